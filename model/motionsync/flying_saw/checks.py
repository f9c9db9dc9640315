"""The checks of sync_mode on a measured profile, each with TwinCAT's detailed error code, lowest code first.

Source: TS5055, sections 5 and 13. Positions are compared literally, below and above; the velocity checks count in the
direction of the synchronous velocity but for the one against a velocity above zero.
"""

from .extremes import Extremes
from .faults import Fault
from .order import Order

TOLERANCE = 1e-9  # of the position span, the greatest speed, or the limit of acceleration or jerk


def broken_position(extremes: Extremes, order: Order, start: float, end: float) -> Fault:
    """`start`, `end`: the slave's positions at both ends of the profile, u."""
    tolerance = TOLERANCE * (extremes.position_max - extremes.position_min)
    lowest = extremes.position_min + tolerance
    highest = extremes.position_max - tolerance
    if order.mode.check_min_position and lowest < order.min_position:
        return Fault.MIN_POSITION
    if order.mode.check_max_position and highest > order.max_position:
        return Fault.MAX_POSITION
    if order.mode.check_undershoot_position and lowest < min(start, end):
        return Fault.UNDERSHOOT_POSITION_FALLING if end < start else Fault.UNDERSHOOT_POSITION_RISING
    if order.mode.check_overshoot_position and highest > max(start, end):
        return Fault.OVERSHOOT_POSITION_FALLING if end < start else Fault.OVERSHOOT_POSITION_RISING
    return Fault.NONE


def broken_velocity(extremes: Extremes, order: Order, start: float, end: float, master: float) -> Fault:
    """`start`, `end`: the slave's velocities at both ends of the profile; `master`: the nominal one, u/s."""
    tolerance = TOLERANCE * max(extremes.velocity_max, -extremes.velocity_min)
    if order.mode.check_max_velocity and extremes.velocity_max > order.velocity + tolerance:
        return Fault.VELOCITY_ABOVE
    if order.mode.check_max_velocity and extremes.velocity_min < -order.velocity - tolerance:
        return Fault.VELOCITY_BELOW
    fault = beyond_ends(extremes, order, start, end, tolerance)
    return fault if fault != Fault.NONE else beyond_zero(extremes, order, start, end, master, tolerance)


def beyond_ends(extremes: Extremes, order: Order, start: float, end: float, tolerance: float) -> Fault:
    """A velocity outside those of both ends."""
    ahead = end > 0.0
    first = start if ahead else -start
    last = abs(end)
    rises = first <= last
    least = extremes.velocity_min if ahead else -extremes.velocity_max
    most = extremes.velocity_max if ahead else -extremes.velocity_min
    if order.mode.check_overshoot_velocity and most > max(first, last) + tolerance:
        if ahead:
            return Fault.OVERSHOOT_VELOCITY_RISING if rises else Fault.OVERSHOOT_VELOCITY_FALLING
        return Fault.OVERSHOOT_VELOCITY_RISING_BACK if rises else Fault.OVERSHOOT_VELOCITY_FALLING_BACK
    if order.mode.check_undershoot_velocity and least < min(first, last) - tolerance:
        if ahead:
            return Fault.UNDERSHOOT_VELOCITY_RISING if rises else Fault.UNDERSHOOT_VELOCITY_FALLING
        return Fault.UNDERSHOOT_VELOCITY_RISING_BACK if rises else Fault.UNDERSHOOT_VELOCITY_FALLING_BACK
    return Fault.NONE


def beyond_zero(extremes: Extremes, order: Order, start: float, end: float, master: float, tolerance: float) -> Fault:
    """A velocity above zero, or one against the synchronous one where the slave does not start with it."""
    least = extremes.velocity_min if end > 0.0 else -extremes.velocity_max
    with_it = start * end >= 0.0
    if order.mode.check_overshoot_velocity_zero and extremes.velocity_max > tolerance:
        return Fault.ABOVE_ZERO if master > 0.0 else Fault.ABOVE_ZERO_BACK
    if order.mode.check_undershoot_velocity_zero and with_it and least < -tolerance:
        return Fault.BELOW_ZERO if master > 0.0 else Fault.BELOW_ZERO_BACK
    return Fault.NONE


def broken_steepness(extremes: Extremes, order: Order) -> Fault:
    """Acceleration, deceleration, jerk."""
    more = 1.0 + TOLERANCE
    if order.mode.check_max_acceleration and extremes.acceleration_peak > order.acceleration * more:
        return Fault.ACCELERATION
    if order.mode.check_max_deceleration and extremes.deceleration_peak > order.deceleration * more:
        return Fault.DECELERATION
    if order.mode.check_max_jerk and extremes.jerk_max > order.jerk * more:
        return Fault.JERK_ABOVE
    if order.mode.check_max_jerk and extremes.jerk_min < -order.jerk * more:
        return Fault.JERK_BELOW
    return Fault.NONE
