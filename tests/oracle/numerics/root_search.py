"""Where a function becomes 0 first, of floats to the last bit; the false position for functions of any numbers."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, TypeAlias

Function: TypeAlias = Callable[[float], float]

SAMPLES, FEW_SAMPLES, SHORT = 48, 12, 0.05
GOLDEN = (sqrt(5.0) - 1.0) / 2.0


@dataclass(slots=True)
class Bracket:
    """Two points at which a function of floats or of `mp` numbers has different signs, and its values there.

    Of an end that stays a second time the value is halved, so that the false position soon is on its side of the root:
    the Illinois algorithm, which needs a dozen values where a bisection needs a hundred.
    """

    low: Any
    high: Any
    at_low: Any
    at_high: Any
    rises: bool = field(init=False)
    low_stayed: bool = False
    high_stayed: bool = False

    def __post_init__(self) -> None:
        self.rises = bool(self.at_low < 0)

    @property
    def false_position(self) -> Any:
        return (self.low * self.at_high - self.high * self.at_low) / (self.at_high - self.at_low)

    @property
    def middle(self) -> Any:
        return (self.low + self.high) / 2

    def narrow(self, point: Any, value: Any) -> None:
        """`point`, between the ends, takes the place of the one where the function has the sign of `value`."""
        if (value < 0) == self.rises:
            self.low, self.at_low = point, value
            self.at_high = self.at_high / 2 if self.high_stayed else self.at_high
            self.low_stayed, self.high_stayed = False, True
        else:
            self.high, self.at_high = point, value
            self.at_low = self.at_low / 2 if self.low_stayed else self.at_low
            self.low_stayed, self.high_stayed = True, False


def find_root(function: Function, low: float, high: float) -> float:
    """The point of [low, high] from which on the function is not negative; at `low` it has to be negative.

    False position, and every third step a bisection.
    """
    bracket = Bracket(low, high, function(low), function(high))
    for count in range(300):
        point = bracket.middle if count % 3 == 2 else bracket.false_position
        if not bracket.low < point < bracket.high:
            point = bracket.middle
            if not bracket.low < point < bracket.high:
                break
        bracket.narrow(point, function(point))
    return float(bracket.high)


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
