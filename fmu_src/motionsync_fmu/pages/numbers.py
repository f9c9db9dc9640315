"""Selects the points of a curve that are drawn, and rounds them: no more than a screen shows."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scenario.recording import Reals

Indices = NDArray[np.int64]

BUCKETS = 1500  # stretches of a curve with more than two points each; a screen has about as many columns
DIGITS = 7  # significant digits of a value
TIME_DIGITS = 9  # of a time
FAR = 5.0  # a step of a position that is so many times what its velocity allows is a jump
NONE: Indices = np.array([], np.int64)


def thinned(values: Reals, required: Indices = NONE) -> Indices:
    """The indices of the points to draw: all, or of many points the least and the greatest of each stretch.

    `required`: indices that are drawn in any case."""
    if len(values) <= 2 * BUCKETS:
        return np.arange(len(values))
    size = -(-len(values) // BUCKETS)
    whole = len(values) // size * size
    stretches, begins = values[:whole].reshape(-1, size), np.arange(0, whole, size)
    extremes = (begins + stretches.argmin(axis=1), begins + stretches.argmax(axis=1))
    return np.unique(np.concatenate([[0], required, *extremes, np.arange(whole, len(values))]))


def evenly_spaced(count: int, most: int) -> Indices:
    """At most so many of the indices below `count`, evenly spaced from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def rounded(values: Iterable[float], digits: int = DIGITS) -> list[Any]:
    """The values with so many significant digits, as JSON has them: None is a gap, whole numbers are integers."""
    return [_number(float(f"{value:.{digits}g}")) for value in values]


def _number(value: float) -> Any:
    if not np.isfinite(value):
        return None
    return int(value) if value.is_integer() and abs(value) < 1e9 else value


def jumps(time: Reals, position: Reals, velocity: Reals) -> Indices:
    """The indices of the points to which a position jumps, as one does that is wrapped: by more than half its range,
    and by far more than its velocity allows."""
    steps = np.abs(np.diff(position))
    fastest = np.maximum(np.abs(velocity[1:]), np.abs(velocity[:-1])) * np.diff(time)
    return np.flatnonzero((steps > 0.5 * float(np.ptp(position))) & (steps > FAR * fastest)) + 1


def points(time: Reals, values: Reals, required: Indices = NONE, gaps: Indices = NONE) -> tuple[list[Any], list[Any]]:
    """The coordinates of a curve's points. `required`: indices of points that are drawn in any case; `gaps`: of points
    before which the line has a gap."""
    selected = thinned(values, np.union1d(required, np.union1d(gaps, gaps - 1)).astype(np.int64))
    x, y = time[selected], values[selected]
    at = np.searchsorted(selected, gaps)
    return rounded(np.insert(x, at, x[at]), TIME_DIGITS), rounded(np.insert(y, at, np.nan))
