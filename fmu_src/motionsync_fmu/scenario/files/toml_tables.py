"""TOML files whose mistakes are reported with file, line and key.

`tomllib` does not report the line of a key. Therefore this module searches the text for the lines.
"""

import math
import re
import tomllib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from ...errors import UserError

KeyLocation = tuple[str, int, str]
"""A table's name with dots, which of the tables of this name it is (from 0), and a key; "": the table itself."""

MOST_DIGITS = 4300  # of an integer; Python reads and writes no longer ones (sys.int_info.default_max_str_digits)
LONGEST = 10**MOST_DIGITS
DEEPEST = 100  # tables and lists within each other; no key is that deep
LONG = re.compile(r"\b\d\w{2999,}")  # 4300 digits are 3571 in hexadecimal


def read_toml(file: Path, lists: Iterable[str] = ()) -> "TomlTable":
    """The top level of a file; `lists`: as for `read_text`.

    Raises:
        UserError: the file cannot be read, or is not TOML.
    """
    return read_text(read_file(file), file, lists)


def read_file(file: Path) -> str:
    """The text of a file.

    Raises:
        UserError: the file cannot be read.
    """
    try:
        return file.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{file}: cannot be read: {error}") from None


def read_text(text: str, file: Path, lists: Iterable[str] = ()) -> "TomlTable":
    """The top level of a file with this text; `lists`: keys whose values are lists of tables in braces, on one line or
    on several.

    Raises:
        UserError: the text is not TOML.
    """
    try:
        values = _parse(text)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"line (\d+)", str(error))
        at = int(line[1]) if line else text.count("\n") + 1
        raise UserError(f"{file}:{at}: not TOML: {error}") from None
    except ValueError as error:
        at = next((n for n, line in enumerate(text.split("\n"), 1) if LONG.search(line)), 1)
        raise UserError(f"{file}:{at}: not TOML: {error}") from None
    except RecursionError:
        raise UserError(f"{file}:1: not TOML: nested too deeply") from None
    return TomlTable(_Source(file, text, _find_lines(text, tuple(lists))), "", 0, values)


def parse_literal(text: str) -> Any:
    """A value as TOML writes it (true, false, a number); any other text as it is."""
    try:
        return _parse(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return text


def _parse(text: str) -> dict[str, Any]:
    """The values of a TOML text.

    Raises:
        tomllib.TOMLDecodeError: the text is not TOML.
        ValueError: one of its integers is too long to be read, or to be written in a message.
        RecursionError: it is nested too deeply.
    """
    too_long = f"an integer has more than {MOST_DIGITS} digits"
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # that of int()
        raise ValueError(too_long) from None
    remaining: list[tuple[Any, int]] = [(values, 0)]
    while remaining:
        value, depth = remaining.pop()
        if isinstance(value, dict | list):
            if depth > DEEPEST:
                raise RecursionError
            remaining += [(inner, depth + 1) for inner in (value.values() if isinstance(value, dict) else value)]
        elif isinstance(value, int) and abs(value) >= LONGEST:  # hexadecimal, octal or binary
            raise ValueError(too_long)
    return values


def to_float(value: float) -> float:
    """The value as a float; infinite for an integer that is greater than every float."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def writable(value: Any) -> Any:
    """The value; infinite for an integer that Python does not write, since it is too long."""
    return math.inf if isinstance(value, int) and abs(value) >= LONGEST else value


@dataclass(frozen=True)
class _Source:
    """A file, its text, and the line of each table and key in it."""

    file: Path
    text: str
    lines: dict[KeyLocation, int]


class TomlTable:
    """One table of a file. Its methods read a key's value, or fail with one `UserError` that names file, line and key.

    Attributes:
        name: the table's name, with dots; empty: the top level.
        values: the values by key.
    """

    def __init__(self, source: _Source, name: str, i: int, values: dict[str, Any]) -> None:
        self.name = name
        self.values = values
        self._source = source
        self._i = i

    @property
    def file(self) -> Path:
        return self._source.file

    @property
    def text(self) -> str:
        """The text of the whole file."""
        return self._source.text

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def with_values(self, values: dict[str, Any]) -> "TomlTable":
        """The same table of the same file, with these values."""
        return TomlTable(self._source, self.name, self._i, values)

    def allow_only(self, *allowed: str) -> None:
        for key in self.values:
            if key not in allowed:
                self.fail(key, f"unknown key; there is {', '.join(allowed)}")

    def number(
        self,
        key: str,
        *,
        default: float | None = None,
        above: float = -math.inf,
        least: float = -math.inf,
        most: float = math.inf,
        below: float = math.inf,
    ) -> float:
        """A finite number within these limits; the default is not checked."""
        value, given = self.values.get(key, default), key in self.values
        if value is None:
            self.fail(key, "is missing")
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fail(key, f"{value!r} is not a number")
        value = to_float(value)
        if given and not math.isfinite(value):
            self.fail(key, f"{value} is not allowed: it must be finite")
        limits = (
            (value > above, above > -math.inf, f"> {above:g}"),
            (value >= least, least > -math.inf, f">= {least:g}"),
            (value <= most, most < math.inf, f"<= {most:g}"),
            (value < below, below < math.inf, f"< {below:g}"),
        )
        if given and not all(is_met for is_met, _, _ in limits):
            text = " and ".join(text for _, is_given, text in limits if is_given)
            self.fail(key, f"{value:g} is not allowed: it must be {text}")
        return value

    def number_or_0(self, key: str, *, smallest: float, most: float) -> float:
        """0, which is the default, or a number within these limits."""
        value = self.number(key, default=0.0, least=0.0, most=most)
        if 0.0 < value < smallest:
            self.fail(key, f"{value:g} is not allowed: it must be 0, or {smallest:g} to {most:g}")
        return value

    def whole(self, key: str, *, default: int | None = None, least: int = 0, most: int | None = None) -> int:
        """A number without a fraction within these limits."""
        value = self.number(key, default=default)
        if not value.is_integer():
            self.fail(key, f"{value:g} is not a whole number")
        if value < least or (most is not None and value > most):
            allowed = f">= {least}" if most is None else f"{least} to {most}"
            self.fail(key, f"{int(value)} is not allowed: it must be {allowed}")
        return int(value)

    def string(self, key: str, default: str | None = None) -> str:
        value = self.values.get(key, default)
        if value is None:
            self.fail(key, "is missing")
        if not isinstance(value, str):
            self.fail(key, f"{value!r} is not a text")
        return value

    def strings(self, key: str) -> tuple[str, ...]:
        """A text or a list of texts; none if the key is missing."""
        value = self.values.get(key, [])
        texts = [value] if isinstance(value, str) else value
        if not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
            self.fail(key, f"{value!r} is neither a text nor a list of texts")
        return tuple(texts)

    def numbers(self, key: str) -> tuple[float, ...]:
        """A list of finite numbers."""
        values = self.values[key]
        if not isinstance(values, list):
            self.fail(key, f"{values!r} is not a list of numbers")
        if wrong := [v for v in values if isinstance(v, bool) or not isinstance(v, int | float)]:
            self.fail(key, f"{wrong[0]!r} is not a number")
        if infinite := [v for v in values if not math.isfinite(to_float(v))]:
            self.fail(key, f"{infinite[0]} is not allowed: it must be finite")
        return tuple(map(to_float, values))

    def flag(self, key: str) -> bool:
        """A Boolean; false if it is missing."""
        value = self.values.get(key, False)
        if not isinstance(value, bool):
            self.fail(key, f"{value!r} is neither true nor false")
        return value

    def table(self, key: str, *, required: bool = True) -> "TomlTable":
        """The table [key]; an empty one if it is missing and not required."""
        name = f"{self.name}.{key}".strip(".")
        value = self.values.get(key, None if required else {})
        if not isinstance(value, dict):
            self.fail(key, "is missing" if value is None else f"must be a table: [{name}]")
        return TomlTable(self._source, name, self._i, value)

    def tables(self, key: str, form: str = "") -> "list[TomlTable]":
        """The tables [[key]], none if they are missing; `form`: how they are written instead, for the message."""
        name = f"{self.name}.{key}".strip(".")
        value = self.values.get(key, [])
        if not isinstance(value, list) or not all(isinstance(t, dict) for t in value):
            self.fail(key, f"must be a list of tables{f' {form}' if form else f': [[{name}]]'}")
        return [TomlTable(self._source, name, i, t) for i, t in enumerate(value)]

    def inline(self, key: str) -> "InlineTable | None":
        """The table in braces that is this key's value; None if the value is something else."""
        value = self.values[key]
        return InlineTable(self, key, value) if isinstance(value, dict) else None

    def fail(self, key: str, message: str) -> NoReturn:
        """Report a mistake at a key; the key "" stands for the whole table.

        Raises:
            UserError: always.
        """
        outer, _, last = self.name.rpartition(".")
        inner = f"{self.name}.{key}".strip(".")
        locations = [(self.name, self._i, key), (inner, 0, ""), (self.name, self._i, "")]
        locations += [(outer, self._i, last), (outer, 0, last)]
        line = next((self._source.lines[at] for at in locations if at in self._source.lines), 1)
        raise UserError(f"{self.file}:{line}: {key or self.name}: {message}")


class InlineTable(TomlTable):
    """A table in braces: its mistakes are reported at its own key in the outer table."""

    def __init__(self, outer: TomlTable, key: str, values: dict[str, Any]) -> None:
        super().__init__(outer._source, f"{outer.name}.{key}", 0, values)
        self._outer, self._key = outer, key

    def fail(self, key: str, message: str) -> NoReturn:
        self._outer.fail(self._key, f"{key}: {message}" if key else message)


HEADER = re.compile(r"\s*\[(\[?)\s*([\w.-]+)\s*\]\]?\s*(#.*)?$")
KEY = re.compile(r"""\s*(["']?)([\w.-]+)\1\s*=""")
INNER_KEY = re.compile(r"""\s*([\w-]+)\s*\.\s*(["']?)([\w.-]+)\2\s*=""")


def _find_lines(text: str, lists: tuple[str, ...]) -> dict[KeyLocation, int]:
    """The number of the line on which each table and each key starts."""
    line_numbers: dict[KeyLocation, int] = {}
    tables: Counter[str] = Counter()
    table, i, list_name = "", 0, ""
    for n, line in enumerate(text.split("\n"), 1):
        if header := HEADER.match(line):
            table, list_name = header[2], ""
            outer_count = tables[table.rpartition(".")[0]]
            i = outer_count - 1 if outer_count and not header[1] else tables[table]  # [a.b] belongs to the last [[a]]
            tables[table] += 1
            line_numbers[table, i, ""] = n
        elif key := KEY.match(line):
            line_numbers.setdefault((table, i, key[2]), n)
            list_name = f"{table}.{key[2]}" if key[2] in lists else ""
        if inner := INNER_KEY.match(line):  # a.b = ... is a table a to TOML
            line_numbers.setdefault((table, i, inner[1]), n)
            line_numbers.setdefault((f"{table}.{inner[1]}".strip("."), i, inner[3]), n)
            list_name = ""
        for _ in range(line.count("{") if list_name else 0):
            line_numbers[list_name, tables[list_name], ""] = n
            tables[list_name] += 1
    return line_numbers
