"""What a page knows of a block and of the values of its variables, as JSON has it, for machine_data.js."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from ...interface.recipe import Recipe
from ...interface.roles import piece_variables
from ...interface.units import unit_name
from ...interface.variables import Variable
from ...scenario.scenario import Scenario
from ..style import typeset
from .description import pictures_of

MOST = 1e9  # a declared limit beyond it limits nothing that anybody would choose


def block_json(recipe: Recipe, scenarios: Iterable[Scenario]) -> dict[str, Any]:
    """All but the variables: by which roles they are known, and how units are called in these scenarios."""
    declared = recipe.variables.values()
    names = piece_variables(declared)
    return {
        "roles": {v.declaration.role.name: v.name for v in declared if v.declaration.role},
        "piece_variables": asdict(names) if names else None,
        "pictures": pictures_of(recipe),
        "units": {units_of(s): _unit_names(s, declared) for s in scenarios},
    }


def variable_json(v: Variable) -> dict[str, Any]:
    """A variable: its declaration, and how it may be set."""
    d = v.declaration
    row: dict[str, Any] = {name: getattr(v, name) for name in ("name", "kind", "causality", "variability")}
    row |= {
        "unit": d.unit.name,
        "description": d.description,
        "choices": [[int(m), m.name, m.description] for m in v.choices],
    }
    if v.settable:
        low, high = max(d.min, d.above), min(d.max, d.below)
        row |= {"start": plain(v.start), "range": v.allowed_range if v.kind != "Boolean" else ""}
        row |= {"command": True} if d.command else {}
        row |= {"min": low} if abs(low) < MOST else {}
        row |= {"max": high} if abs(high) < MOST else {}
    return row


def units_of(s: Scenario) -> str:
    """Under what a page has the names of units of this scenario."""
    return f"{s.unit} {s.slave_unit}".strip()


def _unit_names(s: Scenario, declared: Iterable[Variable]) -> dict[str, str]:
    kinds = {v.declaration.unit for v in declared}
    return {kind.name: typeset(unit_name(kind, s.unit, s.slave_unit)) for kind in sorted(kinds, key=lambda k: k.name)}


def plain_values(values: Mapping[str, Any]) -> dict[str, float | int]:
    """Values of variables, see `plain`."""
    return {name: plain(value) for name, value in values.items()}


def plain(value: Any) -> float | int:
    """A number, of a Boolean or a member of an enumeration, too."""
    return int(value) if isinstance(value, int) else float(value)
