"""The reference table of a block's variables, for `motionsync describe` and the page inside the FMU."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from motionsync.var import LARGEST_INPUT

from .units import unit_name
from .variables import Variable, summary, variables


@dataclass(frozen=True)
class Row:
    """One variable; every column as a text, empty where the column does not apply.

    The usual range is left out: ±1e12 of a Real, that of its type of an Integer."""

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
    """Variables whose names start with the same part, in the order of declaration.

    `name` is empty for the variables whose names have one part only."""

    name: str
    summary: str
    rows: list[Row]


def groups(block: Any, unit: str, slave_unit: str = "", overrides: Mapping[str, str] | None = None) -> list[Group]:
    """All variables of a block in groups; a group has the summary of the part of the block to which it belongs.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`);
    `overrides`: as for `variables`.
    """
    by_name: dict[str, Group] = {}
    for v in variables(block, overrides):
        name = v.name.partition(".")[0] if "." in v.name else ""
        if name not in by_name:
            by_name[name] = Group(name, summary(type(getattr(block, name))) if name else "The block's own", [])
        by_name[name].rows.append(_row(v, unit, slave_unit))
    return list(by_name.values())


def _row(v: Variable, unit: str, slave_unit: str) -> Row:
    return Row(
        v.name,
        v.causality,
        v.variability,
        v.cell.type.__name__ if v.choices else v.kind,
        unit_name(v.declaration.unit, unit, slave_unit),
        _start(v) if v.settable else "",
        v.allowed_range if v.settable and v.kind in ("Real", "Integer") and not _is_usual(v) else "",
        v.declaration.description,
    )


def _start(v: Variable) -> str:
    return v.text(v.start) if v.choices else v.literal(v.start)


def _is_usual(v: Variable) -> bool:
    """Whether the range is that of most variables: ±1e12 of a Real, every Integer."""
    limit = LARGEST_INPUT if v.kind == "Real" else inf
    return (v.declaration.min, v.declaration.max) == (-limit, limit) and not v.restricted
