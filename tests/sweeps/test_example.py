"""docs/how_to/sweeps.md is true: its commands find the lengths in its tables, and its picture is drawn from them."""

import ast
import csv
import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.cut_to_length.machine_limits import shortest_pitch
from tests import ROOT
from tests.model.cut_to_length.harness import machine_data
from tests.model.cut_to_length.machine_results import CYCLES
from tests.support.project.command_line import Command
from tests.support.project.pictures import assert_same_picture
from tools.shortest_length_picture import BoundaryCurves, compare_with, draw_picture

DOCS = ROOT / "docs"
PAGE = (DOCS / "how_to" / "sweeps.md").read_text("utf-8")
BLOCKS = ("CutToLength", "FlyingSaw")


def command(block: str) -> list[str]:
    """The words of the command of the page that made the block's table, after `motionsync`."""
    joined = PAGE.replace("\\\n", "")
    (line,) = re.findall(rf"^    motionsync (search {block}/any_length .* --output {block})$", joined, re.M)
    return shlex.split(line)


def rows(block: str) -> list[dict[str, str]]:
    """The rows of the block's table."""
    with (DOCS / "shortest_length" / f"{block}.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def read_curves(block: str) -> BoundaryCurves:
    return BoundaryCurves.read(DOCS / "shortest_length" / f"{block}.csv")


@pytest.mark.parametrize("block", BLOCKS)
@pytest.mark.parametrize("share", [0.0, 0.55, 1.0])
def test_the_commands_find_what_the_tables_have(motionsync: Command, block: str, share: float) -> None:
    """At some of the points."""
    expected = rows(block)[round(share * (len(rows(block)) - 1))]
    words = command(block)[:-2]  # without a folder
    for i, word in enumerate(words):
        name = word.partition("=")[0]
        if name in ("master.velocity", "axis.max_acceleration"):
            words[i] = f"{name}={expected[name]}"
    done = motionsync(*words, "--json", "--workers", "1")
    assert done.status == 0
    (row,) = json.loads(done.out)
    assert row["length"] == pytest.approx(float(expected["length"]), rel=1e-12)
    assert row["runs"] == int(expected["runs"])


@pytest.mark.parametrize("block", BLOCKS)
def test_the_tables_are_those_of_the_whole_commands(block: str) -> None:
    """Each combination of the grid has its row."""
    grid: dict[str, Any] = {
        name: {float(row[name]) for row in rows(block)} for name in ("master.velocity", "axis.max_acceleration")
    }
    velocities, limits = grid.values()
    assert sorted(velocities) == np.linspace(300.0, 1400.0, 56).tolist()
    assert len(limits) == {"CutToLength": 73, "FlyingSaw": 4}[block]
    assert len(rows(block)) == len(velocities) * len(limits)


def test_the_lengths_on_the_page_are_those_of_the_tables() -> None:
    error = re.findall(r"^\| (?:line at (\d+) m/min|the same), (\w+) \|(.*)\|$", PAGE, re.M)
    assert len(error) == 6
    velocity = ""
    for at, block, cells in error:
        velocity = at or velocity
        lengths = [float(cell.replace("mm", "")) for cell in cells.split("|")]
        for acceleration, length in zip((2e3, 5e3, 1e4, 2e4), lengths, strict=True):
            speeds, expected, _ = read_curves(block).curve(acceleration)
            (place,) = np.flatnonzero(speeds == float(velocity) / 0.06)
            assert length == round(float(expected[place]), 1)


def test_what_is_predicted_lies_between_what_works_and_what_does_not() -> None:
    """At all points; and the numbers in the text are right."""
    machine = read_curves("CutToLength")
    assert (machine.other_side <= machine.predicted * (1.0 + 1e-9)).all()
    assert (machine.length >= machine.predicted * (1.0 - 1e-9)).all()
    assert (machine.length / machine.other_side - 1.0).max() <= 1.0001e-6
    message = PAGE.replace("\n", " ")
    assert f"A search of {machine.runs:,} runs".replace(",", " ") in message
    assert f"at {len(machine.length)} points" in re.sub(" +", " ", message)


def test_how_much_more_the_saw_needs() -> None:
    compared = compare_with(read_curves("FlyingSaw"), read_curves("CutToLength"))
    assert len(compared.length) == 224
    share = 100.0 * (compared.length / compared.predicted - 1.0)
    (least, most) = re.findall(r"The FlyingSaw needs (\S+) to (\S+) % more", PAGE)[0]
    assert (round(share.min(), 1), round(share.max(), 1)) == (float(least), float(most))


def test_the_examples_in_python_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    sweeping, searching = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    exec(sweeping, {"__name__": "__main__"})
    number, columns = capsys.readouterr().out.split(" ", 1)
    assert number == "90"
    assert sum(ast.literal_eval(columns)["passed"]) == passing()
    exec(searching, {"__name__": "__main__"})
    lengths = [row["length"] for row in ast.literal_eval(capsys.readouterr().out)]
    assert lengths == pytest.approx([cycle.shortest_pitch for cycle in CYCLES.values()], rel=1e-6)


def passing() -> int:
    """At how many of the example's points pieces are long enough, by the prediction of the block."""
    machine = machine_data()
    return sum(
        length >= shortest_pitch(machine, velocity)
        for length in np.linspace(600.0, 1500.0, 10)
        for velocity in np.linspace(400.0, 1200.0, 9)
    )


def test_the_picture_is_drawn_from_the_tables() -> None:
    made = draw_picture(read_curves("CutToLength"), read_curves("FlyingSaw"))
    assert_same_picture(made, DOCS / "shortest_length.svg")
