"""An interface whose variables are turned: what may be turned, what is refused and why, and its modelDescription."""

import tempfile
from collections import Counter
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from hypothesis import given, settings
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync_fmu.build import Flavour, fmu_path
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.fmi2_xml import complete, content, describe
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.turns import Interface, TurnError

SIGNALS = {f"{axis}.{name}" for axis in ("master", "remote") for name in ("position", "velocity", "acceleration")}
SIGNALS |= {"remote.cycle_index"}
COMMANDS = {  # what an edge starts, by hand
    "Synchronizer": {"start", "stop"},
    "Gearing": {"start", "reset", "set_master.execute", "set_slave.execute"},
    "Follower": {"position_to_park", "position_to_cycle", "end_synchronism", "reset"},
    "RemoteSync": set(),
    "FlyingSaw": {
        *("gear_in_velo.execute", "gear_in_pos.execute", "gear_out.execute", "halt.execute", "stop.execute"),
        *("move_velocity.execute", "move_absolute.execute", "reset.execute"),
    },
    "CutToLength": {
        *("start", "stop", "abort", "reset", "cut_now", "take_sample", "order.add", "mark.detected", "tool.done"),
    },
}


def turnable(block: str) -> dict[str, str]:
    """The variables that may be turned, each with its other causality."""
    found = {}
    for name, v in Recipe(block).variables.items():
        d = v.declaration
        free = name not in SIGNALS | COMMANDS[block] | {"slave.position"}
        other = {"input": "parameter", "parameter": "input", "output": "local", "local": "output"}[d.causality]
        if free and (d.causality != "parameter" or d.tunable):
            found[name] = other
    return found


def described(recipe: Recipe, folder: str) -> Any:
    """The modelDescription as FMPy reads it, without any fault."""
    root = describe(recipe.block(), recipe.unit, recipe.slave_unit, recipe.turned)
    complete(root, "{0}")
    Path(folder, "modelDescription.xml").write_bytes(content(root))
    assert validate_fmu(folder) == []
    return read_model_description(folder)


@st.composite
def turns(draw: st.DrawFn) -> tuple[str, dict[str, str]]:
    block = draw(st.sampled_from(sorted(BLOCKS)))
    choices = turnable(block)
    names = draw(st.sets(st.sampled_from(sorted(choices))))
    return block, {name: choices[name] for name in sorted(names)}


@settings(deadline=None, max_examples=25)
@given(turns())
def test_any_legal_turns_give_a_valid_description_with_the_counts_that_follow(
    drawn: tuple[str, dict[str, str]],
) -> None:
    block, chosen = drawn
    by_key: dict[str, list[str]] = {}
    for name, causality in chosen.items():
        by_key.setdefault(causality, []).append(name)
    recipe = Recipe(block, interface=Interface(**by_key))
    with tempfile.TemporaryDirectory() as folder:
        found = described(recipe, folder)
    declared = Recipe(block).variables
    wanted = Counter(v.causality for v in declared.values())
    for name, causality in chosen.items():
        wanted[declared[name].causality] -= 1
        wanted[causality] += 1
    assert Counter(v.causality for v in found.modelVariables) == +wanted
    outputs = [v.name for v in found.modelVariables if v.causality == "output"]
    assert [unknown.variable.name for unknown in found.outputs] == outputs
    assert [unknown.variable.name for unknown in found.initialUnknowns] == outputs
    assert [v.name for v in found.modelVariables] == list(declared)
    for v in found.modelVariables:
        assert (v.start is not None) == (v.causality in ("input", "parameter"))
        if v.name in chosen and v.causality in ("input", "parameter"):
            assert v.variability == {"input": "discrete", "parameter": "tunable"}[v.causality]
    assert dict(recipe.turned) == chosen


@pytest.mark.parametrize(
    ("block", "turned", "message"),
    [
        (
            "Gearing",
            {"input": "gear_inn.t*"},
            "input: no variable of Gearing is named 'gear_inn.t*'; there is gear_in.",
        ),
        (
            "Gearing",
            {"input": "GEAR_IN.Time"},
            "no variable of Gearing is named 'GEAR_IN.Time'; did you mean gear_in.time?",
        ),
        ("Gearing", {"local": "statecode"}, "local: no variable of Gearing is named 'statecode'; there is state_code"),
        (
            "Gearing",
            {"parameter": "start"},
            "start cannot become a parameter: it is a command, whose edge acts during a run",
        ),
        ("Gearing", {"parameter": "set_*"}, "set_master.execute cannot become a parameter: it is a command"),
        ("Gearing", {"parameter": "master.*"}, "master.position cannot become a parameter: it tells where the axis is"),
        (
            "RemoteSync",
            {"parameter": "remote.c*"},
            "remote.cycle_index cannot become a parameter: it tells where the axis",
        ),
        ("Gearing", {"input": "slave.period"}, "slave.period cannot become an input: it is fixed"),
        ("Gearing", {"input": "master.input_mode"}, "master.input_mode cannot become an input: it is fixed"),
        ("Gearing", {"input": "state"}, "state cannot become an input: it is an output, and only a parameter can"),
        ("Gearing", {"parameter": "local.*"}, "it is a local variable, and only an input can"),
        (
            "Gearing",
            {"output": "gearing.*"},
            "gearing.numerator cannot become an output: it is a parameter, and only a local",
        ),
        (
            "Gearing",
            {"output": "activate"},
            "activate cannot become an output: it is an input, and only a local variable can",
        ),
        (
            "Gearing",
            {"local": "activate"},
            "activate cannot become a local variable: it is an input, and only an output can",
        ),
        ("Gearing", {"local": "slave.p*"}, "slave.position cannot become a local variable: it is the setpoint"),
        (
            "Gearing",
            {"input": "gear_in.time", "parameter": "gear_in.*"},
            "parameter: gear_in.time is already turned to an input",
        ),
    ],
)
def test_a_refused_turn_says_why(block: str, turned: dict[str, str], message: str) -> None:
    with pytest.raises(TurnError) as e:
        Recipe(block, interface=Interface(**turned)).block()
    assert message in str(e.value)
    assert str(e.value).startswith(f"{e.value.causality}: {e.value.reason}")
    assert "\n" not in str(e.value)
    assert isinstance(e.value, UserError)


def test_every_command_is_refused_as_a_parameter(block: str) -> None:
    assert {name for name, v in Recipe(block).variables.items() if v.declaration.command} == COMMANDS[block]
    for name in COMMANDS[block]:
        with pytest.raises(TurnError, match="it is a command"):
            Recipe(block, interface=Interface(parameter=name)).block()


def test_what_has_the_causality_already_stays(tmp_path: Path) -> None:
    plain = Recipe("Gearing")
    same = Recipe(
        "Gearing", interface=Interface(input=["start", "master.position"], local="local.*", output="slave.p*[n]")
    )
    assert dict(same.turned) == {}
    assert same.guid() == plain.guid()
    assert fmu_path(same, tmp_path, Flavour.NATIVE) == fmu_path(plain, tmp_path, Flavour.NATIVE)


def test_the_fmu_has_a_name_by_what_is_turned_however_it_is_said(tmp_path: Path) -> None:
    said = (
        Interface(input="gearing.*", local="slave.jerk"),
        Interface(input=("gearing.denominator", "gearing.numerator", "gearing.n*"), local=["slave.jerk"]),
    )
    paths = {fmu_path(Recipe("Gearing", interface=interface), tmp_path, Flavour.PYTHON) for interface in said}
    other = fmu_path(Recipe("Gearing", interface=Interface(input="gearing.*")), tmp_path, Flavour.PYTHON)
    (path,) = paths
    assert path.parent == tmp_path / "python"
    assert path.name.startswith("Gearing-")
    assert len(path.name) == len("Gearing-12345678.fmu")
    assert path != other != tmp_path / "python" / "Gearing.fmu"
    assert len({Recipe("Gearing", interface=interface).guid() for interface in said}) == 1


def test_a_real_that_becomes_an_input_lies_within_its_own_range_and_that_of_inputs() -> None:
    """`max_speed` of the Follower is >= 0 and at most 1e12; `gear_in.time` has no least value of its own."""
    speed = Recipe("Follower", interface=Interface(input="max_speed")).variables["max_speed"]
    time = Recipe("Gearing", interface=Interface(input="gear_in.time")).variables["gear_in.time"]
    assert [speed.allows(x) for x in (0.0, 1e12, -1.0, 2e12, nan, inf)] == [True, True, False, False, False, False]
    assert [time.allows(x) for x in (-1e12, 1e12, -2e12, 2e12)] == [True, True, False, False]
    assert speed.judged
    assert time.judged


def test_a_real_that_the_block_declares_as_an_input_is_judged_as_a_parameter_too() -> None:
    v = Recipe("Gearing", interface=Interface(parameter="gear_in.offset")).variables["gear_in.offset"]
    assert (v.causality, v.variability, v.judged) == ("parameter", "tunable", True)
    assert not Recipe("Gearing").variables["gear_in.time"].judged


def test_start_values_can_be_baked_into_turned_variables() -> None:
    recipe = Recipe("Gearing", starts={"activate": "false", "gearing.numerator": "-3"})
    turned = Recipe(recipe.name, starts=recipe.starts, interface=Interface(input="gearing.*", parameter="activate"))
    for name, value in (("activate", False), ("gearing.numerator", -3)):
        assert turned.variables[name].start == recipe.variables[name].start == value
