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

MOST_KNOTS = 8000  # of a smooth signal; with more of them the tolerance is doubled
MOST_HELD = 6000  # of a held signal; with more of them only every n-th remains
CORNER = 0.25  # of a step's change of velocity: so far is its mean velocity from that of both ends, and more
ROUNDED = 0.98  # of the tolerance; the rest is for the rounding of the knots
DIGITS = 9  # of slopes, and of held values; times are exact, so that each point has its own value


def smooth(time: Reals, values: Reals, slopes: Reals, tolerance: float) -> tuple[Signal, float]:
    """A smooth signal, and how far it is at most from the values at their times.

    A stretch that one cubic misses is halved. A step whose slopes do not fit its values, as that in which a velocity
    jumps, becomes a straight line.

    Args:
        time: in s, shape (points,), increasing.
        values: in u, shape (points,).
        slopes: in u/s, shape (points,).
        tolerance: how far the signal may be from the values, in u; it is doubled until the signal is short enough.
    """
    steps = np.diff(time)
    jumps = np.abs(np.diff(values) - steps * 0.5 * (slopes[:-1] + slopes[1:]))
    jumps[jumps <= CORNER * steps * np.abs(np.diff(slopes))] = 0.0
    last, error, before = _halved(time, values, slopes, jumps, ROUNDED * tolerance)
    while True:
        limit = ROUNDED * tolerance
        chosen = (error <= limit) & (before > limit)
        if np.count_nonzero(chosen) < MOST_KNOTS:
            points = [0, *np.sort(last[chosen]).tolist()]
            return _signal(time, values, slopes, (points, jumps > limit), tolerance), tolerance
        tolerance *= 2.0


Stretches = tuple[NDArray[np.intp], Reals, Reals]
"""Stretches of a signal, shape (stretches,): the numbers of their last points; how far their cubics miss it; the
least miss of the stretches of which they are halves."""


def _halved(time: Reals, values: Reals, slopes: Reals, jumps: Reals, limit: float) -> Stretches:
    """The whole signal, and the halves of all stretches that miss it by more than `limit`, in u; see `smooth`."""
    first, last, before = np.array([0]), np.array([len(time) - 1]), np.array([np.inf])
    levels: list[Stretches] = []
    while len(first):
        error = _misses(time, values, slopes, jumps, first, last)
        levels.append((last, error, before))
        split = error > limit
        before = np.repeat(np.minimum(before[split], error[split]), 2)
        first, last = first[split], last[split]
        middle = (first + last) // 2
        first, last = np.column_stack([first, middle]).ravel(), np.column_stack([middle, last]).ravel()
    lasts, errors, befores = (np.concatenate(column) for column in zip(*levels, strict=True))
    return lasts, errors, befores


def _misses(
    time: Reals, values: Reals, slopes: Reals, jumps: Reals, first: NDArray[np.intp], last: NDArray[np.intp]
) -> Reals:
    """How far the cubic of each stretch misses a point or a jump in it, in u; a single step misses nothing."""
    counts = last - first
    begins = np.cumsum(counts) - counts
    of = np.repeat(np.arange(len(first)), counts)
    i = np.arange(len(of)) - begins[of] + first[of]
    h = (time[last] - time[first])[of]
    a, b = first[of], last[of]
    u = (time[i] - time[a]) / h
    w = 1.0 - u
    cubic = w * w * ((1.0 + 2.0 * u) * values[a] + u * h * slopes[a])
    cubic += u * u * ((1.0 + 2.0 * w) * values[b] - w * h * slopes[b])
    missed = np.maximum.reduceat(np.maximum(np.abs(cubic - values[i]), jumps[i]), begins)
    return np.asarray(np.where(counts > 1, missed, 0.0))


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
