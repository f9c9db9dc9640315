"""modelDescription.xml of FMI 2.0, the same for both flavours; `fmi3_xml` makes that of FMI 3.0 from it."""

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from motionsync.var import Role, Unit

from ..about import AUTHORS, COPYRIGHT, HOME, __version__
from .build_time import build_time
from .roles import find_by_role
from .units import base_unit, unit_name
from .variables import Variable, members, summary, variables

STEP_SIZE = 0.001  # s, of the default experiment; for a block with its own cycles it is the length of one cycle
ABILITIES = {  # of both flavours, as attributes of the CoSimulation element
    "canHandleVariableCommunicationStepSize": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
}
OWN_MEMORY = {"canNotUseMemoryManagementFunctions": "true"}  # of an FMU without sources
SOURCES = "sources/"  # where an FMU of either version holds its C
CATEGORIES = {
    "logStatusWarning": "refused commands",
    "logStatusError": "refused values and failed calls",
    "logAll": "all messages",
}


def describe(block: Any, unit: str, slave_unit: str = "", overrides: Mapping[str, str] | None = None) -> Element:
    """The part of the description that all builds of this source share; `complete` adds what belongs to one build.

    `unit`: the unit of positions, a key of `units.BASES`; `slave_unit`: the unit of the slave's positions (empty: the
    same as `unit`); `overrides`: as for `variables`.
    """
    vs = variables(block, overrides)
    name = type(block).__name__
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid="",
        description=summary(type(block)),
        author=AUTHORS,
        version=__version__,
        copyright=COPYRIGHT,
        license="MIT",
        generationTool=f"motionsync {__version__} ({HOME})",
        variableNamingConvention="structured",
    )
    SubElement(root, "CoSimulation", {"modelIdentifier": name} | ABILITIES)
    _units(SubElement(root, "UnitDefinitions"), vs, unit, slave_unit or unit)
    _types(SubElement(root, "TypeDefinitions"), vs, unit, slave_unit or unit)
    categories = SubElement(root, "LogCategories")
    for category, text in CATEGORIES.items():
        SubElement(categories, "Category", name=category, description=text)
    cycle = find_by_role(vs, Role.TASK_CYCLE)
    step = cycle.start if cycle else STEP_SIZE
    SubElement(root, "DefaultExperiment", startTime="0", stopTime="10", stepSize=repr(step))
    model = SubElement(root, "ModelVariables")
    for reference, v in enumerate(vs):
        model.append(_variable(v, reference))
    _structure(SubElement(root, "ModelStructure"), vs)
    return root


def complete(root: Element, guid: str, abilities: Mapping[str, str] | None = None, sources: Sequence[str] = ()) -> None:
    """Add what belongs to one build: the GUID, and a date if the build has one.

    `abilities`: attributes of the CoSimulation element that only one flavour has; `sources`: the C files that the FMU
    can be compiled from."""
    root.set("guid", guid)
    for unit in root.iter("CoSimulation"):
        unit.attrib.update(abilities or {})
        if sources:
            SubElement(unit, "SourceFiles").extend(Element("File", name=file) for file in sources)
    if (built := build_time()) is not None:
        root.set("generationDateAndTime", time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(built)))


def content(root: Element) -> bytes:
    """The content of the file, of either version."""
    indent(root)
    return bytes(tostring(root, "UTF-8", xml_declaration=True)) + b"\n"


def _used_units(vs: list[Variable]) -> list[Unit]:
    return list(dict.fromkeys(v.declaration.unit for v in vs if v.declaration.unit is not Unit.NONE))


def _units(parent: Element, vs: list[Variable], unit: str, slave_unit: str) -> None:
    definitions = {unit_name(u, unit, slave_unit): u for u in reversed(_used_units(vs))}
    for name, u in sorted(definitions.items()):
        powers, factor = base_unit(u, unit, slave_unit)
        exponents = {symbol: str(power) for symbol, power in powers.items()}
        scale = {"factor": repr(factor)} if factor != 1.0 and name != "1" else {}
        SubElement(SubElement(parent, "Unit", name=name), "BaseUnit", exponents | scale)


def _types(parent: Element, vs: list[Variable], unit: str, slave_unit: str) -> None:
    for u in _used_units(vs):
        simple = SubElement(parent, "SimpleType", name=u.quantity)
        SubElement(simple, "Real", quantity=u.quantity, unit=unit_name(u, unit, slave_unit))
    for choice in dict.fromkeys(v.cell.type for v in vs if v.choices):
        simple = SubElement(parent, "SimpleType", name=choice.__name__, description=summary(choice))
        enumeration = SubElement(simple, "Enumeration")
        for member in members(choice):
            SubElement(enumeration, "Item", name=member.name, value=str(member.value), description=member.description)


def _variable(v: Variable, reference: int) -> Element:
    d = v.declaration
    scalar = Element(
        "ScalarVariable",
        valueReference=str(reference),
        name=v.name,
        description=d.description,
        causality=v.causality,
        variability=v.variability,
    )
    value = SubElement(scalar, v.kind)
    if v.choices:
        value.set("declaredType", v.cell.type.__name__)
    elif d.unit is not Unit.NONE:
        value.set("declaredType", d.unit.quantity)
    if v.kind in ("Real", "Integer"):
        for limit, number in (("min", max(d.min, d.above)), ("max", min(d.max, d.below))):
            if math.isfinite(number):
                value.set(limit, v.literal(number))
    if v.settable:
        value.set("start", v.literal(v.start))
    return scalar


def _structure(parent: Element, vs: list[Variable]) -> None:
    """Describe what the outputs depend on.

    At a communication point they depend on nothing, since doStep alone changes them. After the initialization they
    depend on what the block declares."""
    index = {v.name: str(i) for i, v in enumerate(vs, 1)}
    outputs, initial = SubElement(parent, "Outputs"), SubElement(parent, "InitialUnknowns")
    for v in vs:
        if v.causality == "output":
            dependencies = " ".join(sorted((index[name] for name in v.depends), key=int))
            SubElement(outputs, "Unknown", index=index[v.name], dependencies="")
            SubElement(initial, "Unknown", index=index[v.name], dependencies=dependencies)
