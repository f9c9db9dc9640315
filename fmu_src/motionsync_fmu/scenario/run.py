"""Runs a scenario: through a built FMU, or through the block in this process."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from motionsync.master import MasterInput

from ..errors import UserError
from ..interface.stepper import RefusedError, Stepper
from .fmu_instance import FmuError, FmuInstance
from .recording import Recording
from .scenario import AtTime, Scenario, Within
from .script import Motion

CLOSE = 1e-9  # of a step: communication points nearer to one another are one


def points(scenario: Scenario, step_size: float) -> list[float]:
    """The communication points: a regular grid, and each time of a setting, an expectation or a script break.

    So everything happens at its own time, whatever the step size."""
    extra = [s.at for s in scenario.settings]
    extra += [e.at for e in scenario.expectations if isinstance(e, AtTime)]
    extra += [t for e in scenario.expectations if isinstance(e, Within) for t in (e.begin, e.end)]
    extra += [*scenario.master.breaks[1:], scenario.stop_time]
    # Of points at nearly the same time the script's break is kept: `until` then gives the motion that ends there.
    breaks = set(scenario.master.breaks)
    grid = [i * step_size for i in range(math.floor(scenario.stop_time / step_size * (1.0 + 1e-12)) + 1)]
    kept: list[float] = []
    exact = set(extra)
    for t in sorted([*grid, *(t for t in extra if t <= scenario.stop_time)]):
        if kept and t - kept[-1] <= CLOSE * step_size:
            kept[-1] = t if t in exact and kept[-1] not in breaks else kept[-1]
        else:
            kept.append(t)
    return kept


def inputs(scenario: Scenario, t: float, end: float) -> dict[str, float]:
    """The inputs that the scripted axis gives for the step from t to `end`: the telegram of a remote axis, or the
    motion of the master, whose position is wrapped if the axis is a rotary one."""
    if scenario.remote:
        return scenario.remote.inputs(t, end)
    mode = scenario.start.get("master.input_mode", MasterInput.START_OF_STEP)
    motion = scenario.master.until(end) if mode == MasterInput.END_OF_STEP and end > t else scenario.master.at(t)
    return {
        "master.position": motion.position % scenario.period if scenario.period else motion.position,
        "master.velocity": motion.velocity,
        "master.acceleration": motion.acceleration,
    }


def schedule(scenario: Scenario, step_size: float) -> Iterator[tuple[float, float, dict[str, Any]]]:
    """The begin and end of each step, and the inputs that are set before it: those of the axis, and the scenario's
    settings that change at this step."""
    waiting = sorted(scenario.settings, key=lambda s: s.at)
    grid = points(scenario, step_size)
    for t, end in pairwise(grid):
        values: dict[str, Any] = dict(inputs(scenario, t, end))
        while waiting and waiting[0].at <= t + CLOSE * step_size:
            values |= waiting.pop(0).values
        yield t, end, values


class _Recorder:
    """Collects what a run puts out, point by point.

    Attributes:
        names: the outputs and locals that are recorded.
        times: the points so far, in s.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.names = [v.name for v in scenario.recipe.variables.values() if not v.settable]
        self.times: list[float] = []
        self._master = scenario.master
        self._rows: list[list[float]] = []
        self._motions: list[Motion] = []

    def add(self, time: float, values: Mapping[str, Any]) -> None:
        self._rows.append([float(values[n]) for n in self.names])
        self._motions.append(self._master.until(time) if self.times else self._master.at(time))
        self.times.append(time)

    def recording(self, messages: list[str]) -> Recording:
        return Recording(
            np.array(self.times),
            dict(zip(self.names, np.array(self._rows).T, strict=True)),
            np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in self._motions]),
            messages,
        )


def simulate(scenario: Scenario, fmu: Path, step_size: float) -> Recording:
    """Step the FMU along the scenario.

    Raises:
        UserError: the FMU refused a start value or a step; the message has the time and what it logged.
    """
    recorder = _Recorder(scenario)
    time = 0.0
    with FmuInstance(fmu) as instance:
        try:
            instance.initialize({**scenario.start, **inputs(scenario, 0.0, 0.0)})
            recorder.add(time, instance.get(recorder.names))
            for time, end, values in schedule(scenario, step_size):
                instance.time = time
                instance.step(end - time, values)
                recorder.add(end, instance.get(recorder.names))
        except FmuError as e:
            raise UserError(f"{scenario.file}: at {time:g} s the FMU refused: {e}") from None
    return recorder.recording(instance.messages)


def run_in_process(scenario: Scenario, step_size: float) -> Recording:
    """Step the scenario's block in this process; the recording is what the block's FMU would put out.

    Raises:
        UserError: the block refused its initialization or a step; the message has the time and the reason.
    """
    recorder = _Recorder(scenario)
    stepper = Stepper(scenario.recipe.block())
    time = 0.0
    try:
        stepper.initialize({**scenario.start, **inputs(scenario, 0.0, 0.0)})
        recorder.add(time, stepper.get(recorder.names))
        for time, end, values in schedule(scenario, step_size):
            stepper.step(end - time, values)
            recorder.add(end, stepper.get(recorder.names))
    except RefusedError as e:
        raise UserError(f"{scenario.file}: at {time:g} s {e}") from None
    return recorder.recording([])
