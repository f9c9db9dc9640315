"""Reads machines: from TOML files, from scenarios, and from the options of the command line."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from motionsync.cutting.interface import Source
from motionsync.var import LARGEST_INPUT, Unit

from ..errors import UserError, choose, resolve_name
from ..interface.quantities import check_ends, convert, is_quantity
from ..interface.recipe import parse
from ..interface.units import BASES
from ..scenario.files.axis_tables import read_load
from ..scenario.files.reader import load_scenario
from ..scenario.files.shipped import find_scenario, scenario_name
from ..scenario.files.toml_tables import TomlTable, read_text, read_toml, to_float
from ..scenario.files.variable_tables import StartTable, Subject
from ..scenario.load import Load
from ..scenario.scenario import Scenario
from .kinds import BLOCKS, BOTH, KINDS
from .line_plan import round_values
from .machine import Machine

KEYS = ("title", "machine", "unit", "slave_unit", "start", "load", "lengths", "velocities")
LOAD = "load."  # the names of a load's values begin so
AXIS = ("axis.", LOAD)  # names that mean something else for each machine
MATERIAL = ("material_factor", "kerf", "length_correction", "length_tolerance")  # the same whatever cuts it
MASTER_SOURCE = "the line velocities of the plan"  # where the master's inputs come from
RANGE = ".."
UNITS = {"length": Unit.POSITION, "lengths": Unit.POSITION, "velocity": Unit.VELOCITY, "velocities": Unit.VELOCITY}


def read_machines(
    paths: Sequence[Path], kind: str, settings: Mapping[str, str], unit: str
) -> tuple[list[Machine], list[float], list[float]]:
    """Read machines, and the lengths and line velocities in their files (empty: they have none).

    `paths`: files with machines' data, scenarios or their names. `kind`: that of a machine in addition, one of KINDS or
    BOTH; empty: none but what the files have, a saw if there are no files. `settings`: further values, as texts by
    name. `unit`: of positions; empty: the files', else mm.

    Raises:
        UserError: the first mistake, with file, line and key, or with the option.
    """
    tops = [read_toml(path if path.is_file() else find_scenario(path)) for path in paths]
    machines = [_from_file(top) for top in tops]
    machines += _add_kinds(machines, resolve_name([*KINDS, BOTH], kind, "kind of machine") if kind else "")
    tops += [read_text("", Path("--set")) for _ in machines[len(tops) :]]
    if unit:
        unit = resolve_name(BASES, unit, "unit")
        machines = [m.with_units(unit, m.slave_unit if m.recipe.slave_unit else "") for m in machines]
    each = _distribute(settings, machines)
    machines = [_with_settings(m, top, values) for m, top, values in zip(machines, tops, each, strict=True)]
    lengths, velocities = (
        sorted(
            {
                number
                for top, machine in zip(tops, machines, strict=True)
                if "fmu" not in top
                for number in _numbers(top, key, machine.unit_of(UNITS[key]))
            }
        )
        for key in ("lengths", "velocities")
    )
    return machines, lengths, velocities


def _add_kinds(machines: Sequence[Machine], kind: str) -> list[Machine]:
    """The machines that are planned in addition to those of the files, for the same material and orders."""
    given = {machine.kind for machine in machines}
    if kind in KINDS and machines:
        for machine in machines:
            if machine.kind != kind:
                raise UserError(f"--machine {kind}: {machine.origin} is a {machine.kind}; --machine both compares")
        return []
    kinds = KINDS if kind == BOTH else [kind or "saw"] if not machines else []
    added = [KINDS[name].default() for name in kinds if name not in given]
    if not machines:
        return added
    first = machines[0]
    material = {name: first.start[name] for name in MATERIAL if name in first.start}
    return [
        replace(m.with_start(material).with_units(first.unit), orders=first.orders, line_velocity=first.line_velocity)
        for m in added
    ]


def _distribute(settings: Mapping[str, str], machines: Sequence[Machine]) -> list[dict[str, str]]:
    """The settings of each machine: those with the name of its block before them, and those that it has."""
    each: list[dict[str, str]] = [{} for _ in machines]
    blocks = [machine.block for machine in machines]
    for name, text in settings.items():
        block, _, own_name = name.partition(".")
        if block in blocks:
            for i, other in enumerate(blocks):
                each[i] |= {own_name: text} if other == block else {}
            continue
        owners = [i for i, machine in enumerate(machines) if name in machine.recipe.variables or name.startswith(LOAD)]
        if len(owners) > 1 and name.startswith(AXIS):
            names = " or ".join(f"{each_block}.{name}" for each_block in dict.fromkeys(blocks))
            raise UserError(f"--set {name}: of which machine? Write {names}")
        for i in owners or [0]:
            each[i][name] = text
    return each


def _with_settings(machine: Machine, top: TomlTable, settings: Mapping[str, str]) -> Machine:
    """The machine with the values of options `--set`, and with its load."""
    load = {name: text for name, text in settings.items() if name.startswith(LOAD)}
    given = {name: _setting(machine, name, text) for name, text in settings.items() if name not in load}
    return replace(machine.with_start(given), load=_read_load(top, load, machine.slave_unit))


def _read_load(top: TomlTable, settings: Mapping[str, str], unit: str) -> Load | None:
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


def _from_file(top: TomlTable) -> Machine:
    file = top.file
    if "fmu" in top:
        return _from_scenario(file, top)
    top.allow_only(*KEYS)
    kind = top.string("machine", "saw")
    if kind not in KINDS:
        top.fail("machine", f"{kind!r} is not one of {', '.join(KINDS)}")
    machine = KINDS[kind].default()
    unit = _unit(top, "unit", "mm")
    if "slave_unit" in top and not machine.recipe.slave_unit:
        top.fail("slave_unit", f"the slave of a {kind} is in the unit of the material")
    machine = machine.with_units(unit, _unit(top, "slave_unit", ""))
    subject = Subject(machine.block, machine.recipe.variables, "master", MASTER_SOURCE)
    start = StartTable(top.table("start"), subject).values()
    title = top.string("title", file.stem)
    return replace(machine, title=title, name=file.stem, origin=str(file), start=start)


def _unit(top: TomlTable, key: str, default: str) -> str:
    unit = top.string(key, default)
    if unit and unit not in BASES:
        top.fail(key, f"{unit!r} is not one of {', '.join(BASES)}")
    return unit


def _from_scenario(file: Path, top: TomlTable) -> Machine:
    """The machine of a scenario: its start values, and what its script cuts."""
    if (name := top.string("fmu")) not in BLOCKS:
        top.fail("fmu", f"{name} is no machine that can be planned: it must be {' or '.join(BLOCKS)}")
    scenario = load_scenario(file)
    machine = replace(
        BLOCKS[name].default(),
        title=scenario.title,
        name=scenario.name,
        origin=scenario_name(file),
        recipe=scenario.recipe,
        start={n: value for n, value in scenario.start.items() if not n.startswith("master.")},
    )
    machine = machine.with_units(scenario.unit, scenario.slave_unit)
    return replace(machine, orders=_orders(machine, scenario), line_velocity=_line_velocity(scenario))


def _orders(machine: Machine, scenario: Scenario) -> tuple[float, ...]:
    """The lengths that a scenario orders, or sets for pieces without an order; by marks it has none."""
    if machine.value("source") != Source.LENGTH:
        return ()
    changes = [setting.values for setting in scenario.settings]
    values = [{"length": machine.value("length")}, *changes]
    if any(values.get("order.add") for values in [scenario.start, *changes]):
        values.append(scenario.start)
    lengths = {float(v[name]) for v in values for name in ("length", "order.length") if name in v}
    return tuple(sorted(length for length in lengths if length > 0.0 and machine.pitch(length) > 0.0))


def _line_velocity(scenario: Scenario) -> float | None:
    """The greatest velocity of a scenario's line; None: it is recorded, or it never runs."""
    if scenario.master.is_recorded:
        return None
    greatest = max(motion.velocity for motion in [scenario.master.initial, *scenario.master.motions])
    return greatest if greatest > 0.0 else None


def _setting(machine: Machine, name: str, text: str) -> Any:
    """The value of an option `--set`."""
    if name.startswith("master."):
        raise UserError(f"--set {name}: it comes from {MASTER_SOURCE}")
    if name == "length":
        raise UserError(f"--set {name}: lengths are what is planned for: --length {text}")
    variables = machine.recipe.variables.values()
    settable = {v.name: v for v in variables if v.settable and not v.name.startswith("master.")}
    variable = choose(settable, name, f"parameter or input of {machine.block}")
    return parse(variable, text, machine.unit, machine.slave_unit)


def _numbers(top: TomlTable, key: str, unit: str) -> list[float]:
    """A list of numbers in a unit, or a text such as an option's, in a file; empty if it is missing."""
    value = top.values.get(key, [])
    if isinstance(value, list) and all(isinstance(x, int | float) and not isinstance(x, bool) for x in value):
        numbers: str | list[float] = value
    elif isinstance(value, str):
        numbers = value
    else:
        top.fail(key, f'{value!r} is neither a list of numbers nor a text such as "500..1500"')
    try:
        return read_numbers(numbers, unit)
    except UserError as error:
        top.fail(key, str(error))


def read_numbers(numbers: str | Sequence[float], unit: str) -> list[float]:
    """Read numbers in a unit, in rising sequence: a list of them, or a text: `500,1000,1500`, or `100..1200` for round
    numbers in between. A number in a text may have a unit of its own.

    Raises:
        UserError: it is no such text, or a number in it is not allowed.
    """
    if not isinstance(numbers, str):
        return sorted({_allowed(to_float(number)) for number in numbers})
    values: set[float] = set()
    for part in filter(None, (p.strip() for p in numbers.split(","))):
        first, separator, last = part.partition(RANGE)
        ends = [_number(end, unit) for end in ((first, last) if separator else (first,))]
        if separator:
            check_ends(first, last)
        if separator and ends[0] >= ends[1]:
            raise UserError(f"{part}: the second number must be greater than the first")
        values.update([*ends, *(round_values(*ends) if separator else ())])
    return sorted(values)


def _number(text: str, unit: str) -> float:
    if is_quantity(text):
        return _allowed(convert(text, unit))
    try:
        return _allowed(float(text))
    except ValueError:
        raise UserError(f"{text!r} is not a number: write numbers, as 500,1000, or a range, as 100..1200") from None


def _allowed(value: float) -> float:
    if not (math.isfinite(value) and 0.0 < value <= LARGEST_INPUT):
        raise UserError(f"{value:g} is not allowed: it must be > 0 and <= {LARGEST_INPUT:g}")
    return value


def read_option(name: str, numbers: str | Sequence[float], machine: Machine) -> list[float]:
    """Read the numbers of an option, in the unit of the machine's material; empty if it is not given."""
    try:
        return read_numbers(numbers, machine.unit_of(UNITS[name]))
    except UserError as error:
        raise UserError(f"--{name} {numbers}: {error}") from None
