"""`motionsync plan-line`: its tables, its page, and its messages about mistakes."""

import json
import re
from pathlib import Path

import pytest

from motionsync_fmu.plan import confirmation
from tests.model.cut_to_length.machine_results import CYCLES, GREATEST_VELOCITIES, to
from tests.plan.machines import REFERENCE
from tests.support.project.command_line import Command, assert_one_line

SAW = """\
title = "Saw 3"
lengths = [1500, 500]
velocities = "500,1000"

[start]
"axis.max_velocity" = 1500.0
"axis.max_jerk" = 200000.0
"axis.min_position" = -250.0
"axis.max_position" = 650.0
"approach.reserve" = 0.0
"""
SETTINGS = [option for name, value in REFERENCE.items() for option in ("--set", f"{name}={value}")]


def saw(text: str = SAW) -> Path:
    file = Path("saw.toml")
    file.write_text(text, "utf-8")
    return file


def rows(out: str, heading: str) -> list[list[str]]:
    """The cells of the table below a heading of the console, without the names of its columns."""
    _, _, rest = out.partition(f"{heading}")
    lines = [line.strip() for line in rest.splitlines()[2:]]
    end = next((i for i, line in enumerate(lines) if not line or line.startswith("report:")), len(lines))
    return [re.split(r"\s{2,}", line) for line in lines[:end]]


@pytest.mark.parametrize(
    ("lengths", "headline"),
    [
        ("1500", "1297.29 mm/s (77.84 m/min), for pieces of 1500 mm, limited by cycle time"),
        ("1500,500", "619.646 mm/s (37.18 m/min), for all given lengths, limited by pieces of 500 mm: cycle time"),
        ("500,900,1500", "619.646 mm/s (37.18 m/min), for all given lengths, limited by pieces of 500 mm: cycle time"),
    ],
)
def test_the_first_figure_is_that_of_the_lengths_that_are_asked_for(
    motionsync: Command, lengths: str, headline: str
) -> None:
    """The velocities as below."""
    outcome = motionsync("plan-line", saw(), "--length", lengths, "--no-report")
    assert f"  greatest line velocity: {headline}" in outcome.out


def test_a_knife_is_limited_by_the_length_that_suits_it_least(motionsync: Command) -> None:
    """Its blade, 600 mm around, is as fast as the material all along at 600 mm, where only the limit of its velocity
    counts, 10 turns a second; and its way is longer or shorter for others."""
    for lengths, worst in (("300,600", "300"), ("600", "600"), ("600,550,300", "300")):
        outcome = motionsync("plan-line", "--machine", "knife", "--length", lengths, "--no-report")
        assert f"pieces of {worst} mm" in outcome.out.splitlines()[1]
    outcome = motionsync("plan-line", "--machine", "knife", "--length", "600", "--no-report")
    assert outcome.out.splitlines()[1].startswith("  greatest line velocity: 6000 mm/s (360 m/min), for pieces of 600")


def test_a_file_is_planned(motionsync: Command) -> None:
    """Known: 619.646 for 500, 1297.29 for 1500; 372.937 at 500, 997.607 at 1000."""
    outcome = motionsync("plan-line", saw())
    assert (outcome.status, outcome.err) == (0, "")
    head, top, *_ = outcome.out.splitlines()
    assert head == "Saw 3 (saw.toml): confirmed by 12 runs of the block"
    assert top == (
        "  greatest line velocity: 619.646 mm/s (37.18 m/min), for all given lengths, limited by pieces of 500 mm: "
        "cycle time: acceleration"
    )
    fastest = rows(outcome.out, "The greatest line velocity, over the length of the pieces")
    assert [row[:4] for row in fastest] == [
        ["500", "619.646", "37.18", "cycle time: acceleration"],
        ["1500", "1297.29", "77.84", "cycle time: acceleration"],
    ]
    shortest = rows(outcome.out, "The shortest length, over the line velocity")
    assert [row[:3] for row in shortest] == [["500", "30", "372.937"], ["1000", "60", "997.607"]]
    assert all(row[-1] == "yes" for row in (*fastest, *shortest))
    page = Path("build/reports/plan/saw/report.html").resolve()
    assert outcome.out.splitlines()[-1] == f"report: {page.as_uri()}"
    text = page.read_text("utf-8")
    assert "<h1>Saw 3</h1>" in text
    assert "1297.29" in text
    assert not re.search(r"<(script|link|img|iframe)[^>]+(src|href)=", text)


def test_options_are_a_machine_too(motionsync: Command) -> None:
    """Relaxing the stroke by 1 % is worth 0.72 % where the stroke limits."""
    outcome = motionsync("plan-line", *SETTINGS, "--length", "2000", "--velocity", "1400,1480", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert rows(outcome.out, "over the length of the pieces")[0][:4] == ["2000", "1431.8", "85.91", "stroke"]
    assert [row[2] for row in rows(outcome.out, "over the line velocity")] == ["1708", "none"]
    assert "stroke 0.72 %" in outcome.out
    assert not Path("build/reports/plan/machine").exists()


def test_options_take_precedence_over_the_file(motionsync: Command) -> None:
    """Without the end of the stroke the axis's velocity of 1500 is the end."""
    outcome = motionsync("plan-line", saw(), "--set", "axis.max_position=1e9", "--length", "3000", "--no-report")
    assert rows(outcome.out, "over the length of the pieces")[0][:4] == ["3000", "1500", "90", "velocity"]


def test_an_option_may_have_a_unit_of_its_own(motionsync: Command) -> None:
    """Without the end of the stroke the axis's velocity is the end: 60 m/min are 1 m/s, in the unit of --unit."""
    stroke, velocity = ("--set", "axis.max_position=1 km"), ("--set", "axis.max_velocity=60 m/min")
    outcome = motionsync("plan-line", saw(), "--unit", "m", *stroke, *velocity, "--length", "3", "--no-report")
    assert rows(outcome.out, "over the length of the pieces")[0][:4] == ["3", "1", "60", "velocity"]


def test_json_has_all_digits(motionsync: Command) -> None:
    outcome = motionsync("plan-line", saw(), "--json", "--no-report")
    assert outcome.status == 0
    whole = json.loads(outcome.out)
    assert whole["confirmed"] is True
    assert whole["comparison"] is None
    (plan,) = whole["machines"]
    assert [point["velocity"] for point in plan["over_length"]] == pytest.approx(
        [GREATEST_VELOCITIES[500.0], GREATEST_VELOCITIES[1500.0]], abs=5e-7
    )
    assert plan["over_velocity"][1]["cycle_time"] == to(9, CYCLES[1000.0].cycle_time)
    assert plan["over_velocity"][1]["cycle"]["way home"] == to(9, CYCLES[1000.0].return_time)
    assert plan["over_length"][0]["gains"]["cut"] > 0.0


def test_the_machine_of_a_scenario_is_planned(motionsync: Command) -> None:
    """The scenario basic_cut runs the reference machine with a kerf of 4: 1504 of material for 1500."""
    outcome = motionsync("plan-line", "CutToLength/basic_cut", "--length", "1500", "--velocity", "1000", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert rows(outcome.out, "over the length of the pieces")[0][:2] == ["1500", "1299.44"]
    assert rows(outcome.out, "over the line velocity")[0][:3] == ["1000", "60", "993.607"]


def test_two_machines_are_compared(motionsync: Command) -> None:
    """The knife: 1085.767047 for 300; for 900 between two windows 840 cbrt(1e6/(60 180)) = 3800.18."""
    knife = Path("knife.toml")
    knife.write_text(
        'title = "Knife"\nmachine = "knife"\n[start]\n"sync.before" = 30.0\n"sync.after" = 30.0\n', "utf-8"
    )
    outcome = motionsync("plan-line", saw(), knife, "--length", "300,900", "--velocity", "1000", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    first, *_ = outcome.out.splitlines()
    assert first.startswith("The knife is the better machine for pieces of 300 and 900 mm at 1000 mm/s (60 m/min): it ")
    orders = rows(outcome.out, "The greatest line velocity for the orders")
    assert [[row[0], *row[3:]] for row in orders] == [
        ["300", "1085.77 mm/s (65.15 m/min)", "8.58 %"],
        ["900", "3800.18 mm/s (228 m/min)", "280 %"],
    ]
    assert "Saw 3 (saw.toml): confirmed by" in outcome.out
    assert "Knife (knife.toml): confirmed by" in outcome.out


def test_what_the_block_does_not_confirm_is_reported(motionsync: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """The runs below and above a prediction are taken for one another."""
    monkeypatch.setattr(confirmation, "OFFSET", -1e-3)
    outcome = motionsync("plan-line", saw(), "--no-report")
    assert outcome.status == 1
    assert ": NOT confirmed by" in outcome.out
    assert "not met  pieces of 1500 mm at 1298.5908 mm/s: every cut is made: found" in outcome.out


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--set", "axis.max_velocity=-5"], ("axis.max_velocity = -5 is not allowed", "1e-12 to 1e+12")),
        (
            ["--set", "tool.cut_time=soon"],
            ("tool.cut_time=soon: 'soon' is not allowed: it must be a number in s, or with a unit of its own",),
        ),
        (["--set", "axis.max_velocity=9 m"], ("axis.max_velocity=9 m: '9 m' is in m: it must be in mm/s",)),
        (["--set", "tool.mode=SAW"], ("tool.mode=SAW", "1 TIME, 2 DISTANCE, 3 FEEDBACK")),
        (["--set", "axis.max_velocity"], ("--set axis.max_velocity", "NAME=VALUE")),
        (["--set", "kerf=1", "--set", "kerf=2"], ("--set kerf is given twice",)),
        (["--set", "axis.max_velocty=5"], ("'axis.max_velocty'", "axis.max_velocity")),
        (["--set", "master.velocity=5"], ("--set master.velocity", "line velocities of the plan")),
        (["--set", "length=800"], ("--set length", "--length 800")),
        (["--set", "axis.max_position=-5"], ("home_position must be between", "axis.max_position = -5")),
        (["--set", "axis.max_position=0"], ("axis.max_position = 0 is too near",)),
        (["--set", "kerf=1", "--set", "length_correction=-20", "--length", "5"], ("length 5 is not allowed", "> 19")),
        (["--length", "long"], ("--length long", "'long' is not a number", "100..1200")),
        (["--length", "-5"], ("--length -5", "> 0")),
        (["--velocity", "0"], ("--velocity 0", "> 0")),
        (["--velocity", "9..3"], ("--velocity 9..3", "greater than the first")),
        (["--velocity", "6 m"], ("--velocity 6 m", "it must be in mm/s")),
        (["--length", "1..6 m"], ("--length 1..6 m", "one end has a unit and the other none")),
        (["--unit", "inch"], ("no unit is named 'inch'", "mm")),
        (["--open", "--no-report"], ("--open", "--no-report")),
        (["nothing.toml"], ("nothing.toml", "no such file")),
        (["CutToLength"], ("CutToLength", "name one of them")),
        (["FlyingSaw/cyclic_cut"], ("scenario.toml:", "fmu: FlyingSaw", "CutToLength or RotaryKnife")),
        (["--machine", "drill"], ("no kind of machine is named 'drill'", "saw, knife, both")),
        (
            ["--machine", "both", "--set", "axis.max_jerk=5"],
            ("CutToLength.axis.max_jerk or RotaryKnife.axis.max_jerk",),
        ),
    ],
)
def test_a_mistake_is_one_line(motionsync: Command, arguments: list[str], parts: tuple[str, ...]) -> None:
    assert_one_line(motionsync("plan-line", *arguments), *parts)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("lengths = [1500, 500]", 'lengths = ["a"]', ("saw.toml:2: lengths", "neither a list of numbers nor a text")),
        ("lengths = [1500, 500]", "lengths = [-1]", ("saw.toml:2: lengths: -1 is not allowed",)),
        ("lengths = [1500, 500]", "stop_time = 3", ("saw.toml:2: stop_time: unknown key",)),
        (
            '"axis.max_jerk" = 200000.0',
            '"axis.max_jerk" = 0.0',
            ("saw.toml:7: axis.max_jerk: ", "= 0 is not allowed"),
        ),
        ('"axis.max_jerk" = 200000.0', "axis.max_jerk = 1.0", ("saw.toml:7: axis", "quotes")),
        ('"axis.max_jerk" = 200000.0', '"master.position" = 1.0', ("saw.toml:7: master.position", "the plan")),
        ('"axis.max_jerk" = 200000.0', '"in_sync" = true', ("saw.toml:7: in_sync", "a parameter or input")),
        ("[start]", "[begin]", ("saw.toml:5: begin: unknown key",)),
        ('title = "Saw 3"', 'machine = "drill"', ("saw.toml:1: machine: 'drill' is not one of saw, knife",)),
        ('title = "Saw 3"', 'slave_unit = "deg"', ("saw.toml:1: slave_unit: the slave of a saw is in the unit of",)),
        ("[start]", "[start", ("saw.toml:5: not TOML",)),
    ],
)
def test_a_mistake_in_the_file_has_file_line_and_key(
    motionsync: Command, old: str, new: str, parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("plan-line", saw(SAW.replace(old, new))), *parts)


@pytest.mark.parametrize("blades", [2, 3, 5])
def test_a_knife_with_several_blades_is_planned(blades: int, motionsync: Command) -> None:
    """Pieces of circumference over blades are the synchronous ones: their line is as fast as the edges may be,
    3600/360 of a circumference of 600 in a second."""
    length = 600.0 / blades
    arguments = ("--machine", "knife", "--set", f"knife.blades={blades}", "--length", f"{length!r}", "--no-report")
    outcome = motionsync("plan-line", *arguments, "--json")
    assert (outcome.status, outcome.err) == (0, "")
    (plan,) = json.loads(outcome.out)["machines"]
    (point,) = plan["over_length"]
    assert point["velocity"] == pytest.approx(6000.0, rel=1e-6)


def test_a_knife_with_too_many_blades_is_refused_with_the_most_that_it_may_have(motionsync: Command) -> None:
    """Windows of 20 and 20 on 600: 14 blades."""
    outcome = motionsync("plan-line", "--machine", "knife", "--set", "knife.blades=20", "--length", "100")
    assert_one_line(outcome, "knife.blades = 20", "local.allowed_to = 14")
    assert "sync." not in outcome.err
