"""The keys of a table in a scenario file: what each means, which values it may have, what holds if it is left out.

The reader of a table reads its keys by these declarations, and the reference of scenario files is made from them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .toml_tables import TomlTable

REQUIRED = ""  # the default of a key that may not be left out


@dataclass(frozen=True)
class Key:
    """A key of a table.

    Attributes:
        meaning: what the value means, in words.
        value: which values there may be, in words.
        default: what holds if the key is left out, in words; REQUIRED: it may not be left out.
        read: reads the value in a table, within narrower limits if some are given; None: the table's reader does that.
    """

    name: str
    meaning: str
    value: str
    default: str = REQUIRED
    read: Callable[..., Any] | None = None


@dataclass(frozen=True)
class TableKeys:
    """All keys of a table.

    Attributes:
        heading: the table as it is written in a file.
        meaning: what it is about, in words.
    """

    heading: str
    meaning: str
    keys: tuple[Key, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(key.name for key in self.keys)

    def without(self, *names: str) -> "TableKeys":
        """The same table without some of its keys."""
        return TableKeys(self.heading, self.meaning, tuple(key for key in self.keys if key.name not in names))

    def check(self, table: TomlTable) -> None:
        """Refuse a key that the table does not have.

        Raises:
            UserError: there is one.
        """
        table.allow_only(*self.names)

    def read(self, table: TomlTable) -> dict[str, Any]:
        """The values of all keys that need nothing but the table.

        Raises:
            UserError: the first mistake in it.
        """
        self.check(table)
        return {key.name: key.read(table) for key in self.keys if key.read}

    def value(self, table: TomlTable, name: str, **limits: float) -> Any:
        """The value of one key; `limits`: those of `TomlTable.number` that are narrower than the declared ones.

        Raises:
            UserError: it is missing, or not allowed.
        """
        (read,) = (key.read for key in self.keys if key.name == name)
        assert read
        return read(table, **limits)


def number(
    name: str,
    meaning: str,
    unit: str = "",
    *,
    default: float | None = None,
    absent: str = "",
    smallest: float = 0.0,
    note: str = "",
    **limits: float,
) -> Key:
    """A number.

    `unit`: u is the unit of positions; `absent`: what holds without a default, None being read, if the key is left out;
    `smallest`: the least number next to 0; `note`: on its values; `limits`: those of `TomlTable.number`.
    """

    def read(table: TomlTable, **narrower: float) -> float | None:
        if absent and name not in table:
            return None
        if smallest:
            return table.number_or_0(name, smallest=smallest, most=limits["most"])
        return table.number(name, default=default, **{**limits, **narrower})

    values = " and ".join(f"{SIGNS[key]} {limit:g}" for key, limit in limits.items())
    values = f"0, or {smallest:g} to {limits['most']:g}" if smallest else values
    value = ", ".join(filter(None, [f"number in {unit}" if unit else "number", values, note]))
    given = "0" if smallest else absent or (REQUIRED if default is None else NUMBERS.get(default, f"{default:g}"))
    return Key(name, meaning, value, given, read)


SIGNS = {"above": ">", "least": ">=", "most": "<=", "below": "<"}
NUMBERS = {math.inf: "any", -math.inf: "any"}  # limits, in words


def whole(
    name: str, meaning: str, *, default: int | None = None, absent: str = "", least: int = 0, most: int | None = None
) -> Key:
    """A number without a fraction, 0 or more; `absent`: as for `number`."""

    def read(table: TomlTable, **narrower: int) -> int | None:
        if absent and name not in table:
            return None
        return table.whole(name, default=default, least=least, most=narrower.get("most", most))

    value = f"whole number, {least} to {most}" if most is not None else f"whole number, {least} or more"
    return Key(name, meaning, value, absent or (REQUIRED if default is None else f"{default}"), read)


def text(name: str, meaning: str, *, default: str | None = None, absent: str = "", value: str = "text") -> Key:
    """A text; `absent`: what the default means, in words; `value`: which texts there are, in words."""
    given = REQUIRED if default is None else absent or f'"{default}"'
    return Key(name, meaning, value, given, lambda table: table.string(name, default))


def flag(name: str, meaning: str) -> Key:
    """A Boolean, false if it is left out."""
    return Key(name, meaning, "true or false", "false", lambda table: table.flag(name))
