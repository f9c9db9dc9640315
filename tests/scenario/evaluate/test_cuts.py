"""Cuts: how a scenario describes them, how they are found, and what is expected of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.scenario.cutting import CutSpec
from motionsync_fmu.scenario.evaluate.cuts import find_cuts
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import simulate
from tests import ROOT
from tests.support.scenarios.scenario_texts import VALID, assert_refused
from tests.support.scenarios.verdicts import checks_of

CUTS = """
[cuts]
while = "syn_synchronized"
length = 20.0
offset = 3.0
ratio = 1.5
tolerance = 0.25
count = 2
"""


@pytest.mark.parametrize(
    ("old", "new", "key", "parts"),
    [
        ("[cuts]", "[[cuts]]", "cuts", ("must be a table: [cuts]",)),
        ("offset", "ofset", "ofset", ("unknown key", "offset")),
        ('while = "syn_synchronized"\n', "", "while", ("missing",)),
        ('"syn_synchronized"', "true", "while", ("True", "text")),
        ("syn_synchronized", "syn_synchronised", "while", ("do you mean 'syn_synchronized'?",)),
        ("syn_synchronized", "slave.position", "while", ("continuous Real output", "not a Boolean output or local")),
        ("syn_synchronized", "active", "while", ("discrete Boolean input", "not a Boolean output")),
        ("length = 20.0\n", "", "length", ("missing",)),
        ("length = 20.0", "length = 0.0", "length", ("0", "> 0")),
        ("length = 20.0", "length = nan", "length", ("finite",)),
        ("length = 20.0", 'length = "20"', "length", ("'20'", "number")),
        ("offset = 3.0", "offset = inf", "offset", ("finite",)),
        ("ratio = 1.5", "ratio = 0", "ratio", ("0 is not allowed",)),
        ("tolerance = 0.25", "tolerance = -1.0", "tolerance", ("-1", ">= 0")),
        ("count = 2", "count = 2.5", "count", ("2.5", "whole number")),
        ("count = 2", "count = -1", "count", ("-1", ">= 0")),
        ("count = 2", "count = true", "count", ("number",)),
        ("", "", "cuts", ("linear axis", "master.period is 360")),
    ],
)
def test_a_mistake_in_cuts_is_reported_with_its_line(
    old: str, new: str, key: str, parts: tuple[str, ...], tmp_path: Path
) -> None:
    accepted = VALID.replace('"master.period" = 360.0\n', "") if old else VALID
    text = accepted + CUTS.replace(old, new) if old else accepted + CUTS
    at = next((i for i, line in enumerate(text.splitlines(), 1) if i > 42 and line.startswith(f"{key} =")), "[cuts]")
    assert_refused(text, tmp_path, at, key, *parts)


def test_cuts_are_read(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    linear = VALID.replace('"master.period" = 360.0\n', "")
    file.write_text(linear + CUTS)
    assert load_scenario(file).cuts == CutSpec("syn_synchronized", 20.0, 3.0, 1.5, 0.25, 2)
    file.write_text(linear + '[cuts]\nwhile = "ready"\nlength = 5\n')
    assert load_scenario(file).cuts == CutSpec("ready", 5.0, 0.0, 1.0, 0.0005, None)
    file.write_text(linear)
    assert load_scenario(file).cuts is None


def recording_of(places: list[float | None], ratio: float) -> Recording:
    """A saw that lags behind the material by these numbers, at 0, 0.1, 0.2 ... s; None: it does not cut."""
    n = len(places)
    master = np.zeros((n, 4))
    master[:, 0] = 7.0 * np.arange(n)
    slave = [ratio * (m - (p or 0.0)) for m, p in zip(master[:, 0].tolist(), places, strict=True)]
    on = [float(p is not None) for p in places]
    values = {"slave.position": np.array(slave), "in_sync": np.array(on)}
    return Recording(0.1 * np.arange(n), values, master, [])


@pytest.mark.parametrize("ratio", [1.0, -2.0, 0.5])
def test_each_interval_is_a_cut_and_its_error_the_greatest_distance_from_its_mark(ratio: float) -> None:
    places = [3.0, 3.0, None, 22.75, 23.5, 23.25, None, None, 62.5, None, -37.0, -37.5]
    cuts = find_cuts(CutSpec("in_sync", 20.0, 3.0, ratio, 0.1, None), recording_of(places, ratio))
    assert [(round(c.begin, 9), round(c.end, 9)) for c in cuts] == [(0.0, 0.1), (0.3, 0.5), (0.8, 0.8), (1.0, 1.1)]
    assert [c.mark for c in cuts] == [3.0, 23.0, 63.0, -37.0]
    assert [c.error for c in cuts] == pytest.approx([0.0, 0.5, -0.5, -0.5], abs=1e-12)


def test_without_a_cut_there_is_none() -> None:
    assert find_cuts(CutSpec("in_sync", 20.0, 0.0, 1.0, 0.1, None), recording_of([None] * 5, 1.0)) == []


@pytest.mark.parametrize(
    ("cuts", "expected"),
    [
        (
            "length = 20.0\noffset = 0.5\ntolerance = 0.5000001\ncount = 1",
            [("1", True), ("at most 0.5 deg away", True)],
        ),
        ("length = 20.0\noffset = 0.5\ntolerance = 0.4999\ncount = 2", [("1", False), ("at most 0.5 deg away", False)]),
        ("length = 20.0\ntolerance = 1e-9", [("at most", True)]),
        ("length = 20.0", [("at most", True)]),
        ("length = 20.0\noffset = 0.0021", [("at most 0.0021 deg away", False)]),  # a ten-thousandth: 0.002 deg
        ("length = 20.0\noffset = 0.0019", [("at most 0.0019 deg away", True)]),
    ],
)
def test_cuts_are_expectations(cuts: str, expected: list[tuple[str, bool]], fmu: Path, tmp_path: Path) -> None:
    """The Synchronizer's slave is the master until its ramp starts, and comes to rest for good."""
    file = tmp_path / "scenario.toml"
    linear = VALID.replace('"master.period" = 360.0\n', "")
    file.write_text(f'{linear}[cuts]\nwhile = "syn_synchronized"\n{cuts}\n')
    scenario = load_scenario(file)
    result = checks_of(scenario, simulate(scenario, fmu, 0.01))[len(scenario.expectations) :]
    for c, (beginning, passed) in zip(result, expected, strict=True):
        assert c.actual.startswith(beginning)
        assert c.passed == passed


def test_no_cut_at_all_breaks_a_tolerance() -> None:
    recording = recording_of([None] * 5, 1.0)
    scenario = replace(
        load_scenario(ROOT / "scenarios" / "Synchronizer" / "polynomial" / "scenario.toml"),
        expectations=(),
        settings=(),
    )
    (check,) = checks_of(replace(scenario, cuts=CutSpec("in_sync", 20.0, 0.0, 1.0, 1.0, None)), recording)
    assert (check.actual, check.passed) == ("no cut", False)
