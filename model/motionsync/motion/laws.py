"""Motion laws: ramps between rest and synchronous motion, curves through given ends, and how a slave follows a curve.

A ramp's law is normalised (VDI 2143) and has its first three derivatives with it. `parabola` and `polynomial_3_4_5` are
the first halves, 0 <= z <= 1/2, of rest-to-rest laws f with f(1/2) = 1/2; doubled in height and stretched by two they
are ramps. Next to each law are the master's travel over such a ramp, in units D of the slave's travel, and the greatest
acceleration and jerk at the constant master velocity v.
"""

from dataclasses import dataclass
from math import sqrt

PARABOLA_TRAVEL = 2.0  # D
PARABOLA_PEAK_ACCELERATION = 0.5  # v^2 / D; the jerk is an impulse at both ends


def parabola(z: float) -> tuple[float, float, float, float]:
    """f(z) = 2 z^2: the least acceleration, constant along the ramp."""
    return 2.0 * z * z, 4.0 * z, 4.0, 0.0


POLYNOMIAL_3_4_5_D1 = 1.875  # the greatest magnitudes of the first three derivatives over 0 <= z <= 1
POLYNOMIAL_3_4_5_D2 = 10.0 / sqrt(3.0)
POLYNOMIAL_3_4_5_D3 = 60.0
POLYNOMIAL_3_4_5_TRAVEL = 15.0 / 8.0  # D
POLYNOMIAL_3_4_5_PEAK_ACCELERATION = 64.0 / 135.0 * sqrt(3.0)  # v^2 / D
POLYNOMIAL_3_4_5_PEAK_JERK = 512.0 / 225.0  # v^3 / D^2, at the ramp's rest end


def polynomial_3_4_5(z: float) -> tuple[float, float, float, float]:
    """f(z) = 10 z^3 - 15 z^4 + 6 z^5: continuous acceleration, 0 at both ends of the ramp, and bounded jerk."""
    rest = 1.0 - z
    return (
        z * z * z * (10.0 + z * (6.0 * z - 15.0)),
        30.0 * z * z * rest * rest,
        60.0 * z * rest * (1.0 - 2.0 * z),
        60.0 + 360.0 * z * (z - 1.0),
    )


def half_ramp(u: float) -> tuple[float, float, float, float]:
    """q(u) = u^3 - u^4 / 2 for 0 <= u <= 1, and its first three derivatives.

    The first derivative rises from 0 (rest) to 1; the second one is 0 at both ends. The value at the end is 1/2: a
    slave that follows the curve travels half as far as its master.
    """
    return u * u * u * (1.0 - 0.5 * u), u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u), 6.0 - 12.0 * u


def half_ramp_mirrored(u: float) -> tuple[float, float, float, float]:
    """u - q(u) = u - u^3 + u^4 / 2 for 0 <= u <= 1, and its first three derivatives: the mirror of `half_ramp`.

    The first derivative falls from 1 to 0 (rest); the second one is 0 at both ends. The value at the end is 1/2, too.
    """
    q, q1, q2, q3 = half_ramp(u)
    return u - q, 1.0 - q1, -q2, -q3


def chain_rule(d1: float, d2: float, d3: float, velocity: float, acceleration: float) -> tuple[float, float, float]:
    """Velocity, acceleration and jerk of a slave that follows a curve over its master.

    d1, d2, d3: the curve's derivatives by the master's position, which moves with `velocity` and `acceleration`; the
    master's jerk is taken as 0.
    """
    v = velocity
    return d1 * v, d1 * acceleration + d2 * v * v, 3.0 * d2 * v * acceleration + d3 * v * v * v


def quintic(
    c0: float, c1: float, c2: float, c3: float, c4: float, c5: float, u: float
) -> tuple[float, float, float, float]:
    """c0 + c1 u + ... + c5 u^5 and its first three derivatives by u."""
    return (
        c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))),
        2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5)),
        6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5),
    )


@dataclass(slots=True)
class Quintic:
    """The polynomial of order 5 whose position and first two derivatives are given at both ends.

    The coefficients c0 to c5 belong to the powers of u = x / length. `rate` is 1 / length, stored because a division
    takes longer than all the rest."""

    length: float = 1.0
    rate: float = 1.0
    c0: float = 0.0
    c1: float = 0.0
    c2: float = 0.0
    c3: float = 0.0
    c4: float = 0.0
    c5: float = 0.0

    def fit(
        self, length: float, position: float, d1: float, d2: float, end: float, end_d1: float, end_d2: float
    ) -> None:
        """Fit the curve over 0 <= x <= length, length > 0, from position, d1, d2 to end, end_d1, end_d2.

        A, B, C are what the first three terms lack at the end in position, first and second derivative by u. Then
        c3 = 10 A - 4 B + C / 2, c4 = -15 A + 7 B - C, c5 = 6 A - 3 B + C / 2."""
        self.length = length
        self.rate = 1.0 / length
        self.c0 = position
        self.c1 = d1 * length
        self.c2 = 0.5 * d2 * length * length
        a = end - position - self.c1 - self.c2
        b = end_d1 * length - self.c1 - 2.0 * self.c2
        c = end_d2 * length * length - 2.0 * self.c2
        self.c3 = 10.0 * a - 4.0 * b + 0.5 * c
        self.c4 = -15.0 * a + 7.0 * b - c
        self.c5 = 6.0 * a - 3.0 * b + 0.5 * c

    def at(self, x: float) -> tuple[float, float, float, float]:
        """Position and its first three derivatives by x."""
        position, d1, d2, d3 = quintic(self.c0, self.c1, self.c2, self.c3, self.c4, self.c5, x / self.length)
        return position, d1 * self.rate, d2 * self.rate * self.rate, d3 * self.rate * self.rate * self.rate
