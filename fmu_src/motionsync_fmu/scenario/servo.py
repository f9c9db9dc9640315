"""The servo of a scenario: a position controller with feedforward of the velocity, between the setpoint and the tool.

    s_d(t) = s(t - dead_time)    u = feedforward s_d' + Kv (s_d - x)    Tv v' = u - v    x' = v

It does not act back on the block; therefore the motion is computed after the run, from the recorded setpoint. Since the
equations do not change with time, the response to the setpoint is computed first, and comes later by the dead time.

The setpoint s is a cubic in each step. There x = s + q + z: the cubic s + q fulfils the equation of motion, and the
free motion z takes up what q is at the start of the step. With the roots r1 and r2 of Tv r^2 + r + Kv = 0, which may be
equal or conjugate,

    z' = r1 z + p    p' = r2 p

so that from step to step p and z are two linear recurrences of one number each.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .recording import Reals

KINK = 1e-9  # of a step: a kink of the late setpoint that is nearer to a communication point belongs to that one
ROUNDING = 1e-15  # relative to positions; what is smaller in the curvature of a step is their rounding

EQUAL = 1e-11  # relative; lengths of steps that differ by less are those of equal steps
DECAYED = 1e-20  # of a number: it is not seen beside a later one any more
CHUNK = 8192  # points that are computed at a time: their arrays stay in the cache

Numbers = NDArray[Any]
"""Real numbers, or complex ones where the roots are complex."""

Times = Reals | float
"""A time for each step, or one for all of them."""


@dataclass(frozen=True)
class ActualMotion:
    """Position (u, not wrapped), velocity and acceleration of an axis at communication points, shape (points,) each."""

    position: Reals
    velocity: Reals
    acceleration: Reals


@dataclass(frozen=True)
class Servo:
    """A position controller.

    Attributes:
        position_gain: Kv, in 1/s, 1e-3 to 1e6.
        velocity_time_constant: Tv of the velocity loop, in s; 0: the velocity is u.
        feedforward: the share of the setpoint's velocity that is fed forward.
        dead_time: the setpoint acts so late, in s.
    """

    position_gain: float
    velocity_time_constant: float = 0.0
    feedforward: float = 1.0
    dead_time: float = 0.0

    def follow(self, time: Reals, position: Reals, velocity: Reals) -> ActualMotion:
        """The motion after a setpoint: the cubic through these positions (u, not wrapped) and velocities in each step.

        Before the first time the setpoint rests. Where something jumps at a time, the motion is the one before it.

        time, position, velocity: shape (points,), two points at least; the times rise.
        """
        setpoint = _Setpoint(time, np.diff(time), position, velocity)
        response = _Response.to(self, setpoint)
        x, v, a = (np.full(len(time), value) for value in (position[0], 0.0, 0.0))
        at_rest = np.count_nonzero(time[1:] - self.dead_time - KINK * setpoint.steps <= time[0])
        for first in range(1 + int(at_rest), len(time), CHUNK):
            rows = slice(first, min(first + CHUNK, len(time)))
            steps, at, t = setpoint.find(rows, self.dead_time)
            x[rows], v[rows], a[rows] = response.at(steps, at, t)
        return ActualMotion(x, v, a)

    def steady_offset(self, s: "_Cubics") -> tuple[Reals, Reals, Reals]:
        """The coefficients of q, a parabola in each step: those of s + q fulfil the equation of motion."""
        k, tv, less = self.position_gain, self.velocity_time_constant, self.feedforward - 1.0
        q2 = (3.0 * less / k) * s.c3
        q1 = (2.0 / k) * (less * s.c2 - q2 - (3.0 * tv) * s.c3)
        q0 = (1.0 / k) * (less * s.c1 - q1 - (2.0 * tv) * (s.c2 + q2))
        return q0, q1, q2


@dataclass(frozen=True)
class _Cubics:
    """A cubic of the time since its begin for each step: coefficients of shape (steps,)."""

    c0: Reals
    c1: Reals
    c2: Reals
    c3: Reals

    def at(self, steps: slice, at: Any, t: Times) -> tuple[Reals, Reals, Reals]:
        """Value, first and second derivative, a time t after the begin of the steps with these indices in `steps`."""
        c0, c1, c2, c3 = self.c0[steps][at], self.c1[steps][at], self.c2[steps][at], self.c3[steps][at]
        value = c0 + t * (c1 + t * (c2 + t * c3))
        return value, c1 + t * (2.0 * c2 + t * (3.0 * c3)), 2.0 * c2 + t * (6.0 * c3)


@dataclass(frozen=True)
class _Setpoint:
    """Positions (u) and velocities at both ends of each step; `steps`: the lengths of these, in s."""

    time: Reals
    steps: Reals
    position: Reals
    velocity: Reals

    def cubics(self, steps: slice) -> _Cubics:
        """The cubics of these steps.

        In a very short step the difference of two positions is mostly rounding; the parabola of the velocities is exact
        enough there."""
        ends = slice(steps.start, steps.stop + 1)
        position, velocity = self.position[ends], self.velocity[ends]
        p, v, difference = position[:-1], velocity[:-1], velocity[1:] - velocity[:-1]
        beyond = position[1:] - p - self.steps[steps] * (v + 0.5 * difference)
        beyond[np.abs(beyond) <= ROUNDING * np.abs(p)] = 0.0
        h = _joined(self.steps[steps])
        return _Cubics(p, v, (3.0 / h) * beyond / h + (0.5 / h) * difference, (-2.0 / (h * h * h)) * beyond)

    def find(self, rows: slice, dead_time: float) -> tuple[slice, Any, Times]:
        """Which setpoints act at these communication points: the steps from the first to the last that hold them, the
        index of each among these, and the time since its begin."""
        late = self.time[rows] - dead_time
        just_before = late - KINK * self.steps[rows.start - 1 : rows.stop - 1]
        first, last = (np.searchsorted(self.time, just_before[[0, -1]]) - 1).tolist()
        steps = slice(first, last + 1)
        begins = self.time[steps]
        if len(begins) == len(late):
            t = late - begins
            joined = _joined(t)
            if np.ndim(joined) == 0 and np.ndim(_joined(self.steps[steps])) == 0 and joined > 0.0:
                return steps, slice(None), joined
        at = np.searchsorted(begins, just_before) - 1
        return steps, at, late - begins[at]


@dataclass(frozen=True)
class _Response:
    """The motion s + q + z in each step.

    Attributes:
        steady: the cubics s + q.
        slow, fast: the roots r1 and r2.
        z, p: at the begin of each step, shape (steps,); without a velocity_time_constant p is 0.
    """

    steady: _Cubics
    slow: complex
    fast: complex
    z: Numbers
    p: Numbers

    @classmethod
    def to(cls, servo: Servo, setpoint: _Setpoint) -> "_Response":
        """The motion of an axis that rests before the first step. z takes up what jumps in q from step to step."""
        slow, fast = _roots(servo)
        count = len(setpoint.steps)
        z, p = np.zeros((2, count), complex if isinstance(slow, complex) else float)
        steady = _Cubics(*np.empty((4, count)))
        for first in range(0, count, CHUNK):
            steps = slice(first, min(first + CHUNK + 1, count))
            s = setpoint.cubics(steps)
            q0, q1, q2 = servo.steady_offset(s)
            np.add(s.c0, q0, steady.c0[steps])
            np.add(s.c1, q1, steady.c1[steps])
            np.add(s.c2, q2, steady.c2[steps])
            steady.c3[steps] = s.c3
            if not first:
                z[0] = -q0[0]
                p[0] = -q1[0] - s.c1[0] - slow * z[0] if servo.velocity_time_constant else 0.0
            if len(q0) == 1:
                break
            h = _joined(setpoint.steps[first : steps.stop - 1])
            jumps = q0[:-1] - q0[1:] + h * (q1[:-1] + h * q2[:-1])
            of_z, of_p, of_both = _decays(slow, fast, h)
            if servo.velocity_time_constant:
                p[steps] = _recurrence(of_p, q1[:-1] - q1[1:] + (2.0 * h) * q2[:-1] - slow * jumps, p[first])
                jumps = jumps + of_both * p[steps][:-1]
            z[steps] = _recurrence(of_z, jumps, z[first])
        return cls(steady, slow, fast, z, p)

    def at(self, steps: slice, at: Any, t: Times) -> tuple[Reals, Reals, Reals]:
        """The motion and its two derivatives, a time t after the begin of the steps with these indices in `steps`."""
        of_z, of_p, of_both = _decays(self.slow, self.fast, t)
        p = self.p[steps][at]
        z, p = of_z * self.z[steps][at] + of_both * p, of_p * p
        v = self.slow * z + p
        a = self.slow * v + self.fast * p
        of_steady = self.steady.at(steps, at, t)
        return of_steady[0] + z.real, of_steady[1] + v.real, of_steady[2] + a.real


def _roots(servo: Servo) -> tuple[complex, complex]:
    """The roots of Tv r^2 + r + Kv; where there is only one, it is both."""
    k, tv = servo.position_gain, servo.velocity_time_constant
    if not tv:
        return -k, -k
    square = 1.0 - 4.0 * k * tv
    if square >= 0.0:
        both = 1.0 + math.sqrt(square)
        return -2.0 * k / both, -both / (2.0 * tv)
    root = complex(-1.0, math.sqrt(-square)) / (2.0 * tv)
    return root, root.conjugate()


def _joined(times: Reals) -> Times:
    """One time for all steps if they differ by rounding alone: what is computed with it costs a fraction."""
    least, greatest = float(times.min()), float(times.max())
    return 0.5 * (least + greatest) if greatest - least <= EQUAL * greatest else times


def _decays(slow: complex, fast: complex, t: Times) -> tuple[Any, Any, Any]:
    """exp(r1 t), exp(r2 t), and what p leaves in z after a time t: (exp(r1 t) - exp(r2 t)) / (r1 - r2)."""
    if isinstance(slow, complex):
        decay, angle = np.exp(slow.real * t), slow.imag * t
        sine = np.sin(angle)
        turning = decay * (np.cos(angle) + 1j * sine)
        return turning, turning.conj(), decay * sine / slow.imag
    of_slow, apart = np.exp(slow * t), slow - fast
    return of_slow, np.exp(fast * t), of_slow * (-np.expm1(-apart * t) / apart if apart else t)


def _recurrence(factors: Any, terms: Numbers, start: complex) -> Numbers:
    """The numbers y[0] = start, y[k + 1] = factor[k] y[k] + term[k], one more than there are terms.

    Each round adds what is up to twice as far back, until that has decayed.

    factors: of shape (terms,), or one for all."""
    y = np.concatenate([[start], terms])
    are_equal = np.ndim(factors) == 0
    if are_equal:
        factors = factors.item()  # with a number of Python it is quicker
    distance = 1
    while distance < len(y) and (abs(factors) if are_equal else np.abs(factors).max()) > DECAYED:
        y[distance:] += factors * y[:-distance]
        factors = factors * factors if are_equal else factors[distance:] * factors[:-distance]
        distance *= 2
    return y
