"""The Synchronizer's oracle against numbers worked out by hand: the laws, the commands, the states."""

import math
from typing import Any

import mpmath  # type: ignore[import-untyped]
import pytest

from tests.oracle.synchronizer import events, reference

PARABOLA, POLYNOMIAL = 1, 2
READY, EXECUTING, STACKED = 0.0, 1.0, 2.0


def scenario(
    segments: list[dict[str, float]], *sets: dict[str, Any], position: float = 0.0, **start: Any
) -> dict[str, Any]:
    """A scenario of the segments' length; `start` names have `__` for a dot."""
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.001,
        "start": {name.replace("__", "."): value for name, value in start.items()},
        "master": {"position": position, "velocity": segments[0].get("velocity", 0.0), "segments": segments},
        "set": list(sets),
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """A master of constant velocity."""
    return scenario([{"duration": duration, "velocity": velocity}], *sets, **options)


def resting(rest_value: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """With `active=False` at first: at 0.5 s the slave rests at `rest_value`, active and READY."""
    return {"at": 0.25, "stop": True, "rest_value": rest_value}, {"at": 0.5, "active": True, "stop": False}


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(given, [time])[-1]


def named(given: dict[str, Any], name: str) -> list[float]:
    return [time for time, event in events(given) if event == name]


def close(value: float) -> Any:
    return pytest.approx(value, rel=1e-13, abs=1e-13)


# --- results of ramps: rest 180, period 360, master at 90 deg/s ---


def ramp_script(curve: int, phasing: float, command: str, direction: int = 1) -> dict[str, Any]:
    """A command at 1 s, one Δs and more before its ramp; the master passes the rest position 180 at 5 s."""
    options = {"curve": curve, "output_phasing": phasing, "master__period": 360.0, "position": 180.0 - direction * 450}
    if command == "start":
        first, second = resting(180.0)
        return steady(90.0 * direction, 9.0, first, second, {"at": 2.0, "start": True}, active=False, **options)
    return steady(90.0 * direction, 9.0, {"at": 2.0, "stop": True, "rest_value": 180.0}, **options)


@pytest.mark.parametrize(
    ("curve", "phasing", "command", "expected"),
    [
        (PARABOLA, 90.0, "start", (90.0, 270.0, 202.5, 270.0)),
        (PARABOLA, 90.0, "stop", (90.0, 270.0, 157.5, 180.0)),
        (PARABOLA, 180.0, "start", (0.0, 0.0, 225.0, 0.0)),
        (PARABOLA, 180.0, "stop", (0.0, 0.0, 135.0, 180.0)),
        (POLYNOMIAL, 90.0, "start", (101.25, 270.0, 195.6103111111111, 270.0)),
        (POLYNOMIAL, 90.0, "stop", (90.0, 258.75, 164.3896888888889, 180.0)),
        (PARABOLA, -90.0, "start", (270.0, 90.0, 157.5, 90.0)),
        (PARABOLA, -90.0, "stop", (270.0, 90.0, 202.5, 180.0)),
        (POLYNOMIAL, -90.0, "start", (258.75, 90.0, 164.3896888888889, 90.0)),
        (POLYNOMIAL, -90.0, "stop", (270.0, 101.25, 195.6103111111111, 180.0)),
    ],
)
def test_ramp_results(curve: int, phasing: float, command: str, expected: tuple[float, float, float, float]) -> None:
    """`expected`: where the ramp starts and ends, the slave at the rest position and at the end."""
    begin, end, middle, ends_at = expected
    direction = math.copysign(1.0, phasing)
    given = ramp_script(curve, phasing, command, int(direction))
    size = abs(phasing)
    before = size * 7 / 8 if (curve, command) == (POLYNOMIAL, "start") else size
    after = size * 7 / 8 if (curve, command) == (POLYNOMIAL, "stop") else size
    starts, ends = 5.0 - before / 90.0, 5.0 + after / 90.0
    assert named(given, "ramp starts") == [pytest.approx(starts, abs=1e-12)]
    assert named(given, f"completed {command}") == [pytest.approx(ends, abs=1e-8)]
    row = at(given, 5.0)
    assert row["slave.position"] == close(middle)
    assert (row["local.ramp_begin"], row["local.ramp_end"]) == (close(begin), close(end))
    assert row["local.transition_distance"] == close(before + after)
    assert row["local.progress"] == close(before / (before + after))
    assert (row["local.distance_to_begin"], row["local.distance_to_end"]) == (0.0, close(after))
    assert (row["state_code"], row["syn_ramp_on"], row["status"]) == (EXECUTING, 1.0, 2.0)
    assert row["synchronized"] == (1.0 if command == "stop" else 0.0)
    done = at(given, ends)
    assert done["slave.position"] == close(ends_at)
    assert done["slave.velocity"] == (90.0 * direction if command == "start" else 0.0)
    assert (done["state_code"], done["ready"], done["local.progress"]) == (READY, 1.0, 1.0)
    assert (done["local.distance_to_begin"], done["local.distance_to_end"]) == (0.0, 0.0)
    assert done["status"] == (1.0 if command == "start" else 0.0)
    assert (done["local.ramp_begin"], done["local.ramp_end"]) == (close(begin), close(end))


def test_peak_values_are_reached_at_constant_master_speed() -> None:
    parabola, polynomial = (
        at(ramp_script(PARABOLA, 90.0, "start"), 5.0),
        at(ramp_script(POLYNOMIAL, 90.0, "start"), 5.0),
    )
    assert parabola["local.peak_acceleration_per_v2"] == close(1 / 180)
    assert parabola["slave.acceleration"] == close(90.0**2 / 180)
    assert (parabola["slave.jerk"], parabola["local.peak_jerk_per_v3"]) == (0.0, 0.0)
    ratio = polynomial["local.peak_acceleration_per_v2"] / parabola["local.peak_acceleration_per_v2"]
    assert ratio == pytest.approx(1.64224, abs=5e-6)
    assert polynomial["local.peak_jerk_per_v3"] == close(512 / 225 / 90**2)
    peak_at = 5.0 - 78.75 / 90 + 337.5 / 90 * (1 - 1 / math.sqrt(3)) / 2  # f'' is largest at z = (1 - 1/√3)/2
    assert at(ramp_script(POLYNOMIAL, 90.0, "start"), peak_at)["slave.acceleration"] == close(
        45.0 * 128 / 135 * math.sqrt(3)
    )


@pytest.mark.parametrize(("command", "starts", "ends"), [("start", 4.125, 6.0), ("stop", 4.0, 5.875)])
def test_the_polynomial_has_its_peak_jerk_at_the_slow_end(command: str, starts: float, ends: float) -> None:
    given = ramp_script(POLYNOMIAL, 90.0, command)
    before, after = reference(given, [starts])
    peak = 512 / 225 * 90.0
    if command == "start":
        assert (before["slave.jerk"], after["slave.jerk"]) == (0.0, close(peak))
        assert (before["syn_ramp_on"], after["syn_ramp_on"]) == (0.0, 1.0)
    just_before = at(given, ends - 1e-6)["slave.jerk"]
    assert just_before == pytest.approx(peak if command == "stop" else -peak / 2, rel=1e-5)


def test_the_first_and_last_value_of_a_start() -> None:
    given = ramp_script(PARABOLA, 90.0, "start")
    assert at(given, 4.0)["slave.position"] == close(180.0)
    assert at(given, 4.0)["slave.velocity"] == close(0.0)
    assert at(given, 6.0)["slave.position"] == close(270.0)
    assert at(given, 6.0)["slave.velocity"] == close(90.0)


def test_initially_the_slave_is_the_master() -> None:
    (row,) = reference(steady(90.0, 1.0, position=370.0, master__period=360.0), [0.0])
    assert row["slave.position"] == close(10.0)
    assert (row["state_code"], row["synchronized"], row["status"], row["error_id"]) == (READY, 1.0, 1.0, 0.0)
    assert [value for name, value in row.items() if name.startswith("local.")] == [0.0] * 8


# --- stacked commands -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [360.0, 0.1, 0.7, 6.2, 7.7])
@pytest.mark.parametrize("part", [0.5, 0.3])
def test_a_stop_stacked_on_a_start_follows_without_a_gap(period: float, part: float) -> None:
    """Δs = P/2: the stop starts where the start ended. The master travels one period in 4 s, x_b is passed at 2 s."""
    half, rest = period / 2, part * period
    sets = (*resting(rest), {"at": 1.0, "start": True}, {"at": 3.0, "stop": True})
    options = {"position": rest - 2 * half, "output_phasing": half, "master__period": period, "active": False}
    given = steady(period / 4, 11.0, *sets, curve=PARABOLA, **options)
    assert at(given, 3.0)["state_code"] == STACKED
    assert at(given, 5.0)["state_code"] == STACKED
    assert at(given, 6.0)["state_code"] == EXECUTING
    assert at(given, 6.0)["slave.velocity"] == pytest.approx(period / 4, rel=1e-7)
    # a quarter into the stop y = y0 - 2Δ·2·(3/8)², half way y0 - 2Δ·2·(1/4)²
    assert at(given, 7.0)["slave.position"] == pytest.approx((rest - half * 9 / 16) % period, rel=1e-9)
    assert at(given, 7.0)["syn_ramp_on"] == 1.0
    assert at(given, 8.0)["slave.position"] == pytest.approx((rest - half / 4) % period, rel=1e-9)
    assert at(given, 10.5)["state_code"] == READY
    assert at(given, 10.5)["synchronized"] == 0.0
    assert at(given, 10.5)["slave.position"] == pytest.approx(rest, rel=1e-12)
    names = [name for _, name in events(given)][2:]
    assert names == [
        *("command start accepted", "ramp starts", "command stop stacked", "completed start"),
        *("taken up stop", "ramp starts", "completed stop"),
    ]


def test_a_stacked_start_takes_its_rest_position_from_the_stop() -> None:
    sets = ({"at": 0.5, "stop": True, "rest_value": 180.0}, {"at": 1.5, "start": True, "rest_value": 33.0})
    given = steady(90.0, 9.0, *sets, curve=PARABOLA, master__period=360.0)
    assert named(given, "taken up start") == [pytest.approx(3.0, abs=1e-8)]
    assert at(given, 4.0)["slave.position"] == close(180.0)
    assert at(given, 6.0)["slave.position"] == close(202.5)  # 450 … 630, at 540 as in the ramp_script results
    assert named(given, "completed start") == [pytest.approx(7.0, abs=1e-8)]


def test_only_one_command_is_stacked_and_others_are_ignored() -> None:
    sets = (
        {"at": 0.1, "stop": True, "rest_value": 180.0},
        {"at": 0.2, "stop": False},
        {"at": 0.3, "stop": True, "rest_value": 10.0},
        {"at": 0.4, "start": True},
        {"at": 0.5, "stop": False, "start": False},
        {"at": 0.6, "stop": True, "start": True, "output_phasing": 0.0},
    )
    given = steady(90.0, 8.0, *sets, curve=PARABOLA)
    assert [name for _, name in events(given)][:5] == [
        *("command stop accepted", "command stop ignored", "command start stacked"),
        *("command start ignored", "command stop ignored"),
    ]
    assert at(given, 0.6)["error_id"] == 0.0
    assert at(given, 5.0)["slave.position"] == close(180.0)  # no period: the start's x_b was passed during the stop
    assert at(given, 5.0)["state_code"] == EXECUTING


def test_start_and_stop_at_once_act_in_this_order() -> None:
    given = steady(90.0, 2.0, {"at": 0.5, "start": True, "stop": True, "rest_value": 180.0}, curve=PARABOLA)
    assert events(given)[:2] == [(0.5, "command start ignored"), (0.5, "command stop accepted")]
    sets = (*resting(180.0), {"at": 0.75, "start": True, "stop": True, "rest_value": 20.0})
    assert at(steady(90.0, 2.0, *sets, curve=PARABOLA, active=False), 0.75)["state_code"] == STACKED


def test_a_stacked_command_may_have_the_other_direction() -> None:
    """Stop to 180 forwards (90 … 270), then a start with Δs -90 from 270 backwards to 90, at 90 deg/s."""
    sets = ({"at": 0.5, "stop": True, "rest_value": 180.0}, {"at": 2.0, "start": True, "output_phasing": -90.0})
    segments = [{"duration": 4.0, "velocity": 90.0}, {"duration": 4.0, "velocity": -90.0}]
    given = scenario(segments, *sets, curve=PARABOLA)
    waiting = at(given, 3.5)
    assert (waiting["state_code"], waiting["slave.position"]) == (EXECUTING, 180.0)
    assert waiting["local.distance_to_begin"] == close(45.0)  # not armed: the way back to x_b = -270 from x = -315
    assert waiting["local.distance_to_end"] == close(225.0)
    assert named(given, "armed") == []  # taken up at m_e = 270, which is its own x_b
    assert named(given, "ramp starts") == [1.0, pytest.approx(5.0, abs=1e-12)]
    assert at(given, 6.0)["slave.position"] == close(157.5)
    assert named(given, "completed start") == [pytest.approx(7.0, abs=1e-8)]


# --- waiting ----------------------------------------------------------------------------------------------------------


def test_a_command_given_too_late_waits_one_period() -> None:
    given = steady(90.0, 9.0, {"at": 1.25, "stop": True, "rest_value": 180.0}, curve=PARABOLA, master__period=360.0)
    row = at(given, 3.0)  # master at 270, the ramp 90 … 270 of this turn is missed, 450 … 630 aimed at
    assert (row["state_code"], row["slave.position"], row["syn_ramp_on"]) == (EXECUTING, 270.0, 0.0)
    assert (row["local.ramp_begin"], row["local.ramp_end"], row["local.progress"]) == (90.0, 270.0, 0.0)
    assert (row["local.distance_to_begin"], row["local.distance_to_end"]) == (180.0, 360.0)
    assert named(given, "ramp starts") == [pytest.approx(5.0, abs=1e-12)]
    assert at(given, 6.0)["slave.position"] == close(157.5)
    assert named(given, "completed stop") == [pytest.approx(7.0, abs=1e-8)]
    assert at(given, 8.0)["slave.position"] == close(180.0)


def test_a_command_given_exactly_at_its_begin_starts_at_once() -> None:
    for period in (0.0, 360.0):
        sets = ({"at": 1.0, "stop": True, "rest_value": 180.0},)
        given = steady(90.0, 4.0, *sets, curve=PARABOLA, master__period=period)
        assert named(given, "ramp starts") == [1.0]
        before, after = reference(given, [1.0])
        assert (before["state_code"], after["state_code"], after["syn_ramp_on"]) == (READY, EXECUTING, 1.0)
        assert (before["slave.position"], after["slave.position"]) == (90.0, 90.0)
        assert (before["slave.acceleration"], after["slave.acceleration"]) == (0.0, -45.0)


def test_a_late_command_without_period_waits_until_the_master_comes_back() -> None:
    """Given at 100; the master goes to 190, back to 10 and up again at 90 deg/s."""
    segments = [{"duration": d, "velocity": v} for d, v in ((2.0, 90.0), (2.0, -90.0), (4.0, 90.0))]
    sets = ({"at": 1.0, "stop": True, "rest_value": 180.0},)
    given = scenario(segments, *sets, position=10.0, curve=PARABOLA)
    late = at(given, 1.5)  # master at 145
    assert (late["state_code"], late["slave.position"], late["local.progress"]) == (EXECUTING, 145.0, 0.0)
    assert (late["local.distance_to_begin"], late["local.distance_to_end"]) == (55.0, 235.0)
    assert named(given, "armed") == [pytest.approx(2.0 + 100 / 90, abs=1e-8)]
    armed = at(given, 3.5)  # master at 55
    assert (armed["local.distance_to_begin"], armed["local.distance_to_end"]) == (35.0, 215.0)
    assert named(given, "ramp starts") == [pytest.approx(4.0 + 80 / 90, abs=1e-12)]
    assert at(given, 4.0 + 170 / 90)["slave.position"] == close(157.5)
    assert at(given, 7.5)["slave.position"] == close(180.0)


def test_a_late_command_is_armed_by_a_turning_point_at_its_begin() -> None:
    """The master's parabola m = 90 + 20·(t - 3)² touches x_b = 90 at 3 s; the stop is given at 110."""
    given = scenario([{"duration": 7.0, "acceleration": 40.0}], {"at": 2.0, "stop": True, "rest_value": 180.0})
    given["start"]["curve"] = PARABOLA
    given["master"] |= {"position": 270.0, "velocity": -120.0}
    assert named(given, "armed") == [pytest.approx(3.0, abs=1e-4)]
    assert named(given, "ramp starts") == [pytest.approx(3.0, abs=1e-4)]
    assert at(given, 3.0 + math.sqrt(4.5))["slave.position"] == close(157.5)
    assert at(given, 6.5)["slave.position"] == close(180.0)


def test_a_command_against_the_masters_direction_waits_for_ever() -> None:
    given = steady(-90.0, 100.0, {"at": 1.0, "stop": True, "rest_value": 180.0}, master__period=360.0)
    assert events(given) == [(1.0, "command stop accepted")]
    row = at(given, 99.99)
    assert (row["state_code"], row["syn_ramp_on"], row["slave.velocity"]) == (EXECUTING, 0.0, -90.0)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("period", [0.0, 360.0])
def test_where_the_master_passes_the_begin_against_the_sign_nothing_happens(curve: int, period: float) -> None:
    """The stop's x_b is 90, which the master passes at 1 s, downwards."""
    sets = ({"at": 0.5, "stop": True, "rest_value": 180.0},)
    given = steady(-90.0, 2.0, *sets, position=180.0, curve=curve, master__period=period)
    rows = reference(given, [1.0])
    assert {(row["slave.position"], row["slave.acceleration"], row["syn_ramp_on"]) for row in rows} == {
        (90.0, 0.0, 0.0)
    }


def test_a_waiting_command_aims_at_each_occurrence_passed_backwards() -> None:
    """x_b = 90 + 360·n; from 0 the master falls to -900 and rises again at 90 deg/s."""
    segments = [{"duration": 10.0, "velocity": -90.0}, {"duration": 10.0, "velocity": 90.0}]
    sets = ({"at": 1.0, "stop": True, "rest_value": 180.0},)
    given = scenario(segments, *sets, curve=PARABOLA, master__period=360.0)
    assert at(given, 2.0)["local.distance_to_begin"] == close(270.0)
    assert at(given, 2.9)["local.distance_to_begin"] == close(351.0)
    assert at(given, 3.1)["local.distance_to_begin"] == close(9.0)  # -279, aimed at -270
    assert at(given, 8.0)["local.distance_to_begin"] == close(90.0)  # -720, aimed at -630
    assert named(given, "ramp starts") == [pytest.approx(13.0, abs=1e-12)]
    assert at(given, 14.0)["slave.position"] == close(157.5)


# --- the master reverses -------------------------------------------------------------------------------------------


def reversing(period: float) -> dict[str, Any]:
    """A start from 180 (90 … 270): up to 180 at 3 s, down to 0 at 5 s, up again."""
    segments = [{"duration": d, "velocity": v} for d, v in ((3.0, 90.0), (2.0, -90.0), (4.0, 90.0))]
    options = {"position": -90.0, "curve": PARABOLA, "active": False, "master__period": period}
    return scenario(segments, *resting(180.0), {"at": 1.0, "start": True}, **options)


@pytest.mark.parametrize("period", [0.0, 360.0])
def test_after_a_reversal_the_slave_goes_down_the_same_curve_and_rests(period: float) -> None:
    given = reversing(period)
    assert at(given, 2.5)["slave.position"] == close(185.625)  # 180 + 360·(45/360)²
    assert at(given, 3.5)["slave.position"] == close(185.625)
    assert (at(given, 2.5)["slave.velocity"], at(given, 3.5)["slave.velocity"]) == (close(22.5), close(-22.5))
    assert at(given, 3.5)["slave.acceleration"] == close(45.0)
    assert named(given, "ramp left backwards") == [pytest.approx(4.0, abs=1e-12)]
    below = at(given, 4.5)
    assert (below["slave.position"], below["slave.velocity"]) == (180.0, 0.0)
    assert (below["state_code"], below["syn_ramp_on"], below["local.distance_to_begin"]) == (EXECUTING, 0.0, 45.0)
    assert named(given, "ramp starts") == [pytest.approx(2.0, abs=1e-12), pytest.approx(6.0, abs=1e-12)]
    assert named(given, "completed start") == [pytest.approx(8.0, abs=1e-8)]


def test_a_reversal_inside_the_ramp_does_not_end_the_command() -> None:
    segments = [{"duration": d, "velocity": v} for d, v in ((2.0, 90.0), (0.5, -90.0), (1.0, 0.0), (4.0, 90.0))]
    given = scenario(segments, {"at": 0.5, "stop": True, "rest_value": 180.0}, curve=PARABOLA, master__period=360.0)
    assert at(given, 2.0)["slave.position"] == close(157.5)
    standing = at(given, 3.0)  # master at 135
    assert (standing["slave.position"], standing["slave.velocity"]) == (close(180 - 360 * (135 / 360) ** 2), 0.0)
    assert (standing["syn_ramp_on"], standing["local.progress"]) == (1.0, close(0.25))
    assert named(given, "completed stop") == [pytest.approx(5.0, abs=1e-8)]
    assert named(given, "ramp left backwards") == []


def test_a_stop_left_backwards_is_the_master_again() -> None:
    segments = [{"duration": d, "velocity": v} for d, v in ((2.0, 90.0), (1.5, -90.0))]
    given = scenario(segments, {"at": 0.5, "stop": True, "rest_value": 180.0}, curve=POLYNOMIAL)
    row = at(given, 3.25)
    assert (row["slave.position"], row["slave.velocity"], row["status"]) == (67.5, -90.0, 1.0)


def test_a_master_that_only_touches_the_begin_ramps_for_that_instant() -> None:
    """m = 90 - 40·(t - 1)² touches x_b = 90 at 1 s."""
    segments = [{"duration": 2.0, "acceleration": -80.0}]
    given = scenario(segments, {"at": 0.5, "stop": True, "rest_value": 180.0}, position=50.0, curve=PARABOLA)
    given["master"] |= {"velocity": 80.0}
    assert [name for _, name in events(given)][1:] == ["ramp starts", "ramp left backwards"]
    assert [row["syn_ramp_on"] for row in reference(given, [0.9, 1.0, 1.1])] == [0.0, 0.0, 1.0, 0.0]


# --- other rules ------------------------------------------------------------------------------------------------------


def test_a_transition_longer_than_the_period_spans_several_turns() -> None:
    """P 100, Δs 180, rest 30: x_b = -150 + 100·n. Given at -60: -50 … 310, resting at 130."""
    sets = ({"at": 0.4, "stop": True, "rest_value": 30.0},)
    given = steady(100.0, 5.0, *sets, position=-100.0, output_phasing=180.0, curve=PARABOLA, master__period=100.0)
    assert named(given, "ramp starts") == [pytest.approx(0.5, abs=1e-12)]
    assert at(given, 2.3)["slave.position"] == close(85.0)  # 130 - Δ/4
    assert (at(given, 2.3)["local.ramp_begin"], at(given, 2.3)["local.ramp_end"]) == (close(50.0), close(10.0))
    assert named(given, "completed stop") == [pytest.approx(4.1, abs=1e-8)]
    assert at(given, 4.5)["slave.position"] == close(30.0)


def test_a_deactivation_while_executing_completes_the_command_at_once() -> None:
    sets = ({"at": 1.0, "stop": True, "rest_value": 180.0}, {"at": 2.0, "active": False})
    before, after = reference(steady(90.0, 4.0, *sets, curve=PARABOLA), [2.0])
    assert (before["slave.position"], before["slave.velocity"], before["state_code"]) == (close(157.5), 45.0, EXECUTING)
    assert (after["slave.position"], after["slave.velocity"], after["slave.acceleration"]) == (180.0, 0.0, 0.0)
    assert (after["state_code"], after["synchronized"], after["syn_ramp_on"]) == (READY, 0.0, 0.0)
    assert (after["local.progress"], after["local.distance_to_end"]) == (close(0.5), 0.0)
    assert (after["local.ramp_begin"], after["local.ramp_end"]) == (90.0, 270.0)


def test_a_deactivation_while_stacked_leaves_what_both_commands_would() -> None:
    stop, start = {"at": 1.0, "stop": True, "rest_value": 180.0}, {"at": 2.0, "start": True}
    given = steady(90.0, 4.0, stop, start, {"at": 2.5, "active": False}, curve=PARABOLA)
    assert at(given, 2.5)["slave.position"] == close(225.0)
    assert (at(given, 2.5)["synchronized"], at(given, 2.5)["slave.velocity"]) == (1.0, 90.0)
    sets = (*resting(180.0), {"at": 1.0, "start": True}, {"at": 2.0, "stop": True, "rest_value": 33.0})
    given = steady(90.0, 4.0, *sets, {"at": 2.5, "active": False}, curve=PARABOLA, active=False)
    assert at(given, 2.0)["state_code"] == STACKED
    assert (at(given, 2.5)["slave.position"], at(given, 2.5)["state_code"]) == (33.0, READY)
    given = steady(90.0, 4.0, stop, start, {"at": 2.5, "active": False}, {"at": 3.0, "active": True}, curve=PARABOLA)
    assert at(given, 3.5)["slave.position"] == close(315.0)


def test_inactive_commands_act_at_once_whatever_the_phasing() -> None:
    sets = (
        {"at": 1.0, "stop": True, "rest_value": 42.0, "output_phasing": 0.0},
        {"at": 2.0, "stop": False, "rest_value": 7.0},
        {"at": 3.0, "stop": True},
        {"at": 4.0, "start": True},
    )
    given = steady(10.0, 5.0, *sets, active=False)
    assert [at(given, time)["slave.position"] for time in (0.5, 1.5, 2.5, 3.5, 4.5)] == [5.0, 42.0, 42.0, 7.0, 45.0]
    assert {at(given, time)["state_code"] for time in (0.5, 1.5, 2.5, 3.5, 4.5)} == {READY}
    assert at(given, 1.5)["error_id"] == 0.0


def test_a_level_at_initialization_is_no_edge() -> None:
    assert events(steady(90.0, 2.0, {"at": 1.0, "stop": True}, stop=True)) == []


def test_each_command_keeps_the_phasing_of_its_edge() -> None:
    """Stop with 90 (90 … 270), changed to 45 in the ramp; the start from 180 + 360 ramps 495 … 585."""
    sets = (
        {"at": 0.5, "stop": True, "rest_value": 180.0},
        {"at": 1.5, "output_phasing": 45.0},
        {"at": 1.75, "start": True},
        {"at": 2.25, "output_phasing": 120.0},
    )
    given = steady(90.0, 8.0, *sets, curve=PARABOLA, master__period=360.0)
    assert at(given, 2.0)["slave.position"] == close(157.5)
    assert at(given, 2.0)["local.transition_distance"] == close(180.0)
    assert at(given, 3.5)["local.transition_distance"] == close(90.0)
    assert named(given, "ramp starts")[1] == pytest.approx(5.5, abs=1e-12)
    assert at(given, 6.0)["slave.position"] == close(191.25)
    assert named(given, "completed start") == [pytest.approx(6.5, abs=1e-8)]


@pytest.mark.parametrize("phasing", [0.0, 0.9e-9, 1.1e12, math.inf, math.nan])
def test_a_command_with_a_bad_phasing_is_refused(phasing: float) -> None:
    sets = (
        {"at": 1.0, "stop": True, "output_phasing": phasing, "rest_value": 180.0},
        {"at": 1.5, "stop": False, "output_phasing": 90.0},
        {"at": 1.6, "stop": True, "rest_value": 360.0},
    )
    given = steady(90.0, 6.0, *sets, curve=PARABOLA)
    refused = at(given, 1.25)
    assert (refused["error"], refused["error_id"], refused["state_code"]) == (1.0, 1.0, READY)
    assert refused["slave.position"] == close(112.5)
    assert (at(given, 1.55)["error_id"], at(given, 1.65)["error_id"]) == (1.0, 0.0)
    assert at(given, 5.5)["slave.position"] == close(360.0)


def test_a_refused_command_is_not_stacked() -> None:
    sets = ({"at": 0.5, "stop": True, "rest_value": 180.0}, {"at": 1.5, "start": True, "output_phasing": 0.0})
    given = steady(90.0, 4.0, *sets, curve=PARABOLA)
    assert (at(given, 1.75)["state_code"], at(given, 1.75)["error_id"]) == (EXECUTING, 1.0)
    assert at(given, 3.5)["slave.position"] == close(180.0)


# --- the master's script and the rows ---------------------------------------------------------------------------------


def test_the_script_of_the_master() -> None:
    """Each kind of segment: position and velocity at its end worked out by hand."""
    segments = [
        {"duration": 2.0, "jerk": 3.0},  # from a = 1: p = 10 + 4 + 2 + 4, v = 2 + 2 + 6, a = 7
        {"duration": 1.0, "jerk": -6.0},  # p = 20 + 10 + 3.5 - 1, v = 10 + 7 - 3, a = 1
        {"duration": 2.0},  # constant velocity 14
        {"duration": 1.0, "acceleration": -4.0},  # p = 60.5 + 14 - 2, v = 10
        {"duration": 1.0, "velocity": -5.0},  # p = 72.5 - 5
    ]
    given = scenario(segments)
    given["master"] |= {"position": 10.0, "velocity": 2.0, "acceleration": 1.0}
    rows = [at(given, time) for time in (0.0, 2.0, 3.0, 5.0, 6.0, 7.0, 9.0)]
    assert [row["slave.position"] for row in rows] == [10.0, 20.0, 32.5, 60.5, 72.5, 67.5, 57.5]
    assert [row["slave.velocity"] for row in rows] == [2.0, 10.0, 14.0, 14.0, -5.0, -5.0, -5.0]
    assert [row["slave.acceleration"] for row in rows] == [1.0, 7.0, 0.0, -4.0, 0.0, 0.0, 0.0]
    assert [row["slave.velocity"] for row in reference(given, [6.0])] == [10.0, -5.0]
    assert [row["slave.jerk"] for row in rows] == [0.0] * 7


def test_a_crossing_on_a_cubic_path_is_found() -> None:
    """m = 10·t³ meets x_b = 90 at ∛9 and 180 at ∛18."""
    given = scenario([{"duration": 4.0, "jerk": 60.0}], {"at": 0.5, "stop": True, "rest_value": 180.0}, curve=PARABOLA)
    assert named(given, "ramp starts") == [pytest.approx(9.0 ** (1 / 3), abs=1e-12)]
    row = at(given, 18.0 ** (1 / 3))
    velocity, acceleration = 30 * 18.0 ** (2 / 3), 60 * 18.0 ** (1 / 3)
    assert row["slave.position"] == close(157.5)
    assert row["slave.velocity"] == close(velocity / 2)
    assert row["slave.acceleration"] == close(acceleration / 2 - velocity**2 / 180)
    assert row["slave.jerk"] == close(-3 * velocity * acceleration / 180)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("command", ["start", "stop"])
@pytest.mark.parametrize("direction", [1, -1])
def test_velocity_acceleration_and_jerk_are_derivatives(curve: int, command: str, direction: int) -> None:
    """By differences over 2e-4 s, the master at constant acceleration."""
    given = ramp_script(curve, 90.0 * direction, command, direction)
    given["master"] |= {"velocity": 40.0 * direction}
    given["master"]["segments"] = [{"duration": 9.0, "acceleration": 20.0 * direction}]
    for time in (5.2, 5.5, 6.0, 6.5):
        early, row, late = (at(given, time + shift) for shift in (-1e-4, 0.0, 1e-4))
        for name, rate in (("position", "velocity"), ("velocity", "acceleration"), ("acceleration", "jerk")):
            difference = (late[f"slave.{name}"] - early[f"slave.{name}"]) / 2e-4
            assert difference == pytest.approx(row[f"slave.{rate}"], rel=1e-6, abs=1e-5)
    assert named(given, f"completed {command}")


def test_two_rows_only_where_something_happens() -> None:
    given = steady(90.0, 9.0, {"at": 1.0, "stop": True, "rest_value": 180.0}, curve=PARABOLA, master__period=360.0)
    times = [0.0, 0.5, 1.0, 2.0, 3.0, 3.5]
    assert [row["time"] for row in reference(given, times)] == [0.0, 0.5, 1.0, 1.0, 2.0, 3.0, 3.5]
    given["master"]["velocity"] = 0.0
    assert [row["slave.velocity"] for row in reference(given, [0.0])] == [0.0, 90.0]
    assert [row["time"] for row in reference(given, [1.0 - 0.9e-9, 1.0 + 1.1e-9])] == [1 - 0.9e-9] * 2 + [1 + 1.1e-9]


@pytest.mark.parametrize("velocity", [90.0, -90.0])
def test_a_wrap_of_the_position_makes_two_rows(velocity: float) -> None:
    top, bottom = math.nextafter(360.0, 0.0), 0.0
    before, after = reference(steady(velocity, 9.0, master__period=360.0), [4.0])
    expected = (top, bottom) if velocity > 0 else (bottom, top)
    assert (before["slave.position"], after["slave.position"]) == expected


def test_a_wrong_script_is_refused() -> None:
    with pytest.raises(ValueError, match="-1"):
        reference(scenario([{"duration": -1.0}, {"duration": 2.0}]), [0.5])
    with pytest.raises(ValueError, match="velocity and jerk"):
        reference(scenario([{"duration": 1.0, "velocity": 1.0, "jerk": 1.0}]), [0.5])
    with pytest.raises(ValueError, match="never an edge"):
        events(steady(1.0, 1.0, {"at": 0.0, "stop": True}))
    with pytest.raises(ValueError, match="stopp"):
        events(steady(1.0, 1.0, {"at": 0.5, "stopp": True}))


def test_the_global_precision_is_left_alone() -> None:
    before = mpmath.mp.dps
    reference(ramp_script(POLYNOMIAL, 90.0, "start"), [5.0])
    assert mpmath.mp.dps == before
