"""The scenarios: each one through the built FMU, its cross-check files, and what the reader says to a bad file."""

import csv
import shlex
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario import run
from motionsync_fmu.scenario.crosscheck import command_line, inputs_csv, inputs_file
from motionsync_fmu.scenario.cuts import CutSpec, find_cuts
from motionsync_fmu.scenario.fmu_instance import FmuInstance
from motionsync_fmu.scenario.judge import check, compare
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run import run_in_process, schedule, simulate
from motionsync_fmu.scenario.scenario import AtTime, Scenario, When, Within
from motionsync_fmu.scenario.script import Script, Segment
from tests import ROOT, regenerate
from tests.support.fmus import Fmus

SCENARIOS = ROOT / "scenarios"
FOLDERS = sorted(file.parent for file in SCENARIOS.rglob("scenario.toml"))
UNEVEN = 0.007  # s: no divisor of any time in the scenarios
WITHIN = 0.0007  # s: nor this one, within a cycle; steps beyond that repeat a remote axis' telegrams


def named(folder: Path) -> str:
    return folder.relative_to(SCENARIOS).as_posix()


# --- the scenarios that are there ---


def judged(scenario: Scenario, recording: Recording) -> list[str]:
    """What was not as expected, reference included."""
    broken = [f"{c.expected}: found {c.found}" for c in check(scenario, recording) if not c.passed]
    deviations = compare(scenario, recording)
    assert deviations, "there is no reference"
    return broken + [f"{d.name}: {d.greatest} at {d.at}, {d.allowed} allowed" for d in deviations if not d.passed]


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_a_scenario_is_kept_by_the_python_flavour(folder: Path, fmus: Fmus) -> None:
    scenario = load(folder / "scenario.toml")
    assert scenario.expectations
    recording = simulate(scenario, fmus.python(scenario.recipe.name), scenario.step_size)
    assert judged(scenario, recording) == []
    assert min(d.points for d in compare(scenario, recording)) >= 100


def late(scenario: Scenario, step_size: float) -> Scenario:
    """An event shows at the first communication point after it, so its time is known to one step, of either run."""
    step = max(step_size, scenario.step_size)
    widened = [
        replace(e, tolerance=(e.tolerance or 0.0) + step) if isinstance(e, When) else e for e in scenario.expectations
    ]
    return replace(scenario, expectations=tuple(widened))


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_a_scenario_is_kept_at_another_step_size_by_the_native_flavour(folder: Path, fmus: Fmus) -> None:
    scenario = load(folder / "scenario.toml")
    step_size = WITHIN if scenario.remote else UNEVEN
    recording = simulate(scenario, fmus.native(scenario.recipe.name), step_size)
    assert judged(late(scenario, step_size), recording) == []
    assert min(d.points for d in compare(scenario, recording)) >= 5


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_the_cross_check_files_are_those_of_script_and_oracle(folder: Path) -> None:
    files = regenerate.files(folder / "scenario.toml")
    assert {file.name for file in files} == {f.name for f in folder.iterdir()} - {"scenario.toml"}
    for file, text in files.items():
        assert file.read_text("utf-8") == text, f"{file.name} is not what `make references` writes"


@pytest.mark.parametrize("file", regenerate.examples(), ids=list(BLOCKS))
def test_the_reference_of_an_example_is_that_of_the_oracle(file: Path) -> None:
    files = regenerate.files(file)
    assert sorted(f.suffix for f in files) == [".csv", ".opt"]
    for reference, text in files.items():
        assert reference.read_text("utf-8") == text, f"{reference.name} is not what `make references` writes"


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("reversal_in_ramp", 0),
        ("phasing_changed_while_executing", 0),
        ("position_only_input", 0),
        ("end_of_step_inputs", 1),  # FMPy initializes with the first step's inputs, here the master at its end
    ],
)
def test_fmpy_alone_runs_a_scenario_from_its_files(name: str, first: int, native: Path, tmp_path: Path) -> None:
    """The command line that `motionsync run` prints, and the variables of the reference."""
    scenario = load(SCENARIOS / "Synchronizer" / name / "scenario.toml")
    words = shlex.split(command_line(scenario, native, inputs_file(scenario)))
    assert words[:3] == ["fmpy", "simulate", str(native)]
    names = [d.name for d in compare(scenario, simulate(scenario, native, scenario.step_size))]
    call = [str(Path(sys.executable).with_name("fmpy")), *words[1:], "--output-variables", *names]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "Synchronizer_out.csv").open(newline="") as f:
        header, *rows = list(csv.reader(f))
    table = np.array([[float({"True": 1.0, "False": 0.0}.get(x, x)) for x in row] for row in rows[first:]])
    assert table[-1, 0] == pytest.approx(scenario.stop_time, abs=1e-9)
    recording = Recording(table[:, 0], dict(zip(header[1:], table.T[1:], strict=True)), np.empty((0, 3)), [])
    deviations = compare(scenario, recording)
    assert [d.name for d in deviations] == names
    assert [(d.name, d.greatest, d.at) for d in deviations if not d.passed] == []
    assert min(d.points for d in deviations) >= 100


def test_the_command_line_for_fmpy_quotes_paths_and_keeps_all_digits(tmp_path: Path) -> None:
    file = tmp_path / "a folder (1)" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(GOOD.replace("stop_time = 4.0", "stop_time = 4.0000001").replace("0.01", "0.0123456789"))
    scenario = load(file)
    words = shlex.split(command_line(scenario, tmp_path / "an FMU.fmu", inputs_file(scenario)))
    assert words[2] == str(tmp_path / "an FMU.fmu")
    options = dict(zip(words[3::2], words[4::2], strict=False))
    assert float(options["--stop-time"]) == 4.0000001
    assert float(options["--output-interval"]) == 0.0123456789
    assert str(file.parent / "Synchronizer_in.csv") in words


# --- files with a mistake ---

GOOD = """\
title = "A good one"
source = "By hand"
fmu = "Synchronizer"
unit = "deg"
stop_time = 4.0
step_size = 0.01
tolerance = 1e-9

[start]
"master.period" = 360.0
curve = "PARABOLA"
active = true

[master]
position = 0.0
velocity = 90.0
segments = [
    { duration = 1.0, acceleration = 1.0 },
    { duration = 1.5 },
]

[[set]]
at = 0.5
stop = true

[[set]]
at = 1.5
output_phasing = 45.0

[[expect]]
at = 2.0
"slave.position" = 1.0
tolerance = 1e-6

[[expect]]
when = "syn_ramp_on"
time = 1.0

[[expect]]
from = 0.0
to = 1.0
"slave.velocity" = { min = 0.0, max = 90.0 }
"""
SEGMENTS = GOOD[GOOD.index("segments") : GOOD.index("]\n\n[[set]]") + 1]
SETTINGS = GOOD[GOOD.index("[[set]]") : GOOD.index("[[expect]]")]
WHEN, FROM = "[[expect]]\nwhen", "[[expect]]\nfrom"


def turned(text: str) -> str:
    return f"[interface]\n{text}\n\n[start]"


# What is replaced in GOOD, by what; the key and the words that the message has. It names the line of the replacement,
# or the line on which the last text begins.
MISTAKES: dict[str, tuple[str, str, str, tuple[str, ...]] | tuple[str, str, str, tuple[str, ...], str]] = {
    # unknown keys and tables
    "key at the top": ('unit = "deg"', 'units = "deg"', "units", ("unknown key", "unit")),
    "key with a dash": ("step_size = 0.01", "step-size = 0.01", "step-size", ("unknown key", "step_size")),
    "table": ("[start]", "[starts]", "starts", ("unknown key", "start")),
    "list of tables": ("[[set]]\nat = 0.5", "[[sets]]\nat = 0.5", "sets", ("unknown key", "set")),
    "key of the master": ("position = 0.0", "positon = 0.0", "positon", ("unknown key", "position")),
    "key of a segment": ("{ duration = 1.5 },", "{ time = 1.5 },", "time", ("unknown key", "duration")),
    "key of a when": ("time = 1.0", "time = 1.0\nat_most = 2", "at_most", ("unknown key", "tolerance"), "at_most"),
    "key of limits": ("{ min = 0.0,", "{ least = 0.0,", "slave.velocity", ("least", "unknown key", "min, max")),
    # unknown variables
    "start value's name": ("curve =", "curves =", "curves", ("do you mean 'curve'?",)),
    "set variable's name": ("stop = true", "stopp = true", "stopp", ("do you mean 'stop'?",)),
    "expected name": ('"slave.position"', '"slave.positon"', "slave.positon", ("do you mean 'slave.position'?",)),
    "limited name": ('"slave.velocity"', '"slave.velocty"', "slave.velocty", ("do you mean 'slave.velocity'?",)),
    "condition's name": ('"syn_ramp_on"', '"syn_ramp"', "when", ("'syn_ramp'", "do you mean 'syn_ramp_on'?")),
    "name like no other": ("stop = true", "zzz = true", "zzz", ("Synchronizer has no variable 'zzz'",)),
    "dotted name without quotes": ('"slave.position"', "slave.position", "slave", ('"slave.position"', "quotes")),
    # wrong types
    "title is a number": ('title = "A good one"', "title = 3", "title", ("3", "text")),
    "stop_time is a text": ("stop_time = 4.0", 'stop_time = "4"', "stop_time", ("'4'", "number")),
    "stop_time is a Boolean": ("stop_time = 4.0", "stop_time = true", "stop_time", ("number",)),
    "start is a list": ("[start]", "[[start]]", "start", ("[start]",)),
    "set is a table": (SETTINGS, "[set]\nat = 0.5\nstop = true\n\n", "set", ("[[set]]",)),
    "position is a text": ("position = 0.0", 'position = "0"', "position", ("'0'", "number")),
    "segments are no list": (SEGMENTS, "segments = 3", "segments", ("list of tables",)),
    "a segment is a number": ("{ duration = 1.5 },", "1.5,", "segments", ("list of tables",), "segments"),
    "number for a Boolean": ("stop = true", "stop = 1", "stop", ("1", "Boolean")),
    "Boolean for a number": ("= 45.0", "= true", "output_phasing", ("Real",)),
    "text for a number": ("= 45.0", '= "45"', "output_phasing", ("'45'", "Real")),
    "list for a number": ("= 45.0", "= [45.0]", "output_phasing", ("Real",)),
    "number for limits": ("{ min = 0.0, max = 90.0 }", "90.0", "slave.velocity", ("{ min = ..., max = ... }",)),
    "limits for a number": ('"slave.position" = 1.0', '"slave.position" = { min = 1.0 }', "slave.position", ("Real",)),
    "limit is a text": ("max = 90.0", 'max = "90"', "slave.velocity", ("max", "'90'", "number")),
    # durations and times
    "duration negative": ("duration = 1.5", "duration = -1.5", "duration", ("-1.5", "> 0")),
    "duration 0": ("duration = 1.5", "duration = 0", "duration", ("0", "> 0")),
    "duration NaN": ("duration = 1.5", "duration = nan", "duration", ("nan", "finite")),
    "duration infinite": ("duration = 1.5", "duration = inf", "duration", ("inf", "finite")),
    "duration missing": ("duration = 1.5", "velocity = 1.5", "duration", ("missing",)),
    "two kinds in a segment": ("acceleration = 1.0 },", "acceleration = 1.0, jerk = 2.0 },", "jerk", ("at most one",)),
    "kind is NaN": ("acceleration = 1.0 },", "acceleration = nan },", "acceleration", ("nan", "finite")),
    "set at 0": ("at = 0.5", "at = 0", "at", ("start value", "[start]")),
    "set before 0": ("at = 0.5", "at = -0.5", "at", ("-0.5",)),
    "set after the end": ("at = 0.5", "at = 4.5", "at", ("4.5", "stop_time = 4")),
    "set at the end": ("at = 0.5", "at = 4.0", "at", ("4", "stop_time = 4")),
    "set at NaN": ("at = 0.5", "at = nan", "at", ("nan", "finite")),
    "set without at": ("at = 0.5", "", "at", ("missing",), "[[set]]"),
    "set of nothing": ("stop = true\n", "", "at", ("nothing",), "at = 0.5"),
    # what cannot be set
    "set of the master": ("stop = true", '"master.position" = 3.0', "master.position", ("[master]",)),
    "start of the master": ("active = true", '"master.velocity" = 3.0', "master.velocity", ("[master]",)),
    "set of a fixed parameter": ("stop = true", "curve = 1", "curve", ("fixed parameter", "tunable parameter")),
    "set of an output": ("stop = true", "synchronized = false", "synchronized", ("output", "input")),
    "set of a local": ("stop = true", '"local.progress" = 0.5', "local.progress", ("local", "input")),
    "start of an output": ("active = true", "synchronized = false", "synchronized", ("output", "parameter or input")),
    # values out of their range
    "start value too great": ("active = true", "rest_value = 1e13", "rest_value", ("1e+13", "-1e+12 to 1e+12")),
    "start value refused": ("active = true", "output_phasing = 0.0", "output_phasing", ("0", "1e-09 to 1e+12")),
    "start value NaN": ("360.0", "nan", "master.period", ("nan", "0, or >= 1e-09")),
    "start value of 400 digits": ("360.0", "1" + "0" * 400, "master.period", ()),
    "start value of 4300 digits": ("360.0", "1" + "0" * 4299, "master.period", ()),
    "integer of 400 digits": ('"slave.position" = 1.0', f"state_code = 1{'0' * 400}", "state_code", ("no Integer",)),
    "integer of 33 bits": ('"slave.position" = 1.0', "state_code = 2147483648", "state_code", ("no Integer",)),
    "integer of 400 digits in a condition": (
        'when = "syn_ramp_on"',
        f'when = "state_code == 1{"0" * 400}"',
        "when",
        (),
    ),
    "integer of 5000 digits in a condition": (
        'when = "syn_ramp_on"',
        f'when = "state_code == 1{"0" * 5000}"',
        "when",
        ("is no Integer",),
    ),
    "start integer of 400 digits": ('"PARABOLA"', "1" + "0" * 400, "curve", ()),
    "stop_time of 400 digits": ("stop_time = 4.0", f"stop_time = 1{'0' * 400}", "stop_time", ()),
    "member's name": ('"PARABOLA"', '"PARABEL"', "curve", ("'PARABEL'", "1 PARABOLA, 2 POLYNOMIAL_3_4_5")),
    "member's number": ('"PARABOLA"', "3", "curve", ("3", "1 PARABOLA, 2 POLYNOMIAL_3_4_5")),
    "expected member's number": ('"slave.position" = 1.0', "state = 3", "state", ("3", "2 STACKED")),
    "expected member's name": ('"slave.position" = 1.0', 'state = "BUSY"', "state", ("'BUSY'", "2 STACKED")),
    "expected NaN": ('"slave.position" = 1.0', '"slave.position" = nan', "slave.position", ("nan",)),
    "unit": ('unit = "deg"', 'unit = "inch"', "unit", ("'inch'", "mm", "deg")),
    "slave unit": ('unit = "deg"', 'slave_unit = "mm"', "slave_unit", ("'mm'", "Synchronizer", "master's unit")),
    "slave unit that is none": ('unit = "deg"', 'slave_unit = "inch"', "slave_unit", ("'inch'", "mm", "deg")),
    "block": ('fmu = "Synchronizer"', 'fmu = "Synchroniser"', "fmu", ("'Synchroniser'", "Synchronizer")),
    "tolerance 0": ("tolerance = 1e-9", "tolerance = 0", "tolerance", ("> 0",)),
    # expectations
    "expect without kind": (
        "from = 0.0\nto = 1.0\n",
        "",
        "expect",
        ("at, when, from",),
        '[[expect]]\n"slave.velocity"',
    ),
    "expect with two kinds": (
        'when = "syn_ramp_on"',
        'when = "syn_ramp_on"\nat = 1.0',
        "expect",
        ("at, when, from",),
        WHEN,
    ),
    "expect of nothing at a time": ('"slave.position" = 1.0\n', "", "at", ("nothing",), "at = 2.0"),
    "expect of nothing in an interval": (
        '"slave.velocity" = { min = 0.0, max = 90.0 }\n',
        "",
        "from",
        ("nothing",),
        "from",
    ),
    "limits without a limit": ("{ min = 0.0, max = 90.0 }", "{}", "slave.velocity", ("min", "max")),
    "expect of an input": ('"slave.position" = 1.0', "stop = true", "stop", ("input", "output or local")),
    "limits of a parameter": (
        '"slave.velocity"',
        '"output_phasing"',
        "output_phasing",
        ("parameter", "output or local"),
    ),
    "condition on an input": ('"syn_ramp_on"', '"stop"', "when", ("input", "output or local")),
    "condition malformed": ('"syn_ramp_on"', '"syn_ramp_on = true"', "when", ("NAME == VALUE",)),
    "condition >=": ('"syn_ramp_on"', '"slave.position >= 3"', "when", ("NAME > VALUE",)),
    "condition empty": ('"syn_ramp_on"', '""', "when", ("NAME == VALUE",)),
    "condition is a Boolean": ('"syn_ramp_on"', "true", "when", ("NAME == VALUE",)),
    "condition without comparison": ('"syn_ramp_on"', '"slave.position"', "when", ("Real", "compare")),
    "condition on a wrong type": ('"syn_ramp_on"', '"syn_ramp_on == 3"', "when", ("3", "Boolean")),
    "condition's member": ('"syn_ramp_on"', '"state == BUSY"', "when", ("'BUSY'", "2 STACKED")),
    "time missing": ("time = 1.0\n", "", "time", ("missing",), WHEN),
    "time after the end": ("time = 1.0", "time = 5.0", "time", ("5", "<= 4")),
    "expected after the end": ("at = 2.0", "at = 5.0", "at", ("5", "<= 4")),
    "expected before 0": ("at = 2.0", "at = -1.0", "at", ("-1", ">= 0")),
    "tolerance negative": ("tolerance = 1e-6", "tolerance = -1e-6", "tolerance", (">= 0",)),
    "tolerance NaN": ("tolerance = 1e-6", "tolerance = nan", "tolerance", ("nan", "finite")),
    "from after to": ("from = 0.0\nto = 1.0", "from = 2.0\nto = 1.0", "to", ("1", ">= 2"), "to = 1.0"),
    "to missing": ("to = 1.0\n", "", "to", ("missing",), FROM),
    "to after the end": ("to = 1.0", "to = 4.5", "to", ("4.5", "<= 4")),
    "min above max": ("min = 0.0, max = 90.0", "min = 91.0, max = 90.0", "slave.velocity", ("max", "90", ">= 91")),
    # turned variables
    "turned to what": ("[start]", turned("inputs = 'curve'"), "inputs", ("unknown key", "input, output"), "inputs"),
    "turned by a number": ("[start]", turned("input = 3"), "input", ("3", "a list of texts"), "input"),
    "turned by numbers": ("[start]", turned("input = ['curve', 3]"), "input", ("3", "a list of texts"), "input"),
    "turned unknown": ("[start]", turned("local = 'redy'"), "local", ("'redy'", "ready"), "local ="),
    "turned fixed": ("[start]", turned("input = ['c*']"), "input", ("curve cannot become an input", "fixed"), "input"),
    "turned command": ("[start]", turned("parameter = 'sto?'"), "parameter", ("stop cannot", "command"), "parameter"),
    "turned twice": (
        "[start]",
        turned("parameter = 'rest_value'\ninput = 'rest_value'"),
        "parameter",
        ("rest_value is already turned to an input",),
        "parameter",
    ),
    # what every scenario has
    "title missing": ('title = "A good one"\n', "", "title", ("missing",), "source"),
    "fmu missing": ('fmu = "Synchronizer"\n', "", "fmu", ("missing",), "title"),
    "stop_time missing": ("stop_time = 4.0\n", "", "stop_time", ("missing",), "title"),
    "step_size missing": ("step_size = 0.01\n", "", "step_size", ("missing",), "title"),
    "stop_time 0": ("stop_time = 4.0", "stop_time = 0", "stop_time", ("> 0",)),
    "stop_time infinite": ("stop_time = 4.0", "stop_time = inf", "stop_time", ("inf", "finite")),
    "step_size 0": ("step_size = 0.01", "step_size = 0.0", "step_size", ("> 0",)),
    "step_size negative": ("step_size = 0.01", "step_size = -0.01", "step_size", ("> 0",)),
    "step_size beyond the end": ("step_size = 0.01", "step_size = 4.5", "step_size", ("4.5", "<= 4")),
    "absurdly many steps": ("step_size = 0.01", "step_size = 1e-9", "step_size", ("1e-09", "steps")),
    "denormal step": ("step_size = 0.01", "step_size = 1e-320", "step_size", ("steps",)),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, key, says, *named_line = MISTAKES[name]
    assert GOOD.count(old) == 1
    text = GOOD.replace(old, new)
    line = text[: text.index(named_line[0]) if named_line else GOOD.index(old)].count("\n") + 1
    file = tmp_path / "scenario.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(UserError) as told:
        load(file)
    message = str(told.value)
    assert message.startswith(f"{file}:{line}: {key}: ")
    for part in says:
        assert part in message.removeprefix(f"{file}:{line}: {key}: ")
    assert "\n" not in message


CUTS = """
[cuts]
while = "syn_synchronized"
length = 20.0
offset = 3.0
ratio = 1.5
tolerance = 0.25
count = 2
"""


@pytest.mark.parametrize(
    ("old", "new", "key", "says"),
    [
        ("[cuts]", "[[cuts]]", "cuts", ("must be a table: [cuts]",)),
        ("offset", "ofset", "ofset", ("unknown key", "offset")),
        ('while = "syn_synchronized"\n', "", "while", ("missing",)),
        ('"syn_synchronized"', "true", "while", ("True", "text")),
        ("syn_synchronized", "syn_synchronised", "while", ("do you mean 'syn_synchronized'?",)),
        ("syn_synchronized", "slave.position", "while", ("continuous Real output", "not a Boolean output or local")),
        ("syn_synchronized", "active", "while", ("discrete Boolean input", "not a Boolean output")),
        ("length = 20.0\n", "", "length", ("missing",)),
        ("length = 20.0", "length = 0.0", "length", ("0", "> 0")),
        ("length = 20.0", "length = nan", "length", ("finite",)),
        ("length = 20.0", 'length = "20"', "length", ("'20'", "number")),
        ("offset = 3.0", "offset = inf", "offset", ("finite",)),
        ("ratio = 1.5", "ratio = 0", "ratio", ("0 is not allowed",)),
        ("tolerance = 0.25", "tolerance = -1.0", "tolerance", ("-1", ">= 0")),
        ("count = 2", "count = 2.5", "count", ("2.5", "whole number")),
        ("count = 2", "count = -1", "count", ("-1", ">= 0")),
        ("count = 2", "count = true", "count", ("number",)),
        ("", "", "cuts", ("linear axis", "master.period is 360")),
    ],
)
def test_a_mistake_in_cuts_is_told_with_its_line(
    old: str, new: str, key: str, says: tuple[str, ...], tmp_path: Path
) -> None:
    good = GOOD.replace('"master.period" = 360.0\n', "") if old else GOOD
    text = good + CUTS.replace(old, new) if old else good + CUTS
    at = next((i for i, line in enumerate(text.splitlines(), 1) if i > 42 and line.startswith(f"{key} =")), 0)
    at = at or text[: text.index("[cuts]")].count("\n") + 1
    file = tmp_path / "scenario.toml"
    file.write_text(text)
    with pytest.raises(UserError) as told:
        load(file)
    assert str(told.value).startswith(f"{file}:{at}: {key}: ")
    for part in says:
        assert part in str(told.value)


def test_cuts_are_read(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    linear = GOOD.replace('"master.period" = 360.0\n', "")
    file.write_text(linear + CUTS)
    assert load(file).cuts == CutSpec("syn_synchronized", 20.0, 3.0, 1.5, 0.25, 2)
    file.write_text(linear + '[cuts]\nwhile = "ready"\nlength = 5\n')
    assert load(file).cuts == CutSpec("ready", 5.0, 0.0, 1.0, 0.0005, None)
    file.write_text(linear)
    assert load(file).cuts is None


def recording_of(places: list[float | None], ratio: float) -> Recording:
    """A saw that lags behind the material by these numbers, at 0, 0.1, 0.2 ... s; None: it does not cut."""
    n = len(places)
    master = np.zeros((n, 4))
    master[:, 0] = 7.0 * np.arange(n)
    slave = [ratio * (m - (p or 0.0)) for m, p in zip(master[:, 0].tolist(), places, strict=True)]
    on = [float(p is not None) for p in places]
    values = {"slave.position": np.array(slave), "in_sync": np.array(on)}
    return Recording(0.1 * np.arange(n), values, master, [])


@pytest.mark.parametrize("ratio", [1.0, -2.0, 0.5])
def test_each_interval_is_a_cut_and_its_error_the_greatest_distance_from_its_mark(ratio: float) -> None:
    places = [3.0, 3.0, None, 22.75, 23.5, 23.25, None, None, 62.5, None, -37.0, -37.5]
    cuts = find_cuts(CutSpec("in_sync", 20.0, 3.0, ratio, 0.1, None), recording_of(places, ratio))
    assert [(round(c.begin, 9), round(c.end, 9)) for c in cuts] == [(0.0, 0.1), (0.3, 0.5), (0.8, 0.8), (1.0, 1.1)]
    assert [c.mark for c in cuts] == [3.0, 23.0, 63.0, -37.0]
    assert [c.error for c in cuts] == pytest.approx([0.0, 0.5, -0.5, -0.5], abs=1e-12)


def test_without_a_cut_there_is_none() -> None:
    assert find_cuts(CutSpec("in_sync", 20.0, 0.0, 1.0, 0.1, None), recording_of([None] * 5, 1.0)) == []


@pytest.mark.parametrize(
    ("cuts", "expected"),
    [
        (
            "length = 20.0\noffset = 0.5\ntolerance = 0.5000001\ncount = 1",
            [("1", True), ("at most 0.5 deg away", True)],
        ),
        ("length = 20.0\noffset = 0.5\ntolerance = 0.4999\ncount = 2", [("1", False), ("at most 0.5 deg away", False)]),
        ("length = 20.0\ntolerance = 1e-9", [("at most", True)]),
        ("length = 20.0", [("at most", True)]),
        ("length = 20.0\noffset = 0.0021", [("at most 0.0021 deg away", False)]),  # a ten-thousandth: 0.002 deg
        ("length = 20.0\noffset = 0.0019", [("at most 0.0019 deg away", True)]),
    ],
)
def test_cuts_are_expectations(cuts: str, expected: list[tuple[str, bool]], fmu: Path, tmp_path: Path) -> None:
    """The Synchronizer's slave is the master until its ramp begins, and comes to rest for good."""
    file = tmp_path / "scenario.toml"
    linear = GOOD.replace('"master.period" = 360.0\n', "")
    file.write_text(f'{linear}[cuts]\nwhile = "syn_synchronized"\n{cuts}\n')
    scenario = load(file)
    found = check(scenario, simulate(scenario, fmu, 0.01))[len(scenario.expectations) :]
    for c, (beginning, passed) in zip(found, expected, strict=True):
        assert c.found.startswith(beginning)
        assert c.passed == passed


def test_no_cut_at_all_breaks_a_tolerance() -> None:
    recording = recording_of([None] * 5, 1.0)
    scenario = replace(load(FOLDERS[0] / "scenario.toml"), expectations=(), settings=())
    (judged,) = check(replace(scenario, cuts=CutSpec("in_sync", 20.0, 0.0, 1.0, 1.0, None)), recording)
    assert (judged.found, judged.passed) == ("no cut", False)


def test_without_a_mistake_it_is_read(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(GOOD, "utf-8")
    scenario = load(file)
    assert (scenario.recipe, scenario.unit) == (Recipe("Synchronizer"), "deg")
    assert (scenario.title, scenario.source) == ("A good one", "By hand")
    assert (scenario.stop_time, scenario.step_size, scenario.tolerance) == (4.0, 0.01, 1e-9)
    assert scenario.start == {"master.period": 360.0, "curve": 1, "active": True}
    assert [(s.at, s.values) for s in scenario.settings] == [(0.5, {"stop": True}), (1.5, {"output_phasing": 45.0})]
    assert scenario.master.at(2.0).position == pytest.approx(90.0 * 2.0 + 0.5 + 1.0)
    assert [type(e) for e in scenario.expectations] == [AtTime, When, Within]


def test_a_scenario_needs_no_source(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(GOOD.replace('source = "By hand"\n', ""), "utf-8")
    assert load(file).source == ""


def test_line_ends_and_a_byte_order_mark_of_windows_editors_do_no_harm(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load(file).title == "A good one"
    file.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").replace("time = 1.0", "time = -1.0").encode())
    with pytest.raises(UserError, match=r":37: time: "):
        load(file)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (GOOD.replace("[start]", "[start"), 9),
        (GOOD.replace("stop_time = 4.0", "stop_time = "), 5),
        (GOOD.replace("curve =", "curve"), 11),
        (GOOD.replace('"PARABOLA"', "PARABOLA"), 11),
        (GOOD.replace("active = true", 'curve = "PARABOLA"'), 12),
        (GOOD + 'x = """', 43),
        (f"x = {'[' * 5000}", 1),
        (GOOD.replace("stop_time = 4.0", f"stop_time = 1{'0' * 4300}"), 5),
        (GOOD.replace('"PARABOLA"', f"-9{'_9' * 4300}"), 11),
        (GOOD.replace('"PARABOLA"', f"0x{'f' * 3600}"), 11),
        (GOOD.replace("duration = 1.5", f"duration = 0b{'1' * 20_000}"), 19),
        (GOOD + f"x = [[1, {'7' * 100_000}]]", 43),
    ],
)
def test_what_is_no_toml_is_told_with_file_and_line(text: str, line: int, tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(UserError) as told:
        load(file)
    assert str(told.value).startswith(f"{file}:{line}: not TOML: ")
    assert "\n" not in str(told.value)


def test_a_file_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    missing, folder, latin = tmp_path / "missing.toml", tmp_path / "folder.toml", tmp_path / "latin.toml"
    folder.mkdir()
    latin.write_bytes(GOOD.replace("A good one", "90° of phasing").encode("latin-1"))
    for file in (missing, folder, latin):
        with pytest.raises(UserError) as told:
            load(file)
        assert str(told.value).startswith(f"{file}: cannot be read: ")
    assert "utf-8" in str(told.value)


# --- many settings ---

MANY = 'title = "many"\nfmu = "Synchronizer"\nstop_time = 200.0\nstep_size = 100.0\n[master]\nvelocity = 1.0\n'


def many(folder: Path, count: int) -> Path:
    """A scenario with so many tables [[set]], each at a time of its own."""
    tables = [f"[[set]]\nat = {1.0 + 100.0 * i / count:.6f}\nrest_value = {i}.0\n" for i in range(count)]
    file = folder / f"{count}.toml"
    file.write_text(MANY + "".join(tables), "utf-8")
    return file


def calls(action: Callable[[], object]) -> int:
    """How many functions of Python an action calls."""
    found = 0

    def see(frame: object, event: str, arg: object) -> None:
        nonlocal found
        found += event == "call"

    sys.setprofile(see)
    try:
        action()
    finally:
        sys.setprofile(None)
    return found


@pytest.mark.parametrize(
    "act", [load, lambda file: run_in_process(load(file), 100.0), lambda file: inputs_csv(load(file))]
)
def test_twice_the_settings_are_at_most_twice_the_work(act: Callable[[Path], object], tmp_path: Path) -> None:
    few, more = many(tmp_path, 200), many(tmp_path, 1600)
    act(few)  # what is read once for all scenarios
    assert calls(lambda: act(more)) <= 8 * calls(lambda: act(few))


def test_a_step_sets_and_gets_all_variables_of_a_type_in_one_call(fmu: Path, tmp_path: Path) -> None:
    """Of the master alone three Reals are set in each step, and one more that changes."""
    file = many(tmp_path, 50)
    scenario = load(file)
    points = len(list(schedule(scenario, 100.0)))
    called: Counter[str] = Counter()

    class Counted(FmuInstance):
        def call(self, function: Any, *arguments: Any, **options: Any) -> Any:
            called[function.__name__] += 1
            return super().call(function, *arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "FmuInstance", Counted)
        simulate(scenario, fmu, 100.0)
    initial = 1
    assert called["setReal"] == points + initial
    assert called["doStep"] == points
    assert called["getReal"] == called["getInteger"] == called["getBoolean"] == points + initial


# --- what a scenario means between its points ---


def test_limits_hold_at_points_of_their_own_interval(fmu: Path, tmp_path: Path) -> None:
    """However short it is, and however long the steps: at least at both its ends."""
    file = tmp_path / "scenario.toml"
    file.write_text(
        GOOD.replace("from = 0.0\nto = 1.0", "from = 0.301\nto = 0.302").replace("max = 90.0", "max = 90.3015")
    )
    scenario = load(file)
    recording = simulate(scenario, fmu, scenario.step_size)
    *_, limits = check(scenario, recording)
    assert limits.found == "90.301 to 90.302"
    assert not limits.passed


def test_the_inputs_at_the_end_of_a_step_are_those_before_a_jump(tmp_path: Path) -> None:
    """Also where the durations do not add up to the last bit of what is set: 0.1 + 0.7 < 0.8."""
    assert 0.1 + 0.7 < 0.8
    segments = "segments = [{ duration = 0.1 }, { duration = 0.7 }, { duration = 1.0, velocity = 10.0 }]"
    file = tmp_path / "scenario.toml"
    file.write_text(GOOD.replace(SEGMENTS, segments).replace("at = 0.5", "at = 0.8"))
    scenario = load(file)
    for mode in MasterInput.START_OF_STEP, MasterInput.END_OF_STEP:
        running = replace(scenario, start={**scenario.start, "master.input_mode": mode})
        steps = {round(t, 6): values for t, _, values in schedule(running, 0.01)}
        assert steps[0.79]["master.velocity"] == 90.0
        assert steps[0.8]["master.velocity"] == 10.0
        assert "stop" not in steps[0.79]
        assert steps[0.8]["stop"] is True


# --- the script ---


@dataclass(frozen=True)
class Piece:
    """A segment in exact numbers; `kind` is the one thing that it holds, or empty."""

    duration: Fraction
    kind: str
    value: Fraction

    def segment(self) -> Segment:
        held = {self.kind: float(self.value)} if self.kind else {}
        return Segment(float(self.duration), **held)


Initial = tuple[Fraction, Fraction, Fraction]
"""Position, velocity and acceleration at the beginning."""


def scripted(initial: Initial, pieces: list[Piece]) -> Script:
    p, v, a = map(float, initial)
    return Script(p, v, a, [piece.segment() for piece in pieces])


def exact(initial: Initial, pieces: list[Piece], t: Fraction, *, before: bool) -> tuple[Fraction, ...]:
    """Position, velocity, acceleration, jerk at t, integrated piece by piece; at a break, `before` or after it."""
    p, v, a = initial
    j, zero = Fraction(0), Fraction(0)
    for piece in pieces:
        v = piece.value if piece.kind == "velocity" else v
        a = {"acceleration": piece.value, "jerk": a}.get(piece.kind, zero)
        j = piece.value if piece.kind == "jerk" else zero
        d = min(t, piece.duration)
        p, v, a, t = p + v * d + a * d**2 / 2 + j * d**3 / 6, v + a * d + j * d**2 / 2, a + j * d, t - d
        if t == 0 and (before or d < piece.duration):
            return p, v, a, j
    return p + v * t, v, zero, zero


def dyadic(least: int, greatest: int, parts: int) -> st.SearchStrategy[Fraction]:
    """Numbers that floats hold exactly, and so do their sums."""
    return st.integers(least * parts, greatest * parts).map(lambda n: Fraction(n, parts))


AXIS = dyadic(-100, 100, 8)
PIECES = st.lists(
    st.builds(
        Piece,
        st.integers(1, 512).map(lambda n: Fraction(n, 128)),
        st.sampled_from(["", "velocity", "acceleration", "jerk"]),
        dyadic(-50, 50, 8),
    ),
    max_size=6,
)


@given(st.tuples(AXIS, AXIS, AXIS), PIECES, dyadic(0, 30, 128))
def test_the_script_is_its_segments_integrated(initial: Initial, pieces: list[Piece], t: Fraction) -> None:
    script = scripted(initial, pieces)
    breaks = [Fraction(0), *accumulate(piece.duration for piece in pieces)]
    for time in (t, *breaks):
        for motion, before in ((script.at(float(time)), False), (script.until(float(time)), True)):
            wanted = exact(initial, pieces, time, before=before)
            found = (motion.position, motion.velocity, motion.acceleration, motion.jerk)
            assert found == pytest.approx([float(x) for x in wanted], rel=1e-11, abs=1e-8)


@given(st.tuples(AXIS, AXIS, AXIS), PIECES)
def test_the_script_never_jumps_in_position(initial: Initial, pieces: list[Piece]) -> None:
    script = scripted(initial, pieces)
    for time in script.breaks:
        assert script.at(time).position == pytest.approx(script.until(time).position, rel=1e-12, abs=1e-12)
