"""A recording in few numbers, from which a page in the browser computes values at any time.

A smooth signal is a list of knots: times, values and slopes. Between two knots it is the cubic that has their values
and slopes (Hermite). Two knots of the same time are a corner. A held signal keeps each value until the next one.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...scenario.recording import Reals
from ..numbers import rounded

Signal = dict[str, list[float]]
"""The columns of a signal, as JSON has them: `t`, s, and `x`, u; of a smooth one also `v`, u/s."""

MOST_KNOTS = 4000  # of a smooth signal; with more of them the tolerance is doubled
MOST_HELD = 6000  # of a held signal; with more of them only every n-th remains
CORNER = 0.25  # of a step's change of velocity: so far is its mean velocity from that of both ends, and more
ROUNDED = 0.98  # of the tolerance; the rest is for the rounding of the knots
DIGITS = 9  # of slopes, and of held values; times are exact, so that each point has its own value


def smooth(time: Reals, values: Reals, slopes: Reals, tolerance: float) -> tuple[Signal, float]:
    """A smooth signal, and how far it is at most from the values at their times.

    A step whose slopes do not fit its values, as that in which a velocity jumps, becomes a straight line.

    Args:
        time: in s, shape (points,), increasing.
        values: in u, shape (points,).
        slopes: in u/s, shape (points,).
        tolerance: how far the signal may be from the values, in u; it is doubled until the signal is short enough.
    """
    while True:
        points, straight = _choose_points(time, values, slopes, tolerance)
        if len(points) <= MOST_KNOTS:
            return _signal(time, values, slopes, (points, straight), tolerance), tolerance
        tolerance *= 2.0


def _choose_points(time: Reals, values: Reals, slopes: Reals, tolerance: float) -> tuple[list[int], NDArray[np.bool_]]:
    """The points that become knots, up to one too many of them, and for each step whether it is a straight line."""
    steps, means = np.diff(time), 0.5 * (slopes[:-1] + slopes[1:])
    missed = np.abs(np.diff(values) - steps * means)
    straight = (missed > tolerance) & (missed > CORNER * steps * np.abs(np.diff(slopes)))
    borders = np.append(np.flatnonzero(straight), len(time) - 1)
    points = [0]
    while points[-1] < len(time) - 1 and len(points) <= MOST_KNOTS:
        first = points[-1]
        limit = int(borders[np.searchsorted(borders, first)])
        points.append(first + 1 if limit == first else _farthest(time, values, slopes, (first, limit), tolerance))
    return points, straight


def _farthest(time: Reals, values: Reals, slopes: Reals, ends: tuple[int, int], tolerance: float) -> int:
    """The last point of the longest cubic found that starts at the first of these two points and passes all between."""
    first, limit = ends
    fitting, step = first + 1, 2
    while fitting < limit and _fits(time, values, slopes, (first, min(first + step, limit)), tolerance):
        fitting = min(first + step, limit)
        step *= 2
    bad = min(first + step, limit)
    while bad - fitting > 1:
        middle = (fitting + bad) // 2
        if _fits(time, values, slopes, (first, middle), tolerance):
            fitting = middle
        else:
            bad = middle
    return fitting


def _fits(time: Reals, values: Reals, slopes: Reals, ends: tuple[int, int], tolerance: float) -> bool:
    first, last = ends
    inner = slice(first + 1, last)
    h = time[last] - time[first]
    u = (time[inner] - time[first]) / h
    w = 1.0 - u
    cubic = w * w * ((1.0 + 2.0 * u) * values[first] + u * h * slopes[first])
    cubic += u * u * ((1.0 + 2.0 * w) * values[last] - w * h * slopes[last])
    return bool(np.all(np.abs(cubic - values[inner]) <= ROUNDED * tolerance))


def _signal(
    time: Reals, values: Reals, slopes: Reals, knots: tuple[list[int], NDArray[np.bool_]], tolerance: float
) -> Signal:
    """The columns of the knots; a straight step has two knots of its own."""
    points, straight = knots
    rows = [(0, slopes[0])]
    for first, last in pairwise(points):
        if straight[first]:
            secant = (values[last] - values[first]) / (time[last] - time[first])
            rows += [(first, secant), (last, secant)]
        rows.append((last, slopes[last]))
    places = [i for i, _ in rows]
    decimals = max(2 - int(np.floor(np.log10(tolerance))), 0)
    return {
        "t": time[places].tolist(),
        "x": [float(x) for x in np.round(values[places], decimals)],
        "v": rounded((v for _, v in rows), DIGITS),
    }


def held(time: Reals, values: Reals, digits: int = DIGITS) -> Signal:
    """A held signal: the points at which the value changes, and the values with so many digits."""
    places = np.flatnonzero(np.diff(values, prepend=np.nan) != 0.0)
    places = places[:: 1 + len(places) // MOST_HELD]
    return {"t": time[places].tolist(), "x": rounded(values[places], digits)}


def unwrapped(values: Reals, period: float) -> Reals:
    """Positions without the jumps by a period; period 0: as they are."""
    return np.asarray(np.unwrap(values, period=period)) if period else values
