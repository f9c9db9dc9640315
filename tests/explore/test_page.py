"""The command `motionsync explore`, and what lies in its page."""

import hashlib
from pathlib import Path

import pytest

from motionsync_fmu.build import Flavour
from motionsync_fmu.explore import page
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.reader import load
from tests import ROOT
from tests.support.command_line import Command
from tests.support.explored import Explored, explored
from tests.support.fmus import Fmus

FIRST = "Synchronizer/polynomial"


@pytest.fixture
def at_hand(fmus: Fmus, monkeypatch: pytest.MonkeyPatch) -> None:
    """The FMUs that the tests share are those that the command finds."""

    def ready(recipes: list[Recipe], flavour: Flavour) -> list[Path]:
        return [fmus.built(flavour, recipe.name) for recipe in recipes]

    monkeypatch.setattr("motionsync_fmu.commands.explore.ready", ready)


def test_a_block_becomes_a_page(motionsync: Command, at_hand: None, fmus: Fmus, tmp_path: Path) -> None:
    """The same bytes as when it is written anywhere else."""
    done = motionsync("explore", "synchronizer")
    assert done.status == 0, done.err
    file = tmp_path / "build" / "explore" / "Synchronizer.html"
    assert done.out == f"build/explore/Synchronizer.html  {file.stat().st_size / 1000:.0f} kB, 16 scenarios\n"
    assert file.read_bytes() == explored(fmus, "Synchronizer").file.read_bytes()


def test_a_scenario_of_ones_own_is_shown_first(
    motionsync: Command, at_hand: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    own = tmp_path / "mine" / "polynomial" / "scenario.toml"
    own.parent.mkdir(parents=True)
    own.write_bytes((ROOT / "scenarios" / FIRST / "scenario.toml").read_bytes())
    done = motionsync("explore", own, "--folder", "pages", "--open")
    assert done.status == 0, done.err
    file = tmp_path / "pages" / "Synchronizer.html"
    assert opened == [file.as_uri()]
    names = [s["name"] for s in Explored(file).data["scenarios"]]
    shipped = [s.name for s in page.scenarios_of("Synchronizer")]
    assert names == ["polynomial", *(name if name != "polynomial" else "polynomial_2" for name in shipped)]


def test_without_compilers_one_line_says_what_to_install(motionsync: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motionsync_fmu.commands.explore.missing_for_native", lambda: "ziglang")
    done = motionsync("explore", "Synchronizer")
    assert done.status == 2
    assert len(done.err.splitlines()) == 1
    assert done.err.startswith("motionsync: ziglang is not installed, with which the page is made: pip install ")


def test_a_name_that_nothing_has_is_told_with_the_nearest_one(motionsync: Command) -> None:
    done = motionsync("explore", "Synchroniser")
    assert (done.status, len(done.err.splitlines())) == (2, 1)
    assert "Synchroniser: no such file or folder; did you mean Synchronizer" in done.err


def test_a_page_is_of_one_block(motionsync: Command, tmp_path: Path) -> None:
    for name in (FIRST, "Follower/cyclic_park"):
        file = tmp_path / "both" / name / "scenario.toml"
        file.parent.mkdir(parents=True)
        file.write_bytes((ROOT / "scenarios" / name / "scenario.toml").read_bytes())
    done = motionsync("explore", "both")
    assert done.status == 2
    assert done.err == "motionsync: both: scenarios of several blocks, Follower, Synchronizer; a page is of one block\n"


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
    loaded = load(ROOT / "scenarios" / name / "scenario.toml")
    assert loaded.expectations
    known = explored(fmus, "Synchronizer").scenario("changing_master")
    assert known["points"] == round(loaded.stop_time / loaded.step_size) + 1
