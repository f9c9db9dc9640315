"""The pieces that position-based profiles are made of but for P5 alone, and how long their ramps take.

Source: TS5055, section 7.

Velocities, accelerations and jerks are those at constant master velocity; times in s.
"""

from math import sqrt

from .profile import Profile, ProfileKind

HALF_WAY = 1e-12  # of the change of velocity: rounding
JERK_TOLERANCE = 1e-9  # of the jerk limit: a ramp as short as the limit allows keeps it but for rounding


def straight(profile: Profile, duration: float, begin: float, velocity: float) -> float:
    """P1: constant velocity, where that lasts; the way at its end, relative to the profile's origin as `begin` is."""
    if duration <= 0.0:
        return begin
    profile.add(duration, begin, velocity * duration, 0.0, 0.0, 0.0, 0.0)
    return begin + velocity * duration


def ramp(profile: Profile, duration: float, begin: float, velocity: float, end_velocity: float) -> float:
    """v + (v_e - v) (3 u^2 - 2 u^3), where it lasts: unaccelerated at both ends; returns as `straight`."""
    if duration <= 0.0:
        return begin
    change = (end_velocity - velocity) * duration
    profile.add(duration, begin, velocity * duration, 0.0, change, -0.5 * change, 0.0)
    return begin + 0.5 * (velocity + end_velocity) * duration


def ramp_from(profile: Profile, duration: float, velocity: float, acceleration: float, end_velocity: float) -> float:
    """The ramp of gear_in_velo, a(u) = (1 - u) (a + (6 dv / T - 3 a) u): from an acceleration to none; the way."""
    rise = 6.0 * (end_velocity - velocity) / duration - 3.0 * acceleration
    c2 = 0.5 * acceleration * duration * duration
    c3 = (rise - acceleration) * duration * duration / 6.0
    c4 = -rise * duration * duration / 12.0
    profile.add(duration, 0.0, velocity * duration, c2, c3, c4, 0.0)
    return velocity * duration + c2 + c3 + c4


def ramp_duration(change: float, acceleration: float, limit: float, jerk: float) -> float:
    """The shortest duration of `ramp_from` for a change of velocity > 0 that keeps |a| <= max(limit, |acceleration|)
    and, where `jerk` > 0, the jerk at both ends, its extremes. 0 where the change is too small for any duration.

    `acceleration` counts in the direction of the change. At the acceleration limit A the ramp's coefficient 6 dv / T -
    3 a is b = 2 A - a + 2 sqrt(A^2 - A a). A shortest ramp lies there or where a jerk is at its limit: |6 dv / T^2 -
    4 a / T| = J at the beginning, |6 dv / T^2 - 2 a / T| = J at the end.
    """
    peak = max(limit, abs(acceleration))
    steep = 2.0 * peak - acceleration + 2.0 * sqrt(max(peak * (peak - acceleration), 0.0))
    shortest = 6.0 * change / (steep + 3.0 * acceleration)
    if jerk <= 0.0 or shortest <= 0.0 or _jerk_kept(change, acceleration, jerk, shortest):
        return shortest
    best = 0.0
    for end in range(2):
        lean = 2.0 * acceleration if end == 1 else 4.0 * acceleration
        root = sqrt(lean * lean + 24.0 * change * jerk)
        best = _better(
            best,
            12.0 * change / (lean + root) if lean >= 0.0 else 0.5 * (root - lean) / jerk,
            change,
            acceleration,
            jerk,
            shortest,
        )
        square = lean * lean - 24.0 * change * jerk
        if square >= 0.0 and lean > 0.0:
            late = 0.5 * (lean + sqrt(square)) / jerk
            best = _better(best, late, change, acceleration, jerk, shortest)
            best = _better(best, 6.0 * change / jerk / late, change, acceleration, jerk, shortest)
    return best if best > 0.0 else shortest


def _better(best: float, candidate: float, change: float, acceleration: float, jerk: float, shortest: float) -> float:
    """The shorter duration of those that are allowed; 0: none yet."""
    if candidate < shortest or (0.0 < best <= candidate):
        return best
    return candidate if _jerk_kept(change, acceleration, jerk, candidate) else best


def _jerk_kept(change: float, acceleration: float, jerk: float, duration: float) -> bool:
    mean = 6.0 * change / duration
    most = jerk * (1.0 + JERK_TOLERANCE) * duration
    return abs(mean - 4.0 * acceleration) <= most and abs(mean - 2.0 * acceleration) <= most


def level_ramp_duration(change: float, limit: float, jerk: float) -> float:
    """The shortest duration of `ramp` for a change of velocity of either sign: at its peak |a| = 1.5 |dv| / T, |j| =
    6 |dv| / T^2. `jerk` 0: not limited."""
    change = abs(change)
    return max(1.5 * change / limit, sqrt(6.0 * change / jerk)) if jerk > 0.0 else 1.5 * change / limit


def begin_first(profile: Profile, origin: float, duration: float, way: float, velocity: float, end: float) -> None:
    """P1+P5 or P5+P1: no velocity outside those of both ends; the mean velocity lies strictly between them.

    The ramp takes T5 = 2 (way - v T) / (v_e - v) after a straight piece at v, or 2 (v_e T - way) / (v_e - v) before one
    at v_e: whichever of the two velocities is nearer to the mean is kept. Where neither is, but for rounding, the ramp
    takes all the time.
    """
    mean = way / duration
    nearer = abs(mean - end) - abs(mean - velocity)
    if abs(nearer) <= HALF_WAY * abs(end - velocity):
        profile.begin(ProfileKind.P5_P1, origin)
        ramp(profile, duration, 0.0, velocity, end)
    elif nearer > 0.0:
        steep = 2.0 * (way - velocity * duration) / (end - velocity)
        profile.begin(ProfileKind.P1_P5, origin)
        at = straight(profile, duration - steep, 0.0, velocity)
        ramp(profile, steep, at, velocity, end)
    else:
        steep = 2.0 * (end * duration - way) / (end - velocity)
        profile.begin(ProfileKind.P5_P1, origin)
        at = ramp(profile, steep, 0.0, velocity, end)
        straight(profile, duration - steep, at, end)


def at_velocity(
    profile: Profile,
    origin: float,
    duration: float,
    velocity: float,
    cruise: float,
    end: float,
    rise: float,
    fall: float,
) -> None:
    """P5+P1+P5: a ramp to the velocity `cruise` in the time `rise`, and one on to `end` in `fall`."""
    profile.begin(ProfileKind.P5_P1_P5, origin)
    at = ramp(profile, rise, 0.0, velocity, cruise)
    at = straight(profile, duration - rise - fall, at, cruise)
    ramp(profile, fall, at, cruise, end)


def same_peak(duration: float, way: float, velocity: float, cruise: float, end: float) -> tuple[float, float]:
    """The times of both ramps of P5+P1+P5 that have the same peak acceleration; (0, 0) if there are none.

    The way lacks c T - way against a constant c; a ramp of change dv with peak A takes 1.5 |dv| / A and takes dv / 2 of
    each second of it: A = 0.75 ((c - v) |c - v| + (c - v_e) |c - v_e|) / (c T - way).
    """
    lacking = cruise * duration - way
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
