"""The page of a block: it loads nothing, its native run is the scenario's without its expectations, and it has the
start values and the limits of an encoder as scenario files have them."""

import hashlib
from pathlib import Path

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.explorer import page
from motionsync_fmu.scenario.files.reader import load_scenario
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.explored import explored


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


def test_the_page_has_the_start_values_of_the_file(fmus: Fmus) -> None:
    """What follows from the encoder follows on the page, too, from the encoder that is chosen there."""
    stored = explored(fmus, "CutToLength").scenario("measured_line")
    assert stored["start"] == {"length": 800.0, "auto_start": 1, "master.delay": 0.004, "approach.reserve": 0.2}
    assert stored["encoder"]["delay"] == 0.002


@pytest.mark.parametrize(
    ("key", "limit", "beyond"), [("resolution", "smallest", 0.5), ("noise", "most", 2.0), ("delay", "longest", 2.0)]
)
def test_the_page_has_the_limits_at_which_an_encoder_is_refused(
    fmus: Fmus, tmp_path: Path, key: str, limit: str, beyond: float
) -> None:
    x = explored(fmus, "Gearing").data["runner"]["encoder"][limit]
    file = tmp_path / "scenario.toml"
    head = 'title = "A line"\nfmu = "Gearing"\nstop_time = 1.0\nstep_size = 0.01\n[master]\nvelocity = 50.0\n'
    file.write_text(f"{head}[encoder]\n{key} = {x}\n")
    encoder = load_scenario(file).encoder
    assert encoder
    assert getattr(encoder, key) == x
    file.write_text(f"{head}[encoder]\n{key} = {beyond * x}\n")
    with pytest.raises(UserError, match=key):
        load_scenario(file)
