"""Evaluates the runs of a sweep: the results in a row, in addition to its number, its values and its measures.

A run is evaluated as `motionsync run` does, without the reference next to the scenario's file, which belongs to the
scenario as it is there. Only what needs the whole course is recorded; the rest comes from measures, which the compiled
loop computes step by step."""

from collections.abc import Mapping
from typing import Any

from ..batch.scripted_runs import ScriptedRun
from ..scenario.evaluate.axis_figures import find_following_error, find_load_figures
from ..scenario.evaluate.cutting_results import CuttingResults
from ..scenario.evaluate.expectations import check_expectations, check_reactions, checked_outputs
from ..scenario.evaluate.key_figures import SLAVE_OUTPUTS, find_peaks
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .axis_limit_check import AxisLimitCheck, Extent
from .result_columns import FAULT_VARIABLE, LIMITS_BROKEN, TOLERANCE, TRUE_LENGTH_ERRORS

Row = dict[str, Any]


class RunEvaluation:
    """Evaluates the runs of a scenario, whatever its values are.

    Attributes:
        outputs: what is recorded in each run; nothing if nothing needs the whole course.
        reduce: the measures for the rest, by the names of outputs.
    """

    def __init__(self, scenario: Scenario) -> None:
        variables = scenario.recipe.variables
        self._limits = AxisLimitCheck(variables.values())
        self._has_faults = FAULT_VARIABLE in variables
        checked = checked_outputs(scenario)
        self.outputs = sorted(checked | ({*SLAVE_OUTPUTS} if checked and self._limits else set()))
        self.reduce: dict[str, tuple[str, ...]] = {}
        if self._has_faults:
            self.reduce[FAULT_VARIABLE] = ("initial", "first", "first_time")
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
        if run.recording:
            results = CuttingResults(scenario, run.recording)
            checks = check_expectations(scenario, run.recording, results)
            row = _cutting_row(results) | _true_row(results) | _axis_row(scenario, run.recording)
        else:
            checks = check_reactions(run.unmet)
        unmet = [check for check in checks if not check.passed]
        row |= {
            "passed": not unmet,
            "refusal": "",
            "broken": len(unmet),
            "first_broken": unmet[0].text if unmet else "",
        }
        return row | self._limits_broken(scenario, run) | self._fault(run.measures)

    def _limits_broken(self, scenario: Scenario, run: ScriptedRun) -> Row:
        if not self._limits:
            return {}
        if not self._limits.may_be_exceeded(scenario, {name: _extent(name, run.measures) for name in SLAVE_OUTPUTS}):
            return {LIMITS_BROKEN: ""}
        return limits_broken(scenario, run.recording) if run.recording else {}

    def _fault(self, measures: Mapping[str, float]) -> Row:
        if not self._has_faults:
            return {}
        if initial := measures[f"{FAULT_VARIABLE}.initial"]:
            return {"fault": int(initial), "faulted_at": 0.0}
        first = int(measures[f"{FAULT_VARIABLE}.first"])
        return {"fault": first, "faulted_at": measures[f"{FAULT_VARIABLE}.first_time"] if first else None}


def refused_row(text: str, at: float) -> Row:
    """The row of a run that was refused at a time, in s: nothing else is known of it."""
    return {"passed": False, "refusal": text, "refused_at": at}


def limits_broken(scenario: Scenario, recording: Recording) -> Row:
    """The limits of the axis that the slave exceeded, by the whole course of its values."""
    return {LIMITS_BROKEN: ", ".join(peak.name for peak in find_peaks(scenario, recording) if peak.exceeded)}


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
