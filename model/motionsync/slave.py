"""What the blocks share at their inputs and outputs: the edges of commands, and the slave's setpoint."""

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

    def set(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        """Set the setpoint, in u, u/s, u/s2 and u/s3."""
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration
        self.jerk = jerk

    def is_moving(self) -> bool:
        """Whether the setpoint has a velocity or an acceleration."""
        return self.velocity != 0.0 or self.acceleration != 0.0


@dataclass(slots=True)
class Edge:
    """An input that gives a command by its rising edge. `before` is its level in the step before."""

    before: bool = False

    def take_level(self, level: bool) -> None:
        """Take the input's level at the initialization: this level is no edge, only a later rise is."""
        self.before = level

    def try_rise(self, now: bool) -> bool:
        """Take the input's level of this step, and return whether that is a rising edge (IEC 61131: R_TRIG)."""
        rising = now and not self.before
        self.before = now
        return rising
