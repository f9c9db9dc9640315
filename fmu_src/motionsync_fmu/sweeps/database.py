"""The rows of a sweep in its part files, asked by SQL: DuckDB reads them, so memory does not grow with the rows."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

import duckdb
import pyarrow.parquet as pq
from numpy.typing import NDArray

from ..errors import UserError, choose
from ..pages.style import with_unit
from .conditions import Comparison, RowCondition

CODES = ("fault",)  # numbers that are names: nobody asks for their mean; 0 is none
NOTHING: Mapping[str, str] = {}
TRUTH, TEXT, LIST = "BOOLEAN", "VARCHAR", "DOUBLE[]"  # as DuckDB names them

Answer = dict[str, NDArray[Any]]
"""Columns of an answer by name, with a value for each row."""


class ColumnKind(Enum):
    """What the values of a column are."""

    NUMBER = "numbers"
    TRUTH = "true or false"
    TEXT = "texts"
    LIST = "several numbers in a row"


@dataclass(frozen=True)
class Column:
    """A column of the rows.

    Attributes:
        varied: the sweep gives its values (a factor or a derived value); otherwise it is a result.
        unit: the unit of its values; empty: none is known.
    """

    name: str
    kind: ColumnKind
    varied: bool
    unit: str = ""

    @property
    def title(self) -> str:
        """Its name with its unit."""
        return with_unit(self.name, self.unit)

    @property
    def sql(self) -> str:
        """Its name in a query."""
        return '"' + self.name.replace('"', '""') + '"'

    @property
    def number(self) -> str:
        """Its value as a number in a query: 1 for true; NULL where it is not finite or not known."""
        value = f"{self.sql}::DOUBLE"
        return f"CASE WHEN isfinite({value}) THEN {value} END"


class Database:
    """The rows of some part files.

    Attributes:
        columns: all columns by name, in the order of the files.
    """

    def __init__(
        self, folder: Path, parts: Sequence[Path], varied: Iterable[str], units: Mapping[str, str] = NOTHING
    ) -> None:
        """`varied`: the names of the columns with the values of factors and derived values; `units`: those of columns.

        Raises:
            UserError: there is no part, or one is damaged.
        """
        if not parts:
            raise UserError(f"{folder}: there is no part-*.parquet in it, so the sweep has no finished run yet")
        self.folder, self.parts = folder, [str(part) for part in parts]
        self.connection = duckdb.connect()
        given = list(varied)
        self._view(self.parts)
        described = self._rows("SELECT column_name, column_type FROM (DESCRIBE runs)")
        self._written = {name: Column(name, _kind(declared), name in given) for name, declared, *_ in described}
        self._codes = {name: _code(column) for name, column in self._written.items() if name in CODES}
        self._view(self.parts, self._codes)
        self.columns = {
            name: replace(c, kind=ColumnKind.TEXT if name in self._codes else c.kind, unit=units.get(name, ""))
            for name, c in self._written.items()
        }
        if missing := [name for name in ("run", *given) if name not in self.columns]:
            raise UserError(f"{parts[0]}: this part has other columns than the sweep: {missing[0]} is missing")

    def apply_condition(self, condition: RowCondition) -> None:
        """From now on a run passed if this holds for it, in place of its scenario's expectations.

        Raises:
            UserError: the rows have no such column, or one that cannot be compared so.
        """
        condition.check(pq.read_schema(self.parts[0]))
        holds = " AND ".join(_holds(c, self._written[c.column]) for c in condition.comparisons)
        self._view(self.parts, self._codes | {"passed": holds})

    def column(self, option: str, name: str) -> Column:
        """The column of this name. `option`: what names it, for the message.

        Raises:
            UserError: there is none.
        """
        return choose({n: c for n, c in self.columns.items() if n != "run"}, name, f"column for {option}")

    def ask(self, query: str) -> Answer:
        """The columns of an answer, each with NaN or None where there is no value.

        Raises:
            UserError: a part is damaged.
        """
        with self._name_damaged_part():
            table = self.connection.sql(query).to_arrow_table()
        return {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}

    def do(self, query: str) -> None:
        """Make a table or a view.

        Raises:
            UserError: a part is damaged.
        """
        with self._name_damaged_part():
            self.connection.execute(query)

    def one(self, query: str) -> dict[str, Any]:
        """The only row of an answer."""
        return {name: values[0] for name, values in self.ask(query).items()}

    def _rows(self, query: str) -> list[tuple[Any, ...]]:
        with self._name_damaged_part():
            return list(self.connection.execute(query).fetchall())

    @contextmanager
    def _name_damaged_part(self) -> Iterator[None]:
        try:
            yield
        except duckdb.Error as e:
            raise self._damaged(e) from None

    def _view(self, parts: Sequence[str], instead: Mapping[str, str] = NOTHING) -> None:
        """Make the view of all rows; `instead`: what replaces some columns, by their names."""
        files = ", ".join(map(_file, parts))
        columns = f"* REPLACE ({', '.join(f'{v} AS {name}' for name, v in instead.items())})" if instead else "*"
        self.do(f"CREATE OR REPLACE VIEW runs AS SELECT {columns} FROM read_parquet([{files}])")

    def _damaged(self, error: "duckdb.Error") -> UserError:
        """The message for an error: the part that cannot be read alone, or that has other columns than the first."""
        first = None
        for part in self.parts:
            file = _file(part)
            try:
                self.connection.execute(f"SELECT bit_xor(hash(COLUMNS(*))) FROM read_parquet({file})").fetchall()
                columns = self.connection.execute(f"DESCRIBE SELECT * FROM read_parquet({file})").fetchall()
            except duckdb.Error:
                return UserError(f"{part}: this part is damaged; delete it, and the same sweep makes it again")
            first = first or columns
            if columns != first:
                return UserError(
                    f"{part}: this part has other columns than {Path(self.parts[0]).name}: it is of another sweep"
                )
        return UserError(f"{self.folder}: {str(error).splitlines()[0]}")


def literal(number: float) -> str:
    """A number in a query, with all its bits: DuckDB would take its digits for those of a decimal."""
    return f"'{number!r}'::DOUBLE"


def _holds(comparison: Comparison, column: Column) -> str:
    """A comparison in a query: true or false, also where the row has no value."""
    value = comparison.value
    if column.kind is ColumnKind.NUMBER:
        sides = f"{column.sql}::DOUBLE {comparison.sign} {literal(float(value))}"
        return f"coalesce(NOT isnan({column.sql}::DOUBLE) AND {sides}, false)"
    text = _text(value) if isinstance(value, str) else str(value).lower()
    return f"coalesce({column.sql} {comparison.sign} {text}, false)"


def _code(column: Column) -> str:
    """A code as a text in a query, empty for 0."""
    return f"CASE {column.sql} WHEN 0 THEN '' ELSE {column.sql}::VARCHAR END"


def _file(path: str) -> str:
    """A file in a query: DuckDB would take the characters `*`, `?` and `[` of its path for a pattern."""
    return _text(re.sub(r"([*?[])", r"[\1]", path))


def _text(text: str) -> str:
    """A text in a query."""
    return "'" + text.replace("'", "''") + "'"


def _kind(declared: str) -> ColumnKind:
    return {TRUTH: ColumnKind.TRUTH, TEXT: ColumnKind.TEXT, LIST: ColumnKind.LIST}.get(declared, ColumnKind.NUMBER)
