"""The Gearing's oracle against numbers worked out by hand: its laws, and engaging."""

import math
from typing import Any

import pytest

from tests.model.gearing.oracle_cases import (
    ACTIVE,
    CCW_POSITION,
    CONTINUE,
    CW_CCW_DIRECT,
    CW_CCW_POSITION,
    CW_DIRECT,
    GEAR_IN,
    GEAR_OUT,
    MASTER,
    NONE,
    STOPPED,
    TIME,
    TIMED,
    WAITING_START,
    at,
    close,
    motion,
    numbers,
    off,
    on,
    scenario,
    states,
    steady,
    time_based,
)
from tests.oracle.gearing import reference
from tests.oracle.gearing_laws import DRAWN_IN, DRAWN_OUT

# --- the laws ---------------------------------------------------------------------------------------------------------


def test_the_boundary_conditions_give_the_specified_curves() -> None:
    """u³ - u⁴/2 and u - u³ + u⁴/2; both travel one half, so that a transition does not move the line."""
    assert [float(c) for c in DRAWN_IN] == list(numbers(0, 0, 0, 1, -0.5))
    assert [float(c) for c in DRAWN_OUT] == list(numbers(0, 1, 0, -1, 0.5))
    assert float(sum(DRAWN_IN)) == close(0.5)
    assert float(sum(DRAWN_OUT)) == close(0.5)


# --- engaging with the reference position -----------------------------------------------------------------------------

REFERENCE: dict[str, Any] = {"gear_in__reference_position": 280.0, "gear_in__offset": 20.0}


def test_master_based() -> None:
    """D = 100 about 300, the edge at 50: trigger 250 at 2.5 s; u = 1/2 at 3 s: F = 3/32, F' = 1/2, F'' = 3/2."""
    given = steady(100.0, 6.0, on(0.5), slave__initial_position=7.0, **REFERENCE)
    assert states(given) == [(0.5, WAITING_START), (2.5, GEAR_IN), (3.5, ACTIVE)]
    assert motion(at(given, 2.0)) == numbers(7.0, 0.0, 0.0, 0.0)
    middle = at(given, 3.0)
    assert motion(middle) == numbers(7 + 9.375, 50.0, 150.0, 0.0)
    assert (middle["local.progress"], middle["local.trigger_position"]) == numbers(0.5, 250.0)
    quarter = at(given, 2.75)
    assert motion(quarter) == numbers(7 + 100 * (1 / 64 - 1 / 512), 100 * 5 / 32, 100 * 9 / 8, 100 * 3)
    assert motion(at(given, 3.5)) == numbers(57.0, 100.0, 0.0, 0.0)
    late = at(given, 5.0)
    assert motion(late) == numbers(207.0, 100.0, 0.0, 0.0)
    assert (late["in_gear"], late["local.line_offset"]) == (1.0, close(7.0 - 300.0))


def test_a_ratio_scales_the_slave_only() -> None:
    ratio = {"gearing__numerator": -3, "gearing__denominator": 2}
    given = steady(100.0, 6.0, on(0.5), **REFERENCE, **ratio)
    assert motion(at(given, 3.0)) == numbers(-1.5 * 9.375, -75.0, -225.0, 0.0)
    assert at(given, 5.0)["slave.position"] == close(-300.0)


def test_without_transition_the_velocity_jumps() -> None:
    given = steady(100.0, 6.0, on(0.5), gear_in__transition=NONE, **REFERENCE)
    assert states(given) == [(0.5, WAITING_START), (3.0, ACTIVE)]
    before, after = reference(given, [3.0])
    assert (motion(before), motion(after)) == (numbers(0, 0, 0, 0), numbers(0, 100, 0, 0))
    assert (before["state"], after["state"]) == (WAITING_START, ACTIVE)
    same = steady(100.0, 6.0, on(0.5), gear_in__distance=0.0, **REFERENCE)
    assert states(same) == states(given)


def test_ccw_waits_for_the_other_trigger() -> None:
    """Up past 300 and 350 to 400 at 4 s, down again: 350 at 4.5 s, 250 at 5.5 s."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 3.0, "velocity": -100.0}]
    for mode in (CCW_POSITION, CW_CCW_POSITION):
        given = scenario(segments, on(3.0), gear_in__start_mode=mode, **REFERENCE)
        assert states(given) == [(3.0, WAITING_START), (4.5, GEAR_IN), (5.5, ACTIVE)]
        assert motion(at(given, 5.0)) == numbers(-9.375, -50.0, -150.0, 0.0)
        assert at(given, 6.0)["slave.position"] == close(-100.0)
    assert states(scenario(segments, on(3.0), **REFERENCE)) == [(3.0, WAITING_START)]


def test_cw_ccw_takes_the_trigger_crossed_first() -> None:
    given = steady(100.0, 6.0, on(0.5), gear_in__start_mode=CW_CCW_POSITION, **REFERENCE)
    assert states(given) == [(0.5, WAITING_START), (2.5, GEAR_IN), (3.5, ACTIVE)]


def test_within_the_transition_the_window_is_missed() -> None:
    """At 260, past the trigger 250: no fault, 1 until the master comes through it again."""
    segments = [{"duration": 3.0, "velocity": 100.0}, {"duration": 1.0, "velocity": -100.0}]
    given = scenario([*segments, {"duration": 3.0, "velocity": 100.0}], on(2.625), **REFERENCE)
    assert states(given) == [(2.625, WAITING_START), (4.5, GEAR_IN), (5.5, ACTIVE)]
    assert at(given, 3.0)["error"] == 0.0


def test_falling_back_below_the_trigger() -> None:
    """250 at 2.5 s, 280 at 2.8 s, back to 250 at 3.1 s and 240 at 3.2 s, 250 again at 3.3 s."""
    segments = [
        {"duration": 2.8, "velocity": 100.0},
        {"duration": 0.4, "velocity": -100.0},
        {"duration": 3.0, "velocity": 100.0},
    ]
    given = scenario(segments, on(0.5), **REFERENCE)
    expected = [(0.5, WAITING_START), (2.5, GEAR_IN), (3.1, WAITING_START), (3.3, GEAR_IN), (4.3, ACTIVE)]
    assert states(given) == expected
    assert at(given, 2.9)["slave.position"] == close(100 * (0.2**3 - 0.2**4 / 2))
    assert at(given, 2.9)["slave.velocity"] == close(-100 * (3 * 0.2**2 - 2 * 0.2**3))
    assert motion(at(given, 3.2)) == numbers(0, 0, 0, 0)
    assert at(given, 5.0)["slave.position"] == close(420.0 - 300.0)


def test_turning_exactly_on_a_trigger_does_not_count() -> None:
    """100·t - 25·t² is greatest, 100, at 2 s; then one goes straight on, one stops there first."""
    up = {"duration": 2.0, "acceleration": -50.0}
    near = {"gear_in__reference_position": 150.0}
    turning = scenario([up, {"duration": 2.0, "acceleration": -50.0}], on(0.5), velocity=100.0, **near)
    assert states(turning) == [(0.5, WAITING_START)]
    stopping = scenario([up, {"duration": 1.0}, {"duration": 3.0, "velocity": 100.0}], on(0.5), velocity=100.0, **near)
    assert states(stopping) == [(0.5, WAITING_START), (3.0, GEAR_IN), (4.0, ACTIVE)]


def test_turning_exactly_on_the_end_is_the_end() -> None:
    """0 is passed upwards at 0.5 s with 100: greatest 50 at 1.5 s, where u = 1."""
    segments = [{"duration": 0.5, "velocity": 100.0}, {"duration": 2.0, "acceleration": -100.0}]
    options = {"gear_in__reference_position": 25.0, "gear_in__distance": 50.0}
    given = scenario(segments, on(0.25), position=-50.0, **options)
    assert states(given) == [(0.25, WAITING_START), (0.5, GEAR_IN), (1.5, ACTIVE)]
    assert motion(at(given, 2.0)) == numbers(12.5, -50.0, -100.0, 0.0)


def test_standing_exactly_on_a_trigger_and_moving_off_counts() -> None:
    segments = [{"duration": 1.0, "velocity": 0.0}, {"duration": 3.0, "acceleration": 50.0}]
    given = scenario(segments, on(0.5), gear_in__reference_position=50.0)
    assert states(given) == [(0.5, WAITING_START), (1.0, GEAR_IN), (3.0, ACTIVE)]
    away = scenario([segments[0], {"duration": 3.0, "acceleration": -50.0}], on(0.5), gear_in__reference_position=50.0)
    assert states(away) == [(0.5, WAITING_START)]


def test_an_edge_exactly_on_the_trigger_begins_at_once() -> None:
    given = steady(100.0, 4.0, on(2.5), **REFERENCE)
    assert states(given) == [(2.5, WAITING_START), (2.5, GEAR_IN), (3.5, ACTIVE)]
    assert len(reference(given, [2.5])) == 1
    assert at(given, 2.5)["state"] == STOPPED


def test_on_an_accelerating_master() -> None:
    """m = 50·t²: 250 at √5; at 300, √6 s: v = 100·√6, d1 = 1/2, d2 = 3/200."""
    given = scenario([{"duration": 4.0, "acceleration": 100.0}], on(0.5), **REFERENCE)
    assert states(given)[1] == (math.sqrt(5), GEAR_IN)
    row = at(given, math.sqrt(6))
    v = 100 * math.sqrt(6)
    assert motion(row)[:3] == numbers(9.375, v / 2, 50.0 + 0.015 * v * v)
    assert row["slave.jerk"] == close(3 * 0.015 * v * 100)


# --- time-based -------------------------------------------------------------------------------------------------------


def test_time_based_by_hand() -> None:
    """At half time a quintic from (p, v) is p/2 + 5/32·v·T, with the rate -15/8·p/T - 7/16·v: from (40, -100) here."""
    given = time_based(40.0)
    assert states(given) == [(1.0, GEAR_IN), (3.0, ACTIVE)]
    row = at(given, 2.0)
    assert row["slave.position"] == close(60.0 + 20.0 - 31.25)
    assert row["slave.velocity"] == close(100 + (-15 / 8 * 40.0 / 2 + 7 / 16 * 100.0))
    assert (row["local.progress"], row["local.trigger_position"]) == numbers(0.5, 100.0)
    assert motion(at(given, 3.0)) == numbers(160.0, 100.0, 0.0, 0.0)
    assert motion(at(given, 4.0)) == numbers(260.0, 100.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("part", "backwards", "faster"),
    [
        (0.7, True, False),
        (0.6, False, False),
        (0.5, False, False),
        (0.4, False, False),
        (0.3, False, True),
        (0.0, False, True),
        (-0.3, False, True),
    ],
)
def test_the_three_shapes(part: float, backwards: bool, faster: bool) -> None:
    """x = part·v·T."""
    rows = reference(time_based(part * 200.0), [1.0 + 0.01 * i for i in range(1, 200)])
    velocities = [row["slave.velocity"] for row in rows]
    assert (min(velocities) < -1e-9, max(velocities) > 100 + 1e-9) == (backwards, faster)


def test_time_based_waits_for_a_moving_master() -> None:
    """At rest at 0 until 1 s, then down and at 2 s up: CW starts at 2 s, CW_CCW at 1 s."""
    segments = [{"duration": 1.0}, {"duration": 1.0, "velocity": -50.0}, {"duration": 4.0, "velocity": 50.0}]
    given = scenario(segments, on(0.5), gear_in__reference_position=20.0, **TIMED)
    assert states(given) == [(0.5, WAITING_START), (2.0, GEAR_IN), (4.0, ACTIVE)]
    assert at(given, 5.0)["slave.position"] == close(100.0 - 20.0)
    both = scenario(segments, on(0.5), gear_in__reference_position=20.0, gear_in__start_mode=CW_CCW_POSITION, **TIMED)
    assert states(both) == [(0.5, WAITING_START), (1.0, GEAR_IN), (3.0, ACTIVE)]
    assert at(both, 4.0)["slave.position"] == close(50.0 - 20.0)


def test_time_based_on_a_master_that_turns_round() -> None:
    segments = [{"duration": 2.0, "velocity": 100.0}, {"duration": 3.0, "velocity": -100.0}]
    given = scenario(segments, on(1.0), gear_in__reference_position=140.0, **TIMED)
    before, after = reference(given, [2.0])
    assert before["slave.position"] == close(48.75)
    assert after["slave.velocity"] == close(before["slave.velocity"] - 200.0)
    assert motion(at(given, 3.0)) == numbers(-40.0, -100.0, 0.0, 0.0)


# --- direct -----------------------------------------------------------------------------------------------------------


def test_direct_master_based_begins_at_the_edge() -> None:
    """At 50: trigger 50, the line through (100, 5)."""
    given = steady(100.0, 4.0, on(0.5), gear_in__start_mode=CW_DIRECT, slave__initial_position=5.0)
    assert states(given) == [(0.5, GEAR_IN), (1.5, ACTIVE)]
    assert at(given, 1.0)["slave.position"] == close(5 + 9.375)
    assert at(given, 2.0)["slave.position"] == close(105.0)
    assert at(given, 2.0)["local.line_offset"] == close(5.0 - 100.0)


def test_direct_waits_for_its_direction() -> None:
    """Down to -100 at 1 s, then up: the pair is (-100, 0)."""
    segments = [{"duration": 1.0, "velocity": -100.0}, {"duration": 3.0, "velocity": 100.0}]
    for transition, active in ((NONE, 1.0), (MASTER, 2.0), (TIME, 3.0)):
        options = {"gear_in__start_mode": CW_DIRECT, "gear_in__time": 2.0, "gear_in__transition": transition}
        given = scenario(segments, on(0.5), **options)
        assert states(given)[0] == (0.5, WAITING_START)
        assert states(given)[-1] == (active, ACTIVE)
        assert at(given, 3.5)["slave.position"] == close(250.0 - (50.0 if transition == MASTER else 0.0))


def test_direct_without_transition_at_rest() -> None:
    segments = [{"duration": 1.0}, {"duration": 3.0, "velocity": -100.0}]
    given = scenario(segments, on(0.5), gear_in__start_mode=CW_CCW_DIRECT, gear_in__transition=NONE)
    assert states(given) == [(0.5, ACTIVE)]
    assert at(given, 2.0)["slave.position"] == close(-100.0)
    waiting = scenario(segments, on(0.5), gear_in__start_mode=CW_DIRECT, gear_in__transition=NONE)
    assert states(waiting) == [(0.5, WAITING_START)]


def test_direct_at_rest_takes_the_first_direction() -> None:
    """State 2 with u = 0 at once; down from 1 s, D = 100 done at 2 s."""
    segments = [{"duration": 1.0}, {"duration": 3.0, "velocity": -100.0}]
    given = scenario(segments, on(0.5), gear_in__start_mode=CW_CCW_DIRECT)
    assert states(given) == [(0.5, GEAR_IN), (2.0, ACTIVE)]
    assert (at(given, 0.9)["state"], at(given, 0.9)["local.progress"]) == (GEAR_IN, 0.0)
    assert motion(at(given, 1.5)) == numbers(-9.375, -50.0, -150.0, 0.0)
    assert at(given, 3.0)["slave.position"] == close(-150.0)


def test_direct_time_based_at_rest_is_on_the_line_at_once() -> None:
    segments = [{"duration": 1.0}, {"duration": 3.0, "acceleration": 100.0}]
    given = scenario(segments, on(0.5), gear_in__start_mode=CW_CCW_DIRECT, **TIMED)
    assert states(given) == [(0.5, GEAR_IN), (2.5, ACTIVE)]
    assert motion(at(given, 1.5)) == numbers(12.5, 50.0, 100.0, 0.0)


def test_a_direct_transition_keeps_its_trigger() -> None:
    """Begun at 50, back below it at 1.5 s; up through it at 2.5 s."""
    segments = [
        {"duration": 1.0, "velocity": 100.0},
        {"duration": 1.0, "velocity": -100.0},
        {"duration": 3.0, "velocity": 100.0},
    ]
    for mode in (CW_DIRECT, CW_CCW_DIRECT):
        given = scenario(segments, on(0.5), gear_in__start_mode=mode)
        expected = [(0.5, GEAR_IN), (1.5, WAITING_START), (2.5, GEAR_IN), (3.5, ACTIVE)]
        assert states(given) == expected
        assert at(given, 4.0)["slave.position"] == close(100.0)


# --- the synchronous point --------------------------------------------------------------------------------------------

AGAIN: dict[str, Any] = {"gear_in__start_mode": CONTINUE, "gear_out__transition": NONE}


def test_the_first_synchronous_point_is_zero_and_the_initial_position() -> None:
    """Trigger -50 at 1.5 s, active at 2.5 s: s = m + 30."""
    given = steady(100.0, 4.0, on(0.5), position=-200.0, slave__initial_position=30.0, **AGAIN)
    assert states(given) == [(0.5, WAITING_START), (1.5, GEAR_IN), (2.5, ACTIVE)]
    assert at(given, 3.0)["slave.position"] == close(130.0)


def test_the_line_of_the_last_engagement_goes_on() -> None:
    """s = 2·(m - 100) from 150 on; off at 200 with 200; back from 400 to the line downwards: 250 ... 150, s = 200."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 4.0, "velocity": -100.0}]
    given = scenario(
        segments,
        on(0.25),
        off(2.0),
        on(3.0, gear_in__start_mode=CONTINUE),
        gearing__numerator=2,
        gear_in__reference_position=100.0,
        gear_out__transition=NONE,
    )
    expected = [(0.25, WAITING_START), (0.5, GEAR_IN), (1.5, ACTIVE), (2.0, STOPPED), (3.0, WAITING_START)]
    assert states(given) == [*expected, (5.5, GEAR_IN), (6.5, ACTIVE)]
    assert at(given, 6.0)["slave.position"] == close(200.0 - 2 * 9.375)
    assert at(given, 7.0)["slave.position"] == close(2 * (100.0 - 100.0))


def test_already_on_the_line_it_engages_at_rest() -> None:
    segments = [{"duration": 1.0}, {"duration": 2.0, "velocity": -100.0}]
    for position, when in ((0.0, 0.5), (5e-10, 0.5), (1.0, 1.01)):
        given = scenario(segments, on(0.5), position=position, **AGAIN, gear_in__transition=NONE)
        assert states(given)[-1] == (when, ACTIVE)
        assert at(given, 2.0)["slave.position"] == close(position - 100.0)


def test_a_set_synchronous_point() -> None:
    """Master half 50, slave half 80, which also moves the slave: s = m + 30."""
    sets = [
        {"at": 0.1, "activate": False},
        {"at": 0.2, "set_master__execute": True, "set_master__value": 50.0},
        {"at": 0.3, "set_slave__execute": True, "set_slave__value": 80.0},
        {"at": 0.4, "activate": True},
        on(0.5),
    ]
    given = steady(100.0, 4.0, *sets, position=-100.0, **AGAIN)
    assert (at(given, 0.3)["slave.position"], at(given, 0.31)["slave.position"]) == (0.0, 80.0)
    assert states(given) == [(0.5, WAITING_START), (1.0, GEAR_IN), (2.0, ACTIVE)]
    assert at(given, 3.0)["slave.position"] == close(230.0)
    active = steady(100.0, 4.0, *[{k: v for k, v in s.items() if k != "activate"} for s in sets], position=-100.0)
    assert at(active, 0.35)["slave.position"] == 0.0


def test_time_based_onto_the_synchronous_line_while_disengaging() -> None:
    """In 5 the edge acts at once; at 5.5 s the slave is on s = m again."""
    sets = [on(0.5), off(3.0, gear_out__transition=TIME, gear_out__time=2.0), on(3.5, gear_in__transition=TIME)]
    given = steady(100.0, 6.0, *sets, gear_in__start_mode=CONTINUE, gear_in__time=2.0, position=-200.0)
    assert states(given)[3:] == [(3.0, GEAR_OUT), (3.5, GEAR_IN), (5.5, ACTIVE)]
    before, after = (at(given, 3.5 + side * 1e-7) for side in (-1, 1))
    assert motion(after)[:3] == pytest.approx(motion(before)[:3], rel=1e-4)
    assert at(given, 5.75)["slave.position"] == close(375.0)
