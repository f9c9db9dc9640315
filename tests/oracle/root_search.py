"""Where a function of floats becomes 0 first, to the last bit."""

from collections.abc import Callable
from math import sqrt
from typing import TypeAlias

Function: TypeAlias = Callable[[float], float]

SAMPLES, FEW_SAMPLES, SHORT = 48, 12, 0.05
GOLDEN = (sqrt(5.0) - 1.0) / 2.0


def find_root(function: Function, low: float, high: float) -> float:
    """The point of [low, high] from which on the function is not negative; at `low` it has to be negative.

    False position that halves the weight of an end that stays, and every third step a bisection.
    """
    at_low, at_high = function(low), function(high)
    for count in range(300):
        middle = (low + high) / 2 if count % 3 == 2 else (low * at_high - high * at_low) / (at_high - at_low)
        if not low < middle < high:
            middle = (low + high) / 2
            if not low < middle < high:
                break
        value = function(middle)
        if value >= 0:
            high, at_high, at_low = middle, value, at_low / 2
        else:
            low, at_low, at_high = middle, value, at_high / 2
    return high


def find_first_root(function: Function, low: float, high: float) -> float | None:
    """The first point of [low, high] at which the continuous function is not negative; None without one.

    Dense samples, fewer in less than 0.05 s, and between them the greatest value near each sample that is greater than
    its neighbours.
    """
    if function(low) >= 0:
        return low
    if high <= low:
        return None
    samples = SAMPLES if high - low > SHORT else FEW_SAMPLES
    points = [low + (high - low) * i / samples for i in range(samples)] + [high]
    values = [function(point) for point in points]
    for i in range(1, len(points)):
        if values[i] >= 0:
            return find_root(function, points[i - 1], points[i])
        if i + 1 < len(points) and values[i] > max(values[i - 1], values[i + 1]):
            peak = _find_peak(function, points[i - 1], points[i + 1])
            if function(peak) >= 0:
                return find_root(function, points[i - 1], peak)
    return None


def _find_peak(function: Function, low: float, high: float) -> float:
    """Where the function is greatest, by golden sections; or the first point met where it is not negative."""
    for _ in range(60):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        at_left, at_right = function(left), function(right)
        if max(at_left, at_right) >= 0:
            return left if at_left >= 0 else right
        low, high = (low, right) if at_left > at_right else (left, high)
    return (low + high) / 2
