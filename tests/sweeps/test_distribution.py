"""The distribution of a column over the runs of a sweep, compared with plain NumPy over all values; the confidence
interval of C_pk, compared with many sweeps of one process."""

import math
from collections.abc import Sequence

import duckdb
import numpy as np
import pyarrow as pa
import pytest
from numpy.typing import NDArray

from motionsync_fmu.sweeps.database import Column, ColumnKind, Database
from motionsync_fmu.sweeps.distribution import SHARES, Distribution, find_distribution
from motionsync_fmu.sweeps.summary import Summary

Reals = NDArray[np.float64]
CONNECTION = duckdb.connect(config={"threads": 1})
ERRORS, TOLERANCE = "true_length_errors", 0.1


class Made(Database):
    """The rows of a sweep that are made up."""

    def __init__(self, table: pa.Table) -> None:
        self.connection = CONNECTION.register("runs", table)
        kinds = {
            name: ColumnKind.LIST if pa.types.is_list(table.schema.field(name).type) else ColumnKind.NUMBER
            for name in table.column_names
        }
        self.columns = {name: Column(name, kind, False) for name, kind in kinds.items()}


def distribution_of(
    column: Sequence[object], kind: pa.DataType, tolerances: Sequence[float | None] = ()
) -> Distribution | None:
    if not tolerances:
        return find_distribution(Made(pa.table({"value": pa.array(column, kind)})), "value")
    columns = {ERRORS: pa.array(column, kind), "tolerance": pa.array(tolerances, pa.float64())}
    return find_distribution(Made(pa.table(columns)), ERRORS)


def pooled(runs: Sequence[Sequence[float]], tolerance: float = TOLERANCE) -> Distribution:
    result = distribution_of(runs, pa.list_(pa.float64()), [tolerance] * len(runs))
    assert result
    return result


def test_numbers_are_counted_without_those_that_are_missing_or_infinite() -> None:
    """3, 1, 2, 10: mean 4, sigma sqrt((1 + 9 + 4 + 36) / 3)."""
    d = distribution_of([3.0, None, 1.0, math.inf, 2.0, math.nan, 10.0], pa.float64())
    assert d
    assert (d.runs, d.count, d.mean, d.least, d.greatest, d.worst) == (4, 4, 4.0, 1.0, 10.0, 10.0)
    assert d.sigma == pytest.approx(math.sqrt(50.0 / 3.0), rel=1e-15)
    assert [d.quantile(share) for share in (0.2, 0.5, 0.75, 1.0)] == pytest.approx([1.0, 2.0, 3.0, 10.0], abs=1e-5)
    assert d.capability is None


def test_whole_numbers_and_equal_ones_have_a_distribution() -> None:
    d = distribution_of([3, 3, 3], pa.int64())
    assert d
    assert (d.mean, d.sigma, d.quantile(0.5)) == (3.0, 0.0, 3.0)
    single = distribution_of([-2.5], pa.float64())
    assert single
    assert math.isnan(single.sigma)
    assert (single.worst, single.quantile(0.01)) == (-2.5, -2.5)


def test_without_any_value_there_is_no_distribution() -> None:
    assert distribution_of([None, math.nan], pa.float64()) is None
    assert distribution_of([[], None], pa.list_(pa.float64()), [0.1, None]) is None


def test_the_pieces_of_all_runs_are_counted_together() -> None:
    """Runs with 0 to 8 pieces each; NumPy has all of them at once."""
    random = np.random.default_rng(4)
    runs = [random.normal(0.02, 0.03, int(n)).tolist() for n in random.integers(0, 9, 200)]
    everything = np.concatenate(runs)
    d = pooled(runs)
    assert (d.runs, d.count) == (sum(1 for run in runs if run), len(everything))
    assert (d.mean, d.sigma) == pytest.approx((everything.mean(), everything.std(ddof=1)), rel=1e-12)
    assert d.worst == max(everything.tolist(), key=abs)
    expected = np.quantile(everything, SHARES, method="inverted_cdf")
    assert [d.quantile(share) for share in SHARES] == pytest.approx(expected.tolist(), abs=2e-6 * np.ptp(everything))
    assert d.capability
    assert d.capability.outside == np.count_nonzero(np.abs(everything) > TOLERANCE)
    c_pk = min(TOLERANCE - everything.mean(), TOLERANCE + everything.mean()) / (3.0 * everything.std(ddof=1))
    assert d.capability.c_pk == pytest.approx(c_pk, rel=1e-12)


def test_a_capability_needs_one_tolerance() -> None:
    lists = pa.list_(pa.float64())
    d = distribution_of([[0.01], [0.02]], lists, [0.1, 0.2])
    assert d
    assert d.capability is None
    refused = distribution_of([[0.01, 0.03], None, [0.02]], lists, [0.1, None, 0.1])
    assert refused
    assert refused.capability
    assert refused.capability.c_pk == pytest.approx((0.1 - 0.02) / (3.0 * 0.01))


def test_equal_errors_and_a_single_run_have_no_interval() -> None:
    equal = pooled([[0.02, 0.02], [0.02]]).capability
    assert equal
    assert (equal.c_pk, equal.interval) == (math.inf, "")
    single = pooled([[0.01, 0.02, 0.03]]).capability
    assert single
    assert single.c_pk == pytest.approx(0.08 / 0.03)
    assert single.interval == ""
    text = pooled([[0.01], [0.02], [0.04]]).as_json()
    assert text["capability"]["c_pk"] == pytest.approx((0.1 - 0.07 / 3.0) / (3.0 * math.sqrt(7.0 / 3.0) * 0.01))
    assert math.isnan(equal.high)
    assert pooled([[0.02]]).as_json()["sigma"] is None


@pytest.mark.parametrize("bits", [1, 7, 100])
@pytest.mark.parametrize(
    ("mean", "c_pk"), [(0.0, math.inf), (0.9 * TOLERANCE, math.inf), (-1.1 * TOLERANCE, -math.inf)]
)
def test_errors_that_differ_by_rounding_have_no_capability(bits: int, mean: float, c_pk: float) -> None:
    """They come from positions of about 1000, whose last bit is 1.1e-13."""
    runs = [[mean + bits * 1.1e-13 * sign for sign in (0.0, 1.0, -1.0)] for _ in range(4)]
    capability = pooled(runs).capability
    assert capability
    assert (capability.c_pk, capability.interval) == (c_pk, "")
    lines = list(Summary(true_length_errors=pooled(runs)).true_length_lines("mm"))
    assert not any("C_pk" in line for line in lines)


def test_one_normal_error_a_run_has_the_interval_of_bissell() -> None:
    """C_pk +- 1.96 sqrt(1 / (9 n) + C_pk^2 / (2 n)), for many runs."""
    errors = np.random.default_rng(2).normal(0.02, 0.01, 200_000)
    c = pooled(errors[:, None].tolist()).capability
    assert c
    half = 1.959964 * math.sqrt(1.0 / (9.0 * len(errors)) + c.c_pk**2 / (2.0 * len(errors)))
    assert (c.high - c.c_pk, c.c_pk - c.low) == pytest.approx((half, half), rel=0.01)


def sweep(random: np.random.Generator, runs: int, ramp: float) -> Reals:
    """The length errors of runs, shape (runs, 12): cuts are off by normal errors of 0.01, a length by the difference of
    two neighbours; the same two pieces of each run, on a ramp, are off by `ramp` and -ramp in addition. All are too
    long by 0.01."""
    cuts = random.normal(0.0, 0.01, (runs, 13))
    profile = np.zeros(12)
    profile[5:7] = ramp, -ramp
    return np.diff(cuts, axis=1) + profile + 0.01


@pytest.mark.parametrize(("runs", "ramp"), [(15, 0.0), (60, 0.0), (60, 0.1), (8, 0.1)])
def test_95_of_100_sweeps_have_the_true_capability_in_their_interval(runs: int, ramp: float) -> None:
    """The variance of a length is 2 0.01^2, and ramp^2 / 6 of the pieces on the ramp; so the true C_pk is known. The
    interval of independent errors would be met in too few of the sweeps, or in all of them."""
    random = np.random.default_rng(11)
    sigma = math.sqrt(2.0 * 0.01**2 + ramp**2 / 6.0)
    true = (TOLERANCE - 0.01) / (3.0 * sigma)
    sweeps = 300
    hits = independent = 0
    for _ in range(sweeps):
        errors = sweep(random, runs, ramp)
        c = pooled(errors.tolist()).capability
        assert c
        hits += c.low < true < c.high
        n = errors.size
        bissell = 1.959964 * math.sqrt(1.0 / (9.0 * n) + c.c_pk**2 / (2.0 * n))
        independent += abs(c.c_pk - true) < bissell
    assert 0.92 <= hits / sweeps <= 0.98
    assert not 0.93 <= independent / sweeps <= 0.97
