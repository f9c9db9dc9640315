"""The monitored limits: max_speed and max_acceleration, each with its switch. Source: Robox mv_follow2."""

from ..motion.quintic_peaks import QuinticPeaks
from .faults import Fault
from .interface import FollowerInterface
from .stages import Stage, limit_faults

LIMIT_TOLERANCE = 1.0 + 1e-9  # of a limit: a value up to here keeps the limit, but for rounding


def exceeded_limit_fault(block: FollowerInterface, stage: Stage) -> Fault:
    """The fault of a setpoint that exceeds a limit which is checked in this stage; NONE: it keeps them."""
    speed_fault, acceleration_fault = limit_faults(stage)
    if exceeds(block.check_speed, abs(block.slave.velocity), block.max_speed):
        return speed_fault
    if exceeds(block.check_acceleration, abs(block.slave.acceleration), block.max_acceleration):
        return acceleration_fault
    return Fault.NONE


def keeps_limits(parameters: FollowerInterface, peaks: QuinticPeaks, speed: float) -> bool:
    """Whether a curve with these peaks keeps the limits that are checked, at that speed of the master."""
    if exceeds(parameters.check_speed, peaks.d1 * speed, parameters.max_speed):
        return False
    return not exceeds(parameters.check_acceleration, peaks.d2 * speed * speed, parameters.max_acceleration)


def exceeds(is_checked: bool, size: float, limit: float) -> bool:
    """Whether a magnitude exceeds a limit that is checked."""
    return is_checked and limit > 0.0 and size > limit * LIMIT_TOLERANCE
