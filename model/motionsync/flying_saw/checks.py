"""The checks of sync_mode on a measured profile, each with TwinCAT's detailed error code, lowest code first.

Positions are compared as they are, below and above. The velocity checks count in the direction of the synchronous
velocity; only the check against a velocity above zero takes the velocity as it is. Source: TS5055, sections 5 and 13.
"""

from .extremes import Extremes
from .faults import Fault
from .gear_in_request import GearInRequest

TOLERANCE = 1e-9  # of the position span, the greatest speed, or the limit of acceleration or jerk


def find_position_fault(extremes: Extremes, request: GearInRequest, start: float, end: float) -> Fault:
    """The first violated position check; `start`, `end`: the slave's positions at both ends of the profile, u."""
    tolerance = TOLERANCE * (extremes.position_max - extremes.position_min)
    lowest = extremes.position_min + tolerance
    highest = extremes.position_max - tolerance
    if request.mode.check_min_position and lowest < request.min_position:
        return Fault.MIN_POSITION
    if request.mode.check_max_position and highest > request.max_position:
        return Fault.MAX_POSITION
    if request.mode.check_undershoot_position and lowest < min(start, end):
        return Fault.UNDERSHOOT_POSITION_FALLING if end < start else Fault.UNDERSHOOT_POSITION_RISING
    if request.mode.check_overshoot_position and highest > max(start, end):
        return Fault.OVERSHOOT_POSITION_FALLING if end < start else Fault.OVERSHOOT_POSITION_RISING
    return Fault.NONE


def find_velocity_fault(extremes: Extremes, request: GearInRequest, start: float, end: float, master: float) -> Fault:
    """The first violated velocity check.

    `start`, `end`: the slave's velocities at both ends of the profile; `master`: the master's nominal velocity, u/s.
    """
    tolerance = TOLERANCE * max(extremes.velocity_max, -extremes.velocity_min)
    if request.mode.check_max_velocity and extremes.velocity_max > request.velocity + tolerance:
        return Fault.VELOCITY_ABOVE
    if request.mode.check_max_velocity and extremes.velocity_min < -request.velocity - tolerance:
        return Fault.VELOCITY_BELOW
    fault = find_beyond_ends(extremes, request, start, end, tolerance)
    return fault if fault != Fault.NONE else find_across_zero(extremes, request, end, master, tolerance)


def find_beyond_ends(extremes: Extremes, request: GearInRequest, start: float, end: float, tolerance: float) -> Fault:
    """The fault of a velocity outside those of both ends."""
    forwards = end > 0.0
    first = start if forwards else -start
    last = abs(end)
    rises = first <= last
    lowest = extremes.velocity_min if forwards else -extremes.velocity_max
    highest = extremes.velocity_max if forwards else -extremes.velocity_min
    if request.mode.check_overshoot_velocity and highest > max(first, last) + tolerance:
        if forwards:
            return Fault.OVERSHOOT_VELOCITY_RISING if rises else Fault.OVERSHOOT_VELOCITY_FALLING
        return Fault.OVERSHOOT_VELOCITY_RISING_BACK if rises else Fault.OVERSHOOT_VELOCITY_FALLING_BACK
    if request.mode.check_undershoot_velocity and lowest < min(first, last) - tolerance:
        if forwards:
            return Fault.UNDERSHOOT_VELOCITY_RISING if rises else Fault.UNDERSHOOT_VELOCITY_FALLING
        return Fault.UNDERSHOOT_VELOCITY_RISING_BACK if rises else Fault.UNDERSHOOT_VELOCITY_FALLING_BACK
    return Fault.NONE


def find_across_zero(extremes: Extremes, request: GearInRequest, end: float, master: float, tolerance: float) -> Fault:
    """The fault of a velocity above zero, or of one against the synchronous velocity, both at the start too."""
    lowest = extremes.velocity_min if end > 0.0 else -extremes.velocity_max
    if request.mode.check_overshoot_velocity_zero and extremes.velocity_max > tolerance:
        return Fault.ABOVE_ZERO if master > 0.0 else Fault.ABOVE_ZERO_BACK
    if request.mode.check_undershoot_velocity_zero and lowest < -tolerance:
        return Fault.BELOW_ZERO if master > 0.0 else Fault.BELOW_ZERO_BACK
    return Fault.NONE


def find_dynamics_fault(extremes: Extremes, request: GearInRequest) -> Fault:
    """The first violated check of acceleration, deceleration and jerk."""
    tolerance = 1.0 + TOLERANCE
    if request.mode.check_max_acceleration and extremes.acceleration_peak > request.acceleration * tolerance:
        return Fault.ACCELERATION
    if request.mode.check_max_deceleration and extremes.deceleration_peak > request.deceleration * tolerance:
        return Fault.DECELERATION
    if request.mode.check_max_jerk and extremes.jerk_max > request.jerk * tolerance:
        return Fault.JERK_ABOVE
    if request.mode.check_max_jerk and extremes.jerk_min < -request.jerk * tolerance:
        return Fault.JERK_BELOW
    return Fault.NONE
