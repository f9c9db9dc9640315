"""Columns divided into cells, and what the runs in a cell have in common."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import UserError
from ...scenario.recording import Reals
from ..database import Answer, Column, ColumnKind, Database, literal

DISTINCT = 4000  # a column with more values than this is divided evenly, whatever its values are
RUNS_A_CELL = 8  # on average, of a plane that is divided evenly
FEWEST = 10  # cells of a column that is divided evenly


@dataclass(frozen=True)
class Axis:
    """A column divided into cells.

    Attributes:
        edges: where the cells begin, and where the last one ends; shape (cells + 1,).
        low, high: the least and the greatest value in each cell, or its edges if the column is divided evenly.
        cell: the number of a run's cell, in a query; NULL if the run has no value.
        names: what each cell is called, for a column of texts or of true and false; empty for numbers.
    """

    column: Column
    edges: Reals
    low: Reals
    high: Reals
    cell: str
    names: Sequence[str] = ()

    def __len__(self) -> int:
        return len(self.low)

    @property
    def single(self) -> bool:
        """Whether all runs in a cell have the same value."""
        return bool(np.all(self.low == self.high))

    @property
    def middle(self) -> Reals:
        """The value that stands for each cell."""
        return np.asarray(0.5 * (self.low + self.high))


def divide_into_cells(db: Database, column: Column, role: str, most: int, fewer: int = 0) -> Axis:
    """Divide a column into at most so many cells.

    Few values have a cell each, more of them are put together one after the other, and a column with a great many is
    divided evenly. `role`: a name for the table of the cells; `fewer`: the number of cells if there are more values
    than `most`, 0: `most`.

    Raises:
        UserError: no run has a value, or they are too many texts.
    """
    value = column.number if column.kind is ColumnKind.NUMBER else column.sql
    many = db.one(f"SELECT approx_count_distinct({value}) AS n, count({value}) AS runs FROM runs")
    if not many["runs"]:
        raise UserError(f"{column.name} has no value in any run")
    if many["n"] > 1.5 * DISTINCT:
        return _evenly(db, column, min(fewer or most, max(FEWEST, int(np.sqrt(many["runs"] / RUNS_A_CELL)))))
    distinct = db.ask(f"SELECT DISTINCT {value} AS value FROM runs WHERE value IS NOT NULL ORDER BY value")["value"]
    if column.kind is not ColumnKind.NUMBER:
        return _named(
            db, column, role, [str(v).lower() if column.kind is ColumnKind.TRUTH else str(v) for v in distinct], most
        )
    together = 1 if len(distinct) <= most else -(-len(distinct) // (fewer or most))
    low, high = (
        distinct[::together],
        np.append(distinct[together - 1 :: together], distinct[-1:])[: -(-len(distinct) // together)],
    )
    return Axis(column, _edges(low, high), low, high, _number_cells(db, role, value, together))


def _number_cells(db: Database, role: str, value: str, together: int) -> str:
    """Make a table with the cell of each value, so many values together; return the cell of a run, in a query."""
    db.do(
        f"CREATE OR REPLACE TEMP TABLE cells_{role} AS SELECT value, ((row_number() OVER (ORDER BY value)) - 1) //"
        f" {together} AS cell FROM (SELECT DISTINCT {value} AS value FROM runs) WHERE value IS NOT NULL"
    )
    return f"(SELECT cell FROM cells_{role} AS c WHERE c.value = {value})"


def _named(db: Database, column: Column, role: str, names: list[str], most: int) -> Axis:
    if len(names) > most:
        raise UserError(
            f"{column.name} has {len(names)} different texts, more than the {most} that can be distinguished"
        )
    positions = np.arange(len(names), dtype=float)
    edges = np.arange(len(names) + 1, dtype=float) - 0.5
    return Axis(column, edges, positions, positions, _number_cells(db, role, column.sql, 1), names)


def _evenly(db: Database, column: Column, cells: int) -> Axis:
    ends = db.one(f"SELECT min({column.number}) AS low, max({column.number}) AS high FROM runs")
    edges: Reals = np.linspace(ends["low"], ends["high"], cells + 1, dtype=np.float64)
    low, high = float(edges[0]), float(edges[-1])
    share = f"({column.number} - {literal(low)}) / {literal(high - low)}"
    cell = f"least(floor({share} * {cells}), {cells - 1})::INTEGER"
    return Axis(column, edges, edges[:-1], edges[1:], cell)


def _edges(low: Reals, high: Reals) -> Reals:
    """Cells meet in the middle between their values; the outer ones are as wide outwards as inwards."""
    if len(low) == 1:
        margin = 0.5 * float(high[0] - low[0]) or 0.5 * abs(float(low[0])) or 0.5
        return np.array([float(low[0]) - margin, float(high[0]) + margin])
    between = 0.5 * (high[:-1] + low[1:])
    first, last = between[0] - low[0], high[-1] - between[-1]
    return np.concatenate([[low[0] - first], between, [high[-1] + last]])


@dataclass(frozen=True)
class CellStatistic:
    """The statistic of a column's values in a cell.

    Attributes:
        name: mean, min, max, share, count, or the most frequent text ("most").
        column: None for the count.
    """

    name: str
    column: Column | None

    @property
    def value(self) -> str:
        """The value of one run, in a query."""
        if self.column is None:
            return "1.0"
        return f"nullif({self.column.sql}, '')" if self.column.kind is ColumnKind.TEXT else self.column.number

    @property
    def together(self) -> str:
        """The value of a cell, from the values v of its runs."""
        return {"min": "min(v)", "max": "max(v)", "count": "count(*)", "most": "mode(v)"}.get(self.name, "avg(v)")

    @property
    def away(self) -> str:
        """How far a run with the value v is from the value of its cell, `together`: the nearest one represents it."""
        if self.name == "most":
            return "(v IS DISTINCT FROM together)::INTEGER"
        if self.name == "share":  # a run that did not pass is worth more
            return "v"
        return "0" if self.name == "count" else "coalesce(abs(v - together), 'inf'::DOUBLE)"


def choose_statistic(column: Column | None, asked: str = "") -> CellStatistic:
    """The statistic of a column: the requested one, else the one that suits the column.

    Raises:
        UserError: the column has no such amount.
    """
    if column is None or asked == "count":
        return CellStatistic("count", None)
    usual = {ColumnKind.NUMBER: "mean", ColumnKind.TRUTH: "share", ColumnKind.TEXT: "most"}[column.kind]
    if asked and column.kind is not ColumnKind.NUMBER:
        raise UserError(f"{column.name} has {column.kind.value}, which have no {asked}")
    return CellStatistic(asked or usual, column)


def plane(db: Database, x: Axis, y: Axis, statistic: CellStatistic) -> Answer:
    """The cells of a plane in which there are runs.

    The answer has for each cell: its numbers `cx` and `cy`, how many `runs` are in it, its `value`, the `least` and the
    `greatest` value (NaN for texts), and `pick`, the number of the run that represents it."""
    extremes = (
        "NULL::DOUBLE AS least, NULL::DOUBLE AS greatest"
        if statistic.name == "most"
        else ("min(v) AS least, max(v) AS greatest")
    )
    return db.ask(f"""
        WITH placed AS (SELECT run, {x.cell} AS cx, {y.cell} AS cy, {statistic.value} AS v FROM runs),
        cells AS (
            SELECT cx, cy, count(*) AS runs, {statistic.together} AS together, {extremes} FROM placed
            WHERE cx IS NOT NULL AND cy IS NOT NULL GROUP BY cx, cy)
        SELECT cx, cy, any_value(runs) AS runs, any_value(together) AS value, any_value(least) AS least,
            any_value(greatest) AS greatest, arg_min(run, ({statistic.away}, run)) AS pick
        FROM placed JOIN cells USING (cx, cy) GROUP BY cx, cy ORDER BY cx, cy""")
