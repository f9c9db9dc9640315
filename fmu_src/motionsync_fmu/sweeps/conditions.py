"""Conditions on the rows of a sweep: columns compared with values, joined with `and`.

`late == 0 and skipped == 0`, `passed`, `not passed`, `cut_error < 0.01`, `refusal == ""`.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import pyarrow as pa
import pyarrow.compute as pc

from ..errors import UserError, choose

SIGNS: Mapping[str, Callable[[Any, Any], Any]] = {
    "==": pc.equal,
    "!=": pc.not_equal,
    "<=": pc.less_equal,
    ">=": pc.greater_equal,
    "<": pc.less,
    ">": pc.greater,
}
PART = re.compile(r"""(not\s+)?([^\s=!<>"']+)\s*(?:(==|!=|<=|>=|<|>)\s*("[^"]*"|'[^']*'|[^\s=!<>"']+))?""")
JOINT = re.compile(r"""\s+and\s+(?=(?:[^"']|"[^"]*"|'[^']*')*$)""")  # none inside a text
FLAGS = {"true": True, "false": False}
FORM = "COLUMN == VALUE (or !=, <, <=, >, >=) nor the name of a column of true and false; several are joined by and"


@dataclass(frozen=True)
class Comparison:
    """A column of a row, compared with a value.

    Attributes:
        sign: a key of SIGNS.
    """

    column: str
    sign: str
    value: bool | float | str


@dataclass(frozen=True)
class RowCondition:
    """A condition on the rows of a sweep: all comparisons hold."""

    text: str
    comparisons: tuple[Comparison, ...]

    @classmethod
    def read(cls, text: str) -> Self:
        """The condition in a text.

        Raises:
            UserError: the text is no condition.
        """
        return cls(text, tuple(_comparison(part, text) for part in JOINT.split(text.strip())))

    @property
    def columns(self) -> list[str]:
        """The columns that are compared, each once."""
        return list(dict.fromkeys(c.column for c in self.comparisons))

    def check(self, schema: pa.Schema) -> None:
        """Refuse what rows with this schema cannot be asked.

        Raises:
            UserError: a column is none of theirs, or is compared with a value that it cannot have.
        """
        kinds = {field.name: field.type for field in schema}
        for c in self.comparisons:
            kind = choose(kinds, c.column, "column of a row")
            if pa.types.is_list(kind):
                raise UserError(f"{c.column} has several numbers in a row: nothing is compared with them")
            expected_type, example = _expected_type(kind)
            if type(c.value) is not expected_type:
                value = f'"{c.value}"' if isinstance(c.value, str) else f"{c.value:g}"
                raise UserError(f"{c.column} {c.sign} {value}: compare {c.column} with {example}")
            if expected_type is not float and c.sign not in ("==", "!="):
                raise UserError(f"{c.column} {c.sign} ...: {c.column} is {example}, which == and != compare")

    def holds(self, rows: pa.Table) -> pa.ChunkedArray:
        """For which rows it holds, shape (rows,). A comparison with a value that is missing (null, NaN) does not."""
        mask = pa.chunked_array([pa.repeat(pa.scalar(True), rows.num_rows)])
        for c in self.comparisons:
            column = rows[c.column]
            has_value = pc.invert(pc.is_null(column, nan_is_null=True))
            mask = pc.and_(mask, pc.and_(has_value, pc.fill_null(SIGNS[c.sign](column, c.value), False)))
        return mask


def _comparison(part: str, text: str) -> Comparison:
    match = PART.fullmatch(part)
    if not match:
        raise UserError(f"{text!r} is no condition: {part!r} is neither {FORM}")
    negated, column, sign, value = match.groups()
    if value is None:
        return Comparison(column, "==", not negated)
    if negated:
        raise UserError(f"{text!r} is no condition: not is for the name of a column alone, as in: not passed")
    return Comparison(column, sign, _value(value, text))


def _value(word: str, text: str) -> bool | float | str:
    if word[0] in "\"'":
        return word[1:-1]
    if word.lower() in FLAGS:
        return FLAGS[word.lower()]
    try:
        number = float(word)
    except ValueError:
        raise UserError(f"{text!r} is no condition: {word!r} is no number, true, false or text in quotes") from None
    if math.isnan(number):
        raise UserError(f"{text!r} is no condition: nothing is equal to {word}, less or greater")
    return number


def _expected_type(kind: pa.DataType) -> tuple[type, str]:
    """What a column of this type is compared with, and that in words."""
    if pa.types.is_boolean(kind):
        return bool, "true or false"
    if pa.types.is_string(kind):
        return str, 'a text in quotes, as in == ""'
    return float, "a number"
