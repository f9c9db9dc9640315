"""Reads a machine's data: from a TOML file, from a scenario, and from the options of the command line."""

import math
from pathlib import Path
from typing import Any

from motionsync.var import LARGEST_INPUT

from ..errors import UserError, choose, resolve_name
from ..interface.recipe import Recipe, parse
from ..interface.units import BASES
from ..scenario.files.axis_tables import read_load
from ..scenario.files.reader import load_scenario
from ..scenario.files.shipped import find_scenario, scenario_name
from ..scenario.files.toml_tables import TomlTable, read_text, read_toml
from ..scenario.files.variable_tables import StartTable, Subject
from ..scenario.load import Load
from .line_plan import round_values
from .machine_data import BLOCK, MachineData

KEYS = ("title", "unit", "start", "load", "lengths", "velocities")
LOAD = "load."  # the names of a load's values begin so
MASTER_SOURCE = "the line velocities of the plan"  # where the master's inputs come from
RANGE = ".."


def read_machine(
    path: Path | None, settings: dict[str, str], unit: str
) -> tuple[MachineData, list[float], list[float]]:
    """Read a machine, and the lengths and line velocities in its file (empty: it has none).

    `path`: a file with a machine's data, a scenario of the block or the name of one; None: the block's own start
    values. `settings`: further values, as texts by name. `unit`: of positions; empty: the file's, else mm.

    Raises:
        UserError: the first mistake, with file, line and key, or with the option.
    """
    default = MachineData(f"A machine with {BLOCK}", "machine", "", Recipe(BLOCK), "mm", {})
    top = _read_top(path) if path else read_text("", Path("--set"))
    data, lengths, velocities = _from_file(top) if path else (default, [], [])
    given = {n: _setting(data.recipe, n, text) for n, text in settings.items() if not n.startswith(LOAD)}
    unit = resolve_name(BASES, unit, "unit") if unit else data.unit
    load = _read_load(top, {n: text for n, text in settings.items() if n.startswith(LOAD)}, unit)
    data = MachineData(data.title, data.name, data.origin, data.recipe, unit, {**data.start, **given}, load)
    for length in lengths:
        check_length(data, length)
    return data, lengths, velocities


def _read_top(path: Path) -> TomlTable:
    return read_toml(path if path.is_file() else find_scenario(path))


def _read_load(top: TomlTable, settings: dict[str, str], unit: str) -> Load | None:
    """The load in a file's table, with the values of options `--set`; None if there is neither."""
    if "load" not in top and not settings:
        return None
    table = top.table("load", required=False)
    given = {name.removeprefix(LOAD): _read_value(name, text) for name, text in settings.items()}
    return read_load(table.with_values({**table.values, **given}), unit)


def _read_value(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UserError(f"--set {name}={text}: {text!r} is not a number") from None


def _from_file(top: TomlTable) -> tuple[MachineData, list[float], list[float]]:
    file = top.file
    if "fmu" in top:
        return _read_scenario(file, top), [], []
    top.allow_only(*KEYS)
    unit = top.string("unit", "mm")
    if unit not in BASES:
        top.fail("unit", f"{unit!r} is not one of {', '.join(BASES)}")
    recipe = Recipe(BLOCK)
    start = StartTable(top.table("start"), Subject(BLOCK, recipe.variables, "master", MASTER_SOURCE)).values()
    data = MachineData(top.string("title", file.stem), file.stem, str(file), recipe, unit, start)
    return data, _numbers(top, "lengths"), _numbers(top, "velocities")


def _read_scenario(file: Path, top: TomlTable) -> MachineData:
    """The machine of a scenario: its start values, without its script."""
    if (name := top.string("fmu")) != BLOCK:
        top.fail("fmu", f"{name} is no machine that can be planned: it must be {BLOCK}")
    scenario = load_scenario(file)
    own = {name: value for name, value in scenario.start.items() if not name.startswith("master.")}
    return MachineData(scenario.title, scenario.name, scenario_name(file), scenario.recipe, scenario.unit, own)


def _setting(recipe: Recipe, name: str, text: str) -> Any:
    """The value of an option `--set`."""
    if name.startswith("master."):
        raise UserError(f"--set {name}: it comes from {MASTER_SOURCE}")
    if name == "length":
        raise UserError(f"--set {name}: lengths are what is planned for: --length {text}")
    settable = {v.name: v for v in recipe.variables.values() if v.settable and not v.name.startswith("master.")}
    return parse(choose(settable, name, f"parameter or input of {BLOCK}"), text)


def _numbers(top: TomlTable, key: str) -> list[float]:
    """A list of numbers, or a text such as an option's, in a file; empty if it is missing."""
    value = top.values.get(key, [])
    if isinstance(value, list) and all(isinstance(x, int | float) and not isinstance(x, bool) for x in value):
        text = ",".join(map(repr, value))
    elif isinstance(value, str):
        text = value
    else:
        top.fail(key, f'{value!r} is neither a list of numbers nor a text such as "500..1500"')
    try:
        return read_numbers(text)
    except UserError as error:
        top.fail(key, str(error))


def read_numbers(text: str) -> list[float]:
    """Read the numbers of a text, in rising sequence: `500,1000,1500`, or `100..1200` for round numbers in between.

    Raises:
        UserError: it is no such text, or a number in it is not allowed.
    """
    values: set[float] = set()
    for part in filter(None, (p.strip() for p in text.split(","))):
        first, separator, last = part.partition(RANGE)
        numbers = [_number(first), _number(last)] if separator else [_number(first)]
        if separator and numbers[0] >= numbers[1]:
            raise UserError(f"{part}: the second number must be greater than the first")
        values.update([*numbers, *(round_values(*numbers) if separator else ())])
    return sorted(values)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise UserError(f"{text!r} is no number: write numbers with commas, 500,1000, or a range, 100..1200") from None
    if not (math.isfinite(value) and 0.0 < value <= LARGEST_INPUT):
        raise UserError(f"{value:g} is not allowed: it must be > 0 and <= {LARGEST_INPUT:g}")
    return value


def read_option(name: str, text: str) -> list[float]:
    """Read the numbers of an option; empty if it is not given."""
    try:
        return read_numbers(text)
    except UserError as error:
        raise UserError(f"--{name} {text}: {error}") from None


def check_length(data: MachineData, length: float) -> None:
    """Refuse a length that leaves no distance between two cuts."""
    if data.pitch(length) <= 0.0:
        raise UserError(
            f"length {length:g} is not allowed: with kerf = {data.value('kerf'):g} and length_correction = "
            f"{data.value('length_correction'):g} it must be > {data.length(0.0):g}"
        )
