"""How the values of a column are distributed over the runs of a sweep; of length errors, how capable the process is.

DuckDB counts the values, so memory does not grow with them."""

import math
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scenario.engineering import ROUNDING, engineering
from .database import ColumnKind, Database, literal
from .result_columns import TOLERANCE, TRUE_LENGTH_ERRORS

BINS = 1_000_000  # between the least and the greatest value: so exact are quantiles
CONFIDENCE = 0.95  # of the interval of a process capability
SHARES = (0.001, 0.005, 0.05, 0.25, 0.5, 0.75, 0.95, 0.995, 0.999)  # of the quantiles that are shown
FINER = 3  # decimal places more than the first digit of sigma has: so exact are values shown
MOST = (0.005, 0.995)  # the quantiles between which 99 % of the values lie


@dataclass(frozen=True)
class Capability:
    """The process capability of length errors.

    Attributes:
        tolerance: how far a length may be off.
        outside: how many are farther off.
        c_pk: the distance of the mean from the nearer end of the tolerance, over 3 sigma; infinite where sigma is
            rounding.
        low, high: the ends of its confidence interval; NaN for a single run.
    """

    tolerance: float
    outside: int
    c_pk: float
    low: float
    high: float

    @property
    def interval(self) -> str:
        """The confidence interval in words; empty: there is none."""
        if not math.isfinite(self.low):
            return ""
        return f"{self.low:.2f} to {self.high:.2f} with {100.0 * CONFIDENCE:g} % confidence"


@dataclass(frozen=True)
class Distribution:
    """The values of a column that are finite.

    Attributes:
        runs: the runs that have any.
        count: how many values there are: one a run, or one for each piece of a run.
        sigma: one standard deviation, estimated; NaN for a single value.
        capability: that of true length errors with one tolerance; else None.
        counts: how many values there are in each of the bins between `least` and `greatest`.
    """

    runs: int
    count: int
    mean: float
    sigma: float
    least: float
    greatest: float
    capability: Capability | None
    counts: NDArray[np.int64] = field(repr=False)

    @property
    def worst(self) -> float:
        """The value that is farthest from 0."""
        return max(self.least, self.greatest, key=abs)

    def quantile(self, share: float) -> float:
        """The least value that this share of all values does not exceed, to a millionth of their spread."""
        place = np.searchsorted(np.cumsum(self.counts), share * self.count)
        middle = self.least + (self.greatest - self.least) * (float(place) + 0.5) / BINS
        return min(max(middle, self.least), self.greatest)

    def shown(self, value: float, unit: str) -> str:
        """A value to a thousandth of sigma, with its unit."""
        if not self.sigma > 0.0:
            return engineering(value, unit)
        places = max(FINER - math.floor(math.log10(self.sigma)) - 1, 0)
        return f"{round(value, places) + 0.0:.{places}f} {unit}".rstrip()

    def as_json(self) -> dict[str, Any]:
        """All of it but the bins, by its names, with the quantiles; what is not known is None."""
        values = asdict(self) | {"quantiles": {f"{share:g}": self.quantile(share) for share in SHARES}}
        del values["counts"]
        nested = {name: _finite(value) for name, value in values.items()}
        if self.capability:
            nested["capability"] = {name: _finite(value) for name, value in asdict(self.capability).items()}
        return nested


def find_distribution(db: Database, name: str) -> Distribution | None:
    """The distribution of a column of numbers, or of lists of them; None: no run has a value.

    Raises:
        UserError: a part file is damaged.
    """
    column = db.columns[name]
    numbers = column.sql if column.kind is ColumnKind.LIST else f"[{column.sql}::DOUBLE]"
    db.do(f"CREATE OR REPLACE VIEW numbers AS SELECT [x FOR x IN {numbers} IF isfinite(x)] AS numbers FROM runs")
    m = db.one("""
        SELECT count(*) AS count, avg(v) AS mean, stddev_samp(v) AS sigma, min(v) AS least, max(v) AS greatest,
            (SELECT count(*) FROM numbers WHERE len(numbers) > 0) AS runs
        FROM (SELECT unnest(numbers) AS v FROM numbers)""")
    if not m["count"]:
        return None
    runs, count = int(m["runs"]), int(m["count"])
    mean, sigma, least, greatest = (float(m[key]) for key in ("mean", "sigma", "least", "greatest"))
    spread = greatest - least
    if count > 1 and not spread:
        mean, sigma = least, 0.0  # without rounding
    place = f"least(floor({BINS} * (v - {literal(least)}) / {literal(spread)}), {BINS - 1})::INTEGER" if spread else "0"
    bins = db.ask(f"SELECT {place} AS bin, count(*) AS n FROM (SELECT unnest(numbers) AS v FROM numbers) GROUP BY bin")
    counts = np.zeros(BINS, np.int64)
    counts[bins["bin"]] = bins["n"]
    result = Distribution(runs, count, mean, sigma, least, greatest, None, counts)
    if name != TRUE_LENGTH_ERRORS or TOLERANCE not in db.columns:
        return result
    tolerances = db.ask(f"SELECT DISTINCT {TOLERANCE} AS t FROM runs WHERE {TOLERANCE} IS NOT NULL")["t"].tolist()
    return replace(result, capability=_find_capability(db, result, *tolerances)) if len(tolerances) == 1 else result


def _find_capability(db: Database, d: Distribution, tolerance: float) -> Capability:
    """C_pk = (T - |m|) / (3 s) of all errors e together, of mean m and sigma s, and its confidence interval.

    Errors of one run depend on each other: neighbours share a cut, and each run meets the same ramps of its line. The
    runs are independent. So the variance of C_pk is that of the sums over runs of its linearization,

        u = (-sign(m) (e - m) / (3 s) - C_pk / 2 ((e - m)^2 / s^2 - 1)) / n,

    n being the number of errors: R / (R - 1) times the sum of the R runs' squared sums (Wolter, Introduction to
    Variance Estimation, 2nd edition, chapter 6). The interval has the quantiles of Student's distribution with R - 1
    degrees of freedom. With one normal error a run the variance is that of Bissell, "How reliable is your capability
    index?" (Applied Statistics 39, 1990): 1 / (9 n) + C_pk^2 / (2 n)."""
    margin = tolerance - abs(d.mean)
    c_pk = margin / (3.0 * d.sigma) if d.sigma > ROUNDING * tolerance else math.copysign(math.inf, margin)
    beyond = f"[e FOR e IN numbers IF abs(e) > {literal(tolerance)}]"
    outside = int(db.one(f"SELECT sum(len({beyond})) AS n FROM numbers")["n"])
    if d.runs < 2 or not math.isfinite(c_pk):
        return Capability(tolerance, outside, c_pk, math.nan, math.nan)
    from scipy.special import stdtrit  # noqa: PLC0415 (it takes long to load)

    scaled = f"(e - {literal(d.mean)}) / {literal(d.sigma)}"
    linear = (
        f"({-math.copysign(1.0, d.mean) / 3.0!r} * {scaled} - {0.5 * c_pk!r} * (({scaled}) ** 2 - 1.0)) / {d.count}"
    )
    squares = db.one(f"SELECT sum(list_sum([{linear} FOR e IN numbers]) ** 2) AS sum FROM numbers")["sum"]
    deviation = math.sqrt(float(squares) * d.runs / (d.runs - 1))
    reach = deviation * float(stdtrit(d.runs - 1, 0.5 + 0.5 * CONFIDENCE))
    return Capability(tolerance, outside, c_pk, c_pk - reach, c_pk + reach)


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
