"""A Gearing along a scripted master, and the situations from which its tests begin."""

from typing import Any, Self

import pytest

from motionsync.gearing.block import Gearing
from motionsync.gearing.interface import StartMode, State, Transition
from tests.support.blocks.harness import MOTION, BlockHarness

NONE, MASTER, TIME = Transition.NONE, Transition.MASTER_BASED, Transition.TIME_BASED
STOPPED, WAITING_FOR_START, GEAR_IN = State.STOPPED, State.WAITING_FOR_STARTPOSITION, State.GEAR_IN
ACTIVE, WAITING_FOR_STOP, GEAR_OUT = State.ACTIVE, State.WAITING_FOR_STOPPOSITION, State.GEAR_OUT
INSTANT = 2.0**-40  # s, a step in which nothing moves
CW, CCW, BOTH = (
    StartMode.WITH_CW_REFERENCE_POSITION,
    StartMode.WITH_CCW_REFERENCE_POSITION,
    StartMode.WITH_CW_CCW_REFERENCE_POSITION,
)


class GearingHarness(BlockHarness):
    """A Gearing whose commands are the edges of `start`."""

    TYPE = Gearing
    SHOWN = (*MOTION, "state_code")

    def start(self, **values: Any) -> Self:
        """A rising edge of `start` with the next run; the values go to gear_in."""
        return self.set({f"gear_in.{name}": value for name, value in values.items()} | {"start": True})

    def stop(self, **values: Any) -> Self:
        """A falling edge of `start` with the next run; the values go to gear_out."""
        return self.set({f"gear_out.{name}": value for name, value in values.items()} | {"start": False})


def near(*values: float, tolerance: float = 1e-9) -> Any:
    """What equals one number, or a tuple of several, within the tolerance, relative or absolute."""
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def ratio(numerator: int, denominator: int) -> dict[str, int]:
    """The values of the ratio's two variables."""
    return {"gearing.numerator": numerator, "gearing.denominator": denominator}


def three_halves(**values: Any) -> dict[str, Any]:
    """The ratio 3 : 2, and further values."""
    return {**ratio(3, 2), **values}


def in_gear(*, master_position: float = 0.0, speed: float = 10.0, **values: Any) -> GearingHarness:
    """Engaged at once on the line through (master_position, 0), 3 : 2; an INSTANT later."""
    gear = GearingHarness(three_halves(**values), master_position=master_position, speed=speed)
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=NONE).run(INSTANT)
    assert gear.state == ACTIVE
    return gear


def waiting_for_reference(
    speed: float = 10.0, master_position: float = 0.0, mode: StartMode = CW, **values: Any
) -> GearingHarness:
    """The slave waits at 7 for the reference position 40 + 10, with a transition over 20; 3 : 2."""
    gear = GearingHarness(three_halves(**{"slave.initial_position": 7.0}), master_position=master_position, speed=speed)
    return gear.start(start_mode=mode, reference_position=40.0, offset=10.0, **{"distance": 20.0, **values})


def engaging_direct(mode: StartMode, speed: float, **values: Any) -> GearingHarness:
    """A direct engagement is ordered with the master at 5 and the slave at 7, with a transition over 20; 3 : 2."""
    gear = GearingHarness(three_halves(**{"slave.initial_position": 7.0}), master_position=5.0, speed=speed)
    return gear.start(start_mode=mode, **{"distance": 20.0, **values})


def engaging_in_time(missing: float, speed: float = 10.0, **values: Any) -> GearingHarness:
    """An engagement within T = 2 s is ordered, v T = 20; the reference position is `missing` ahead of the master at
    100; the slave is at 0, 3 : 2."""
    gear = GearingHarness(three_halves(), master_position=100.0, speed=speed)
    return gear.start(transition=TIME, time=2.0, reference_position=100.0 + missing, **values)


def continuing(**values: Any) -> GearingHarness:
    """The slave has left the line through (0, 0) at (0, 0) and rests 1.5 * 10 further, with the master at 20; it is
    ordered to continue on that line, with a transition over 4."""
    gear = in_gear().stop(distance=20.0).to(20.0)
    gear.run(INSTANT)
    assert gear.slave == near(15.0, 0.0, 0.0)
    return gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, **{"transition": MASTER, "distance": 4.0, **values})
