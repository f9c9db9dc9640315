"""The Gearing with each way in which the inputs hold the master."""

import math

import pytest

from motionsync.gearing.faults import Refusal
from motionsync.gearing.interface import StartMode, State, StopMode, Transition
from motionsync.master import MasterInput
from tests.model.gearing.harness import (
    ACTIVE,
    GearingHarness,
    near,
    three_halves,
)
from tests.support.blocks.harness import grid


@pytest.mark.parametrize("transition", Transition)
def test_end_of_step_inputs_give_the_same(transition: Transition) -> None:
    def motions(mode: MasterInput) -> list[tuple[float, float, float]]:
        gear = GearingHarness(three_halves(), speed=10.0, mode=mode)
        gear.start(reference_position=30.0, transition=transition, distance=20.0).run(1.0)
        engaging = [gear.run(0.7, acceleration=a).slave for a in (0.0, 3.0, 0.0, -2.0, 5.0, 0.0)]
        gear.stop(transition=transition, distance=20.0)
        return engaging + [gear.run(0.7, acceleration=a).slave for a in (0.0, -3.0, 4.0, 1.0)]

    for a, b in zip(motions(MasterInput.START_OF_STEP), motions(MasterInput.END_OF_STEP), strict=True):
        assert a == near(*b)


def test_position_only_inputs_lead_on_to_the_line() -> None:
    gear = GearingHarness(three_halves(), speed=10.0, mode=MasterInput.POSITION_ONLY)
    gear.start(reference_position=30.0, distance=20.0).run(6.0, cuts=grid(6.0, 0.1))
    assert gear.state == ACTIVE
    assert gear.slave == near(1.5 * 30.0, 15.0, 0.0, tolerance=1e-6)


def test_a_step_too_short_to_divide_by_leaves_nothing_infinite() -> None:
    gear = GearingHarness(speed=10.0, mode=MasterInput.END_OF_STEP)
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=Transition.NONE).run(1.0)
    gear.stop(stop_mode=StopMode.CW_CCW_DIRECT, transition=Transition.TIME_BASED, time=1.0).set(
        {"master.velocity": -20.0}
    )
    assert gear.block.step(5e-324) == Refusal.NONE
    gear.speed = -20.0
    for motion in gear.rows(1.0, cuts=[0.25, 0.5]).values():
        assert all(map(math.isfinite, motion.values()))
    assert gear.state == State.STOPPED


def test_a_measured_master_leads_along_the_same_curve_out_of_gear() -> None:
    """A steady line is measured as it runs: the slave is on the curve from its beginning on, and not on the line."""
    gear = GearingHarness(three_halves(), speed=10.0, mode=MasterInput.MEASURED)
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=Transition.NONE).run(0.1, cuts=grid(0.1, 0.01))
    gear.stop(stop_mode=StopMode.CW_CCW_DIRECT, distance=20.0).run(0.5, cuts=grid(0.5, 0.01))
    assert gear.state == State.GEAR_OUT
    assert gear.slave == near(
        1.5 + 30.0 * (1 / 4 - 1 / 64 + 1 / 512), 15.0 * (1 - 3 / 16 + 2 / 64), -1.5 * (9 / 8) * 5.0, tolerance=1e-7
    )
