"""Evaluates the runs of a sweep: the results in a row, in addition to its number, its values and its measures.

A run is evaluated as `motionsync run` does, without the scenario's reference, which belongs to the
scenario as it is there. Only what needs the whole course is recorded; the rest comes from measures, which the compiled
loop computes step by step."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from motionsync.var import Role

from ..batch.scripted_runs import ScriptedRun
from ..interface.roles import find_by_role
from ..scenario.evaluate.axis_figures import find_following_error, find_load_figures
from ..scenario.evaluate.cutting_results import CuttingResults
from ..scenario.evaluate.expectations import Check, check_reactions
from ..scenario.evaluate.key_figures import SLAVE_OUTPUTS, find_peaks
from ..scenario.evaluate.reference_comparison import Deviation
from ..scenario.evaluate.verdict import Event, check_alarms, find_checks, gather, needed_outputs
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .axis_limit_check import AxisLimitCheck, Extent
from .result_columns import FAULT_VARIABLE, LIMITS_BROKEN, TOLERANCE, TRUE_LENGTH_ERRORS

Row = dict[str, Any]


class RunEvaluation:
    """Evaluates the runs of a scenario, whatever its values are.

    Attributes:
        outputs: what is recorded in each run; nothing if nothing needs the whole course.
        limit_outputs: what has to be recorded to find the limits that were broken.
        reduce: the measures for the rest, by the names of outputs.
    """

    def __init__(self, scenario: Scenario) -> None:
        variables = scenario.recipe.variables
        self._limits = AxisLimitCheck(variables.values())
        exceeded = find_by_role(variables.values(), Role.EXCEEDED_LIMIT)
        self._exceeded = exceeded.name if exceeded else ""
        self._has_faults = FAULT_VARIABLE in variables
        codes = {FAULT_VARIABLE, self._exceeded} & {*variables}
        self.limit_outputs = sorted({*SLAVE_OUTPUTS} | codes)
        needed = needed_outputs(scenario)
        self.outputs = sorted(needed | codes | ({*SLAVE_OUTPUTS} if self._limits else set())) if needed else []
        self.reduce: dict[str, tuple[str, ...]] = dict.fromkeys(codes, ("initial", "first", "first_time"))
        if self._limits:
            self.reduce |= dict.fromkeys(SLAVE_OUTPUTS, ("initial", "min", "max"))

    def lacks_limits(self, row: Row) -> bool:
        """Whether only a recording of the slave can show which limits were broken."""
        return bool(self._limits) and not row["refusal"] and LIMITS_BROKEN not in row

    def row(self, scenario: Scenario, run: ScriptedRun) -> Row:
        """The row of a run; without the limits that it broke if this takes a recording, and there is none."""
        if run.failure:
            return refused_row(run.failure.removeprefix(f"at {run.failed_at:g} s "), run.failed_at)
        row: Row = {}
        may_exceed = self._may_exceed(scenario, run.measures)
        checks: Iterable[Check | Deviation]
        if run.recording:
            results = CuttingResults(scenario, run.recording)
            peaks = find_peaks(scenario, run.recording) if may_exceed else []
            checks = find_checks(gather(scenario, run.recording, results, peaks))
            row = _cutting_row(results) | _true_row(results) | _axis_row(scenario, run.recording)
            row |= {LIMITS_BROKEN: ", ".join(peak.name for peak in peaks if peak.exceeded)}
        else:
            checks = [*check_reactions(run.unmet), *check_alarms(scenario, self._first(FAULT_VARIABLE, run.measures))]
            row |= {} if may_exceed else {LIMITS_BROKEN: ""}
        unmet = [check for check in checks if not check.passed]
        row |= {
            "passed": not unmet,
            "refusal": "",
            "broken": len(unmet),
            "first_broken": unmet[0].text if unmet else "",
        }
        return row | self._fault(run.measures)

    def _may_exceed(self, scenario: Scenario, measures: Mapping[str, float]) -> bool:
        """Whether a limit of the axis may be exceeded."""
        if not self._limits:
            return False
        extents = {name: _extent(name, measures) for name in SLAVE_OUTPUTS}
        return bool(self._first(self._exceeded, measures)) or self._limits.may_be_exceeded(scenario, extents)

    def _first(self, name: str, measures: Mapping[str, float]) -> list[Event]:
        """The first value of a variable with codes that was not 0; none if there is no such variable."""
        if name not in self.reduce:
            return []
        if initial := measures[f"{name}.initial"]:
            return [Event(int(initial), 0.0)]
        first = int(measures[f"{name}.first"])
        return [Event(first, measures[f"{name}.first_time"])] if first else []

    def _fault(self, measures: Mapping[str, float]) -> Row:
        if not self._has_faults:
            return {}
        (event,) = self._first(FAULT_VARIABLE, measures) or [Event(0, math.nan)]
        return {"fault": event.code, "faulted_at": event.at if event.code else None}


def refused_row(text: str, at: float) -> Row:
    """The row of a run that was refused at a time, in s: nothing else is known of it."""
    return {"passed": False, "refusal": text, "refused_at": at}


def _extent(name: str, measures: Mapping[str, float]) -> Extent:
    initial = measures[f"{name}.initial"]
    return Extent(min(initial, measures[f"{name}.min"]), max(initial, measures[f"{name}.max"]))


def _cutting_row(results: CuttingResults) -> Row:
    production = results.production
    if production is None:
        return {"cuts": len(results.cuts), "cut_error": max((abs(cut.error) for cut in results.cuts), default=None)}
    return {
        "cuts": production.cuts,
        "cut_error": max(production.gaps, default=None),
        "late": production.late,
        "skipped": production.skipped,
        "length_error": abs(production.worst.error) if production.worst else None,
    }


def _true_row(results: CuttingResults) -> Row:
    true = results.true_pieces
    if true is None:
        return {}
    return {
        "true_length_mean": true.mean,
        "true_length_sigma": true.deviation,
        "true_length_worst": true.worst,
        "c_pk": true.c_pk,
        "cut_movement": true.movement,
        TOLERANCE: true.tolerance,
        TRUE_LENGTH_ERRORS: [piece.error for piece in true.pieces],
    }


def _axis_row(scenario: Scenario, recording: Recording) -> Row:
    error, load = find_following_error(scenario, recording), find_load_figures(scenario, recording)
    row: Row = {"following_error": error.greatest} if error else {}
    return row | ({"force_rms": load.rms, "force_peak": load.peak} if load else {})
