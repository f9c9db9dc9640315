"""Causality overrides: which are allowed, which are refused and why, and the modelDescription with them."""

import tempfile
from collections import Counter
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import Flavour, fmu_path
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.causality import CausalityError, Interface
from motionsync_fmu.interface.fmi2_xml import complete, content, describe
from motionsync_fmu.interface.recipe import Recipe
from tests.support.blocks.by_block import load_test_module
from tests.support.blocks.drawn import drawn
from tests.support.hosts.validation import faults_by_fmpy

SIGNALS = {f"{axis}.{name}" for axis in ("master", "remote") for name in ("position", "velocity", "acceleration")}
SIGNALS |= {"remote.cycle_index"}


def commands(block: str) -> set[str]:
    """The inputs whose edge starts something, by hand."""
    return set(load_test_module(block, "interface_facts").COMMANDS)


def allowed_overrides(block: str) -> dict[str, str]:
    """The variables whose causality may be overridden, each with its other causality."""
    result = {}
    for name, v in Recipe(block).variables.items():
        d = v.declaration
        free = name not in SIGNALS | commands(block) | {"slave.position"}
        other = {"input": "parameter", "parameter": "input", "output": "local", "local": "output"}[d.causality]
        if free and (d.causality != "parameter" or d.tunable):
            result[name] = other
    return result


def read_description(recipe: Recipe, folder: str) -> Any:
    """The modelDescription as FMPy reads it, after its validation."""
    root = describe(recipe.block(), recipe.unit, recipe.slave_unit, recipe.causality_overrides)
    complete(root, "{0}")
    Path(folder, "modelDescription.xml").write_bytes(content(root))
    assert faults_by_fmpy(folder) == []
    return read_model_description(folder)


@st.composite
def overrides(draw: st.DrawFn) -> tuple[str, dict[str, str]]:
    block = draw(st.sampled_from(sorted(BLOCKS)))
    choices = allowed_overrides(block)
    names = draw(st.sets(st.sampled_from(sorted(choices))))
    return block, {name: choices[name] for name in sorted(names)}


@drawn(25, anew=True)
@given(overrides())
def test_any_allowed_overrides_give_a_valid_description_with_the_counts_that_follow(
    overrides_of_block: tuple[str, dict[str, str]],
) -> None:
    block, overrides = overrides_of_block
    by_key: dict[str, list[str]] = {}
    for name, causality in overrides.items():
        by_key.setdefault(causality, []).append(name)
    recipe = Recipe(block, interface=Interface(**by_key))
    with tempfile.TemporaryDirectory() as folder:
        result = read_description(recipe, folder)
    declared = Recipe(block).variables
    requested = Counter(v.causality for v in declared.values())
    for name, causality in overrides.items():
        requested[declared[name].causality] -= 1
        requested[causality] += 1
    assert Counter(v.causality for v in result.modelVariables) == +requested
    outputs = [v.name for v in result.modelVariables if v.causality == "output"]
    assert [unknown.variable.name for unknown in result.outputs] == outputs
    assert [unknown.variable.name for unknown in result.initialUnknowns] == outputs
    assert [v.name for v in result.modelVariables] == list(declared)
    for v in result.modelVariables:
        assert (v.start is not None) == (v.causality in ("input", "parameter"))
        if v.name in overrides and v.causality in ("input", "parameter"):
            assert v.variability == {"input": "discrete", "parameter": "tunable"}[v.causality]
    assert dict(recipe.causality_overrides) == overrides


@pytest.mark.parametrize(
    ("block", "interface", "message"),
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
        (
            "Gearing",
            {"parameter": "master.*"},
            "master.position cannot become a parameter: it is a signal of the axis that leads",
        ),
        (
            "RemoteSync",
            {"parameter": "remote.c*"},
            "remote.cycle_index cannot become a parameter: it is a signal of the axis that leads",
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
            "parameter: gear_in.time already becomes an input",
        ),
    ],
)
def test_a_refused_override_gives_the_reason(block: str, interface: dict[str, str], message: str) -> None:
    with pytest.raises(CausalityError) as e:
        Recipe(block, interface=Interface(**interface)).block()
    assert message in str(e.value)
    assert str(e.value).startswith(f"{e.value.causality}: {e.value.reason}")
    assert "\n" not in str(e.value)
    assert isinstance(e.value, UserError)


def test_every_command_is_refused_as_a_parameter(block: str) -> None:
    assert {name for name, v in Recipe(block).variables.items() if v.declaration.command} == commands(block)
    for name in commands(block):
        with pytest.raises(CausalityError, match="it is a command"):
            Recipe(block, interface=Interface(parameter=name)).block()


def test_what_has_the_causality_already_stays(tmp_path: Path) -> None:
    plain = Recipe("Gearing")
    same = Recipe(
        "Gearing", interface=Interface(input=["start", "master.position"], local="local.*", output="slave.p*[n]")
    )
    assert dict(same.causality_overrides) == {}
    assert compute_guid(same) == compute_guid(plain)
    assert fmu_path(same, tmp_path, Flavour.NATIVE) == fmu_path(plain, tmp_path, Flavour.NATIVE)


def test_the_name_of_the_fmu_depends_on_the_overrides_and_not_on_how_they_are_written(tmp_path: Path) -> None:
    interfaces = (
        Interface(input="gearing.*", local="slave.jerk"),
        Interface(input=("gearing.denominator", "gearing.numerator", "gearing.n*"), local=["slave.jerk"]),
    )
    paths = {fmu_path(Recipe("Gearing", interface=interface), tmp_path, Flavour.PYTHON) for interface in interfaces}
    other = fmu_path(Recipe("Gearing", interface=Interface(input="gearing.*")), tmp_path, Flavour.PYTHON)
    (path,) = paths
    assert path.parent == tmp_path / "python"
    assert path.name.startswith("Gearing-")
    assert len(path.name) == len("Gearing-12345678.fmu")
    assert path != other != tmp_path / "python" / "Gearing.fmu"
    assert len({compute_guid(Recipe("Gearing", interface=interface)) for interface in interfaces}) == 1


def test_a_real_that_becomes_an_input_is_checked_for_its_own_range_and_that_of_inputs() -> None:
    """`max_speed` of the Follower is >= 0 and at most 1e12; `gear_in.time` has no least value of its own."""
    speed = Recipe("Follower", interface=Interface(input="max_speed")).variables["max_speed"]
    time = Recipe("Gearing", interface=Interface(input="gear_in.time")).variables["gear_in.time"]
    assert [speed.allows(x) for x in (0.0, 1e12, -1.0, 2e12, nan, inf)] == [True, True, False, False, False, False]
    assert [time.allows(x) for x in (-1e12, 1e12, -2e12, 2e12)] == [True, True, False, False]
    assert speed.checked
    assert time.checked


def test_a_real_that_the_block_declares_as_an_input_is_checked_as_a_parameter_too() -> None:
    v = Recipe("Gearing", interface=Interface(parameter="gear_in.offset")).variables["gear_in.offset"]
    assert (v.causality, v.variability, v.checked) == ("parameter", "tunable", True)
    assert not Recipe("Gearing").variables["gear_in.time"].checked


def test_start_values_can_be_set_for_overridden_variables() -> None:
    recipe = Recipe("Gearing", starts={"activate": "false", "gearing.numerator": "-3"})
    overridden = Recipe(recipe.name, starts=recipe.starts, interface=Interface(input="gearing.*", parameter="activate"))
    for name, value in (("activate", False), ("gearing.numerator", -3)):
        assert overridden.variables[name].start == recipe.variables[name].start == value
