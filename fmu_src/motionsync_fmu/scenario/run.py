"""Runs a scenario: through a built FMU, or through the block in this process."""

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from motionsync.master import MasterInput

from ..errors import UserError
from ..interface.stepper import RefusedError, Stepper
from .fmu_instance import FmuError, FmuInstance
from .reactions import Program, scans
from .recording import Reals, Recording
from .scenario import AtTime, Scenario, Within
from .script import Motion, Script

Flags = np.ndarray[Any, np.dtype[np.bool_]]
CLOSE = 1e-9  # of a step: communication points nearer to one another are one


def points(scenario: Scenario, step_size: float) -> Reals:
    """The communication points that are known before the run: a regular grid, and each time of a setting, of an
    expectation, of a script break, and of a scan if the scenario reacts to the block. The array is not to be changed.

    So everything happens at its own time, whatever the step size."""
    extra = [s.at for s in scenario.settings]
    extra += [e.at for e in scenario.expectations if isinstance(e, AtTime)]
    extra += [t for e in scenario.expectations if isinstance(e, Within) for t in (e.begin, e.end)]
    extra += [*scenario.master.breaks[1:], scenario.stop_time]
    scan = scenario.scan if scenario.reacts else math.inf
    # Of points at nearly the same time the script's break is kept: `until` then gives the motion that ends there.
    breaks = None if scenario.drive else tuple(scenario.master.breaks)
    return _points(step_size, scenario.stop_time, scan, tuple(extra), breaks)


@lru_cache(maxsize=8)
def _points(
    step_size: float, stop_time: float, scan: float, extra: tuple[float, ...], breaks: tuple[float, ...] | None
) -> Reals:
    """As `points`, kept for the next one who asks; `extra`: what has its own time; `breaks`: of the script, None: the
    scans."""
    scanned = scans(scan, stop_time)
    named = np.concatenate([extra, scanned])
    named = named[named <= stop_time]
    grid = np.arange(math.floor(stop_time / step_size * (1.0 + 1e-12)) + 1.0) * step_size
    times = np.unique(np.concatenate([grid, named]))
    exact = np.zeros(len(times), bool)
    exact[np.searchsorted(times, named)] = True
    found = times[_kept(times, exact, np.isin(times, scanned if breaks is None else breaks), CLOSE * step_size)]
    found.setflags(write=False)
    return found


def _kept(times: Reals, exact: Flags, breaks: Flags, close: float) -> Flags:
    """Which of the sorted times are kept, where several are close to one another: each exact one takes the place of the
    one before it, unless that is a break."""
    kept = np.ones(len(times), np.bool_)
    begins = np.flatnonzero(np.diff(times, prepend=-math.inf) > close)
    crowd = np.diff(begins, append=len(times))
    pairs = begins[crowd == 2]
    kept[pairs + np.where(exact[pairs + 1] & ~breaks[pairs], 0, 1)] = False
    for first, size in zip(begins[crowd > 2].tolist(), crowd[crowd > 2].tolist(), strict=True):
        last = first
        for i in range(first + 1, first + size):
            if times[i] - times[last] <= close:
                replaced = exact[i] and not breaks[last]
                kept[last if replaced else i] = False
                last = i if replaced else last
            else:
                last = i
    return kept


def inputs(scenario: Scenario, master: Script, t: float, end: float) -> dict[str, float]:
    """The inputs that the scripted axis gives for the step from t to `end`: the telegram of a remote axis, or the
    motion of the `master`, whose position is wrapped if the axis is a rotary one."""
    if scenario.remote:
        return scenario.remote.inputs(t, end)
    mode = scenario.start.get("master.input_mode", MasterInput.START_OF_STEP)
    motion = master.until(end) if mode == MasterInput.END_OF_STEP and end > t else master.at(t)
    return {
        "master.position": motion.position % scenario.period if scenario.period else motion.position,
        "master.velocity": motion.velocity,
        "master.acceleration": motion.acceleration,
    }


Step = tuple[float, float, dict[str, Any]]
"""Begin and end of a step, in s, and the inputs that are set before it: those of the axis, and what changes then."""


def schedule(scenario: Scenario, step_size: float) -> Iterator[Step]:
    """All steps of a scenario that does not react to the block."""
    assert not scenario.reacts, "what a reaction sets, and how a master follows, is known after a run only"
    return _steps(scenario, step_size, Program(scenario))


def _steps(scenario: Scenario, step_size: float, program: Program) -> Iterator[Step]:
    """The steps, one by one. Where a step ends depends on what the program sees at the end of the one before."""
    close = CLOSE * step_size
    known = points(scenario, step_size).tolist()
    t, i = known[0], 1
    while i < len(known):
        changed = program.take(t + close)
        end = min(program.next_look, program.next_setting)
        if end >= known[i] - close:
            end, i = known[i], i + 1
        yield t, end, inputs(scenario, program.master, t, end) | changed
        t = end


class _Recorder:
    """Collects what a run puts out, point by point.

    Attributes:
        names: the outputs and locals that are recorded.
        times: the points so far, in s.
        program: what sets the inputs of the run.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.names = [v.name for v in scenario.recipe.variables.values() if not v.settable]
        self.times: list[float] = []
        self.program = Program(scenario)
        self._rows: list[list[float]] = []
        self._motions: list[Motion] = []

    @property
    def now(self) -> float:
        """The latest point, in s; 0 before the first one."""
        return self.times[-1] if self.times else 0.0

    def add(self, time: float, values: Mapping[str, Any]) -> None:
        self._rows.append([float(values[n]) for n in self.names])
        master = self.program.master
        self._motions.append(master.until(time) if self.times else master.at(time))
        self.times.append(time)

    def recording(self, messages: list[str]) -> Recording:
        return Recording(
            np.array(self.times),
            dict(zip(self.names, np.array(self._rows).T, strict=True)),
            np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in self._motions]),
            messages,
            self.program.settings,
            self.program.unmet,
            self.program.master,
        )


class _Unit(Protocol):
    """What a scenario runs: an FMU, or a block in this process."""

    def initialize(self, values: Mapping[str, Any]) -> object: ...
    def step(self, h: float, values: Mapping[str, Any]) -> object: ...
    def get(self, names: Iterable[str]) -> dict[str, Any]: ...


def _stepped(scenario: Scenario, unit: _Unit, step_size: float, recorder: _Recorder) -> Iterator[float]:
    """Step the unit along the scenario; yields the time of each step before the step is done, in s."""
    program = recorder.program
    unit.initialize({**scenario.start, **inputs(scenario, program.master, 0.0, 0.0)})
    recorder.add(0.0, unit.get(recorder.names))
    program.begin(unit.get(program.names))
    for time, end, values in _steps(scenario, step_size, program):
        yield time
        unit.step(end - time, values)
        recorder.add(end, unit.get(recorder.names))
        if program.next_look <= end + CLOSE * step_size:
            program.look(unit.get(program.names))


def simulate(scenario: Scenario, fmu: Path, step_size: float) -> Recording:
    """Step the FMU along the scenario.

    Raises:
        UserError: the FMU refused a start value or a step; the message has the time and what it logged.
    """
    recorder = _Recorder(scenario)
    with FmuInstance(fmu) as instance:
        try:
            for time in _stepped(scenario, instance, step_size, recorder):
                instance.time = time
        except FmuError as e:
            raise UserError(f"{scenario.file}: at {recorder.now:g} s the FMU refused: {e}") from None
    return recorder.recording(instance.messages)


def run_in_process(scenario: Scenario, step_size: float) -> Recording:
    """Step the scenario's block in this process; the recording is what the block's FMU would put out.

    Raises:
        UserError: the block refused its initialization or a step; the message has the time and the reason.
    """
    recorder = _Recorder(scenario)
    stepper = Stepper(scenario.recipe.block())
    try:
        for _ in _stepped(scenario, stepper, step_size, recorder):
            pass
    except RefusedError as e:
        raise UserError(f"{scenario.file}: at {recorder.now:g} s {e}") from None
    return recorder.recording([])
