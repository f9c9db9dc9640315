"""The slave's laws between two events of the Gearing, as Taylor series of time; no closed form of the specification.

The transitions are the polynomials that meet their boundary conditions, found by solving linear systems. A law takes
the master as the first four Taylor coefficients of its position at one instant (its jerk 0, as far as a unit can know)
and gives those of the slave, so that velocity, acceleration and jerk come out of the composition by themselves.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

ZERO, ONE = mp.mpf(0), mp.mpf(1)
ORDER = 4

Series: TypeAlias = tuple[Number, ...]
"""The first four Taylor coefficients of a function of time at one instant."""


def series(motion: Motion) -> Series:
    """The master's position around an instant, its acceleration constant."""
    return motion.position, motion.velocity, motion.acceleration / 2, ZERO


def constant(value: Number) -> Series:
    return (value,) + (ZERO,) * (ORDER - 1)


def added(a: Series, b: Series) -> Series:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def scaled(factor: Number, a: Series) -> Series:
    return tuple(factor * x for x in a)


def product(a: Series, b: Series) -> Series:
    return tuple(sum((a[i] * b[n - i] for i in range(n + 1)), ZERO) for n in range(ORDER))


def composed(polynomial: Sequence[Number], inner: Series) -> Series:
    """The polynomial (ascending powers) of a series."""
    result = constant(ZERO)
    for coefficient in reversed(polynomial):
        result = added(product(result, inner), constant(coefficient))
    return result


def interpolated(*conditions: tuple[int, int, Number]) -> list[Number]:
    """The polynomial of least degree whose derivative of an `order` at `u` has a value, for each (u, order, value)."""
    size = len(conditions)
    matrix = [[ZERO] * size for _ in conditions]
    for row, (u, order, _) in zip(matrix, conditions, strict=True):
        for power in range(order, size):
            row[power] = mp.factorial(power) / mp.factorial(power - order) * mp.mpf(u) ** (power - order)
    return mp.solve_linear(matrix, [value for *_, value in conditions])


def zero_of(affine: Callable[[Number], Number]) -> Number:
    """Where a function that is a straight line is 0."""
    at_zero = affine(ZERO)
    return at_zero / (at_zero - affine(ONE))


DRAWN_IN = interpolated((0, 0, ZERO), (0, 1, ZERO), (0, 2, ZERO), (1, 1, ONE), (1, 2, ZERO))
"""Travel over r·D for u = 0 … 1: from rest to slope 1, without curvature at the ends."""

DRAWN_OUT = interpolated((0, 0, ZERO), (0, 1, ONE), (0, 2, ZERO), (1, 1, ZERO), (1, 2, ZERO))
"""From slope 1 to rest."""


@dataclass(frozen=True, slots=True)
class Rest:
    """The slave is at rest."""

    position: Number

    def at(self, time: Number, master: Series) -> Series:
        return constant(self.position)


@dataclass(frozen=True, slots=True)
class RatioLine:
    """The straight line of slope `ratio` through one point of master and slave."""

    master: Number
    slave: Number
    ratio: Number

    def value(self, master: Number) -> Number:
        return self.slave + self.ratio * (master - self.master)

    def at(self, time: Number, master: Series) -> Series:
        return added(constant(self.value(ZERO)), scaled(self.ratio, master))


@dataclass(frozen=True, slots=True)
class TransitionCurve:
    """A master-based transition from `start` over `distance`, started at the master's `trigger` in `direction`."""

    shape: Sequence[Number]
    trigger: Number
    direction: int
    distance: Number
    start: Number
    ratio: Number

    @property
    def end(self) -> Number:
        """The master's position at u = 1."""
        return self.trigger + self.direction * self.distance

    @property
    def line(self) -> RatioLine:
        """The one that an engagement ends on."""
        return RatioLine(self.end, self.value(self.end), self.ratio)

    def progress(self, master: Number) -> Number:
        return self.direction * (master - self.trigger) / self.distance

    def value(self, master: Number) -> Number:
        return self.at(ZERO, constant(master))[0]

    def at(self, time: Number, master: Series) -> Series:
        passed = added(master, constant(-self.trigger))
        scale = self.direction * self.ratio * self.distance
        u = scaled(self.direction / self.distance, passed)
        return added(constant(self.start), scaled(scale, composed(self.shape, u)))


@dataclass(frozen=True, slots=True)
class Timed:
    """A time-based transition from `begin` (s) over `duration` (s): `base`, plus a polynomial of the part gone by."""

    begin: Number
    duration: Number
    base: RatioLine | Rest
    shape: Sequence[Number]

    @property
    def end(self) -> Number:
        return self.begin + self.duration

    def progress(self, time: Number) -> Number:
        return (time - self.begin) / self.duration

    def at(self, time: Number, master: Series) -> Series:
        u = (self.progress(time), 1 / self.duration, ZERO, ZERO)
        return added(self.base.at(time, master), composed(self.shape, u))


Law: TypeAlias = Rest | RatioLine | TransitionCurve | Timed


def timed(begin: Number, duration: Number, slave: Series, base: RatioLine | Rest, master: Series) -> Timed:
    """From the slave's own position, velocity and acceleration to those of `base`, and there without any offset."""
    offset = added(slave, scaled(-ONE, base.at(begin, master)))
    starts = ((0, n, offset[n] * mp.factorial(n) * duration**n) for n in range(3))
    return Timed(begin, duration, base, interpolated(*starts, *((1, n, ZERO) for n in range(3))))
