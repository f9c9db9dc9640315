"""A synchronisation profile: the slave's position as piecewise polynomials of order 5 and less.

Its variable is the nominal time t: the master's travel since the profile's beginning, divided by the nominal velocity
v_m, which the master had there. At constant master velocity t is the time itself. Whatever the master does, the slave
follows the same curve over the master's position. Source: TS5055, sections 3, 4 and 7.
"""

from dataclasses import dataclass

from .. import var
from ..laws import Quintic, quintic
from ..motion import Motion
from ..var import Enumeration

TERMS = 6  # coefficients of a piece


class ProfileKind(Enumeration):
    """Which polynomials the synchronisation is made of"""

    NONE = 0, "in sync at once, or nothing synchronised yet"
    P5 = 1, "one polynomial of order 5 or less"
    P1_P5 = 2, "constant velocity, then a ramp"
    P5_P1 = 3, "a ramp, then the synchronous velocity"
    P5_P1_P5 = 4, "a ramp, constant velocity, a ramp"
    JERK_LIMITED = 5, "time-optimal with limited jerk (time based)"


@dataclass(slots=True)
class Profile:
    """Up to eight pieces; within piece i, begins[i] <= t <= begins[i + 1] and

        position = origin + sum of coefficients[6 i + n] u^n, n = 0 to 5, u = (t - begins[i]) / durations[i].

    Positions in u, times in s. Every duration of a piece is > 0; `rates` are their reciprocals, 1/s. `joint` is where
    the next one of the segments of constant velocity and level ramps begins, u, relative to the origin.
    """

    kind: ProfileKind = ProfileKind.NONE
    pieces: int = 0
    origin: float = 0.0
    joint: float = 0.0
    begins: list[float] = var.ring(9)
    durations: list[float] = var.ring(8)
    rates: list[float] = var.ring(8)
    coefficients: list[float] = var.ring(48)

    def begin(self, kind: ProfileKind, origin: float) -> None:
        """Drop all pieces; the first new one begins at the position `origin`, u, at the nominal time 0."""
        self.kind = kind
        self.origin = origin
        self.joint = 0.0
        self.pieces = 0
        self.begins[0] = 0.0

    def add(self, duration: float, c0: float, c1: float, c2: float, c3: float, c4: float, c5: float) -> None:
        """Append a piece; its position in powers of u counts from the origin."""
        self.coefficients[TERMS * self.pieces] = c0
        self.coefficients[TERMS * self.pieces + 1] = c1
        self.coefficients[TERMS * self.pieces + 2] = c2
        self.coefficients[TERMS * self.pieces + 3] = c3
        self.coefficients[TERMS * self.pieces + 4] = c4
        self.coefficients[TERMS * self.pieces + 5] = c5
        self.durations[self.pieces] = duration
        self.rates[self.pieces] = 1.0 / duration
        self.pieces += 1
        self.begins[self.pieces] = self.begins[self.pieces - 1] + duration

    def add_quintic(self, curve: Quintic) -> None:
        """Append a piece along a quintic over the time from 0, whose position counts from the origin."""
        self.add(curve.length, curve.c0, curve.c1, curve.c2, curve.c3, curve.c4, curve.c5)

    def add_motion(self, motion: Motion) -> None:
        """Append all pieces of a motion in time but the last one, which has no end."""
        for i in range(motion.pieces - 1):
            t = motion.begins[i + 1] - motion.begins[i]
            self.add(
                t,
                motion.positions[i] - self.origin,
                motion.velocities[i] * t,
                0.5 * motion.accelerations[i] * t * t,
                motion.jerks[i] * t * t * t / 6.0,
                0.0,
                0.0,
            )

    def duration(self) -> float:
        """The nominal time of all pieces, s; 0 without a piece."""
        return self.begins[self.pieces]

    def distance(self) -> float:
        """From the origin to the position at the end, u, with its sign; 0 without a piece."""
        last = self.pieces - 1
        return self.coefficients[TERMS * last] + self.distance_in(last, 1.0) if last >= 0 else 0.0

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position (u), velocity, acceleration and jerk (u/s, u/s2, u/s3) at constant master velocity."""
        i = 0
        while i < self.pieces - 1 and time > self.begins[i + 1]:
            i += 1
        return self.within(i, (time - self.begins[i]) * self.rates[i])

    def within(self, i: int, u: float) -> tuple[float, float, float, float]:
        """The same as `at`, at u in piece i: a time would be rounded in a short piece, u is not."""
        rate = self.rates[i]
        position, d1, d2, d3 = quintic(
            self.coefficients[TERMS * i],
            self.coefficients[TERMS * i + 1],
            self.coefficients[TERMS * i + 2],
            self.coefficients[TERMS * i + 3],
            self.coefficients[TERMS * i + 4],
            self.coefficients[TERMS * i + 5],
            u,
        )
        return self.origin + position, d1 * rate, d2 * rate * rate, d3 * rate * rate * rate

    def distance_in(self, i: int, u: float) -> float:
        """From the beginning of piece i to u in it, u, with its sign."""
        c1 = self.coefficients[TERMS * i + 1]
        c2 = self.coefficients[TERMS * i + 2]
        c3 = self.coefficients[TERMS * i + 3]
        c4 = self.coefficients[TERMS * i + 4]
        c5 = self.coefficients[TERMS * i + 5]
        return u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
