"""What every block has at its two ends: the slave's setpoint and the edges of its commands; places on an axis."""

from dataclasses import dataclass

from . import declare as var
from .declare import Unit


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

    def rising(self, now: bool) -> bool:
        rising = now and not self.before
        self.before = now
        return rising


def clamp(x: float, low: float, high: float) -> float:
    return max(low, min(x, high))


def wrap(position: float, period: float) -> float:
    """`position` modulo `period` in [0, period); `position` itself if the period is 0.

    The remainder is exact for a position >= 0; of a negative one a whole period is lacking, and where adding it rounds
    to the period itself the answer is 0.
    """
    if period == 0.0:
        return position
    if 0.0 <= position < period:  # nearly always, and a division is slow
        return position + 0.0  # 0 of -0, as the remainder makes it
    wrapped = position % period
    return wrapped if wrapped < period else 0.0


def floor(x: float) -> float:
    """The greatest whole number not above x; from 2^52 on there are only whole numbers."""
    if abs(x) >= 4503599627370496.0:
        return x
    whole = float(int(x))
    return whole - 1.0 if whole > x else whole


def nearest(base: float, spacing: float, here: float) -> float:
    """Of the places base + n spacing the one nearest to `here`; with a spacing of 0, `base`."""
    if spacing == 0.0:
        return base
    return base + floor((here - base) / spacing + 0.5) * spacing
