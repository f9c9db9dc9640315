"""What an axis asks of its motor, exact: force in N and power in W (torque in N m with an axis in deg or rad).

Where the description may be read in two ways, this is the reading:
- A mass is in kg, so that acceleration and velocity are taken in m or rad, whatever the axis's unit is.
- sign(0) is 0, and sign has no dead band.
- A peak is the greatest magnitude of all rows. The mean of the squares takes each row with half of the steps on both of
  its sides (trapezoids), as does the work, which is the net one: braking gives back.
"""

from collections.abc import Sequence
from itertools import pairwise

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

IN_BASE_UNITS = {"mm": mp.mpf(1) / 1000, "m": mp.mpf(1), "deg": mp.pi / 180, "rad": mp.mpf(1), "1": mp.mpf(1)}


def force(mass: Number, friction: Number, acceleration: Number, velocity: Number, unit: str = "mm") -> Number:
    """The force (N, or N m) at an acceleration and a velocity of the axis, in its `unit`."""
    return mp.mpf(mass) * acceleration * IN_BASE_UNITS[unit] + mp.mpf(friction) * mp.sign(mp.mpf(velocity))


def power(force: Number, velocity: Number, unit: str = "mm") -> Number:
    """In W: positive where the motor drives, negative where it brakes."""
    return mp.mpf(force) * velocity * IN_BASE_UNITS[unit]


def peak(values: Sequence[Number]) -> Number:
    """The greatest magnitude."""
    return max(abs(mp.mpf(value)) for value in values)


def rms(times: Sequence[Number], values: Sequence[Number]) -> Number:
    """The root of the mean of the squares, from the first time to the last."""
    squares = [mp.mpf(value) ** 2 for value in values]
    return mp.sqrt(integral(times, squares) / (mp.mpf(times[-1]) - times[0]))


def integral(times: Sequence[Number], values: Sequence[Number]) -> Number:
    """By trapezoids, from the first time to the last; of the power: the work, in J."""
    rows = zip(map(mp.mpf, times), map(mp.mpf, values), strict=True)
    return mp.mpf(sum((t1 - t0) * (a + b) / 2 for (t0, a), (t1, b) in pairwise(rows)))


def used(value: Number, given: Number) -> Number:
    """The share of what the motor can give."""
    return mp.mpf(value) / given
