"""How the values of a column are distributed over the runs of a sweep; of length errors, how capable the process is.

The rows are read twice, some thousand at a time: the memory does not grow with them."""

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from ..scenario.engineering import ROUNDING, engineering
from ..scenario.recording import Reals
from .result_columns import TOLERANCE, TRUE_LENGTH_ERRORS
from .table import Rows

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


def find_distribution(rows: Rows, name: str) -> Distribution | None:
    """The distribution of a column of numbers, or of lists of them; None: no run has a value.

    Raises:
        UserError: there is no such column, or a part file is damaged.
    """
    moments, tolerances = _Moments(), set[float]()
    has_tolerance = name == TRUE_LENGTH_ERRORS and TOLERANCE in rows.schema.names
    for batch in rows.batches([name, TOLERANCE] if has_tolerance else [name]):
        values, runs = _values(batch[name])
        moments.add(values, runs)
        if has_tolerance:
            tolerances |= set(pc.unique(batch[TOLERANCE]).drop_null().to_pylist())
    if not moments.count:
        return None
    bins = np.zeros(BINS, np.int64)
    spread = moments.greatest - moments.least
    capability = _CapabilityEstimate(moments, *tolerances) if len(tolerances) == 1 else None
    for batch in rows.batches([name]):
        values, runs = _values(batch[name])
        shares = (values - moments.least) / spread if spread else np.zeros(len(values))
        np.add.at(bins, np.minimum((BINS * shares).astype(np.int64), BINS - 1), 1)
        if capability:
            capability.add(values, runs)
    m = moments
    result = capability.result() if capability else None
    return Distribution(m.runs, m.count, m.mean, m.sigma, m.least, m.greatest, result, bins)


class _Moments:
    """Count, mean and sigma of values that come in batches: sums of squares are joined as by Chan, Golub and LeVeque,
    "Algorithms for computing the sample variance" (1983)."""

    def __init__(self) -> None:
        self.runs = self.count = 0
        self.mean = self.squares = 0.0  # the sum of the squared differences from the mean
        self.least, self.greatest = math.inf, -math.inf

    def add(self, values: Reals, runs: NDArray[np.int64]) -> None:
        """Add values; `runs`: to which run each belongs."""
        if not len(values):
            return
        count, mean = self.count + len(values), float(values.mean())
        away = mean - self.mean
        self.squares += float(np.square(values - mean).sum()) + away * away * self.count * len(values) / count
        self.mean += away * len(values) / count
        self.count = count
        self.runs += len(np.unique(runs))
        self.least, self.greatest = min(self.least, float(values.min())), max(self.greatest, float(values.max()))

    @property
    def sigma(self) -> float:
        """One standard deviation; 0, without rounding, where all values are the same."""
        if self.count < 2:
            return math.nan
        return math.sqrt(self.squares / (self.count - 1)) if self.least < self.greatest else 0.0


class _CapabilityEstimate:
    """C_pk = (T - |m|) / (3 s) of all errors e together, of mean m and sigma s, and its confidence interval.

    Errors of one run depend on each other: neighbours share a cut, and each run meets the same ramps of its line. The
    runs are independent. So the variance of C_pk is that of the sums over runs of its linearization,

        u = (-sign(m) (e - m) / (3 s) - C_pk / 2 ((e - m)^2 / s^2 - 1)) / n,

    n being the number of errors: R / (R - 1) times the sum of the R runs' squared sums (Wolter, Introduction to
    Variance Estimation, 2nd edition, chapter 6). The interval has the quantiles of Student's distribution with R - 1
    degrees of freedom. With one normal error a run the variance is that of Bissell, "How reliable is your capability
    index?" (Applied Statistics 39, 1990): 1 / (9 n) + C_pk^2 / (2 n)."""

    def __init__(self, moments: _Moments, tolerance: float) -> None:
        self.moments, self.tolerance = moments, tolerance
        margin, sigma = tolerance - abs(moments.mean), moments.sigma
        self.c_pk = margin / (3.0 * sigma) if sigma > ROUNDING * tolerance else math.copysign(math.inf, margin)
        self.squares = 0.0
        self.outside = 0

    def add(self, errors: Reals, runs: NDArray[np.int64]) -> None:
        """Add errors; `runs`: to which run each belongs."""
        m = self.moments
        self.outside += int(np.count_nonzero(np.abs(errors) > self.tolerance))
        if m.sigma > 0.0 and len(errors):
            scaled = (errors - m.mean) / m.sigma
            linear = -np.sign(m.mean) * scaled / 3.0 - 0.5 * self.c_pk * (scaled * scaled - 1.0)
            self.squares += float(np.square(np.bincount(runs, linear / m.count)).sum())

    def result(self) -> Capability:
        """What follows from all errors."""
        runs = self.moments.runs
        if runs < 2 or not math.isfinite(self.c_pk):
            return Capability(self.tolerance, self.outside, self.c_pk, math.nan, math.nan)
        from scipy.special import stdtrit  # noqa: PLC0415 (it takes long to load)

        deviation = math.sqrt(self.squares * runs / (runs - 1))
        reach = deviation * float(stdtrit(runs - 1, 0.5 + 0.5 * CONFIDENCE))
        return Capability(self.tolerance, self.outside, self.c_pk, self.c_pk - reach, self.c_pk + reach)


def _values(column: Any) -> tuple[Reals, NDArray[np.int64]]:
    """The finite values of a batch's column, and the place in the batch of the run to which each belongs."""
    lists = pa.types.is_list(column.type)
    values = np.asarray((column.flatten() if lists else column).cast(pa.float64()).to_numpy(zero_copy_only=False))
    runs = np.asarray(pc.list_parent_indices(column)) if lists else np.arange(len(values))
    is_finite = np.isfinite(values)
    return values[is_finite], runs[is_finite].astype(np.int64)


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
