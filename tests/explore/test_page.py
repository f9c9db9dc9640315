"""The page of a block: it loads nothing, and its native run is the scenario's without its expectations."""

import hashlib

import pytest

from motionsync_fmu.explore import page
from motionsync_fmu.scenario.files.reader import load_scenario
from tests import ROOT
from tests.support.explored import explored
from tests.support.fmus import Fmus


def test_a_page_loads_nothing(fmus: Fmus, block: str) -> None:
    text = explored(fmus, block).text
    assert "<link" not in text
    assert "<iframe" not in text
    assert " src=" not in text


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        ("uPlot.iife.min.js", "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f"),
        ("uPlot.min.css", "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04"),
    ],
)
def test_uplot_is_the_one_that_was_looked_at(name: str, digest: str) -> None:
    """The digests are those of the npm package uplot 1.6.32."""
    text = (page.VENDOR / name).read_bytes()
    assert hashlib.sha256(text).hexdigest() == digest
    assert b"</script" not in text


def test_the_native_run_of_the_page_expects_nothing(fmus: Fmus) -> None:
    """An expectation has communication points of its own; a run that is written down has none."""
    name = "Synchronizer/changing_master"
    loaded = load_scenario(ROOT / "scenarios" / name / "scenario.toml")
    assert loaded.expectations
    stored = explored(fmus, "Synchronizer").scenario("changing_master")
    assert stored["points"] == round(loaded.stop_time / loaded.step_size) + 1
