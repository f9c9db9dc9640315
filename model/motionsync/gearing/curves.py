"""The ways between rest and the line: over the master's position and in time. Source: MOVIKIT gearing."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..laws import Quintic, half_ramp
from ..limits import clamp

SAME_TIME = 1e-13  # of a step's or a transition's time: what is missing is rounding


def into(way: float, distance: float) -> tuple[float, float, float, float]:
    """From rest on to the line of slope 1 over a `distance` > 0 of the master, of which `way` is made, both >= 0, u.

    The slave's travel D (u^3 - u^4 / 2), u = way / D, and its first three derivatives by the master's position: slope 0
    at the beginning and 1 at the end, without curvature at both; it travels D / 2."""
    q, q1, q2, q3 = half_ramp(clamp(way / distance, 0.0, 1.0))
    return distance * q, q1, q2 / distance, q3 / distance / distance


def out(way: float, distance: float) -> tuple[float, float, float, float]:
    """From the line of slope 1 to rest, D (u - u^3 + u^4 / 2): what `into` lacks to the master's own way."""
    u = clamp(way / distance, 0.0, 1.0)
    q, q1, q2, q3 = half_ramp(u)
    return distance * (u - q), 1.0 - q1, -q2 / distance, -q3 / distance / distance


@dataclass(slots=True)
class Blend:
    """A quintic in time from a state of motion to another, and how long it has run.

    `clock` tells the time since it began."""

    curve: Quintic = var.part(Quintic)
    clock: Clock = var.part(Clock)

    def begin(
        self, time: float, duration: float, position: float, velocity: float, acceleration: float, end: float
    ) -> None:
        """At a time since the step's beginning; to rest at `end`."""
        self.curve.fit(duration, position, velocity, acceleration, end, 0.0, 0.0)
        self.clock.start(time)

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position and its derivatives at a time since the step's beginning."""
        return self.curve.at(clamp(self.clock.time + time, 0.0, self.curve.length))

    def left(self) -> float:
        """The time from the step's beginning to the end."""
        return self.curve.length - self.clock.time

    def over(self, time: float) -> bool:
        """Whether it has ended by then."""
        return self.left() - time <= SAME_TIME * self.curve.length

    def progress(self) -> float:
        return clamp(self.clock.time / self.curve.length, 0.0, 1.0)

    def advance(self, h: float) -> None:
        """The clock goes on by h."""
        self.clock.advance(h)
