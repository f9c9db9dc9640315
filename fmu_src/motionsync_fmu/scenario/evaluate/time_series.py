"""Any variable of a run over time: recorded, or as the scenario and its reactions have set it; where one is true; and
positions that turn in such stretches."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recording import Reals, Recording, unwrapped
from ..scenario import Scenario

CLOSE = 1e-9  # s


def time_series(scenario: Scenario, recording: Recording, name: str) -> Reals:
    """A variable at the communication points, shape (points,).

    A value that is set at a time is that of all later points."""
    if name in recording.values:
        return recording.values[name]
    start = scenario.recipe.variables[name].start
    values = np.full(len(recording.time), float(scenario.start.get(name, start)))
    for setting in recording.settings or scenario.settings:
        if name in setting.values:
            values[recording.time > setting.at + CLOSE] = float(setting.values[name])
    return values


def true_stretches(values: NDArray[Any]) -> list[tuple[int, int]]:
    """The stretches in which the values are true: of each its first index, and the one after its last."""
    borders = np.flatnonzero(np.diff(values.astype(bool), prepend=False, append=False)).tolist()
    return list(zip(borders[::2], borders[1::2], strict=True))


def slave_positions(scenario: Scenario, recording: Recording) -> Reals:
    """The positions of the slave without turns, shape (points,)."""
    position, period = recording.values["slave.position"], scenario.slave_period
    return unwrapped(recording.time, position, recording.values["slave.velocity"], period) if period else position


def in_nearest_turn(positions: Reals, begins: NDArray[Any], period: float) -> Reals:
    """Positions of several stretches, each shifted by whole turns, so that its mean is as near to 0 as possible.

    positions: of all stretches, one after the other and each without turns, of shape (points,).
    begins: the index of each stretch's first point.
    period: that of the positions; 0: they remain as they are.
    """
    if not period:
        return positions
    counts = np.diff(begins, append=len(positions))
    turns = np.rint(np.add.reduceat(positions, begins) / counts / period)
    return np.asarray(positions - period * np.repeat(turns, counts))
