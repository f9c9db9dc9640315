"""`run` from Python: what it takes, what it gives, and its errors."""

import csv
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.master import MasterInput
from motionsync_fmu import RunResult, UserError, run, scenarios
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_scenario
from tests import ROOT

SAW = {
    "title": "My saw",
    "fmu": "CutToLength",
    "stop_time": 6.0,
    "step_size": 0.01,
    "start": {
        "length": np.float64(800.0),
        "axis.max_position": 900,
        "master.input_mode": MasterInput.START_OF_STEP,
    },
    "master": {"segments": ({"duration": 1.0, "acceleration": 500.0},)},
    "set": [{"at": 0.5, "start": True}],
    "cuts": {"tolerance": 0.01},
}


@pytest.fixture(scope="module")
def result() -> RunResult:
    return run("CutToLength/basic_cut")


def test_a_run_has_its_pieces_and_columns(result: RunResult) -> None:
    """docs of the scenario: pieces of 1500 mm at 1000 mm/s; two cuts in 5 s."""
    assert result.passed
    assert [piece.length for piece in result.pieces] == pytest.approx([1500.0, 1500.0], abs=1e-6)
    assert result.time.shape == result["slave.position"].shape == result["master.velocity"].shape
    assert result.time[[0, -1]].tolist() == [0.0, 5.0]
    assert result["statistics.cuts"][-1] == 2.0
    assert repr(result).startswith("CutToLength/basic_cut: as expected\n  made ")


def test_a_table_has_the_columns_of_the_csv_file(result: RunResult, tmp_path: Path) -> None:
    table = result.to_frame()
    outcome = result.write(tmp_path / "out", report=False)
    with Path(outcome.result).open(newline="") as file:
        header, *rows = csv.reader(file)
    assert table.column_names == header
    assert table.num_rows == len(rows)
    last = dict(zip(header, rows[-1], strict=True))
    assert table.column("slave.position")[-1].as_py() == float(last["slave.position"])
    assert table.column("running")[-1].as_py() is bool(int(last["running"]))
    assert str(table.schema.field("state").type) == "int64"


def test_other_values_and_another_step(result: RunResult) -> None:
    """At 650 mm/s for 5 s there is one cut of 1500 mm less; the reference belongs to the file's own values."""
    slow = run("CutToLength/basic_cut", set={"master.velocity": 650.0}, step_size=0.005)
    assert slow.time[1] == 0.005
    assert slow.scenario.master.at(1.0).velocity == 650.0
    assert len(slow.pieces) < len(result.pieces)
    assert slow.outcome.reference == []
    assert slow.outcome.overrides == {"master.velocity": "650.0"}


def test_a_scenario_without_a_file() -> None:
    """Acceleration to 500 mm/s, then 5 s: 250 + 2500 mm, of which the saw cuts 800 mm pieces."""
    made = run(SAW)
    assert made.passed, made.outcome.failed
    assert made.scenario.label == "CutToLength/My saw"
    assert len(made.pieces) >= 2
    assert made["master.position"][-1] == pytest.approx(2750.0, abs=1e-9)
    assert 'title = "My saw"' in made.scenario.text


def test_a_loaded_scenario_runs_as_it_is() -> None:
    scenario = load_scenario(find_scenario(Path("Synchronizer/polynomial")))
    short = replace(scenario, stop_time=1.0, expectations=())
    assert run(short, flavour="python").time[-1] == 1.0
    assert run(find_scenario(Path("Synchronizer/polynomial")), fmi="3").passed


def wrong_key() -> dict[str, Any]:
    return SAW | {"stop": 6.0}


def wrong_value() -> dict[str, Any]:
    return SAW | {"start": {"length": None}}


@pytest.mark.parametrize(
    ("scenario", "options", "message"),
    [
        (lambda: "CutToLength/basic_cuts", {}, "no such file or folder; did you mean CutToLength/basic_cut"),
        (lambda: "CutToLength", {}, "scenarios: name one of them"),
        (wrong_key, {}, "stop: unknown key; there is title"),
        (wrong_value, {}, "None is not allowed in a scenario"),
        (lambda: "CutToLength/basic_cut", {"set": {"kerf": -1}}, "kerf"),
        (lambda: "CutToLength/basic_cut", {"set": {"kerfs": 1.0}}, "kerfs"),
        (lambda: "CutToLength/basic_cut", {"step_size": 9.0}, "--step-size 9 is not allowed"),
        (lambda: "CutToLength/basic_cut", {"flavour": "wasm"}, "no flavour is named 'wasm'; there is native, python"),
        (lambda: "CutToLength/basic_cut", {"fmi": "1"}, "no version of FMI is named '1'; there is 2, 3"),
        (
            lambda: load_scenario(find_scenario(Path("CutToLength/basic_cut"))),
            {"set": {"kerf": 1.0}},
            "a loaded scenario is changed by dataclasses.replace",
        ),
    ],
)
def test_mistakes_are_named(scenario: Callable[[], Any], options: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        run(scenario(), **options)


def test_an_unknown_column_is_named(result: RunResult) -> None:
    with pytest.raises(UserError, match=r"no column is named 'slave.positions'; there is slave.position"):
        result["slave.positions"]


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    run("Synchronizer/polynomial")
    assert capfd.readouterr() == ("", "")


class Frame(HTMLParser):
    """Keeps the page of the only frame."""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag == "iframe"
        self.page = str(dict(attrs)["srcdoc"])


def test_a_notebook_shows_the_machine(result: RunResult) -> None:
    frame = Frame()
    frame.feed(result._repr_html_())
    assert "<strong>CutToLength/basic_cut</strong>: as expected" in frame.page
    assert 'class="motionsync-machine"' in frame.page
    assert "2 pieces" in frame.page


def test_a_report_is_written(result: RunResult, tmp_path: Path) -> None:
    page = result.report(tmp_path / "mine" / "report.html")
    assert page == tmp_path / "mine" / "report.html"
    assert "A first cut" in page.read_text("utf-8") or result.scenario.title in page.read_text("utf-8")


def test_scenarios_are_listed_by_the_names_that_run_takes() -> None:
    names = scenarios("cuttolength")
    assert "CutToLength/basic_cut" in names
    assert len(names) == len(list((ROOT / "scenarios" / "CutToLength").rglob("scenario.toml")))
    assert set(names) < set(scenarios())
    with pytest.raises(UserError, match="no block is named 'Saw'"):
        scenarios("Saw")


@pytest.mark.parametrize(("at", "step_size", "time"), [(0.5, 0.01, "0.51"), (1.25, 0.05, "1.3"), (0.333, 0.1, "0.4")])
def test_a_message_of_the_fmu_has_the_time_at_which_its_step_ended(at: float, step_size: float, time: str) -> None:
    """The denominator of 0 is refused in the step that begins with it."""
    gear = {
        "title": "A gear that cannot be engaged",
        "fmu": "Gearing",
        "stop_time": 2.0,
        "step_size": step_size,
        "master": {"velocity": 100.0},
        "set": [{"at": at, "start": True, "gearing.denominator": 0}],
    }
    (message,) = run(gear).messages
    assert message.startswith(f"at {time} s: refused: gearing.denominator = 0")
