"""The tables [[expect]] of a scenario file."""

import math
import re

from ..scenario import AtTime, Expectation, When, Within
from ..settings import OutputCondition
from .toml_tables import TomlTable, parse_literal, to_float
from .variable_tables import OutputTable, Subject

CONDITION = re.compile(r"\s*([\w.]+)\s*(?:(==|<|>)\s*(\S+)\s*)?")


def read_expectation(table: TomlTable, block: Subject, stop_time: float) -> Expectation:
    """One expectation; its keys decide which of the three kinds it is.

    Raises:
        UserError: the first mistake in it.
    """
    kinds = [key for key in ("at", "when", "from") if key in table]
    if len(kinds) != 1:
        table.fail("", "needs exactly one of at, when, from")
    outputs = OutputTable(table, block)
    match kinds[0]:
        case "at":
            return _read_at_time(outputs, stop_time)
        case "when":
            return _read_when(outputs, stop_time)
        case _:
            return _read_within(outputs, stop_time)


def _read_at_time(outputs: OutputTable, stop_time: float) -> AtTime:
    table = outputs.table
    at = table.number("at", least=0.0, most=stop_time)
    values = {name: float(value) for name, value in outputs.values("at", "tolerance").items()}
    if not values:
        table.fail("at", "expects nothing")
    return AtTime(at, values, table.number("tolerance", default=1e-6, least=0.0))


def _read_when(outputs: OutputTable, stop_time: float) -> When:
    table = outputs.table
    table.allow_only("when", "time", "tolerance")
    condition = read_condition(outputs)
    time = table.number("time", least=0.0, most=stop_time)
    tolerance = table.number("tolerance", least=0.0) if "tolerance" in table else None
    return When(condition.text, condition.name, condition.comparison, condition.value, time, tolerance)


def read_condition(outputs: OutputTable) -> OutputCondition:
    """The condition at the key `when`.

    Raises:
        UserError: it is not a comparison of an output with a value that it may have.
    """
    table = outputs.table
    if "when" not in table:
        table.fail("when", "is missing")
    text = table.values["when"]
    match = CONDITION.fullmatch(text) if isinstance(text, str) else None
    if not match:
        table.fail("when", f"{text!r} is not NAME, NAME == VALUE, NAME < VALUE or NAME > VALUE")
    name, comparison, value = match[1], match[2] or "==", match[3]
    v = outputs.variable(name, "when")
    if value is None and v.kind != "Boolean":
        table.fail("when", f"{name} is a {v.kind}: compare it, as in {name!r} == VALUE")
    compared = 1.0 if value is None else to_float(outputs.value(name, parse_literal(value), "when"))
    return OutputCondition(match.string, name, comparison, compared)


def _read_within(outputs: OutputTable, stop_time: float) -> Within:
    table = outputs.table
    begin = table.number("from", least=0.0, most=stop_time)
    end = table.number("to", least=begin, most=stop_time)
    limits: dict[str, tuple[float, float]] = {}
    for name in table.values:
        if name in ("from", "to", "tolerance"):
            continue
        outputs.variable(name)
        bounds = table.inline(name)
        if bounds is None or not bounds.values:
            table.fail(name, "must be { min = ..., max = ... }, or one of them")
        bounds.allow_only("min", "max")
        low = bounds.number("min", default=-math.inf)
        limits[name] = (low, bounds.number("max", default=math.inf, least=low))
    if not limits:
        table.fail("from", "expects nothing")
    return Within(begin, end, limits, table.number("tolerance", default=1e-9, least=0.0))
