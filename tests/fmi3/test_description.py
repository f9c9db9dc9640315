"""The descriptions in an FMU of FMI 3.0, and the terminals: by the standard's schemas, and beside those of FMI 2.0."""

from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy import read_model_description
from lxml import etree

from motionsync.blocks import BLOCKS
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.fmi2_xml import complete, content, describe
from motionsync_fmu.interface.fmi3_xml import translated
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.interface.terminals import terminals
from motionsync_fmu.native.tables import abilities
from tests.support.hosts.validation import faults_by_fmpy

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}
OVERRIDDEN = Recipe("Gearing", "deg", interface=Interface(input=("gearing.*",), local=("in_gear",)))
RECIPES = [*map(Recipe, BLOCKS), OVERRIDDEN, Recipe("Follower", "mm", {"sync_master": "7.5"}, "deg")]


def both(recipe: Recipe, folder: Path) -> tuple[Any, Any]:
    """The descriptions of FMI 2.0 and FMI 3.0 as FMPy reads them."""
    result = []
    for version in ("fmi2", "fmi3"):
        block = recipe.block()
        root = describe(block, recipe.unit, recipe.slave_unit, recipe.causality_overrides)
        complete(root, compute_guid(recipe), abilities(block))
        (folder / version).mkdir()
        (folder / version / "modelDescription.xml").write_bytes(
            content(translated(root) if version == "fmi3" else root)
        )
        result.append(read_model_description(str(folder / version)))
    return result[0], result[1]


def faults(text: bytes, schema: str) -> list[str]:
    """What is wrong with a text by one of the standard's schemas."""
    checker = etree.XMLSchema(etree.parse(str(SCHEMAS / schema)))
    checker.validate(etree.fromstring(text))
    return [str(fault) for fault in checker.error_log]


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: f"{recipe.name}-{recipe.unit}")
def test_the_description_says_what_that_of_fmi_2_says(recipe: Recipe, tmp_path: Path) -> None:
    two, three = both(recipe, tmp_path)
    text = (tmp_path / "fmi3" / "modelDescription.xml").read_bytes()
    assert faults(text, "fmi3ModelDescription.xsd") == []
    if recipe.starts or recipe.causality_overrides:  # the others are validated as FMUs
        assert faults_by_fmpy(tmp_path / "fmi3") == []
    assert (two.fmiVersion, three.fmiVersion) == ("2.0", "3.0")
    for name in ("modelName", "guid", "description", "author", "version", "copyright", "license", "generationTool"):
        assert getattr(two, name) == getattr(three, name), name
    *own, time = three.modelVariables
    assert [(v.name, v.causality, v.variability, v.type, v.unit) for v in [time]] == [
        ("time", "independent", "continuous", "Float64", "s")
    ]
    assert time.valueReference == len(two.modelVariables) == len(own)
    for old, new in zip(two.modelVariables, own, strict=True):
        assert new.type == TYPES[old.type]
        assert facts(old) == facts(new)
    for name in ("outputs", "initialUnknowns"):
        assert list(map(dependencies, getattr(two, name))) == list(map(dependencies, getattr(three, name))), name
    assert [(t.name, t.unit, t.quantity) for t in two.typeDefinitions] == [
        (t.name, t.unit, t.quantity) for t in three.typeDefinitions
    ]
    assert {u.name: str(u.baseUnit) for u in two.unitDefinitions}.items() <= {
        u.name: str(u.baseUnit) for u in three.unitDefinitions
    }.items()


def facts(v: Any) -> dict[str, Any]:
    names = ("name", "valueReference", "description", "causality", "variability", "initial", "start", "min", "max")
    return {name: getattr(v, name) for name in names} | {"declared": v.declaredType and v.declaredType.name}


def dependencies(unknown: Any) -> tuple[str, list[str]]:
    return unknown.variable.name, [v.name for v in unknown.dependencies]


def test_the_unit_declares_its_capabilities(tmp_path: Path) -> None:
    two, three = both(Recipe("Synchronizer"), tmp_path)
    can = three.coSimulation
    assert can.modelIdentifier == "Synchronizer"
    assert can.canHandleVariableCommunicationStepSize
    assert can.canGetAndSetFMUstate
    assert can.canSerializeFMUstate
    assert not can.hasEventMode
    assert not can.providesIntermediateUpdate
    assert not can.canReturnEarlyAfterIntermediateUpdate
    assert can.maxOutputDerivativeOrder == 2
    assert two.coSimulation.canInterpolateInputs  # which FMI 3.0 has no word for


# --- terminals ---


def listed(block: str) -> dict[str, Any]:
    """The terminals of a block by name."""
    root = etree.fromstring(terminals(BLOCKS[block]()))
    return {terminal.get("name"): terminal for terminal in root.iterfind("Terminals/Terminal")}


def members(terminal: Any) -> dict[str, str]:
    """The variables of a terminal by the names of its members."""
    return {member.get("memberName"): member.get("variableName") for member in terminal}


def test_terminals_follow_the_schema_and_name_what_can_be_wired(block: str) -> None:
    for fmi in Fmi:
        text = terminals(BLOCKS[block](), fmi=fmi)
        assert faults(text, "fmi3TerminalsAndIcons.xsd") == []
        assert (b"<Icon " in text) == (fmi == Fmi.THREE)  # of FMI 2.0 it is model.png
    causalities = {v.name: v.causality for v in Recipe(block).variables.values()}
    result = [name for terminal in listed(block).values() for name in members(terminal).values()]
    wired = [name for name, causality in causalities.items() if causality in ("input", "output") and "." in name]
    assert sorted(result) == sorted(wired)
    assert all(terminal.get("description") for terminal in listed(block).values())


@pytest.mark.all_blocks
def test_a_turned_variable_is_a_member_only_where_it_can_be_wired() -> None:
    root = etree.fromstring(terminals(OVERRIDDEN.block(), OVERRIDDEN.causality_overrides))
    gearing = root.find("Terminals/Terminal[@name='gearing']")
    assert "gearing" not in listed("Gearing")
    overridden = {name for name in OVERRIDDEN.causality_overrides if name.startswith("gearing.")}
    assert set(members(gearing).values()) == overridden


@pytest.mark.all_blocks
def test_a_remote_axis_fits_where_a_master_does() -> None:
    """The members that both have are the wires of `motionsync line`, for each block that has a master."""
    slave = listed("RemoteSync")["slave"]
    for block in set(BLOCKS) - {"RemoteSync"}:
        master = listed(block)["master"]
        assert slave.get("matchingRule") == master.get("matchingRule") == "bus"
        assert slave.get("terminalKind") == master.get("terminalKind") == "_motionsync_Axis"
        common = members(slave).keys() & members(master).keys()
        assert {members(slave)[name]: members(master)[name] for name in common} == {
            "slave.position": "master.position",
            "slave.velocity": "master.velocity",
            "slave.acceleration": "master.acceleration",
        }
    kinds = {name for name, terminal in listed("CutToLength").items() if terminal.get("terminalKind")}
    assert kinds == {"master", "slave"}
