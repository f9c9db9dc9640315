"""How the carriage of a cut-to-length machine moves: curves over the master, and motions in time on the way home.

`MasterSection` is a part of the scripted master in floats; its ends are those of `master.stretches`. The way home is
planned by `flying_saw_motion`, with 50 digits.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TypeAlias

from tests.oracle.cut_to_length.limits import Saw
from tests.oracle.flying_saw.limits import AxisData
from tests.oracle.flying_saw.motion import move, run, stop
from tests.oracle.master import Motion as Exact
from tests.oracle.master import Stretch
from tests.oracle.motion_start import attainable_acceleration, begin_of_own_motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.root_search import find_root
from tests.oracle.timed_motion import AxisState, Motion, Rest, TimedMotion, relative_state, timed_motion

NEAR = 1e-6
"""Of a curve's width: so near to one of its ends it is at that end, since rows are taken within 1e-9 s of events."""


@dataclass(frozen=True, slots=True)
class MasterSection:
    """The master from `begin` to `end` (s), on which it moves in one `direction` or is at rest (0)."""

    begin: float
    end: float
    origin: float
    start: Motion
    jerk: float
    direction: int

    @staticmethod
    def of(stretch: Stretch, shift: float) -> "MasterSection":
        """The stretch in floats, moved by `shift`."""
        s = stretch.start
        start = Motion(float(s.position) + shift, float(s.velocity), float(s.acceleration))
        times = (float(stretch.begin), float(stretch.end), float(stretch.origin))
        return MasterSection(*times, start, float(stretch.jerk), stretch.direction)

    def at(self, time: float) -> Motion:
        t, s, jerk = time - self.origin, self.start, self.jerk
        position = s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6))
        return Motion(position, s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk)

    def passes(self, position: float, direction: int, low: float, high: float) -> float | None:
        """When the master that moves in that direction reaches a position in [low, high]; `low` if it is beyond."""
        if self.direction != direction or (self.at(high).position - position) * direction < 0:
            return None
        if (self.at(low).position - position) * direction >= 0:
            return low
        return find_root(lambda time: (self.at(time).position - position) * direction, low, high)


@dataclass(frozen=True, slots=True)
class InSync:
    """In sync with the cut C = `cut_position`, or `ahead` of it."""

    k: float
    cut_position: float
    ahead: float = 0.0

    def at(self, _time: float, master: Motion) -> AxisState:
        s = self.k * (master.position - self.cut_position) + self.ahead
        return s, self.k * master.velocity, self.k * master.acceleration, 0.0


@dataclass(frozen=True, slots=True)
class CurveOverMaster:
    """A curve over the master's travel μ from the position of a cut on: u = (μ - begin)/width from 0 to 1.

    s = base + slope·μ + scale·P(u), with the coefficients of P in rising order; beyond its ends P and its slope stay.
    """

    cut_position: float
    begin: float
    width: float
    base: float
    slope: float
    scale: float
    polynomial: Sequence[float]

    def share(self, master: Motion) -> float:
        """u, which is beyond 0 or 1 where the master is beyond the ends."""
        return (master.position - self.cut_position - self.begin) / self.width

    def at(self, _time: float, master: Motion) -> AxisState:
        """By the chain rule, with the master's jerk as 0."""
        share, v, a, w = self.share(master), master.velocity, master.acceleration, self.width
        u = min(max(share, 0.0), 1.0)
        f = [_value(self.polynomial, u, order) * self.scale / w**order for order in range(4)]
        if abs(share - u) > NEAR:
            f[3] = 0.0  # the slope stays
        slope = f[1] + self.slope
        s = self.base + self.slope * (master.position - self.cut_position) + f[0]
        return s, slope * v, f[2] * v**2 + slope * a, f[3] * v**3 + 3 * f[2] * v * a


def _value(polynomial: Sequence[float], u: float, order: int) -> float:
    """The derivative of that order."""
    result = 0.0
    for power in range(len(polynomial) - 1, order - 1, -1):
        factor = 1.0
        for i in range(order):
            factor *= power - i
        result = result * u + factor * polynomial[power]
    return result


def approach_curve(k: float, cut_position: float, home: float, distance: float) -> CurveOverMaster:
    """From rest at home to sync: kM·(u³ - u⁴/2) over M = 2·distance/k."""
    return CurveOverMaster(
        cut_position,
        (home - distance) / k,
        2 * distance / k,
        home,
        0.0,
        2 * distance,
        (0, 0, 0, 1, -0.5),
    )


def gap_curve(k: float, cut_position: float, begin: float, travel: float, distance: float) -> CurveOverMaster:
    """From sync to `distance` ahead of it, while a carriage in sync would travel `travel`."""
    return CurveOverMaster(cut_position, begin, travel / k, 0.0, k, distance, (0, 0, 0, 10, -15, 6))


MotionLaw: TypeAlias = Rest | InSync | CurveOverMaster | TimedMotion


def plan_eased_return(
    time: float, state: AxisState, target: float, limits: Sequence[float], share: float
) -> TimedMotion:
    """First a halt, then the move from rest with that share of the limits: of velocity; squared; cubed of jerk."""
    start = relative_state(state, target)
    velocity, acceleration, deceleration, jerk = (mp.mpf(limit) for limit in limits)
    halt = stop(start, deceleration, jerk)
    stopped = run(start, halt)
    s = mp.mpf(share)
    rest = Exact(stopped.position, mp.mpf(0), mp.mpf(0))
    home = move(rest, mp.mpf(0), s * velocity, s**2 * acceleration, s**2 * deceleration, s**3 * jerk)
    return timed_motion(time, start, [*halt, *home], target)


def stop_position(state: AxisState, saw: Saw) -> float:
    """Where the time-optimal stop from the state ends, which begins with an acceleration that the axis can have.

    It lets the deceleration rise to its peak, holds it, and lets it fall to 0; an acceleration that is too high, or one
    that would stop the carriage too soon, has the other sign.
    """
    s, v, _, _ = state
    a = attainable_acceleration(v, state[2], *saw.axis[:3])
    deceleration, jerk = saw.turning_acceleration, saw.homing[3]
    remaining = v + a * abs(a) / (2 * jerk)
    side = 1.0 if remaining > 0 else -1.0  # of the velocity that remains to be taken away
    w, rate = side * v, -side * a
    peak, change, constant_time = deceleration, -jerk, (w - rate**2 / (2 * jerk)) / deceleration
    if rate < deceleration:
        peak, change = min(sqrt(max(jerk * w + rate**2 / 2, 0.0)), deceleration), jerk
        constant_time = (w - (2 * peak**2 - rate**2) / (2 * jerk)) / peak if peak > 0 else 0.0
    phases = [((peak - rate) / change, change), (constant_time, 0.0), (peak / jerk, -jerk)]
    travel, speed, slowing = 0.0, w, rate
    for time, growth in phases:
        travel += time * (speed - time * (slowing / 2 + time * growth / 6))
        speed -= time * (slowing + time * growth / 2)
        slowing += time * growth
    return s + side * travel


def begin_of_return(state: AxisState, saw: Saw) -> AxisState:
    """What a way home begins with: the state, as far as the axis could have had it."""
    axis = AxisData(*(mp.mpf(number) for number in (saw.low, saw.high, *saw.axis)))
    exact = Exact(*(mp.mpf(number) for number in state[:3]))
    begin, _ = begin_of_own_motion(exact, axis, mp.mpf(saw.turning_acceleration), mp.mpf(saw.homing[3]))
    return state[0], float(begin.velocity), float(begin.acceleration), state[3]
