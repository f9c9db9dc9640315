"""What a row tells of one run of a sweep, beside its number, its values and its measures.

A run is judged as `motionsync run` judges it, without the reference beside the file, which belongs to the scenario as
it stands there. Only what has to be judged from the whole course is recorded; the rest is told by measures, which the
compiled loop keeps step by step."""

from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from ..interface.roles import books
from ..native.loop.scripted import ScriptedRun
from ..scenario.figures import SLAVE, peaks
from ..scenario.judge import check_work, judged_outputs, missing
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from ..scenario.work import Work
from .limits import Extent, Limits

FAULT = "error_id"  # in this variable a block tells its faults; 0: there is none

ALWAYS = {
    "passed": pa.bool_(),
    "refusal": pa.string(),
    "refused_at": pa.float64(),
    "broken": pa.int64(),
    "first_broken": pa.string(),
}
CUTS = {"cuts": pa.int64(), "cut_error": pa.float64()}
PIECES = {"late": pa.int64(), "skipped": pa.int64(), "length_error": pa.float64()}
LIMITS_BROKEN = "limits_broken"
FAULTS = {"fault": pa.int64(), "faulted_at": pa.float64()}

Row = dict[str, Any]


class Results:
    """What the rows tell of the runs of a scenario, whatever its values are.

    Attributes:
        columns: their types by their names; those that the scenario cannot have are left out.
        outputs: what is recorded in each run; nothing if nothing is judged from the whole course.
        reduce: the measures that tell the rest, by the names of outputs.
    """

    def __init__(self, scenario: Scenario) -> None:
        variables = scenario.recipe.variables
        tells_pieces = books(variables.values()) is not None
        self._limits = Limits(variables.values())
        self._faults = FAULT in variables
        self.columns = ALWAYS | (CUTS if scenario.cuts or tells_pieces else {}) | (PIECES if tells_pieces else {})
        self.columns |= ({LIMITS_BROKEN: pa.string()} if self._limits else {}) | (FAULTS if self._faults else {})
        judged = judged_outputs(scenario)
        self.outputs = sorted(judged | ({*SLAVE} if judged and self._limits else set()))
        self.reduce: dict[str, tuple[str, ...]] = {FAULT: ("initial", "first", "first_time")} if self._faults else {}
        if self._limits:
            self.reduce |= dict.fromkeys(SLAVE, ("initial", "min", "max"))

    def lacks_limits(self, row: Row) -> bool:
        """Whether a recording of the slave has to tell yet which limits were broken."""
        return bool(self._limits) and not row["refusal"] and LIMITS_BROKEN not in row

    def row(self, scenario: Scenario, run: ScriptedRun) -> Row:
        """The row of a run; without the limits that it broke if this takes a recording, and there is none."""
        if run.failure:
            return refused(run.failure.removeprefix(f"at {run.failed_at:g} s "), run.failed_at)
        work = Work(scenario, run.recording) if run.recording else None
        broken = [found for found in (check_work(work) if work else missing(run.unmet)) if not found.passed]
        row = {
            "passed": not broken,
            "refusal": "",
            "broken": len(broken),
            "first_broken": broken[0].text if broken else "",
        }
        return row | (_work(work) if work else {}) | self._limits_broken(scenario, run) | self._fault(run.measures)

    def _limits_broken(self, scenario: Scenario, run: ScriptedRun) -> Row:
        if not self._limits:
            return {}
        if not self._limits.may_be_exceeded(scenario, {name: _extent(name, run.measures) for name in SLAVE}):
            return {LIMITS_BROKEN: ""}
        return limits_broken(scenario, run.recording) if run.recording else {}

    def _fault(self, measures: Mapping[str, float]) -> Row:
        if not self._faults:
            return {}
        if initial := measures[f"{FAULT}.initial"]:
            return {"fault": int(initial), "faulted_at": 0.0}
        first = int(measures[f"{FAULT}.first"])
        return {"fault": first, "faulted_at": measures[f"{FAULT}.first_time"] if first else None}


def refused(text: str, at: float) -> Row:
    """The row of a run that was refused at a time, in s: nothing else is known of it."""
    return {"passed": False, "refusal": text, "refused_at": at}


def limits_broken(scenario: Scenario, recording: Recording) -> Row:
    """The limits of the axis that the slave exceeded, by the whole course of its values."""
    return {LIMITS_BROKEN: ", ".join(peak.name for peak in peaks(scenario, recording) if peak.exceeded)}


def _extent(name: str, measures: Mapping[str, float]) -> Extent:
    initial = measures[f"{name}.initial"]
    return Extent(min(initial, measures[f"{name}.min"]), max(initial, measures[f"{name}.max"]))


def _work(work: Work) -> Row:
    made = work.production
    if made is None:
        return {"cuts": len(work.cuts), "cut_error": max((abs(cut.error) for cut in work.cuts), default=None)}
    return {
        "cuts": made.cuts,
        "cut_error": max(made.gaps, default=None),
        "late": made.late,
        "skipped": made.skipped,
        "length_error": abs(made.worst.error) if made.worst else None,
    }
