"""The Gearing engages directly, where both axes are."""

import pytest

from motionsync.gearing.interface import StartMode, State
from tests.model.gearing.harness import (
    ACTIVE,
    GEAR_IN,
    MASTER,
    NONE,
    TIME,
    WAITING_FOR_START,
    GearingHarness,
    engaging_direct,
    near,
    three_halves,
)


@pytest.mark.parametrize(
    ("mode", "speed", "state"),
    [
        (StartMode.CW_DIRECT, 10.0, GEAR_IN),
        (StartMode.CW_DIRECT, 0.0, WAITING_FOR_START),
        (StartMode.CW_DIRECT, -10.0, WAITING_FOR_START),
        (StartMode.CCW_DIRECT, -10.0, GEAR_IN),
        (StartMode.CCW_DIRECT, 0.0, WAITING_FOR_START),
        (StartMode.CW_CCW_DIRECT, 10.0, GEAR_IN),
        (StartMode.CW_CCW_DIRECT, -10.0, GEAR_IN),
        (StartMode.CW_CCW_DIRECT, 0.0, GEAR_IN),
    ],
)
def test_direct_begins_at_the_edge_if_the_master_moves_as_it_has_to(
    mode: StartMode, speed: float, state: State
) -> None:
    for transition, reached in [(MASTER, state), (TIME, state), (NONE, ACTIVE if state == GEAR_IN else state)]:
        gear = engaging_direct(mode, speed, transition=transition).run(0.01)
        assert gear.state == reached
        assert gear["local.progress"] == near(
            {GEAR_IN: abs(speed) * 0.01 / 20.0, ACTIVE: 1.0, WAITING_FOR_START: 0.0}[reached]
        ) or (transition == TIME)


def test_direct_and_master_based_the_line_is_moved_by_half_the_distance() -> None:
    gear = engaging_direct(StartMode.CW_DIRECT, 10.0).run(1.0)
    assert gear["local.trigger_position"] == 5.0
    assert gear["local.line_offset"] == 7.0 - 1.5 * 15.0
    assert gear.slave == near(7.0 + 30.0 * (1 / 8 - 1 / 32), 7.5, 1.5 * 1.5 * 5.0)
    assert gear.run(2.0).slave == near(7.0 + 1.5 * (35.0 - 15.0), 15.0, 0.0)


def test_direct_waits_for_the_master_to_turn() -> None:
    gear = engaging_direct(StartMode.CW_DIRECT, -10.0).run(3.0, acceleration=5.0)  # turns after 2 s at 5 - 10
    assert gear.state == GEAR_IN
    assert gear["local.trigger_position"] == near(-5.0)
    u = 2.5 / 20.0
    assert gear.slave[0] == near(7.0 + 30.0 * (u**3 - u**4 / 2))


def test_at_rest_and_in_either_direction_the_first_motion_gives_the_direction() -> None:
    gear = engaging_direct(StartMode.CW_CCW_DIRECT, 0.0).run(1.0)
    assert (gear.state, gear["local.progress"], gear.slave) == (GEAR_IN, 0.0, (7.0, 0.0, 0.0))
    gear.run(2.0, acceleration=-5.0)
    assert gear.slave[0] == near(7.0 - 30.0 * (1 / 8 - 1 / 32))
    assert gear["local.line_offset"] == near(7.0 + 1.5 * 5.0)  # through (5 - 10, 7)


def test_direct_without_transition_is_in_gear_at_once_even_at_rest() -> None:
    gear = engaging_direct(StartMode.CW_CCW_DIRECT, 0.0, transition=NONE).run(1.0)
    assert (gear.state, gear.slave) == (ACTIVE, (7.0, 0.0, 0.0))
    assert gear.run(1.0, acceleration=2.0).slave == near(8.5, 3.0, 3.0)


def test_a_master_that_sets_off_gently_moves_from_its_first_step_on() -> None:
    """At 1e6 it travels 1e-9 in 10 ms, less than two positions there can differ by: its velocity counts."""
    gear = GearingHarness(three_halves(), master_position=1e6, speed=0.0)
    gear.start(start_mode=StartMode.CW_DIRECT, distance=20.0).run(0.01)
    assert gear.state == WAITING_FOR_START
    assert gear.run(0.01, acceleration=2e-5).state == GEAR_IN
