"""One synchronisation of the flying saw, planned for a master that goes on at constant velocity.

`plan` is the interface for random comparisons: from the states, the factor, the limits and the sync mode to the
refusal, or to the profile, its curve and its characteristic values. Laws are found from their conditions, not from
closed forms: polynomials by elimination, shortest ramps by bracketing on the peak, constant velocities on the distance.

Readings of the specification that it leaves open:
- In sync at once there is no profile, so that nothing is checked; start and end are the synchronous state at constant
  master velocity (acceleration and jerk 0), the mean velocity is its magnitude.
- Velocities that differ by less than 1e-13 of the greater one are the same one (a factor such as 1/3 has no exact
  value).
- The slave is at rest if its true velocity and acceleration are 0, whatever is ignored.
- A slave that counts as free of acceleration keeps its tiny acceleration in P5; the other profiles take it as 0.
- At the velocity limit a start above the limit may ask for a peak acceleration of the wrong sign: no such profile.
- A mean velocity that differs from an end's by less than 1e-12 of the greater one is not between them.
- Where the mean velocity is half way between v0 and v_s, but for rounding, the ramp takes all the time: P5+P1.
- `prefer_constant_velocity`: solutions on the side of 0 with the sign of v_s come first, then those on the other side.
- A time-based profile reports and checks the ramp at constant master velocity from the slave's true acceleration;
  the ignore bits do not concern it. All checks apply to it.
- A position, velocity, or other extremum is checked literally; the end of a gear_in_velo ramp is its sync position.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from itertools import pairwise

from tests.oracle.flying_saw.checks import TOLERANCE, find_broken_checks
from tests.oracle.flying_saw.curves import (
    ACCELERATION,
    JERK,
    POSITION,
    VELOCITY,
    ZERO,
    Curve,
    CurveSegment,
    derivative,
    fitted,
    joined,
    real_roots,
    solve,
    value,
)
from tests.oracle.flying_saw.motion import limit_towards, ramp
from tests.oracle.flying_saw.request import GEAR_IN_POS, GEAR_IN_VELO, Limits, Request
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

NONE, P5, P1_P5, P5_P1, P5_P1_P5, JERK_LIMITED = range(6)

NO_ERROR, BROKEN_CHECK = 0, 0x42DF
BAD_FACTOR, BAD_LIMIT, NOT_FOR_POSITION = 0x425B, 0x42DD, 0x4289
STANDING_MASTER, STANDING_MASTER_MOVING_SLAVE, NOT_AHEAD = 0x426E, 0x424A, 0x42DE

SAME = mp.mpf("1e-13")
"""Relative difference below which two velocities are the same one."""

ROUNDING = mp.mpf("1e-12")
"""Relative difference that is rounding: of |v_s| by that of the factor, of a mean velocity by that of positions."""

SAMPLES = 64
"""Places per interval at which the search for a constant velocity looks for a change of sign."""

DYNAMIC = frozenset({0x4388, 0x4389, 0x438A, 0x438B})
"""The codes of acceleration, deceleration and jerk, for which the faster profiles give way to P5."""

CHARACTERISTICS = (
    "profile",
    "master_velocity_nominal",
    "master_position_start",
    "slave_position_start",
    "slave_velocity_start",
    "slave_acceleration_start",
    "slave_jerk_start",
    "master_position_end",
    "slave_position_end",
    "slave_velocity_end",
    "slave_acceleration_end",
    "slave_jerk_end",
    *(
        f"{kind}_{quantity}_{side}"
        for quantity in ("position", "velocity", "acceleration")
        for side in ("min", "max")
        for kind in ("slave", "master_position_at_slave")
    ),
    "slave_velocity_at_slave_acceleration_min",
    "slave_velocity_at_slave_acceleration_max",
    "slave_jerk_min",
    "slave_jerk_max",
    "slave_dynamic_momentum_min",
    "slave_dynamic_momentum_max",
    "slave_velocity_mean",
    "slave_acceleration_effective",
)


@dataclass(frozen=True)
class Plan:
    """A refusal, or a profile over the time at constant master velocity; an empty curve is in sync at once."""

    request: Request
    error: int = NO_ERROR
    profile: int = NONE
    curve: Curve = field(default_factory=lambda: Curve(()))

    def at(self, master_position: Number) -> tuple[Number, Number, Number, Number]:
        """Slave position, velocity, acceleration and jerk where the master, at constant velocity, is (u, s).

        From the end of the profile on the synchronous motion.
        """
        beyond = mp.mpf(master_position) - self.master_end
        if not self.curve.segments or beyond * mp.sign(self.request.master.velocity) >= 0:
            end = self.curve.finish()[0] if self.curve.segments else self.request.slave.position
            return end + self.request.factor * beyond, self.request.synchronous_velocity, ZERO, ZERO
        return self.curve.at(self.curve.duration + beyond / self.request.master.velocity)

    @property
    def master_end(self) -> Number:
        """The master position at which the profile ends."""
        return self.request.master.position + self.request.master.velocity * self.curve.duration

    @cached_property
    def characteristics(self) -> dict[str, Number]:
        """Every characteristic value; see the specification for the names."""
        return _characteristics(self)


def plan(
    mode: str,
    master: Sequence[float],
    slave: Sequence[float],
    factor: float,
    limits: Sequence[float],
    bits: Collection[str] = (),
    ends: tuple[float, float] = (-1e9, 1e9),
    sync: tuple[float, float] | None = None,
) -> Plan:
    """The plan from plain numbers: states as (position, velocity, acceleration), limits as in `Limits`."""
    return planned(
        Request(
            mode,
            Motion(*map(mp.mpf, master)),
            Motion(*map(mp.mpf, slave)),
            mp.mpf(factor),
            Limits(*limits),
            frozenset(bits),
            (mp.mpf(ends[0]), mp.mpf(ends[1])),
            (mp.mpf(sync[0]), mp.mpf(sync[1])) if sync else None,
        )
    )


@lru_cache(maxsize=256)  # where a run has reactions, it is started anew for each of them
def planned(request: Request) -> Plan:
    """The plan of a request, with the first error that applies."""
    if error := refusal(request):
        return Plan(request, error)
    if in_sync_at_once(request):
        return Plan(request)
    profile, curve = _choose_profile(request)
    codes = find_broken_checks(request, curve)
    if codes:
        return Plan(request, min(codes) if "detailed_error_codes" in request.bits else BROKEN_CHECK)
    return Plan(request, NO_ERROR, profile, curve)


# --- what is refused before anything is planned -----------------------------------------------------------------------


def refusal(request: Request, *, slave_side: bool = True) -> int:
    """The first error of the command itself; without `slave_side` not whether the slave's sync position is ahead."""
    beyond = abs(request.synchronous_velocity) > request.limits.velocity * (1 + ROUNDING)
    limited = "check_max_velocity" in request.bits or (request.time_based and request.mode == GEAR_IN_VELO)
    if request.factor == 0 or not mp.isfinite(request.factor):
        return BAD_FACTOR
    if not request.limits.valid or (beyond and limited):
        return BAD_LIMIT
    if request.mode == GEAR_IN_POS:
        return _refusal_to_position(request, slave_side)
    never_meets = request.master.velocity == 0 and not request.is_slave_at_rest
    return STANDING_MASTER_MOVING_SLAVE if never_meets else NO_ERROR


def _refusal_to_position(request: Request, slave_side: bool) -> int:
    if request.time_based:
        return NOT_FOR_POSITION
    if request.master.velocity == 0:
        return STANDING_MASTER
    assert request.sync
    forwards = mp.sign(request.master.velocity)
    ahead = (request.sync[0] - request.master.position) * forwards > 0
    slave_ahead = (request.sync[1] - request.slave.position) * mp.sign(request.factor) * forwards > 0
    return NO_ERROR if ahead and (slave_ahead or not slave_side) else NOT_AHEAD


def in_sync_at_once(request: Request) -> bool:
    """Both at rest, or gear_in_velo with nothing left to change."""
    if request.mode == GEAR_IN_POS:
        return False
    if request.master.velocity == 0 and request.is_slave_at_rest:
        return True
    alike = same_velocity(request.slave.velocity, request.synchronous_velocity)
    if request.time_based:
        return alike and bool(request.slave.acceleration == request.factor * request.master.acceleration)
    return alike


def same_velocity(a: Number, b: Number) -> bool:
    return bool(abs(a - b) <= SAME * max(abs(a), abs(b)))


# --- the profiles -----------------------------------------------------------------------------------------------------


def _choose_profile(request: Request) -> tuple[int, Curve]:
    """The profile that is to be checked in the end, by the order of choice."""
    if request.mode == GEAR_IN_VELO:
        return (JERK_LIMITED, _jerk_limited(request)) if request.time_based else (P5, _velocity_ramp(request))
    if not _free_of_acceleration(request):
        return P5, _quintic(request)
    if "prefer_constant_velocity" in request.bits:
        curve = _preferred_constant_velocity(request)
        if curve and not find_broken_checks(request, curve):
            return P5_P1_P5, curve
    if "check_overshoot_velocity" in request.bits or "check_undershoot_velocity" in request.bits:
        profile, curve = _without_overshoot(request)
        if curve and not find_broken_checks(request, curve) & DYNAMIC:
            return profile, curve
    quintic = _quintic(request)
    if "check_max_velocity" in request.bits:
        curve = _at_the_velocity_limit(request, quintic)
        if curve and not find_broken_checks(request, curve) & DYNAMIC:
            return P5_P1_P5, curve
    return P5, quintic


def _free_of_acceleration(request: Request) -> bool:
    master, slave, time = request.master, request.slave, request.time
    slave_speed = max(abs(slave.velocity), abs(request.synchronous_velocity))
    return bool(
        abs(request.master_acceleration) * time <= TOLERANCE * abs(master.velocity)
        and abs(request.slave_acceleration) * time <= TOLERANCE * slave_speed
    )


def _quintic(request: Request) -> Curve:
    """P5: position, slope and curvature given at both ends."""
    assert request.sync
    start, end = request.slave, request.time
    polynomial = fitted(
        end,
        [
            (POSITION, 0, start.position),
            (VELOCITY, 0, start.velocity),
            (ACCELERATION, 0, request.start_acceleration),
            (POSITION, 1, request.sync[1]),
            (VELOCITY, 1, request.synchronous_velocity),
            (ACCELERATION, 1, ZERO),
        ],
    )
    return Curve([CurveSegment(ZERO, end, polynomial)])


def blend(time: Number, v0: Number, v1: Number, a0: Number = ZERO) -> list[Number]:
    """The position, from 0, of a ramp in that time from velocity v0 and acceleration a0 to velocity v1, without one.

    The velocity is the cubic that meets these four conditions.
    """
    cubic = fitted(time, [(0, 0, v0), (1, 0, a0), (0, 1, v1), (1, 1, ZERO)])
    return [ZERO, *(c / (i + 1) for i, c in enumerate(cubic))]


def steady(velocity: Number) -> list[Number]:
    return [ZERO, velocity]


def _without_overshoot(request: Request) -> tuple[int, Curve | None]:
    """P1+P5 or P5+P1: the ramp's time is what makes the distance right."""
    v0, v1, time, distance = request.slave.velocity, request.synchronous_velocity, request.time, request.distance
    mean = distance / time
    same = ROUNDING * max(abs(v0), abs(v1))
    if not min(v0, v1) + same < mean < max(v0, v1) - same:
        return NONE, None
    nearer = abs(mean - v1) - abs(mean - v0)
    if abs(nearer) <= ROUNDING * abs(v1 - v0):
        return P5_P1, joined([(time, blend(time, v0, v1))], request.slave.position)
    first_steady = nearer > 0
    retained = v0 if first_steady else v1

    def missing(ramp_time: Number) -> Number:
        return retained * (time - ramp_time) + value(blend(ramp_time, v0, v1), ramp_time) - distance

    ramp_time = solve(missing, time * mp.mpf("1e-30"), time * (1 + mp.mpf("1e-30")))
    ramp_time = min(ramp_time, time)
    rest = (time - ramp_time, steady(retained))
    ramped = (ramp_time, blend(ramp_time, v0, v1))
    parts = [rest, ramped] if first_steady else [ramped, rest]
    return P1_P5 if first_steady else P5_P1, joined(parts, request.slave.position)


def _three_parts(request: Request, c: Number, first: Number, last: Number) -> Curve:
    """P5+P1+P5: ramp to c in the time `first`, c, ramp from c in the time `last`."""
    v0, v1, time = request.slave.velocity, request.synchronous_velocity, request.time
    parts = [
        (first, blend(first, v0, c) if first > 0 else steady(c)),
        (time - first - last, steady(c)),
        (last, blend(last, c, v1) if last > 0 else steady(c)),
    ]
    return joined(parts, request.slave.position)


def _at_the_velocity_limit(request: Request, quintic: Curve) -> Curve | None:
    """P5+P1+P5 whose constant part is the limit that P5 exceeds, both ramps with the same peak acceleration.

    With a peak of 1 the ramps fall short of c·T by a distance; a peak of A makes it 1/A of that.
    """
    limit, v0, v1 = request.limits.velocity, request.slave.velocity, request.synchronous_velocity
    minimum, maximum = (e.value for e in quintic.extrema(VELOCITY))
    tolerance = TOLERANCE * max(abs(minimum), abs(maximum))
    if maximum > limit + tolerance:
        c = limit
    elif minimum < -limit - tolerance:
        c = -limit
    else:
        return None
    unit_first, unit_last = (_shortest(a, ZERO, b, mp.mpf(1), None) for a, b in ((v0, c), (c, v1)))
    short = ZERO
    for duration, from_velocity, to_velocity in ((unit_first, v0, c), (unit_last, c, v1)):
        if duration > 0:
            short += c * duration - value(blend(duration, from_velocity, to_velocity), duration)
    requested = c * request.time - request.distance
    if requested * c <= 0 or short * requested <= 0:
        return None
    stretch = requested / short
    first, last = unit_first * stretch, unit_last * stretch
    return _three_parts(request, c, first, last) if first + last <= request.time else None


def _preferred_constant_velocity(request: Request) -> Curve | None:
    """P5+P1+P5 whose ramps are as short as the limits allow: the constant velocity makes the distance right.

    The distance is not taken to be monotone: every change of sign is looked for, with the places where the ramps just
    fill the time and where a limit changes among the ends of the intervals.
    """
    limits, time, distance = request.limits, request.time, request.distance
    v0, v1 = request.slave.velocity, request.synchronous_velocity
    jerk = limits.jerk if "check_max_jerk" in request.bits else None

    def ramps(c: Number, side: int) -> tuple[Number, Number]:
        """Their times; at c = 0 with the limits of that side."""
        nonzero = c if c != 0 else side * mp.mpf("1e-40")
        return (
            _shortest_from_rest(c - v0, limit_towards(v0, nonzero, limits.acceleration, limits.deceleration), jerk),
            _shortest_from_rest(v1 - c, limit_towards(nonzero, v1, limits.acceleration, limits.deceleration), jerk),
        )

    def spare(c: Number, side: int) -> Number:
        return time - sum(ramps(c, side))

    def missing(c: Number, side: int) -> Number:
        first, last = ramps(c, side)
        return (v0 + c) / 2 * first + c * (time - first - last) + (c + v1) / 2 * last - distance

    reach = 2 * time * max(limits.acceleration, limits.deceleration) + abs(v0) + abs(v1)
    preferred = int(mp.sign(v1))
    for side in (preferred, -preferred):
        result: list[Number] = []
        for low, high in pairwise(sorted({side * c for c in (ZERO, abs(v0), abs(v1), reach)})):
            for a, b in _monotone_parts(partial(spare, side=side), low, high):
                if mp.sign(missing(a, side)) * mp.sign(missing(b, side)) <= 0:
                    result.append(solve(partial(missing, side=side), a, b))
        if result:
            assert max(result) - min(result) <= mp.mpf("1e-30") * reach, f"several constant velocities fit: {result}"
            return _three_parts(request, result[0], *ramps(result[0], side))
    return None


def _monotone_parts(spare: Callable[[Number], Number], low: Number, high: Number) -> list[tuple[Number, Number]]:
    """The parts of the interval in which the ramps fit into the time, cut at samples and where they just fill it."""
    samples = [low + (high - low) * i / SAMPLES for i in range(SAMPLES + 1)]
    parts = []
    for a, b in pairwise(samples):
        at_a, at_b = spare(a), spare(b)
        if at_a < 0 and at_b < 0:
            continue
        if at_a * at_b < 0:
            edge = solve(spare, a, b)
            parts.append((a, edge) if at_a > 0 else (edge, b))
        else:
            parts.append((a, b))
    return parts


def _shortest_from_rest(change: Number, limit: Number, jerk: Number | None) -> Number:
    """The shortest blend free of acceleration at both ends, from the peaks of the unit blend 3u² - 2u³."""
    by_jerk = mp.sqrt(6 * abs(change) / jerk) if jerk else ZERO
    return max(3 * abs(change) / (2 * limit), by_jerk)


def _velocity_ramp(request: Request) -> Curve:
    """The gear_in_velo ramp, position based."""
    limits, v0, v1 = request.limits, request.slave.velocity, request.synchronous_velocity
    limit = limit_towards(v0, v1, limits.acceleration, limits.deceleration)
    jerk = limits.jerk if "check_max_jerk" in request.bits else None
    return velocity_ramp(request.slave.position, v0, request.start_acceleration, v1, limit, jerk)


def velocity_ramp(s0: Number, v0: Number, a0: Number, v1: Number, limit: Number, jerk: Number | None) -> Curve:
    """The shortest blend from (v0, a0) to (v1, 0) within an acceleration limit (at least |a0|) and a jerk limit."""
    time = _shortest(v0, a0, v1, limit, jerk)
    return joined([(time, blend(time, v0, v1, a0))], s0) if time > 0 else Curve(())


def _shortest(v0: Number, a0: Number, v1: Number, limit: Number, jerk: Number | None) -> Number:
    """The least T of a blend with |a| <= max(limit, |a0|), |j| <= jerk.

    In x = 1/T: a(u) = (1 - u)(a + b·u), b = 6Δx - 3a. The peak of |a| rises with x from where it first exceeds |a|, so
    the greatest x that keeps the limit is bracketed. The jerk is linear in u; the x at which it meets its limit at an
    end are found as roots, and the greatest allowed one that keeps all limits counts.
    """
    change = abs(v1 - v0)
    if change == 0:
        return ZERO
    a = a0 * mp.sign(v1 - v0)
    greatest = max(limit, abs(a))

    def peak(x: Number) -> Number:
        b = 6 * change * x - 3 * a
        quadratic = [a, b - a, -b]
        extremal = [ZERO, *([(b - a) / (2 * b)] if b != 0 and 0 < (b - a) / (2 * b) < 1 else []), mp.mpf(1)]
        return max(abs(value(quadratic, u)) for u in extremal)

    low, high = max(ZERO, (abs(a) + 3 * a) / (6 * change)), (8 * greatest + 3 * a) / (6 * change)
    for _ in range(170):
        middle = (low + high) / 2
        low, high = (middle, high) if peak(middle) <= greatest else (low, middle)
    if jerk is None:
        return 1 / low
    ends = [[ZERO, -4 * a, 6 * change], [ZERO, -2 * a, 6 * change]]

    def keeps(x: Number) -> bool:
        return all(abs(value(end, x)) <= jerk * (1 + TOLERANCE) for end in ends)

    candidates = [low]
    for end in ends:
        for level in (jerk, -jerk):
            candidates += real_roots([-level, *end[1:]], 2 * low)
    return 1 / max(x for x in candidates if x <= low and keeps(x))


def _jerk_limited(request: Request) -> Curve:
    """The time-based ramp at constant master velocity."""
    limits, slave, v1 = request.limits, request.slave, request.synchronous_velocity
    limit = limit_towards(slave.velocity, v1, limits.acceleration, limits.deceleration)
    parts, v, a = [], slave.velocity, slave.acceleration
    for duration, jerk in ramp(v, a, v1, limit, limits.jerk):
        polynomial = [ZERO, v, a / 2, jerk / 6]
        parts.append((duration, polynomial))
        v, a = (value(derivative(polynomial, order), duration) for order in (1, 2))
    return joined(parts, slave.position)


# --- characteristic values --------------------------------------------------------------------------------------------


def _characteristics(plan: Plan) -> dict[str, Number]:
    master = plan.request.master
    result = dict.fromkeys(CHARACTERISTICS, ZERO)
    result |= {"profile": plan.profile, "master_velocity_nominal": master.velocity}
    if not plan.curve.segments:
        return result | _characteristics_in_sync(plan)
    curve = plan.curve

    def master_position(time: Number) -> Number:
        return master.position + master.velocity * time

    for when, time, values in (("start", ZERO, curve.start()), ("end", curve.duration, curve.finish())):
        result[f"master_position_{when}"] = master_position(time)
        for name, results in zip(("position", "velocity", "acceleration", "jerk"), values, strict=True):
            result[f"slave_{name}_{when}"] = results
    for order, name in ((POSITION, "position"), (VELOCITY, "velocity"), (ACCELERATION, "acceleration")):
        for side, extremum in zip(("min", "max"), curve.extrema(order), strict=True):
            result[f"slave_{name}_{side}"] = extremum.value
            result[f"master_position_at_slave_{name}_{side}"] = master_position(extremum.time)
            if order == ACCELERATION:
                result[f"slave_velocity_at_slave_acceleration_{side}"] = curve.at(extremum.time)[VELOCITY]
    for name, extrema in (("jerk", curve.extrema(JERK)), ("dynamic_momentum", curve.momentum())):
        result[f"slave_{name}_min"], result[f"slave_{name}_max"] = (e.value for e in extrema)
    result["slave_velocity_mean"] = curve.mean_speed()
    result["slave_acceleration_effective"] = curve.effective_acceleration()
    return result


def _characteristics_in_sync(plan: Plan) -> dict[str, Number]:
    """In sync at once: start, end and extrema are one state at constant master velocity."""
    request = plan.request
    result: dict[str, Number] = {}
    for name in CHARACTERISTICS:
        if name.startswith("master_position"):
            result[name] = request.master.position
        elif name in {f"slave_position_{x}" for x in ("start", "end", "min", "max")}:
            result[name] = request.slave.position
        elif name.startswith("slave_velocity"):
            result[name] = request.synchronous_velocity
    result["slave_velocity_mean"] = abs(request.synchronous_velocity)
    return result
