"""Checks a run against the expectations of its scenario."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...interface.variables import Variable
from ..computed_columns import needed_outputs
from ..engineering import engineering
from ..recording import Recording, nearest_turn
from ..remote_view import RemoteView
from ..scenario import AtTime, Scenario, When, Within
from ..settings import COMPARISONS, UnmetReaction
from .remote_errors import remote_errors


@dataclass(frozen=True)
class Check:
    """An expectation, and the actual result, in words."""

    expected: str
    actual: str
    passed: bool

    @property
    def text(self) -> str:
        """The expectation and the result in one sentence."""
        return f"{self.expected}: found {self.actual}"


def checked_outputs(scenario: Scenario) -> set[str]:
    """The outputs that the expectations of a scenario check over time; empty if there are none."""
    names = {name for e in scenario.expectations for name in e.names if name in scenario.recipe.variables}
    names |= {*needed_outputs(scenario.servo, scenario.load)}
    if scenario.remote and scenario.remote.accuracy:
        names |= {scenario.remote.names.corrected_index, "slave.position"}
    return names


def check_expectations(scenario: Scenario, recording: Recording) -> list[Check]:
    """The results for every [[expect]] of the scenario; then for the reactions that it requires and that did not
    happen, and for its remote axis."""
    checks: list[Check] = []
    for e in scenario.expectations:
        match e:
            case AtTime():
                checks += _check_values_at_time(e, recording, scenario)
            case When():
                checks.append(
                    _check_first_time(e, recording, scenario.remote.clocks.task_cycle if scenario.remote else 0.0)
                )
            case Within():
                checks += _check_limits(e, recording, scenario)
    checks += check_reactions(recording.unmet)
    if scenario.remote:
        checks += _check_accuracy(scenario.remote, recording, unit_name(Unit.POSITION, scenario.unit))
    return checks


def check_reactions(unmet: Iterable[UnmetReaction]) -> list[Check]:
    """The reactions that the scenario requires and that did not happen."""
    return [Check(u.expected, u.actual, False) for u in unmet if u.reaction.required]


def _check_values_at_time(e: AtTime, recording: Recording, scenario: Scenario) -> Iterator[Check]:
    i = int(np.argmin(np.abs(recording.time - e.at)))
    for name, required in e.values.items():
        value = float(recording.columns[name][i])
        text = scenario.columns[name].text
        named = text(required)
        allowed = f" ± {engineering(e.tolerance)}" if named == f"{required:.10g}" else ""
        actual = named if value == required else text(value)
        off = abs(float(nearest_turn(value, required, scenario.period_of(name))) - required)
        yield Check(f"{name} = {named}{allowed} at {e.at:.10g} s", actual, off <= e.tolerance)


def _check_first_time(e: When, recording: Recording, cycle: float) -> Check:
    """`cycle`: the length of the block's own cycles, in s, or 0.

    An expectation without a tolerance allows one step of the run, or one cycle if that is longer."""
    tolerance = max(float(np.diff(recording.time).max()), cycle) if e.tolerance is None else e.tolerance
    holds = np.asarray(COMPARISONS[e.comparison](recording.columns[e.name], e.value))
    expected = f"first {e.text} at {e.time:.10g} s ± {engineering(tolerance)}"
    if not holds.any():
        return Check(expected, "never", False)
    time = float(recording.time[int(np.argmax(holds))])
    return Check(expected, f"{time:.10g} s", abs(time - e.time) <= tolerance * (1.0 + 1e-9))


def _check_limits(e: Within, recording: Recording, scenario: Scenario) -> Iterator[Check]:
    inside = (recording.time >= e.begin - 1e-9) & (recording.time <= e.end + 1e-9)
    for name, (low, high) in e.limits.items():
        v = scenario.columns[name]
        unit = unit_name(v.declaration.unit, scenario.unit, scenario.slave_unit)
        values = recording.columns[name][inside]
        least, greatest = float(values.min()), float(values.max())
        passed = low - e.tolerance <= least and greatest <= high + e.tolerance
        actual = v.text(least) if least == greatest else f"{v.text(least)} to {v.text(greatest)}"
        expected = f"{name} {_limits_text(v, e.limits[name], e.tolerance, unit)}"
        yield Check(f"{expected}, from {e.begin:.10g} s to {e.end:.10g} s", f"{actual} {unit}".rstrip(), passed)


def _limits_text(v: Variable, limits: tuple[float, float], tolerance: float, unit: str) -> str:
    """What is allowed between two limits: `= false`, `= OFF or HOMING`, `at most 650 mm ± 1e-9 mm`."""
    low, high = limits
    if v.kind == "Boolean" or v.choices:
        allowed = [v.text(value) for value in (v.choices or (0, 1)) if low <= value <= high]
        return f"= {' or '.join(allowed) or 'nothing'}"
    least, greatest = (engineering(limit, digits=10) for limit in limits)
    if low == high:
        text = f"= {least}"
    elif low == -math.inf:
        text = f"at most {greatest}"
    else:
        text = f"at least {least}" if high == math.inf else f"between {least} and {greatest}"
    margin = f" ± {engineering(tolerance, unit)}" if tolerance and v.kind == "Real" else ""
    return f"{text} {unit}".rstrip() + margin


def _check_accuracy(remote: RemoteView, recording: Recording, unit: str) -> Iterator[Check]:
    """`unit`: the name of the unit of positions."""
    allowed = remote.accuracy
    if allowed is None:
        return
    errors = remote_errors(remote, recording)
    inside = errors.time >= allowed.begin - 1e-9
    since = f"from {allowed.begin:.10g} s on"
    if allowed.index is not None:
        width = float(np.ptp(errors.corrected_index[inside]))
        name = remote.names.corrected_index
        expected = f"{name} within {engineering(allowed.index)} cycles of the true index, peak to peak, {since}"
        yield Check(expected, engineering(width, digits=3), width <= allowed.index)
    if allowed.position is not None:
        worst = float(np.abs(errors.corrected_position[inside]).max())
        behind = f", {allowed.behind:g} data cycles behind," if allowed.behind else ""
        expected = f"slave.position within {engineering(allowed.position, unit)} of the true axis{behind} {since}"
        yield Check(expected, f"at most {engineering(worst, unit, digits=3)} away", worst <= allowed.position)
