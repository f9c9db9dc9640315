"""Building blocks of position-based profiles, other than the single quintic P5, and how long their ramps take.

Velocities, accelerations and jerks are those at constant master velocity; times in s, distances in u.
Source: TS5055, section 7.
"""

from math import sqrt

from ..numerics.computable_range import SHORTEST_TIME
from .profile import Profile, ProfileKind

SAME_DISTANCE = 1e-12  # of the change of velocity: the mean velocity is in the middle of both ends, but for rounding
JERK_TOLERANCE = 1e-9  # of the jerk limit: a ramp as short as the limit allows keeps it but for rounding


def add_constant_velocity(profile: Profile, duration: float, velocity: float) -> None:
    """P1: append constant velocity; nothing for a duration that is too short to be computed with, or negative."""
    if duration >= SHORTEST_TIME:
        profile.add_segment(duration, profile.next_position, velocity * duration, 0.0, 0.0, 0.0, 0.0)
        profile.next_position = profile.next_position + velocity * duration


def add_ramp(profile: Profile, duration: float, velocity: float, end_velocity: float) -> None:
    """Append v + (v_e - v) (3 u^2 - 2 u^3), unaccelerated at both ends; nothing for a duration as above."""
    if duration >= SHORTEST_TIME:
        change = (end_velocity - velocity) * duration
        profile.add_segment(duration, profile.next_position, velocity * duration, 0.0, change, -0.5 * change, 0.0)
        profile.next_position = profile.next_position + 0.5 * (velocity + end_velocity) * duration


def add_ramp_from_acceleration(
    profile: Profile, duration: float, velocity: float, acceleration: float, end_velocity: float
) -> None:
    """Append the ramp of gear_in_velo as the first segment, a(u) = (1 - u) (a + (6 dv / T - 3 a) u).

    It leads from the acceleration a at its beginning to an unaccelerated end."""
    rise = 6.0 * (end_velocity - velocity) / duration - 3.0 * acceleration
    c2 = 0.5 * acceleration * duration * duration
    c3 = (rise - acceleration) * duration * duration / 6.0
    c4 = -rise * duration * duration / 12.0
    profile.add_segment(duration, 0.0, velocity * duration, c2, c3, c4, 0.0)


def ramp_duration(change: float, acceleration: float, limit: float, jerk: float) -> float:
    """The shortest duration of `add_ramp_from_acceleration` within the limits, s, for a change of velocity > 0, u/s.

    The limits are |a| <= max(limit, |acceleration|) and, where `jerk` > 0, |j| <= jerk; the jerk is greatest at one of
    the ends. The result is 0 where the change is too small for any duration. `acceleration` counts in the direction of
    the change.

    At the acceleration limit A the ramp's coefficient 6 dv / T - 3 a is b = 2 A - a + 2 sqrt(A^2 - A a). The shortest
    ramp either reaches A or has a jerk at its limit: |6 dv / T^2 - 4 a / T| = J at the beginning, or |6 dv / T^2 -
    2 a / T| = J at the end.
    """
    peak = max(limit, abs(acceleration))
    coefficient = 2.0 * peak - acceleration + 2.0 * sqrt(max(peak * (peak - acceleration), 0.0))
    shortest = 6.0 * change / (coefficient + 3.0 * acceleration)
    if jerk <= 0.0 or shortest <= 0.0 or _keeps_jerk(change, acceleration, jerk, shortest):
        return shortest
    best = 0.0
    for end in range(2):
        linear = 2.0 * acceleration if end == 1 else 4.0 * acceleration
        root = sqrt(linear * linear + 24.0 * change * jerk)
        early = 12.0 * change / (linear + root) if linear >= 0.0 else 0.5 * (root - linear) / jerk
        best = _shorter(best, early, change, acceleration, jerk, shortest)
        square = linear * linear - 24.0 * change * jerk
        if square >= 0.0 and linear > 0.0:
            late = 0.5 * (linear + sqrt(square)) / jerk
            best = _shorter(best, late, change, acceleration, jerk, shortest)
            best = _shorter(best, 6.0 * change / jerk / late, change, acceleration, jerk, shortest)
    return best if best > 0.0 else shortest


def _shorter(best: float, candidate: float, change: float, acceleration: float, jerk: float, shortest: float) -> float:
    """The candidate, if it is shorter than the best duration so far and keeps the limits; a best of 0 is none."""
    if candidate < shortest or (0.0 < best <= candidate):
        return best
    return candidate if _keeps_jerk(change, acceleration, jerk, candidate) else best


def _keeps_jerk(change: float, acceleration: float, jerk: float, duration: float) -> bool:
    """Whether a ramp of that duration keeps the jerk limit at both ends."""
    mean = 6.0 * change / duration
    limit = jerk * (1.0 + JERK_TOLERANCE) * duration
    return abs(mean - 4.0 * acceleration) <= limit and abs(mean - 2.0 * acceleration) <= limit


def level_ramp_duration(change: float, limit: float, jerk: float) -> float:
    """The shortest duration of `add_ramp` within the limits, s, for a change of velocity of either sign, u/s.

    The ramp's peaks are |a| = 1.5 |dv| / T and |j| = 6 |dv| / T^2. A `jerk` of 0 means that the jerk is not limited."""
    change = abs(change)
    return max(1.5 * change / limit, sqrt(6.0 * change / jerk)) if jerk > 0.0 else 1.5 * change / limit


def plan_one_ramp(
    profile: Profile, origin: float, duration: float, distance: float, velocity: float, end: float
) -> None:
    """P1+P5 or P5+P1, in which no velocity is outside those of both ends.

    The mean velocity is strictly between those of the ends. The end velocity nearer to it is constant for a time: v
    before a ramp that takes T5 = 2 (distance - v T) / (v_e - v), or v_e after a ramp that takes
    T5 = 2 (v_e T - distance) / (v_e - v). Where both are equally near, but for rounding, the ramp takes all the time.
    """
    mean = distance / duration
    nearer = abs(mean - end) - abs(mean - velocity)
    if abs(nearer) <= SAME_DISTANCE * abs(end - velocity):
        profile.start(ProfileKind.P5_P1, origin)
        add_ramp(profile, duration, velocity, end)
    elif nearer > 0.0:
        ramp = 2.0 * (distance - velocity * duration) / (end - velocity)
        profile.start(ProfileKind.P1_P5, origin)
        add_constant_velocity(profile, duration - ramp, velocity)
        add_ramp(profile, ramp, velocity, end)
    else:
        ramp = 2.0 * (end * duration - distance) / (end - velocity)
        profile.start(ProfileKind.P5_P1, origin)
        add_ramp(profile, ramp, velocity, end)
        add_constant_velocity(profile, duration - ramp, end)


def same_peak_durations(
    duration: float, distance: float, velocity: float, cruise: float, end: float
) -> tuple[float, float]:
    """The durations of both ramps of P5+P1+P5 that have the same peak acceleration, s; (0, 0) if there are none.

    At the velocity c all the time the slave would travel c T, that is c T - distance too far. A ramp that changes the
    velocity by dv with the peak acceleration A lasts 1.5 |dv| / A and loses dv / 2 in each second of that. So
    A = 0.75 ((c - v) |c - v| + (c - v_e) |c - v_e|) / (c T - distance).
    """
    lacking = cruise * duration - distance
    before = cruise - velocity
    after = cruise - end
    square = before * abs(before) + after * abs(after)
    if lacking * cruise <= 0.0 or square * lacking <= 0.0:
        return 0.0, 0.0
    rise = 2.0 * abs(before) * lacking / square
    fall = 2.0 * abs(after) * lacking / square
    if rise + fall > duration:
        return 0.0, 0.0
    return rise, fall
