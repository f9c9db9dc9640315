"""The Gearing engages at a reference position: the transition, the trigger, the direction."""

import pytest

from motionsync.gearing.interface import StartMode, Transition
from tests.model.gearing.harness import (
    ACTIVE,
    BOTH,
    CCW,
    CW,
    GEAR_IN,
    INSTANT,
    MASTER,
    NONE,
    WAITING_FOR_START,
    GearingHarness,
    near,
    three_halves,
    waiting_for_reference,
)
from tests.support.blocks.harness import grid


def test_a_master_based_transition_lies_round_the_reference_position() -> None:
    gear = waiting_for_reference().run(3.9)
    assert gear.state == WAITING_FOR_START
    assert gear["local.trigger_position"] == 40.0
    assert gear["local.line_offset"] == 7.0 - 1.5 * 50.0
    assert gear.slave == (7.0, 0.0, 0.0)
    gear.to(45.0)  # u = 1/4
    assert gear.state == GEAR_IN
    assert gear["local.progress"] == near(0.25)
    assert gear.slave == near(7.0 + 30.0 * (1 / 64 - 1 / 512), 15.0 * (3 / 16 - 2 / 64), 1.5 * (6 / 4 - 6 / 16) * 5.0)
    assert gear["slave.jerk"] == near(1.5 * (6.0 - 3.0) * 1000.0 / 400.0)
    gear.to(59.9)
    assert gear.state == GEAR_IN
    gear.to(61.0)
    assert gear.state == ACTIVE
    assert gear["in_gear"]
    assert gear["local.progress"] == 1.0
    assert gear.slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_without_transition_the_velocity_jumps_where_the_reference_position_is_crossed() -> None:
    gear = waiting_for_reference(transition=NONE).run(4.99)
    assert gear.state == WAITING_FOR_START
    assert gear.slave == (7.0, 0.0, 0.0)
    gear.run(0.02)
    assert gear.state == ACTIVE
    assert gear.slave == near(7.0 + 1.5 * 0.1, 15.0, 0.0)


def test_a_distance_of_0_is_no_transition() -> None:
    assert waiting_for_reference(distance=0.0).run(4.99).state == WAITING_FOR_START
    assert waiting_for_reference(distance=0.0).run(5.01).slave == near(7.15, 15.0, 0.0)


@pytest.mark.parametrize(
    ("mode", "speed", "master_position", "engages"),
    [
        (CW, 10.0, 0.0, True),
        (CW, -10.0, 100.0, False),
        (CCW, -10.0, 100.0, True),
        (CCW, 10.0, 0.0, False),
        (BOTH, 10.0, 0.0, True),
        (BOTH, -10.0, 100.0, True),
    ],
)
@pytest.mark.parametrize("transition", [NONE, MASTER])
def test_the_master_has_to_cross_in_the_configured_direction(
    mode: StartMode, speed: float, master_position: float, engages: bool, transition: Transition
) -> None:
    gear = waiting_for_reference(speed, master_position, mode, transition=transition).run(3.9)
    assert gear.state == WAITING_FOR_START
    gear.run(0.2)
    assert gear.state == (GEAR_IN if engages and transition == MASTER else WAITING_FOR_START)
    gear.run(2.0)
    assert gear.state == (ACTIVE if engages else WAITING_FOR_START)
    if engages:
        assert gear.slave == near(7.0 + 1.5 * (gear.master_position - 50.0), 1.5 * speed, 0.0)


def test_downwards_the_trigger_lies_above_and_the_curve_leads_down() -> None:
    gear = waiting_for_reference(-10.0, 100.0, BOTH).run(3.9)
    assert gear["local.trigger_position"] == 60.0
    gear.to(55.0)
    assert gear.slave == near(7.0 - 30.0 * (1 / 64 - 1 / 512), -15.0 * (3 / 16 - 2 / 64), -1.5 * (9 / 8) * 5.0)


def test_in_either_direction_the_trigger_that_is_crossed_first_decides() -> None:
    gear = waiting_for_reference(10.0, 41.0, BOTH).run(1.0)  # upwards it is too late; turn above the other trigger
    assert gear.state == WAITING_FOR_START
    gear.run(2.0).set({})
    gear.speed = -10.0
    gear.to(59.0)
    assert gear.state == GEAR_IN


def test_a_missed_window_is_no_fault() -> None:
    gear = waiting_for_reference(10.0, 41.0).run(5.0)
    assert (gear.state, gear["error"]) == (WAITING_FOR_START, False)
    gear.speed = -10.0
    gear.to(39.0)
    gear.speed = 10.0
    gear.to(61.0)
    assert gear.slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_being_on_the_trigger_and_moving_in_its_direction_counts() -> None:
    assert waiting_for_reference(10.0, 40.0).run(INSTANT).state == GEAR_IN
    assert waiting_for_reference(0.0, 40.0).run(1.0).state == WAITING_FOR_START
    assert waiting_for_reference(0.0, 40.0).run(1.0, acceleration=1.0).state == GEAR_IN
    assert waiting_for_reference(0.0, 40.0).run(1.0, acceleration=-1.0).state == WAITING_FOR_START
    assert waiting_for_reference(10.0, 30.0).run(1.0).state == GEAR_IN  # at the step's end


def test_from_where_the_master_came_before_the_edge_does_not_count() -> None:
    """It comes down to the trigger and rests on it; after the edge it starts upwards."""
    gear = GearingHarness(three_halves(), master_position=50.0, speed=-10.0).run(1.0)
    gear.speed = 0.0
    gear.start(start_mode=CW, reference_position=40.0, offset=10.0, distance=20.0)
    assert gear.run(1.0).state == WAITING_FOR_START
    assert gear.run(1.0, acceleration=1.0).state == GEAR_IN


@pytest.mark.parametrize("cuts", [[], [1.0], grid(2.0, 0.25)])
@pytest.mark.parametrize(("master_position", "speed"), [(35.0, 10.0), (45.0, -10.0)])
def test_turning_exactly_on_the_trigger_does_not_count(cuts: list[float], master_position: float, speed: float) -> None:
    gear = waiting_for_reference(speed, master_position).run(2.0, acceleration=-speed, cuts=cuts)
    assert gear.master_position == master_position
    assert gear.state == WAITING_FOR_START
    gear.speed = 0.0
    assert gear.run(1.0).state == WAITING_FOR_START


@pytest.mark.parametrize("h", [10.0, 3.0, 0.3, 0.01])
def test_the_whole_transition_may_lie_in_one_step(h: float) -> None:
    gear = waiting_for_reference().run(10.0, cuts=grid(10.0, h))
    assert gear.slave == near(7.0 + 1.5 * 50.0, 15.0, 0.0)
