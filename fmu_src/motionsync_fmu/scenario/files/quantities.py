"""Numbers with a unit in a scenario file: `velocity = "40 m/min"`."""

from collections.abc import Iterator, Mapping
from typing import Any

from motionsync.var import Unit

from ...errors import UserError
from ...interface.quantities import convert, is_quantity
from ...interface.units import unit_name
from ...interface.variables import Variable
from .toml_tables import TomlTable

KeyPath = tuple[str | int, ...]
"""Keys and indices that lead from the top of a scenario file to a value."""

SCRIPT = {
    "position": Unit.POSITION,
    "velocity": Unit.VELOCITY,
    "acceleration": Unit.ACCELERATION,
    "jerk": Unit.JERK,
    "duration": Unit.TIME,
}


def resolve_quantities(top: TomlTable, variables: Mapping[str, Variable], unit: str, slave_unit: str) -> TomlTable:
    """The top level of a scenario file, with the number in the scenario's units for each number with a unit.

    `variables`: those of the block; `unit`, `slave_unit`: the scenario's.

    Raises:
        UserError: a unit is unknown, or measures something else; the message has file, line and key.
    """
    for path, values in _texts(top.values):
        key = str(path[-1])
        if is_quantity(values[key]) and (kind := measured_kind(path, variables)):
            try:
                values[key] = convert(values[key], unit_name(kind, unit, slave_unit))
            except UserError as e:
                _table_at(top, path[:-1]).fail(key, str(e))
    return top


def measured_kind(path: KeyPath, variables: Mapping[str, Variable]) -> Unit | None:
    """What the value at a path measures; None: it is no number that may have a unit."""
    match path:
        case ("stop_time" | "step_size",) | ("set" | "expect", int(), "at") | ("on", int(), "after"):
            return Unit.TIME
        case ("expect", int(), "time" | "from" | "to"):
            return Unit.TIME
        case ("master" | "remote", str(key)) | ("master" | "remote", "segments", int(), str(key)):
            return SCRIPT.get(key)
        case ("cuts", "length" | "offset" | "tolerance"):
            return Unit.POSITION
        case ("start", str(name)) | ("set" | "expect", int(), str(name)) | ("on", int(), "set" | "add", str(name)):
            v = variables.get(name)
            return v.declaration.unit if v and v.kind == "Real" else None
    return None


def _texts(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """The paths of all texts in a file that are values of keys, each with the table that has the key."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        if isinstance(inner, str) and isinstance(value, dict):
            yield (*path, key), value
        elif isinstance(inner, dict | list):
            yield from _texts(inner, (*path, key))


def _table_at(top: TomlTable, path: KeyPath) -> TomlTable:
    """The table at a path."""
    table, name = top, ""
    for part in path:
        if isinstance(part, int):
            table = table.tables(name)[part]
        elif isinstance(table.values[part], dict):
            table = table.table(part)
        else:
            name = part
    return table
