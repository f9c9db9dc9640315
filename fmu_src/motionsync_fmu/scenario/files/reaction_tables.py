"""The tables [[on]] of a scenario file: what is set when a condition becomes true."""

import math
from typing import Any, NoReturn

from ...interface.variables import Variable
from ..settings import Reaction
from .expect_tables import read_condition
from .toml_tables import TomlTable
from .variable_tables import OutputTable, SetTable, Subject

LENGTH = "cuts.length"  # the text that stands for the length in the table [cuts]


class AddTable(SetTable):
    """What is added to present values."""

    required = "an input or tunable parameter that is a number"

    def __init__(self, table: TomlTable, block: Subject, length: Any) -> None:
        """`length`: that of the table [cuts], None without one."""
        super().__init__(table, block)
        self.length = length

    def fits(self, v: Variable) -> bool:
        return super().fits(v) and v.kind in ("Real", "Integer")

    def refuse(self, v: Variable, key: str) -> NoReturn:
        self.table.fail(v.name, f"is a {v.variability} {v.kind} {v.causality}, not {self.required}")

    def refusal(self, v: Variable, value: Any) -> str:
        return "" if math.isfinite(value) else f"{value} is not allowed: it must be finite"

    def value(self, name: str, value: Any, key: str = "") -> Any:
        if value == LENGTH and self.length is None:
            self.table.fail(name, f"{LENGTH!r}: there is no length in a table [cuts]")
        return super().value(name, self.length if value == LENGTH else value, key)


def read_reaction(table: TomlTable, block: Subject, stop_time: float, length: Any) -> Reaction:
    """One reaction; `length`: that of the table [cuts], None without one.

    Raises:
        UserError: the first mistake in it.
    """
    table.allow_only("when", "after", "set", "add", "times", "repeat", "required")
    condition = read_condition(OutputTable(table, block))
    after = table.number("after", default=0.0, least=0.0, below=stop_time)
    set_values = SetTable(table.table("set", required=False), block).values()
    added_values = AddTable(table.table("add", required=False), block, length).values()
    if both := set_values.keys() & added_values.keys():
        table.fail("add", f"{min(both)} is set, too: give one of both")
    if not set_values and not added_values:
        table.fail("when", "sets nothing: it needs set, add or both")
    return Reaction(condition, after, set_values, added_values, _read_times(table), table.flag("required"))


def _read_times(table: TomlTable) -> int | None:
    if "times" not in table:
        return None if table.flag("repeat") else 1
    if "repeat" in table:
        table.fail("times", "repeat means each time: give one of both")
    times = table.whole("times")
    if times == 0:
        table.fail("times", "0 is not allowed: it must be >= 1")
    return times
