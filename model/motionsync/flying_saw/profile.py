"""A synchronisation profile: the slave's position as piecewise polynomials of order 5 and less.

Its variable is the nominal time t: the master's travel since the profile's start, divided by the nominal velocity v_m,
which the master had there. At constant master velocity t is the time itself. Whatever the master does, the slave
follows the same curve over the master's position. Source: TS5055, sections 3, 4 and 7.
"""

from dataclasses import dataclass

from .. import var
from ..motion.jerk_limited import Motion
from ..motion.laws import Quintic, chain_rule, quintic
from ..numerics.computable_range import clamp
from ..var import Enumeration

TERMS = 6  # coefficients of a segment
LARGEST_RATIO = 1e60  # to the nominal master velocity: products of the derivatives with its powers are finite


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
    """Up to eight segments; within segment i, start_times[i] <= t <= start_times[i + 1] and

        position = origin + sum of coefficients[6 i + n] u^n, n = 0 to 5, u = (t - start_times[i]) / durations[i].

    Positions in u, times in s. Every duration of a segment is > 0; `rates` are their reciprocals, 1/s. At
    `next_position`, u from the origin, the next segment of constant velocity, or the next level ramp, starts.
    """

    kind: ProfileKind = ProfileKind.NONE
    segments: int = 0
    origin: float = 0.0
    next_position: float = 0.0
    start_times: list[float] = var.array(9)
    durations: list[float] = var.array(8)
    rates: list[float] = var.array(8)
    coefficients: list[float] = var.array(48)

    def start(self, kind: ProfileKind, origin: float) -> None:
        """Remove all segments; the first new one starts at the position `origin`, u, at the nominal time 0."""
        self.kind = kind
        self.origin = origin
        self.next_position = 0.0
        self.segments = 0
        self.start_times[0] = 0.0

    def add_segment(self, duration: float, c0: float, c1: float, c2: float, c3: float, c4: float, c5: float) -> None:
        """Append a segment; its position in powers of u counts from the origin."""
        self.coefficients[TERMS * self.segments] = c0
        self.coefficients[TERMS * self.segments + 1] = c1
        self.coefficients[TERMS * self.segments + 2] = c2
        self.coefficients[TERMS * self.segments + 3] = c3
        self.coefficients[TERMS * self.segments + 4] = c4
        self.coefficients[TERMS * self.segments + 5] = c5
        self.durations[self.segments] = duration
        self.rates[self.segments] = 1.0 / duration
        self.segments += 1
        self.start_times[self.segments] = self.start_times[self.segments - 1] + duration

    def add_quintic(self, curve: Quintic) -> None:
        """Append a segment along a quintic over the time from 0, whose position counts from the origin."""
        self.add_segment(curve.length, curve.c0, curve.c1, curve.c2, curve.c3, curve.c4, curve.c5)

    def add_motion(self, motion: Motion) -> None:
        """Append all segments of a motion in time but the last one, which has no end."""
        for i in range(motion.segments - 1):
            t = motion.start_times[i + 1] - motion.start_times[i]
            c2 = 0.5 * motion.accelerations[i] * t * t
            c3 = motion.jerks[i] * t * t * t / 6.0
            self.add_segment(t, motion.positions[i] - self.origin, motion.velocities[i] * t, c2, c3, 0.0, 0.0)

    def duration(self) -> float:
        """The nominal time of all segments, s; 0 without a segment."""
        return self.start_times[self.segments]

    def distance(self) -> float:
        """From the origin to the position at the end, u, with its sign; 0 without a segment."""
        last = self.segments - 1
        return self.coefficients[TERMS * last] + self.segment_distance(last, 1.0) if last >= 0 else 0.0

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position (u), velocity, acceleration and jerk (u/s, u/s2, u/s3) at constant master velocity."""
        i = 0
        while i < self.segments - 1 and time > self.start_times[i + 1]:
            i += 1
        return self.segment_state(i, (time - self.start_times[i]) * self.rates[i])

    def at_or_at_rest(self, time: float) -> tuple[float, float, float, float]:
        """The same as `at` up to the end; after it the rest at the position there, which is where a halt ends."""
        if time < self.duration():
            return self.at(time)
        return self.origin + self.distance(), 0.0, 0.0, 0.0

    def follow(
        self, distance: float, velocity: float, acceleration: float, per_nominal_velocity: float, may_be_before: bool
    ) -> tuple[float, float, float, float]:
        """Position (u), velocity, acceleration and jerk for a master that has travelled `distance` since the start.

        The master moves with `velocity` and `acceleration`; its jerk is taken as 0. `per_nominal_velocity` is 1 / v_m.
        The master may have been nearly at rest at the start, so its velocity and acceleration over v_m are limited to
        where products stay finite. Where it `may_be_before` the start, there the slave goes on at its velocity then."""
        time = distance * per_nominal_velocity
        is_before = may_be_before and time < 0.0
        position, v, a, j = self.at(0.0 if is_before else time)
        if is_before:
            position += v * time
            a = 0.0
            j = 0.0
        relative_velocity = clamp(velocity * per_nominal_velocity, -LARGEST_RATIO, LARGEST_RATIO)
        relative_acceleration = clamp(acceleration * per_nominal_velocity, -LARGEST_RATIO, LARGEST_RATIO)
        v, a, j = chain_rule(v, a, j, relative_velocity, relative_acceleration)
        return position, v, a, j

    def segment_state(self, i: int, u: float) -> tuple[float, float, float, float]:
        """The same as `at`, at u in segment i: a time would be rounded in a short segment, u is not."""
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

    def segment_distance(self, i: int, u: float) -> float:
        """From the start of segment i to u in it, u, with its sign."""
        c1 = self.coefficients[TERMS * i + 1]
        c2 = self.coefficients[TERMS * i + 2]
        c3 = self.coefficients[TERMS * i + 3]
        c4 = self.coefficients[TERMS * i + 4]
        c5 = self.coefficients[TERMS * i + 5]
        return u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
