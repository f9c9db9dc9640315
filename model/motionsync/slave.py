"""What every block has at its two ends: the slave's setpoint, and the edges of its commands."""

from dataclasses import dataclass

from . import var
from .var import Unit


@dataclass(slots=True)
class Slave:
    """The slave's setpoint at the end of the step."""

    position: float = var.output(0.0, "the slave's position setpoint", Unit.POSITION)
    velocity: float = var.output(0.0, "the slave's velocity setpoint", Unit.VELOCITY)
    acceleration: float = var.output(0.0, "the slave's acceleration setpoint", Unit.ACCELERATION)
    jerk: float = var.output(0.0, "the slave's jerk setpoint", Unit.JERK)

    def put(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration
        self.jerk = jerk


@dataclass(slots=True)
class Edge:
    """A command: its rising edge gives it. The first value seen, at the end of initialization, is no edge."""

    before: bool = False

    def hold(self, level: bool) -> None:
        """The command has this level at the end of initialization: only a change from it on is an edge."""
        self.before = level

    def rising(self, now: bool) -> bool:
        rising = now and not self.before
        self.before = now
        return rising
