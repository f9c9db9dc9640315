"""How the carriage of a cut-to-length machine moves: curves over the master, and its own way home in time.

`Course` is the scripted master in floats; its breaks are those of `master.stretches`. The way home is planned by
`flying_saw_motion`, in mpmath.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TypeAlias

from tests.oracle.cut_to_length_limits import root
from tests.oracle.flying_saw_motion import Phases, move, run, stop
from tests.oracle.master import Motion as Exact
from tests.oracle.master import Stretch, mp

State: TypeAlias = tuple[float, float, float, float]
"""Position, velocity, acceleration and jerk of the carriage."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The master at one instant (u, u/s, u/s2)."""

    position: float
    velocity: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class Course:
    """The master from `begin` to `end` (s), on which it moves in one `direction` or stands (0)."""

    begin: float
    end: float
    origin: float
    start: Motion
    jerk: float
    direction: int

    @staticmethod
    def of(stretch: Stretch, shift: float) -> "Course":
        """The stretch in floats, moved by `shift`."""
        s = stretch.start
        start = Motion(float(s.position) + shift, float(s.velocity), float(s.acceleration))
        times = (float(stretch.begin), float(stretch.end), float(stretch.origin))
        return Course(*times, start, float(stretch.jerk), stretch.direction)

    def at(self, time: float) -> Motion:
        t, s, jerk = time - self.origin, self.start, self.jerk
        position = s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6))
        return Motion(position, s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk)

    def passes(self, position: float, direction: int, low: float, high: float) -> float | None:
        """When the master that moves in that direction comes to a position in [low, high]; `low` if it is beyond."""
        if self.direction != direction or (self.at(high).position - position) * direction < 0:
            return None
        if (self.at(low).position - position) * direction >= 0:
            return low
        return root(lambda time: (self.at(time).position - position) * direction, low, high)


@dataclass(frozen=True, slots=True)
class Rest:
    position: float

    def at(self, _time: float, _master: Motion) -> State:
        return self.position, 0.0, 0.0, 0.0


@dataclass(frozen=True, slots=True)
class OnLine:
    """On the line of the cut C = `line`, or `ahead` of it."""

    k: float
    line: float
    ahead: float = 0.0

    def at(self, _time: float, master: Motion) -> State:
        s = self.k * (master.position - self.line) + self.ahead
        return s, self.k * master.velocity, self.k * master.acceleration, 0.0


@dataclass(frozen=True, slots=True)
class Over:
    """A curve over the master's way μ behind the line of a cut: u = (μ - begin)/width from 0 to 1.

    s = base + slope·μ + scale·P(u), with the coefficients of P in rising order; beyond its ends it goes on as at them.
    """

    line: float
    begin: float
    width: float
    base: float
    slope: float
    scale: float
    polynomial: Sequence[float]

    def share(self, master: Motion) -> float:
        """u, within 0 and 1."""
        return min(max((master.position - self.line - self.begin) / self.width, 0.0), 1.0)

    def at(self, _time: float, master: Motion) -> State:
        """By the chain rule, with the master's jerk as 0."""
        u, v, a, w = self.share(master), master.velocity, master.acceleration, self.width
        f = [_value(self.polynomial, u, order) * self.scale / w**order for order in range(4)]
        first = f[1] + self.slope
        s = self.base + self.slope * (master.position - self.line) + f[0]
        return s, first * v, f[2] * v**2 + first * a, f[3] * v**3 + 3 * f[2] * v * a


def _value(polynomial: Sequence[float], u: float, order: int) -> float:
    """The derivative of that order."""
    result = 0.0
    for power in range(len(polynomial) - 1, order - 1, -1):
        factor = 1.0
        for i in range(order):
            factor *= power - i
        result = result * u + factor * polynomial[power]
    return result


def approach(k: float, line: float, home: float, way: float) -> Over:
    """From rest at home to sync on the line: kM·(u³ - u⁴/2) over M = 2·way/k."""
    return Over(line, (home - way) / k, 2 * way / k, home, 0.0, 2 * way, (0, 0, 0, 1, -0.5))


def gap(k: float, line: float, begin: float, travel: float, distance: float) -> Over:
    """From the line ahead of it by `distance` while the carriage on the line would travel `travel`."""
    return Over(line, begin, travel / k, 0.0, k, distance, (0, 0, 0, 10, -15, 6))


@dataclass(frozen=True, slots=True)
class Own:
    """A motion in time: phases of (begin, jerk) with the state at their begin; from `end` on at rest at `target`."""

    phases: Sequence[tuple[float, float, Motion]]
    end: float
    target: float

    def at(self, time: float, _master: Motion) -> State:
        if time >= self.end:
            return self.target, 0.0, 0.0, 0.0
        begin, jerk, s = next(p for p in reversed(self.phases) if p[0] <= time or p is self.phases[0])
        t = time - begin
        velocity, acceleration = s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk
        return s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)), velocity, acceleration, jerk


Law: TypeAlias = Rest | OnLine | Over | Own


def own(time: float, state: State, target: float, limits: Sequence[float]) -> Own:
    """The way from a state to rest at the target; limits: velocity, acceleration, deceleration, jerk."""
    start = _exact(state, target)
    velocity, acceleration, deceleration, jerk = (mp.mpf(limit) for limit in limits)
    return _laid(time, start, move(start, mp.mpf(0), velocity, acceleration, deceleration, jerk), target)


def eased(time: float, state: State, target: float, limits: Sequence[float], share: float) -> Own:
    """First a halt, then the move from rest with that share of the limits: of velocity; squared; cubed of jerk."""
    start = _exact(state, target)
    velocity, acceleration, deceleration, jerk = (mp.mpf(limit) for limit in limits)
    halt = stop(start, deceleration, jerk)
    standing = run(start, halt)
    s = mp.mpf(share)
    rest = Exact(standing.position, mp.mpf(0), mp.mpf(0))
    home = move(rest, mp.mpf(0), s * velocity, s**2 * acceleration, s**2 * deceleration, s**3 * jerk)
    return _laid(time, start, [*halt, *home], target)


def stopping_place(state: State, deceleration: float, jerk: float) -> float:
    """Where the time-optimal stop from the state ends.

    It lets the deceleration rise to its peak, holds it, and lets it fall to 0; an acceleration that is too high, or one
    that would stop the carriage too soon, has the other sign.
    """
    s, v, a, _ = state
    left = v + a * abs(a) / (2 * jerk)
    side = 1.0 if left > 0 else -1.0  # of the velocity that is left to be taken away
    w, rate = side * v, -side * a
    peak, change, held = deceleration, -jerk, (w - rate**2 / (2 * jerk)) / deceleration
    if rate < deceleration:
        peak, change = min(sqrt(max(jerk * w + rate**2 / 2, 0.0)), deceleration), jerk
        held = (w - (2 * peak**2 - rate**2) / (2 * jerk)) / peak if peak > 0 else 0.0
    phases = [((peak - rate) / change, change), (held, 0.0), (peak / jerk, -jerk)]
    travel, speed, slowing = 0.0, w, rate
    for time, growth in phases:
        travel += time * (speed - time * (slowing / 2 + time * growth / 6))
        speed -= time * (slowing + time * growth / 2)
        slowing += time * growth
    return s + side * travel


def _exact(state: State, origin: float) -> Exact:
    return Exact(mp.mpf(state[0]) - mp.mpf(origin), mp.mpf(state[1]), mp.mpf(state[2]))


def _laid(time: float, start: Exact, phases: Phases, target: float) -> Own:
    """Phases of a motion whose positions count from the target."""
    laid, begin = [], mp.mpf(time)
    for duration, jerk in phases:
        state = Motion(float(start.position + mp.mpf(target)), float(start.velocity), float(start.acceleration))
        laid.append((float(begin), float(jerk), state))
        start, begin = run(start, [(duration, jerk)]), begin + duration
    return Own(laid, float(begin), target)


def at_target(state: State, target: float) -> bool:
    """At rest there."""
    return state[0] == target and state[1] == 0 and state[2] == 0
