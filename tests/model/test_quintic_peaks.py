"""The greatest derivatives of a quintic, against those of the oracle's quintic through the same six values."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.motion.laws import Quintic
from motionsync.motion.quintic_peaks import QuinticPeaks
from tests.oracle.numerics import mp
from tests.oracle.rotary_knife.curves import Quintic as ExactQuintic

values = st.floats(-2.0, 2.0) | st.sampled_from([0.0, 1.0])


def measured(length: float, first: Sequence[float], last: Sequence[float]) -> QuinticPeaks:
    curve, peaks = Quintic(), QuinticPeaks()
    curve.fit(length, *first, *last)
    peaks.measure(curve)
    return peaks


@given(st.floats(0.1, 10.0), st.tuples(values, values, values), st.tuples(values, values, values))
def test_any_quintic(length: float, first: Sequence[float], last: Sequence[float]) -> None:
    peaks = measured(length, first, last)
    zero = mp.mpf(0)
    exact = ExactQuintic.through(zero, [*map(mp.mpf, first)], mp.mpf(length), [*map(mp.mpf, last)])
    size = max(abs(last[0] - first[0]), *(abs(x) * length for x in (first[1], last[1])), 1e-3)
    size = max(size, *(abs(x) * length * length for x in (first[2], last[2])))
    for order, (value, expected) in enumerate(
        zip((peaks.d1, peaks.d2, peaks.d3), exact.extremes(), strict=True), start=1
    ):
        assert value == pytest.approx(float(expected), rel=1e-12, abs=1e-11 * size / length**order)
    assert peaks.least_d1 == pytest.approx(float(exact.least_slope()), rel=1e-12, abs=1e-11 * size / length)


def test_from_rest_to_rest() -> None:
    """10 u3 - 15 u4 + 6 u5: 15/8 in the middle, 10/sqrt(3) at (3 - sqrt(3))/6, 60 at the ends; the least slope is 0."""
    peaks = measured(2.0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert (peaks.d1, peaks.d2, peaks.d3) == pytest.approx((15 / 16, 10 / 3**0.5 / 4, 60 / 8), rel=1e-14)
    assert peaks.least_d1 == 0.0


def test_a_curve_that_turns_back() -> None:
    """From the slope 1 to the slope 1 without travel: s = u - 10 u3 + ..., with the slope 1 - 15/8 in the middle."""
    assert measured(1.0, (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)).least_d1 == pytest.approx(1 - 15 / 8, rel=1e-14)
