"""Which limit of the axis a motion exceeds.

A command may have limits of its own, a check may be off, and a coupled slave follows its master, whatever that does: so
a motion can ask for more than the axis can do. It is put out all the same, but never without a word.
"""

from dataclasses import dataclass

from .axis_limits import AxisLimits
from .limits import clamp
from .slave import Slave
from .var import Enumeration

PLANNED = 1e-9  # of the limit: a plan that exceeds it by less does so by rounding
PUT_OUT = (
    1e-6  # of the limit: the same of a setpoint, whose acceleration is rounded more where positions are far from 0
)
NEAR_END = 1e-9  # of an end position, and of the travel in 1 s at the greatest velocity: a smaller overrun is rounding
MOST_SHOWN = 1e100  # a value beyond it is shown as this one
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
class Exceeded:
    """The first limit, in the order of `Limit`, that a motion exceeds, and the value that does, in the limit's unit."""

    limit: Limit = Limit.NONE
    value: float = 0.0

    def put(self, limit: Limit, value: float) -> None:
        self.limit = limit
        self.value = clamp(value, -MOST_SHOWN, MOST_SHOWN)

    def clear(self) -> None:
        self.put(Limit.NONE, 0.0)

    def judge_setpoint(self, axis: AxisLimits, slave: Slave) -> None:
        """Judge the setpoint of an instant. All but at standstill, the greater limit of acceleration counts."""
        speed = abs(slave.velocity)
        acceleration = abs(slave.acceleration)
        deceleration = acceleration
        if speed <= PUT_OUT * axis.max_velocity:
            if acceleration <= max(axis.max_acceleration, axis.deceleration()):
                acceleration = 0.0
            deceleration = 0.0
        elif slave.velocity * slave.acceleration > 0.0:
            deceleration = 0.0
        else:
            acceleration = 0.0
        position = slave.position
        self.judge(axis, PUT_OUT, position, position, speed, acceleration, deceleration, abs(slave.jerk))

    def judge(
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
        """Find the first limit that these magnitudes exceed, u, u/s, u/s2 and u/s3."""
        factor = 1.0 + tolerance
        if lowest < axis.min_position - NEAR_END * (abs(axis.min_position) + axis.max_velocity):
            self.put(Limit.MIN_POSITION, lowest)
        elif highest > axis.max_position + NEAR_END * (abs(axis.max_position) + axis.max_velocity):
            self.put(Limit.MAX_POSITION, highest)
        elif is_beyond(speed, axis.max_velocity * factor):
            self.put(Limit.MAX_VELOCITY, speed)
        elif is_beyond(acceleration, axis.max_acceleration * factor):
            self.put(Limit.MAX_ACCELERATION, acceleration)
        elif is_beyond(deceleration, axis.deceleration() * factor):
            self.put(Limit.MAX_DECELERATION, deceleration)
        elif is_beyond(jerk, axis.max_jerk * factor):
            self.put(Limit.MAX_JERK, jerk)
        else:
            self.clear()


def is_beyond(magnitude: float, limit: float) -> bool:
    """Whether a magnitude exceeds a limit; one that is no number above 0 limits nothing."""
    return 0.0 < limit < magnitude
