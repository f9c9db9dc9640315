"""Runs a scenario: through a built FMU, or through the block in this process."""

import math
from array import array
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from motionsync.master import MasterInput

from ...errors import UserError
from ...interface.roles import MOTION
from ...interface.stepper import RefusedError, Stepper
from ..computed_columns import compute_columns
from ..recording import Reals, Recording
from ..scenario import AtTime, Scenario, Within
from ..script import Script
from .fmu_instance import FmuError, FmuInstance
from .reactions import ReactionProgram, scan_times

Flags = np.ndarray[Any, np.dtype[np.bool_]]
MASTER_INPUTS = tuple(f"master.{name}" for name in MOTION)
CLOSE = 1e-9  # of a step: communication points nearer to one another are one


def communication_points(scenario: Scenario, step_size: float) -> Reals:
    """The communication points that a run has in any case: a regular grid, and the times of settings, of expectations,
    of breaks in the script, and of scans if the scenario reacts to the block. The array cannot be changed.

    So everything happens at its own time at every step size."""
    extra = [s.at for s in scenario.settings]
    extra += [e.at for e in scenario.expectations if isinstance(e, AtTime)]
    extra += [t for e in scenario.expectations if isinstance(e, Within) for t in (e.begin, e.end)]
    extra += [*scenario.master.points[1:], scenario.stop_time]
    scan = scenario.scan if scenario.reacts else math.inf
    # Of points at nearly the same time the script's break remains: `until` then gives the motion that ends there.
    breaks = None if scenario.drive else tuple(scenario.master.points)
    return _merge_points(step_size, scenario.stop_time, scan, tuple(extra), breaks)


@lru_cache(maxsize=8)
def _merge_points(
    step_size: float, stop_time: float, scan: float, extra: tuple[float, ...], breaks: tuple[float, ...] | None
) -> Reals:
    """The grid of a step size with the scans and the `extra` times; `breaks`: those of the script, None: the scans."""
    scanned = scan_times(scan, stop_time)
    events = np.concatenate([extra, scanned])
    events = events[events <= stop_time]
    grid = np.arange(math.floor(stop_time / step_size * (1.0 + 1e-12)) + 1.0) * step_size
    times = np.unique(np.concatenate([grid, events]))
    is_event = np.zeros(len(times), bool)
    is_event[np.searchsorted(times, events)] = True
    is_break = np.isin(times, scanned if breaks is None else breaks)
    points = times[_select_points(times, is_event, is_break, CLOSE * step_size)]
    points.setflags(write=False)
    return points


def _select_points(times: Reals, is_event: Flags, is_break: Flags, close: float) -> Flags:
    """Which of the sorted times remain where several are close to one another: an event replaces the time before it
    unless that is a break."""
    remains = np.ones(len(times), np.bool_)
    starts = np.flatnonzero(np.diff(times, prepend=-math.inf) > close)
    sizes = np.diff(starts, append=len(times))
    pairs = starts[sizes == 2]
    remains[pairs + np.where(is_event[pairs + 1] & ~is_break[pairs], 0, 1)] = False
    for first, size in zip(starts[sizes > 2].tolist(), sizes[sizes > 2].tolist(), strict=True):
        last = first
        for i in range(first + 1, first + size):
            if times[i] - times[last] <= close:
                replaces = is_event[i] and not is_break[last]
                remains[last if replaces else i] = False
                last = i if replaces else last
            else:
                last = i
    return remains


def start_inputs(scenario: Scenario) -> dict[str, float]:
    """The inputs of the axis at time 0, when the block is initialized."""
    return _axis_inputs(scenario, scenario.step_size, scenario.master, 0.0, 0.0)


def _axis_inputs(scenario: Scenario, step_size: float, master: Script, t: float, end: float) -> dict[str, float]:
    """The inputs that the scripted axis gives for the step from t to `end`: the telegram of a remote axis, what the
    encoder measures of the `master`, or the motion of the `master`, whose position is wrapped if the axis is a rotary
    one. `step_size`: that of the run."""
    if scenario.remote:
        return scenario.remote.inputs(t, end)
    mode = scenario.start.get("master.input_mode", MasterInput.START_OF_STEP)
    is_ahead = mode == MasterInput.END_OF_STEP and end > t
    if scenario.encoder:
        motion = scenario.encoder.inputs(master, end if is_ahead else t, step_size, scenario.period)
        return dict(zip(MASTER_INPUTS, motion, strict=True))
    m = master.until(end) if is_ahead else master.at(t)
    position = m.position % scenario.period if scenario.period else m.position
    return dict(zip(MASTER_INPUTS, (position, m.velocity, m.acceleration), strict=True))


Step = tuple[float, float, dict[str, Any]]
"""Begin and end of a step, in s, and the inputs that are set before it: those of the axis, and those that change."""


def scheduled_steps(scenario: Scenario, step_size: float) -> Iterator[Step]:
    """All steps of a scenario that does not react to the block."""
    assert not scenario.reacts, "only a run determines reactions, and the motion of a master that follows"
    return _plan_steps(scenario, step_size, ReactionProgram(scenario))


def _plan_steps(scenario: Scenario, step_size: float, program: ReactionProgram) -> Iterator[Step]:
    """The steps one by one: the end of a step may depend on the outputs at its begin."""
    close = CLOSE * step_size
    points = array("d", communication_points(scenario, step_size).tobytes())
    t, i = points[0], 1
    while i < len(points):
        changed = program.take_settings(t + close)
        end = min(program.next_sample_time, program.next_setting_time)
        if end >= points[i] - close:
            end, i = points[i], i + 1
        yield t, end, _axis_inputs(scenario, step_size, program.master, t, end) | changed
        t = end


class _Recorder:
    """Records the outputs of a run, point by point.

    Attributes:
        names: the outputs and locals that are recorded.
        times: the points so far, in s.
        program: that of the inputs of the run.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self.names = tuple(v.name for v in scenario.recipe.variables.values() if not v.settable)
        self.times = array("d")
        self.program = ReactionProgram(scenario)
        self._values = array("d")  # of each point in turn; a list of numbers would need four times the memory
        self._motions = array("d")  # position, velocity, acceleration, jerk of each point

    @property
    def current_time(self) -> float:
        """The latest point, in s; 0 before the first one."""
        return self.times[-1] if self.times else 0.0

    def add(self, time: float, values: Iterable[Any]) -> None:
        self._values.extend(values)
        master = self.program.master
        m = master.until(time) if self.times else master.at(time)
        self._motions.extend(m)
        self.times.append(time)

    def recording(self, messages: list[str]) -> Recording:
        time, scenario = np.frombuffer(self.times), self._scenario
        values = dict(zip(self.names, np.frombuffer(self._values).reshape(len(time), -1).T, strict=True))
        return Recording(
            time,
            values,
            np.frombuffer(self._motions).reshape(-1, 4),
            messages,
            self.program.settings,
            self.program.unmet,
            self.program.master,
            compute_columns(scenario.servo, scenario.load, scenario.slave_period, time, values),
        )


class _Model(Protocol):
    """An FMU, or a block in this process."""

    def initialize(self, values: Mapping[str, Any]) -> object: ...
    def step(self, h: float, values: Mapping[str, Any]) -> object: ...
    def get(self, names: Iterable[str]) -> dict[str, Any]: ...
    def values(self, names: tuple[str, ...]) -> Iterable[Any]: ...


def _run_steps(scenario: Scenario, model: _Model, step_size: float, recorder: _Recorder) -> Iterator[float]:
    """Run the model along the scenario; yields the begin of each step, in s, before the step is made."""
    program = recorder.program
    model.initialize({**scenario.start, **start_inputs(scenario)})
    recorder.add(0.0, model.values(recorder.names))
    program.sample_start(model.get(program.names))
    for time, end, values in _plan_steps(scenario, step_size, program):
        yield time
        model.step(end - time, values)
        recorder.add(end, model.values(recorder.names))
        if program.next_sample_time <= end + CLOSE * step_size:
            program.sample(model.get(program.names))


def simulate(scenario: Scenario, fmu: Path, step_size: float) -> Recording:
    """Run a scenario through its FMU.

    Raises:
        UserError: the FMU refused a start value or a step; the message has the time and what it logged.
    """
    recorder = _Recorder(scenario)
    with FmuInstance(fmu) as instance:
        try:
            for time in _run_steps(scenario, instance, step_size, recorder):
                instance.time = time
            instance.terminate()
        except FmuError as error:
            raise UserError(f"{scenario.file}: at {recorder.current_time:g} s the FMU refused: {error}") from None
    return recorder.recording(instance.timed_messages)


def run_in_process(scenario: Scenario, step_size: float) -> Recording:
    """Run a scenario through its block in this process; the recording is that of the block's FMU.

    Raises:
        UserError: the block refused its initialization or a step; the message has the time and the reason.
    """
    recorder = _Recorder(scenario)
    stepper = Stepper(scenario.recipe.block())
    try:
        for _ in _run_steps(scenario, stepper, step_size, recorder):
            pass
    except RefusedError as error:
        raise UserError(f"{scenario.file}: at {recorder.current_time:g} s {error}") from None
    return recorder.recording([])
