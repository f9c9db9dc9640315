"""A FlyingSaw along a scripted master, for tests of the block alone."""

from collections.abc import Iterable
from itertools import compress
from typing import Any, Self

import pytest

from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.interface import State
from motionsync_fmu.interface.variables import variables
from tests.support.blocks.harness import BlockHarness, Row

OUTPUTS = tuple(v.name for v in variables(FlyingSaw()) if v.causality in ("output", "local"))
RESULTS = (
    *("start_sync", "in_sync", "in_velocity", "done", "busy", "active"),
    *("command_aborted", "error"),
)
GROUPS = (
    *("gear_in_velo", "gear_in_pos", "gear_out", "halt", "stop"),
    *("move_velocity", "move_absolute", "reset"),
)
EXECUTES = tuple(f"{group}.execute" for group in GROUPS)
INSTANT = 2.0**-20  # s, a step in which hardly anything moves
VELOCITY_CHECKS = ("check_overshoot_velocity", "check_undershoot_velocity")
FIRST: dict[str, float] = {"master_sync_position": 1000.0, "slave_sync_position": 1000.0}
SECOND: dict[str, float] = {"ratio_numerator": 1.5, "master_sync_position": 1000.0, "slave_sync_position": 500.0}
AIMS: dict[str, Any] = {"master_sync_position": 1000.0, "slave_sync_position": 700.0}


class FlyingSawHarness(BlockHarness):
    """Drives a FlyingSaw; its commands are function blocks, so `execute` has to fall before it can rise again."""

    TYPE = FlyingSaw

    def after_step(self) -> None:
        self.held = {*compress(GROUPS, self.stepper.values(EXECUTES))}

    def modes(self, *names: str) -> Self:
        """These bits of sync_mode, and no other."""
        bits = (name for name in self.stepper.cells if name.startswith("sync_mode."))
        return self.set({name: name.removeprefix("sync_mode.") in names for name in bits})

    def give(self, group: str, **values: Any) -> Self:
        """The group's inputs, and a rising edge of its `execute` with the next run."""
        assert group not in self.held, "no edge: execute has not been false"
        return self.set({f"{group}.{name}": value for name, value in values.items()} | {f"{group}.execute": True})

    def release(self, *groups: str) -> Self:
        """A falling edge of these groups' `execute`, of all of them if none is named."""
        return self.set({f"{group}.execute": False for group in groups or GROUPS})

    def read(self, names: Iterable[str] = OUTPUTS) -> Row:
        return super().read(names)

    def results(self, group: str) -> set[str]:
        """The names of the group's outputs that are true."""
        return {name for name in RESULTS if f"{group}.{name}" in self.stepper.cells and self[f"{group}.{name}"]}


def near(*values: float, tolerance: float = 1e-9) -> Any:
    """Equal to one value, or to a tuple of several, within the tolerance, relative or absolute."""
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def first_example(**values: Any) -> FlyingSawHarness:
    """TS5055, section 4, example 1: T = 3 s, D = 1250, v0 = 250, v_s = 500; not yet ordered."""
    initial = {"axis.initial_position": -250.0, "axis.initial_velocity": 250.0}
    limits = {f"axis.max_{name}": value for name, value in [("acceleration", 2500.0), ("deceleration", 2500.0)]}
    return FlyingSawHarness(
        {**initial, **limits, "axis.max_jerk": 5000.0, **values}, master_position=-500.0, speed=500.0
    )


def second_example(**values: Any) -> FlyingSawHarness:
    """Example 2: T = 3 s, D = 1000, v0 = -250, v_s = 750; not yet ordered."""
    initial = {"axis.initial_position": -500.0, "axis.initial_velocity": -250.0}
    return FlyingSawHarness({**initial, "axis.max_jerk": 50000.0, **values}, master_position=-500.0, speed=500.0)


def meeting(  # T = 1 s unless said otherwise; both at 0 at first
    v0: float, vs: float, distance: float, *modes: str, vm: float = 100.0, t: float = 1.0, **values: Any
) -> FlyingSawHarness:
    """gear_in_pos takes a slave from 0 with the velocity v0 to `distance` with vs, while the master comes from 0 with
    vm."""
    machine = {f"axis.{name}": value for name, value in values.items()}
    saw = FlyingSawHarness({"axis.initial_velocity": v0, **machine}, speed=vm).modes("detailed_error_codes", *modes)
    ratio = {"ratio_numerator": vs / vm}
    return saw.give("gear_in_pos", master_sync_position=vm * t, slave_sync_position=distance, **ratio).run(INSTANT)


def assert_refused(saw: FlyingSawHarness, group: str, code: int, **values: Any) -> FlyingSawHarness:
    """Give the command and check that it is refused with this code.

    Apart from the errors and the values of the plan, all outputs are as without the command, to the last bit. A command
    of an earlier edge of the same function block goes on without being shown."""
    twin = saw.twin()
    saw.give(group, **values)
    for acceleration in (0.0, 30.0):
        saw.run(0.02, acceleration=acceleration)
        twin.run(0.02, acceleration=acceleration)
        assert saw.results(group) == {"error"}
        assert (saw[f"{group}.error_id"], saw["error"], saw["error_id"]) == (code, True, code)
        for name in OUTPUTS:
            if not name.startswith((f"{group}.", "error", "local.plan_")):
                assert repr(saw[name]) == repr(twin[name]), name
    saw.release(group).run(INSTANT)
    assert saw.results(group) == set()
    assert (saw[f"{group}.error_id"], saw["error"], saw["error_id"]) == (0, True, code)
    return saw


def moving() -> FlyingSawHarness:
    """The slave moves by itself at constant velocity."""
    return FlyingSawHarness({"axis.initial_velocity": 20.0}, speed=100.0).run(0.1)


def under_way() -> FlyingSawHarness:
    """gear_in_velo has begun to synchronise the slave, which takes 0.15 s."""
    saw = FlyingSawHarness(speed=100.0).give("gear_in_velo", acceleration=1000.0).run(0.03).release()
    assert saw.run(INSTANT).state == State.SYNCHRONIZING
    return saw


def coupled() -> FlyingSawHarness:
    """The slave is in sync with the master by gear_in_velo."""
    saw = under_way().run(0.5)
    assert saw.state == State.SYNCHRON
    return saw


def stopped_half() -> FlyingSawHarness:
    """A halt of the slave is half done."""
    return FlyingSawHarness({"axis.initial_velocity": 500.0}, speed=3.0).give("halt").run(0.03)
