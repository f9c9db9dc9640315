"""A Follower along a scripted master, for tests of the block alone.

Unless said otherwise its slave is linear, from its park at 0 to sync at 100, out at 300, braking over 100, k = 1; the
master comes with 100 from 0 and has a cycle of 1000. So the way to the meeting at 1000 starts at 800, the synchronized
phase ends at 1200, the stroke at 1400, and the way home at 1800.
"""

from typing import Any, Self

import pytest

from motionsync.follower.block import Follower
from motionsync.follower.faults import Fault
from motionsync.master import MasterInput
from tests.support.blocks.harness import BlockHarness

START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
CYCLIC = {"slave_cycle": 400.0}  # S_h = 100, L = 100
PASSING: dict[str, Any] = {**CYCLIC, "stop_in_park": False}
VARIABLE: dict[str, Any] = {"variable_cycle": True, "sync_master": 1000.0}
RECOVERING: dict[str, Any] = {**PASSING, **VARIABLE, "recover_late_sync": True}
COMMANDS = ("position_to_park", "position_to_cycle", "end_synchronism", "reset")


class FollowerHarness(BlockHarness):
    """Its commands fall again after the step for which they were given."""

    TYPE = Follower

    def after_step(self) -> None:
        self.set(dict.fromkeys(COMMANDS, False))

    def give(self, *names: str) -> Self:
        """Rising edges of these commands with the next run."""
        return self.set(dict.fromkeys(names, True))

    @property
    def position(self) -> float:
        position: float = self.block.slave.position
        return position

    @property
    def fault(self) -> Fault:
        return Fault(self.block.error_id)

    @property
    def missing(self) -> tuple[float, float, float]:
        """The master's travel missing to start, meeting and end."""
        return self.block.master_to_start, self.block.master_to_sync, self.block.master_to_out


def near(*values: float, tolerance: float = 1e-9) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def parked(
    master_position: float = 0.0, speed: float = 100.0, mode: MasterInput = START, **values: Any
) -> FollowerHarness:
    """Positioned to its park, where it is at rest already."""
    names = {name.replace("__", "."): value for name, value in values.items()}
    return (
        FollowerHarness(names, master_position=master_position, speed=speed, mode=mode)
        .give("position_to_park")
        .run(2.0**-20)
    )


def stopping(phase: float, **limits: Any) -> FollowerHarness:
    """Just before the place of the phase; then the limits come to act."""
    return parked(check_speed=False, check_acceleration=False, **limits).to(phase - 1.0)


def quintic(length: float, position: float, d1: float, target: float, end_d1: float, x: float) -> float:
    """By Hermite's functions, not by the coefficients the block uses."""
    u = x / length
    h0, h1 = 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u * u), u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    g0, g1 = u - u**3 * (6.0 - 8.0 * u + 3.0 * u * u), -(u**3) * (4.0 - 7.0 * u + 3.0 * u * u)
    return position * h0 + d1 * length * g0 + target * h1 + end_d1 * length * g1
