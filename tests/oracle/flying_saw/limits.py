"""Which limit of its axis the flying saw exceeds, whatever is checked.

Readings of the description:
- What was planned counts from its beginning to its end: a profile until it is in sync, a time-based ramp at constant
  master velocity until it has arrived, a move or a change of velocity until it is over, the halt of the backstop until
  the slave is at rest. A stop at once counts until another motion starts.
- Beside that, what the slave does at the end of a step counts, and its mean velocity in the step.
- Of several limits the first one in the order of the codes is shown.
- An end position is passed by more than 1e-9 of itself and of the travel in 1 s at the axis's velocity. A plan exceeds
  a limit by more than 1e-9 of it, an instant or a step by more than 1e-6. A slave slower than 1e-6 of the axis's
  velocity gets neither faster nor slower: it may have the greater acceleration of the two.
- A limit that is no number above 0 limits nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

from tests.oracle.flying_saw.curves import JERK, POSITION, VELOCITY, ZERO, Curve
from tests.oracle.flying_saw.motion import advanced
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

NONE, MIN_POSITION, MAX_POSITION, MAX_VELOCITY, MAX_ACCELERATION, MAX_DECELERATION, MAX_JERK, INSTANT_STOP = range(8)

PLAN, INSTANT, END = mp.mpf("1e-9"), mp.mpf("1e-6"), mp.mpf("1e-9")


@dataclass(frozen=True, slots=True)
class AxisData:
    """The machine data: u, u/s, u/s2 and u/s3."""

    low: Number
    high: Number
    velocity: Number
    acceleration: Number
    deceleration: Number
    jerk: Number

    @staticmethod
    def of(inputs: Mapping[str, Any]) -> "AxisData":
        """The axis as its variables are set now; a deceleration of 0 means the acceleration."""
        low, high, v, a, d, j = (
            mp.mpf(inputs[f"axis.{name}"])
            for name in (
                "min_position",
                "max_position",
                "max_velocity",
                "max_acceleration",
                "max_deceleration",
                "max_jerk",
            )
        )
        return AxisData(low, high, v, a, d if d != 0 else a, j)


def by_plan(curve: Curve, axis: AxisData) -> int:
    """The code of what a curve in time exceeds; a curve without segments exceeds nothing."""
    if not curve.segments:
        return NONE
    ends = [e.value for e in curve.extrema(POSITION)]
    speed, jerk = (max(abs(e.value) for e in curve.extrema(order)) for order in (VELOCITY, JERK))
    faster, slower = curve.speeding
    return _first(axis, PLAN, ends, (speed, faster, slower, jerk))


def by_instant(state: Sequence[Number], axis: AxisData) -> int:
    """The code of what position, velocity, acceleration and jerk of an instant exceed."""
    s, v, a, j = state
    faster = abs(a) if v * a > 0 else ZERO
    slower = abs(a) if v * a < 0 else ZERO
    if abs(v) <= INSTANT * axis.velocity:
        faster, slower = (abs(a) if abs(a) > max(axis.acceleration, axis.deceleration) else ZERO), ZERO
    return _first(axis, INSTANT, (s, s), (abs(v), faster, slower, abs(j)))


def by_way(way: Number, duration: Number, axis: AxisData) -> int:
    """The code of what the way of a step in so much time exceeds: its mean velocity may be too great."""
    return MAX_VELOCITY if 0 < axis.velocity * (1 + INSTANT) * duration < abs(way) else NONE


def _first(axis: AxisData, tolerance: Number, ends: Sequence[Number], sizes: Sequence[Number]) -> int:
    for beyond, end, code in (
        (axis.low - ends[0], axis.low, MIN_POSITION),
        (ends[1] - axis.high, axis.high, MAX_POSITION),
    ):
        if beyond > END * (abs(end) + axis.velocity):
            return code
    limits = (axis.velocity, axis.acceleration, axis.deceleration, axis.jerk)
    for size, limit, code in zip(sizes, limits, range(MAX_VELOCITY, MAX_JERK + 1), strict=True):
        if 0 < limit * (1 + tolerance) < size:
            return code
    return NONE


@lru_cache(maxsize=256)  # where a run has reactions, it is started anew for each of them
def by_motion(start: Motion, phases: tuple[tuple[Number, Number], ...], axis: AxisData) -> int:
    """The same of the slave's own motion, from its phases of (duration, jerk); without a phase it exceeds nothing."""
    if not phases:
        return NONE
    positions, speed, faster, slower = [start.position], abs(start.velocity), ZERO, ZERO
    for duration, jerk in phases:
        for first, last in pairwise(_cuts(start, duration, jerk)):
            early, middle, late = (advanced(start, jerk, time) for time in (first, (first + last) / 2, last))
            positions.append(late.position)
            speed = max(speed, abs(late.velocity))
            steepest = max(abs(early.acceleration), abs(late.acceleration))
            if middle.velocity * middle.acceleration > 0:
                faster = max(faster, steepest)
            elif middle.velocity * middle.acceleration < 0:
                slower = max(slower, steepest)
        start = advanced(start, jerk, duration)
    jerk = max(abs(jerk) for _, jerk in phases)
    return _first(axis, PLAN, (min(positions), max(positions)), (speed, faster, slower, jerk))


def _cuts(start: Motion, duration: Number, jerk: Number) -> list[Number]:
    """The ends of a phase, and where in it the velocity or the acceleration is 0."""
    v, a = start.velocity, start.acceleration
    result = [-a / jerk] if jerk != 0 else []
    square = a**2 - 2 * jerk * v
    if jerk != 0 and square >= 0:
        result += [(-a + side * mp.sqrt(square)) / jerk for side in (1, -1)]
    elif jerk == 0 and a != 0:
        result += [-v / a]
    return sorted({ZERO, duration, *(time for time in result if 0 < time < duration)})
