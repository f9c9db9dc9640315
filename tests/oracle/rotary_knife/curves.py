"""How a rotary knife turns over the master: at rest, in the window of a cut, and on the quintic through six values.

A place is a position of the master (u); `at` gives the slave's position there and its three derivatives over the place.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

Derivatives: TypeAlias = tuple[Number, Number, Number, Number]
"""The slave's position, slope, curvature and third derivative over the place."""
Extremes: TypeAlias = tuple[Number, Number, Number]
"""The greatest magnitudes of slope, curvature and third derivative."""

ZERO, ONE = mp.mpf(0), mp.mpf(1)
FINE = mp.mpf("1e-12")
"""The last step of Newton's method: the zero is right to 24 digits then, and what is extreme there to 48."""
MOST_ITERATIONS = 400
NO_EXTREMES: Extremes = (ZERO, ZERO, ZERO)


def greatest(*extremes: Extremes) -> Extremes:
    """Of several curves, one after the other."""
    slope, curvature, third = (max(values) for values in zip(*extremes, strict=True))
    return slope, curvature, third


@dataclass(frozen=True, slots=True)
class Rest:
    position: Number

    def at(self, _place: Number) -> Derivatives:
        return self.position, ZERO, ZERO, ZERO


@dataclass(frozen=True, slots=True)
class Window:
    """The law around a cut. `slope`: k' where it is TANGENTIAL, k = f·turn/C where it is HORIZONTAL, that of the cut.

    `before`, `after`: travel of the master before and after the cut. `radian`: turn/(2π) where it is HORIZONTAL, or 0.
    """

    slope: Number
    before: Number
    after: Number
    radian: Number

    def at(self, travel: Number) -> Derivatives:
        """`travel`: of the master since the cut. HORIZONTAL: radian·arcsin(y), y = slope·travel/radian = 2π x/C."""
        if not self.radian:
            return self.slope * travel, self.slope, ZERO, ZERO
        y, rate = self.slope * travel / self.radian, self.slope / self.radian
        root = mp.sqrt(1 - y * y)
        return (
            self.radian * mp.asin(y),
            self.slope / root,
            self.slope * rate * y / root**3,
            self.slope * rate**2 * (1 + 2 * y * y) / root**5,
        )

    def extremes(self, travel: Number) -> Extremes:
        """Between the cut and `travel`: all three are greatest at the end."""
        _, slope, curvature, third = self.at(travel)
        return slope, abs(curvature), third


@dataclass(frozen=True, slots=True)
class Cut:
    """The window of a cut that is made at `place`, where the slave's position is `position`."""

    window: Window
    place: Number
    position: Number

    @property
    def begin(self) -> Number:
        return self.place - self.window.before

    @property
    def end(self) -> Number:
        return self.place + self.window.after

    def at(self, place: Number) -> Derivatives:
        s, slope, curvature, third = self.window.at(place - self.place)
        return self.position + s, slope, curvature, third


@dataclass(frozen=True)
class Quintic:
    """Σ cᵢ uⁱ, u = (place - begin)/width from 0 to 1."""

    begin: Number
    width: Number
    coefficients: tuple[Number, ...]

    @staticmethod
    def through(begin: Number, first: Sequence[Number], end: Number, last: Sequence[Number]) -> "Quintic":
        """The one with the position, slope and curvature of `first` at `begin` and of `last` at `end`."""
        h = end - begin
        c = [first[0], first[1] * h, first[2] * h * h / 2]
        d, e, g = last[0] - sum(c), last[1] * h - c[1] - 2 * c[2], last[2] * h * h - 2 * c[2]
        return Quintic(begin, h, (*c, 10 * d - 4 * e + g / 2, -15 * d + 7 * e - g, 6 * d - 3 * e + g / 2))

    @property
    def end(self) -> Number:
        return self.begin + self.width

    def at(self, place: Number) -> Derivatives:
        u = min(max((place - self.begin) / self.width, ZERO), ONE)
        s, slope, curvature, third = (
            value_at(polynomial, u) / self.width**order for order, polynomial in enumerate(self._derivatives[:4])
        )
        return s, slope, curvature, third

    def extremes(self) -> Extremes:
        slope, curvature, third = (
            max(map(abs, values)) / self.width**order for order, values in enumerate(self._critical_values, start=1)
        )
        return slope, curvature, third

    def least_slope(self) -> Number:
        return min(self._critical_values[0]) / self.width

    @cached_property
    def _derivatives(self) -> list[list[Number]]:
        """The polynomial over u and its derivatives, by order."""
        result = [list(self.coefficients)]
        for _ in range(5):
            result.append([power * c for power, c in enumerate(result[-1])][1:])
        return result

    @cached_property
    def _critical_values(self) -> list[list[Number]]:
        """Of the first three derivatives over u, at both ends and wherever the next one is 0."""
        result: list[list[Number]] = []
        points = [ZERO, ONE]  # between any two of them the derivative is monotone
        for order in (4, 3, 2, 1):
            polynomial = self._derivatives[order]
            result.insert(0, [value_at(polynomial, u) for u in points])
            if order > 1:
                points = [ZERO, *zeros(polynomial, self._derivatives[order + 1], points, result[0]), ONE]
        return result[:3]


def value_at(polynomial: Sequence[Number], u: Number) -> Number:
    result = ZERO
    for coefficient in reversed(polynomial):
        result = result * u + coefficient
    return result


def zeros(
    polynomial: Sequence[Number], slope: Sequence[Number], points: Sequence[Number], values: Sequence[Number]
) -> list[Number]:
    """Where the polynomial changes its sign, in order. `slope`: its derivative; `values`: its values at `points`,
    between any two of which it is monotone, so that there is one zero at most."""
    return [
        _zero_between(polynomial, slope, low, high, mp.sign(at_high))
        for (low, at_low), (high, at_high) in pairwise(zip(points, values, strict=True))
        if mp.sign(at_low) * mp.sign(at_high) < 0
    ]


def _zero_between(
    polynomial: Sequence[Number], slope: Sequence[Number], low: Number, high: Number, side: Number
) -> Number:
    """The zero of a polynomial that is monotone from `low` to `high`, where it has the sign `side`.

    Newton's method kept inside a bracket, which a step that would leave it bisects.
    """
    u = (low + high) / 2
    for _ in range(MOST_ITERATIONS):
        value, rate = value_at(polynomial, u), value_at(slope, u)
        if value * side < 0:
            low = u
        else:
            high = u
        following = u - value / rate if rate else low
        if abs(following - u) <= FINE:
            return following
        u = following if low < following < high else (low + high) / 2
    return u
