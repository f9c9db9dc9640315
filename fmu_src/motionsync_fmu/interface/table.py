"""The reference table of a block's variables, for `motionsync describe` and the page inside the FMU."""

from dataclasses import dataclass
from typing import Any

from motionsync.var import LARGEST_INPUT

from .units import unit_name
from .variables import Variable, summary, variables

EVERY_INPUT = f"{-LARGEST_INPUT:g} to {LARGEST_INPUT:g}"


@dataclass(frozen=True)
class Row:
    """One variable; every column as a text, empty where the column does not apply.

    The allowed range is empty too where it is that of all Real inputs, ±1e12."""

    name: str
    causality: str
    variability: str
    type: str
    unit: str
    start: str
    allowed_range: str
    description: str


@dataclass
class Group:
    """Variables whose names begin with the same part, in the order of declaration.

    `name` is empty for the variables whose names have one part only."""

    name: str
    summary: str
    rows: list[Row]


def groups(block: Any, unit: str, slave_unit: str = "") -> list[Group]:
    """All variables of a block in groups; a group has the summary of the part of the block to which it belongs.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`).
    """
    found: dict[str, Group] = {}
    for v in variables(block):
        name = v.name.partition(".")[0] if "." in v.name else ""
        if name not in found:
            found[name] = Group(name, summary(type(getattr(block, name))) if name else "The block's own", [])
        found[name].rows.append(_row(v, unit, slave_unit))
    return list(found.values())


def _row(v: Variable, unit: str, slave_unit: str) -> Row:
    start = next((member.name for member in v.choices if member == v.start), v.literal(v.start))
    limited = v.kind in ("Real", "Integer") and v.allowed_range != EVERY_INPUT
    return Row(
        v.name,
        v.causality,
        v.variability,
        v.cell.type.__name__ if v.choices else v.kind,
        unit_name(v.declaration.unit, unit, slave_unit),
        start if v.settable else "",
        v.allowed_range if v.settable and limited else "",
        v.declaration.description,
    )
