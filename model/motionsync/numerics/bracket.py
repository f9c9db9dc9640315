"""Where a function of one variable changes its sign: a bracket that the caller narrows by computing values."""

from dataclasses import dataclass
from math import sqrt

from .computable_range import clamp

ROOT_TOLERANCE = 1e-13  # relative width of a bracket that is narrow
ITERATIONS = 200  # a bound that no search comes near: about 10 steps are usual, 30 the most


@dataclass(slots=True)
class Bracket:
    """Two places 0 < low < high at which a function has opposite signs, with its values; 0 counts as the sign of the
    end that has it. Regula falsi in the Illinois form: the value of an end that stays twice in succession is halved.

    Attributes:
        side: the end that was replaced last: -1 low, 1 high; 0 if that does not count.
    """

    low: float = 1.0
    at_low: float = -1.0
    high: float = 1.0
    at_high: float = 1.0
    side: int = 0

    def set(self, low: float, at_low: float, high: float, at_high: float) -> None:
        self.low = low
        self.at_low = at_low
        self.high = high
        self.at_high = at_high
        self.side = 0

    def is_narrow(self) -> bool:
        """Whether both ends are the root but for rounding."""
        return self.high - self.low <= ROOT_TOLERANCE * self.high

    def middle(self) -> float:
        """Where to compute the function next."""
        return next_try(self.low, self.at_low, self.high, self.at_high)

    def replace(self, place: float, value: float, is_high: bool) -> None:
        """A place inside becomes the high end, or else the low one, with the function's value there."""
        wide = self.high > 4.0 * self.low
        if is_high:
            self.high = place
            self.at_high = value
            if self.side == 1:
                self.at_low *= 0.5
            self.side = 1
        else:
            self.low = place
            self.at_low = value
            if self.side == -1:
                self.at_high *= 0.5
            self.side = -1
        if wide:
            self.side = 0


def next_try(low: float, at_low: float, high: float, at_high: float) -> float:
    """Where a bracket of a root is cut, not nearer to its ends than half of what it may be wide at last.

    A wide bracket is halved in its logarithm, a narrow one by the chord between its values."""
    if high > 4.0 * low:
        return sqrt(low) * sqrt(high)
    chord = low - (high - low) * at_low / (at_high - at_low)
    margin = 0.5 * ROOT_TOLERANCE * high
    return clamp(chord, low + margin, high - margin)
