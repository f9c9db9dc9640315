"""Bisection for many points at once, against conditions whose boundaries are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.sweeps.bisection import Boundaries, Indices, Reals, bisect, rounds

LOW, HIGH = 300.0, 3000.0
THRESHOLDS = st.lists(st.floats(0.0, 4000.0), min_size=1, max_size=20)


def search_rows(thresholds: list[float], relative: float, *, above: bool) -> Boundaries:
    """The boundaries of conditions that hold above (below) a threshold, at the threshold too."""
    at = np.array(thresholds)

    def holds(points: Indices, values: Reals) -> np.ndarray:
        return values >= at[points] if above else values <= at[points]

    return bisect(holds, len(at), LOW, HIGH, relative)


@given(THRESHOLDS, st.sampled_from([1e-2, 1e-6, 1e-12]), st.booleans())
def test_the_boundary_is_found_in_both_directions(thresholds: list[float], relative: float, above: bool) -> None:
    b = search_rows(thresholds, relative, above=above)
    for i, threshold in enumerate(thresholds):
        if LOW < threshold <= HIGH if above else LOW <= threshold < HIGH:
            low, high = (b.other[i], b.holding[i]) if above else (b.holding[i], b.other[i])
            assert low < threshold <= high if above else low <= threshold < high
            assert high - low <= relative * high
            assert b.runs[i] <= rounds(LOW, HIGH, relative)
        else:
            assert np.isnan(b.holding[i])
            assert np.isnan(b.other[i])
            assert b.at_low[i] == b.at_high[i] == ((threshold <= LOW) == above)
            assert b.runs[i] == 2


@given(st.floats(-1.0, 1.0, exclude_min=True), st.sampled_from([1e-3, 1e-6]))
def test_a_range_with_zero_inside_comes_to_an_end(threshold: float, relative: float) -> None:
    """Near 0 the boundary is known to a share of a millionth of the range."""
    b = bisect(lambda _, values: values >= threshold, 1, -1.0, 1.0, relative)
    assert b.other[0] < threshold <= b.holding[0]
    assert b.holding[0] - b.other[0] <= relative * max(abs(b.other[0]), abs(b.holding[0]), 2e-6)
    assert b.runs[0] <= rounds(-1.0, 1.0, relative)


def test_neighbours_are_not_halved() -> None:
    """A share of 0 asks for more than floating-point numbers have."""
    b = search_rows([1000.1], 0.0, above=True)
    assert b.holding[0] == 1000.1
    assert b.other[0] == np.nextafter(1000.1, 0.0)


def test_a_condition_that_changes_three_times_has_one_of_its_boundaries() -> None:
    """It holds from 800 to 1200 and from 2000 on. Halfway, at 1650, it does not: so 2000 is found."""
    b = bisect(lambda _, v: ((v >= 800.0) & (v < 1200.0)) | (v >= 2000.0), 1, LOW, HIGH, 1e-6)
    assert b.other[0] < 2000.0 <= b.holding[0]


def test_points_that_are_done_are_not_looked_at_again() -> None:
    """Of a boundary at 300 the values are a tenth of those at 3000, and so are nearer to one another."""
    asked: list[int] = []
    at = np.array([300.001, 2999.0, 5000.0])

    def holds(points: Indices, values: Reals) -> np.ndarray:
        asked.append(len(points))
        return values >= at[points]

    b = bisect(holds, 3, LOW, HIGH, 1e-6)
    assert asked[:3] == [3, 3, 2]
    assert sum(asked) == b.runs.sum()
    assert b.runs.tolist() == [pytest.approx(2 + 23.2, abs=1), pytest.approx(2 + 19.8, abs=1), 2]
