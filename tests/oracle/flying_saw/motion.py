"""The flying saw's own motion: time-optimal, jerk-limited changes of velocity and moves to a position.

A motion is a list of phases (duration in s, jerk in u/s3) from a known state.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TypeAlias

from tests.oracle.flying_saw.curves import ZERO, solve
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

Phases: TypeAlias = list[tuple[Number, Number]]

SAMPLES = 50
MOST_DOUBLINGS = 200


def advanced(start: Motion, jerk: Number, time: Number) -> Motion:
    """The state after `time` (s) with that jerk."""
    p, v, a = start.position, start.velocity, start.acceleration
    return Motion(p + time * (v + time * (a / 2 + time * jerk / 6)), v + time * (a + time * jerk / 2), a + time * jerk)


def run(start: Motion, phases: Sequence[tuple[Number, Number]]) -> Motion:
    """The state after all phases."""
    for duration, jerk in phases:
        start = advanced(start, jerk, duration)
    return start


def limit_towards(v: Number, target: Number, acceleration: Number, deceleration: Number) -> Number:
    """The acceleration limit (u/s2) of a change from v to the target velocity."""
    if v * target < 0:
        return min(acceleration, deceleration)
    return acceleration if abs(target) > abs(v) else deceleration


def ramp(v: Number, a: Number, target: Number, limit: Number, jerk: Number) -> Phases:
    """From velocity v and acceleration a to the target velocity, free of acceleration, in the shortest time."""
    return ramp_between(v - target, a, -limit, limit, jerk)


def ramp_between(w: Number, rate: Number, low: Number, high: Number, jerk: Number) -> Phases:
    """From (w, w' = rate) to (0, 0) in the shortest time with low <= w' <= high and |w''| <= jerk.

    A rate outside the limits is first brought to the limit. Letting the rate go to 0 at once ends at w_0; the sign of
    w_0 shows to which side w' must first go. Its peak is where the rise and the fall cover the difference; limited,
    it is held for the rest. If 0 is no rate strictly between the limits there is no such ramp: w' then goes to the
    limit next to 0 and stays there for ever (the last phase has an infinite duration).
    """
    if not low < 0 < high:
        nearest = high if high <= 0 else low
        return [*_to(rate, nearest, jerk), (mp.inf, ZERO)]
    missing = -(w + rate * abs(rate) / (2 * jerk))
    if missing == 0:
        return _to(rate, ZERO, jerk)
    side = mp.sign(missing)
    bound = high if side > 0 else -low
    start, needed = side * rate, side * missing
    if start >= bound:
        phases = [((start - bound) / jerk, -jerk), (needed / bound, ZERO), (bound / jerk, -jerk)]
    else:
        peak = _peak(start, -side * w, jerk)
        if peak <= bound:
            phases = [((peak - start) / jerk, jerk), (peak / jerk, -jerk)]
        else:
            covered = (2 * bound**2 - start**2) / (2 * jerk)
            phases = [((bound - start) / jerk, jerk), ((-side * w - covered) / bound, ZERO), (bound / jerk, -jerk)]
    return [(duration, side * rate_of_change) for duration, rate_of_change in phases if duration > 0]


def _peak(start: Number, distance: Number, jerk: Number) -> Number:
    """The peak of a w' that rises from `start` and falls to 0 while w covers `distance`: 2·peak² - start² = 2·j·d."""
    return mp.sqrt(max(jerk * distance + start**2 / 2, ZERO))


def _to(rate: Number, requested: Number, jerk: Number) -> Phases:
    """A rate brought to another one."""
    return [(abs(requested - rate) / jerk, mp.sign(requested - rate) * jerk)] if rate != requested else []


def stop(state: Motion, deceleration: Number, jerk: Number) -> Phases:
    """The time-optimal way to rest."""
    return ramp(state.velocity, state.acceleration, ZERO, deceleration, jerk)


@lru_cache(maxsize=256)  # where a run has reactions, it is started anew for each of them
def move(
    start: Motion, target: Number, velocity: Number, acceleration: Number, deceleration: Number, jerk: Number
) -> Phases:
    """From any state to rest at the target position; all limits positive.

    The ramp towards the cruise velocity is kept up for a time after which the stop ends at the target. The least such
    time is taken: with unequal limits the end position is not monotone in it. (Acceleration below deceleration, and
    moving away: it first goes the wrong way. Started beyond the limits: it may reverse near the end of the ramp.)
    """
    ending = run(start, stop(start, deceleration, jerk)).position
    if ending == target:
        return stop(start, deceleration, jerk)
    cruise = velocity if target >= ending else -velocity
    limit = limit_towards(start.velocity, cruise, acceleration, deceleration)
    towards = ramp(start.velocity, start.acceleration, cruise, limit, jerk)

    def beyond(time: Number) -> Number:
        return run(start, _with_constant_velocity(start, towards, time, deceleration, jerk)).position - target

    time = solve(beyond, *_bracket(beyond, sum((duration for duration, _ in towards), ZERO)))
    return _with_constant_velocity(start, towards, time, deceleration, jerk)


def _bracket(beyond: Callable[[Number], Number], ramp_time: Number) -> tuple[Number, Number]:
    """The first interval, sampled over the ramp, in which the stop comes to end beyond the target."""
    side = mp.sign(beyond(ZERO))
    low, high = ZERO, ramp_time / SAMPLES
    for _ in range(SAMPLES + MOST_DOUBLINGS):
        if high > 0 and beyond(high) * side <= 0:
            return low, high
        low, high = high, high + ramp_time / SAMPLES if high < ramp_time else 2 * high + mp.mpf(1) / 1024
    raise ArithmeticError("the target is out of reach")


def _with_constant_velocity(start: Motion, towards: Phases, time: Number, deceleration: Number, jerk: Number) -> Phases:
    """The ramp, then its cruise, for `time`; then the stop."""
    phases: Phases = []
    for duration, rate in [*towards, (mp.inf, ZERO)]:
        part = min(duration, time)
        if part > 0:
            phases.append((part, rate))
        time -= part
    return phases + stop(run(start, phases), deceleration, jerk)
