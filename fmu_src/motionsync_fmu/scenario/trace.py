"""A recorded line: positions at times, as an encoder measured them, and straight lines between them.

A counter that wraps makes a jump from one row to the next. No encoder has seen what a straight line between these two
would be, and to a block it would be a fast line; so the line goes on as before until the second one."""

from array import array
from functools import cached_property

import numpy as np

from .recording import Reals
from .script import AxisMotion, Script

START_SPAN = 0.1 * (
    1.0 - 1e-9
)  # s: how long the recording's beginning is from which the velocity at the start is taken
JUMP = 10.0  # times all velocities before it: from row to row no line is so much faster, ...
CALM = 0.1  # ... and then, in the next row, slower than this share of it
FIRST = 30  # of the rows that may be one; before it too little has been seen of the line


class Trace(Script):
    """A line of which only measured positions are known; it starts with the first of them.

    Its breaks are no communication points: the block sees the positions at its own times."""

    is_recorded = True

    def __init__(self, times: Reals, positions: Reals, period: float) -> None:
        """`times`: rising, s; `positions`: u, of the same shape (rows,), at least two; with a period each is in the
        turn that is nearest to the one before."""
        breaks = times - times[0]
        if period:
            steps = np.diff(positions)
            steps -= period * np.rint(steps / period)
            positions = positions[0] + np.concatenate([[0.0], np.cumsum(steps)])
        velocities = _between_jumps(np.diff(positions) / np.diff(breaks))
        self._table = np.zeros((len(breaks), 4))
        self._table[:, 0] = positions
        self._table[:, 1] = np.append(velocities, velocities[-1])
        end = min(int(np.searchsorted(breaks, START_SPAN)), len(breaks) - 1)
        self.initial = AxisMotion(float(positions[0]), float((positions[end] - positions[0]) / breaks[end]), 0.0, 0.0)
        self.breaks = breaks  # a list of Python's floats would take four times the memory
        self.points = [0.0]

    @cached_property
    def motions(self) -> list[AxisMotion]:  # type: ignore[override]
        return [AxisMotion(*row) for row in self._table.tolist()]

    def _after(self, i: int, t: float) -> AxisMotion:
        return AxisMotion(*self._table[i].tolist()).after(t - float(self.breaks[i]))

    def table(self) -> Reals:
        return self._table

    @cached_property
    def series(self) -> "tuple[array[float], array[float]]":
        return array("d", np.asarray(self.breaks).tobytes()), array("d", self._table.tobytes())


def _between_jumps(velocities: Reals) -> Reals:
    """The velocities from row to row, shape (rows - 1,), with that of the row before in place of each jump."""
    speeds = np.abs(velocities)
    sudden = np.append(speeds[1:] <= CALM * speeds[:-1], False)
    fastest = np.maximum.accumulate(np.where(sudden, 0.0, speeds))
    before = np.concatenate([[0.0], fastest[:-1]])
    jumps = np.flatnonzero(sudden & (before > 0.0) & (speeds > JUMP * before))
    jumps = jumps[jumps >= FIRST]
    result = velocities.copy()
    result[jumps] = velocities[jumps - 1]
    return result
