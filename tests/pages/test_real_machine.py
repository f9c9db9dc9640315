"""The report of a machine with encoder, servo and load: its charts show the true pieces and the motor's limits."""

import re
from dataclasses import replace
from math import erf, sqrt
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.batch.scripted_runs import run_scenarios
from motionsync_fmu.pages.report.chart import BAD, OK, Chart
from motionsync_fmu.pages.report.page import run_charts, write_report
from motionsync_fmu.pages.report.real_machine import chart_histogram
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.evaluate.true_pieces import TruePiece, TruePieces
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from tests import ROOT

FILE = ROOT / "scenarios" / "CutToLength" / "measured_line" / "scenario.toml"


@pytest.fixture(scope="module")
def recording() -> Recording:
    scenario = load_scenario(FILE)
    outputs = [v.name for v in scenario.recipe.variables.values() if not v.settable]
    (run,) = run_scenarios([scenario], outputs, threads=1)
    assert run.recording, run.failure
    return run.recording


@pytest.fixture(scope="module")
def charts(recording: Recording) -> dict[str, Chart]:
    return run_charts(load_scenario(FILE), recording)


def pieces(*errors: float, tolerance: float = 0.1) -> TruePieces:
    made = tuple(TruePiece(i, float(i), 800.0 + error, 800.0, 800.0) for i, error in enumerate(errors, 1))
    sigma = float(np.std(errors, ddof=1)) if len(errors) > 1 else float("nan")
    worst = max(errors, key=abs)
    return TruePieces(made, 800.0 + float(np.mean(errors)), sigma, worst, 1.0, 0.0, tolerance, tolerance, "mm", 1e4)


def test_the_bars_of_the_histogram_hold_each_piece_once() -> None:
    errors = np.random.default_rng(1).normal(0.01, 0.05, 200).tolist()
    bars, curve = chart_histogram(pieces(*errors)).traces
    middles, half = np.array(bars["x"]), 0.5 * bars["width"]
    counted = [sum(1 for e in errors if m - half <= e < m + half) for m in middles.tolist()]
    assert bars["y"] == counted
    assert sum(bars["y"]) == 200
    colours = [BAD if abs(middle) > 0.1 else OK for middle in middles.tolist()]
    assert bars["marker"]["color"] == colours
    assert {BAD, OK} == set(colours)
    # the curve is what a normal distribution puts into a bar of this width
    mean, sigma = float(np.mean(errors)), float(np.std(errors, ddof=1))
    for x, y in zip(curve["x"], curve["y"], strict=True):
        share = 0.5 * (erf((x + half - mean) / sigma / sqrt(2.0)) - erf((x - half - mean) / sigma / sqrt(2.0)))
        assert y == pytest.approx(200.0 * share, abs=2e-3 * 200.0)


@pytest.mark.parametrize("errors", [(0.02,), (0.02, 0.02, 0.02), (-0.3, 0.3)])
def test_few_or_equal_errors_have_a_histogram(errors: tuple[float, ...]) -> None:
    chart = chart_histogram(pieces(*errors))
    assert sum(chart.traces[0]["y"]) == len(errors)
    assert len(chart.traces) == (2 if len(set(errors)) > 1 else 1)
    low, high = chart.span
    assert low < -0.1
    assert high > 0.1


@pytest.mark.parametrize("allowed", [0.05, 0.11, 0.12, 0.5])
def test_a_tool_that_moves_too_far_in_the_cut_is_red(recording: Recording, tmp_path: Path, allowed: float) -> None:
    """In this run it moves by 0.1135 mm."""
    scenario = load_scenario(FILE)
    assert scenario.pieces
    scenario = replace(scenario, pieces=replace(scenario.pieces, movement=allowed))
    outcome = evaluate_run(scenario, recording)
    write_report(tmp_path / "report.html", scenario, recording, outcome)
    page = (tmp_path / "report.html").read_text("utf-8")
    figure = re.search(r'<div class="(\w*)"><dt>movement in the cut</dt>(.*?)</div>', page, re.DOTALL)
    assert figure
    assert figure[1] == ("met" if outcome.passed else "unmet")
    assert outcome.passed == (allowed > 0.1135)
    assert f"{allowed} mm allowed" in figure[2]


def test_true_and_believed_errors_are_drawn_at_their_cuts(charts: dict[str, Chart], recording: Recording) -> None:
    true, believed = charts["true"].traces[:2]
    assert len(true["x"]) == 12
    assert believed["x"] == true["x"]
    assert max(map(abs, believed["y"])) < 1e-9
    assert max(map(abs, true["y"])) == pytest.approx(0.0251, abs=1e-4)
    cutting = recording.values["tool.cutting"]
    assert all(cutting[np.searchsorted(recording.time, t - 1e-9)] for t in true["x"])


def test_the_force_is_drawn_with_the_limits_of_the_motor(charts: dict[str, Chart], recording: Recording) -> None:
    for name, row in (("axis", "y3"), ("force", "y")):
        drawn = [t for t in charts[name].traces if t["yaxis"] == row]
        limits = sorted(t["y"][0] for t in drawn if "limit" in t["name"])
        assert limits == [-3000.0, -900.0, 900.0, 3000.0]
        curve = next(t for t in drawn if t["name"] in ("motor", "working points"))
        force = recording.computed["load.force"]
        assert max(curve["y"]) == pytest.approx(float(force.max()), rel=0.02)
        assert min(curve["y"]) == pytest.approx(float(force.min()), rel=0.02)
    working = charts["force"].traces[0]
    velocity = np.interp(working["customdata"], recording.time, recording.computed["actual.slave.velocity"])
    assert working["x"] == pytest.approx(velocity.tolist(), abs=1e-3)


def test_the_axis_is_drawn_behind_its_setpoint(charts: dict[str, Chart], recording: Recording) -> None:
    """By as much as the row below shows."""
    curves = {t["name"]: t for t in charts["axis"].traces}
    setpoint, actual, error = (curves[name] for name in ("setpoint", "actual", "following error"))
    block = np.interp(setpoint["x"], recording.time, recording.values["slave.position"])
    assert setpoint["y"] == pytest.approx(block.tolist(), abs=1e-3)
    there = np.interp(error["x"], actual["x"], actual["y"])
    expected = np.interp(error["x"], setpoint["x"], setpoint["y"])
    assert (expected - there).tolist() == pytest.approx(error["y"], abs=0.15)  # the curves are thinned
    assert max(error["y"]) > 1.0
