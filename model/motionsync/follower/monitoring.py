"""The monitored limits: max_speed and max_acceleration, each with its switch. Source: Robox mv_follow2."""

from ..motion.exceeded_limit import exceeds
from ..motion.quintic_peaks import QuinticPeaks
from .faults import Fault
from .interface import FollowerInterface
from .stages import Stage, limit_faults

LIMIT_TOLERANCE = 1.0 + 1e-9  # of a limit: a value up to here keeps the limit, but for rounding


def exceeded_limit_fault(block: FollowerInterface, stage: Stage) -> Fault:
    """The fault of a setpoint that exceeds a limit which is checked in this stage; NONE: it keeps them."""
    speed_fault, acceleration_fault = limit_faults(stage)
    if block.check_speed and exceeds(abs(block.slave.velocity), block.max_speed * LIMIT_TOLERANCE):
        return speed_fault
    if block.check_acceleration and exceeds(abs(block.slave.acceleration), block.max_acceleration * LIMIT_TOLERANCE):
        return acceleration_fault
    return Fault.NONE


def keeps_limits(parameters: FollowerInterface, peaks: QuinticPeaks, speed: float) -> bool:
    """Whether a curve with these peaks keeps the limits that are checked, at that speed of the master."""
    if parameters.check_speed and exceeds(peaks.d1 * speed, parameters.max_speed * LIMIT_TOLERANCE):
        return False
    acceleration = peaks.d2 * speed * speed
    return not (parameters.check_acceleration and exceeds(acceleration, parameters.max_acceleration * LIMIT_TOLERANCE))
