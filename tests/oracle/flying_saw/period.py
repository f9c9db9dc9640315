"""Positions of a flying saw's master that turns in a period; a period of 0 is none."""

from dataclasses import replace

from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.master import Motion, Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


def wrap(position: Number, period: Number) -> Number:
    """The position within the period."""
    result = position - mp.floor(position / period) * period
    return ZERO if float(result) >= float(period) else result


def wrap_start(stretches: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return stretches
    shift = mp.floor(stretches[0].start.position / period) * period
    return [replace(s, start=replace(s.start, position=s.start.position - shift)) for s in stretches]


def next_occurrence(position: Number, master: Motion, period: Number) -> Number:
    """A position within the period means its next occurrence ahead of the master."""
    direction = mp.sign(master.velocity)
    if not (0 <= position < period) or direction == 0:
        return position
    turns = mp.floor((master.position - position) * direction / period) + 1
    return position + direction * turns * period
