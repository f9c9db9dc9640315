"""`motionsync new`: a short scenario that runs, and goes on being valid when its figures are changed."""

import re
import tomllib
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu import new
from motionsync_fmu.commands import new as command
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.scenario.files.new_scenario import figures
from motionsync_fmu.sweeps.rows import rows
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import PYTHON

TUBE = ("--length", "6000", "--line-speed", "40 m/min", "--stroke", "5000", "--max-velocity", "2000")
TUBE += ("--max-acceleration", "4000", "--cut-time", "2 s")
BEYOND = {  # a value that the machine cannot do, and what the row says of it
    "CutToLength": ("master.velocity=1500", "number of skipped cuts = 0"),
    "RotaryKnife": ("master.velocity=9000", "number of skipped cuts = 0"),
    "FlyingSaw": ("master.velocity=1900", ""),
}


def test_a_new_scenario_runs_as_expected(motionsync: Command, fmus: Fmus) -> None:
    fmus.copied(Flavour.PYTHON, "Synchronizer", Path("build"))
    outcome = motionsync("new", "synchronizer", "mine/first")
    assert (outcome.status, outcome.err) == (0, "")
    file = Path("mine/first/scenario.toml")
    assert outcome.out.splitlines()[:2] == [f"written: {file}", f"run it:  motionsync run {file.parent} --open"]
    outcome = motionsync("run", "mine/first", *PYTHON, "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert ": as expected\n" in outcome.out
    assert_one_line(motionsync("new", "Synchronizer", "mine/first"), str(file), "exists")


@pytest.mark.parametrize("name", BLOCKS)
def test_a_new_scenario_is_short_and_each_figure_has_a_line_that_says_what_it_is(name: str, tmp_path: Path) -> None:
    text = new(name, tmp_path).read_text("utf-8")
    assert len(text.splitlines()) <= 40
    assert [figure.name for figure in figures(name)] != []
    for figure in figures(name):
        assert re.search(rf' = "?{re.escape(figure.value)}"? +# {re.escape(figure.meaning)}$', text, re.M)
        assert len(figure.meaning.split()) >= 3


@pytest.mark.parametrize("name", BEYOND)
def test_what_the_machine_cannot_do_is_not_as_expected(name: str, tmp_path: Path) -> None:
    """What it can do is (test_new_comments.py)."""
    setting, reason = BEYOND[name]
    (row,) = rows(SweepPlan.of(new(name, tmp_path), [setting]), 0, 1).to_pylist()
    assert not row["passed"]
    assert reason in row["first_broken"]


def test_the_figures_of_a_machine_are_options(motionsync: Command) -> None:
    assert motionsync("new", "CutToLength", "tube", *TUBE).status == 0
    text = Path("tube/scenario.toml").read_text("utf-8")
    tables = tomllib.loads(text)
    assert tables["master"] == {"velocity": "40 m/min"}
    assert tables["start"] == {
        "length": 6000.0,
        "axis.max_position": 5000.0,
        "axis.max_velocity": 2000.0,
        "axis.max_acceleration": 4000.0,
        "axis.max_jerk": 100000.0,
        "tool.cut_time": "2 s",
        "kerf": 0.0,
    }
    untouched = new("CutToLength", "untouched").read_text("utf-8")
    comments = [line.partition("#")[::2] for line in untouched.splitlines()]
    assert [line.partition("#")[2] for line in text.splitlines()] == [comment for _, comment in comments]
    plan = SweepPlan.of(Path("tube/scenario.toml"), ["kerf=0"])
    (row,) = rows(plan, 0, 1).to_pylist()
    assert (row["passed"], row["cuts"]) == (True, 6)  # 40 m in a minute


@pytest.mark.parametrize("blades", [2, 3, 6])
def test_a_knife_has_as_many_blades_as_given(blades: int, motionsync: Command) -> None:
    """With the circumference of so many pieces the cylinder turns evenly: a piece is cut each 0.6 s."""
    circumference = str(600 * blades)
    outcome = motionsync("new", "RotaryKnife", "mine", "--blades", str(blades), "--circumference", circumference)
    assert (outcome.status, outcome.err) == (0, "")
    assert tomllib.loads(Path("mine/scenario.toml").read_text("utf-8"))["start"]["knife.blades"] == blades
    (row,) = rows(SweepPlan.of(Path("mine/scenario.toml"), ["length=600"]), 0, 1).to_pylist()
    assert row["passed"]
    assert_one_line(motionsync("new", "RotaryKnife", "other", "--blades", "2.5"), "--blades 2.5", "whole number")
    assert not Path("other").exists()
    many = motionsync("new", "RotaryKnife", "other", "--blades", "65")
    assert_one_line(many, "knife.blades", "65", "64")


@pytest.mark.parametrize("value", ["0", "-5", "-0.1", "0.0 m", "-6 m", "-1e3", "-5 ft 6 in"])
def test_a_figure_that_no_machine_has_is_refused_by_its_option(motionsync: Command, block: str, value: str) -> None:
    for figure in figures(block):
        option = f"--{figure.name.replace('_', '-')}"
        outcome = motionsync("new", block, "mine", f"{option}={value}")
        assert_one_line(outcome, f"{option} {value}: it must be above 0")
        assert not Path("mine").exists()


def test_figures_are_asked_for_at_a_terminal(motionsync: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is given by an option is not asked for; Enter takes what is proposed."""
    questions: list[str] = []

    def answer(question: str, default: str) -> str:
        questions.append(question)
        return {"stroke": "5 m"}.get(question.partition(",")[0], default)

    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr(command.typer, "prompt", answer)
    assert motionsync("new", "CutToLength", "asked", "--length", "2 m").status == 0
    assert [question.partition(",")[0] for question in questions] == [
        "line speed",
        "stroke",
        "max velocity",
        "max acceleration",
        "cut time",
    ]
    start = tomllib.loads(Path("asked/scenario.toml").read_text("utf-8"))["start"]
    assert (start["length"], start["axis.max_position"]) == ("2 m", "5 m")
    assert start["axis.max_velocity"] == 2000.0


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("Gearing", "x", "--stroke", "5000"), ("no figure of Gearing is named 'stroke'", "line_speed")),
        (("CutToLength", "x", "--line-speed", "fast"), ("--line-speed fast: it must be a number", "40 m/min")),
        (("CutToLength", "x", "--line-speed", "40 m"), ("velocity: '40 m' is in m: it must be in mm/s",)),
        (("CutToLength", "x", "--max-velocity", "-5"), ("--max-velocity -5: it must be above 0",)),
    ],
)
def test_a_wrong_figure_is_named_and_nothing_is_written(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("new", *arguments), *parts)
    assert not Path("x").exists()
