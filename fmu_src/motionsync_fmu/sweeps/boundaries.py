"""What a search looks for, and the rows that it finds: a boundary for each point of a sweep's grid.

All points of a chunk are looked at together. Each round runs every point once, at the middle of what is left of its
range.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self, Unpack

import numpy as np
import pyarrow as pa

from ..errors import UserError
from ..scenario.files.toml_tables import read_toml
from ..scenario.variation.scenario_variation import ScenarioVariation
from ..scenario.variation.values import Range, read_values
from .bisection import Boundaries, Flags, Indices, Reals, bisect
from .conditions import RowCondition
from .measures import check_measures
from .result_columns import measure_columns, schema
from .rows import rows_with
from .sweep_plan import FILE, SEARCH, SamplingOptions, SweepPlan

POINT, OTHER_SIDE, HOLDS, REFUSAL, RUNS = "point", "beside", "holds", "refusal", "runs"
ABOVE, BELOW, BOTH, NEITHER = "above", "below", "at both ends", "at neither end"
FINEST = 1e-15  # relative: of finer values there are none
ENDS = "NAME=low..high, as in: --vary length=300..3000"


@dataclass(frozen=True)
class Search:
    """What a search looks for.

    Attributes:
        plan: a sweep over the grid at both ends of the range: what is varied is its first factor, with two values.
        until: the condition on a row.
        relative: how far apart the values on both sides of a boundary may be, as a share of their magnitude.
        chunk: how many points are looked at together; 0: as many as take some seconds.
    """

    plan: SweepPlan
    until: str
    relative: float
    chunk: int = 0

    @classmethod
    def of(
        cls,
        file: Path,
        vary: str,
        until: str,
        settings: Iterable[str] = (),
        *,
        relative: float = 1e-6,
        **options: Unpack[SamplingOptions],
    ) -> Self:
        """The search in a scenario's file, along `vary`, a text `NAME=low..high`, until a condition holds, for settings
        `NAME=VALUES` as those of a sweep. The condition may name measures that are not among those of the options.

        Raises:
            UserError: the file, the range, the condition, a setting, or what they make together is refused.
        """
        if not FINEST <= relative < 1.0:
            raise UserError(f"--relative {relative:g} is not allowed: it must be from {FINEST:g} to below 1")
        variation = ScenarioVariation.of_file(file)
        name, ends = _range(vary, variation)
        plan = SweepPlan.of_variation(variation, [f"{name}={ends.low!r},{ends.high!r}", *settings], **options)
        condition = RowCondition.read(until)
        missing = [name for name in condition.columns if name not in schema(plan).names]
        plan = plan.with_fields(measures=_with_measures(plan, missing))
        condition.check(schema(plan))
        return cls(plan, until, relative)

    @property
    def name(self) -> str:
        """What is varied."""
        return self.plan.factors[0].name

    @property
    def runs(self) -> int:
        """The number of points."""
        return self.plan.runs // 2

    @cached_property
    def condition(self) -> RowCondition:
        return RowCondition.read(self.until)

    @cached_property
    def range(self) -> tuple[float, float]:
        """The two ends."""
        low, high = (float(self.plan.values(run, run + 1)[self.name][0]) for run in (0, self.runs))
        return low, high

    @cached_property
    def schema(self) -> pa.Schema:
        """The columns of the rows: the point's number and values, the boundary and the value beside it, on which side
        the condition holds, why the run beside was refused, the number of runs, and the measures of the run at the
        boundary."""
        row_schema = schema(self.plan)
        grid = {factor.name: row_schema.field(factor.name).type for factor in self.plan.factors[1:]}
        boundary = {self.name: pa.float64(), f"{self.name}.{OTHER_SIDE}": pa.float64(), HOLDS: pa.string()}
        measured = dict.fromkeys(measure_columns(self.plan.measures), pa.float64())
        return pa.schema({POINT: pa.int64()} | grid | boundary | {REFUSAL: pa.string(), RUNS: pa.int64()} | measured)

    def write(self, folder: Path) -> None:
        """Write `plan.toml` and a copy of the scenario's file.

        Raises:
            UserError: they cannot be written.
        """
        own = {"until": self.until, "relative": self.relative}
        replace(self.plan, chunk=self.chunk).write(folder, **{SEARCH: own})

    @classmethod
    def read(cls, folder: Path) -> Self:
        """The search in a folder.

        Raises:
            UserError: there is none, or its plan is damaged.
        """
        plan = SweepPlan.read(folder, SEARCH)
        table = read_toml(folder / FILE).table(SEARCH)
        table.allow_only("until", "relative")
        return cls(plan, table.string("until"), table.number("relative"), plan.chunk)

    def differs(self, other: "Search") -> str:
        """What this search has otherwise than the other one, in one sentence; empty if both give the same rows."""
        differences = [self.plan.differs(other.plan)]
        differences += [
            f"{name} is {own}, not {others}"
            for name in ("until", "relative")
            if (own := getattr(self, name)) != (others := getattr(other, name))
        ]
        return "; ".join(filter(None, differences))


def boundaries(search: Search, first: int, last: int) -> pa.Table:
    """The rows of the points from `first` up to, but not including, `last`; its columns are those of the schema."""
    points = _Points(search, first, last)
    result = bisect(points.holds, last - first, *search.range, search.relative)
    columns = {
        POINT: np.arange(first, last),
        **points.grid,
        search.name: result.holding,
        f"{search.name}.{OTHER_SIDE}": result.other,
        HOLDS: _sides(result),
        REFUSAL: points.refusals,
        RUNS: result.runs,
        **{
            name: np.where(np.isnan(result.holding), np.nan, column_values)
            for name, column_values in points.boundary_values.items()
        },
    }
    return pa.table([pa.array(columns[f.name], f.type, from_pandas=True) for f in search.schema], schema=search.schema)


class _Points:
    """The points of a chunk, run at one value each.

    Attributes:
        grid: the values that do not depend on what is varied, by column.
        columns: of each point's last run for which the condition held, the measures and what follows from the varied
            value, NaN before it held; by column.
        refusals: why each point's last run for which it did not hold was refused; empty: it was not.
    """

    def __init__(self, search: Search, first: int, last: int) -> None:
        self._search = search
        low, high = (search.plan.values(first + at, last + at) for at in (0, search.runs))
        self._values = low
        self.grid = {name: values for name, values in low.items() if np.array_equal(values, high[name])}
        following = [name for name in low if name not in (*self.grid, search.name)]
        columns = [*following, *measure_columns(search.plan.measures)]
        self.boundary_values = {name: np.full(last - first, np.nan) for name in columns}
        self.refusals = np.full(last - first, "", dtype=object)

    def holds(self, points: Indices, values: Reals) -> Flags:
        """Whether the condition holds for the rows of some points, at a value each."""
        plan, condition = self._search.plan, self._search.condition
        given = {name: column[points] for name, column in self._values.items()} | {self._search.name: values}
        rows = rows_with(plan, plan.complete(given), [*condition.columns, *self.boundary_values, REFUSAL])
        held = condition.holds(rows).to_numpy()
        for name, column_values in self.boundary_values.items():
            column_values[points[held]] = rows[name].to_numpy()[held]
        self.refusals[points[~held]] = rows[REFUSAL].to_numpy()[~held]
        return np.asarray(held)


def _sides(result: Boundaries) -> list[str]:
    """On which side of its boundary the condition holds, or that there is none, for each point."""
    sides = {(False, True): ABOVE, (True, False): BELOW, (True, True): BOTH, (False, False): NEITHER}
    return [sides[at] for at in zip(result.at_low.tolist(), result.at_high.tolist(), strict=True)]


def _range(vary: str, variation: ScenarioVariation) -> tuple[str, Range]:
    """The name in `NAME=low..high`, and the two numbers in its unit in the scenario."""
    name, equals, text = (part.strip() for part in vary.partition("="))
    if not (name and equals and text):
        raise UserError(f"--vary {vary}: write {ENDS}")
    kind = variation.target(name).kind
    if kind.name not in ("Real", ""):
        raise UserError(
            f"--vary {vary}: {name} is no real number, but of the type {kind.name}: there is nothing to halve"
        )
    try:
        values = read_values(text, kind)
    except UserError as e:
        raise UserError(f"--vary {vary}: {e}") from None
    if not isinstance(values, Range):
        raise UserError(f"--vary {vary}: {text} is no range: write {ENDS}")
    return name, values


def _with_measures(plan: SweepPlan, columns: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The plan's measures, and those that further columns are named after; what is none is left out."""
    measures_by_output = dict(plan.measures)
    outputs = plan.variation.scenario.recipe.variables
    for column in columns:
        if name := max((n for n in outputs if column.startswith(f"{n}.")), key=len, default=""):
            measures_by_output[name] = (*measures_by_output.get(name, ()), column.removeprefix(f"{name}."))
    return check_measures(measures_by_output, plan.variation.scenario.recipe)
