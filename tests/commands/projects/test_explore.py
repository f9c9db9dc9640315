"""`motionsync explore`: the page that it writes, and its messages."""

from pathlib import Path

import pytest

from motionsync_fmu.explorer import page
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.fmus.prebuilt import Report, silent
from motionsync_fmu.interface.recipe import Recipe
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command
from tests.support.scenarios.explored import Explored, explored

FIRST = "Synchronizer/polynomial"


@pytest.fixture
def shared_fmus(fmus: Fmus, monkeypatch: pytest.MonkeyPatch) -> None:
    """The FMUs that the tests share are those that the command finds."""

    def prepare_fmus(recipes: list[Recipe], flavour: Flavour, report: Report = silent) -> list[Path]:
        return [fmus.built(flavour, recipe.name) for recipe in recipes]

    monkeypatch.setattr("motionsync_fmu.api.explore.prepare_fmus", prepare_fmus)


def test_a_block_becomes_a_page(motionsync: Command, shared_fmus: None, fmus: Fmus, tmp_path: Path) -> None:
    """The same bytes as when it is written anywhere else."""
    outcome = motionsync("explore", "synchronizer")
    assert outcome.status == 0, outcome.err
    file = tmp_path / "build" / "explore" / "Synchronizer.html"
    assert outcome.out == f"build/explore/Synchronizer.html  {file.stat().st_size / 1000:.0f} kB\n"
    assert file.read_bytes() == explored(fmus, "Synchronizer").file.read_bytes()


def test_a_scenario_of_ones_own_is_shown_first(
    motionsync: Command, shared_fmus: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    own = tmp_path / "mine" / "polynomial" / "scenario.toml"
    own.parent.mkdir(parents=True)
    own.write_bytes((ROOT / "scenarios" / FIRST / "scenario.toml").read_bytes())
    outcome = motionsync("explore", own, "--output", "pages", "--open")
    assert outcome.status == 0, outcome.err
    file = tmp_path / "pages" / "Synchronizer.html"
    assert opened == [file.as_uri()]
    names = [s["name"] for s in Explored(file).data["scenarios"]]
    shipped = ["example", *(s.name for s in page.scenarios_of("Synchronizer")[1:])]
    assert names == ["polynomial", *(name if name != "polynomial" else "polynomial_2" for name in shipped)]


def test_without_compilers_one_line_says_what_to_install(motionsync: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motionsync_fmu.api.explore.missing_for_native", lambda: "ziglang")
    outcome = motionsync("explore", "Synchronizer")
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith("motionsync: ziglang builds the page, and is not installed: pip install ")


def test_a_name_that_nothing_has_is_answered_with_the_nearest_one(motionsync: Command) -> None:
    outcome = motionsync("explore", "Synchroniser")
    assert (outcome.status, len(outcome.err.splitlines())) == (2, 1)
    assert "Synchroniser: no such file or folder; did you mean Synchronizer" in outcome.err


def test_a_page_is_of_one_block(motionsync: Command, tmp_path: Path) -> None:
    for name in (FIRST, "Follower/cyclic_park"):
        file = tmp_path / "both" / name / "scenario.toml"
        file.parent.mkdir(parents=True)
        file.write_bytes((ROOT / "scenarios" / name / "scenario.toml").read_bytes())
    outcome = motionsync("explore", "both")
    assert outcome.status == 2
    assert (
        outcome.err == "motionsync: both: scenarios of several blocks, Follower, Synchronizer; a page is of one block\n"
    )
