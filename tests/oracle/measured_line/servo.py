"""A position controller with feedforward of the velocity, exact: in closed form between the kinks of its setpoint.

    s_d(t) = s(t - dead_time)    u = feedforward s_d' + Kv (s_d - x)    Tv v' = u - v    x' = v

On an interval on which s_d is a cubic, x is a cubic, found by its coefficients, plus a solution of the homogeneous
equation Tv x'' + x' + Kv x = 0, by its characteristic roots. Tv = 0: x' = u.

Where the description may be read in two ways, this is the reading:
- Before the first time the setpoint rests at its first position, whatever its first velocity is. So its velocity may
  jump at the start, that of the delayed setpoint `dead_time` later; x begins there at rest.
- A row has the values just before its time: at the end of a step. With Tv = 0 it matters for the acceleration, which
  jumps with the setpoint's; and where the setpoint's velocity jumps at the start, for the acceleration, and with Tv = 0
  for the velocity. A kink that is nearer to a row than 1e-9 of the step belongs to that row: a dead time may be a
  multiple of the step, but for the rounding of numbers.
- Positions are not wrapped. The following error is s(t) - x(t): the dead time is part of it.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

TOLERANCE = mp.mpf(10) ** -9


@dataclass(frozen=True)
class Cubic:
    """Coefficients, in rising order, of a polynomial of the time since `begin` (s)."""

    begin: Number
    coefficients: tuple[Number, Number, Number, Number]

    def at(self, time: Number) -> tuple[Number, Number, Number]:
        """Value, first and second derivative."""
        t = time - self.begin
        c0, c1, c2, c3 = self.coefficients
        return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + t * 3 * c3), 2 * c2 + t * 6 * c3


class Servo:
    """`position_gain` Kv (1/s) > 0, `velocity_time_constant` Tv (s), `feedforward` (a share), `dead_time` (s)."""

    def __init__(
        self,
        position_gain: Number,
        velocity_time_constant: Number = 0.0,
        feedforward: Number = 1.0,
        dead_time: Number = 0.0,
    ) -> None:
        self.gain = mp.mpf(position_gain)
        self.time_constant = mp.mpf(velocity_time_constant)
        self.feedforward = mp.mpf(feedforward)
        self.dead_time = mp.mpf(dead_time)

    def run(
        self, times: Sequence[Number], positions: Sequence[Number], velocities: Sequence[Number]
    ) -> tuple[list[Number], list[Number], list[Number]]:
        """Actual positions, velocities and accelerations at the times, which rise, for the setpoint at these times."""
        setpoint = hermite(times, positions, velocities)
        delayed = [Cubic(piece.begin + self.dead_time, piece.coefficients) for piece in setpoint]
        kinks = [piece.begin for piece in delayed[1:]]
        rows = [(mp.mpf(positions[0]), mp.mpf(0), mp.mpf(0))]
        for begin, end in pairwise(map(mp.mpf, times)):
            margin = TOLERANCE * (end - begin)
            present = bisect_right(kinks, begin + margin)
            until = bisect_right(kinks, end - margin)
            row, limits = rows[-1], [begin, *kinks[present:until], end]
            for piece, (a, b) in zip(delayed[present : until + 1], pairwise(limits), strict=True):
                row = self._moved(row, piece, a, b)
            rows.append(row)
        x, v, a = zip(*rows, strict=True)
        return list(x), list(v), list(a)

    def _moved(
        self, row: tuple[Number, Number, Number], setpoint: Cubic, begin: Number, end: Number
    ) -> tuple[Number, Number, Number]:
        """Position, velocity and acceleration at `end` after those at `begin`."""
        steady = self._steady(setpoint)
        p, q, _ = steady.at(begin)
        x, v = self._free(row[0] - p, row[1] - q, end - begin)
        p, q, _ = steady.at(end)
        x += p
        s, s1, s2 = setpoint.at(end)
        u = self.feedforward * s1 + self.gain * (s - x)
        if not self.time_constant:
            return x, u, self.feedforward * s2 + self.gain * (s1 - u)
        v += q
        return x, v, (u - v) / self.time_constant

    def _steady(self, setpoint: Cubic) -> Cubic:
        """The cubic that solves the equation of motion: by comparing the coefficients."""
        k, tv = self.gain, self.time_constant
        s0, s1, s2, s3 = setpoint.coefficients
        c3 = s3
        c2 = s2 + (3 * self.feedforward * s3 - 3 * c3) / k
        c1 = s1 + (2 * self.feedforward * s2 - 2 * c2 - 6 * tv * c3) / k
        c0 = s0 + (self.feedforward * s1 - c1 - 2 * tv * c2) / k
        return Cubic(setpoint.begin, (c0, c1, c2, c3))

    def _free(self, x: Number, v: Number, t: Number) -> tuple[Number, Number]:
        """The homogeneous equation's position and velocity after the time t; without Tv the velocity is not used."""
        if not self.time_constant:
            x *= mp.exp(-self.gain * t)
            return x, -self.gain * x
        damping, stiffness = 1 / (2 * self.time_constant), self.gain / self.time_constant
        square = damping * damping - stiffness
        w = mp.sqrt(abs(square))
        if square > 0:  # two real roots
            slow, fast = mp.exp(-stiffness / (damping + w) * t), mp.exp(-(damping + w) * t)
            c, s = (slow + fast) / 2, (slow - fast) / (2 * w)
        else:
            decay = mp.exp(-damping * t)
            c, s = decay * mp.cos(w * t), decay * (mp.sin(w * t) / w if w else t)
        return x * c + (v + damping * x) * s, v * c - (damping * v + stiffness * x) * s


def hermite(times: Sequence[Number], positions: Sequence[Number], velocities: Sequence[Number]) -> list[Cubic]:
    """The cubics through positions and velocities at both ends of each step, after the one at rest before the start.

    Raises ValueError if the times do not rise.
    """
    rows = [tuple(map(mp.mpf, row)) for row in zip(times, positions, velocities, strict=True)]
    first, zero = rows[0], mp.mpf(0)
    pieces = [Cubic(first[0], (first[1], zero, zero, zero))]
    for (t0, p0, v0), (t1, p1, v1) in pairwise(rows):
        h = t1 - t0
        if h <= 0:
            raise ValueError(f"the time {t1} follows {t0}; times must rise")
        slope = (p1 - p0) / h
        pieces.append(Cubic(t0, (p0, v0, (3 * slope - 2 * v0 - v1) / h, (v0 + v1 - 2 * slope) / (h * h))))
    return pieces
