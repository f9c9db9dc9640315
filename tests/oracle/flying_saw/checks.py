"""The checks of sync_mode on a planned curve of the flying saw, with their detailed error codes."""

from tests.oracle.flying_saw.curves import JERK, POSITION, VELOCITY, Curve
from tests.oracle.flying_saw.request import Request
from tests.oracle.numerics import mp

TOLERANCE = mp.mpf("1e-9")
"""Of a check, of a jerk that just fits, of an acceleration that counts as none; see the specification for of what."""

CHECKS = {
    "check_min_position": (0x4372,),
    "check_max_position": (0x4373,),
    "check_undershoot_position": (0x4376, 0x4377),
    "check_overshoot_position": (0x4378, 0x4379),
    "check_max_velocity": (0x437A, 0x437B),
    "check_overshoot_velocity": (0x437C, 0x437D, 0x437E, 0x437F),
    "check_undershoot_velocity": (0x4380, 0x4381, 0x4382, 0x4383),
    "check_overshoot_velocity_zero": (0x4384, 0x4385),
    "check_undershoot_velocity_zero": (0x4386, 0x4387),
    "check_max_acceleration": (0x4388,),
    "check_max_deceleration": (0x4389,),
    "check_max_jerk": (0x438A, 0x438B),
}
"""The codes that each check may give."""


def find_broken_checks(request: Request, curve: Curve) -> set[int]:
    """The detailed codes of all active checks that the curve breaks."""
    active = [name for name in CHECKS if name in request.bits]
    if not active or not curve.segments:
        return set()
    codes = {code for name in active for code in CHECKS[name]}
    return _all_broken(request, curve) & codes


def _all_broken(request: Request, curve: Curve) -> set[int]:
    return (
        _broken_positions(request, curve)
        | _broken_velocities(request, curve)
        | _broken_overshoot(request, curve)
        | _broken_dynamics(request, curve)
    )


def _broken_positions(request: Request, curve: Curve) -> set[int]:
    minimum, maximum = (e.value for e in curve.extrema(POSITION))
    start, sync = curve.start()[POSITION], curve.finish()[POSITION]
    tolerance = TOLERANCE * (maximum - minimum)
    codes = set()
    if minimum < request.ends[0] - tolerance:
        codes.add(0x4372)
    if maximum > request.ends[1] + tolerance:
        codes.add(0x4373)
    if minimum < min(start, sync) - tolerance:
        codes.add(0x4376 if sync < start else 0x4377)
    if maximum > max(start, sync) + tolerance:
        codes.add(0x4378 if sync < start else 0x4379)
    return codes


def _broken_velocities(request: Request, curve: Curve) -> set[int]:
    minimum, maximum = (e.value for e in curve.extrema(VELOCITY))
    tolerance = TOLERANCE * max(abs(minimum), abs(maximum))
    master_forwards = request.master.velocity > 0
    codes = set()
    if maximum > request.limits.velocity + tolerance:
        codes.add(0x437A)
    if minimum < -request.limits.velocity - tolerance:
        codes.add(0x437B)
    if maximum > tolerance:
        codes.add(0x4384 if master_forwards else 0x4385)
    t = mp.sign(request.synchronous_velocity)
    if min(t * minimum, t * maximum) < -tolerance:
        codes.add(0x4386 if master_forwards else 0x4387)
    return codes


def _broken_overshoot(request: Request, curve: Curve) -> set[int]:
    """Velocities beyond those of both ends, in the direction t of the synchronous velocity."""
    t = mp.sign(request.synchronous_velocity)
    ends = [e.value * t for e in curve.extrema(VELOCITY)]
    minimum, maximum = min(ends), max(ends)
    tolerance = TOLERANCE * max(abs(minimum), abs(maximum))
    start, sync = t * request.slave.velocity, abs(request.synchronous_velocity)
    slowing = start > sync
    codes = set()
    if maximum > max(start, sync) + tolerance:
        codes.add((0x437C if t > 0 else 0x437E) + slowing)
    if minimum < min(start, sync) - tolerance:
        codes.add((0x4380 if t > 0 else 0x4382) + (not slowing))
    return codes


def _broken_dynamics(request: Request, curve: Curve) -> set[int]:
    limits = request.limits
    speeding, slowing = curve.speeding
    least_jerk, greatest_jerk = (e.value for e in curve.extrema(JERK))
    codes = set()
    if speeding > limits.acceleration * (1 + TOLERANCE):
        codes.add(0x4388)
    if slowing > limits.deceleration * (1 + TOLERANCE):
        codes.add(0x4389)
    if greatest_jerk > limits.jerk * (1 + TOLERANCE):
        codes.add(0x438A)
    if least_jerk < -limits.jerk * (1 + TOLERANCE):
        codes.add(0x438B)
    return codes
