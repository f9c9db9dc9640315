"""What a sweep varies: the values of one name in the scenario, as `--set NAME=VALUES` gives them.

A grid has equally spaced values or listed ones; a sweep runs all combinations. A range is sampled: each sample has one
value of every range.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import UserError
from ...interface.quantities import check_ends, convert, is_quantity
from .expressions import Array, Expression, parse

HELP = (
    "write NAME=start:stop:count, NAME=first:last, NAME=a,b,c, NAME=low..high, NAME=value or NAME=expression, as in: "
    "--set master.velocity=200:400:11"
)
BETWEEN = ".."
SEED = "seed"
EXACT = 2**53  # whole numbers below it are exact as Reals
FLAGS = {"true": True, "false": False}


@dataclass(frozen=True)
class Linear:
    """Equally spaced numbers, the first and the last included.

    Attributes:
        whole: the variable is an Integer: the numbers are whole.
    """

    start: float
    stop: float
    count: int
    whole: bool = False

    def at(self, index: np.ndarray[Any, np.dtype[np.int64]]) -> Array:
        """The values with these numbers, from 0; shape (index,)."""
        step = (self.stop - self.start) / (self.count - 1)
        values = np.where(index == self.count - 1, self.stop, self.start + index * step)
        return values.round().astype(np.int64) if self.whole else values


@dataclass(frozen=True)
class Listed:
    """Values one by one: numbers, Booleans, or the names of an enumeration's members."""

    values: Array

    @property
    def count(self) -> int:
        return len(self.values)

    def at(self, index: np.ndarray[Any, np.dtype[np.int64]]) -> Array:
        """The values with these numbers, from 0; shape (index,)."""
        return np.asarray(self.values[index])


@dataclass(frozen=True)
class Range:
    """Numbers from low to high, to be sampled.

    Attributes:
        whole: the variable is an Integer: the whole numbers from low to high, each as often as the others.
    """

    low: float
    high: float
    whole: bool = False

    def at(self, share: np.ndarray[Any, np.dtype[np.float64]]) -> Array:
        """The values at these shares of the range, from 0 to below 1; shape (share,)."""
        if self.whole:
            return np.minimum(np.floor(self.low + share * (self.high - self.low + 1.0)), self.high).astype(np.int64)
        return np.minimum(self.low + share * (self.high - self.low), self.high)


Values = Linear | Listed | Range | Expression


@dataclass(frozen=True)
class ValueKind:
    """What the values of a name in the scenario are.

    Attributes:
        name: FMI's type of a variable: Real, Integer, Boolean or Enumeration; empty: a key of the script, which takes
            numbers or Booleans.
        members: the names of an enumeration's members by their values.
        unit: the unit of the numbers; None: they have none.
    """

    name: str = ""
    members: Collection[tuple[int, str]] = ()
    unit: str | None = None


def is_seed(name: str) -> bool:
    """Whether a name is that of the seed of random numbers: runs that differ in it alone are samples of one thing."""
    return name.rpartition(".")[2] == SEED


def split_setting(setting: str) -> tuple[str, str]:
    """The name and the text of the values in `NAME=VALUES`.

    Raises:
        UserError: it is no such text.
    """
    name, equals, text = (part.strip() for part in setting.partition("="))
    if not (name and equals and text):
        raise UserError(f"{setting}: {HELP}")
    return name, text


def read_values(text: str, kind: ValueKind) -> Values:
    """The values, or the expression, in a text.

    Raises:
        UserError: it is none, or its values do not fit the kind.
    """
    if BETWEEN in text:
        return _range(text, kind)
    if ":" in text:
        return _linear(text, kind)
    parts = _split(text)
    if len(parts) == 1 and not _is_value(text, kind):
        return parse(text)
    return Listed(_array(parts, kind))


def _range(text: str, kind: ValueKind) -> Range:
    low, high = _bounds(text.split(BETWEEN), 2, kind)
    return Range(low, high, kind.name == "Integer")


def _linear(text: str, kind: ValueKind) -> Linear:
    parts = text.split(":")
    whole = kind.name == "Integer"
    if len(parts) == 2:
        first, last = _bounds(parts, 2, kind)
        if not (float(first).is_integer() and float(last).is_integer() and last - first < EXACT):
            raise UserError("first:last is for whole numbers; write start:stop:count for others")
        return Linear(first, last, int(last - first) + 1, whole)
    start, stop = _bounds(parts, 3, kind)
    try:
        count = int(parts[2])
    except ValueError:
        raise UserError(f"{parts[2].strip()!r} is no count") from None
    if count < 2:
        raise UserError(f"a count of {count} is not allowed: it must be >= 2; for one value write NAME=value")
    if count >= EXACT:
        raise UserError(f"a count of {parts[2].strip()} is not allowed: it must be < {EXACT}")
    if whole and (stop - start) % (count - 1):
        raise UserError(f"{start + (stop - start) / (count - 1):g} is no Integer: it must be a whole number")
    return Linear(start, stop, count, whole)


def _bounds(parts: list[str], count: int, kind: ValueKind) -> tuple[float, float]:
    """The two numbers between which a grid or range extends."""
    if len(parts) != count:
        raise UserError(HELP)
    if kind.name in ("Boolean", "Enumeration"):
        raise UserError(f"{_allowed(kind)}, one by one with commas")
    check_ends(parts[0], parts[1])
    low, high = (_number(part, kind) for part in parts[:2])
    if low >= high:
        raise UserError(f"the range is {'empty' if low == high else 'reversed'}: write the lesser number first")
    if not math.isfinite(high - low):
        raise UserError("the range is too great")
    return low, high


def _array(parts: list[str], kind: ValueKind) -> Array:
    values = [_value(part, kind) for part in parts]
    types = {type(value) for value in values}
    if len(types) > 1:
        raise UserError("numbers and true or false cannot be mixed")
    return np.array(values)


def _value(part: str, kind: ValueKind) -> float | bool | str:
    text = part.strip()
    if kind.name == "Enumeration":
        for value, name in kind.members:
            if text.upper() in (name.upper(), str(value)):
                return name
        raise UserError(f"{text!r} is not allowed: {_allowed(kind)}")
    if text.lower() in FLAGS and kind.name in ("Boolean", ""):
        return FLAGS[text.lower()]
    if kind.name == "Boolean":
        raise UserError(f"{text!r} is not allowed: {_allowed(kind)}")
    return _number(text, kind)


def _number(part: str, kind: ValueKind) -> float:
    """A finite number, in the kind's unit; a whole one, as an int, if the variable is an Integer."""
    text = part.strip()
    if kind.unit is not None and is_quantity(text):
        return convert(text, kind.unit)
    try:
        value = float(text)
    except ValueError:
        raise UserError(f"{text!r} is no number") from None
    if not math.isfinite(value):
        raise UserError(f"{text} is not allowed: it must be finite")
    if kind.name != "Integer":
        return value
    if not value.is_integer() or abs(value) >= EXACT:
        raise UserError(f"{text} is no Integer: it must be a whole number")
    return int(value)


def _allowed(kind: ValueKind) -> str:
    if kind.name == "Boolean":
        return "it must be true or false"
    return f"it must be {', '.join(f'{value} {name}' for value, name in kind.members)}"


def _is_value(text: str, kind: ValueKind) -> bool:
    """Whether a text without a comma is a value, and not an expression; a wrong value counts as one."""
    if text.lower() in FLAGS or (kind.name == "Enumeration" and text.isidentifier()):
        return True
    if kind.unit is not None and is_quantity(text):
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True


def _split(text: str) -> list[str]:
    """The parts between commas that are in no parentheses."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return [part.strip() for part in parts]
