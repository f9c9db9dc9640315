"""The master's path inside one step, divided at its turning points into monotone sections.

Section 0 is the input correction: the step before ended where the master was predicted to be, and the present input
gives where the master is. The straight section from the one position to the other takes no time.

If the inputs hold the master at the beginning of the step, the path is a parabola. If they hold the master at the end
of the step, the path is the cubic through the positions and velocities of both ends.
"""

from dataclasses import dataclass
from math import isfinite, sqrt

from . import var
from .clock import Clock
from .numerics.bracket import can_halve, halve, middle
from .numerics.computable_range import clamp

GREATEST_SPEED = 1e154  # u/s: its square is finite
NEVER = 1e300  # s since the step's beginning
MOST_EVENTS = 10_000_000  # in a section: ten for each of the most cycles that a step may have; so many never happen


@dataclass(slots=True)
class MasterPath:
    """x(t) = origin + t (velocity + t (c2 + t c3)), 0 <= t <= h; u, u/s, u/s2, u/s3.

    Section i, 0 <= i < sections, is monotone from positions[i] at times[i] to positions[i + 1] at times[i + 1]. The
    motion within the step starts with section 1, at positions[1] = origin.

    A block goes along section after section, and on each from event to event. What is left of `section` leads from
    `reached`, where the master is at the time `now`, to `end` at the time `until`; the times count from the step's
    beginning.
    """

    origin: float = 0.0
    velocity: float = 0.0
    c2: float = 0.0
    c3: float = 0.0
    sections: int = 0
    times: list[float] = var.array(5)
    positions: list[float] = var.array(5)
    section: int = 0
    reached: float = 0.0
    now: float = 0.0
    end: float = 0.0
    until: float = 0.0

    def set_parabola(self, former: float, origin: float, velocity: float, acceleration: float, h: float) -> None:
        """The path of constant acceleration over h, after the correction from `former`. It has at most one turning
        point."""
        self.start(former, origin, velocity, 0.5 * acceleration, 0.0)
        end = origin + (velocity + 0.5 * acceleration * h) * h
        if velocity * (velocity + acceleration * h) < 0.0:
            self.add_turning_point(-velocity / acceleration)
            self.end_section(h, end)
        else:
            self.times[2] = h
            self.positions[2] = end
            self.sections = 2

    def set_cubic(self, origin: float, velocity: float, end: float, end_velocity: float, h: float) -> None:
        """The cubic with these positions and velocities at its ends, without a correction. It has at most two turning
        points.

        With u = t / h and the mean velocity w its velocity is velocity + 2 b u + 3 c u^2, b = 3 w - 2 velocity -
        end_velocity, c = velocity + end_velocity - 2 w. In a step too short for the quotients to be finite the path is
        a straight section.
        """
        mean = (end - origin) / h
        b = 3.0 * mean - 2.0 * velocity - end_velocity
        c = velocity + end_velocity - 2.0 * mean
        if isfinite(b / h) and isfinite(c / h / h):
            self.start(origin, origin, velocity, b / h, c / h / h)
            # Bernstein's coefficients of the velocity are the values at its ends and this one: it is between them.
            between = velocity + b
            if min(velocity, between, end_velocity) <= 0.0 <= max(velocity, between, end_velocity):
                self.add_turning_points(b, c, h)
        else:
            self.start(origin, origin, clamp(mean, -GREATEST_SPEED, GREATEST_SPEED), 0.0, 0.0)
        self.end_section(h, end)

    def add_turning_points(self, b: float, c: float, h: float) -> None:
        """Add the turning points of the cubic with these coefficients of its velocity."""
        root = sqrt(max(b * b - 3.0 * c * self.velocity, 0.0))
        q = -(b + root) if b >= 0.0 else root - b  # the root of greater magnitude has no cancellation
        first = self.velocity / q if q != 0.0 else 0.0
        second = q / (3.0 * c) if c != 0.0 else 0.0
        if root > 0.0:
            if 0.0 < min(first, second) < 1.0:
                self.add_turning_point(min(first, second) * h)
            if 0.0 < max(first, second) < 1.0:
                self.add_turning_point(max(first, second) * h)

    def start(self, former: float, origin: float, velocity: float, c2: float, c3: float) -> None:
        """The coefficients of the path, and section 0 from `former` to `origin`."""
        self.origin = origin
        self.velocity = velocity
        self.c2 = c2
        self.c3 = c3
        self.positions[0] = former
        self.times[1] = 0.0
        self.positions[1] = origin
        self.sections = 1

    def add_turning_point(self, time: float) -> None:
        """Add a turning point: a section ends there and the next one starts."""
        self.end_section(time, self.position(time))

    def end_section(self, time: float, position: float) -> None:
        """End a section at this time and position."""
        self.sections += 1
        self.times[self.sections] = time
        self.positions[self.sections] = position

    def enter(self, section: int) -> None:
        """Go to the beginning of a section, all of which is left."""
        self.section = section
        self.reached = self.positions[section]
        self.now = self.times[section]
        self.end = self.positions[section + 1]
        self.until = self.times[section + 1]

    def end_at(self, position: float) -> None:
        """What is left of the section ends at a position on it."""
        self.until = self.crossing_time(position)
        self.end = position

    def go_to(self, position: float) -> None:
        """Go on to a position on the section; one that is behind is reached already."""
        self.now = max(self.now, self.crossing_time(position))
        is_rising = self.end > self.positions[self.section]
        self.reached = max(self.reached, position) if is_rising else min(self.reached, position)

    def leave(self) -> None:
        """Nothing is left of the section."""
        self.reached = self.end
        self.now = self.until

    def due(self, clock: Clock, time: float) -> float:
        """When a clock reaches a time, in s since the step's beginning, not before now; NEVER: not on what is left."""
        if not clock.has_reached(time, self.until):
            return NEVER
        return max(self.now, min(time - clock.time, self.until))

    def is_correction(self) -> bool:
        """Whether the section is the input correction."""
        return self.section == 0

    def position(self, time: float) -> float:
        """x(time), u."""
        return self.origin + time * (self.velocity + time * (self.c2 + time * self.c3))

    def crossing_time(self, position: float) -> float:
        """The time at which the section passes a position on it, s; for a position beyond it, that of its nearer end.

        On a parabola it has a closed form, on a cubic the time is bisected down to rounding. It is 0 on section 0."""
        section = self.section
        if section == 0:
            return 0.0
        rising = self.positions[section + 1] > self.positions[section]
        first = self.times[section]
        last = self.times[section + 1]
        if position == self.positions[section] or (position < self.positions[section]) == rising:
            return first
        if position == self.positions[section + 1] or (position > self.positions[section + 1]) == rising:
            return last
        if self.c3 == 0.0:
            return max(first, min(self.parabola_time(position, 1.0 if rising else -1.0), last))
        while can_halve(first, last):
            first, last = halve(first, last, (self.position(middle(first, last)) >= position) == rising)
        return last

    def parabola_time(self, position: float, direction: float) -> float:
        """The time at which the parabola passes `position` in this direction, +1 or -1.

        Its velocity there is direction * sqrt(v^2 + 2 a d), d being the distance from the origin. Of the two formulas
        for the time this is the one without cancellation."""
        distance = position - self.origin
        velocity = direction * sqrt(max(self.velocity * self.velocity + 4.0 * self.c2 * distance, 0.0))
        if self.velocity * direction >= 0.0:
            return 2.0 * distance / (self.velocity + velocity) if self.velocity + velocity != 0.0 else 0.0
        return 0.5 * (velocity - self.velocity) / self.c2
