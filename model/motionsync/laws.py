"""Polynomial curves that several blocks lay through their boundary conditions.

The variable x is the master's travel or time, whatever drives the block; derivatives are with respect to it.
"""

from dataclasses import dataclass


def half_ramp(u: float) -> tuple[float, float, float, float]:
    """q(u) = u^3 - u^4 / 2 for 0 <= u <= 1, and its first three derivatives.

    From rest (slope 0) to slope 1, without curvature at both ends; the value at the end is 1/2: whoever follows it
    travels half of what the master does.
    """
    return u * u * u * (1.0 - 0.5 * u), u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u), 6.0 - 12.0 * u


def half_ramp_mirrored(u: float) -> tuple[float, float, float, float]:
    """u - q(u) = u - u^3 + u^4 / 2 for 0 <= u <= 1, and its first three derivatives: the mirror of `half_ramp`.

    From slope 1 to rest (slope 0), with a second derivative of 0 at both ends; the value at the end is 1/2 too.
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


@dataclass(slots=True)
class Quintic:
    """The polynomial of order 5 with position, slope and curvature given at both ends.

    c0 to c5 go with u = x / length; `rate` is 1 / length: a division costs more than all of the rest."""

    length: float = 1.0
    rate: float = 1.0
    c0: float = 0.0
    c1: float = 0.0
    c2: float = 0.0
    c3: float = 0.0
    c4: float = 0.0
    c5: float = 0.0

    def fit(
        self,
        length: float,
        position: float,
        slope: float,
        curvature: float,
        end: float,
        end_slope: float,
        end_curvature: float,
    ) -> None:
        """`length` > 0. With what the start lacks at the end, A in position, B in slope, C in curvature (by u),
        c3 = 10 A - 4 B + C / 2, c4 = -15 A + 7 B - C, c5 = 6 A - 3 B + C / 2."""
        self.length = length
        self.rate = 1.0 / length
        self.c0 = position
        self.c1 = slope * length
        self.c2 = 0.5 * curvature * length * length
        a = end - position - self.c1 - self.c2
        b = end_slope * length - self.c1 - 2.0 * self.c2
        c = end_curvature * length * length - 2.0 * self.c2
        self.c3 = 10.0 * a - 4.0 * b + 0.5 * c
        self.c4 = -15.0 * a + 7.0 * b - c
        self.c5 = 6.0 * a - 3.0 * b + 0.5 * c

    def at(self, x: float) -> tuple[float, float, float, float]:
        """Position and its first three derivatives."""
        u = x / self.length
        position = self.c0 + u * (self.c1 + u * (self.c2 + u * (self.c3 + u * (self.c4 + u * self.c5))))
        slope = self.c1 + u * (2.0 * self.c2 + u * (3.0 * self.c3 + u * (4.0 * self.c4 + u * 5.0 * self.c5)))
        curvature = 2.0 * self.c2 + u * (6.0 * self.c3 + u * (12.0 * self.c4 + u * 20.0 * self.c5))
        twist = 6.0 * self.c3 + u * (24.0 * self.c4 + u * 60.0 * self.c5)
        return position, slope * self.rate, curvature * self.rate * self.rate, twist * self.rate * self.rate * self.rate
