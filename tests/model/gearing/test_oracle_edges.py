"""The Gearing's oracle against numbers worked out by hand: edges, ratio changes, activate and reset, faults."""

import random
from typing import Any

import pytest

from tests.model.gearing.oracle_cases import (
    ACTIVE,
    CONTINUE,
    CW_DIRECT,
    ENGAGED,
    GEAR_IN,
    GEAR_OUT,
    NONE,
    STOPPED,
    TIME,
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
    time_based,
)
from tests.oracle.gearing import events, reference

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


def test_not_active_the_slave_rests_and_continues_in_stopped() -> None:
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
    accepted = {
        "gearing__denominator": 1,
        "gearing__numerator": 1,
        "gear_in__transition": NONE,
        "gear_in__distance": 1.0,
    }
    given = steady(100.0, 4.0, on(0.5, **values), off(1.0), on(1.5, **accepted), gear_in__start_mode=CW_DIRECT)
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
