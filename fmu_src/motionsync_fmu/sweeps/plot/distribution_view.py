"""What a page shows of one column alone: the histogram of its values, their quantiles, and of true length errors how
capable the process is, and how much that differs from run to run."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...errors import UserError
from ...pages.report.histogram import Histogram, bar_borders
from ...scenario.engineering import engineering
from ..conditions import RowCondition
from ..database import Answer, Column, ColumnKind, Database, literal
from ..distribution import MOST, SHARES, Distribution, find_distribution
from ..result_columns import TRUE_LENGTH_ERRORS, TRUE_PIECES
from ..table import Rows
from .cells import Axis
from .example_runs import ExampleRuns
from .view import Question, count_runs

HEIGHT = 300  # px
PER_RUN = {  # of a run with true lengths: what its figures are called, and how they are computed from its row
    "greatest length error": "abs(true_length_worst)",
    "sigma of the lengths": "true_length_sigma",
    "process capability": "c_pk",
    "movement of the blade in the cut": "cut_movement",
}
PER_RUN_SHARES = {"least": 0.0, "5 %": 0.05, "median": 0.5, "95 %": 0.95, "greatest": 1.0}


@dataclass(frozen=True)
class Table:
    """A table of a page: its heading, what it shows, the names of its columns, and the texts of its rows."""

    heading: str
    text: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass
class DistributionView:
    """The distribution of a column.

    Attributes:
        column: whose values it has.
        x: the bars of the histogram.
        bars: for each bar that has values: its number `cx`, how many values are in it, of how many `runs`, and the run
            with the value that is farthest from the mean, `pick`.
        runs: how many runs there are, and how many of them passed, are refused, have no value.
        run_quantiles: of the figures of `PER_RUN`, those of the runs; empty where rows have no true lengths.
    """

    column: Column
    values: Distribution
    x: Axis
    bars: Answer
    runs: dict[str, int]
    condition: RowCondition | None
    run_quantiles: dict[str, list[float]] = field(default_factory=dict)
    examples: ExampleRuns = field(default_factory=ExampleRuns)

    @property
    def counted(self) -> str:
        """What is counted: the products of all runs, or the runs."""
        return "products" if self.column.kind is ColumnKind.LIST else "runs"

    @property
    def name(self) -> str:
        """The quantity in words, where it has a name in words."""
        return "true length error" if self.column.name == TRUE_LENGTH_ERRORS else self.column.name

    def histogram(self) -> Histogram:
        """The histogram of all values."""
        counts = np.zeros(len(self.x), np.int64)
        counts[self.bars["cx"].astype(int)] = self.bars["count"]
        d = self.values
        tolerance = d.capability.tolerance if d.capability else None
        unit = self.column.unit
        return Histogram(self.name, unit, self.counted, self.x.edges, counts.tolist(), d.mean, d.sigma, tolerance)

    def shown(self, value: float) -> str:
        """A value with the unit of the column."""
        return self.values.shown(value, self.column.unit)

    def shown_columns(self, db: Database) -> list[Column]:
        """The results of a run that the page shows with it."""
        names = (*TRUE_PIECES, "cuts") if self.column.kind is ColumnKind.LIST else (self.column.name,)
        return [db.columns[name] for name in names if name in db.columns and name != self.column.name]

    def tables(self) -> Iterator[Table]:
        """The tables of the page."""
        d = self.values
        rows = [(f"{100.0 * share:g} %", self.shown(d.quantile(share))) for share in SHARES]
        yield Table(
            "Quantiles",
            f"So many of the {self.counted} have at most this {self.name}.",
            [f"share of the {self.counted}", self.name],
            [*rows, ("100 %", self.shown(d.greatest))],
        )
        if self.run_quantiles:
            yield Table(
                "From run to run",
                "Each run has figures of its own, as motionsync run gives them: 5 % of the runs are below the second"
                " value, and 95 % below the fourth.",
                ["figure of a run", *PER_RUN_SHARES],
                [
                    (name, *(engineering(value, "" if "c_pk" in PER_RUN[name] else self.column.unit) for value in row))
                    for name, row in self.run_quantiles.items()
                ],
            )


def build_distribution(db: Database, rows: Rows, question: Question) -> DistributionView:
    """The distribution of the column `x` of a question.

    Raises:
        UserError: there is no such column, it has no numbers, or the question asks for more than one column.
    """
    options = {"--colour": question.colour, "--amount": question.amount, "--better": question.better}
    for option, value in (options | {"--beside": ", ".join(question.comparisons)}).items():
        if value:
            raise UserError(f"{option} {value}: a page of one column has none; add --y")
    condition = RowCondition.read(question.passed) if question.passed else None
    if condition:
        db.apply_condition(condition)
    column = db.column("--x", question.x)
    if column.kind not in (ColumnKind.NUMBER, ColumnKind.LIST):
        raise UserError(f"--x {column.name}: this column has {column.kind.value}; --x takes one with numbers")
    values = find_distribution(db, column.name)
    if values is None:
        raise UserError(f"{column.name} has no value in any run")
    x, bars = _bars(db, column, values)
    counts = count_runs(db) | {"without": len(rows) - values.runs}
    view = DistributionView(column, values, x, bars, counts, condition)
    if column.name == TRUE_LENGTH_ERRORS:
        view.run_quantiles = _run_quantiles(db)
    view.examples.add(bars["pick"])
    return view


def _bars(db: Database, column: Column, values: Distribution) -> tuple[Axis, Answer]:
    borders = bar_borders(values.least, values.greatest, values.count, abs(values.worst))
    first, width, bars = float(borders[0]), float(borders[1] - borders[0]), len(borders) - 1
    cell = f"greatest(least(floor((v - {literal(first)}) / {literal(width)}), {bars - 1}), 0)::INTEGER"
    value = f"unnest({column.sql})" if column.kind is ColumnKind.LIST else column.number
    answer = db.ask(f"""
        SELECT {cell} AS cx, count(*) AS count, count(DISTINCT run) AS runs,
            arg_max(run, (abs(v - {literal(values.mean)}), -run)) AS pick
        FROM (SELECT run, {value} AS v FROM runs) WHERE isfinite(v) GROUP BY cx ORDER BY cx""")
    return Axis(column, borders, borders[:-1], borders[1:], cell), answer


def _run_quantiles(db: Database) -> dict[str, list[float]]:
    shares = ", ".join(map(str, PER_RUN_SHARES.values()))
    figures = ", ".join(
        f"quantile_cont({value}, [{shares}]) FILTER (isfinite({value})) AS f{i}"
        for i, value in enumerate(PER_RUN.values())
    )
    row = db.one(f"SELECT {figures} FROM runs")
    quantiles = {name: row[f"f{i}"] for i, name in enumerate(PER_RUN)}
    return {name: [*map(float, values)] for name, values in quantiles.items() if values is not None}


def distribution_figures(view: DistributionView) -> Iterator[tuple[str, str, str]]:
    """Names, values and notes: the distribution at a glance."""
    d, shown = view.values, view.shown
    low, high = (d.quantile(share) for share in MOST)
    if c := d.capability:
        allowed = engineering(c.tolerance, view.column.unit)
        yield view.counted, _grouped(d.count), f"{_grouped(c.outside)} out of tolerance, ±{allowed}"
    yield f"mean {view.name}", shown(d.mean), f"one sigma is {shown(d.sigma)}" if d.count > 1 else ""
    yield f"99 % of the {view.counted}", f"{shown(low)} to {shown(high)}", f"the farthest from 0 is {shown(d.worst)}"
    if c:
        if not math.isfinite(c.c_pk):
            yield "process capability", "none", f"the {view.counted} are all the same, but for rounding"
            return
        without = "a confidence interval needs several runs" if d.runs == 1 else ""
        yield "process capability", f"C_pk {c.c_pk:.2f}", c.interval or without


def distribution_text(view: DistributionView) -> str:
    """What the histogram shows."""
    d, c = view.values, view.values.capability
    text = f"A bar shows how many {view.counted} have a {view.name} in its range."
    if d.sigma > 0.0:
        text += " The curve is the normal distribution with the same mean and sigma."
    if c is None:
        return text
    text += " Red bars, beyond the dotted lines, are out of tolerance."
    if not math.isfinite(c.c_pk):
        return text
    text += f" C_pk is {c.c_pk:.2f}: from the mean to"
    text += " the nearer end of the tolerance it is so many times 3 sigma; customers often ask for 1.33."
    if c.interval:
        text += f" These runs are a sample of all that could be: C_pk is {c.interval}. Lengths of one run depend on"
        text += " each other, since neighbours share a cut; so the interval follows from how the runs differ."
    return text


def _grouped(number: int) -> str:
    return f"{number:,}".replace(",", "\N{NARROW NO-BREAK SPACE}")
