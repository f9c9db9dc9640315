"""The master reverses during an engagement of the Gearing."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.gearing.interface import StartMode, StopMode, Transition
from motionsync.master import MasterInput
from tests.model.gearing.harness import (
    ACTIVE,
    CCW,
    CW,
    WAITING_FOR_START,
    WAITING_FOR_STOP,
    GearingHarness,
    engaging_direct,
    near,
    waiting_for_reference,
)
from tests.support.blocks.drawn import drawn


def test_the_slave_goes_back_along_the_curve_and_rests_below_the_trigger() -> None:
    gear = waiting_for_reference().to(45.0)
    forwards = gear.slave
    gear.to(55.0)
    gear.speed = -10.0
    gear.to(45.0)
    assert gear.slave == near(forwards[0], -forwards[1], forwards[2])
    gear.to(39.0)
    assert (gear.state, gear.slave) == (WAITING_FOR_START, (7.0, 0.0, 0.0))
    gear.speed = 10.0
    assert gear.to(61.0).slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_a_direct_transition_keeps_its_trigger() -> None:
    gear = engaging_direct(StartMode.CW_CCW_DIRECT, 10.0).run(1.0)
    gear.speed = -10.0
    assert gear.to(-20.0).state == WAITING_FOR_START
    assert gear["local.trigger_position"] == 5.0
    gear.speed = 10.0
    assert gear.to(30.0).slave == near(7.0 + 1.5 * 15.0, 15.0, 0.0)


def test_completion_is_final() -> None:
    gear = waiting_for_reference().to(60.5)
    gear.speed = -10.0
    assert gear.to(30.0).state == ACTIVE
    assert gear.slave == near(7.0 - 1.5 * 20.0, -15.0, 0.0)


@drawn()
@given(
    st.sampled_from([1.0, -1.0]),
    st.booleans(),
    st.sampled_from([Transition.NONE, Transition.MASTER_BASED]),
    st.sampled_from([MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY]),
    st.integers(1, 64).map(lambda number: number / 16),
    st.sampled_from([1.0, 0.25, 2.0**-7]),
    st.integers(1, 20),
    st.sampled_from([0.0, 8.0]),
)
def test_against_its_direction_a_master_that_steps_exactly_onto_triggers_starts_nothing(
    direction: float,
    engages: bool,
    transition: Transition,
    mode: MasterInput,
    size: float,
    h: float,
    steps: int,
    distance: float,
) -> None:
    """The master goes against the direction in steps of `size`; after `steps` of them it is exactly at the trigger,
    half the distance before the position; all numbers are dyadic."""
    half = 0.5 * distance * direction if transition == Transition.MASTER_BASED else 0.0
    position = -direction * size * steps + half
    gear = GearingHarness(speed=-direction * size / h, mode=mode)
    settings_of_both = {"transition": transition, "distance": distance}
    if engages:
        gear.start(start_mode=CW if direction > 0.0 else CCW, reference_position=position, **settings_of_both)
        waiting = WAITING_FOR_START
    else:
        gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=Transition.NONE).run(h)
        position -= direction * size
        stops = StopMode.WITH_CW_STOP_POSITION if direction > 0.0 else StopMode.WITH_CCW_STOP_POSITION
        gear.stop(stop_mode=stops, stop_position=position, **settings_of_both)
        waiting = WAITING_FOR_STOP
    for _ in range(steps + 3):
        gear.run(h)
        assert gear.state == waiting


@pytest.mark.parametrize("transition", [Transition.NONE, Transition.MASTER_BASED])
@pytest.mark.parametrize("beyond", [0.5, 4.0])
def test_a_correction_of_a_master_that_goes_against_the_direction_crosses_no_trigger(
    transition: Transition, beyond: float
) -> None:
    """The prediction ends before the trigger at 40, or 50 without a transition; the master is behind it and falls."""
    trigger = 50.0 if transition == Transition.NONE else 40.0
    gear = waiting_for_reference(speed=-10.0, master_position=trigger + 10.0, transition=transition)
    gear.to(trigger - beyond)
    gear.master_position = trigger + beyond
    gear.speed = -1.0
    assert gear.run(0.25).state == WAITING_FOR_START
    assert gear.slave == (7.0, 0.0, 0.0)
