"""The rows of a sweep: each shows what `motionsync run` shows of the same scenario with the same values.

The other side of the comparison is the block in Python, stepped one run at a time, and the whole evaluation and all
figures of its recording of all outputs."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from weakref import ref

import numpy as np
import pyarrow as pa
import pytest

from motionsync_fmu.batch.scripted_runs import ScriptedRun, run_scenarios
from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.evaluate.key_figures import SLAVE_OUTPUTS, KeyFigures, compute_key_figures
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.files.shipped import shipped_folder
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.sweeps import rows as of_sweep
from motionsync_fmu.sweeps.result_columns import measure_columns, schema
from motionsync_fmu.sweeps.rows import rows
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.support.scenarios.scenario_texts import FREE_SAW
from tests.support.scenarios.verdicts import checks_of

SAW = load_example("FlyingSaw").file
ALWAYS = ["passed", "refusal", "refused_at", "broken", "first_broken"]
SMOOTH = """\
title = "A saw goes along, and nothing is expected of it"
fmu = "FlyingSaw"
stop_time = 3.0
step_size = 0.01
[start]
"axis.max_velocity" = 400.0
"axis.max_acceleration" = 2000.0
"axis.max_jerk" = 50000.0
"gear_in_pos.master_sync_position" = 250.0
"gear_in_pos.slave_sync_position" = 100.0
[master]
velocity = 250.0
segments = [{ duration = 2.0 }, { duration = 0.5, acceleration = 0.0 }]
[[set]]
at = 0.2
"gear_in_pos.execute" = true
"""
TURNS = """\
title = "A master that turns too quickly to be followed"
fmu = "Synchronizer"
stop_time = 0.1
step_size = 0.01
[start]
"master.period" = 1e-6
[master]
velocity = 1.0
segments = [{ duration = 0.05 }, { duration = 0.05, velocity = 1.0 }]
"""


def plan(file: Path, *settings: str, **measures: Sequence[str]) -> SweepPlan:
    """`measures`: `__` stands for a dot."""
    return SweepPlan.of(file, settings, measures={name.replace("__", "."): kinds for name, kinds in measures.items()})


def written(folder: Path, text: str) -> Path:
    file = folder / "scenario.toml"
    file.write_text(text, "utf-8")
    return file


def table(of: SweepPlan) -> list[dict[str, Any]]:
    return rows(of, 0, of.runs).to_pylist()


def expected(scenario: Scenario) -> dict[str, Any]:
    """The row of a run without its number, values and measures, from its run in Python."""
    try:
        recording = run_in_process(scenario, scenario.step_size)
    except UserError as e:
        at, _, why = str(e).removeprefix(f"{scenario.file}: at ").partition(" s ")
        return {"passed": False, "refusal": why, "refused_at": float(at)}
    broken = [c.text for c in checks_of(scenario, recording) if not c.passed]
    error = {"passed": not broken, "refusal": "", "broken": len(broken), "first_broken": "".join(broken[:1])}
    figures = compute_key_figures(scenario, recording)
    limits = ", ".join(peak.name for peak in figures.peaks if peak.exceeded)
    return error | {"limits_broken": limits} | cut(scenario, recording) | fault(recording) | axis(figures)


def axis(figures: KeyFigures) -> dict[str, Any]:
    result: dict[str, Any] = {}
    if error := figures.following_error:
        result["following_error"] = error.greatest
    if load := figures.load:
        result |= {"force_rms": load.rms, "force_peak": load.peak}
    if true := figures.true_pieces:
        result |= {"true_length_mean": true.mean, "true_length_sigma": true.deviation, "c_pk": true.c_pk}
        result |= {"true_length_worst": true.worst, "cut_movement": true.movement, "tolerance": true.tolerance}
    errors = {"true_length_errors": [piece.error for piece in true.pieces]} if true else {}
    return {name: None if math.isnan(value) else value for name, value in result.items()} | errors


def cut(scenario: Scenario, recording: Recording) -> dict[str, Any]:
    result = compute_key_figures(scenario, recording)
    if result.production:
        figures = result.production
        worst = max((abs(p.error) for p in figures.pieces if p.name == "PRODUCT"), default=None)
        away = [max(p.wander, abs((p.measured or p.length) - p.length)) for p in figures.pieces if p.cut]
        errors = {"cut_error": max(away, default=None), "length_error": worst}
        return errors | {"cuts": figures.cuts, "late": figures.late, "skipped": figures.skipped}
    return {"cuts": len(result.cuts), "cut_error": max((abs(c.error) for c in result.cuts), default=None)}


def fault(recording: Recording) -> dict[str, Any]:
    for time, code in zip(recording.time.tolist(), recording.values["error_id"].tolist(), strict=True):
        if code:
            return {"fault": code, "faulted_at": time}
    return {"fault": 0}


def assert_same(of: SweepPlan) -> list[dict[str, Any]]:
    """Each row is what is expected of its run; the rows."""
    result = table(of)
    for run, row in enumerate(result):
        by_hand = expected(of.scenario(run))
        error = {
            name for name in row if name not in ("run", *(f.name for f in of.factors), *measure_columns(of.measures))
        }
        assert {name: row[name] for name in error} == {name: by_hand.get(name) for name in error}
        assert error >= by_hand.keys() - {"limits_broken", "cuts", "cut_error"}
    return result


# --- the same as one run ---


def test_the_rows_of_a_saw() -> None:
    result = assert_same(
        plan(SAW, "axis.max_acceleration=600,2500", "axis.max_position=150,1000", "set.0.at=0.2,0.9", "stop_time=4.4")
    )
    assert {row["passed"] for row in result} == {True, False}
    assert {row["limits_broken"] for row in result} == {"", "position"}
    assert {row["fault"] for row in result} == {0, 17118, 17119}
    assert {row["cuts"] for row in result} == {0, 1, 2}


def test_the_rows_of_a_saw_with_reactions() -> None:
    result = assert_same(plan(shipped_folder() / "FlyingSaw/cyclic_cut/scenario.toml", "length=1100,1500"))
    assert [row["passed"] for row in result] == [False, True]
    assert result[1]["cuts"] == 20


def test_the_rows_of_a_block_that_shows_its_pieces() -> None:
    cutter = shipped_folder() / "CutToLength/basic_cut/scenario.toml"
    result = assert_same(plan(cutter, "length=300,900,1500", "axis.max_acceleration=1000,10000"))
    assert {row["passed"] for row in result} == {True, False}
    assert {row["skipped"] for row in result} >= {0, 2, 18}
    assert {row["length_error"] for row in result} == {None, 0.0}


def test_the_rows_of_a_servo_and_a_load(tmp_path: Path) -> None:
    text = (shipped_folder() / "CutToLength/basic_cut/scenario.toml").read_text()
    tables = "[servo]\nposition_gain = 50.0\nvelocity_time_constant = 0.003\n[load]\nmass = 100.0\npeak_force = 500.0\n"
    moved = "[master]\nsegments = [{ duration = 2.5 }, { duration = 1.0, acceleration = -50.0 }]"
    file = written(tmp_path, text.replace("[master]", moved) + tables)
    settings = ("servo.position_gain=20,100", "servo.dead_time=0,0.004", "load.mass=50,200", "stop_time=5,9")
    result = assert_same(plan(file, *settings))
    assert {row["c_pk"] is None for row in result} == {True, False}
    for name in ("force_peak", "force_rms"):
        assert len({row[name] for row in result}) >= 8
    assert len({row["true_length_worst"] for row in result if row["stop_time"] == 9.0}) == 4
    for row in result:
        errors = row["true_length_errors"]
        assert row["true_length_worst"] == max(errors, key=abs, default=None)
    assert {len(row["true_length_errors"]) > 1 for row in result} == {True, False}
    assert {row["following_error"] > 3.0 for row in result} == {True, False}


def test_a_servo_alone_and_a_load_alone(tmp_path: Path) -> None:
    saw = "[servo]\nposition_gain = 50.0\n"
    (row,) = assert_same(plan(written(tmp_path, FREE_SAW + saw), "servo.feedforward=0"))
    assert row["following_error"] == pytest.approx(2.0, abs=1e-6)
    assert "force_rms" not in row
    assert "c_pk" not in row
    (row,) = assert_same(plan(written(tmp_path, FREE_SAW + "[load]\nmass = 1.0\nfriction = 3.0\n"), "load.mass=2"))
    assert row["force_peak"] == 3.0
    assert "following_error" not in row


@pytest.mark.parametrize(
    ("name", "setting"),
    [
        ("RemoteSync/no_drift", "remote.jitter=0,0.1"),
        ("Gearing/direct_time_based", "master.velocity=-50,100,200"),
        ("Follower/cyclic_park", "master.velocity=50,300"),
        ("Synchronizer/polynomial", "master.velocity=50,100"),
    ],
)
def test_the_rows_of_the_other_blocks(name: str, setting: str) -> None:
    assert_same(plan(shipped_folder() / name / "scenario.toml", setting))


# --- refused runs ---


def test_a_value_out_of_its_range_is_a_row() -> None:
    result = table(plan(SAW, "axis.max_velocity=-1,1000", slave__velocity=["max"]))
    wrong = "axis.max_velocity = -1 is not allowed: it must be 1e-12 to 1e+12"
    assert (result[0]["refusal"], result[0]["refused_at"], result[0]["passed"]) == (wrong, 0.0, False)
    nothing = ["broken", "first_broken", "cuts", "cut_error", "limits_broken", "fault", "slave.velocity.max"]
    assert {result[0][name] for name in nothing} == {None}
    assert result[1]["refusal"] == ""
    assert result[1]["slave.velocity.max"] > 0.0


def test_a_number_that_the_script_does_not_allow_is_a_row() -> None:
    result = table(plan(SAW, "set.0.at=0.2,4.4"))
    assert result[1]["refusal"] == "at: 4.4 is not before stop_time = 4.4: no step would show it"
    assert result[1]["refused_at"] == 0.0


def test_a_refused_start_is_a_row() -> None:
    starts = plan(shipped_folder() / "Gearing/direct_time_based/scenario.toml", "gearing.denominator=1,0")
    _, result = assert_same(starts)
    assert (
        result["refusal"]
        == "Gearing refuses initialize(): gearing.denominator = 0 is not allowed: an unwired input gives 0"
    )
    assert result["refused_at"] == 0.0


def test_a_refused_step_is_a_row(tmp_path: Path) -> None:
    """The master is to go 1e10 u in a step, 1e16 periods: more than 1e15."""
    slow, quick = assert_same(plan(written(tmp_path, TURNS), "master.segments.1.velocity=1,1e12"))
    assert slow["passed"]
    assert "refuses step(" in quick["refusal"]
    assert "the master's position and its prediction must be at most 1e15 periods" in quick["refusal"]
    assert quick["refused_at"] == 0.05


def test_an_input_that_the_fmu_refuses_during_a_run_is_a_row() -> None:
    result = table(plan(SAW, "set.2.gear_in_pos.master_sync_position=750,1e13"))
    assert result[1]["refusal"] == "gear_in_pos.master_sync_position = 1e+13 is not allowed: it must be -1e+12 to 1e+12"
    assert result[1]["refused_at"] == 2.36


# --- measures and columns ---


def test_measures_are_those_of_the_whole_run() -> None:
    """Of the recording, the value at time 0 does not count."""
    of = plan(SAW, "axis.max_jerk=1e4,5e4", slave__velocity=["max", "max_time"], in_sync=["rises", "first_time"])
    for run, row in enumerate(table(of)):
        scenario = of.scenario(run)
        recording = run_in_process(scenario, scenario.step_size)
        time, speed = recording.time[1:], recording.values["slave.velocity"][1:]
        assert row["slave.velocity.max"] == speed.max()
        assert row["slave.velocity.max_time"] == time[speed.argmax()]
        sync = recording.values["in_sync"]
        assert row["in_sync.rises"] == (np.diff(sync) > 0.0).sum()
        assert row["in_sync.first_time"] == (time[sync[1:].argmax()] if sync.any() else None)


def test_columns_that_a_scenario_cannot_have_are_left_out() -> None:
    assert schema(plan(SAW, "master.velocity=1,2")).names == [
        "run", "master.velocity", *ALWAYS, "cuts", "cut_error", "limits_broken", "fault", "faulted_at"
    ]  # fmt: skip
    gearing = plan(load_example("Gearing").file, "master.velocity=1,2", slave__jerk=["rms", "last"])
    assert schema(gearing).names == [
        "run", "master.velocity", *ALWAYS, "fault", "faulted_at", "slave.jerk.rms", "slave.jerk.last"
    ]  # fmt: skip
    assert {"cuts", "late", "skipped", "length_error"} < {
        *schema(plan(load_example("CutToLength").file, "kerf=1,2")).names
    }


def test_columns_have_the_types_of_their_values() -> None:
    varied = plan(
        SAW,
        "master.velocity=200,250",
        "sync_mode.time_based=true,false",
        "gear_in_pos.ratio_denominator=1,2",
        "master.input_mode=START_OF_STEP,END_OF_STEP",
    )
    types = dict(zip(schema(varied).names, schema(varied).types, strict=True))
    assert types["master.velocity"] == pa.float64()
    assert types["sync_mode.time_based"] == pa.bool_()
    assert types["gear_in_pos.ratio_denominator"] == pa.int64()
    assert types["master.input_mode"] == pa.string()
    assert (types["run"], types["passed"], types["refusal"]) == (pa.int64(), pa.bool_(), pa.string())
    result = rows(varied, 1, 3)
    assert result.schema == schema(varied)
    assert result["run"].to_pylist() == [1, 2]
    assert result["master.input_mode"].to_pylist() == ["END_OF_STEP", "START_OF_STEP"]
    assert rows(varied, 2, 2).num_rows == 0


# --- memory ---


class Watched:
    """Replaces `run_scenarios`, and records how many runs were recorded together, and of which outputs."""

    def __init__(self) -> None:
        self.calls: list[tuple[int, list[str]]] = []

    def __call__(
        self, scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Mapping[str, Any], threads: int
    ) -> list[ScriptedRun]:
        self.calls.append((len(scenarios), list(outputs)))
        return run_scenarios(scenarios, outputs, reduce, threads)


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> Watched:
    result = Watched()
    monkeypatch.setattr(of_sweep, "run_scenarios", result)
    return result


def test_only_so_many_recordings_are_in_memory(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run has 221 points of the time, four numbers of the axis and at least the slave's four outputs."""
    of = plan(SAW, "axis.max_position=150:1000:9")
    whole = table(of)
    assert [number for number, _ in watched.calls] == [9]
    watched.calls.clear()
    monkeypatch.setattr(of_sweep, "MOST_MEMORY", 4 * 221 * 8.0 * 10)
    assert table(of) == whole
    assert len(watched.calls) > 2
    assert max(number for number, _ in watched.calls) <= 4
    monkeypatch.setattr(of_sweep, "MOST_MEMORY", 1.0)
    assert table(of) == whole


def test_runs_that_nobody_evaluates_are_not_recorded(
    tmp_path: Path, watched: Watched, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Limits, faults and measures are known nevertheless; who may have broken a limit is run once more."""
    of = plan(
        written(tmp_path, SMOOTH),
        "axis.max_position=50,150,2000",
        "axis.max_jerk=20000,50000",
        "master.velocity=100,250,500",
        slave__position=["max"],
    )
    result = assert_same(of)
    assert {row["limits_broken"] for row in result} == {"", "position"}
    assert {row["fault"] for row in result} > {0}
    assert watched.calls[0] == (18, [])
    broken = sum(row["limits_broken"] != "" for row in result)
    assert watched.calls[1:] == [(broken, sorted({*SLAVE_OUTPUTS, "error_id", "local.exceeded_limit"}))]
    watched.calls.clear()
    monkeypatch.setattr(of_sweep, "MOST_MEMORY", 3 * 8.0 * 300)  # without outputs: 8 bytes a step
    assert table(of) == result
    assert max(number for number, _ in watched.calls) == 3


def test_scenarios_that_have_run_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    """A remote axis keeps its telegrams. Of the runs before, those of the last call may still be there."""
    ran: list[ref[Scenario]] = []
    alive: list[int] = []

    def counted(scenarios: Sequence[Scenario], *others: Any) -> list[ScriptedRun]:
        alive.append(sum(scenario() is not None for scenario in ran))
        ran.extend(map(ref, scenarios))
        return run_scenarios(scenarios, *others)

    monkeypatch.setattr(of_sweep, "run_scenarios", counted)
    monkeypatch.setattr(of_sweep, "MOST_MEMORY", 1.0)
    table(plan(shipped_folder() / "RemoteSync/no_drift/scenario.toml", "remote.phase=0:0.9:6"))
    assert len(alive) == 6
    assert max(alive) <= 1


def test_a_required_reaction_is_evaluated_without_a_recording(tmp_path: Path) -> None:
    """It never happens where the saw is never in sync."""
    react = '[[on]]\nwhen = "in_sync"\nrequired = true\nset = { "gear_in_pos.execute" = false }\n'
    of = plan(written(tmp_path, SMOOTH + react), "axis.max_acceleration=100,2000")
    lazy, quick = assert_same(of)
    assert lazy["first_broken"] == "reaction to in_sync once: found never"
    assert quick["passed"]


def test_rows_do_not_depend_on_chunks_and_threads() -> None:
    of = plan(SAW, "axis.max_acceleration=600:2500:7", "axis.max_velocity=-1,1000", slave__jerk=["max"])
    whole = rows(of, 0, of.runs)
    assert rows(of, 0, of.runs, threads=2) == whole
    assert pa.concat_tables([rows(of, 0, 5), rows(of, 5, 6), rows(of, 6, of.runs)]).combine_chunks() == whole


@pytest.mark.parametrize(("first", "last"), [(0, 3), (-1, 1), (2, 1)])
def test_runs_that_the_plan_has_not_are_refused(first: int, last: int) -> None:
    with pytest.raises(UserError, match="there are no runs"):
        rows(plan(SAW, "master.velocity=200,250"), first, last)
