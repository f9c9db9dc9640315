"""Runs a scenario through a built FMU and judges the result."""

import csv
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from motionsync.master import MasterInput

from ..errors import UserError
from ..interface.stepper import RefusedError, Stepper
from .cuts import CutSpec, find_cuts
from .fmu_instance import FmuError, FmuInstance
from .recording import Recording
from .scenario import COMPARISONS, AtTime, Scenario, When, Within
from .script import Motion
from .telegrams import Accuracy, Errors, errors

CLOSE = 1e-9  # of a step: communication points nearer to one another are one


@dataclass(frozen=True)
class Check:
    """One expectation and what was found."""

    expected: str
    found: str
    passed: bool


@dataclass(frozen=True)
class Deviation:
    """How far a variable was from the reference: the greatest |difference|, when, and what is allowed."""

    name: str
    greatest: float
    at: float
    allowed: float
    points: int

    @property
    def passed(self) -> bool:
        return self.greatest <= self.allowed


def points(scenario: Scenario, step_size: float) -> list[float]:
    """The communication points: a regular grid, and where something is set, expected, or the script breaks.

    Everything in a scenario thus happens when it says, whatever the step size."""
    extra = [s.at for s in scenario.settings]
    extra += [e.at for e in scenario.expectations if isinstance(e, AtTime)]
    extra += [t for e in scenario.expectations if isinstance(e, Within) for t in (e.begin, e.end)]
    extra += [*scenario.master.breaks[1:], scenario.stop_time]
    breaks = set(scenario.master.breaks)  # first among equals: the master is asked for its motion up to there
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
    """The scripted axis' inputs for the step from t to `end`: a remote one's telegram, or the master, wrapped as a
    rotary axis' would be."""
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
    """Each step's beginning and end, and what is set for it; what stays as it is is not repeated but the axis."""
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
    """Step the scenario's block in this process: what its FMU would put out, without one.

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


def check(scenario: Scenario, recording: Recording) -> list[Check]:
    """Every expectation of the scenario, judged; those of its cuts and of its remote axis come last."""
    found: list[Check] = []
    texts = {name: v.text for name, v in scenario.recipe.variables.items()}
    for e in scenario.expectations:
        match e:
            case AtTime():
                found += _at_time(e, recording, texts)
            case When():
                found.append(_when(e, recording, scenario.remote.clocks.task_cycle if scenario.remote else 0.0))
            case Within():
                found += _within(e, recording)
    if scenario.cuts:
        found += _cuts(scenario.cuts, recording)
    if scenario.remote and scenario.remote.accuracy:
        found += _accuracy(scenario.remote.accuracy, errors(scenario.remote, recording))
    return found


def _at_time(e: AtTime, recording: Recording, texts: Mapping[str, Callable[[float], str]]) -> Iterator[Check]:
    i = int(np.argmin(np.abs(recording.time - e.at)))
    for name, wanted in e.values.items():
        value = float(recording.values[name][i])
        text = texts[name]
        allowed = f" ± {e.tolerance:g}" if text(wanted) == f"{wanted:.10g}" else ""
        expected = f"{name} = {text(wanted)}{allowed} at {e.at:g} s"
        yield Check(expected, text(value), abs(value - wanted) <= e.tolerance)


def _when(e: When, recording: Recording, cycle: float) -> Check:
    """Without a tolerance an event is known to a step, that of a cyclic block to a cycle."""
    tolerance = max(float(np.diff(recording.time).max()), cycle) if e.tolerance is None else e.tolerance
    holds = np.asarray(COMPARISONS[e.comparison](recording.values[e.name], e.value))
    expected = f"first {e.text} at {e.time:g} s ± {tolerance:g}"
    if not holds.any():
        return Check(expected, "never", False)
    time = float(recording.time[int(np.argmax(holds))])
    return Check(expected, f"{time:.10g} s", abs(time - e.time) <= tolerance * (1.0 + 1e-9))


def _within(e: Within, recording: Recording) -> Iterator[Check]:
    chosen = (recording.time >= e.begin - 1e-9) & (recording.time <= e.end + 1e-9)
    for name, (low, high) in e.limits.items():
        values = recording.values[name][chosen]
        least, greatest = float(values.min()), float(values.max())
        passed = low - e.tolerance <= least and greatest <= high + e.tolerance
        expected = f"{name} from {low:g} to {high:g} ± {e.tolerance:g} between {e.begin:g} s and {e.end:g} s"
        yield Check(expected, f"{least:.10g} to {greatest:.10g}", passed)


def _cuts(spec: CutSpec, recording: Recording) -> Iterator[Check]:
    found = find_cuts(spec, recording)
    if spec.count is not None:
        yield Check(f"number of cuts = {spec.count}", f"{len(found)}", len(found) == spec.count)
    if spec.tolerance is not None:
        worst = max((abs(c.error) for c in found), default=math.inf)
        expected = f"cuts within {spec.tolerance:g} of a mark, one mark each {spec.length:g}"
        yield Check(expected, f"at most {worst:.3g} away" if found else "no cut", worst <= spec.tolerance)


def _accuracy(allowed: Accuracy, found: Errors) -> Iterator[Check]:
    chosen = found.time >= allowed.begin - 1e-9
    since = f"from {allowed.begin:g} s on"
    if allowed.index is not None:
        width = float(np.ptp(found.corrected_index[chosen]))
        expected = f"corrected_cycle_index within {allowed.index:g} cycles of the true index, peak to peak, {since}"
        yield Check(expected, f"{width:.3g}", width <= allowed.index)
    if allowed.position is not None:
        worst = float(np.abs(found.corrected_position[chosen]).max())
        behind = f", {allowed.behind:g} data cycles behind," if allowed.behind else ""
        expected = f"slave.position within {allowed.position:g} of the true axis{behind} {since}"
        yield Check(expected, f"at most {worst:.3g} away", worst <= allowed.position)


def read_reference(scenario: Scenario) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]], float] | None:
    """Names, rows of shape (points, 1 + names) and relative tolerance of the scenario's reference; None without one.

    Raises:
        UserError: a reference that cannot be read or names an unknown variable.
    """
    file = scenario.file.parent / f"{scenario.recipe.name}_ref.csv"
    options = file.with_suffix(".opt")
    if not file.exists():
        return None
    try:
        with file.open(newline="") as lines:
            header, *rows = list(csv.reader(lines))
        settings = dict(line.split(",") for line in options.read_text().splitlines() if line.strip())
        tolerance = float(settings["RelTol"])
        table = np.array(rows, float)
        if table.shape[1] != len(header):
            raise ValueError("rows of different lengths")
    except (OSError, ValueError, KeyError, IndexError) as e:
        raise UserError(f"{file}: not a reference: {e}") from None
    return header[1:], table, tolerance


def compare(scenario: Scenario, recording: Recording) -> list[Deviation]:
    """The recording against the reference at their common times.

    Two reference rows of one time are the values before and after a jump: anything between them agrees. The tolerance
    is relative to the greatest magnitude of the variable in the reference, at least 1.
    """
    reference = read_reference(scenario)
    if reference is None:
        return []
    names, table, tolerance = reference
    if unknown := [n for n in names if n not in recording.values]:
        raise UserError(f"{scenario.file.parent}: the reference has {unknown[0]!r}, the FMU has not")
    times = np.unique(table[:, 0])
    at = np.searchsorted(recording.time, times - 1e-9)
    common = (at < len(recording.time)) & (
        np.abs(recording.time[np.minimum(at, len(recording.time) - 1)] - times) <= 1e-9
    )
    first = np.searchsorted(table[:, 0], times[common], "left")
    last = np.searchsorted(table[:, 0], times[common], "right") - 1
    found = []
    for column, name in enumerate(names, 1):
        before, after = table[first, column], table[last, column]
        values = recording.values[name][at[common]]
        beyond = np.maximum(np.minimum(before, after) - values, values - np.maximum(before, after))
        away = np.maximum(beyond, 0.0)
        worst = int(np.argmax(away)) if len(away) else 0
        scale = max(1.0, float(np.abs(table[:, column]).max()))
        greatest, time = (float(away[worst]), float(times[common][worst])) if len(away) else (math.inf, 0.0)
        found.append(Deviation(name, greatest, time, tolerance * scale, int(common.sum())))
    return found
