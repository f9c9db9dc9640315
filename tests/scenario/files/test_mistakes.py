"""What the reader of scenario files reports of a file with a mistake."""

import re
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.files.reader import load_scenario, read_scenario_text
from motionsync_fmu.scenario.scenario import AtTime, When, Within
from tests.support.blocks.drawn import drawn
from tests.support.compiler.calls import calls
from tests.support.scenarios.scenario_texts import SEGMENTS, VALID, assert_refused

SETTINGS = VALID[VALID.index("[[set]]") : VALID.index("[[expect]]")]
WHEN, FROM = "[[expect]]\nwhen", "[[expect]]\nfrom"


def table(text: str) -> str:
    return f"[interface]\n{text}\n\n[start]"


# What is replaced in VALID, by what; the key and the words that the message has. It names the line of the replacement,
# or the line on which the last text starts.
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
    "duration 0": ("duration = 1.5", "duration = 0", "duration", ("0", "> 0")),
    "duration NaN": ("duration = 1.5", "duration = nan", "duration", ("nan", "finite")),
    "duration missing": ("duration = 1.5", "velocity = 1.5", "duration", ("missing",)),
    "two kinds in a segment": ("acceleration = 1.0 },", "acceleration = 1.0, jerk = 2.0 },", "jerk", ("at most one",)),
    "set at 0": ("at = 0.5", "at = 0", "at", ("start value", "[start]")),
    "set after the end": ("at = 0.5", "at = 4.5", "at", ("4.5", "stop_time = 4")),
    "set at the end": ("at = 0.5", "at = 4.0", "at", ("4", "stop_time = 4")),
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
    "from after to": ("from = 0.0\nto = 1.0", "from = 2.0\nto = 1.0", "to", ("1", ">= 2"), "to = 1.0"),
    "to missing": ("to = 1.0\n", "", "to", ("missing",), FROM),
    "to after the end": ("to = 1.0", "to = 4.5", "to", ("4.5", "<= 4")),
    "min above max": ("min = 0.0, max = 90.0", "min = 91.0, max = 90.0", "slave.velocity", ("max", "90", ">= 91")),
    # variables with another causality
    "overridden to what": (
        "[start]",
        table("inputs = 'curve'"),
        "inputs",
        ("unknown key", "input, output"),
        "inputs",
    ),
    "overridden by a number": ("[start]", table("input = 3"), "input", ("3", "a list of texts"), "input"),
    "overridden by numbers": (
        "[start]",
        table("input = ['curve', 3]"),
        "input",
        ("3", "a list of texts"),
        "input",
    ),
    "overridden unknown": ("[start]", table("local = 'redy'"), "local", ("'redy'", "ready"), "local ="),
    "overridden fixed": (
        "[start]",
        table("input = ['c*']"),
        "input",
        ("curve cannot become an input", "fixed"),
        "input",
    ),
    "overridden command": (
        "[start]",
        table("parameter = 'sto?'"),
        "parameter",
        ("stop cannot", "command"),
        "parameter",
    ),
    "overridden twice": (
        "[start]",
        table("parameter = 'rest_value'\ninput = 'rest_value'"),
        "parameter",
        ("rest_value already becomes an input",),
        "parameter",
    ),
    # what every scenario has
    "title missing": ('title = "A good one"\n', "", "title", ("missing",), "source"),
    "fmu missing": ('fmu = "Synchronizer"\n', "", "fmu", ("missing",), "title"),
    "stop_time missing": ("stop_time = 4.0\n", "", "stop_time", ("missing",), "title"),
    "step_size missing": ("step_size = 0.01\n", "", "step_size", ("missing",), "title"),
    "stop_time 0": ("stop_time = 4.0", "stop_time = 0", "stop_time", ("> 0",)),
    "step_size 0": ("step_size = 0.01", "step_size = 0.0", "step_size", ("> 0",)),
    "step_size beyond the end": ("step_size = 0.01", "step_size = 4.5", "step_size", ("4.5", "<= 4")),
    "absurdly many steps": ("step_size = 0.01", "step_size = 1e-9", "step_size", ("1e-09", "steps")),
    "denormal step": ("step_size = 0.01", "step_size = 1e-320", "step_size", ("steps",)),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, key, parts, *named_line = MISTAKES[name]
    assert VALID.count(old) == 1
    at = named_line[0] if named_line else VALID[: VALID.index(old)].count("\n") + 1
    assert_refused(VALID.replace(old, new), tmp_path, at, key, *parts)


def test_without_a_mistake_it_is_read(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(VALID, "utf-8")
    scenario = load_scenario(file)
    assert (scenario.recipe, scenario.unit) == (Recipe("Synchronizer"), "deg")
    assert (scenario.title, scenario.source) == ("A good one", "By hand")
    assert (scenario.stop_time, scenario.step_size, scenario.tolerance) == (4.0, 0.01, 1e-9)
    assert scenario.start == {"master.period": 360.0, "curve": 1, "active": True}
    assert [(s.at, s.values) for s in scenario.settings] == [(0.5, {"stop": True}), (1.5, {"output_phasing": 45.0})]
    assert scenario.master.at(2.0).position == pytest.approx(90.0 * 2.0 + 0.5 + 1.0)
    assert [type(e) for e in scenario.expectations] == [AtTime, When, Within]


def test_a_scenario_needs_no_source(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(VALID.replace('source = "By hand"\n', ""), "utf-8")
    assert load_scenario(file).source == ""


def test_line_ends_and_a_byte_order_mark_of_windows_editors_do_no_harm(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_bytes(b"\xef\xbb\xbf" + VALID.replace("\n", "\r\n").encode())
    assert load_scenario(file).title == "A good one"
    file.write_bytes(b"\xef\xbb\xbf" + VALID.replace("\n", "\r\n").replace("time = 1.0", "time = -1.0").encode())
    with pytest.raises(UserError, match=r":37: time: "):
        load_scenario(file)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (VALID.replace("[start]", "[start"), 9),
        (VALID.replace("stop_time = 4.0", "stop_time = "), 5),
        (VALID.replace("curve =", "curve"), 11),
        (VALID.replace('"PARABOLA"', "PARABOLA"), 11),
        (VALID.replace("active = true", 'curve = "PARABOLA"'), 12),
        (VALID + 'x = """', 43),
        (f"x = {'[' * 5000}", 1),
        (VALID.replace("stop_time = 4.0", f"stop_time = 1{'0' * 4300}"), 5),
        (VALID.replace('"PARABOLA"', f"-9{'_9' * 4300}"), 11),
        (VALID.replace('"PARABOLA"', f"0x{'f' * 3600}"), 11),
        (VALID.replace("duration = 1.5", f"duration = 0b{'1' * 20_000}"), 19),
        (VALID + f"x = [[1, {'7' * 100_000}]]", 43),
    ],
)
def test_what_is_no_toml_is_reported_with_file_and_line(text: str, line: int, tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(UserError) as error:
        load_scenario(file)
    assert str(error.value).startswith(f"{file}:{line}: not TOML: ")
    assert "\n" not in str(error.value)


def test_a_file_that_cannot_be_read_is_reported(tmp_path: Path) -> None:
    missing, folder, latin = tmp_path / "missing.toml", tmp_path / "folder.toml", tmp_path / "latin.toml"
    folder.mkdir()
    latin.write_bytes(VALID.replace("A good one", "90° of phasing").encode("latin-1"))
    for file in (missing, folder, latin):
        with pytest.raises(UserError) as error:
            load_scenario(file)
        assert str(error.value).startswith(f"{file}: cannot be read: ")
    assert "utf-8" in str(error.value)


# --- any text ---

DEEP = st.builds(
    lambda template, depth: template.format(dots=".".join("a" * depth), opened="[" * depth, closed="]" * depth),
    st.sampled_from(
        ["[{dots}]", "{dots} = 1", "[[{dots}]]", "a = {opened}{closed}", "a = {opened}", "[start]\n{dots} = 1"]
    ),
    st.sampled_from([2, 90, 110, 990, 20_000]),
)
PLACES = re.compile(r"(?<== )[^\n]+")
LITERALS = st.sampled_from(
    ["1979-05-27", "07:32:00", "[1, [2]]", "{ a = 1 }", "[{}]", "''", "nan", "[]", "true", "-1", "'1 mm'"]
)


@given(DEEP | st.text(max_size=40), st.integers(0, len(VALID)))
@drawn(anew=True)
def test_a_text_in_a_file_is_read_or_refused(inserted: str, at: int) -> None:
    """Also one that nests tables and lists as deep as the recursion of Python goes, and deeper."""
    line = VALID.rfind("\n", 0, at) + 1
    with suppress(UserError):
        read_scenario_text(f"{VALID[:line]}{inserted}\n{VALID[line:]}", Path("scenario.toml"))


@given(st.data(), LITERALS)
@drawn(anew=True)
def test_a_value_of_another_kind_is_read_or_refused(data: st.DataObject, literal: str) -> None:
    place = data.draw(st.sampled_from(list(PLACES.finditer(VALID))))
    with suppress(UserError):
        read_scenario_text(VALID[: place.start()] + literal + VALID[place.end() :], Path("scenario.toml"))


MANY = {
    "segments": ("[master]\nsegments = [", '{{ duration = "10 us", velocity = 3.0 }},\n', "]"),
    "settings": ("[master]\n", '[[set]]\nat = "{i}e-5 s"\nactive = true\n', ""),
    "expectations": ("[master]\n", "[[expect]]\nat = {i}e-5\n'slave.position' = '1 mm'\n", ""),
    "reactions": ("[master]\n", "[[on]]\nwhen = 'synchronized'\nafter = '1 ms'\nset = {{ active = true }}\n", ""),
}


@pytest.mark.parametrize("kind", MANY)
def test_a_file_of_four_times_the_length_takes_four_times_the_work(kind: str) -> None:
    """The work is how many functions are called. A file of a hundred thousand segments is read in seconds."""
    head = 'title = "long"\nfmu = "Synchronizer"\nstop_time = 4.0\nstep_size = 0.01\n'
    begin, each, end = MANY[kind]

    def work(count: int) -> int:
        text = head + begin + "".join(each.format(i=i + 1) for i in range(count)) + end
        return calls(lambda: read_scenario_text(text, Path("scenario.toml")))

    work(1)
    assert work(400) < 4.5 * work(100)
