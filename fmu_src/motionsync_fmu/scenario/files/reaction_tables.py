"""The tables [[on]] of a scenario file: what is set when a condition becomes true."""

import math
from typing import Any, NoReturn

from ...interface.variables import Variable
from ..settings import Reaction
from .expect_tables import read_condition
from .keys import Key, TableKeys, flag, number, whole
from .toml_tables import TomlTable
from .variable_tables import OutputTable, SetTable, Subject

LENGTH = "cuts.length"  # the text that stands for the length in the table [cuts]

ON = TableKeys(
    "[[on]]",
    "Values that are set each time a condition becomes true.",
    (
        Key(
            "when", "the condition", "NAME, NAME == VALUE, NAME < VALUE or NAME > VALUE, of an output or local variable"
        ),
        number("after", "how much later the values act", "s", default=0.0, least=0.0, note="below stop_time"),
        Key("set", "what is set", "table of inputs and tunable parameters", "nothing"),
        Key("add", "what is added to present values", f'table of numbers, or of "{LENGTH}"', "nothing"),
        whole("times", "how often at most", least=1, absent="once"),
        flag("repeat", "each time, instead of times"),
        flag("required", "whether the run is not as expected if it never happens, or less often than times"),
    ),
)


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
    ON.check(table)
    condition = read_condition(OutputTable(table, block))
    after = ON.value(table, "after", below=stop_time)
    set_values = SetTable(table.table("set", required=False), block).values()
    added_values = AddTable(table.table("add", required=False), block, length).values()
    if both := set_values.keys() & added_values.keys():
        table.fail("add", f"{min(both)} is set, too: give one of both")
    if not set_values and not added_values:
        table.fail("when", "sets nothing: it needs set, add or both")
    return Reaction(condition, after, set_values, added_values, _read_times(table), ON.value(table, "required"))


def _read_times(table: TomlTable) -> int | None:
    if "times" not in table:
        return None if ON.value(table, "repeat") else 1
    if "repeat" in table:
        table.fail("times", "repeat means each time: give one of both")
    return int(ON.value(table, "times"))
