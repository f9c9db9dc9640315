"""The command line as a user meets it: what it builds, shows and runs, and what it says to a mistake."""

import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from html.parser import HTMLParser
from importlib import import_module
from math import pi
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest
from fmpy import simulate_fmu
from typer.testing import CliRunner

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__, cli, places
from motionsync_fmu.build import Flavour
from motionsync_fmu.commands import run
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import here
from motionsync_fmu.pages import console, results
from motionsync_fmu.scenario.shipped import FILE, LINES, find
from tests import ROOT
from tests.support.command_line import Command, Outcome, assert_one_line
from tests.support.fmus import Fmus, Shared

COMMANDS = ("build", "list", "describe", "new", "run", "line", "plan-line", "error")
FLAVOURS = ("native", "python")
PYTHON = ("--flavour", "python")  # the quicker one to build, where either shows it

# A master at 100 mm/s. Along the parabola the slave leaves it at rest_value - phasing, and half way to the end, where
# the master is at rest_value, it has done 3/4 of the phasing and has half the master's velocity.
STOP = """\
title = "A stop along a parabola"
source = "By hand"
fmu = "Synchronizer"
stop_time = 0.5
step_size = 0.01

[start]
curve = "PARABOLA"
output_phasing = 10.0
rest_value = 30.0

[master]
velocity = 100.0

[[set]]
at = 0.1
stop = true

[[expect]]
at = 0.3
"slave.position" = 27.5
"slave.velocity" = 50.0
tolerance = 1e-9

[[expect]]
when = "synchronized == false"
time = 0.4

[[expect]]
from = 0.0
to = 0.5
"slave.velocity" = { min = 0.0, max = 100.0 }
"""


@pytest.fixture
def cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache in place of the user's."""
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setattr(places, "cache", lambda: folder)
    return folder


def process(folder: Path, *arguments: str, **environment: str) -> Outcome:
    """The console script itself, in a process of its own."""
    script = Path(sys.executable).with_name("motionsync")
    done = subprocess.run(
        [script, *arguments], cwd=folder, env=os.environ | environment, capture_output=True, check=False
    )
    return Outcome(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))


def scenario(folder: str, text: str = STOP) -> Path:
    file = Path(folder, "scenario.toml")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    return file


@pytest.fixture(scope="module")
def built(shared: Shared) -> Path:
    """A folder `build` in which the FMU for STOP is up to date."""

    def fill(folder: Path) -> None:
        assert process(folder, "build", "Synchronizer").status == 0

    return shared.once("cli", fill) / "build"


@pytest.fixture
def workshop(motionsync: Command, built: Path) -> Command:
    """`motionsync` in a folder with an up-to-date FMU and the scenario `stop`."""
    shutil.copytree(built, "build")
    scenario("stop")
    return motionsync


def description(fmu: Path) -> Element:
    with zipfile.ZipFile(fmu) as z:
        return fromstring(z.read("modelDescription.xml"))


def start_value(fmu: Path, name: str) -> str | None:
    (variable,) = description(fmu).iterfind(f"ModelVariables/ScalarVariable[@name='{name}']/*")
    return variable.get("start")


def the_fmu(folder: str) -> Path:
    (file,) = Path(folder).rglob("*.fmu")
    return file


# --- build ---


def test_build_without_a_name_builds_every_block(motionsync: Command) -> None:
    """In one flavour; that both are built is seen with one block."""
    done = motionsync("build", "--folder", "here", *PYTHON)
    assert done.status == 0
    assert sorted(f.name for f in Path("here/python").iterdir()) == sorted(f"{name}.fmu" for name in BLOCKS)
    targets = [str(Path(f"here/python/{name}.fmu")) for name in BLOCKS]
    assert [line.split("  ")[0] for line in done.out.splitlines()] == targets
    assert [line.rstrip(".") for line in done.err.splitlines()] == [f"building {target} " for target in targets]


def test_build_by_name_lands_in_the_folder_build(motionsync: Command) -> None:
    assert motionsync("build", "Synchronizer").status == 0
    assert sorted(map(str, Path("build").rglob("*.fmu"))) == [
        str(Path(f"build/{flavour}/Synchronizer.fmu")) for flavour in FLAVOURS
    ]


@pytest.mark.parametrize(
    ("unit", "base", "factor"),
    [("mm", {"m"}, 1e-3), ("m", {"m"}, 1.0), ("deg", {"rad"}, pi / 180.0), ("rad", {"rad"}, 1.0), ("1", set(), 1.0)],
)
def test_the_unit_of_all_positions_can_be_chosen(motionsync: Command, unit: str, base: set[str], factor: float) -> None:
    assert motionsync("build", "Synchronizer", *PYTHON, "--unit", unit, "--folder", "here").status == 0
    xml = description(the_fmu("here"))
    for quantity, symbol in (("Position", unit), ("Velocity", f"{unit}/s"), ("Acceleration", f"{unit}/s2")):
        (real,) = xml.iterfind(f"TypeDefinitions/SimpleType[@name='{quantity}']/Real")
        assert real.get("unit") == symbol
    (velocity,) = xml.iterfind(f"UnitDefinitions/Unit[@name='{unit}/s']/BaseUnit")
    assert float(velocity.get("factor", "1")) == factor
    assert {name: power for name, power in velocity.attrib.items() if name != "factor"} == (
        dict.fromkeys(base, "1") | {"s": "-1"}
    )


def test_baked_start_values_stand_in_the_description_and_act_in_a_run(motionsync: Command) -> None:
    starts = {"curve": "PARABOLA", "output_phasing": "-7.5", "rest_value": "-20", "active": "TRUE", "stop": "0"}
    options = [part for name, value in starts.items() for part in ("--start", f"{name}={value}")]
    assert motionsync("build", "Synchronizer", *PYTHON, *options, "--folder", "here").status == 0
    fmu = the_fmu("here")
    found = {name: start_value(fmu, name) for name in starts}
    assert found == {
        "curve": "1",
        "output_phasing": "-7.5",
        "rest_value": "-20.0",
        "active": "true",
        "stop": "false",
    }
    # A falling master: the slave leaves it at -12.5 and rests at -20, where the master is at -27.5.
    times = np.arange(0.0, 1.001, 0.01)
    signal = np.array(
        [(t, -100.0 * t, -100.0, t >= 0.05) for t in times],
        [("time", float), ("master.position", float), ("master.velocity", float), ("stop", bool)],
    )
    outputs = ["slave.position", "slave.velocity", "local.transition_distance"]
    recording = simulate_fmu(str(fmu), stop_time=1.0, output_interval=0.01, input=signal, output=outputs)
    half_way = recording[np.searchsorted(recording["time"], 0.2 - 1e-9)]
    assert half_way["slave.position"] == pytest.approx(-12.5 - 0.75 * 7.5, abs=1e-9)
    assert half_way["slave.velocity"] == pytest.approx(-50.0, abs=1e-9)
    assert (recording["slave.position"][-1], recording["local.transition_distance"][-1]) == (-20.0, 15.0)


def test_names_of_blocks_flavours_units_and_members_may_have_any_case(motionsync: Command) -> None:
    start = ("--start", "curve=parabola", "--unit", "DEG", "--flavour", "PYTHON", "--folder", "here")
    assert motionsync("build", "synchronizer", *start).status == 0
    fmu = Path("here/python/Synchronizer.fmu")
    assert start_value(fmu, "curve") == "1"
    assert "deg" in motionsync("describe", fmu).out.split()
    assert motionsync("describe", "FLYINGSAW", "--unit", "M").out.startswith("FlyingSaw: ")
    assert "FlyingSaw/cyclic_cut" in motionsync("list", "flyingsaw").out


def test_a_second_build_is_byte_identical(motionsync: Command, tmp_path: Path) -> None:
    """Of the native flavour tests/native/test_libraries.py shows it."""
    assert motionsync("build", "Synchronizer", *PYTHON, "--folder", "here").status == 0
    assert process(tmp_path, "build", "Synchronizer", *PYTHON, "--folder", "there").status == 0
    assert the_fmu("here").read_bytes() == the_fmu("there").read_bytes()


def test_unit_and_start_values_change_the_guid(motionsync: Command) -> None:
    options = [
        (),
        ("--unit", "deg"),
        ("--start", "rest_value=5"),
        ("--start", "rest_value=6"),
        ("--start", "curve=PARABOLA"),
    ]
    guids = []
    for i, option in enumerate(options):
        assert motionsync("build", "Synchronizer", *PYTHON, *option, "--folder", str(i)).status == 0
        guids.append(description(the_fmu(str(i))).get("guid"))
    assert len(set(guids)) == len(options)


def test_an_enumeration_by_number_is_the_same_build_as_by_name(motionsync: Command) -> None:
    for folder, value in (("name", "PARABOLA"), ("number", "1")):
        assert motionsync("build", "Synchronizer", *PYTHON, "--start", f"curve={value}", "--folder", folder).status == 0
    assert the_fmu("name").read_bytes() == the_fmu("number").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("Nope",), ("'Nope'", "Synchronizer")),
        (("Synchroniser",), ("'Synchroniser'", "did you mean Synchronizer")),
        (("Synchronizer", "--flavour", "nativ"), ("'nativ' is not one of 'native', 'python'",)),
        (("Synchronizer", "Nope"), ("'Nope'",)),
        (("Synchronizer", "--unit", "km"), ("km", "mm", "deg")),
        (("Synchronizer", "--start", "rest_value"), ("rest_value", "NAME=VALUE")),
        (("Synchronizer", "--start", "rest_valu=3"), ("'rest_valu'", "rest_value")),
        (("Synchronizer", "--start", "=3"), ("''", "parameter or input")),
        (("Synchronizer", "--start", "slave.position=3"), ("slave.position", "parameter or input")),
        (("Synchronizer", "--start", "rest_value=abc"), ("rest_value = abc", "Real")),
        (("Synchronizer", "--start", "rest_value="), ("rest_value", "Real")),
        (("Synchronizer", "--start", "rest_value=nan"), ("rest_value = nan", "-1e+12 to 1e+12")),
        (("Synchronizer", "--start", "rest_value=1e13"), ("rest_value = 1e+13", "-1e+12 to 1e+12")),
        (("Synchronizer", "--start", "output_phasing=0"), ("output_phasing = 0", "1e-09 to 1e+12")),
        (("Synchronizer", "--start", "master.period=-1"), ("master.period = -1", "0, or >= 1e-09")),
        (("Synchronizer", "--start", "active=yes"), ("active = yes", "true or false")),
        (("Synchronizer", "--start", "curve=CUBIC"), ("curve = CUBIC", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "curve=3"), ("curve = 3", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "curve=1.5"), ("curve = 1.5", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "active=1", "--start", "active=0"), ("--start active", "twice", "1", "0")),
        (("Synchronizer", "--input", "output_fasing"), ("--input: no variable", "'output_fasing'", "output_phasing")),
        (("Synchronizer", "--input", "curve"), ("--input: curve cannot become an input", "fixed")),
        (("Synchronizer", "--parameter", "st*"), ("--parameter: start cannot become a parameter", "command")),
        (("Synchronizer", "--local", "slave.*"), ("--local: slave.position cannot become a local variable",)),
        (("Synchronizer", "--output", "elsewhere"), ("--output: no variable of Synchronizer is named 'elsewhere'",)),
        (
            ("Synchronizer", "--parameter", "rest_value", "--input", "rest_*"),
            ("--parameter: rest_value is already turned to an input",),
        ),
        (("--local", "ready"), ("--local", "one block")),
    ],
)
def test_a_mistake_in_build_is_one_line_and_builds_nothing(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("build", *arguments), *parts)
    assert not Path("build").exists()


def test_start_values_need_one_block(motionsync: Command) -> None:
    assert_one_line(
        motionsync("build", "Synchronizer", "Synchronizer", "--start", "rest_value=3"), "--start", "one block"
    )


def test_an_fmu_that_is_up_to_date_is_built_again_by_force_only(motionsync: Command) -> None:
    build = ("build", "Synchronizer", *PYTHON)
    assert motionsync(*build).status == 0
    fmu = the_fmu("build")
    first, content = fmu.stat().st_mtime_ns, fmu.read_bytes()
    again = motionsync(*build)
    assert (again.status, again.out) == (0, f"{fmu}  is up to date\n")
    assert fmu.stat().st_mtime_ns == first
    assert "kB" in motionsync(*build, "--force").out
    assert fmu.stat().st_mtime_ns != first
    assert fmu.read_bytes() == content
    assert "kB" in motionsync(*build, "--unit", "deg").out
    assert "kB" in motionsync(*build).out


def test_turned_variables_have_an_fmu_of_their_own(motionsync: Command) -> None:
    turns = ("--input", "output_*", "--parameter", "active", "--parameter", "rest_value", "--local", "ready")
    assert motionsync("build", "Synchronizer", *PYTHON).status == 0
    default = the_fmu("build").read_bytes()
    done = motionsync("build", "Synchronizer", *PYTHON, *turns, "--output", "local.*")
    assert done.status == 0
    fmu = Path(done.out.split("  ")[0])
    assert Path("build/python/Synchronizer.fmu").read_bytes() == default
    found = {
        v.get("name"): f"{v.get('variability')} {v.get('causality')}"
        for v in description(fmu).iterfind("ModelVariables/ScalarVariable")
    }
    assert found["output_phasing"] == "discrete input"
    assert found["active"] == found["rest_value"] == "tunable parameter"
    assert found["ready"] == "discrete local"
    assert found["local.progress"] == "continuous output"
    assert found["curve"] == "fixed parameter"
    shown = motionsync("describe", fmu).out
    for text in ("output_phasing  input, Real", "active  tunable parameter, Boolean", "local.progress  output, Real"):
        assert f"\n  {text}" in shown
    assert "POLYNOMIAL_3_4_5" in shown


def test_a_scenario_with_an_interface_leaves_the_default_fmu_alone(motionsync: Command, cache: Path) -> None:
    """STOP sets stop alone; the turned variables keep their start values, so its expectations hold."""
    turned = '[interface]\ninput = "output_phasing"\nparameter = ["active", "rest_value"]\n\n[start]'
    scenario("wired", STOP.replace("[start]", turned, 1))
    scenario("stop")
    assert motionsync("build", "Synchronizer", *PYTHON).status == 0
    default = the_fmu("build").stat().st_mtime_ns
    for folder, built in (("wired", True), ("stop", False), ("wired", False)):
        done = motionsync("run", folder, *PYTHON, "--no-report")
        assert done.status == 0, done
        assert ("building" in done.err) == built
    assert the_fmu(str(cache)).name.startswith("Synchronizer-")
    assert the_fmu("build").stat().st_mtime_ns == default


@pytest.mark.parametrize("epoch", ["yesterday", "1.5", "99999999999", "99999999999999999999"])
def test_a_bad_source_date_epoch_is_one_line(motionsync: Command, monkeypatch: pytest.MonkeyPatch, epoch: str) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    assert_one_line(motionsync("build", "Synchronizer", *PYTHON), "SOURCE_DATE_EPOCH", epoch)


def test_an_output_folder_that_cannot_be_made_is_one_line(workshop: Command) -> None:
    Path("taken").write_text("a file")
    assert_one_line(workshop("build", "Synchronizer", "--folder", "taken"), "taken")
    assert_one_line(workshop("run", "stop", "--no-report", "--output", "taken"), "taken")


# --- list, describe, help ---


def test_list_counts_the_scenarios_of_each_block(motionsync: Command) -> None:
    done = motionsync("list")
    assert (done.status, done.err) == (0, "")
    counts = dict(re.findall(r"^ *(\w+) +(\d+) ", done.out, re.M))
    for name in BLOCKS:
        files = (ROOT / "scenarios").rglob("scenario.toml")
        assert counts[name] == str(sum(f'\nfmu = "{name}"\n' in file.read_text("utf-8") for file in files))
    assert "line/line.toml" in done.out


def test_list_of_a_block_names_what_can_be_run(motionsync: Command) -> None:
    done = motionsync("list", "Synchronizer")
    assert (done.status, done.err) == (0, "")
    title = "A stop and a start along the 3-4-5 polynomial"
    assert re.search(rf"^ *Synchronizer/polynomial +{title} *$", done.out, re.M)
    assert "FlyingSaw" not in done.out


def test_list_of_an_own_folder_names_its_scenarios_in_full(motionsync: Command) -> None:
    long = Path("mine/Synchronizer/a_scenario_whose_name_says_all_that_happens_in_it")
    scenario(str(long))
    done = motionsync("list", "--scenarios", "mine")
    assert (done.status, done.err) == (0, "")
    assert re.search(rf"^ *{re.escape(str(long))} +A stop along a parabola *$", done.out, re.M)


def test_list_of_a_folder_that_is_missing_says_so(motionsync: Command) -> None:
    done = motionsync("list", "--scenarios", "elsewhere")
    assert done.status == 0
    assert "elsewhere" in done.out


def test_list_tells_of_a_broken_scenario_in_one_line(motionsync: Command) -> None:
    file = scenario("mine", STOP.replace("title =", "titel ="))
    done = motionsync("list", "--scenarios", "mine")
    assert done.status == 2
    assert done.err.startswith(f"motionsync: {file}:1: title: ")
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(("unit", "velocity"), [("mm", "mm/s"), ("deg", "deg/s"), ("1", "1/s")])
def test_describe_shows_every_variable_and_choice(motionsync: Command, unit: str, velocity: str) -> None:
    done = motionsync("describe", "Synchronizer", "--unit", unit)
    assert (done.status, done.err) == (0, "")
    words = done.out.replace(",", " ").split()
    for name in ("master.input_mode", "output_phasing", "rest_value", "slave.jerk", "local.peak_acceleration_per_v2"):
        assert name in words
    for text in ("input", "parameter", "output", "local", velocity):
        assert text in words
    for choice in ("1 START_OF_STEP:", "3 POSITION_ONLY:", "1 PARABOLA:", "0 READY:", "2 STACKED:"):
        assert choice in done.out


def test_describe_of_a_built_fmu_shows_its_own_unit_and_start_values(motionsync: Command) -> None:
    options = ("--unit", "deg", "--start", "rest_value=12.25", "--folder", "here")
    assert motionsync("build", "Synchronizer", *PYTHON, *options).status == 0
    done = motionsync("describe", the_fmu("here"))
    assert (done.status, done.err) == (0, "")
    assert {"deg/s2", "12.25"} <= set(done.out.split())
    assert "mm/s2" not in done.out


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("Nope",), ("'Nope'", "Synchronizer")),
        (("Synchronizer", "--unit", "furlong"), ("furlong", "mm")),
        (("nowhere.fmu",), ("nowhere.fmu", "no such file")),
        (("build/native/FlyingSaw",), ("build/native/FlyingSaw", "no such file")),
        (("FlyingSaw", "--slave-unit", "deg"), ("slave unit 'deg'", "in its master's unit")),
        (("text.fmu",), ("text.fmu", "not an FMU")),
    ],
)
def test_a_mistake_in_describe_is_one_line(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    Path("text.fmu").write_text("no FMU")
    assert_one_line(motionsync("describe", *arguments), *parts)


@pytest.mark.parametrize("name", BLOCKS)
def test_describe_tells_the_fault_codes(motionsync: Command, name: str) -> None:
    """Each code of the block's faults stands there, with its sentence."""
    module = import_module(type(Recipe(name).block()).__module__.replace(".block", ".faults"))
    _, _, told = motionsync("describe", name).out.partition("Fault codes")
    assert told
    for fault in module.Fault:
        if fault.value:
            assert re.search(rf"^  {fault.value} .*{fault.name}: {re.escape(fault.description)}$", told, re.MULTILINE)


def test_describe_fits_a_terminal_of_80_columns(monkeypatch: pytest.MonkeyPatch, motionsync: Command) -> None:
    monkeypatch.setattr(console.out, "_force_terminal", True)
    monkeypatch.setattr(console.out, "_width", 80)
    monkeypatch.setattr(console.out, "no_color", True)
    for name in BLOCKS:
        lines = re.sub(r"\x1b\[[0-9;]*m", "", motionsync("describe", name).out).splitlines()
        headings = [line for line in lines if not line.startswith(" ")]
        assert [line for line in lines if len(line) > 80 and line not in headings] == []


@pytest.mark.parametrize(
    "asked", [("17118",), ("0x42DE",), ("0x42de",), ("flyingsaw", "17118"), ("must", "LIE", "ahead")]
)
def test_error_explains_a_code(motionsync: Command, asked: tuple[str, ...]) -> None:
    done = motionsync("error", *asked)
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith(
        "FlyingSaw, 17118 = 0x42DE (NOT_AHEAD)\n  refused (0x42DE): both sync positions must lie"
    )
    assert "gear_in_pos.error_id" in done.out
    assert "master.position" in done.out


def test_error_tells_all_blocks_that_have_a_code(motionsync: Command) -> None:
    told = motionsync("error", "2").out
    assert re.findall(r"^(\w+), 2 ", told, re.MULTILINE) == ["FlyingSaw", "Gearing", "Follower", *3 * ["CutToLength"]]
    assert re.findall(r"^(\w+), 2 ", motionsync("error", "Follower", "2").out, re.MULTILINE) == ["Follower"]


@pytest.mark.parametrize(
    ("asked", "parts"),
    [
        (("17000",), ("fault code 17000", "17006 = 0x426E (FlyingSaw)")),
        (("Follower", "17118"), ("fault code 17118", "14 (Follower)")),
        (("purple", "elephant"), ("'purple elephant'", "motionsync describe")),
    ],
)
def test_an_unknown_code_is_one_line_with_the_nearest(
    motionsync: Command, asked: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("error", *asked), *parts)


@pytest.mark.parametrize("name", BLOCKS)
def test_a_new_scenario_runs_as_expected(motionsync: Command, fmus: Fmus, name: str) -> None:
    fmus.copied(Flavour.PYTHON, name, Path("build"))
    made = motionsync("new", name.lower(), "mine/first")
    assert (made.status, made.err) == (0, "")
    file = Path("mine/first/scenario.toml")
    assert made.out.splitlines()[:2] == [f"written: {file}", f"run it:  motionsync run {file.parent} --open"]
    assert file.read_text("utf-8").count("\n# ") >= 4
    done = motionsync("run", "mine/first", *PYTHON, "--no-report")
    assert (done.status, done.err) == (0, "")
    assert ": as expected\n" in done.out
    assert_one_line(motionsync("new", name, "mine/first"), str(file), "exists")


def test_an_unknown_command_is_one_line(motionsync: Command) -> None:
    assert_one_line(motionsync("runn"), "No such command 'runn'", "describe", "new")


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_each_command_has_an_example_that_works(command: str) -> None:
    text = CliRunner().invoke(cli.app, [command, "--help"]).output
    _, _, examples = text.partition("Example")
    assert f"motionsync {command}" in examples
    for name in re.findall(r"motionsync (?:run|line) ([^-\s]\S*)", examples.partition("Options:")[0]):
        assert find(Path(name), LINES if command == "line" else FILE)


def test_help_lists_the_commands() -> None:
    text = CliRunner().invoke(cli.app, ["--help"]).output
    for command in COMMANDS:
        assert re.search(rf"^ +{command} .*\.$", text, re.MULTILINE)
    assert "..." not in text.partition("Commands:")[2]


# --- run ---


def test_run_takes_a_file_a_folder_and_several(workshop: Command) -> None:
    file = scenario("more/other", STOP.replace("A stop along", "Another stop along"))
    done = workshop("run", file, "--no-report")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith(f"Another stop along a parabola ({file.parent}): as expected\n")
    for paths in (["more", "stop/scenario.toml"], ["."]):
        done = workshop("run", *paths, "--no-report")
        assert (done.status, done.err) == (0, "")
        names = re.findall(r"^ok +(\S+) ", done.out, re.MULTILINE)
        assert names == ["Synchronizer/other", "Synchronizer/stop"]


# The slave goes with 100 mm/s, and from there to rest between 20 and 30: a = v^2/(2 s) = 10000/20 = 500 mm/s2; a
# parabola's acceleration jumps, so its jerk is told as 0.
PEAKS = "v 100 mm/s, a 500 mm/s2, j 0 mm/s3"


def test_a_result_is_a_line_and_a_summary_ends_with_the_address(workshop: Command) -> None:
    scenario("other")
    done = workshop("run", ".")
    assert (done.status, done.err) == (0, "")
    page = Path("build/reports/index.html").resolve()
    assert done.out.splitlines() == [
        f"ok  Synchronizer/other  {PEAKS}",
        f"ok  Synchronizer/stop   {PEAKS}",
        "",
        "2 scenarios: all as expected",
        f"report: {page.as_uri()}",
    ]
    links = re.findall(r'href="([^"]*)"', page.read_text("utf-8"))
    assert links == ["Synchronizer/other/report.html", "Synchronizer/stop/report.html"]
    assert all((page.parent / link).is_file() for link in links)


def test_the_result_of_one_scenario_has_a_line_for_each_figure(workshop: Command) -> None:
    done = workshop("run", "stop")
    assert (done.status, done.err) == (0, "")
    assert done.out.splitlines() == [
        "A stop along a parabola (stop): as expected",
        "  position      0 to 30 mm",
        "  velocity      100 mm/s",
        "  acceleration  500 mm/s2",
        "  jerk          0 mm/s3",
        "  expectations  4 of 4 kept",
        f"  result        {Path('build/reports/Synchronizer/stop/Synchronizer_out.csv')}",
        f"report: {Path('build/reports/Synchronizer/stop/report.html').resolve().as_uri()}",
    ]


def test_verbose_tells_all_that_was_judged(workshop: Command) -> None:
    done = workshop("run", "stop", "--no-report", "--verbose")
    assert done.status == 0
    assert done.out.count("  kept    ") == 4
    assert "the same with FMPy alone: fmpy simulate " in done.out
    assert "fmpy simulate" not in workshop("run", "stop", "--no-report").out


def test_the_report_is_opened_in_the_browser(workshop: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    assert workshop("run", "stop", "--open").status == 0
    assert shown == [Path("build/reports/Synchronizer/stop/report.html").resolve().as_uri()]
    assert_one_line(workshop("run", "stop", "--open", "--no-report"), "--open", "--no-report")


def test_marks_that_pass_uncut_are_told_beside_a_good_result(workshop: Command) -> None:
    """The material goes on to 50 mm, the slave stops at 30 mm: of the marks at 0.05, 2.05, ... the first is cut, and
    those below 50 - 30 have passed."""
    table = '\n[cuts]\nwhile = "syn_synchronized"\nlength = 2.0\noffset = 0.05\n'
    scenario("saw", STOP + table)
    alone = workshop("run", "saw", "--no-report")
    assert alone.status == 0
    assert "(saw): as expected, with 1 remark\n  ! 9 marks passed uncut: 2.05, 4.05, … mm\n" in alone.out
    both = workshop("run", "saw", "stop", "--no-report")
    assert both.status == 0
    assert f"ok! Synchronizer/saw   1 cut, worst error 0.05 mm (mark 0.05 mm); {PEAKS}\n" in both.out
    assert "2 scenarios: all as expected\n! 1 result with a remark: Synchronizer/saw\n" in both.out


def test_a_reaction_that_never_happens_is_told(workshop: Command) -> None:
    """The slave never goes beyond 30 mm; a required reaction is judged."""
    table = '\n[[on]]\nwhen = "slave.position > 31"\nset = { rest_value = 5.0 }\n'
    scenario("late", STOP + table)
    done = workshop("run", "late", "stop", "--no-report")
    assert done.status == 0
    assert "    ! reaction to slave.position > 31 once: found never\n" in done.out
    assert "2 scenarios: all as expected\n! 1 result with a remark: Synchronizer/late\n" in done.out
    scenario("late", STOP + table + "required = true\n")
    done = workshop("run", "late", "stop", "--no-report")
    assert done.status == 1
    assert "    broken  reaction to slave.position > 31 once: found never\n" in done.out


def test_a_scenario_that_judges_nothing_says_so(workshop: Command) -> None:
    scenario("free", STOP[: STOP.index("[[expect]]")])
    done = workshop("run", "free", "--no-report")
    assert done.status == 0
    assert "as expected, with 1 remark\n  ! nothing is judged" in done.out


def test_what_the_fmu_logs_is_counted_and_shown(workshop: Command) -> None:
    """A phasing of 0 is refused when a stop reads it."""
    scenario("refused", STOP.replace("stop = true", "stop = true\noutput_phasing = 0.0").split("[[expect]]")[0])
    assert re.search(r"^  the FMU logged: .*output_phasing = 0", workshop("run", "refused").out, re.MULTILINE)
    assert "; 1 message of the FMU\n" in workshop("run", "refused", "stop").out


@pytest.mark.parametrize(("options", "printed"), [((), "1 of 3"), (("--json",), "1 of 3")])
def test_an_interruption_keeps_what_is_finished(
    workshop: Command, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], printed: str
) -> None:
    for name in ("a", "b"):
        scenario(name)
    write = results.write_outcome

    def interrupted(s: Any, *arguments: Any, **options: Any) -> Any:
        if s.name == "b":
            monkeypatch.setattr(results, "inputs_csv", interrupted_too)
        return write(s, *arguments, **options)

    def interrupted_too(_: Any) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(results, "write_outcome", interrupted)
    done = workshop("run", ".", *options)
    assert (done.status, done.err) == (130, f"motionsync: interrupted after {printed}\n")
    if options:
        assert [result["name"] for result in json.loads(done.out)] == ["Synchronizer/a"]
    else:
        assert done.out.startswith(f"ok  Synchronizer/a     {PEAKS}\n\n1 scenario: as expected\n")
    assert sorted(p.name for p in Path("build/reports").iterdir()) == ["Synchronizer", "index.html"]
    assert [p.name for p in Path("build/reports/Synchronizer").iterdir()] == ["a"]


def test_run_writes_results_and_report(workshop: Command) -> None:
    assert workshop("run", "stop", "--output", "results").status == 0
    with Path("results/Synchronizer/stop/Synchronizer_out.csv").open(newline="") as f:
        header, *rows = list(csv.reader(f))
    assert header[0] == "time"
    axis = [
        f"{part}.{name}" for part in ("master", "slave") for name in ("position", "velocity", "acceleration", "jerk")
    ]
    assert header[:10] == ["time", *axis, "state"]
    assert {"state_code", "local.progress"} <= set(header)
    assert {row[header.index("state")] for row in rows} <= {"0", "1", "2"}
    assert {row[header.index("synchronized")] for row in rows} == {"0", "1"}
    assert [float(row[header.index("master.position")]) for row in rows[::10]] == pytest.approx([0, 10, 20, 30, 40, 50])
    times = [float(row[0]) for row in rows]
    assert times == pytest.approx([i * 0.01 for i in range(51)], abs=1e-12)
    position = header.index("slave.position")
    assert float(rows[10][position]) == pytest.approx(10.0, abs=1e-12)
    assert float(rows[30][position]) == pytest.approx(27.5, abs=1e-9)
    assert float(rows[50][position]) == 30.0
    assert Path("results/Synchronizer/stop/report.html").is_file()


def test_run_without_a_report_writes_none(workshop: Command) -> None:
    assert workshop("run", "stop", "--no-report").status == 0
    names = sorted(p.name for p in Path("build/reports").rglob("*") if p.is_file())
    assert names == ["Synchronizer_in.csv", "Synchronizer_out.csv"]


def test_the_printed_line_for_fmpy_runs_also_a_scenario_without_generated_files(workshop: Command) -> None:
    (result,) = json.loads(workshop("run", "stop", "--no-report", "--json").out)
    words = shlex.split(result["fmpy"])
    fmpy = str(Path(sys.executable).with_name(words[0]))
    subprocess.run([fmpy, *words[1:], "--output-variables", "slave.position"], check=True)
    with Path("Synchronizer_out.csv").open(newline="") as f:
        rows = {round(float(row["time"]), 6): float(row["slave.position"]) for row in csv.DictReader(f)}
    assert rows[0.3] == pytest.approx(27.5, abs=1e-9)  # what the scenario expects


class Loads(HTMLParser):
    """Collects what a page would load from elsewhere, and its text."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.links: list[str | None] = []
        self.words: list[str] = []
        self.tag = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tag = tag
        if tag == "a":  # a link loads nothing until somebody follows it
            self.links += [v for k, v in attrs if k == "href"]
            return
        self.found += [f"{tag} {k}={v}" for k, v in attrs if k in ("src", "href", "srcset", "data", "action", "poster")]
        self.found += [f"{tag} {k}={v}" for k, v in attrs if k == "style" and "url(" in (v or "")]

    def handle_endtag(self, tag: str) -> None:
        self.tag = ""

    def handle_data(self, data: str) -> None:
        if self.tag == "style":
            self.found += re.findall(r"@import.*|url\(.*", data)
        elif self.tag != "script":
            self.words += data.split()


def test_the_report_is_one_self_contained_page(workshop: Command) -> None:
    assert workshop("run", "stop").status == 0
    folder = Path("build/reports/Synchronizer/stop")
    assert sorted(p.name for p in folder.iterdir()) == ["Synchronizer_in.csv", "Synchronizer_out.csv", "report.html"]
    page = Loads()
    page.feed((folder / "report.html").read_text("utf-8"))
    assert page.found == []
    assert page.links == ["Synchronizer_out.csv"]
    text = " ".join(page.words)
    for part in ("A stop along a parabola", "By hand", "slave.position = 27.5", "synchronized == false", "rest_value"):
        assert part in text


def test_the_report_escapes_what_the_scenario_says(workshop: Command) -> None:
    scenario("odd", STOP.replace("A stop along", "<img src='http://example.org'> & </script>"))
    assert workshop("run", "odd").status == 0
    page = Loads()
    page.feed(Path("build/reports/Synchronizer/odd/report.html").read_text("utf-8"))
    assert page.found == []
    assert "<img src='http://example.org'> & </script> a parabola" in " ".join(page.words)


def test_json_has_all_that_was_found_and_nothing_else_is_printed(workshop: Command) -> None:
    Path("stop/Synchronizer_ref.csv").write_text('"time","slave.position"\n0.0,0.0\n0.1,10.0\n0.3,27.5\n0.5,30.0\n')
    Path("stop/Synchronizer_ref.opt").write_text("StartTime, 0.0\nStopTime, 0.5\nStepSize, 0.01\nRelTol, 1e-9\n")
    done = workshop("run", "stop", "--json", "--no-report")
    assert (done.status, done.err) == (0, "")
    (result,) = json.loads(done.out)
    found = [e.pop("found") for e in result["expectations"]]
    (deviation,) = result["reference"]
    assert deviation.pop("max_difference") <= 3e-8
    assert deviation.pop("at") in (0.0, 0.1, 0.3, 0.5)
    peaks = {p["name"]: (p["least"], p["greatest"], p["limit"], p["exceeded"]) for p in result.pop("peaks")}
    assert {name: of[2:] for name, of in peaks.items()} == dict.fromkeys(peaks, (None, False))
    assert {name: of[:2] for name, of in peaks.items()} == {
        "position": (0.0, 30.0),
        "velocity": (0.0, 100.0),
        "acceleration": (pytest.approx(-500.0), 0.0),
        "jerk": (0.0, 0.0),
    }
    assert result == {
        "scenario": "stop",
        "name": "Synchronizer/stop",
        "title": "A stop along a parabola",
        "fmu": "Synchronizer",
        "step_size": 0.01,
        "passed": True,
        "expectations": [
            {"expected": "slave.position = 27.5 ± 1e-9 at 0.3 s", "passed": True},
            {"expected": "slave.velocity = 50 ± 1e-9 at 0.3 s", "passed": True},
            {"expected": "first synchronized == false at 0.4 s ± 0.01", "passed": True},
            {"expected": "slave.velocity from 0 to 100 ± 1e-9 between 0 s and 0.5 s", "passed": True},
        ],
        "reference": [{"variable": "slave.position", "allowed": pytest.approx(3e-8), "passed": True}],
        "cuts": [],
        "uncut": [],
        "production": None,
        "remarks": [],
        "messages": [],
        "result": str(Path("build/reports/Synchronizer/stop/Synchronizer_out.csv")),
        "report": None,
        "fmpy": result["fmpy"],
    }
    assert found == ["27.5", "50", "0.4 s", "0 to 100"]


def test_cuts_are_told_and_shown(workshop: Command) -> None:
    """The slave is the master until 0.2 s: one cut, 0.5 mm before the mark."""
    table = '\n[cuts]\nwhile = "syn_synchronized"\nlength = 20.0\noffset = 0.5\ntolerance = {}\n'
    scenario("saw", STOP + table.format(0.6))
    done = workshop("run", "saw")
    assert (done.status, done.err) == (0, "")
    assert "  saw           1 cut, worst error 0.5 mm (mark 0.5 mm); 0.6 mm allowed\n" in done.out
    verbose = workshop("run", "saw", "--no-report", "-v").out
    assert "kept    cuts within 0.6 mm of a mark, one mark each 20 mm: found at most 0.5 mm away\n" in verbose
    page = Loads()
    page.feed(Path("build/reports/Synchronizer/saw/report.html").read_text("utf-8"))
    assert page.found == []
    text = " ".join(page.words)
    assert "A cut each time syn_synchronized is true; a mark on the material each 20 mm, from 0.5 on" in text
    assert re.search(r"cut from to mark error 1 0 s 0\.(19|2) s 0\.5 mm -0\.5 mm ", text)
    scenario("saw", STOP + table.format(0.4))
    done = workshop("run", "saw", "--json", "--no-report")
    assert done.status == 1
    (result,) = json.loads(done.out)
    (cut,) = result["cuts"]
    assert cut == pytest.approx({"begin": 0.0, "end": cut["end"], "mark": 0.5, "error": -0.5}, abs=1e-9)


def test_a_run_without_a_cut_is_told_and_judged(workshop: Command) -> None:
    """It is as expected only where the scenario wants no cut."""
    table = '\n[cuts]\nwhile = "error"\nlength = 20.0\n'
    scenario("saw", STOP + table)
    done = workshop("run", "saw")
    assert (done.status, done.err) == (1, "")
    assert "  saw           no cut; 0.1 mm allowed\n" in done.out
    assert "There was none." in Path("build/reports/Synchronizer/saw/report.html").read_text("utf-8")
    scenario("saw", STOP + table + "count = 0\n")
    assert workshop("run", "saw", "--no-report").status == 0


def test_a_cut_is_judged_with_a_tenth_of_a_millimetre_where_the_scenario_does_not_say(workshop: Command) -> None:
    """The cut is 0.5 mm before the mark, as above; in metres the tolerance would be 0.0001, too."""
    table = '\n[cuts]\nwhile = "syn_synchronized"\nlength = 20.0\noffset = {}\n'
    for offset, status in ((0.5, 1), (0.09, 0), (-0.09, 0), (0.11, 1)):
        scenario("saw", STOP + table.format(offset))
        assert workshop("run", "saw", "--no-report").status == status


def test_the_step_size_can_be_chosen(workshop: Command) -> None:
    assert workshop("run", "stop", "--no-report", "--step-size", "0.007").status == 0
    text = Path("build/reports/Synchronizer/stop/Synchronizer_out.csv").read_text()
    times = [float(line.split(",")[0]) for line in text.splitlines()[1:]]
    regular = {round(i * 0.007, 9) for i in range(72)}  # and where something is set, expected, or ends
    assert {round(t, 9) for t in times} == regular | {0.1, 0.3, 0.5}


def test_a_scenario_that_reacts_has_the_scans_of_its_file_at_another_step_size(motionsync: Command, fmus: Fmus) -> None:
    fmus.copied(Flavour.PYTHON, "FlyingSaw", Path("build"))
    done = motionsync("run", "FlyingSaw/cyclic_cut", "--step-size", 0.007, "--no-report", *PYTHON)
    assert done.status == 0
    assert "20 cuts, worst error 0 (to rounding)" in done.out


def test_the_report_of_a_run_tells_the_reactions_and_what_they_set(motionsync: Command, fmus: Fmus) -> None:
    fmus.copied(Flavour.PYTHON, "FlyingSaw", Path("build"))
    assert motionsync("run", "FlyingSaw/cyclic_cut", *PYTHON).status == 0
    page = Path("build/reports/FlyingSaw/cyclic_cut/report.html").read_text("utf-8")
    reactions = page[page.index("<h3>Reactions</h3>") : page.index("<h3>The master</h3>")]
    assert re.findall(r'<td class="name">(.*?)</td>.*?<td>(each time)</td>', reactions) == [
        ("in_sync", "each time"),
        ("slave.position &lt; 180", "each time"),
    ]


def test_what_cannot_run_at_a_step_size_is_left_out_with_the_reason(motionsync: Command, fmus: Fmus) -> None:
    for name in ("FlyingSaw", "Synchronizer"):
        fmus.copied(Flavour.PYTHON, name, Path("build"))
    names = ("FlyingSaw/diagonal_saw", "Synchronizer/phasing_changed_while_executing")
    left_out = ("RemoteSync/accelerating_axis", "RemoteSync/no_drift", "Synchronizer/position_only_input")
    done = motionsync("run", *PYTHON, *names, *left_out, "--step-size", "0.007", "--no-report")
    assert (done.status, done.err) == (0, "")
    assert re.findall(r"^ok +(\S+) ", done.out, re.MULTILINE) == list(names)
    assert done.out.splitlines()[-3:] == [
        "2 scenarios: all as expected",
        "! 2 not run: RemoteSync works in cycles of 0.002 s, and a step of 0.007 s is longer: "
        "RemoteSync/accelerating_axis, RemoteSync/no_drift",
        "! 1 not run: POSITION_ONLY takes the velocity from the last two positions: Synchronizer/position_only_input",
    ]
    alone = motionsync("run", *PYTHON, left_out[0], "--step-size", "0.007")
    assert_one_line(alone, "--step-size 0.007", "RemoteSync works in cycles of 0.002 s")


def test_the_line_for_fmpy_has_the_step_that_was_run(workshop: Command) -> None:
    (result,) = json.loads(workshop("run", "stop", "--no-report", "--json", "--step-size", "0.02").out)
    assert "--output-interval 0.02 " in result["fmpy"]
    with Path("build/reports/Synchronizer/stop/Synchronizer_in.csv").open(newline="") as f:
        times = [float(row["time"]) for row in csv.DictReader(f)]
    assert times == pytest.approx([0.02 * i for i in range(25)], abs=1e-12)


def test_an_event_may_come_a_step_late_whatever_the_step_size(workshop: Command) -> None:
    """An expectation without a tolerance allows one step, the run's."""
    done = workshop("run", "stop", "--no-report", "--json", "--step-size", "0.16")
    (result,) = json.loads(done.out)
    assert result["step_size"] == 0.16
    assert [e["found"] for e in result["expectations"] if e["expected"].startswith("first")] == ["0.48 s"]
    assert (done.status, result["passed"]) == (0, True)


def test_a_broken_expectation_is_exit_status_1(workshop: Command) -> None:
    scenario("wrong", STOP.replace("= 27.5", "= 27.6").replace("time = 0.4\n", "time = 0.2\n"))
    done = workshop("run", "wrong", "stop")
    assert (done.status, done.err) == (1, "")
    assert done.out.splitlines()[:-1] == [
        f"NOT Synchronizer/wrong  {PEAKS}",
        "    broken  slave.position = 27.6 ± 1e-9 at 0.3 s: found 27.5",
        "    broken  first synchronized == false at 0.2 s ± 0.01: found 0.4 s",
        f"ok  Synchronizer/stop   {PEAKS}",
        "",
        "2 scenarios: 1 as expected, 1 not: Synchronizer/wrong",
    ]
    alone = workshop("run", "wrong", "-v", "--no-report")
    assert "kept    slave.velocity = 50 ± 1e-9 at 0.3 s: found 50\n" in alone.out
    assert "broken  slave.position = 27.6" in workshop("run", "wrong", "--no-report").out
    assert "broken" in Path("build/reports/Synchronizer/wrong/report.html").read_text("utf-8")


def test_a_condition_that_never_holds_and_a_limit_that_is_passed_are_broken(workshop: Command) -> None:
    changed = STOP.replace("synchronized == false", "slave.position > 31").replace("max = 100.0", "max = 99.0")
    scenario("wrong", changed)
    done = workshop("run", "wrong", "--json", "--no-report")
    assert done.status == 1
    (result,) = json.loads(done.out)
    assert not result["passed"]
    assert [(e["found"], e["passed"]) for e in result["expectations"][2:]] == [("never", False), ("0 to 100", False)]


def test_a_deviation_from_the_reference_is_exit_status_1(workshop: Command) -> None:
    Path("stop/Synchronizer_ref.csv").write_text('"time","slave.position"\n0.0,0.0\n0.1,9.0\n0.5,30.0\n')
    Path("stop/Synchronizer_ref.opt").write_text("RelTol, 1e-9\n")
    done = workshop("run", "stop", "--json", "--no-report")
    assert done.status == 1
    (result,) = json.loads(done.out)
    assert result["passed"] is False
    assert result["reference"] == [
        {
            "variable": "slave.position",
            "max_difference": pytest.approx(1.0, abs=1e-9),
            "at": 0.1,
            "allowed": pytest.approx(3e-8),
            "passed": False,
        }
    ]


@pytest.mark.parametrize(
    ("reference", "options", "part"),
    [
        ('"time","slave.place"\n0.0,0.0\n', "RelTol, 1e-9\n", "slave.place"),
        ('"time","slave.position"\n0.0,zero\n', "RelTol, 1e-9\n", "Synchronizer_ref.csv"),
        ('"time","slave.position"\n0.0\n', "RelTol, 1e-9\n", "Synchronizer_ref.csv"),
        ("", "RelTol, 1e-9\n", "Synchronizer_ref.csv"),
        ('"time","slave.position"\n', "RelTol, 1e-9\n", "Synchronizer_ref.csv"),
        ('"time","slave.position"\n0.0,0.0\n', "StepSize, 1e-9\n", "RelTol"),
        ('"time","slave.position"\n0.0,0.0\n', "RelTol 1e-9\n", "Synchronizer_ref"),
    ],
)
def test_a_reference_that_cannot_be_used_is_one_line(
    workshop: Command, reference: str, options: str, part: str
) -> None:
    Path("stop/Synchronizer_ref.csv").write_text(reference)
    Path("stop/Synchronizer_ref.opt").write_text(options)
    assert_one_line(workshop("run", "stop", "--no-report"), part)


def test_a_missing_fmu_is_built_for_this_machine_and_told(motionsync: Command, cache: Path) -> None:
    scenario("stop")
    first = motionsync("run", "stop", "--no-report", "--json")
    assert first.status == 0
    told = re.fullmatch(r"building (\S+), for this machine alone \.\.+\n", first.err)
    assert told
    assert json.loads(first.out)[0]["passed"]
    fmu = Path(told[1])
    assert fmu.is_relative_to(cache)
    assert fmu.is_file()
    assert not Path("build/native").exists()
    with zipfile.ZipFile(fmu) as z:
        libraries = [name for name in z.namelist() if name.startswith("binaries/")]
    row = here()
    assert row
    assert libraries == [row.library("Synchronizer")]
    assert description(fmu).get("guid") == Recipe("Synchronizer").guid()
    second = motionsync("run", "stop", "--no-report")
    assert (second.status, second.err) == (0, "")


def test_a_stale_fmu_is_left_alone_and_another_one_is_run(workshop: Command, built: Path, cache: Path) -> None:
    fmu = Path("build/python/Synchronizer.fmu")
    fresh = fmu.read_bytes()
    assert workshop("build", "Synchronizer", *PYTHON, "--start", "rest_value=5", "--folder", "other").status == 0
    for other in (the_fmu("other").read_bytes(), b"no FMU", fresh[:3000], b""):
        fmu.write_bytes(other)
        done = workshop("run", "stop", "--no-report", *PYTHON)
        assert done.status == 0
        assert fmu.read_bytes() == other
        (run,) = cache.rglob("*.fmu")
        assert run.read_bytes() == fresh


def test_a_damaged_fmu_in_the_cache_is_built_anew(motionsync: Command, cache: Path) -> None:
    scenario("stop")
    assert motionsync("run", "stop", "--no-report", *PYTHON).status == 0
    (fmu,) = cache.rglob("*.fmu")
    fresh = fmu.read_bytes()
    for other in (b"no FMU", fresh[:3000], b""):
        fmu.write_bytes(other)
        done = motionsync("run", "stop", "--no-report", *PYTHON)
        assert done.status == 0
        assert done.err.startswith(f"building {fmu} ..")
        assert fmu.read_bytes() == fresh


def test_a_folder_in_the_fmus_place_is_one_line(motionsync: Command) -> None:
    scenario("stop")
    Path("build/native/Synchronizer.fmu").mkdir(parents=True)
    assert_one_line(motionsync("run", "stop"), str(Path("build/native/Synchronizer.fmu")))


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("nowhere",), ("nowhere", "no such file or folder")),
        (("Synchronizer/polynomal",), ("no such file or folder", "did you mean Synchronizer/polynomial")),
        (("synchronizer",), ("no such file or folder", "did you mean Synchronizer or ")),
        (("stop", "nowhere/scenario.toml"), (str(Path("nowhere/scenario.toml")), "no such file or folder")),
        (("empty",), ("empty", "no scenario.toml")),
        (("stop", "--step-size", "abc"), ("--step-size abc", "a number of seconds")),
        (("line",), ("this is a line", "motionsync line line")),
        (("line/line.toml",), ("this is a line", f"motionsync line {Path('line/line.toml')}")),
        (("stop", "--step-size", "0"), ("--step-size 0", "> 0")),
        (("stop", "--step-size", "-0.01"), ("--step-size -0.01", "> 0")),
        (("stop", "--step-size", "0.6"), ("--step-size 0.6", "stop time")),
        (("stop", "--step-size", "nan"), ("--step-size nan", "> 0")),
        (("stop", "--step-size", "inf"), ("--step-size inf", "stop time")),
        (("broken",), (str(Path("broken/scenario.toml:5")), "not TOML")),
    ],
)
def test_a_mistake_in_run_is_one_line(workshop: Command, arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    Path("empty").mkdir()
    shutil.copytree(ROOT / "scenarios/line", "line")
    scenario("broken", STOP.replace("step_size = 0.01", "step_size = "))
    assert_one_line(workshop("run", *arguments), *parts)
    assert not Path("build/reports").exists()


def test_a_step_size_with_absurdly_many_steps_is_one_line(workshop: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "_run", lambda *_, **__: pytest.fail("it would take hours and all memory"))
    assert_one_line(workshop("run", "stop", "--step-size", "1e-10"), "--step-size 1e-10", "steps")


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("at = 0.1\nstop = true", "at = 0.1\nrest_value = nan", ("at 0.1 s", "rest_value = nan")),
        ("velocity = 100.0", "velocity = 1e13", ("at 0 s", "master.velocity = 1e+13")),
    ],
)
def test_what_the_fmu_refuses_is_one_line(workshop: Command, old: str, new: str, parts: tuple[str, ...]) -> None:
    file = scenario("refused", STOP.replace(old, new))
    assert_one_line(workshop("run", "refused", "--no-report"), str(file), *parts)


def test_titles_and_paths_are_shown_as_they_are(workshop: Command) -> None:
    """What looks like markup is none."""
    scenario("odd[b]", STOP.replace("A stop along", "[red] [/] [/x] \\\\[bold]"))
    done = workshop("run", "odd[b]", "--no-report")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith("[red] [/] [/x] \\[bold] a parabola (odd[b]): as expected\n")
    listed = workshop("list", "--scenarios", "odd[b]")
    assert listed.status == 0
    assert "[red] [/] [/x]" in listed.out


def test_a_scenario_run_from_its_own_folder_has_its_folders_name(
    workshop: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.move("build", "stop/build")
    monkeypatch.chdir("stop")
    for path in (".", "scenario.toml"):
        assert workshop("run", path, "--output", f"by {path}").status == 0
        assert Path(f"by {path}/Synchronizer/stop/report.html").is_file()


def test_scenarios_of_the_same_name_keep_their_own_results(workshop: Command) -> None:
    for folder in ("a/stop", "b/stop"):
        scenario(folder)
    done = workshop("run", "a", "b", "--no-report", "--json")
    if done.status == 2:  # to refuse it is as good
        assert_one_line(done, "stop")
    else:
        assert len({result["result"] for result in json.loads(done.out)}) == 2


# --- the console script itself ---


@pytest.mark.parametrize("arguments", [("list",), ("--help",), ("run", "--help")])
def test_what_only_tells_loads_no_library_of_runs_and_pictures(arguments: tuple[str, ...]) -> None:
    """They take a second to load; a fresh interpreter shows what a command has loaded."""
    script = (
        f"import sys\nfrom motionsync_fmu import cli\nsys.argv = ['motionsync', *{arguments!r}]\n"
        "try:\n    cli.main()\nexcept SystemExit as e:\n    assert not e.code, e.code\n"
        "print('loaded:', *sorted({name.partition('.')[0] for name in sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert {"motionsync", "motionsync_fmu", "typer"} <= loaded
    assert not loaded & {"matplotlib", "plotly", "ziglang", "fmpy", "PIL"}


def test_the_console_script_passes_exit_status_and_streams_on(built: Path, tmp_path: Path) -> None:
    shutil.copytree(built, tmp_path / "build")
    scenario(str(tmp_path / "stop"))
    scenario(str(tmp_path / "wrong"), STOP.replace("= 27.5", "= 27.6"))
    kept = process(tmp_path, "run", "stop", "--no-report", "--json")
    assert (kept.status, kept.err) == (0, "")
    assert json.loads(kept.out)[0]["passed"] is True
    assert process(tmp_path, "run", "wrong", "--no-report").status == 1
    assert_one_line(process(tmp_path, "run", "nowhere"), "nowhere")


def test_a_terminal_that_cannot_show_a_sign_is_no_reason_to_fail(built: Path, tmp_path: Path) -> None:
    shutil.copytree(built, tmp_path / "build")
    scenario(str(tmp_path / "stop"), STOP.replace("A stop", "90° → a stop"))
    done = process(tmp_path, "run", "stop", "--no-report", PYTHONIOENCODING="ascii")
    assert (done.status, done.err) == (0, "")
    assert "as expected" in done.out


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["run"], "path"),
        (["run", "x", "--step-size", "abc"], "--step-size"),
        (["run", "x", "--flavour", "cobol"], "cobol"),
        (["build", "--start"], "--start"),
        (["bild"], "bild"),
        (["build", "--colour"], "--colour"),
    ],
)
def test_wrong_usage_is_one_line(arguments: list[str], part: str, tmp_path: Path) -> None:
    assert_one_line(process(tmp_path, *arguments), part)


def test_the_version_is_told(motionsync: Command) -> None:
    told = motionsync("--version")
    assert (told.status, told.out, told.err) == (0, f"motionsync {__version__}\n", "")


def test_without_arguments_the_help_is_shown(tmp_path: Path) -> None:
    done = process(tmp_path)
    assert "Commands:" in done.out + done.err
