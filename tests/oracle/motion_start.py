"""What an axis's own motion begins with: a state that the axis could have had.

Readings of the specification:
- Speeding up, an acceleration beyond the axis's limit begins with `max_acceleration`, slowing down with
  `max_deceleration`; slower than 1e-6 of the axis's velocity it is neither, and the greater limit counts.
- The velocity stays, unless a stop with the motion's own deceleration and jerk would end beyond an end position, or
  beyond where the axis is, by more than a stop from the axis's greatest velocity. Then the motion begins with that
  velocity, and does not speed up.
- Which limit the state before was beyond, by more than 1e-6 of it, shows as long as the motion lasts.
- A limit that is no number above 0 limits nothing.
"""

from dataclasses import replace

from tests.oracle.flying_saw.limits import INSTANT, MAX_ACCELERATION, MAX_DECELERATION, MAX_VELOCITY, NONE, AxisData
from tests.oracle.flying_saw.motion import run, stop
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

STANDSTILL = 1e-6


def begin_of_own_motion(state: Motion, axis: AxisData, deceleration: Number, jerk: Number) -> tuple[Motion, int]:
    """The state with which the motion begins, and the code of the limit that the state was beyond."""
    limits = axis.velocity, axis.acceleration, axis.deceleration
    bounded = replace(state, acceleration=attainable_acceleration(state.velocity, state.acceleration, *limits))
    code = NONE
    if abs(state.acceleration) > abs(bounded.acceleration) * (1 + INSTANT):
        code = MAX_DECELERATION if state.velocity * state.acceleration < 0 else MAX_ACCELERATION
    greatest = axis.velocity
    if not 0 < greatest < mp.inf:
        return bounded, code
    fastest = Motion(mp.mpf(0), greatest, mp.mpf(0))
    longest = run(fastest, stop(fastest, deceleration, jerk)).position
    end = run(bounded, stop(bounded, deceleration, jerk)).position
    outside = max(end - max(axis.high, state.position), min(axis.low, state.position) - end)
    if not outside > longest:
        return bounded, code
    speed = min(max(bounded.velocity, -greatest), greatest)
    rate = mp.mpf(0) if bounded.velocity * bounded.acceleration > 0 else bounded.acceleration
    return Motion(state.position, speed, rate), code or MAX_VELOCITY


def attainable_acceleration(v: Number, a: Number, velocity: Number, faster: Number, slower: Number) -> Number:
    """The nearest acceleration that an axis with these limits can have at velocity v; numbers or floats."""
    limit = faster if v * a > 0 else slower
    if abs(v) <= STANDSTILL * velocity:
        limit = max(faster, slower)
    return min(max(a, -limit), limit) if limit > 0 else a
