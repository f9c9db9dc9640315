"""The curves between rest and the line: over the master's position, and in time. Source: MOVIKIT gearing."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..motion.laws import Quintic, half_ramp, half_ramp_mirrored
from ..numerics.computable_range import clamp
from ..numerics.grid import grid_tolerance


def gear_in_curve(travel: float, distance: float) -> tuple[float, float, float, float]:
    """The slave's travel, u, from rest on to a line of slope 1, and its three derivatives by the master's position.

    travel: what the master has travelled, u, of the transition's `distance`, u, > 0. With x = travel / distance the
    slave travels distance (x^3 - x^4 / 2), half of the distance in all; the derivative is 0 at the beginning and 1 at
    the end, the second derivative is 0 at both. Before the beginning and after the end the values there are held.
    """
    q, q1, q2, q3 = half_ramp(clamp(travel / distance, 0.0, 1.0))
    return distance * q, q1, q2 / distance, q3 / distance / distance


def gear_out_curve(travel: float, distance: float) -> tuple[float, float, float, float]:
    """The mirror of `gear_in_curve`: from a line of slope 1 to rest, distance (x - x^3 + x^4 / 2)."""
    q, q1, q2, q3 = half_ramp_mirrored(clamp(travel / distance, 0.0, 1.0))
    return distance * q, q1, q2 / distance, q3 / distance / distance


@dataclass(slots=True)
class MasterCurve:
    """Where a transition is on the master's axis. The curve itself is `gear_in_curve` or `gear_out_curve`.

    - trigger: the master's position at which the transition starts, u.
    - direction: in which direction the master travels through it, 1 or -1; 0 while a master that was at rest at the
      trigger has not moved yet.
    - distance: how far the master travels through it, u, >= 0; a transition that is not master-based has none.
    """

    trigger: float = 0.0
    direction: float = 0.0
    distance: float = 0.0

    def start(self, trigger: float, direction: float, distance: float) -> None:
        self.trigger = trigger
        self.direction = direction
        self.distance = distance

    def travel(self, master: float) -> float:
        """What the master has travelled since the trigger, u, when it is at `master`; negative: it is before it."""
        return self.direction * (master - self.trigger)

    def half(self) -> float:
        """The master's signed travel over half of the distance, u: in all the slave travels what is geared to it."""
        return self.direction * (0.5 * self.distance)

    def end(self) -> float:
        """The master's position at the end, u."""
        return self.trigger + self.direction * self.distance

    def is_reached_at(self, master: float) -> bool:
        """Whether a master at this position, u, has reached the end, but for rounding."""
        margin = grid_tolerance(self.end(), self.distance, master)
        return self.direction * (master - self.end()) >= -margin and self.direction != 0.0

    def is_left_at(self, master: float, uncertain: float) -> bool:
        """Whether a master at this position, u, has gone back before the trigger, by more than rounding and what is
        uncertain of its travel, u."""
        return self.travel(master) < -grid_tolerance(self.end(), self.distance, master) - uncertain

    def progress(self, master: float) -> float:
        """The share of the distance, > 0, that a master at this position has travelled, 0 to 1."""
        return clamp(self.travel(master) / self.distance, 0.0, 1.0)


@dataclass(slots=True)
class TimeCurve:
    """A quintic in time that leads from a state of motion to rest, and the time since it started.

    All times that its methods take, s, count from the beginning of the present step."""

    curve: Quintic = var.part(Quintic)
    clock: Clock = var.part(Clock)

    def start(
        self, time: float, duration: float, position: float, velocity: float, acceleration: float, end: float
    ) -> None:
        """Start the curve at `time` with this motion; it rests at the position `end` after `duration` > 0, s."""
        self.curve.fit(duration, position, velocity, acceleration, end, 0.0, 0.0)
        self.clock.start(time)

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk; before the beginning and after the end the values there."""
        return self.curve.at(clamp(self.clock.time + time, 0.0, self.curve.length))

    def progress(self) -> float:
        """The share of its duration that is over at the beginning of the present step, 0 to 1."""
        return clamp(self.clock.time / self.curve.length, 0.0, 1.0)

    def advance(self, h: float) -> None:
        """Go on to the next step; the present one takes h seconds."""
        self.clock.advance(h)
