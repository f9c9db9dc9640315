"""The Gearing's oracle against numbers worked out by hand: laws, triggers, states, edges, periods, faults."""

import math
import random
from typing import Any

import pytest

from tests.oracle.gearing import STATES, events, reference
from tests.oracle.gearing_laws import DRAWN_IN, DRAWN_OUT

STOPPED, WAITING_START, GEAR_IN, ACTIVE, WAITING_STOP, GEAR_OUT = range(6)
CW_DIRECT, CCW_DIRECT, CW_CCW_DIRECT, CW_POSITION, CCW_POSITION, CW_CCW_POSITION, CONTINUE = range(1, 8)
NONE, MASTER, TIME = 1, 2, 3


def scenario(segments: list[dict[str, float]], *sets: dict[str, Any], **start: Any) -> dict[str, Any]:
    """A scenario of the segments' length; names have `__` for a dot, `position` and `velocity` are the master's."""
    master = {name: start.pop(name, 0.0) for name in ("position", "velocity", "acceleration")}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": {name.replace("__", "."): value for name, value in start.items()},
        "master": master | {"segments": segments},
        "set": [{name.replace("__", "."): value for name, value in table.items()} for table in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **start: Any) -> dict[str, Any]:
    """A master of constant velocity."""
    return scenario([{"duration": duration}], *sets, velocity=velocity, **start)


def on(time: float, **values: Any) -> dict[str, Any]:
    """A rising edge of start."""
    return {"at": time, "start": True, **values}


def off(time: float, **values: Any) -> dict[str, Any]:
    """A falling edge of start."""
    return {"at": time, "start": False, **values}


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float, float]:
    return (row["slave.position"], row["slave.velocity"], row["slave.acceleration"], row["slave.jerk"])


def states(given: dict[str, Any]) -> list[tuple[Any, int]]:
    """The states entered, with their times."""
    return [(close(time), STATES.index(name)) for time, name in events(given) if name in STATES]


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


def numbers(*values: float) -> tuple[Any, ...]:
    return tuple(close(value) for value in values)


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

TIMED: dict[str, Any] = {"gear_in__transition": TIME, "gear_in__time": 2.0}


def time_based(ahead: float, **options: Any) -> dict[str, Any]:
    """An edge at 1 s, the master at 100 with 100; the reference position `ahead` of it."""
    return steady(100.0, 5.0, on(1.0), gear_in__reference_position=100.0 + ahead, **TIMED | options)


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
    """At rest at 0 until 1 s, then down and at 2 s up: CW begins at 2 s, CW_CCW at 1 s."""
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


# --- periods ----------------------------------------------------------------------------------------------------------


def test_every_occurrence_of_the_reference_position_counts() -> None:
    """P = 360 and 710 is 350: trigger 10 - 50 + 360 = 320 is past, the next at 680, 3.3 s later; slave's S = 100."""
    given = steady(
        100.0, 6.0, on(0.5), position=660.0, master__period=360.0, slave__period=100.0, gear_in__reference_position=10.0
    )
    assert states(given) == [(0.5, WAITING_START), (3.8, GEAR_IN), (4.8, ACTIVE)]
    assert at(given, 4.3)["slave.position"] == close(9.375)
    assert at(given, 5.5)["slave.position"] == close(20.0)
    assert at(given, 1.0)["local.trigger_position"] == close(320.0)
    assert at(given, 1.0)["local.line_offset"] == close(-730.0)
    before, after = reference(given, [5.3])
    assert (before["slave.position"], after["slave.position"]) == (math.nextafter(100.0, 0.0), 0.0)


def test_downwards_through_the_end_of_a_turn() -> None:
    """P = 360, from 5 downwards: 10 + 50 is crossed at 60 - 360 = -300 after 3.05 s."""
    given = steady(
        -100.0,
        6.0,
        on(0.5),
        position=55.0,
        master__period=360.0,
        gear_in__reference_position=10.0,
        gear_in__start_mode=CW_CCW_POSITION,
    )
    assert states(given) == [(0.5, WAITING_START), (3.55, GEAR_IN), (4.55, ACTIVE)]
    assert at(given, 5.0)["slave.position"] == close(55.0 - 500.0 + 350.0)


@pytest.mark.parametrize(("velocity", "line"), [(100.0, 370.0), (-100.0, -350.0)])
def test_time_based_takes_the_occurrence_ahead(velocity: float, line: float) -> None:
    """Upwards from 20 the next 10 is 370, downwards from 0 it is -350."""
    position = 20.0 - velocity * 0.5 if velocity > 0 else 50.0
    given = steady(
        velocity,
        6.0,
        on(0.5),
        position=position,
        master__period=360.0,
        gear_in__reference_position=10.0,
        gear_in__start_mode=CW_CCW_POSITION,
        **TIMED,
    )
    master = position % 360.0 + velocity * 5.0
    shift = 360.0 if position < 0 else 0.0
    assert at(given, 5.0)["slave.position"] == close(master - line - shift)


def test_a_stop_position_with_a_slave_period() -> None:
    """S = 100: s = m - 100; off at 2.3 s with 130: 150 needs 150 - 50, past; 250 begins at 200, m = 300."""
    given = steady(
        100.0,
        6.0,
        on(0.25),
        off(2.3),
        gear_in__reference_position=100.0,
        slave__period=100.0,
        gear_out__stop_mode=4,
        gear_out__stop_position=50.0,
    )
    assert states(given)[3:] == [(2.3, WAITING_STOP), (3.0, GEAR_OUT), (4.0, STOPPED)]
    assert motion(at(given, 5.0)) == numbers(50.0, 0.0, 0.0, 0.0)
    assert at(given, 2.5)["local.trigger_position"] == close(300.0)
    assert at(given, 2.5)["in_gear"] == 0.0


# --- disengaging ------------------------------------------------------------------------------------------------------

ENGAGED: dict[str, Any] = {"gear_in__reference_position": 100.0}
"""With 100 u/s from 0 and an edge at 0.25 s: s = m - 100 from 1.5 s on."""


def engaged(*sets: dict[str, Any], duration: float = 6.0, **options: Any) -> dict[str, Any]:
    return steady(100.0, duration, on(0.25), *sets, **ENGAGED | options)


def test_direct_master_based_stop() -> None:
    """At 2 s from 100: u = 1/2 at 2.5 s, 100·(1/2 - 1/8 + 1/32) = 40.625; rest at 150."""
    given = engaged(off(2.0))
    assert states(given)[3:] == [(2.0, GEAR_OUT), (3.0, STOPPED)]
    assert motion(at(given, 2.5)) == numbers(140.625, 50.0, -150.0, 0.0)
    assert motion(at(given, 4.0)) == numbers(150.0, 0.0, 0.0, 0.0)


def test_direct_stop_without_transition() -> None:
    given = engaged(off(2.0, gear_out__transition=NONE))
    assert states(given)[3:] == [(2.0, STOPPED)]
    assert motion(at(given, 2.5)) == numbers(100.0, 0.0, 0.0, 0.0)


def test_a_direct_time_based_stop_over_runs_and_comes_back() -> None:
    """48/243·v·T beyond at a third of T."""
    given = engaged(off(2.0, gear_out__transition=TIME, gear_out__time=1.5))
    assert states(given)[3:] == [(2.0, GEAR_OUT), (3.5, STOPPED)]
    assert motion(at(given, 2.5))[:2] == numbers(100 + 150 * 48 / 243, 0.0)
    assert motion(at(given, 4.0)) == numbers(100.0, 0.0, 0.0, 0.0)


def test_a_direct_stop_waits_for_its_direction() -> None:
    """Up to 300 at 3 s, then down: CCW stops from 200 on."""
    segments = [{"duration": 3.0, "velocity": 100.0}, {"duration": 3.0, "velocity": -100.0}]
    for transition, stopped, rest in ((NONE, 3.0, 200.0), (MASTER, 4.0, 150.0), (TIME, 4.0, 200.0)):
        options = {"gear_out__stop_mode": CCW_DIRECT, "gear_out__transition": transition}
        given = scenario(segments, on(0.25), off(2.0), **ENGAGED, **options)
        assert states(given)[3] == (2.0, WAITING_STOP)
        assert states(given)[-1] == (stopped, STOPPED)
        assert motion(at(given, 2.5)) == numbers(150.0, 100.0, 0.0, 0.0)
        assert at(given, 5.0)["slave.position"] == close(rest)


@pytest.mark.parametrize(("transition", "begin", "end"), [(NONE, 3.5, 3.5), (MASTER, 3.0, 4.0)])
def test_at_a_stop_position(transition: int, begin: float, end: float) -> None:
    """250 is on the line at 350."""
    given = engaged(off(2.0), gear_out__transition=transition, gear_out__stop_mode=4, gear_out__stop_position=250.0)
    assert states(given)[3] == (2.0, WAITING_STOP)
    assert states(given)[4:] == ([(begin, GEAR_OUT)] if begin < end else []) + [(end, STOPPED)]
    assert motion(at(given, 5.0)) == numbers(250.0, 0.0, 0.0, 0.0)


def test_at_a_stop_position_downwards_with_a_negative_ratio() -> None:
    """s = -(m - 100); up to 400 at 4 s, down again: -250 is at 350, from 400 to 300."""
    segments = [{"duration": 4.5, "velocity": 100.0}, {"duration": 3.0, "velocity": -100.0}]
    options = {"gear_out__stop_mode": 5, "gear_out__stop_position": -250.0, "gearing__numerator": -1}
    given = scenario(segments, on(0.25), off(2.0), **ENGAGED, **options)
    assert states(given)[3:] == [(2.0, WAITING_STOP), (5.0, GEAR_OUT), (6.0, STOPPED)]
    assert at(given, 5.5)["slave.position"] == close(-300.0 + 40.625)
    assert at(given, 7.0)["slave.position"] == close(-250.0)


def test_a_stop_position_already_passed_keeps_the_slave_on_the_line() -> None:
    given = engaged(off(2.0), gear_out__stop_mode=4, gear_out__stop_position=120.0)
    assert states(given)[3:] == [(2.0, WAITING_STOP)]
    assert at(given, 5.0)["slave.position"] == close(400.0)


def test_a_time_based_stop_at_a_position() -> None:
    """From 50 below with 100 in 1 s: after half of it 25 below, and 5/32·100 further."""
    given = engaged(off(2.0), gear_out__transition=TIME, gear_out__stop_mode=4, gear_out__stop_position=150.0)
    assert states(given)[3:] == [(2.0, GEAR_OUT), (3.0, STOPPED)]
    assert at(given, 2.5)["slave.position"] == close(150.0 - 50 / 2 + 5 / 32 * 100)
    assert motion(at(given, 4.0)) == numbers(150.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("velocity", "numerator", "stop", "rest"),
    [
        (100.0, 1, 20.0, 120.0),
        (100.0, 1, 0.0, 100.0),
        (100.0, -1, 20.0, -180.0),
        (0.0, 1, 20.0, 120.0),
        (0.0, 1, 70.0, 70.0),
        (-100.0, 1, 20.0, 20.0),
    ],
)
def test_a_time_based_stop_with_a_slave_period(velocity: float, numerator: int, stop: float, rest: float) -> None:
    """At 100 (or -100) with S = 100, the master then at `velocity`."""
    segments = [{"duration": 2.0, "velocity": 100.0}, {"duration": 4.0, "velocity": velocity}]
    options = {"gear_out__transition": TIME, "gear_out__stop_mode": 6, "gear_out__stop_position": stop}
    given = scenario(segments, on(0.25), off(2.0), **ENGAGED, **options, gearing__numerator=numerator)
    given["start"]["slave.period"] = 100.0
    assert at(given, 5.0)["slave.position"] == close(rest % 100.0)
    middle = velocity * numerator * 5 / 32 + (rest + 100.0 * numerator) / 2
    assert at(given, 2.5)["slave.position"] == close(middle % 100.0)


def test_falling_back_in_gear_out() -> None:
    """Trigger 300 at 3 s, up to 330, back to 300 at 3.6 s and 290 at 3.7 s; again at 3.8 s."""
    segments = [
        {"duration": 3.3, "velocity": 100.0},
        {"duration": 0.4, "velocity": -100.0},
        {"duration": 3.0, "velocity": 100.0},
    ]
    options = {"gear_out__stop_mode": 4, "gear_out__stop_position": 250.0}
    given = scenario(segments, on(0.25), off(2.0), **ENGAGED, **options)
    expected = [(2.0, WAITING_STOP), (3.0, GEAR_OUT), (3.6, WAITING_STOP), (3.8, GEAR_OUT), (4.8, STOPPED)]
    assert states(given)[3:] == expected
    assert at(given, 3.65)["slave.position"] == close(195.0)
    assert at(given, 5.0)["slave.position"] == close(250.0)
    again = scenario(segments, on(0.25), off(2.0), on(3.4), **ENGAGED, **options)
    assert states(again)[5:] == [(3.6, ACTIVE)]


def test_a_direct_stop_keeps_its_trigger() -> None:
    """Begun at 200, back to it at 3 s, again at 3.4 s."""
    segments = [
        {"duration": 2.5, "velocity": 100.0},
        {"duration": 0.7, "velocity": -100.0},
        {"duration": 3.0, "velocity": 100.0},
    ]
    given = scenario(segments, on(0.25), off(2.0), **ENGAGED)
    assert states(given)[3:] == [(2.0, GEAR_OUT), (3.0, WAITING_STOP), (3.4, GEAR_OUT), (4.4, STOPPED)]
    assert at(given, 3.2)["slave.position"] == close(80.0)
    assert at(given, 5.0)["slave.position"] == close(150.0)


def test_a_stop_at_rest_takes_the_first_direction() -> None:
    """At 100, rest until 3 s, then down by D: 100 - 50."""
    segments = [{"duration": 2.0, "velocity": 100.0}, {"duration": 1.0}, {"duration": 2.0, "velocity": -100.0}]
    segments[1]["velocity"] = 0.0
    given = scenario(segments, on(0.25), off(2.5), **ENGAGED)
    assert states(given)[3:] == [(2.5, GEAR_OUT), (4.0, STOPPED)]
    assert (at(given, 2.9)["state"], at(given, 2.9)["slave.position"]) == (GEAR_OUT, close(100.0))
    assert at(given, 4.5)["slave.position"] == close(50.0)


# --- edges in each state ----------------------------------------------------------------------------------------------


def test_a_falling_edge_while_waiting() -> None:
    given = engaged(off(0.375))
    assert states(given) == [(0.25, WAITING_START), (0.375, STOPPED)]


def test_a_falling_edge_in_gear_in() -> None:
    """In the middle, 9.375 with 50: at rest at once; quintic; or first completed."""
    none = engaged(off(1.0, gear_out__transition=NONE))
    assert states(none)[2:] == [(1.0, STOPPED)]
    assert motion(at(none, 2.0)) == numbers(9.375, 0.0, 0.0, 0.0)
    timed = engaged(off(1.0, gear_out__transition=TIME, gear_out__time=2.0))
    assert states(timed)[2:] == [(1.0, GEAR_OUT), (3.0, STOPPED)]
    assert at(timed, 1.0 + 1e-9)["slave.acceleration"] == pytest.approx(150.0, rel=1e-6)
    assert at(timed, 2.0)["slave.position"] == close(9.375 + 5 / 32 * 100 + 150 * 4 / 64)
    assert motion(at(timed, 4.0)) == numbers(9.375, 0.0, 0.0, 0.0)
    placed = engaged(off(1.0, gear_out__transition=TIME, gear_out__stop_mode=4, gear_out__stop_position=-30.0))
    assert at(placed, 2.5)["slave.position"] == close(-30.0)
    master = engaged(off(1.0))
    assert states(master)[2:] == [(1.5, ACTIVE), (1.5, GEAR_OUT), (2.5, STOPPED)]
    assert at(master, 3.0)["slave.position"] == close(100.0)
    stop = engaged(off(1.0, gear_out__transition=NONE, gear_out__stop_mode=4, gear_out__stop_position=80.0))
    assert states(stop)[2:] == [(1.5, ACTIVE), (1.5, WAITING_STOP), (1.8, STOPPED)]


def test_a_falling_edge_in_gear_in_and_falling_back() -> None:
    segments = [{"duration": 1.0, "velocity": 100.0}, {"duration": 2.0, "velocity": -100.0}]
    given = scenario(segments, on(0.25), off(0.75), **ENGAGED)
    assert states(given) == [(0.25, WAITING_START), (0.5, GEAR_IN), (1.5, STOPPED)]


def test_waiting_edges_are_taken_back() -> None:
    given = engaged(off(0.75), on(1.0))
    assert states(given) == [(0.25, WAITING_START), (0.5, GEAR_IN), (1.5, ACTIVE)]
    stopped = engaged(off(2.0), on(2.25), off(2.5))
    assert states(stopped)[3:] == [(2.0, GEAR_OUT), (3.0, STOPPED)]


def test_a_rising_edge_while_waiting_to_stop() -> None:
    options = {"gear_out__stop_mode": 4, "gear_out__stop_position": 250.0}
    given = engaged(off(2.0), on(2.5), **options)
    assert states(given)[3:] == [(2.0, WAITING_STOP), (2.5, ACTIVE)]
    assert at(given, 5.0)["slave.position"] == close(400.0)


def test_a_rising_edge_in_gear_out_waits() -> None:
    """Rest at 150 at 3 s, the master at 300; then the curve to the line through (400, 150)."""
    given = engaged(off(2.0), on(2.5, gear_in__reference_position=400.0))
    expected = [(2.0, GEAR_OUT), (3.0, STOPPED), (3.0, WAITING_START), (3.5, GEAR_IN), (4.5, ACTIVE)]
    assert states(given)[3:] == expected
    assert at(given, 5.0)["slave.position"] == close(250.0)


def test_time_based_from_within_gear_out() -> None:
    """At 2.5 s at 140.625 with 50 and -150, the master at 250: onto the line through (300, 140.625) at 4.5 s."""
    given = engaged(off(2.0), on(2.5, gear_in__transition=TIME, gear_in__time=2.0, gear_in__reference_position=300.0))
    assert states(given)[3:] == [(2.0, GEAR_OUT), (2.5, GEAR_IN), (4.5, ACTIVE)]
    e, v, a = 50.0, -50.0, -150.0
    assert at(given, 3.5)["slave.position"] == close(190.625 + e / 2 + 5 / 32 * v * 2 + a * 4 / 64)
    assert at(given, 5.0)["slave.position"] == close(340.625)


# --- ratio changes ----------------------------------------------------------------------------------------------------

DOUBLE = {"gearing__numerator": 2}


def test_a_new_ratio_on_the_line_turns_it_about_the_present() -> None:
    """At (200, 100)."""
    given = engaged({"at": 2.0, **DOUBLE})
    assert motion(at(given, 3.0)) == numbers(300.0, 200.0, 0.0, 0.0)
    assert at(given, 3.0)["local.line_offset"] == close(-300.0)


def test_a_new_ratio_moves_a_stop_trigger() -> None:
    """From (200, 100) with 2: 300 is at 300, begun at 250."""
    options = {"gear_out__stop_mode": 4, "gear_out__stop_position": 300.0}
    given = engaged(off(1.75), {"at": 2.0, **DOUBLE}, **options)
    assert states(given)[3:] == [(1.75, WAITING_STOP), (2.5, GEAR_OUT), (3.5, STOPPED)]
    assert at(given, 4.0)["slave.position"] == close(300.0)


def test_a_new_ratio_in_master_based_gear_in_turns_the_curve() -> None:
    """In the middle at 9.375; s_a becomes -9.375: at the end -9.375 + 100, and rests there after falling back."""
    given = engaged({"at": 1.0, **DOUBLE})
    assert motion(at(given, 1.0 + 1e-9))[1] == pytest.approx(100.0, rel=1e-6)
    assert motion(at(given, 1.5)) == numbers(90.625, 200.0, 0.0, 0.0)
    assert at(given, 2.0)["slave.position"] == close(190.625)
    segments = [{"duration": 1.25, "velocity": 100.0}, {"duration": 2.0, "velocity": -100.0}]
    back = scenario(segments, on(0.25), {"at": 1.0, **DOUBLE}, **ENGAGED)
    assert motion(at(back, 2.5)) == numbers(-9.375, 0.0, 0.0, 0.0)


def test_a_new_ratio_in_time_based_gear_in_keeps_the_offset() -> None:
    """At half time on 48.75, the line at 60: then 60 + 2·(m - 200)."""
    given = time_based(40.0)
    given["set"].append({"at": 2.0, "gearing.numerator": 2})
    assert at(given, 2.0)["slave.position"] == close(48.75)
    assert at(given, 2.0 + 1e-9)["slave.position"] == pytest.approx(48.75, abs=1e-6)
    assert motion(at(given, 3.0)) == numbers(260.0, 200.0, 0.0, 0.0)


def test_a_new_ratio_while_waiting_and_in_gear_out() -> None:
    waiting = engaged({"at": 0.375, **DOUBLE})
    assert motion(at(waiting, 3.0)) == numbers(400.0, 200.0, 0.0, 0.0)
    leaving = engaged(off(2.0), {"at": 2.5, **DOUBLE})
    assert motion(at(leaving, 4.0)) == numbers(150.0, 0.0, 0.0, 0.0)
    again = engaged(off(2.0), {"at": 2.5, **DOUBLE}, on(2.75, gear_in__start_mode=CW_DIRECT, gear_in__transition=NONE))
    assert motion(at(again, 4.0)) == numbers(350.0, 200.0, 0.0, 0.0)


def test_a_new_ratio_in_gear_out_waits_for_the_next_engagement() -> None:
    """Back on the line, and from there by a rising edge in gear, the ratio is still 1; the next change acts."""
    segments = [{"duration": 2.5, "velocity": 100.0}, {"duration": 3.5, "velocity": -100.0}]
    given = scenario(segments, on(0.25), off(2.0), {"at": 2.25, **DOUBLE}, on(3.5), **ENGAGED)
    assert states(given)[4:] == [(3.0, WAITING_STOP), (3.5, ACTIVE)]
    assert motion(at(given, 4.0)) == numbers(0.0, -100.0, 0.0, 0.0)
    given["set"].append({"at": 4.0, "gearing.numerator": 3})
    assert motion(at(given, 5.0)) == numbers(-300.0, -300.0, 0.0, 0.0)


def test_a_new_ratio_while_waiting_keeps_the_synchronous_point() -> None:
    """(200, 100) is saved, the slave rests at 150: m_a is 250, with the ratio 2 it is 225, met downwards at 5.75 s."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 4.0, "velocity": -100.0}]
    again = on(3.5, gear_in__start_mode=CONTINUE, gear_in__transition=NONE)
    given = scenario(segments, on(0.25), off(2.0), again, {"at": 3.75, **DOUBLE}, **ENGAGED)
    assert states(given)[5:] == [(3.5, WAITING_START), (5.75, ACTIVE)]
    assert motion(at(given, 6.25)) == numbers(50.0, -200.0, 0.0, 0.0)


# --- activate, reset --------------------------------------------------------------------------------------------------


def test_not_active_the_slave_stands_and_continues_in_stopped() -> None:
    """At 100; edges of start are lost."""
    given = engaged({"at": 2.0, "activate": False}, off(2.25), on(2.5), {"at": 3.0, "activate": True})
    frozen = at(given, 2.75)
    assert motion(frozen) == numbers(100.0, 0.0, 0.0, 0.0)
    assert frozen["state"] == ACTIVE
    assert (at(given, 3.5)["state"], at(given, 3.5)["slave.position"]) == (STOPPED, close(100.0))
    assert states(given)[3:] == [(3.0, STOPPED)]


def test_leaving_by_activate_saves_the_pair() -> None:
    """(200, 100); from above, 400, down onto that line."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 3.0, "velocity": -100.0}]
    sets = [{"at": 2.0, "activate": False, "start": False}, {"at": 3.0, "activate": True}]
    sets.append(on(3.5, gear_in__start_mode=CONTINUE, gear_in__transition=NONE))
    given = scenario(segments, on(0.25), *sets, **ENGAGED)
    assert states(given)[-1] == (6.0, ACTIVE)
    assert at(given, 6.5)["slave.position"] == close(50.0)


def test_reset_acts_only_while_not_active() -> None:
    sets = [{"at": 2.0, "reset": True}, {"at": 2.5, "activate": False, "reset": False}, {"at": 3.0, "reset": True}]
    given = engaged(*sets)
    assert [at(given, time)["state"] for time in (2.25, 2.75, 3.25)] == [ACTIVE, ACTIVE, STOPPED]
    assert motion(at(given, 3.25)) == numbers(150.0, 0.0, 0.0, 0.0)


# --- faults -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "error_id"),
    [
        ({"gearing__denominator": 0, "gearing__numerator": 0}, 1),
        ({"gearing__numerator": 0}, 2),
        ({"gear_in__time": 0.0, "gear_in__transition": TIME}, 3),
        ({"gear_in__distance": -1.0}, 4),
        ({"gear_in__distance": -1.0, "gear_in__time": -1.0, "gear_in__transition": TIME}, 3),
    ],
)
def test_a_refused_start(values: dict[str, Any], error_id: int) -> None:
    good = {"gearing__denominator": 1, "gearing__numerator": 1, "gear_in__transition": NONE, "gear_in__distance": 1.0}
    given = steady(100.0, 4.0, on(0.5, **values), off(1.0), on(1.5, **good), gear_in__start_mode=CW_DIRECT)
    for time in (0.75, 1.25):
        row = at(given, time)
        assert (row["state"], row["error"], row["error_id"]) == (STOPPED, 1.0, error_id)
    assert (at(given, 1.75)["state"], at(given, 1.75)["error_id"]) == (ACTIVE, 0.0)


@pytest.mark.parametrize(("name", "error_id"), [("gear_out__time", 3), ("gear_out__distance", 4)])
def test_a_refused_stop_needs_new_edges(name: str, error_id: int) -> None:
    given = engaged(off(2.0, gear_out__transition=TIME, **{name: -1.0}), on(3.0, **{name: 1.0}), off(4.0))
    assert (at(given, 2.5)["state"], at(given, 2.5)["error_id"]) == (ACTIVE, error_id)
    assert at(given, 3.5)["error_id"] == error_id
    assert (at(given, 4.5)["state"], at(given, 4.5)["error_id"]) == (GEAR_OUT, 0.0)


@pytest.mark.parametrize(("name", "error_id"), [("gearing__denominator", 1), ("gearing__numerator", 2)])
def test_a_ratio_of_zero_is_not_taken(name: str, error_id: int) -> None:
    given = engaged({"at": 2.0, name: 0}, {"at": 3.0, "activate": False}, {"at": 4.0, "reset": True})
    row = at(given, 2.5)
    assert (row["state"], row["error_id"], row["slave.position"]) == (ACTIVE, error_id, close(150.0))
    assert (at(given, 3.5)["error_id"], at(given, 4.5)["error_id"]) == (error_id, 0.0)


def test_wrong_start_values_and_scripts_are_refused() -> None:
    for wrong in ({"gearing__denominator": 0}, {"gear_out__distance": -1.0}, {"gear_in__time": 0.0}):
        with pytest.raises(ValueError, match="refused"):
            events(steady(1.0, 1.0, gear_in__transition=TIME, **wrong))
    with pytest.raises(ValueError, match="never an edge"):
        events(steady(1.0, 1.0, on(0.0)))
    with pytest.raises(ValueError, match="stort"):
        events(steady(1.0, 1.0, {"at": 0.5, "stort": True}))


def test_members_may_be_named() -> None:
    """Without transition at 100."""
    named = {"gear_in__start_mode": "WITH_CW_REFERENCE_POSITION", "gear_out__stop_mode": "CW_CCW_DIRECT"}
    given = engaged({"at": 0.375, "gear_out__transition": "NONE"}, off(2.0), gear_in__transition="NONE", **named)
    assert states(given)[1:] == [(1.0, ACTIVE), (2.0, STOPPED)]


# --- as a whole -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(10))
def test_on_random_scripts_the_slave_moves_as_its_derivatives_say(seed: int) -> None:
    """The position joins everywhere; between jumps of the master, velocity and acceleration are its derivatives."""
    chance = random.Random(seed)
    segments = [{"duration": 1.0, "acceleration": chance.uniform(-300, 300)} for _ in range(8)]
    sets = [{"at": 0.37 + 0.61 * i, "start": i % 2 == 0} for i in range(12)]
    for table in sets:
        modes = {"gear_in__start_mode": chance.randint(1, 7), "gear_out__stop_mode": chance.randint(1, 6)}
        modes |= {f"{group}__transition": chance.randint(2, 3) for group in ("gear_in", "gear_out")}
        modes |= {"gear_in__reference_position": chance.uniform(0, 300), "gear_in__distance": chance.uniform(5, 80)}
        modes |= {"gear_out__stop_position": chance.uniform(0, 300), "gear_out__distance": chance.uniform(5, 80)}
        table.update(modes)
    periods = {"master__period": 300.0} if seed % 2 else {}
    given = scenario(segments, *sets, velocity=chance.uniform(-100, 100), gearing__numerator=2, **periods)
    entered = {state for _, state in states(given)}
    assert GEAR_IN in entered
    breaks = sorted({time for time, _ in events(given)} | {float(i) for i in range(1, 8)})
    centres = [time for i in range(1, 160) if all(abs((time := 0.05 * i) - other) > 2e-6 for other in breaks)]
    rows = reference(given, [time + shift for time in centres for shift in (-1e-6, 0.0, 1e-6)])
    for early, row, late in zip(rows[::3], rows[1::3], rows[2::3], strict=True):
        for name, rate in (("position", "velocity"), ("velocity", "acceleration")):
            difference = (late[f"slave.{name}"] - early[f"slave.{name}"]) / 2e-6
            assert difference == pytest.approx(row[f"slave.{rate}"], rel=1e-5, abs=1e-2)
    for time in breaks:
        early, late = (at(given, time + shift)["slave.position"] for shift in (-1e-8, 1e-8))
        speed = max(abs(at(given, time + shift)["slave.velocity"]) for shift in (-1e-8, 1e-8))
        assert late == pytest.approx(early, abs=1e-9 + 3e-8 * speed)
