"""What the functions give and take, as who works with Python or in a notebook sees it."""

import inspect
import sys
from contextlib import suppress
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import motionsync_fmu
from motionsync import Gearing
from motionsync_fmu import Stepper, build, error, plan_line, run, search, simulate_many, sweep
from motionsync_fmu.pages import progress

CLASSES = [getattr(motionsync_fmu, name) for name in motionsync_fmu.__all__ if name[0].isupper()]
FUNCTIONS = [getattr(motionsync_fmu, name) for name in motionsync_fmu.__all__ if name[0].islower()]
METHODS = [member for each in CLASSES for _, member in inspect.getmembers(each, inspect.isfunction)]


@pytest.mark.parametrize("function", [*FUNCTIONS, *METHODS], ids=lambda f: f.__qualname__)
def test_help_shows_defaults_that_can_be_read(function: Any) -> None:
    with suppress(ValueError):  # of a class of Python's own
        assert "<" not in str(inspect.signature(function))


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What each kind of function gives, for two values of a scenario."""
    folder = tmp_path_factory.mktemp("results")
    lengths = {"length": [600.0, 800.0]}
    ran = run("CutToLength/basic_cut")
    plan = plan_line(length=[300.0])
    return {
        "CutToLength/basic_cut": ran,
        "as expected": ran.write(folder / "written", report=False),
        "Synchronizer.fmu": build("Synchronizer", flavour="python", output=folder),
        "0x42DE": error(17118),
        "2 of 2 runs": sweep("CutToLength/basic_cut", set=lengths, output=folder / "rows", workers=1),
        "predictions": plan,
        "CutToLength: ": plan.machines,
        "5 steps": simulate_many("Gearing", 0.01, {"master.position": np.arange(5.0)}, "slave.position"),
        "Gearing": Stepper(Gearing()),
    }


def test_a_result_says_what_it_is(results: dict[str, Any]) -> None:
    for part, result in results.items():
        text = repr(result)
        assert part in text
        assert len(text) < 1500
        assert "object at" not in text
        assert "Recipe(" not in text


@pytest.mark.parametrize("name", ["CutToLength/measured_line", "CutToLength/basic_cut", "Gearing/ccw_direct"])
def test_a_run_has_the_tape_measure_and_the_motor(name: str) -> None:
    """The keys of `motionsync run --json` that are there have the same values."""
    result = run(name)
    written = result.outcome.as_json()
    assert (result.true_pieces is None) == ("true_pieces" not in written)
    assert (result.load is None) == ("load" not in written)
    if name == "CutToLength/measured_line":
        assert result.true_pieces
        assert result.load
        assert [p.length for p in result.true_pieces.pieces] == [p["length"] for p in written["true_pieces"]["pieces"]]
        assert result.load.rms == written["load"]["rms"]


class Cell:
    """The output of a notebook's cell: what has been shown in it, and what is left."""

    def __init__(self) -> None:
        self.shown: list[str] = []

    def display(self, data: dict[str, str], raw: bool, display_id: bool) -> "Cell":
        assert raw
        assert display_id
        self.update(data, raw=raw)
        return self

    def update(self, data: dict[str, str], raw: bool) -> None:
        assert raw
        self.shown.append(data["text/plain"])


@pytest.fixture
def cell(monkeypatch: pytest.MonkeyPatch) -> Cell:
    """As in a notebook, where each count is shown at once."""
    made, shell, display = Cell(), ModuleType("IPython"), ModuleType("IPython.display")
    shell.get_ipython = lambda: SimpleNamespace(kernel=None)  # type: ignore[attr-defined]
    display.display = made.display  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setattr(progress, "CELL_INTERVAL", 0.0)
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    return made


def test_a_notebook_shows_how_far_a_sweep_is(cell: Cell, tmp_path: Path) -> None:
    sweep("CutToLength/basic_cut", set={"length": [600.0, 800.0, 900.0]}, output=tmp_path / "rows", workers=1, chunk=1)
    assert any("3 of 3 runs" in text for text in cell.shown)
    assert cell.shown[-1] == ""


def test_a_notebook_shows_how_far_a_search_is(cell: Cell) -> None:
    velocities = {"master.velocity": [500.0, 900.0]}
    search("CutToLength/any_length", vary="length=50..6000", until="passed", set=velocities, relative=0.1, workers=1)
    assert any("2 of 2 points" in text for text in cell.shown)
    assert cell.shown[-1] == ""


def test_a_notebook_shows_what_is_built_and_planned(cell: Cell, tmp_path: Path) -> None:
    build("Gearing", flavour="python", output=tmp_path)
    assert f"building {tmp_path / 'python' / 'Gearing.fmu'}" in cell.shown
    plan_line(length=[300.0])
    assert any("planning the line" in text for text in cell.shown)
    assert cell.shown[-1] == ""


def test_what_the_caller_takes_is_not_shown(cell: Cell, tmp_path: Path) -> None:
    counts: list[tuple[int, int]] = []
    sweep(
        "CutToLength/basic_cut",
        set={"length": [600.0]},
        output=tmp_path,
        workers=1,
        progress=lambda done, runs: counts.append((done, runs)),
    )
    assert counts[-1] == (1, 1)
    assert cell.shown == []


def test_outside_a_notebook_nothing_is_shown(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    sweep("CutToLength/basic_cut", set={"length": [600.0]}, output=tmp_path, workers=1)
    assert capfd.readouterr() == ("", "")
