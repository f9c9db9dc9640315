"""Which limit of the axis a motion exceeds.

A command may have limits of its own, a check may be off, and a coupled slave follows its master, whatever that does: so
a motion can ask for more than the axis can do. The block outputs it all the same, and reports the limit.
"""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..numerics.computable_range import clamp
from ..numerics.grid import nearest_on_grid
from ..slave import Slave
from ..var import Enumeration
from .axis_limits import AxisLimits

PLAN_TOLERANCE = 1e-9  # of a limit: rounding of a plan
SETPOINT_TOLERANCE = 1e-6  # of a limit: rounding of a setpoint, whose acceleration loses digits far from position 0
POSITION_ROUNDING = 4e-16  # of a position: rounding of the way from one setpoint to the next
END_POSITION_TOLERANCE = 1e-9  # of an end position, and of the travel in 1 s at the greatest velocity: rounding
LARGEST_SHOWN_VALUE = 1e100  # a greater value is shown as this one
VALUE = ("local.exceeded_value",)


class Limit(Enumeration):
    """Which limit of the axis the motion under way exceeds"""

    NONE = 0, "none"
    MIN_POSITION = 1, "limit exceeded: the slave goes below the software end position", *VALUE, "axis.min_position"
    MAX_POSITION = 2, "limit exceeded: the slave goes above the software end position", *VALUE, "axis.max_position"
    MAX_VELOCITY = 3, "limit exceeded: the slave is faster than its axis can be", *VALUE, "axis.max_velocity"
    MAX_ACCELERATION = (
        4,
        "limit exceeded: the slave's acceleration is beyond its axis's",
        *VALUE,
        "axis.max_acceleration",
    )
    MAX_DECELERATION = (
        5,
        "limit exceeded: the slave's deceleration is beyond its axis's (0: as the acceleration)",
        *VALUE,
        "axis.max_deceleration",
        "axis.max_acceleration",
    )
    MAX_JERK = 6, "limit exceeded: the slave's jerk is beyond its axis's", *VALUE, "axis.max_jerk"
    INSTANT_STOP = 7, "limit exceeded: the slave stops at once, from a velocity", *VALUE


@dataclass(slots=True)
class ExceededLimit:
    """The first limit, in the order of `Limit`, that a motion exceeds, and the exceeding value, in the limit's unit."""

    limit: Limit = Limit.NONE
    value: float = 0.0

    def set(self, limit: Limit, value: float) -> None:
        self.limit = limit
        self.value = clamp(value, -LARGEST_SHOWN_VALUE, LARGEST_SHOWN_VALUE)

    def clear(self) -> None:
        self.limit = Limit.NONE
        self.value = 0.0

    def include(self, other: "ExceededLimit") -> None:
        """Take over what another one has found, if that comes before what this one has."""
        if other.limit != Limit.NONE and (self.limit == Limit.NONE or other.limit < self.limit):
            var.copy(self, other)

    def check_setpoint(self, axis: AxisLimits, slave: Slave) -> None:
        """Check the setpoint of an instant. Nearly at standstill, the greater limit of acceleration counts."""
        speed = abs(slave.velocity)
        acceleration = abs(slave.acceleration)
        deceleration = acceleration
        if speed <= SETPOINT_TOLERANCE * axis.max_velocity:
            if acceleration <= max(axis.max_acceleration, axis.deceleration()):
                acceleration = 0.0
            deceleration = 0.0
        elif slave.velocity * slave.acceleration > 0.0:
            deceleration = 0.0
        else:
            acceleration = 0.0
        position = slave.position
        self.check_extremes(
            axis, SETPOINT_TOLERANCE, position, position, speed, acceleration, deceleration, abs(slave.jerk)
        )

    def check_way(self, axis: AxisLimits, slave: Slave, before: float, turn: float, h: float, master: Master) -> None:
        """Check the mean velocity of a step of h seconds, to this setpoint from the position `before`, u.

        Where the position jumps, no setpoint shows that. An axis that turns has a `turn`, u, and is taken to go the
        shorter way; of a linear axis it is 0. A setpoint that follows the master has the rounding of its position."""
        way = slave.position - before
        if turn > 0.0:
            way -= nearest_on_grid(0.0, turn, way)
        longest = axis.max_velocity * (1.0 + SETPOINT_TOLERANCE) * h
        if not exceeds(abs(way), longest):
            return
        rounded = abs(slave.position)
        if master.end_velocity != 0.0:
            rounded += abs(master.end * slave.velocity / master.end_velocity)
        velocity = abs(way) / h
        is_first = self.limit == Limit.NONE or self.limit > Limit.MAX_VELOCITY
        is_worse = self.limit == Limit.MAX_VELOCITY and velocity > self.value * (1.0 + SETPOINT_TOLERANCE)
        if (is_first or is_worse) and abs(way) > longest + POSITION_ROUNDING * rounded:
            self.set(Limit.MAX_VELOCITY, velocity)

    def check_extremes(
        self,
        axis: AxisLimits,
        tolerance: float,
        lowest: float,
        highest: float,
        speed: float,
        acceleration: float,
        deceleration: float,
        jerk: float,
    ) -> None:
        """Find the first limit that these extreme values exceed, u, u/s, u/s2 and u/s3."""
        factor = 1.0 + tolerance
        limit = Limit.NONE
        value = 0.0
        if lowest < axis.min_position - end_tolerance(axis.min_position, axis.max_velocity):
            limit = Limit.MIN_POSITION
            value = lowest
        elif highest > axis.max_position + end_tolerance(axis.max_position, axis.max_velocity):
            limit = Limit.MAX_POSITION
            value = highest
        elif exceeds(speed, axis.max_velocity * factor):
            limit = Limit.MAX_VELOCITY
            value = speed
        elif exceeds(acceleration, axis.max_acceleration * factor):
            limit = Limit.MAX_ACCELERATION
            value = acceleration
        elif exceeds(deceleration, axis.deceleration() * factor):
            limit = Limit.MAX_DECELERATION
            value = deceleration
        elif exceeds(jerk, axis.max_jerk * factor):
            limit = Limit.MAX_JERK
            value = jerk
        self.set(limit, value)


def end_tolerance(end: float, max_velocity: float) -> float:
    """How far beyond an end position, u, is rounding."""
    return END_POSITION_TOLERANCE * (abs(end) + max_velocity)


def exceeds(magnitude: float, limit: float) -> bool:
    """Whether a magnitude exceeds a limit; a limit that is not a number above 0 limits nothing."""
    return 0.0 < limit < magnitude
