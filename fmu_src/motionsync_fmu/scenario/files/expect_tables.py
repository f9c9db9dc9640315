"""The tables [[expect]] of a scenario file."""

import math
import re

from ..scenario import AtTime, Expectation, When, Within
from ..settings import OutputCondition
from .keys import Key, TableKeys, number
from .toml_tables import TomlTable, parse_literal, to_float
from .variable_tables import OutputTable, Subject

CONDITION = re.compile(r"\s*([\w.]+)\s*(?:(==|<|>)\s*(\S+)\s*)?")
VALUE = "number, Boolean or name of a member"

AT_TIME = TableKeys(
    "[[expect]], values at a time",
    "The values of outputs and local variables at a time.",
    (
        number("at", "the time", "s", least=0.0, note="up to stop_time"),
        Key("NAME", "the value of this variable", VALUE),
        number("tolerance", "how far a value may be off", default=1e-6, least=0.0),
    ),
)
WHEN = TableKeys(
    "[[expect]], the time of an event",
    "The first time at which a condition holds.",
    (
        Key("when", "the condition", "as in [[on]]"),
        number("time", "when it holds first", "s", least=0.0, note="up to stop_time"),
        number(
            "tolerance",
            "how far the time may be off",
            "s",
            absent="one step, with [remote] at least a cycle",
            least=0.0,
        ),
    ),
)
WITHIN = TableKeys(
    "[[expect]], limits",
    "Limits at all communication points of an interval.",
    (
        number("from", "where the interval begins", "s", least=0.0, note="up to stop_time"),
        number("to", "where it ends", "s", note="from to stop_time"),
        Key("NAME", "the limits of this variable", "{ min, max }: numbers, one or both"),
        number("tolerance", "how far a value may be beyond a limit", default=1e-9, least=0.0),
    ),
)
BOUNDS = TableKeys("NAME", "", (number("min", "", default=-math.inf), number("max", "", default=math.inf)))


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
    at = AT_TIME.value(table, "at", most=stop_time)
    values = {name: float(value) for name, value in outputs.values("at", "tolerance").items()}
    if not values:
        table.fail("at", "expects nothing")
    return AtTime(at, values, AT_TIME.value(table, "tolerance"))


def _read_when(outputs: OutputTable, stop_time: float) -> When:
    table = outputs.table
    WHEN.check(table)
    condition = read_condition(outputs)
    time, tolerance = WHEN.value(table, "time", most=stop_time), WHEN.value(table, "tolerance")
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
    begin = WITHIN.value(table, "from", most=stop_time)
    end = WITHIN.value(table, "to", least=begin, most=stop_time)
    limits: dict[str, tuple[float, float]] = {}
    for name in table.values:
        if name in ("from", "to", "tolerance"):
            continue
        outputs.variable(name)
        bounds = table.inline(name)
        if bounds is None or not bounds.values:
            table.fail(name, "must be { min = ..., max = ... }, or one of them")
        BOUNDS.check(bounds)
        low = BOUNDS.value(bounds, "min")
        limits[name] = (low, BOUNDS.value(bounds, "max", least=low))
    if not limits:
        table.fail("from", "expects nothing")
    return Within(begin, end, limits, WITHIN.value(table, "tolerance"))
