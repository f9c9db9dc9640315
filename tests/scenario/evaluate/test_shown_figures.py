"""Figures of a run that are what they seem to be: peaks, the margin of a knife's line, the process capability."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.pages.summary import figure_rows
from motionsync_fmu.scenario.evaluate.key_figures import KeyFigures, compute_key_figures
from motionsync_fmu.scenario.evaluate.outcome import ScenarioOutcome, evaluate_run
from motionsync_fmu.scenario.evaluate.true_pieces import capability
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script
from motionsync_fmu.scenario.servo import Servo
from tests import ROOT


def knife(velocity: float, length: float, step_size: float) -> Scenario:
    """A knife with a circumference of 600 that cuts pieces of one length, within limits that are far away."""
    formats = load_scenario(ROOT / "scenarios/RotaryKnife/formats/scenario.toml")
    far = dict.fromkeys(("axis.max_velocity", "axis.max_acceleration", "axis.max_jerk"), 1e9)
    return replace(
        formats,
        start=dict(formats.start) | far | {"length": length, "auto_start": True},
        master=Script(0.0, velocity, 0.0, []),
        settings=(),
        expectations=(),
        stop_time=12.0 * length / velocity,
        step_size=step_size,
    )


def figures_of(scenario: Scenario) -> KeyFigures:
    return compute_key_figures(scenario, run_in_process(scenario, scenario.step_size))


# --- peaks ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("velocity", [400.0, 730.0, 1000.0])
@pytest.mark.parametrize("step_size", [0.003, 0.0171])
def test_the_peaks_of_a_knife_do_not_depend_on_the_step(velocity: float, step_size: float) -> None:
    """Pieces of 400: the scenario `formats` has the peaks at 1000 mm/s by hand, which grow with v^2 and v^3; the speed
    is 2.102941 times 600 deg/s in the middle of the way."""
    figures = figures_of(knife(velocity, 400.0, step_size))
    peaks = {peak.name: peak.value for peak in figures.peaks}
    share = velocity / 1000.0
    assert peaks["velocity"] == pytest.approx(2.102941 * 600.0 * share, rel=1e-6)
    assert peaks["acceleration"] == pytest.approx(5993.255390 * share**2, rel=1e-6)
    assert peaks["jerk"] == pytest.approx(183187.461836 * share**3, rel=1e-6)
    assert figures.peaks_text == "as the block knows them, else at the communication points"


def test_a_cycle_that_the_axis_cannot_do_is_no_peak() -> None:
    """The line is too fast: the block shows a cycle that it does not carry out, beyond the limit of the jerk, 1e6."""
    scenario = load_scenario(ROOT / "scenarios/RotaryKnife/late_stop_line/scenario.toml")
    recording = run_in_process(scenario, scenario.step_size)
    assert recording.values["peaks.jerk"].max() > 1.2e6
    (jerk,) = (peak for peak in compute_key_figures(scenario, recording).peaks if peak.name == "jerk")
    assert jerk.value <= 1e6 * (1.0 + 1e-6)


@pytest.mark.parametrize("block", ["Gearing/rotary_axes", "FlyingSaw/diagonal_saw", "Synchronizer/polynomial"])
def test_peaks_that_no_block_shows_are_said_to_be_those_at_the_points(block: str) -> None:
    scenario = load_scenario(ROOT / f"scenarios/{block}/scenario.toml")
    outcome = evaluate_run(scenario, run_in_process(scenario, scenario.step_size))
    assert dict(figure_rows(outcome))["peaks"] == "at the communication points"
    assert {peak["own"] for peak in outcome.as_json()["peaks"]} == {0.0}


# --- the reserve ------------------------------------------------------------------------------------------------------


def reserve(scenario: Scenario) -> str:
    production = figures_of(scenario).production
    assert production
    return production.reserve_text


@pytest.mark.parametrize("velocity", [300.0, 640.0, 1080.0])
def test_the_reserve_of_a_knife_is_the_margin_of_its_line(velocity: float) -> None:
    """With the limits of the scenario `formats` pieces of 300 may be cut up to 1085.767047 mm/s."""
    scenario = knife(velocity, 300.0, 0.005)
    start = {name: value for name, value in scenario.start.items() if not name.startswith("axis.")}
    text = reserve(replace(scenario, start=start))
    (percent,) = re.findall(r"^the line at least ([\d.]+) % below its limit$", text)
    assert float(percent) == pytest.approx(100.0 * (1.0 - velocity / 1085.767047), rel=5e-3)


def test_a_line_above_the_limit_of_a_knife_has_no_margin() -> None:
    """1800 of 1761 mm/s."""
    text = reserve(load_scenario(ROOT / "scenarios/RotaryKnife/late_skip/scenario.toml"))
    (percent,) = re.findall(r"^the line up to ([\d.]+) % above its limit$", text)
    assert float(percent) == pytest.approx(100.0 * (1800.0 / 1761.0 - 1.0), abs=0.05)


def test_the_reserve_of_a_saw_is_that_of_a_cycle() -> None:
    assert reserve(load_scenario(ROOT / "scenarios/CutToLength/basic_cut/scenario.toml")).endswith(" of a cycle")


# --- the process capability -------------------------------------------------------------------------------------------


@given(
    st.floats(10.0, 1e5),
    st.lists(st.integers(-40, 40), min_size=2, max_size=30),
    st.floats(-0.09, 0.09),
)
def test_where_sigma_is_rounding_there_is_no_process_capability(scale: float, noise: list[int], mean: float) -> None:
    """Errors that differ by some last bits of positions."""
    errors = [mean + n * float(np.spacing(scale)) for n in noise]
    assert capability(errors, 0.1, scale) == np.inf
    assert capability(errors, 0.5 * abs(mean) - 1e-9, scale) == -np.inf


@given(st.floats(10.0, 1e5), st.floats(1e-3, 1.0))
def test_where_sigma_is_more_there_is_one(scale: float, sigma: float) -> None:
    """Of two errors, s and -s, sigma is sqrt(2) s."""
    assert capability([sigma, -sigma], 3.0, scale) == pytest.approx(3.0 / (3.0 * np.sqrt(2.0) * sigma))


@pytest.mark.parametrize("velocity", [250.0, 400.0])
def test_an_exact_run_shows_no_process_capability(velocity: float) -> None:
    """From a steady line each piece is as long as the one before, behind a servo, too."""
    scenario = replace(knife(velocity, 600.0, 0.01), servo=Servo(50.0, 0.003, 1.0, 0.002))
    recording = run_in_process(scenario, 0.01)
    outcome: ScenarioOutcome = evaluate_run(scenario, recording)
    true = outcome.figures.true_pieces
    assert true
    assert len(true.pieces) > 5
    late = replace(true, pieces=true.pieces[3:])
    assert capability([piece.error for piece in late.pieces], 0.5, outcome.figures.scale) == np.inf
    exact = replace(outcome, figures=replace(outcome.figures, true_pieces=replace(true, deviation=1e-13, c_pk=np.inf)))
    assert "C_pk" not in dict(figure_rows(exact))["sigma"]
    assert json.loads(json.dumps(exact.as_json()))["true_pieces"]["c_pk"] is None
