"""modelDescription.xml, the same for both flavours."""

import math
import time
from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from motionsync.var import Unit

from .. import __version__
from ..archive import epoch
from .variables import Variable, members, variables

BASES = {  # a build's position unit in SI base units: exponents' unit and factor
    "mm": ("m", 1e-3),
    "m": ("m", 1.0),
    "deg": ("rad", math.pi / 180.0),
    "rad": ("rad", 1.0),
    "1": ("", 1.0),
}
DEGREE = "deg"
CATEGORIES = {
    "logStatusWarning": "refused commands",
    "logStatusError": "refused values and failed calls",
    "logAll": "all messages",
}


def describe(block: Any, unit: str, slave_unit: str = "") -> Element:
    """Everything that both flavours and every build of this source share; `finish` adds GUID and date.

    `unit`: of positions, a key of BASES; `slave_unit`: of the slave's where a block tells them apart, empty: the same.
    """
    vs = variables(block)
    name = type(block).__name__
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid="",
        description=summary(type(block)),
        version=__version__,
        license="MIT",
        generationTool=f"motionsync {__version__}",
        variableNamingConvention="structured",
    )
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        needsExecutionTool="false",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
    )
    _units(SubElement(root, "UnitDefinitions"), vs, unit, slave_unit or unit)
    _types(SubElement(root, "TypeDefinitions"), vs, unit, slave_unit or unit)
    categories = SubElement(root, "LogCategories")
    for category, text in CATEGORIES.items():
        SubElement(categories, "Category", name=category, description=text)
    step = repr(getattr(block, "task_cycle_time", 0.001))  # a block with cycles of its own: one of them
    SubElement(root, "DefaultExperiment", startTime="0", stopTime="10", stepSize=step)
    model = SubElement(root, "ModelVariables")
    for reference, v in enumerate(vs):
        model.append(_variable(v, reference))
    _structure(SubElement(root, "ModelStructure"), vs)
    return root


def finish(root: Element, guid: str, abilities: Mapping[str, str] | None = None) -> bytes:
    """The file; `abilities`: attributes of the CoSimulation element that only one flavour has."""
    root.set("guid", guid)
    for unit in root.iter("CoSimulation"):
        unit.attrib.update(abilities or {})
    root.set("generationDateAndTime", time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(epoch())))
    indent(root)
    return bytes(tostring(root, "UTF-8", xml_declaration=True)) + b"\n"


def summary(thing: Any) -> str:
    """The first line of a docstring, without its full stop."""
    return (thing.__doc__ or "").strip().split("\n")[0].rstrip(".")


def unit_name(kind: Unit, unit: str, slave_unit: str = "") -> str:
    """The name of a unit where positions are in `unit`, and the slave's in `slave_unit` if it is given: mm/s2, 1/deg2,
    deg/mm; of a pure number, the empty string."""
    powers: dict[str, int] = {}
    factors = ((unit, kind.position), (slave_unit or unit, kind.slave), (DEGREE, kind.degree), ("s", kind.second))
    for symbol, exponent in factors:
        powers[symbol] = powers.get(symbol, 0) + exponent
    powers.pop("1", None)
    above = "".join(_power(symbol, exponent) for symbol, exponent in powers.items())
    below = "".join(f"/{p}" for symbol, exponent in powers.items() if (p := _power(symbol, -exponent)))
    return (above or "1") + below if above or below or kind is not Unit.NONE else ""


def axis_label(kind: Unit, unit: str, slave_unit: str = "") -> str:
    """The units of a plot's axis that shows master and slave: `mm`, or `mm, slave deg` where they differ."""
    of_master, of_slave = unit_name(kind, unit), unit_name(kind, slave_unit or unit)
    return of_master if of_master == of_slave else f"{of_master}, slave {of_slave}"


def _power(symbol: str, exponent: int) -> str:
    return "" if not symbol or exponent <= 0 else symbol + (str(exponent) if exponent > 1 else "")


def _used_units(vs: list[Variable]) -> list[Unit]:
    return list(dict.fromkeys(v.declaration.unit for v in vs if v.declaration.unit is not Unit.NONE))


def _units(parent: Element, vs: list[Variable], unit: str, slave_unit: str) -> None:
    definitions = {unit_name(u, unit, slave_unit): u for u in reversed(_used_units(vs))}
    for name, u in sorted(definitions.items()):
        powers: dict[str, int] = {}
        factor = 1.0
        for symbol, exponent in ((unit, u.position), (slave_unit, u.slave), (DEGREE, u.degree)):
            base, size = BASES[symbol]
            powers[base] = powers.get(base, 0) + exponent
            factor *= _scaled(size, exponent)
        powers["s"] = u.second
        exponents = {symbol: str(power) for symbol, power in powers.items() if symbol and power}
        scale = {"factor": repr(factor)} if factor != 1.0 and name != "1" else {}
        SubElement(SubElement(parent, "Unit", name=name), "BaseUnit", exponents | scale)


def _scaled(factor: float, exponent: int) -> float:
    return factor**exponent if exponent >= 0 else 1.0 / factor**-exponent


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
        name=v.name,
        valueReference=str(reference),
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
                value.set(limit, literal(v, number))
    if v.settable:
        value.set("start", literal(v, v.start))
    return scalar


def literal(v: Variable, value: Any) -> str:
    """A value as modelDescription.xml and command lines write it."""
    if v.kind == "Boolean":
        return str(bool(value)).lower()
    return repr(float(value)) if v.kind == "Real" else str(int(value))


def _structure(parent: Element, vs: list[Variable]) -> None:
    """At a communication point no output follows an input (only doStep moves it); after initialization, as declared."""
    index = {v.name: str(i) for i, v in enumerate(vs, 1)}
    outputs, initial = SubElement(parent, "Outputs"), SubElement(parent, "InitialUnknowns")
    for v in vs:
        if v.causality == "output":
            known = " ".join(sorted((index[name] for name in v.depends), key=int))
            SubElement(outputs, "Unknown", index=index[v.name], dependencies="")
            SubElement(initial, "Unknown", index=index[v.name], dependencies=known)
