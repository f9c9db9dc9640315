"""Tables of a scenario file whose keys are names of variables: which variables each may name, and with which values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NoReturn

from ...interface.variables import GREATEST_INTEGER, LEAST_INTEGER, Variable
from .toml_tables import TomlTable, to_float


@dataclass(frozen=True)
class Subject:
    """The block whose variables a table names.

    Attributes:
        name: the block's name.
        variables: the block's variables by name.
        scripted: the part of the block whose inputs no table sets, since they come from elsewhere.
        origin: where these inputs come from, in words.
    """

    name: str
    variables: Mapping[str, Variable]
    scripted: str
    origin: str

    def scripts(self, v: Variable) -> bool:
        """Whether the variable is an input of the scripted part."""
        return v.causality == "input" and v.name.startswith(f"{self.scripted}.")


class VariableTable:
    """A table that names variables; a subclass defines which of them it may name, and with which values."""

    required = ""
    """The variables that the table may name, in words."""

    def __init__(self, table: TomlTable, block: Subject) -> None:
        self.table = table
        self.block = block

    def fits(self, v: Variable) -> bool:
        """Whether the table may name the variable."""
        raise NotImplementedError

    def refusal(self, v: Variable, value: Any) -> str:
        """Why the value, which is of the variable's type, is not allowed; empty if it is."""
        return v.refusal(value)

    def values(self, *others: str) -> dict[str, Any]:
        """The values of all variables in the table; `others`: keys that are no variables."""
        return {name: self.value(name, value) for name, value in self.table.values.items() if name not in others}

    def variable(self, name: str, key: str = "") -> Variable:
        """The variable of this name; `key`: the key at which the name is given, if it is not a key itself."""
        v = self.block.variables.get(name)
        if v is None:
            near = get_close_matches(name, self.block.variables, 1)
            hint = f"; do you mean {near[0]!r}?" if near else ""
            self.table.fail(key or name, f"{self.block.name} has no variable {name!r}{hint}")
        if not self.fits(v):
            self.refuse(v, key)
        return v

    def refuse(self, v: Variable, key: str) -> NoReturn:
        """Fail because the table may not name the variable."""
        named = f"{v.name} " if key else ""
        self.table.fail(key or v.name, f"{named}is a {v.variability} {v.causality}, not {self.required}")

    def value(self, name: str, value: Any, key: str = "") -> Any:
        """A variable's value as a number or Boolean; a member of an enumeration may be given by its name."""
        location = key or name
        if isinstance(value, dict) and name not in self.block.variables:
            for part, inner in value.items():
                if f"{name}.{part}" in self.block.variables and not isinstance(inner, dict):
                    self.table.fail(name, f'a name with a dot needs quotes: "{name}.{part}"')
        v = self.variable(name, key)
        if self.block.scripts(v):
            self.table.fail(location, f"comes from {self.block.origin}")
        members = {member.name: member.value for member in v.choices}
        value = members.get(value, value) if isinstance(value, str) else value
        if not is_of_kind(v, value):
            self.table.fail(location, f"{value!r} is no {v.kind}: it must be {v.allowed_values}")
        value = to_float(value) if v.kind == "Real" else value
        if refusal := self.refusal(v, value):
            self.table.fail(location, refusal)
        return value


class StartTable(VariableTable):
    """Start values."""

    required = "a parameter or input"

    def fits(self, v: Variable) -> bool:
        return v.settable


class SetTable(VariableTable):
    """What is set during a run. The FMU itself refuses a number outside its range, at the time of the setting."""

    required = "an input or tunable parameter"

    def fits(self, v: Variable) -> bool:
        return v.causality == "input" or v.variability == "tunable"

    def refusal(self, v: Variable, value: Any) -> str:
        return v.refusal(value) if v.choices else ""


class OutputTable(VariableTable):
    """What is expected of outputs, whose ranges are not declared."""

    required = "an output or local variable"

    def fits(self, v: Variable) -> bool:
        return not v.settable

    def refusal(self, v: Variable, value: Any) -> str:
        if v.choices:
            return v.refusal(value)
        return "" if math.isfinite(to_float(value)) else f"{value} is not allowed: it must be finite"


class FlagTable(VariableTable):
    """A table that names a Boolean output."""

    required = "a Boolean output or local variable"

    def fits(self, v: Variable) -> bool:
        return v.kind == "Boolean" and not v.settable

    def refuse(self, v: Variable, key: str) -> NoReturn:
        self.table.fail(key, f"{v.name} is a {v.variability} {v.kind} {v.causality}, not {self.required}")


def is_of_kind(v: Variable, value: Any) -> bool:
    """Whether a TOML value is of the variable's type; a whole number is a Real, too, and a Boolean is not a number.

    An Integer has 32 bits, as FMI's has."""
    if v.kind == "Boolean" or isinstance(value, bool):
        return v.kind == "Boolean" and isinstance(value, bool)
    if v.kind == "Real":
        return isinstance(value, int | float)
    return isinstance(value, int) and LEAST_INTEGER <= value <= GREATEST_INTEGER
