"""Runs a scenario: through a built FMU, or through the block in this process. The package `runner` says what the block
is given; here it is given to the model, whose outputs are recorded."""

from array import array
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ...errors import UserError
from ...interface.stepper import RefusedError, Stepper
from ..recording import Recording
from ..scenario import Scenario
from .fmu_instance import FmuError, FmuInstance
from .tables import RunTables

Step = tuple[float, float, dict[str, Any]]
"""Begin and end of a step, in s, and the inputs that are set before it: those of the axis, and those that change."""


def start_inputs(scenario: Scenario) -> dict[str, float]:
    """The inputs of the axis at time 0, when the block is initialized."""
    tables = RunTables(scenario, scenario.step_size)
    tables.run.start()
    return tables.axis_inputs


def scheduled_steps(scenario: Scenario, step_size: float) -> Iterator[Step]:
    """All steps of a scenario that does not react to the block."""
    assert not scenario.reacts, "only a run determines reactions, and the motion of a master that follows"
    tables = RunTables(scenario, step_size)
    tables.run.start()
    tables.run.begin()
    while step := _try_step(tables):
        yield step
        tables.run.finish()


def _try_step(tables: RunTables) -> Step | None:
    """Prepare the next step; None: the run is at its end."""
    begin, taken = tables.run.end, tables.run.program.taken
    if not tables.run.try_prepare():
        return None
    return begin, tables.run.end, tables.axis_inputs | tables.set_since(taken)


class _Model(Protocol):
    """An FMU, or a block in this process."""

    def initialize(self, values: Mapping[str, Any]) -> object: ...
    def step(self, h: float, values: Mapping[str, Any]) -> object: ...
    def get(self, names: Iterable[str]) -> dict[str, Any]: ...
    def values(self, names: tuple[str, ...]) -> Iterable[Any]: ...


class _RecordedRun:
    """A run whose outputs and locals are recorded, point by point.

    Attributes:
        tables: of the run; `tables.run.now` is the latest point, in s.
    """

    def __init__(self, scenario: Scenario, step_size: float, model: _Model) -> None:
        self.tables, self._scenario, self._model = RunTables(scenario, step_size), scenario, model
        self._names = tuple(v.name for v in scenario.recipe.variables.values() if not v.settable)
        self._times = array("d")
        self._values = array("d")  # of each point in turn; a list of numbers would need four times the memory
        self._motions = array("d")  # position, velocity, acceleration, jerk of each point

    def steps(self) -> Iterator[float]:
        """Run the model along the scenario; yields the begin of each step, in s, before the step is made."""
        run, model = self.tables.run, self._model
        run.start()
        model.initialize({**self._scenario.start, **self.tables.axis_inputs})
        self._see()
        run.begin()
        self._record()
        while step := _try_step(self.tables):
            begin, end, values = step
            yield begin
            model.step(end - begin, values)
            run.finish()
            self._record()
            if run.samples:
                self._see()
                run.sample()

    def _see(self) -> None:
        """Let the program see the outputs."""
        seen = self._model.get(self.tables.sees)
        for i, name in enumerate(self.tables.sees):
            self.tables.run.program.outputs[i] = float(seen[name])

    def _record(self) -> None:
        axis = self.tables.run.axis
        self._times.append(self.tables.run.now)
        self._values.extend(self._model.values(self._names))
        self._motions.extend((axis.position, axis.velocity, axis.acceleration, axis.jerk))

    def recording(self, messages: list[str]) -> Recording:
        time = np.frombuffer(self._times)
        values = dict(zip(self._names, np.frombuffer(self._values).reshape(len(time), -1).T, strict=True))
        return self.tables.recording(time, values, np.frombuffer(self._motions).reshape(-1, 4), messages)


def simulate(scenario: Scenario, fmu: Path, step_size: float) -> Recording:
    """Run a scenario through its FMU.

    Raises:
        UserError: the FMU refused a start value or a step; the message has the time and what it logged.
    """
    with FmuInstance(fmu) as instance:
        run = _RecordedRun(scenario, step_size, instance)
        try:
            for time in run.steps():
                instance.time = time
            instance.terminate()
        except FmuError as error:
            raise UserError(f"{scenario.file}: at {run.tables.run.now:g} s the FMU refused: {error}") from None
    return run.recording(instance.timed_messages)


def run_in_process(scenario: Scenario, step_size: float) -> Recording:
    """Run a scenario through its block in this process; the recording is that of the block's FMU.

    Raises:
        UserError: the block refused its initialization or a step; the message has the time and the reason.
    """
    run = _RecordedRun(scenario, step_size, Stepper(scenario.recipe.block()))
    try:
        for _ in run.steps():
            pass
    except RefusedError as error:
        raise UserError(f"{scenario.file}: at {run.tables.run.now:g} s {error}") from None
    return run.recording([])
