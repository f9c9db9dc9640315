"""A synchronisation profile: the slave's position as piecewise polynomials of order 5 and less.

The variable is the nominal time t: what the master has travelled since the profile's beginning, divided by the nominal
velocity v_m that it had there. At constant master velocity it is time itself; whatever the master does, the slave
follows the same curve over the master's position. Source: TS5055, sections 3, 4 and 7.
"""

from dataclasses import dataclass

from .. import var
from ..laws import Quintic
from ..var import Enumeration

ORDER = 6  # coefficients of a piece


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
    """Up to four pieces; within piece i, begins[i] <= t <= begins[i + 1] and

        position = origin + sum of coefficients[6 i + n] u^n, n = 0 to 5, u = (t - begins[i]) / durations[i].

    Positions in u, times in s. Every duration of a piece is > 0; `rates` are their reciprocals, 1/s.
    """

    kind: ProfileKind = ProfileKind.NONE
    pieces: int = 0
    origin: float = 0.0
    begins: list[float] = var.ring(5)
    durations: list[float] = var.ring(4)
    rates: list[float] = var.ring(4)
    coefficients: list[float] = var.ring(24)

    def begin(self, kind: ProfileKind, origin: float) -> None:
        """No pieces yet; the first one will begin at the position `origin` at nominal time 0."""
        self.kind = kind
        self.origin = origin
        self.pieces = 0
        self.begins[0] = 0.0

    def add(self, duration: float, c0: float, c1: float, c2: float, c3: float, c4: float, c5: float) -> None:
        """One more piece, its position in powers of u, relative to the origin."""
        at = ORDER * self.pieces
        self.coefficients[at] = c0
        self.coefficients[at + 1] = c1
        self.coefficients[at + 2] = c2
        self.coefficients[at + 3] = c3
        self.coefficients[at + 4] = c4
        self.coefficients[at + 5] = c5
        self.durations[self.pieces] = duration
        self.rates[self.pieces] = 1.0 / duration
        self.pieces += 1
        self.begins[self.pieces] = self.begins[self.pieces - 1] + duration

    def whole(self, curve: Quintic) -> None:
        """One piece, along a quintic over the time from 0, relative to the origin."""
        self.add(curve.length, curve.c0, curve.c1, curve.c2, curve.c3, curve.c4, curve.c5)

    def take(self, other: "Profile") -> None:
        """Become a copy of the other."""
        self.kind = other.kind
        self.origin = other.origin
        self.pieces = other.pieces
        for i in range(other.pieces):
            self.begins[i + 1] = other.begins[i + 1]
            self.durations[i] = other.durations[i]
            self.rates[i] = other.rates[i]
        for i in range(ORDER * other.pieces):
            self.coefficients[i] = other.coefficients[i]

    def duration(self) -> float:
        """s, nominal; 0 without a piece."""
        return self.begins[self.pieces]

    def way(self) -> float:
        """From the beginning to the end, in u."""
        last = self.pieces - 1
        return self.coefficients[ORDER * last] + self.passed(last, 1.0) if last >= 0 else 0.0

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position (u), velocity, acceleration and jerk (u/s, u/s2, u/s3) at constant master velocity."""
        i = 0
        while i < self.pieces - 1 and time > self.begins[i + 1]:
            i += 1
        return self.within(i, (time - self.begins[i]) * self.rates[i])

    def within(self, i: int, u: float) -> tuple[float, float, float, float]:
        """As `at`, at u in piece i: unlike a time, u is not rounded in a short piece."""
        rate = self.rates[i]
        at = ORDER * i
        c1 = self.coefficients[at + 1]
        c2 = self.coefficients[at + 2]
        c3 = self.coefficients[at + 3]
        c4 = self.coefficients[at + 4]
        c5 = self.coefficients[at + 5]
        position = self.origin + (self.coefficients[at] + self.passed(i, u))
        velocity = c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        acceleration = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))
        jerk = 6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5)
        return position, velocity * rate, acceleration * rate * rate, jerk * rate * rate * rate

    def passed(self, i: int, u: float) -> float:
        """The way from the beginning of piece i to u in it."""
        at = ORDER * i
        c1 = self.coefficients[at + 1]
        c2 = self.coefficients[at + 2]
        c3 = self.coefficients[at + 3]
        c4 = self.coefficients[at + 4]
        c5 = self.coefficients[at + 5]
        return u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
