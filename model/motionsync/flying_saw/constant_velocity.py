"""The constant velocity of P5+P1+P5 where it is preferred: both ramps as steep as the limits allow.

Source: TS5055, section 7 (PREFERCONSTVELO).
"""

from dataclasses import dataclass
from math import inf

from .. import var
from ..motion import acceleration_limit
from .shapes import level_ramp_duration

BISECTIONS = 200  # enough to halve any interval down to neighbouring numbers but for those next to 0
EQUAL = 1e-12  # of the greater velocity: rounding
SHARE = 2.0 / 3.0  # a ramp of time T changes the velocity by 2/3 a T at most


@dataclass(slots=True)
class ConstantVelocity:
    """From `velocity` to `end` with the way `way` in the time `duration`: find c.

    The ramps to and from c take T_a(c) and T_b(c), and the whole way is f(c) = c T - (c - v) T_a / 2 - (c - v_e) T_b /
    2. Where T_a + T_b <= T, f rises; elsewhere there is no profile. So the numbers are cut where T_a + T_b is not
    smooth, or not monotone: at 0, v, v_e (other limits hold on the other side), where a ramp's jerk limit takes over
    from its acceleration limit, and where T_a + T_b turns. In each interval between, the part with T_a + T_b <= T is
    an interval too, in which f is bracketed. The side of zero that holds v_e comes first.

    Attributes:
        cruise, rise, fall: c, T_a, T_b, if `solve` has found them.
        low, high: the limits of acceleration in the ramps before and after c, for c between two cuts.
    """

    duration: float = 0.0
    way: float = 0.0
    velocity: float = 0.0
    end: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0
    jerk: float = 0.0
    cruise: float = 0.0
    rise: float = 0.0
    fall: float = 0.0
    before: float = 0.0
    after: float = 0.0
    cuts: list[float] = var.ring(16)
    count: int = 0

    def solve(self) -> bool:
        """Whether there is a constant velocity; the values of the search are set before."""
        side = 1.0 if self.end >= 0.0 else -1.0
        return self.search(side) or self.search(-side)

    def search(self, side: float) -> bool:
        """On one side of zero, from zero outwards: three parts, divided by |v| and |v_e| where they lie there."""
        first = max(min(side * self.velocity, side * self.end), 0.0)
        second = max(side * self.velocity, side * self.end, 0.0)
        steepest = max(self.acceleration, self.deceleration)
        far = second + SHARE * steepest * self.duration
        return self.part(side, 0.0, first) or self.part(side, first, second) or self.part(side, second, far)

    def part(self, side: float, near: float, far: float) -> bool:
        """Between two cuts of the limits; `near` and `far` are distances from zero."""
        if not near < far < inf:
            return False
        middle = side * (near + 0.5 * (far - near))
        self.before = acceleration_limit(self.velocity, middle, self.acceleration, self.deceleration)
        self.after = acceleration_limit(middle, self.end, self.acceleration, self.deceleration)
        self.count = 0
        self.cut(near, near, far)
        self.bend(self.velocity, self.before, self.after, side, near, far)
        self.bend(self.end, self.after, self.before, side, near, far)
        self.cut(side * (self.velocity + 0.5 * (self.end - self.velocity)), near, far)
        self.cut(far, near, far)
        found = False
        for i in range(self.count - 1):
            found = found or self.interval(side, self.cuts[i], self.cuts[i + 1])
        return found

    def bend(self, start: float, limit: float, other: float, side: float, near: float, far: float) -> None:
        """Cut where the ramp between `start` and c passes from its jerk limit to its acceleration limit, |dv| = 8 a^2 /
        (3 J), and where it is in its jerk limit and as steep in c as the other ramp is in its acceleration limit, |dv|
        = a^2 * 2 / (3 J)."""
        if self.jerk > 0.0:
            for sign in range(2):
                direction = 1.0 if sign == 1 else -1.0
                self.cut(side * (start + direction * 8.0 * limit * limit / (3.0 * self.jerk)), near, far)
                self.cut(side * (start + direction * 2.0 * other * other / (3.0 * self.jerk)), near, far)

    def cut(self, at: float, near: float, far: float) -> None:
        """Put a cut in order, if it lies in the part."""
        if near <= at <= far:
            i = self.count
            while i > 0 and self.cuts[i - 1] > at:
                self.cuts[i] = self.cuts[i - 1]
                i -= 1
            self.cuts[i] = at
            self.count += 1

    def interval(self, side: float, near: float, far: float) -> bool:
        """T_a + T_b is monotone here: the part with T_a + T_b <= T, then c in it."""
        fits_near = self.fits(side * near)
        fits_far = self.fits(side * far)
        if not fits_near and not fits_far:
            return False
        if fits_near != fits_far:
            good = near if fits_near else far
            bad = far if fits_near else near
            for _ in range(BISECTIONS):
                middle = good + 0.5 * (bad - good)
                if not min(good, bad) < middle < max(good, bad):
                    break
                if self.fits(side * middle):
                    good = middle
                else:
                    bad = middle
            if fits_near:
                far = good
            else:
                near = good
        return self.accept(side * near, side * far)

    def accept(self, near: float, far: float) -> bool:
        """c between two velocities, if the way there brackets the one wanted."""
        low = min(near, far)
        high = max(near, far)
        if not self.travel(low) <= self.way <= self.travel(high):
            return False
        for _ in range(BISECTIONS):
            middle = low + 0.5 * (high - low)
            if not low < middle < high:
                break
            if self.travel(middle) <= self.way:
                low = middle
            else:
                high = middle
        self.cruise = low if abs(self.travel(low) - self.way) <= abs(self.travel(high) - self.way) else high
        self.settle(self.velocity)
        self.settle(self.end)
        self.rise = self.rise_time(self.cruise)
        self.fall = self.fall_time(self.cruise)
        return True

    def settle(self, velocity: float) -> None:
        """A c that differs by rounding from a velocity at an end is that velocity, and needs no ramp."""
        if abs(self.cruise - velocity) <= EQUAL * max(abs(self.velocity), abs(self.end)):
            self.cruise = velocity

    def rise_time(self, cruise: float) -> float:
        return level_ramp_duration(cruise - self.velocity, self.before, self.jerk)

    def fall_time(self, cruise: float) -> float:
        return level_ramp_duration(self.end - cruise, self.after, self.jerk)

    def fits(self, cruise: float) -> bool:
        return self.rise_time(cruise) + self.fall_time(cruise) <= self.duration

    def travel(self, cruise: float) -> float:
        return cruise * self.duration - 0.5 * (
            (cruise - self.velocity) * self.rise_time(cruise) + (cruise - self.end) * self.fall_time(cruise)
        )
