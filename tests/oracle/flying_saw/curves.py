"""Piecewise polynomial courses of the flying saw's slave: values, extrema, sign changes and integrals, to 50 digits.

A curve gives a position over a time from 0; velocity, acceleration and jerk are its derivatives. Extrema come from all
roots of the derivative (`mp.roots`), integrals from the exact antiderivative.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.numerics.root_search import Bracket

ZERO = mp.mpf(0)

NEGLIGIBLE = mp.mpf("1e-38")
"""Of a polynomial's greatest term: a leading term below it is rounding."""

REAL = mp.mpf("1e-18")
"""Imaginary part, over the interval's length, up to which a root counts as real (a double root splits by rounding)."""

EQUAL = mp.mpf("1e-12")
"""Of the greatest magnitude: extrema that differ by less are equal, and the first one counts."""

POSITION, VELOCITY, ACCELERATION, JERK = range(4)


def value(polynomial: Sequence[Number], x: Number) -> Number:
    """The polynomial, coefficients in rising order, at x."""
    result = ZERO
    for coefficient in reversed(polynomial):
        result = result * x + coefficient
    return result


def derivative(polynomial: Sequence[Number], order: int = 1) -> list[Number]:
    """The coefficients of its derivative of that order; at least one."""
    result = list(polynomial)
    for _ in range(order):
        result = [i * c for i, c in enumerate(result)][1:] or [ZERO]
    return result


def product(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    result = [ZERO] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for k, y in enumerate(b):
            result[i + k] += x * y
    return result


def integral(polynomial: Sequence[Number], begin: Number, end: Number) -> Number:
    antiderivative = [ZERO, *(c / (i + 1) for i, c in enumerate(polynomial))]
    return value(antiderivative, end) - value(antiderivative, begin)


def real_roots(polynomial: Sequence[Number], length: Number) -> list[Number]:
    """The real roots strictly between 0 and `length`, rising; none of a polynomial that is 0 everywhere."""
    scaled = [c * length**i for i, c in enumerate(polynomial)]
    maximum = max(abs(c) for c in scaled)
    while scaled and abs(scaled[-1]) <= NEGLIGIBLE * maximum:
        scaled.pop()
    if len(scaled) < 2:
        return []
    inside = [real for real, imaginary in mp.roots(scaled) if abs(imaginary) < REAL and mp.EPSILON < real < 1]
    return sorted(root * length for root in inside)


def solve(function: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """The root between `low` and `high`, where the function has different signs, to about 45 digits.

    False position, and every third step a bisection.
    """
    at_low, at_high = function(low), function(high)
    if at_low == 0 or at_high == 0:
        return low if at_low == 0 else high
    assert mp.sign(at_low) != mp.sign(at_high), "no sign change in the bracket"
    bracket = Bracket(low, high, at_low, at_high)
    for count in range(600):
        low, high = sorted((bracket.low, bracket.high))
        if high - low <= mp.mpf("1e-46") * (abs(high) + abs(low)):
            break
        point = bracket.middle if count % 3 == 2 else bracket.false_position
        if not low < point < high:
            point = bracket.middle
        value = function(point)
        if value == 0:
            return point
        bracket.narrow(point, value)
    return bracket.middle


@dataclass(frozen=True)
class CurveSegment:
    """From `begin` to `end` (s) the position is a polynomial of the time since `begin`."""

    begin: Number
    end: Number
    polynomial: Sequence[Number]

    @property
    def length(self) -> Number:
        return self.end - self.begin

    def at(self, time: Number) -> tuple[Number, Number, Number, Number]:
        """Position, velocity, acceleration and jerk."""
        return tuple(value(polynomial, time - self.begin) for polynomial in self._derivatives)

    @cached_property
    def _derivatives(self) -> list[Sequence[Number]]:
        return [derivative(self.polynomial, order) for order in range(4)]


@dataclass(frozen=True, slots=True)
class Extremum:
    """The value of a quantity and the time (s) at which it is first taken."""

    value: Number
    time: Number


@dataclass(frozen=True)
class Curve:
    """Segments that follow one another from time 0; segments without length are left out."""

    segments: Sequence[CurveSegment]

    @property
    def duration(self) -> Number:
        return self.segments[-1].end if self.segments else ZERO

    def at(self, time: Number, lean: Number = ZERO) -> tuple[Number, Number, Number, Number]:
        """Position, velocity, acceleration and jerk; before and after the curve its outer segments go on.

        `lean`: where two segments meet, that of the earlier one if it is less than 0.
        """
        return self.segments[max(bisect_right([p.begin for p in self.segments], time + lean) - 1, 0)].at(time)

    def start(self) -> tuple[Number, Number, Number, Number]:
        return self.at(ZERO)

    def finish(self) -> tuple[Number, Number, Number, Number]:
        """The values at the end, those of the last segment."""
        return self.segments[-1].at(self.segments[-1].end)

    def _extrema(self, quantities: Iterable[Sequence[Number]]) -> tuple[Extremum, Extremum]:
        """Least and greatest of a quantity given as one polynomial for each segment."""
        result: list[Extremum] = []
        for segment, polynomial in zip(self.segments, quantities, strict=True):
            for x in [ZERO, *real_roots(derivative(polynomial), segment.length), segment.length]:
                result.append(Extremum(value(polynomial, x), segment.begin + x))
        tolerance = EQUAL * max(abs(e.value) for e in result)
        minimum, maximum = min(e.value for e in result), max(e.value for e in result)
        low = next(e for e in result if e.value <= minimum + tolerance)
        high = next(e for e in result if e.value >= maximum - tolerance)
        return Extremum(minimum, low.time), Extremum(maximum, high.time)

    def extrema(self, order: int) -> tuple[Extremum, Extremum]:
        """Least and greatest position (order 0), velocity, acceleration or jerk (3)."""
        return self._all_extrema[order]

    @cached_property
    def _all_extrema(self) -> list[tuple[Extremum, Extremum]]:
        return [self._extrema(derivative(p.polynomial, order) for p in self.segments) for order in range(4)]

    def momentum(self) -> tuple[Extremum, Extremum]:
        """Least and greatest v·a (u2/s3)."""
        return self._extrema(product(derivative(p.polynomial), derivative(p.polynomial, 2)) for p in self.segments)

    @cached_property
    def _one_way(self) -> list[CurveSegment]:
        """The segments cut where the velocity is 0."""
        cut = []
        for segment in self.segments:
            velocity = derivative(segment.polynomial)
            limits = [ZERO, *real_roots(velocity, segment.length), segment.length]
            for low, high in pairwise(limits):
                cut.append(CurveSegment(segment.begin + low, segment.begin + high, shifted(segment.polynomial, low)))
        return cut

    @cached_property
    def speeding(self) -> tuple[Number, Number]:
        """The greatest |a| where v·a > 0, and where v·a < 0 (u/s2)."""
        maximum = {1: ZERO, -1: ZERO}
        for segment in self._one_way:
            direction = mp.sign(value(derivative(segment.polynomial), segment.length / 2))
            acceleration = derivative(segment.polynomial, 2)
            for x in [ZERO, *real_roots(derivative(acceleration), segment.length), segment.length]:
                a = value(acceleration, x)
                if a * direction != 0:
                    side = int(mp.sign(a * direction))
                    maximum[side] = max(maximum[side], abs(a))
        return maximum[1], maximum[-1]

    def mean_speed(self) -> Number:
        """The mean of |v| over the time (u/s)."""
        parts = (abs(integral(derivative(p.polynomial), ZERO, p.length)) for p in self._one_way)
        return sum(parts, ZERO) / self.duration

    def effective_acceleration(self) -> Number:
        """The root of the mean of a² over the time (u/s2)."""
        squares = (product(a, a) for a in (derivative(p.polynomial, 2) for p in self.segments))
        total = sum((integral(s, ZERO, p.length) for s, p in zip(squares, self.segments, strict=True)), ZERO)
        return mp.sqrt(total / self.duration)


def shifted(polynomial: Sequence[Number], x: Number) -> list[Number]:
    """The same polynomial with x as its origin (Taylor's theorem)."""
    return [value(derivative(polynomial, order), x) / mp.factorial(order) for order in range(len(polynomial))]


def joined(parts: Iterable[tuple[Number, Sequence[Number]]], position: Number) -> Curve:
    """A curve from parts of (duration, polynomial whose position counts from 0), starting at `position`."""
    segments, begin = [], ZERO
    for duration, polynomial in parts:
        if duration > 0:
            moved = [position, *polynomial[1:]]
            segments.append(CurveSegment(begin, begin + duration, moved))
            begin, position = begin + duration, value(moved, duration)
    return Curve(segments)


def fitted(length: Number, conditions: Sequence[tuple[int, int, Number]]) -> list[Number]:
    """The polynomial of lowest order that meets conditions (order of the derivative, end 0 or 1, value).

    End 1 is at `length`. By elimination, in the interval 0 … 1.
    """
    size = len(conditions)
    units = [[ZERO] * column + [mp.mpf(1)] for column in range(size)]
    matrix = [[value(derivative(unit, order), mp.mpf(end)) for unit in units] for order, end, _ in conditions]
    right = [requested * length**order for order, _, requested in conditions]
    return [c / length**i for i, c in enumerate(mp.solve_linear(matrix, right))]
