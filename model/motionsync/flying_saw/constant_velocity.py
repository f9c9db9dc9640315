"""The constant velocity of P5+P1+P5 where it is preferred: both ramps are as short as the limits allow.

The README of this folder derives the search, with a picture of T_a + T_b over c. Source: TS5055, section 7
(PREFERCONSTVELO).
"""

from dataclasses import dataclass
from math import inf

from .. import var
from ..motion.jerk_limited import acceleration_limit
from ..numerics.bracket import can_halve, halve, middle
from .segments import level_ramp_duration

NO_RAMP = 1e-12  # of the greater velocity at the ends: a smaller change of velocity is rounding
MEAN_ACCELERATION = 2.0 / 3.0  # of a ramp's peak acceleration


@dataclass(slots=True)
class ConstantVelocity:
    """Finds the velocity c with which the slave travels `distance` in `duration`, from `velocity` v to `end` v_e.

    The ramps to and from c take T_a(c) and T_b(c); f(c) is the distance.

    Attributes:
        duration, distance, velocity, end: T (s), the distance (u), v and v_e (u/s), which are set before.
        acceleration, deceleration, jerk: the limits, set before; a jerk of 0 is not limited.
        cruise, rise, fall: c, T_a and T_b, the results.
        side, near, far: the present range: c is on this side of zero, 1 or -1, from `near` to `far` away from it.
        rise_limit, fall_limit: the acceleration limits of the ramps to and from c in that range.
        cuts, cut_count: the ends of the intervals in the present range, in rising order, as distances from zero.
    """

    duration: float = 0.0
    distance: float = 0.0
    velocity: float = 0.0
    end: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0
    jerk: float = 0.0
    cruise: float = 0.0
    rise: float = 0.0
    fall: float = 0.0
    side: float = 1.0
    near: float = 0.0
    far: float = 0.0
    rise_limit: float = 0.0
    fall_limit: float = 0.0
    cuts: list[float] = var.array(16)
    cut_count: int = 0

    def try_solve(self) -> bool:
        """Find c; whether there is one."""
        side = 1.0 if self.end >= 0.0 else -1.0
        return self.try_on_side(side) or self.try_on_side(-side)

    def try_on_side(self, side: float) -> bool:
        """Find c on one side of zero, from zero outwards, in the three ranges that |v| and |v_e| divide it into."""
        self.side = side
        first = max(min(side * self.velocity, side * self.end), 0.0)
        second = max(side * self.velocity, side * self.end, 0.0)
        steepest = max(self.acceleration, self.deceleration)
        far = second + MEAN_ACCELERATION * steepest * self.duration
        return self.try_in_range(0.0, first) or self.try_in_range(first, second) or self.try_in_range(second, far)

    def try_in_range(self, near: float, far: float) -> bool:
        """Find c in a range in which the same limits hold; `near` and `far` are its ends' distances from zero."""
        if not near < far < inf:
            return False
        self.near = near
        self.far = far
        inside = self.side * middle(near, far)
        self.rise_limit = acceleration_limit(self.velocity, inside, self.acceleration, self.deceleration)
        self.fall_limit = acceleration_limit(inside, self.end, self.acceleration, self.deceleration)
        self.cut_count = 0
        self.add_cut(near)
        self.add_cuts_of_ramp(self.velocity, self.rise_limit, self.fall_limit)
        self.add_cuts_of_ramp(self.end, self.fall_limit, self.rise_limit)
        self.add_cut(self.side * middle(self.velocity, self.end))
        self.add_cut(far)
        is_solved = False
        for i in range(self.cut_count - 1):
            is_solved = is_solved or self.try_in_interval(self.cuts[i], self.cuts[i + 1])
        return is_solved

    def add_cuts_of_ramp(self, start: float, limit: float, other: float) -> None:
        """Cut where the ramp between `start` and c passes from its jerk limit to its acceleration limit A,
        |dv| = 8 A^2 / (3 J), and where its duration, limited by jerk, changes with c as fast as the other ramp's,
        limited by acceleration A', |dv| = 2 A'^2 / (3 J)."""
        if self.jerk > 0.0:
            for sign in range(2):
                direction = 1.0 if sign == 1 else -1.0
                self.add_cut(self.side * (start + direction * 8.0 * limit * limit / (3.0 * self.jerk)))
                self.add_cut(self.side * (start + direction * 2.0 * other * other / (3.0 * self.jerk)))

    def add_cut(self, at: float) -> None:
        """Insert a cut in rising order, if it is in the range."""
        if self.near <= at <= self.far:
            i = self.cut_count
            while i > 0 and self.cuts[i - 1] > at:
                self.cuts[i] = self.cuts[i - 1]
                i -= 1
            self.cuts[i] = at
            self.cut_count += 1

    def try_in_interval(self, near: float, far: float) -> bool:
        """Find c between two cuts, where T_a + T_b is monotone: first the part in which it fits into T, then c."""
        side = self.side
        fits_near = self.fits(side * near)
        fits_far = self.fits(side * far)
        if not fits_near and not fits_far:
            return False
        if fits_near != fits_far:
            fitting = near if fits_near else far
            unfitting = far if fits_near else near
            while can_halve(fitting, unfitting):
                fits = self.fits(side * middle(fitting, unfitting))
                fitting, unfitting = halve(fitting, unfitting, not fits)
            if fits_near:
                far = fitting
            else:
                near = fitting
        return self.try_between(side * near, side * far)

    def try_between(self, near: float, far: float) -> bool:
        """Find c between two velocities where everything fits, if their distances bracket the required one."""
        low = min(near, far)
        high = max(near, far)
        if not self.distance_at(low) <= self.distance <= self.distance_at(high):
            return False
        while can_halve(low, high):
            low, high = halve(low, high, self.distance_at(middle(low, high)) > self.distance)
        nearer = abs(self.distance_at(low) - self.distance) <= abs(self.distance_at(high) - self.distance)
        self.cruise = low if nearer else high
        self.snap_to(self.velocity)
        self.snap_to(self.end)
        self.rise = self.rise_time(self.cruise)
        self.fall = self.fall_time(self.cruise)
        return True

    def snap_to(self, velocity: float) -> None:
        """Make c the velocity at an end from which it differs by rounding only: no ramp is needed there."""
        if abs(self.cruise - velocity) <= NO_RAMP * max(abs(self.velocity), abs(self.end)):
            self.cruise = velocity

    def rise_time(self, cruise: float) -> float:
        """T_a, s."""
        return level_ramp_duration(cruise - self.velocity, self.rise_limit, self.jerk)

    def fall_time(self, cruise: float) -> float:
        """T_b, s."""
        return level_ramp_duration(self.end - cruise, self.fall_limit, self.jerk)

    def fits(self, cruise: float) -> bool:
        """Whether both ramps fit into the duration."""
        return self.rise_time(cruise) + self.fall_time(cruise) <= self.duration

    def distance_at(self, cruise: float) -> float:
        """f(c), u."""
        return cruise * self.duration - 0.5 * (
            (cruise - self.velocity) * self.rise_time(cruise) + (cruise - self.end) * self.fall_time(cruise)
        )
