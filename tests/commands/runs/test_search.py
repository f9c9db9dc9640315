"""`motionsync search`: its table, its files, its folder, and its messages about mistakes."""

import csv
import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.support.project.command_line import Command, assert_one_line
from tests.support.scenarios.scenario_texts import EVEN_RAMP, write_scenario

VELOCITY = "master.velocity=100..5000"


@pytest.fixture
def ramp(tmp_path: Path) -> Path:
    """A scenario whose peak acceleration is at its limit where the line has 730.296743 mm/s."""
    return write_scenario(EVEN_RAMP, tmp_path)


def test_the_command_prints_a_table(motionsync: Command, ramp: Path) -> None:
    outcome = motionsync("search", ramp, "--vary", VELOCITY, "--until", "fault == 0", "--workers", "1")
    assert outcome.status == 0
    head, row, last = outcome.out.splitlines()
    assert head.split() == ["point", "master.velocity", "master.velocity.beside", "holds", "runs"]
    assert row.split()[3] == "below"
    assert float(row.split()[1]) == pytest.approx(730.296743, rel=1e-6)
    assert last == f"1 point, {row.split()[-1]} runs"


def test_the_command_writes_json_and_csv(motionsync: Command, ramp: Path) -> None:
    arguments = (
        "--vary",
        "master.velocity=300..700",
        "--until",
        "fault == 0",
        "--set",
        "axis.max_acceleration=3000,1e6",
    )
    outcome = motionsync("search", ramp, *arguments, "--workers", "1", "--json", "--output", "boundaries")
    rows = json.loads(outcome.out)
    assert rows[1]["master.velocity"] is None
    with Path("boundaries/boundaries.csv").open(newline="") as stream:
        file_rows = list(csv.DictReader(stream))
    assert [float(row["axis.max_acceleration"]) for row in file_rows] == [3000.0, 1e6]
    assert float(file_rows[0]["master.velocity"]) == rows[0]["master.velocity"]
    assert file_rows[1]["master.velocity"] == ""


def test_the_scenario_is_parsed_once(motionsync: Command, ramp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text, loads = ramp.read_text("utf-8"), tomllib.loads
    parsed: list[bool] = []

    def count(given: str) -> dict[str, Any]:
        parsed.append(given == text)
        return loads(given)

    monkeypatch.setattr(tomllib, "loads", count)
    condition = ("--until", "slave.acceleration.max < 5000", "--measure", "slave.velocity=max")
    assert motionsync("search", ramp, "--vary", VELOCITY, *condition, "--workers", "1").status == 0
    assert sum(parsed) == 1


def test_the_same_command_goes_on_and_another_is_refused(motionsync: Command, ramp: Path) -> None:
    arguments = ("search", ramp, "--vary", VELOCITY, "--workers", "1", "--output", "boundaries", "--until")
    first = motionsync(*arguments, "fault == 0")
    part = Path("boundaries/part-000000.parquet")
    written = part.stat().st_mtime_ns
    assert motionsync(*arguments, "fault == 0").out == first.out
    assert part.stat().st_mtime_ns == written
    assert_one_line(motionsync(*arguments, "fault == 1"), "until", "fault == 1", "fault == 0")
    assert_one_line(motionsync(*arguments, "fault == 0", "--relative", "1e-3"), "relative", "0.001")


def test_the_folder_of_a_search_is_no_sweep_s(motionsync: Command, ramp: Path) -> None:
    assert motionsync("search", ramp, "--vary", VELOCITY, "--until", "fault == 0", "--output", "boundaries").status == 0
    error = "boundaries is the folder of a search, not of a sweep"
    assert_one_line(motionsync("sweep-plot", "boundaries", "--x", "run", "--y", "passed"), error)
    assert_one_line(motionsync("sweep", ramp, "--set", "master.velocity=100,5000", "--output", "boundaries"), error)


@pytest.mark.parametrize(
    ("changed", "parts"),
    [
        ({"--vary": "master.velocity"}, ("--vary master.velocity: write NAME=low..high",)),
        ({"--vary": "master.velocity=1:2:3"}, ("1:2:3 is no range: write NAME=low..high",)),
        ({"--vary": "master.velocity=a..b"}, ("'a' is no number",)),
        ({"--vary": "master.velocity=3..3"}, ("the range is empty",)),
        ({"--vary": "master.velocity=30..3"}, ("the range is reversed",)),
        ({"--vary": "master.velocity=3..inf"}, ("inf is not allowed: it must be finite",)),
        ({"--vary": "master.velocty=3..30"}, ("master.velocty", "master.velocity")),
        ({"--vary": "gear_in_pos.ratio_denominator=1..3"}, ("gear_in_pos.ratio_denominator", "nothing to halve")),
        ({"--set": "master.velocity=500"}, ("master.velocity is given twice",)),
        ({"--set": "cuts.length=5"}, ("cuts",)),
        ({"--method": "dice"}, ("no method is named 'dice'", "lhs, sobol")),
        ({"--set": "axis.max_jerk=2..1"}, ("axis.max_jerk", "reversed")),
        ({"--until": "fault"}, ("fault == 1: compare fault with a number",)),
        ({"--until": "fault = 0"}, ("'fault = 0' is neither COLUMN == VALUE",)),
        ({"--until": "faults == 0"}, ("no column of a row is named 'faults'", "fault")),
        ({"--until": "slave.velocity.greatest > 1"}, ("greatest", "max")),
        ({"--relative": "0"}, ("--relative 0 is not allowed",)),
        ({"--relative": "1"}, ("--relative 1 is not allowed",)),
        ({"--relative": "fine"}, ("--relative fine: it must be a number",)),
        ({"--workers": "0"}, ("workers = 0 is not allowed",)),
    ],
)
def test_a_mistake_has_one_line(
    motionsync: Command, ramp: Path, changed: dict[str, str], parts: tuple[str, ...]
) -> None:
    given = {"--vary": VELOCITY, "--until": "fault == 0"} | changed
    assert_one_line(motionsync("search", ramp, *(word for option in given.items() for word in option)), *parts)


def test_a_search_needs_one_scenario(motionsync: Command) -> None:
    assert_one_line(motionsync("search", "FlyingSaw", "--vary", "a=1..2", "--until", "passed"), "name one of them")
