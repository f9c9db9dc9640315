"""The Gearing's oracle against numbers worked out by hand: periods, and disengaging."""

import math

import pytest

from tests.model.gearing.oracle_cases import (
    ACTIVE,
    CCW_DIRECT,
    CW_CCW_POSITION,
    ENGAGED,
    GEAR_IN,
    GEAR_OUT,
    MASTER,
    NONE,
    STOPPED,
    TIME,
    TIMED,
    WAITING_START,
    WAITING_STOP,
    at,
    close,
    engaged,
    motion,
    numbers,
    off,
    on,
    scenario,
    states,
    steady,
)
from tests.oracle.gearing import reference

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
    """S = 100: s = m - 100; off at 2.3 s with 130: 150 needs 150 - 50, past; 250 starts at 200, m = 300."""
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
