"""Where a condition begins to hold, or a function changes its sign: between two places that the caller brings together.

The caller computes condition or function at a place inside, since functions are not values here:

    while can_halve(before, after):
        before, after = halve(before, after, holds(middle(before, after)))
"""

from dataclasses import dataclass
from math import sqrt

from .computable_range import clamp

SHORTEST = 1e-60  # an interval that is no wider is not halved
ROOT_TOLERANCE = 1e-13  # relative width of a bracket that is narrow
ITERATIONS = 200  # a bound that no search comes near: about 10 steps are usual, 30 the most


def middle(before: float, after: float) -> float:
    """The middle between two places, in whichever order they are."""
    return before + 0.5 * (after - before)


def can_halve(before: float, after: float) -> bool:
    """Whether there is a number between two places; not where they are neighbours, or next to 0."""
    place = middle(before, after)
    return before != place != after and abs(after - before) > SHORTEST


def halve(before: float, after: float, holds: bool) -> tuple[float, float]:
    """The half in which a condition begins to hold that does not hold at `before`, but at `after`; `holds`: it does in
    the middle."""
    place = middle(before, after)
    if holds:
        return before, place
    return place, after


@dataclass(slots=True)
class Bracket:
    """Two places 0 < low < high at which a function has opposite signs, with its values; 0 counts as the sign of the
    end that has it. Regula falsi in the Illinois form: the value of an end that stays twice in succession is halved.

        while bracket.try_narrow():
            value = function(bracket.place)
            bracket.replace(value, is_high)

    Attributes:
        place: where to compute the function next.
        side: the end that was replaced last: -1 low, 1 high; 0 if that does not count.
        tries: how many places are left to be tried.
    """

    low: float = 1.0
    at_low: float = -1.0
    high: float = 1.0
    at_high: float = 1.0
    place: float = 1.0
    side: int = 0
    tries: int = 0

    def set(self, low: float, at_low: float, high: float, at_high: float) -> None:
        self.low = low
        self.at_low = at_low
        self.high = high
        self.at_high = at_high
        self.side = 0
        self.tries = ITERATIONS

    def try_narrow(self) -> bool:
        """Set `place`; False: both ends are the root but for rounding.

        A wide bracket is halved in its logarithm, a narrow one by the chord between its values, not nearer to its ends
        than half of what it may be wide at last."""
        if self.high - self.low <= ROOT_TOLERANCE * self.high or self.tries == 0:
            return False
        self.tries -= 1
        if self.is_wide():
            self.place = sqrt(self.low) * sqrt(self.high)
        else:
            chord = self.low - (self.high - self.low) * self.at_low / (self.at_high - self.at_low)
            margin = 0.5 * ROOT_TOLERANCE * self.high
            self.place = clamp(chord, self.low + margin, self.high - margin)
        return True

    def is_wide(self) -> bool:
        """Whether the ends have different magnitudes."""
        return self.high > 4.0 * self.low

    def replace(self, value: float, is_high: bool) -> None:
        """The place becomes the high end, or else the low one, with the function's value there."""
        side = 0 if self.is_wide() else 1 if is_high else -1
        if is_high:
            if self.side == 1:
                self.at_low *= 0.5
            self.high = self.place
            self.at_high = value
        else:
            if self.side == -1:
                self.at_high *= 0.5
            self.low = self.place
            self.at_low = value
        self.side = side
