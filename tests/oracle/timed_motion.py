"""Motions of an axis in time: at rest, and on the way to rest at a target, planned by `flying_saw_motion`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from tests.oracle.flying_saw.motion import Phases, move, run
from tests.oracle.master import Motion as Exact
from tests.oracle.numerics import mp

AxisState: TypeAlias = tuple[float, float, float, float]
"""Position, velocity, acceleration and jerk of an axis."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The master at one instant (u, u/s, u/s2)."""

    position: float
    velocity: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class Rest:
    position: float

    def at(self, _time: float, _master: Motion) -> AxisState:
        return self.position, 0.0, 0.0, 0.0


@dataclass(frozen=True, slots=True)
class TimedMotion:
    """A motion in time: phases of (begin, jerk) with the state at their begin; from `end` on at rest at `target`."""

    phases: Sequence[tuple[float, float, Motion]]
    end: float
    target: float

    def at(self, time: float, _master: Motion | None = None) -> AxisState:
        if time >= self.end:
            return self.target, 0.0, 0.0, 0.0
        begin, jerk, s = next(p for p in reversed(self.phases) if p[0] <= time or p is self.phases[0])
        t = time - begin
        velocity, acceleration = s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk
        return s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)), velocity, acceleration, jerk


def plan_move(time: float, state: AxisState, target: float, limits: Sequence[float]) -> TimedMotion:
    """The motion from a state to rest at the target; limits: velocity, acceleration, deceleration, jerk."""
    start = relative_state(state, target)
    velocity, acceleration, deceleration, jerk = (mp.mpf(limit) for limit in limits)
    return timed_motion(time, start, move(start, mp.mpf(0), velocity, acceleration, deceleration, jerk), target)


def relative_state(state: AxisState, origin: float) -> Exact:
    return Exact(mp.mpf(state[0]) - mp.mpf(origin), mp.mpf(state[1]), mp.mpf(state[2]))


def timed_motion(time: float, start: Exact, phases: Phases, target: float) -> TimedMotion:
    """Phases of a motion whose positions count from the target."""
    timed_phases, begin = [], mp.mpf(time)
    for duration, jerk in phases:
        state = Motion(float(start.position + mp.mpf(target)), float(start.velocity), float(start.acceleration))
        timed_phases.append((float(begin), float(jerk), state))
        start, begin = run(start, [(duration, jerk)]), begin + duration
    return TimedMotion(timed_phases, float(begin), target)


def is_at_target(state: AxisState, target: float) -> bool:
    """At rest there."""
    return state[0] == target and state[1] == 0 and state[2] == 0
