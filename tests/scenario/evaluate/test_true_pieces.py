"""Pieces as a tape measure finds them, and what a run asks of the axis: against the oracles, and in closed form."""

import math
from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest

from motionsync_fmu.pages.summary import print_result
from motionsync_fmu.scenario.computed_columns import ACTUAL_POSITION
from motionsync_fmu.scenario.evaluate.cutting_results import CuttingResults
from motionsync_fmu.scenario.evaluate.key_figures import KeyFigures, compute_key_figures
from motionsync_fmu.scenario.evaluate.outcome import ScenarioOutcome
from motionsync_fmu.scenario.evaluate.true_pieces import TruePieces, capability, find_true_cuts
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.servo import Servo
from tests import ROOT
from tests.oracle.measured_line import load as load_oracle
from tests.oracle.measured_line import true_pieces as oracle
from tests.support.scenarios.recordings import run_compiled
from tests.support.scenarios.scenario_texts import FREE_SAW, write_scenario
from tests.support.scenarios.verdicts import checks_of

CYCLIC_CUT = ROOT / "scenarios/FlyingSaw/cyclic_cut/scenario.toml"
LINE = """\
title = "A line that slows down"
fmu = "CutToLength"
stop_time = 12.0
step_size = 0.004
[start]
auto_start = true
length = 800.0
kerf = 4.0
[master]
velocity = 500.0
segments = [{ duration = 5.6 }, { duration = 0.5, acceleration = -400.0 }]
"""
SERVO = "[servo]\nposition_gain = 50.0\nvelocity_time_constant = 0.003\ndead_time = 0.002\n"
LATE = "[servo]\nposition_gain = 50.0\ndead_time = 0.002\n"  # the setpoint, 2 ms late
LOAD = "[load]\nmass = 120.0\nfriction = 150.0\n"


def run(folder: Path, text: str) -> tuple[Scenario, Recording]:
    return run_of(load_scenario(write_scenario(text, folder)))


def run_of(scenario: Scenario) -> tuple[Scenario, Recording]:
    (compiled,) = run_compiled(scenario)
    assert compiled.recording
    return scenario, compiled.recording


def true_pieces(scenario: Scenario, recording: Recording) -> TruePieces:
    result = CuttingResults(scenario, recording).true_pieces
    assert result
    return result


def by_the_oracle(recording: Recording, flag: str, ratio: float = 1.0) -> oracle.TrueCuts:
    values = recording.values[flag] != 0.0
    master, slave = (
        recording.master[:, 0],
        recording.computed.get(ACTUAL_POSITION, recording.values.get("slave.position")),
    )
    return oracle.TrueCuts(recording.time.tolist(), master.tolist(), slave.tolist(), values.tolist(), ratio=ratio)


# --- pieces -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "ratio"),
    [("", 1.0), ("diagonal_angle = 30.0\n", 1.0 / math.cos(math.radians(30.0))), ("material_factor = 1.25\n", 1.0)],
)
def test_pieces_are_those_of_the_oracle(start: str, ratio: float, tmp_path: Path) -> None:
    scenario, recording = run(tmp_path, LINE.replace("kerf", f"{start}kerf") + SERVO)
    cuts = by_the_oracle(recording, "tool.cutting", ratio)
    lengths = cuts.lengths(4.0)
    result = true_pieces(scenario, recording)
    assert len(result.pieces) == len(lengths) >= 3
    for piece, exact in zip(result.pieces, lengths, strict=True):
        assert piece.length == pytest.approx(float(exact), abs=1e-9)
        assert (piece.ordered, piece.believed) == (800.0, pytest.approx(800.0, abs=1e-9))
    errors = [length - 800 for length in lengths]
    assert result.mean == pytest.approx(float(oracle.mean(lengths)), abs=1e-9)
    assert result.deviation == pytest.approx(float(oracle.deviation(errors)), abs=1e-9)
    assert result.worst == pytest.approx(float(oracle.worst(errors)), abs=1e-9)
    assert result.c_pk == pytest.approx(float(oracle.c_pk(errors, 0.5)), rel=1e-6)
    assert result.movement == pytest.approx(float(cuts.movement), abs=1e-9)
    assert [piece.number for piece in result.pieces] == [*range(2, 2 + len(lengths))]


def test_a_slower_line_gives_a_shorter_piece_behind_a_dead_time(tmp_path: Path) -> None:
    """At 500 mm/s the blade is 1 mm behind its place, at 300 mm/s 0.6 mm: the piece in between is 0.4 mm too short."""
    result = true_pieces(*run(tmp_path, LINE + LATE))
    errors = [piece.error for piece in result.pieces]
    assert min(errors) == result.worst == pytest.approx(-0.4, abs=2e-3)
    assert sorted(map(abs, errors))[:-1] == pytest.approx([0.0] * (len(errors) - 1), abs=2e-3)


def test_the_blade_moves_by_the_dead_time_where_the_line_changes_its_velocity_in_the_cut(tmp_path: Path) -> None:
    text = LINE[: LINE.index("segments")]
    still = true_pieces(*run(tmp_path, text + LATE))
    assert still.worst == pytest.approx(0.0, abs=1e-9)
    assert 0.0 < still.movement < 0.1  # as the cut begins, the blade still does what the approach did


def test_the_marks_of_a_saw(tmp_path: Path) -> None:
    saw = replace(load_scenario(CYCLIC_CUT), stop_time=8.0)
    served = load_scenario(write_scenario(FREE_SAW + SERVO, tmp_path)).servo
    scenario, recording = run_of(replace(saw, servo=served, expectations=()))
    assert scenario.cuts
    cuts = by_the_oracle(recording, scenario.cuts.name, scenario.cuts.ratio)
    result = true_pieces(scenario, recording)
    assert len(result.pieces) == len(cuts.lengths()) >= 2
    for piece, exact in zip(result.pieces, cuts.lengths(), strict=True):
        assert piece.length == pytest.approx(float(exact), abs=1e-9)
        assert (piece.ordered, piece.believed) == (pytest.approx(scenario.cuts.length), None)
    assert result.movement == pytest.approx(float(cuts.movement), abs=1e-9)
    assert result.tolerance == scenario.cuts.tolerance


@pytest.mark.parametrize("seed", range(30))
def test_cuts_of_every_kind_are_those_of_the_oracle(seed: int) -> None:
    """Cuts of one row, from the first row on, up to the last one; and no cut."""
    random = Random(seed)
    scenario = replace(load_scenario(CYCLIC_CUT), servo=Servo(50.0))
    assert scenario.cuts
    points = random.choice((2, 3, 10, 40))
    share = random.choice((0.0, 0.3, 0.6, 1.0))
    time = np.cumsum([random.uniform(1e-4, 1e-2) for _ in range(points)])
    master, slave = np.array([[random.uniform(0.0, 1e3) for _ in range(points)] for _ in range(2)])
    flag = np.array([float(random.random() < share) for _ in range(points)])
    axis = np.column_stack([master, *np.zeros((3, points))])
    recording = Recording(
        time, {scenario.cuts.name: flag, "slave.position": 0.0 * slave}, axis, [], computed={ACTUAL_POSITION: slave}
    )
    result = find_true_cuts(scenario, recording)
    cuts = by_the_oracle(recording, scenario.cuts.name, scenario.cuts.ratio)
    assert result.place.tolist() == pytest.approx([float(place) for place in cuts.places], abs=1e-9)
    seen = result.movement[~np.isnan(result.movement)]
    assert seen.max(initial=0.0) == pytest.approx(float(cuts.movement), abs=1e-9)
    assert len(result.movement) - len(seen) == sum(len(times) == 1 for times, _ in cuts.cuts)


@pytest.mark.parametrize(("step", "seen"), [(0.1, False), (0.002, True)])
def test_a_cut_within_a_step_does_not_show_how_far_the_tool_moves_in_it(
    step: float, seen: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The blade cuts for 50 ms. What nobody has seen is not within the tolerance."""
    text = LINE.replace("step_size = 0.004", f"step_size = {step}").replace("kerf", '"tool.cut_time" = 0.05\nkerf')
    scenario, recording = run(tmp_path, text + SERVO + "[cuts]\ntolerance = 5.0\nlate = 9\nskipped = 9\n")
    assert math.isnan(true_pieces(scenario, recording).movement) != seen
    (check,) = (check for check in checks_of(scenario, recording) if "moves in the cut" in check.expected)
    assert (check.passed, check.actual.startswith("unknown: each cut is over")) == (seen, not seen)
    print_result(outcome(compute_key_figures(scenario, recording)), verbose=False)
    assert ("unknown: each cut is over" in capsys.readouterr().out) != seen


@pytest.mark.parametrize("errors", [[0.1, -0.2, 0.05], [0.3, 0.3], [0.7, 0.7, 0.7], [-2.0, -2.5]])
def test_the_capability_is_that_of_the_oracle(errors: list[float]) -> None:
    assert capability(errors, 0.5) == pytest.approx(float(oracle.c_pk(errors, 0.5)), rel=1e-12)


def test_one_piece_has_no_capability() -> None:
    assert math.isnan(capability([0.1], 0.5))
    assert math.isnan(capability([], 0.5))


def test_with_an_encoder_alone_the_tool_is_where_its_setpoint_is(tmp_path: Path) -> None:
    """A wheel that measures 1 in 1000 too much makes pieces shorter by as much, kerf and all."""
    scenario, recording = run(tmp_path, LINE + "[encoder]\nscale = 1.001\n")
    result, lengths = true_pieces(scenario, recording), by_the_oracle(recording, "tool.cutting").lengths(4.0)
    assert [piece.length for piece in result.pieces] == pytest.approx([float(length) for length in lengths], abs=1e-9)
    steady = [piece.error for piece in result.pieces if abs(piece.error - result.worst) < 1e-3]
    assert len(steady) >= 2
    assert steady == pytest.approx([804.0 / 1.001 - 804.0] * len(steady), abs=1e-3)
    assert result.pieces[0].believed == pytest.approx(800.0, abs=0.1)


def test_the_true_places_of_a_recorded_line_are_not_known() -> None:
    recorded = load_scenario(ROOT / "scenarios/CutToLength/recorded_line/scenario.toml")
    scenario, recording = run_of(replace(recorded, servo=Servo(50.0), expectations=()))
    assert ACTUAL_POSITION in recording.computed
    assert CuttingResults(scenario, recording).true_pieces is None


def test_without_servo_and_encoder_the_block_knows_the_true_places(tmp_path: Path) -> None:
    assert CuttingResults(*run(tmp_path, LINE + LOAD)).true_pieces is None


@pytest.mark.parametrize(("tolerance", "passed"), [(0.3, False), (0.5, True)])
def test_a_run_is_as_expected_if_the_true_lengths_are(tolerance: float, passed: bool, tmp_path: Path) -> None:
    checks = checks_of(*run(tmp_path, f"{LINE}{LATE}[cuts]\ntolerance = {tolerance}\n"))
    (true,) = [check for check in checks if check.expected.startswith("true lengths")]
    assert true.passed == passed
    assert true.actual == "at most 0.4 mm off"
    assert not any("where they are reported" in check.expected for check in checks)


# --- the axis ---------------------------------------------------------------------------------------------------------


def test_the_figures_of_the_motor_are_those_of_the_oracle(tmp_path: Path) -> None:
    motor = "peak_force = 3000.0\ncontinuous_force = 900.0\n"
    scenario, recording = run(tmp_path, LINE + SERVO + LOAD + motor)
    result = compute_key_figures(scenario, recording).load
    assert result
    cutting = recording.values["tool.cutting"]
    starts = np.flatnonzero(np.diff(cutting) > 0.0) + 1
    inside = slice(starts[0], starts[-1] + 1)
    time, force = recording.time[inside].tolist(), recording.computed["load.force"]
    rms, peak = load_oracle.rms(time, force[inside].tolist()), load_oracle.peak(force.tolist())
    power = recording.computed["load.power"]
    work = load_oracle.integral(time, power[inside].tolist()) / (len(starts) - 1)
    assert (result.begin, result.end, result.cycles) == (time[0], time[-1], len(starts) - 1)
    assert result.rms == pytest.approx(float(rms), rel=1e-12)
    assert result.peak == pytest.approx(float(peak), rel=1e-12)
    assert result.peak == abs(force[np.searchsorted(recording.time, result.peak_at)])
    assert result.peak_power == pytest.approx(float(load_oracle.peak(power.tolist())), rel=1e-12)
    assert result.work == pytest.approx(float(work), rel=1e-9)
    assert result.rms_share == pytest.approx(float(load_oracle.used(rms, 900.0)), rel=1e-12)
    assert result.peak_share == pytest.approx(float(load_oracle.used(peak, 3000.0)), rel=1e-12)


def test_without_cuts_the_whole_run_counts(tmp_path: Path) -> None:
    """A saw at a constant 100 mm/s has its friction alone."""
    result = compute_key_figures(*run(tmp_path, FREE_SAW + LOAD)).load
    assert result
    assert (result.begin, result.end, result.cycles, result.work) == (0.0, 2.0, 0, None)
    assert (result.peak, result.rms) == (150.0, pytest.approx(150.0, rel=1e-12))
    assert result.peak_power == pytest.approx(15.0, rel=1e-12)
    assert (result.peak_share, result.rms_share) == (None, None)


def outcome(figures: KeyFigures) -> ScenarioOutcome:
    notes = figures.load.beyond_motor if figures.load else []
    return ScenarioOutcome("f", "n", "t", "CutToLength", 0.004, figures, [], [], [], notes, "r", None, "p")


def test_the_console_and_json_show_what_is_true(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenario, recording = run(tmp_path, LINE + LATE + LOAD + "peak_force = 100.0\ncontinuous_force = 1e6\n")
    shown = outcome(compute_key_figures(scenario, recording))
    print_result(shown, verbose=False)
    lines = {" ".join(line.split()) for line in capsys.readouterr().out.splitlines()}
    figures = shown.figures
    assert figures.load
    assert figures.true_pieces
    assert any(line.startswith(f"true length {len(figures.true_pieces.pieces)} products: mean 799.9") for line in lines)
    assert "sigma 0.2 mm C_pk 0.6667 for 0.5 mm" in lines  # of errors of 0, 0, 0 and -0.4 mm
    assert any(line.startswith("in the cut the tool moves 0.0") for line in lines)
    assert any(line.startswith("force rms ") and line.endswith(f"over {figures.load.cycles} cycles") for line in lines)
    assert any(line.startswith("following ") for line in lines)
    share = f"{figures.load.peak:.3g} % of its own"  # of 100 N
    assert any(line.startswith("! beyond the motor: peak force 1") and line.endswith(share) for line in lines)
    assert not any("rms force" in line for line in lines)
    json = shown.as_json()
    assert json["true_pieces"]["worst"] == figures.true_pieces.worst
    assert json["load"]["rms"] == figures.load.rms
    assert json["following_error"]["unit"] == "mm"


def test_a_run_without_the_tables_shows_nothing_of_them(tmp_path: Path) -> None:
    shown = outcome(compute_key_figures(*run(tmp_path, LINE))).as_json()
    assert not {"true_pieces", "load", "following_error"} & shown.keys()
