"""A command for a motion of the axis itself, as read at its edge: halt, stop, move_velocity or move_absolute."""

from dataclasses import dataclass

from .. import var
from ..motion.axis_limits import AxisLimits, are_ends_finite, limit_in_use
from ..motion.jerk_limited import Motion, acceleration_limit
from ..motion.start import MotionStart
from ..numerics.computable_range import is_usable
from ..slave import Slave
from .commands import Halt, Limited, MoveAbsolute, MoveVelocity
from .faults import Fault


@dataclass(slots=True)
class MotionRequest:
    """The command's values; limits in use, the command's own or the axis's, in u/s, u/s2 and u/s3.

    `velocity` is the target of move_velocity with its sign, and the limit of move_absolute, whose target is `position`.
    `start` is the state from which the motion planned last starts.
    """

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0
    jerk: float = 0.0
    start: MotionStart = var.part(MotionStart)

    def read_halt(self, command: Halt, axis: AxisLimits) -> None:
        """Read halt or stop."""
        self.deceleration = limit_in_use(command.deceleration, axis.deceleration())
        self.jerk = limit_in_use(command.jerk, axis.max_jerk)

    def read_move_velocity(self, command: MoveVelocity, axis: AxisLimits) -> None:
        self.velocity = command.velocity
        self.read_dynamics(command, axis)

    def read_move_absolute(self, command: MoveAbsolute, axis: AxisLimits) -> None:
        self.position = command.position
        self.velocity = limit_in_use(command.velocity, axis.max_velocity)
        self.read_dynamics(command, axis)

    def read_dynamics(self, command: Limited, axis: AxisLimits) -> None:
        self.acceleration = limit_in_use(command.acceleration, axis.max_acceleration)
        self.deceleration = limit_in_use(command.deceleration, axis.deceleration())
        self.jerk = limit_in_use(command.jerk, axis.max_jerk)

    def has_usable_dynamics(self) -> bool:
        return is_usable(self.acceleration) and is_usable(self.deceleration) and is_usable(self.jerk)

    def find_halt_fault(self) -> Fault:
        return Fault.NONE if is_usable(self.deceleration) and is_usable(self.jerk) else Fault.LIMIT

    def find_move_velocity_fault(self, axis: AxisLimits) -> Fault:
        is_allowed = self.has_usable_dynamics() and abs(self.velocity) <= axis.max_velocity
        return Fault.NONE if is_allowed else Fault.LIMIT

    def find_move_absolute_fault(self, axis: AxisLimits) -> Fault:
        ends_finite = are_ends_finite(axis.min_position, axis.max_position)
        if not (ends_finite and is_usable(self.velocity) and self.has_usable_dynamics()):
            return Fault.LIMIT
        if self.position < axis.min_position:
            return Fault.MIN_POSITION
        return Fault.MAX_POSITION if self.position > axis.max_position else Fault.NONE

    def start_motion(self, motion: Motion, slave: Slave, axis: AxisLimits) -> None:
        """The motion starts from the slave's state, as far as the axis could have had it."""
        start = self.start
        start.set(slave.position, slave.velocity, slave.acceleration)
        start.limit_acceleration(axis.max_velocity, axis.max_acceleration, axis.deceleration())
        start.limit_way(axis.min_position, axis.max_position, axis.max_velocity, self.deceleration, self.jerk)
        motion.start(start.position, start.velocity, start.acceleration)

    def plan_halt(self, motion: Motion, slave: Slave, axis: AxisLimits) -> None:
        self.start_motion(motion, slave, axis)
        motion.halt(self.deceleration, self.jerk)

    def plan_move_velocity(self, motion: Motion, slave: Slave, axis: AxisLimits) -> None:
        self.start_motion(motion, slave, axis)
        limit = acceleration_limit(self.start.velocity, self.velocity, self.acceleration, self.deceleration)
        motion.try_change(self.velocity, 0.0, -limit, limit, self.jerk)

    def plan_move_absolute(self, motion: Motion, slave: Slave, axis: AxisLimits) -> None:
        self.start_motion(motion, slave, axis)
        motion.move(self.position, self.velocity, self.acceleration, self.deceleration, self.jerk)
