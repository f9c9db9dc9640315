"""Any variable of a run over time: recorded, or as the scenario and its reactions have set it; where one is true."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recording import Reals, Recording
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
