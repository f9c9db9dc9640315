"""The master's path inside one step, cut at its turning points into monotone pieces.

Piece 0 is the input correction: the step before ended where the master was predicted to be, and the present input
says where the master is. The straight piece from the one place to the other takes no time.

If the inputs hold the master at the beginning of the step, the path is a parabola. If they hold the master at the end
of the step, the path is the cubic through the positions and velocities of both ends.
"""

from dataclasses import dataclass
from math import isfinite, sqrt

from . import var
from .limits import clamp

GREATEST_SPEED = 1e154  # u/s: its square is finite
BISECTIONS = 200  # this many halve any step down to neighbouring numbers, unless the root is below 1e-40 of the step


@dataclass(slots=True)
class Path:
    """x(t) = origin + t (velocity + t (c2 + t c3)), 0 <= t <= h; u, u/s, u/s2, u/s3.

    Piece i, 0 <= i < pieces, runs monotonously from places[i] at times[i] to places[i + 1] at times[i + 1]. The motion
    within the step begins with piece 1, at places[1] = origin.
    """

    origin: float = 0.0
    velocity: float = 0.0
    c2: float = 0.0
    c3: float = 0.0
    pieces: int = 0
    times: list[float] = var.ring(5)
    places: list[float] = var.ring(5)

    def parabola(self, former: float, origin: float, velocity: float, acceleration: float, h: float) -> None:
        """The path of constant acceleration over h, after the correction from `former`. It has at most one turning
        point."""
        self.start(former, origin, velocity, 0.5 * acceleration, 0.0)
        if velocity * (velocity + acceleration * h) < 0.0:
            self.turn_at(-velocity / acceleration)
        self.end_piece(h, origin + (velocity + 0.5 * acceleration * h) * h)

    def cubic(self, origin: float, velocity: float, end: float, end_velocity: float, h: float) -> None:
        """The cubic with these positions and velocities at its ends, without a correction. It has at most two turning
        points.

        With u = t / h and the mean velocity w its velocity is velocity + 2 b u + 3 c u^2, b = 3 w - 2 velocity -
        end_velocity, c = velocity + end_velocity - 2 w. In a step too short for the quotients to be finite the path is
        a straight piece.
        """
        mean = (end - origin) / h
        b = 3.0 * mean - 2.0 * velocity - end_velocity
        c = velocity + end_velocity - 2.0 * mean
        if isfinite(b / h) and isfinite(c / h / h):
            self.start(origin, origin, velocity, b / h, c / h / h)
            root = sqrt(max(b * b - 3.0 * c * velocity, 0.0))
            q = -(b + root) if b >= 0.0 else root - b  # the root of greater magnitude has no cancellation
            first = velocity / q if q != 0.0 else 0.0
            second = q / (3.0 * c) if c != 0.0 else 0.0
            if root > 0.0:
                if 0.0 < min(first, second) < 1.0:
                    self.turn_at(min(first, second) * h)
                if 0.0 < max(first, second) < 1.0:
                    self.turn_at(max(first, second) * h)
        else:
            self.start(origin, origin, clamp(mean, -GREATEST_SPEED, GREATEST_SPEED), 0.0, 0.0)
        self.end_piece(h, end)

    def start(self, former: float, origin: float, velocity: float, c2: float, c3: float) -> None:
        """The coefficients of the path, and piece 0 from `former` to `origin`."""
        self.origin = origin
        self.velocity = velocity
        self.c2 = c2
        self.c3 = c3
        self.places[0] = former
        self.pieces = 0
        self.end_piece(0.0, origin)

    def turn_at(self, time: float) -> None:
        """A turning point: a piece ends there and the next one begins."""
        self.end_piece(time, self.position(time))

    def end_piece(self, time: float, place: float) -> None:
        """A piece ends at this time and place."""
        self.pieces += 1
        self.times[self.pieces] = time
        self.places[self.pieces] = place

    def position(self, time: float) -> float:
        """x(time), u."""
        return self.origin + time * (self.velocity + time * (self.c2 + time * self.c3))

    def crossing(self, piece: int, place: float) -> float:
        """The time at which a piece passes a place that lies on it, s; for a place beyond it, that of its nearer end.

        On a parabola it has a closed form, on a cubic it is found by bisection down to rounding. It is 0 on piece 0."""
        if piece == 0:
            return 0.0
        rising = self.places[piece + 1] > self.places[piece]
        first = self.times[piece]
        last = self.times[piece + 1]
        if place == self.places[piece] or (place < self.places[piece]) == rising:
            return first
        if place == self.places[piece + 1] or (place > self.places[piece + 1]) == rising:
            return last
        if self.c3 == 0.0:
            return max(first, min(self.parabola_time(place, 1.0 if rising else -1.0), last))
        for _ in range(BISECTIONS):
            middle = 0.5 * (first + last)
            if middle <= first or middle >= last:
                break
            if (self.position(middle) >= place) == rising:
                last = middle
            else:
                first = middle
        return last

    def parabola_time(self, place: float, direction: float) -> float:
        """The time at which the parabola passes `place` in this direction, +1 or -1.

        Its velocity there is direction * sqrt(v^2 + 2 a d), d being the distance from the origin. Of the two formulas
        for the time this is the one without cancellation."""
        distance = place - self.origin
        velocity = direction * sqrt(max(self.velocity * self.velocity + 4.0 * self.c2 * distance, 0.0))
        if self.velocity * direction >= 0.0:
            return 2.0 * distance / (self.velocity + velocity) if self.velocity + velocity != 0.0 else 0.0
        return 0.5 * (velocity - self.velocity) / self.c2
