"""Boundaries by bisection: for many points at once, where on the way from one value to another a condition changes."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Holds = Callable[[Indices, Reals], Flags]
"""Whether the condition holds: for points, given by their numbers, at a value each."""

NEAR = 1e-6  # of the range: a boundary that is nearer to 0 counts as that far from it


@dataclass(frozen=True)
class Boundaries:
    """Where a condition starts to hold, for each point; all arrays have the shape (points,).

    Attributes:
        holding: the value at which it holds, of the two at the boundary; NaN: there is no boundary.
        other: the value beside it, at which it does not hold; NaN: there is no boundary.
        at_low, at_high: whether it holds at the ends of the range.
        runs: at how many values it was looked at.
    """

    holding: Reals
    other: Reals
    at_low: Flags
    at_high: Flags
    runs: Indices


def bisect(holds: Holds, points: int, low: float, high: float, relative: float) -> Boundaries:
    """The boundaries between `low` and `high` of so many points, each known to a share of its magnitude.

    The condition is looked at for all points at both ends, and then, round by round, halfway between the two values
    that are nearest to each boundary, for the points whose values are still too far from one another. Where the
    condition holds at both ends or at none, there is nothing to halve. Where it changes more than once, one of the
    boundaries is found.
    """
    everywhere = np.arange(points)
    at_low, at_high = (holds(everywhere, np.full(points, end)) for end in (low, high))
    runs = np.full(points, 2)
    changing = at_low != at_high
    holding = np.where(changing, np.where(at_low, low, high), np.nan)
    other = np.where(changing, np.where(at_low, high, low), np.nan)
    while len(left := np.flatnonzero(_apart(holding, other, relative, NEAR * (high - low)))):
        middle = 0.5 * (holding[left] + other[left])
        held = holds(left, middle)
        holding[left[held]], other[left[~held]] = middle[held], middle[~held]
        runs[left] += 1
    return Boundaries(holding, other, at_low, at_high, runs)


def _apart(a: Reals, b: Reals, relative: float, smallest: float) -> Flags:
    """Whether two values are farther from one another than a share of their magnitude, of `least` at least, and not
    neighbours."""
    middle = 0.5 * (a + b)
    scale = np.maximum(np.maximum(np.abs(a), np.abs(b)), smallest)
    apart: Flags = (np.abs(a - b) > relative * scale) & (middle != a) & (middle != b)
    return apart


def rounds(low: float, high: float, relative: float) -> int:
    """How many rounds a search takes at most, those at the ends included."""
    nearest = 0.0 if low < 0.0 < high else min(abs(low), abs(high))
    smallest = max(NEAR * (high - low), nearest)
    return 2 + max(0, ceil(log2((high - low) / (relative * smallest))))
