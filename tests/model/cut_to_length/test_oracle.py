"""The oracle of CutToLength against numbers that were computed beforehand, and the block against the oracle.

The machine is the reference machine of `machine_results.py`; all else as it is started. The expected numbers were
computed twice, with closed forms and with a prototype of the sequence; what is derived from them is derived in the
docstrings.
"""

from itertools import pairwise
from math import cos, inf, pi, sqrt
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import LEAD
from tests.model.cut_to_length.machine_results import (
    BASIC_CUT,
    CYCLES,
    EACH_RESULT,
    GREATEST_VELOCITIES,
    MACHINES,
    REFERENCE,
    Result,
    pitch_without_jerk,
    result_of,
    to,
)
from tests.model.cut_to_length.scripted_runs import NOT_COMPARED, find_differences, random_script, simulate
from tests.oracle.cut_to_length import DEFAULTS, FIXED, events, reference
from tests.oracle.cut_to_length_limits import Saw

FAULT, OFF, HOMING, WAITING, APPROACHING, SYNCHRONOUS, CUTTING, PULLING, CLEARING, RETURNING = range(-1, 9)
PRODUCT, SAMPLE, WASTE, TRIM, SHORT, MERGED = range(1, 7)

Script = dict[str, Any]


def near(value: float, rel: float = 1e-9) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-9)


def saw_limits(**values: Any) -> Saw:
    """The reference machine with other values; a name has `__` for a dot."""
    return Saw.of(DEFAULTS | FIXED | REFERENCE | _dotted(values), 1.0)


def _dotted(values: dict[str, Any]) -> dict[str, Any]:
    return {name.replace("__", "."): value for name, value in values.items()}


def run(segments: list[dict[str, float]], *sets: dict[str, Any], **values: Any) -> Script:
    """The reference machine on a line; `position`, `velocity` and `acceleration` are the line's first ones."""
    start = _dotted(values)
    line = {name: start.pop(name, 0.0) for name in ("position", "velocity", "acceleration")}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": start.pop("step_size", 0.01),
        "start": REFERENCE | start,
        "master": line | {"segments": segments},
        "set": [_dotted(table) for table in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **values: Any) -> Script:
    """A line of constant velocity; `start` is given at 0.2 s."""
    return run([{"duration": duration}], {"at": 0.2, "start": True}, *sets, velocity=velocity, **values)


def row_at(script: Script, time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(script, [time])[-1]


def rows(script: Script, step: float) -> list[dict[str, float]]:
    return reference(script, [i * step for i in range(1, round(script["stop_time"] / step) + 1)])


def pieces(script: Script, step: float = 0.01) -> list[dict[str, float]]:
    """The first row of each piece that is recorded."""
    all_rows = [{"statistics.cuts": 0.0}, *rows(script, step)]
    return [b for a, b in pairwise(all_rows) if b["statistics.cuts"] > a["statistics.cuts"]]


def times(script: Script, name: str) -> list[float]:
    return [time for time, event in events(script) if event == name]


# --- limits -----------------------------------------------------------------------------------------------------------


def quantity(saw: Saw, name: str, at: float) -> float:
    if name == "coupling":
        return saw.k
    if name == "return_time":
        return saw.return_time(saw.k * at, saw.cut_travel(at), saw.turning_acceleration)
    return float(getattr(saw, name)(at))


@EACH_RESULT
def test_what_a_machine_can_do(result: Result) -> None:
    saw = saw_limits(**MACHINES[result.machine])
    assert quantity(saw, result.quantity, result.at) == to(result.digits, result.value)


def test_without_a_pitch_the_stroke_limits_the_line() -> None:
    assert saw_limits().max_line_velocity(inf) == to(6, GREATEST_VELOCITIES[2000.0])


def test_the_carriage_of_a_diagonal_saw_is_faster_than_the_line() -> None:
    """k = 1.02/cos 30°."""
    assert saw_limits(**MACHINES["mitre"]).k == near(1.02 / cos(pi / 6), 1e-15)
    fastest = result_of("mitre", "max_line_velocity", 800.0)
    row = row_at(steady(100.0, 1.0, length=812.0, **MACHINES["mitre"]), 1.0)
    assert row["limits.max_line_velocity"] == near(fastest)
    assert row["line.velocity_request"] == near(0.98 * fastest)


def test_without_a_jerk_limit_the_shortest_pitch_has_a_closed_form() -> None:
    v, a = 700.0, 5000.0
    free = {"axis__max_velocity": 1e9, "axis__max_jerk": 1e15, "axis__max_position": 1e9}
    limits = {"axis__max_acceleration": a, "axis__max_deceleration": a}
    for t_s in (0.0, 0.3):
        s = saw_limits(tool__cut_time=t_s, **free, **limits)
        assert s.shortest_pitch(v) == near(pitch_without_jerk(v, a, t_s), 1e-8)


# --- cuts at constant velocity ----------------------------------------------------------------------------------------


def test_the_basic_cut() -> None:
    script = steady(1000.0, 5.5, length=1500.0, kerf=4.0)
    assert row_at(script, 1.0)["next_cut.position"] == near(1702.0)
    assert times(script, "start") == [near(BASIC_CUT["start"] + i * 1.504) for i in range(3)]
    assert {name: times(script, name)[0] for name in BASIC_CUT} == {name: near(t) for name, t in BASIC_CUT.items()}
    row = row_at(script, 2.1)
    assert (row["last.length"], row["last.error"], row["last.good"]) == (near(1500.0), near(0.0), 1.0)
    assert (row["last.reserve"], row["last.kind"]) == (1.0, PRODUCT)
    assert row_at(script, 4.0)["last.reserve"] == near(1 - CYCLES[1000.0].cycle_time / 1.504, 1e-8)


def test_the_line_slows_down_and_speeds_up_again() -> None:
    segments = [{"duration": 3.0}, {"duration": 1.0, "acceleration": -300.0}, {"duration": 2.0}]
    segments += [{"duration": 1.0, "acceleration": 300.0}, {"duration": 4.0}]
    script = run(segments, {"at": 0.2, "start": True}, velocity=1000.0, length=1500.0, kerf=4.0)
    recorded = pieces(script)
    assert len(recorded) == 6
    assert [row["last.length"] for row in recorded] == [near(1500.0)] * 6


@pytest.mark.parametrize(("share", "met"), [(0.999999, True), (1.000001, False)])
def test_the_greatest_velocity_is_sharp(share: float, met: bool) -> None:
    script = steady(share * GREATEST_VELOCITIES[1500.0], 15.0, length=1500.0)
    recorded = pieces(script)
    assert len(recorded) > 5
    assert {row["warning.line_too_fast"] for row in rows(script, 0.1)[5:]} == {float(not met)}
    assert [row["last.length"] for row in recorded[1:]] == [near(1500.0 if met else 3000.0)] * (len(recorded) - 1)
    assert recorded[-1]["statistics.skipped"] == (0.0 if met else len(recorded) - 1.0)


def test_what_becomes_of_a_cut_that_cannot_be_reached() -> None:
    """At 1310: LATE each piece takes a whole cycle, 1310·T_c."""
    cycle = result_of("reference", "shortest_pitch", 1310.0)
    late, skipped, stopped = (steady(1310.0, 8.0, length=1500.0, late_mode=mode) for mode in (2, 1, 3))
    assert [row["last.length"] for row in pieces(late)] == [near(1500.0), *[near(cycle)] * 5]
    assert [row["statistics.late"] for row in pieces(late)] == [0, 1, 2, 3, 4, 5]
    assert [row["last.length"] for row in pieces(skipped)] == [near(1500.0), *[near(3000.0)] * 2]
    assert [row["last.kind"] for row in pieces(skipped)] == [PRODUCT, MERGED, MERGED]
    assert len(pieces(stopped)) == 1
    assert times(stopped, "fault 16") == times(stopped, "home")
    row = row_at(stopped, 4.0)
    assert (row["state_code"], row["error_id"], row["line.stop_request"]) == (FAULT, 16.0, 1.0)
    assert (row["line.velocity_request"], row["running"], row["slave.position"]) == (0.0, 0.0, 0.0)


# --- the tool and the gap ---------------------------------------------------------------------------------------------


def test_the_gap_is_opened() -> None:
    """10 over 150: v = 1000 + 1.875·10/0.15, a = 10/sqrt 3·10/0.15², j = 60·10/0.15³ at both ends."""
    script = steady(1000.0, 4.0, length=1500.0, gap__distance=10.0, gap__travel=150.0)
    begin = times(script, "cut")[0]
    pulling = reference(script, [begin + 1e-8 + i * 1e-4 for i in range(1500)])
    assert {row["state_code"] for row in pulling} == {PULLING}
    assert max(row["slave.velocity"] for row in pulling) == near(1125.0, 1e-6)
    assert max(row["slave.acceleration"] for row in pulling) == near(2566.0, 1e-4)
    assert min(row["slave.acceleration"] for row in pulling) == near(-2566.0, 1e-4)
    assert max(row["slave.jerk"] for row in pulling) == near(177778.0, 1e-5)
    open_ = row_at(script, begin + 0.1499999)
    line = 1000.0 * (begin + 0.1499999) - open_["next_cut.position"] + 1500.0
    assert open_["slave.position"] == near(line + 10.0, 1e-6)
    assert row_at(script, begin + 0.15)["state_code"] == RETURNING
    assert (row_at(script, begin + 0.1)["tool.command"], row_at(script, begin + 0.16)["tool.command"]) == (1.0, 0.0)


def test_a_gap_beyond_the_limits_is_skipped() -> None:
    """Over 140 the jerk would be 60·10/0.14³ = 218659."""
    script = steady(1000.0, 4.0, length=1500.0, gap__distance=10.0, gap__travel=140.0)
    end = times(script, "cut")[0]
    row = row_at(script, end + 1e-3)
    assert (row["state_code"], row["warning.gap_skipped"]) == (RETURNING, 1.0)


def test_the_blade_is_commanded_so_much_earlier() -> None:
    """on_delay 0.08 - settle_time 0.03: 0.05 s before sync; the cut starts 0.03 s after it."""
    script = steady(1000.0, 4.0, length=1500.0, tool__on_delay=0.08, tool__settle_time=0.03)
    sync = times(script, "sync")[0]
    assert row_at(script, sync)["tool.command_time"] == near(sync - 0.05)
    assert times(script, "cut")[0] == near(sync + 0.03 + 0.25)
    down = [row_at(script, sync + 0.03 + side * 1e-6)["tool.blade_down"] for side in (-1, 1)]
    assert down == [0.0, 1.0]
    assert row_at(script, 3.9)["warning.blade_early"] == 0.0


def test_a_cut_by_distance_waits_for_the_line() -> None:
    """Sync at 1.7866 s, 200 of travel: the line is at rest from 1.9 s for 1 s, 113.4 after sync."""
    segments = [{"duration": 1.9}, {"duration": 1.0, "velocity": 0.0}, {"duration": 5.0, "velocity": 1000.0}]
    script = run(
        segments, {"at": 0.2, "start": True}, velocity=1000.0, length=1500.0, tool__mode=2, tool__cut_distance=200.0
    )
    cut, sync = times(script, "cut")[0], times(script, "sync")[0]
    assert sync == near(1.7 + 0.0866025404)
    assert cut == near(sync + 0.2 + 1.0)
    positions = [row_at(script, time)["slave.position"] for time in (sync, cut)]
    assert positions[1] - positions[0] == near(200.0)
    assert [row["last.length"] for row in pieces(script)] == [near(1500.0)] * 4


# --- the way home -----------------------------------------------------------------------------------------------------

EASE: dict[str, Any] = {"homing__ease": True, "length": 3000.0}


def test_the_way_home_is_eased() -> None:
    """The share is 0.197109: the peak is 0.197109·1500 = 295.7; home 0.02 s before each start."""
    script = steady(1000.0, 12.2, **EASE)
    eased = rows(script, 0.002)
    returning = [row for row in eased if row["state_code"] == RETURNING]
    assert {round(row["local.ease"], 6) for row in returning} == {0.197109}
    assert min(row["slave.velocity"] for row in returning) == near(-295.7, 1e-3)
    starts, homes = times(script, "start"), times(script, "home")
    assert (len(starts), len(homes)) == (4, 3)
    assert [start - home for home, start in zip(homes, starts[1:], strict=True)] == [near(0.02)] * 3
    fast = rows(steady(1000.0, 12.2, length=3000.0), 0.002)
    assert min(row["slave.velocity"] for row in fast) == near(-1500.0)
    for rms, eased_or_fast in ((2022.0, eased), (3318.0, fast)):
        square = sum(row["slave.acceleration"] ** 2 for row in eased_or_fast) / len(eased_or_fast)
        assert sqrt(square) == near(rms, 2e-3)


def test_a_line_that_speeds_up_ends_the_easing() -> None:
    segments = [{"duration": 4.0}, {"duration": 0.5, "acceleration": 600.0}, {"duration": 3.0}]
    script = run(segments, {"at": 0.2, "start": True}, velocity=1000.0, **EASE)
    assert times(script, "home")[0] == near(4.459111, 1e-6)
    assert (row_at(script, 3.9)["local.ease"], row_at(script, 4.1)["local.ease"]) == (near(0.197109, 1e-5), 1.0)


# --- the ends of the stroke, and late starts --------------------------------------------------------------------------


def test_the_carriage_stops_before_the_end_of_its_stroke() -> None:
    """The stop would end at 650; on the way home the carriage reverses without coming to rest, so before that."""
    segments = [{"duration": 1.75}, {"duration": 2.0, "acceleration": 400.0}]
    script = run(segments, {"at": 0.2, "start": True}, velocity=1000.0, length=1500.0, tool__cut_time=0.45)
    run_rows = rows(script, 0.001)
    assert times(script, "fault 17")
    assert 645.0 < max(row["slave.position"] for row in run_rows) <= 650.0
    assert run_rows[-1]["state_code"] == FAULT
    assert run_rows[-1]["statistics.unsynchronised"] == 1.0
    assert (run_rows[-1]["statistics.cuts"], run_rows[-1]["slave.position"]) == (0.0, 0.0)


def test_the_reserve_is_used_up_by_a_late_start() -> None:
    """Held until the material is 0.05 past the start at 1000: D' = lead(1020) - 0.05, 1.0296·lead(1000)."""
    lead = saw_limits().lead(1000.0)
    for reserve, way in ((0.02, saw_limits(approach__reserve=0.02).approach_distance(1000.0)), (0.0, lead)):
        begin = (1700.0 - way) / 1000.0
        held = {"at": begin + 0.05e-3, "hold": False}
        script = steady(1000.0, 4.0, held, length=1500.0, hold=True, approach__reserve=reserve, late_mode=2)
        sync = times(script, "sync")[0]
        if reserve:
            assert (way - 0.05) / lead == near(1.0296, 1e-4)
            assert sync == near(1.7 + (way - 0.05) / 1000.0)
        row = row_at(script, 3.0)
        assert row["statistics.late"] == float(reserve == 0.0)
        assert row["last.length"] == near(1500.0 if reserve else 1500.05)


# --- marks and calibration --------------------------------------------------------------------------------------------


def test_a_mark_is_cut() -> None:
    """C = 10000 + 2000 + 25; the start is lead(1000) before it."""
    mark = {"at": 0.5, "mark__detected": True, "mark__position": 10000.0}
    script = steady(1000.0, 4.0, mark, position=9600.0, source=2, mark__sensor_distance=2000.0, mark__cut_offset=25.0)
    assert row_at(script, 0.4)["next_cut.known"] == 0.0
    assert row_at(script, 1.0)["next_cut.position"] == near(12025.0)
    assert 9600.0 + 1000.0 * times(script, "start")[0] == near(12025.0 - LEAD)


def test_calibration_by_a_measured_piece() -> None:
    """(1512 + 4)/(1500 + 4); in force from the piece fixed next."""
    measured = {"at": 2.5, "calibration__execute": True, "calibration__measured_length": 1512.0}
    script = steady(1000.0, 6.0, measured, length=1500.0, kerf=4.0)
    assert row_at(script, 2.6)["calibration.factor"] == near(1516.0 / 1504.0)
    cuts = [row["next_cut.position"] for row in reference(script, [1.0, 3.0, 4.5])]
    assert cuts[1] - cuts[0] == near(1504.0)
    assert cuts[2] - cuts[1] == near(1504.0 * 1504.0 / 1516.0)


def test_the_pitch_counts_travel_of_the_master() -> None:
    script = steady(1000.0, 5.0, length=1500.0, kerf=4.0, material_factor=1.02)
    cuts = [row["next_cut.position"] for row in reference(script, [1.0, 3.0])]
    assert cuts[1] - cuts[0] == near(1474.509804)
    assert [row["last.length"] for row in pieces(script)] == [near(1500.0)] * len(pieces(script))


# --- the block --------------------------------------------------------------------------------------------------------

settings.register_profile("cut_to_length_oracle", derandomize=True, deadline=None)
repeatable = settings.get_profile("cut_to_length_oracle")
randoms = st.integers(0, 2**32 - 1).map(Random)
SHOWN = [name for name in row_at(steady(100.0, 1.0), 0.5) if name not in NOT_COMPARED]
DURATION = 5.0


@settings(repeatable, max_examples=20)
@given(randoms, st.sampled_from([0.007, 0.0471]))
def test_the_block_is_its_oracle(random: Random, step_size: float) -> None:
    """Random machines, lines and commands; all outputs to 1e-9 of the machine's size."""
    script = random_script(random, DURATION, step_size)
    cuts = [i * step_size for i in range(int(script["stop_time"] / step_size) + 1)]
    rows_of_block = simulate(script, cuts, SHOWN, MasterInput.START_OF_STEP, stride=3)
    assert find_differences(script, rows_of_block) == []


@settings(repeatable, max_examples=2)
@given(randoms)
def test_the_block_is_its_oracle_at_short_steps(random: Random) -> None:
    script = random_script(random, DURATION, 0.001)
    cuts = [i * 0.001 for i in range(int(script["stop_time"] / 0.001) + 1)]
    rows_of_block = simulate(script, cuts, SHOWN, MasterInput.START_OF_STEP, stride=25)
    assert find_differences(script, rows_of_block) == []


@settings(repeatable, max_examples=8)
@given(randoms, st.sampled_from([MasterInput.START_OF_STEP, MasterInput.END_OF_STEP]))
def test_the_block_is_its_oracle_at_random_steps(random: Random, mode: MasterInput) -> None:
    script = random_script(random, DURATION, None, jumps=mode == MasterInput.START_OF_STEP)
    cuts = [random.uniform(0.0, script["stop_time"]) for _ in range(random.choice([20, 100, 400]))]
    rows_of_block = simulate(script, cuts, SHOWN, mode, stride=3)
    assert find_differences(script, rows_of_block) == []
