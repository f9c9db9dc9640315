"""Any variable of a run over time: recorded, or as the scenario and its reactions have set it."""

import numpy as np

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


def value_at(scenario: Scenario, recording: Recording, name: str, point: int) -> float:
    """The value of a variable at one of the communication points, as `time_series` has it."""
    if name in recording.values:
        return float(recording.values[name][point])
    value = scenario.start.get(name, scenario.recipe.variables[name].start)
    for setting in recording.settings or scenario.settings:
        if name in setting.values and recording.time[point] > setting.at + CLOSE:
            value = setting.values[name]
    return float(value)
