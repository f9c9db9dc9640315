"""The scripted master axis, exact: a cubic of time for each stretch on which it moves one way only.

Script: initial position, velocity, acceleration, then segments, each with a duration and at most one of `velocity`
(a jump, then constant), `acceleration` (constant), `jerk` (constant, from the acceleration reached so far). After the
last segment the velocity stays. Positions are the true, unwrapped ones.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

CLOSE = mp.mpf("1e-35")
"""Relative distance below which two computed positions are the same one."""

KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class Motion:
    """Position, velocity and acceleration at one instant (u, u/s, u/s2)."""

    position: Number
    velocity: Number
    acceleration: Number


@dataclass(frozen=True, slots=True)
class Stretch:
    """The master from `begin` to `end` (s), in one `direction`: constant jerk from the state `start` at `origin`."""

    begin: Number
    end: Number
    origin: Number
    start: Motion
    jerk: Number
    direction: int = 0

    def at(self, time: Number) -> Motion:
        """The motion at `time`, which may lie outside the stretch (then extrapolated)."""
        t, s = time - self.origin, self.start
        if not self.jerk:  # the terms with it are 0, and take half of the time
            return Motion(
                s.position + t * (s.velocity + t * s.acceleration / 2), s.velocity + t * s.acceleration, s.acceleration
            )
        return Motion(
            s.position + t * (s.velocity + t * (s.acceleration / 2 + t * self.jerk / 6)),
            s.velocity + t * (s.acceleration + t * self.jerk / 2),
            s.acceleration + t * self.jerk,
        )

    def when(self, position: Number, low: Number, high: Number) -> Number:
        """The time in [low, high] at which a moving master is at `position`; the nearer limit if it is never there.

        Newton's method kept inside a bracket, which a step that would leave it bisects.
        """
        time = low
        for _ in range(400):
            motion = self.at(time)
            missing = position - motion.position
            if missing * self.direction > 0:
                low = time
            else:
                high = time
            step = missing / motion.velocity if motion.velocity else high - low
            following = time + step
            if not low <= following <= high:
                following = (low + high) / 2
            if abs(following - time) < CLOSE:
                break
            time = following
        return following


def stretches(script: Mapping[str, Any], horizon: Number) -> list[Stretch]:
    """The master from 0 to `horizon` (s), led by one stretch before 0 that holds the initial state.

    Raises ValueError for a segment with a negative duration or with two kinds of motion.
    """
    initial = Motion(*(mp.mpf(script.get(name, 0)) for name in ("position", "velocity", "acceleration")))
    pieces = [Stretch(mp.mpf(-1), mp.mpf(0), mp.mpf(0), initial, mp.mpf(0))]
    begin, motion = mp.mpf(0), initial
    for segment in (*script.get("segments", ()), {"duration": horizon}):
        duration = mp.mpf(segment["duration"])
        start, jerk = _start(segment, motion)
        if duration < 0:
            raise ValueError(f"duration of a master segment is {duration}; it must not be negative")
        whole = Stretch(begin, begin + duration, begin, start, jerk)
        pieces.extend(_monotone(replace(whole, end=min(whole.end, horizon))))
        begin, motion = whole.end, whole.at(whole.end)
    return pieces


def _start(segment: Mapping[str, Any], reached: Motion) -> tuple[Motion, Number]:
    """The state with which a segment starts, and its jerk."""
    kinds = [kind for kind in KINDS if kind in segment]
    if len(kinds) > 1:
        raise ValueError(f"a master segment holds {' and '.join(kinds)}; at most one of {', '.join(KINDS)} is allowed")
    value = mp.mpf(segment[kinds[0]]) if kinds else mp.mpf(0)
    match kinds:
        case ["velocity"]:
            return Motion(reached.position, value, mp.mpf(0)), mp.mpf(0)
        case ["acceleration"]:
            return Motion(reached.position, reached.velocity, value), mp.mpf(0)
        case ["jerk"]:
            return reached, value
        case _:
            return Motion(reached.position, reached.velocity, mp.mpf(0)), mp.mpf(0)


def _monotone(whole: Stretch) -> Iterator[Stretch]:
    """`whole` cut at its turning points; nothing if it has no length."""
    cuts = [time for time in _turning_points(whole) if whole.begin < time < whole.end]
    limits = [whole.begin, *cuts, whole.end]
    for begin, end in pairwise(limits):
        if begin < end:
            travel = whole.at(end).position - whole.at(begin).position
            yield replace(whole, begin=begin, end=end, direction=int(mp.sign(travel)))


def _turning_points(whole: Stretch) -> Sequence[Number]:
    """The times at which the velocity changes its sign: roots of v + a·t + j·t²/2, without cancellation."""
    v, a, j = whole.start.velocity, whole.start.acceleration, whole.jerk
    if j == 0:
        return [whole.origin - v / a] if a != 0 else []
    discriminant = a * a - 2 * j * v
    if discriminant <= 0:
        return []
    q = -(a + (mp.sqrt(discriminant) if a >= 0 else -mp.sqrt(discriminant)))
    return sorted([whole.origin + q / j, whole.origin + 2 * v / q])
