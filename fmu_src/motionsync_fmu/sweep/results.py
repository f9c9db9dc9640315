"""What a row tells of one run of a sweep, beside its number, its values and its measures.

A run is judged as `motionsync run` judges it, without the reference beside the file, which belongs to the scenario as
it stands there."""

from typing import Any

import numpy as np
import pyarrow as pa

from ..interface.roles import books
from ..scenario.figures import SLAVE, is_limited, peaks
from ..scenario.judge import check_work, judged_outputs
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from ..scenario.work import Work

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
LIMITS = {"limits_broken": pa.string()}
FAULTS = {"fault": pa.int64(), "faulted_at": pa.float64()}


def columns(scenario: Scenario) -> dict[str, pa.DataType]:
    """The columns by which a run of the scenario is told, in their order; those that it cannot have are left out."""
    variables = scenario.recipe.variables
    tells_pieces = books(variables.values()) is not None
    told = ALWAYS | (CUTS if scenario.cuts or tells_pieces else {}) | (PIECES if tells_pieces else {})
    return told | (LIMITS if is_limited(scenario) else {}) | (FAULTS if FAULT in variables else {})


def outputs(scenario: Scenario) -> list[str]:
    """The outputs that have to be recorded."""
    faults = {FAULT} & scenario.recipe.variables.keys()
    return sorted({*judged_outputs(scenario), *SLAVE, *faults})


def refused(text: str, at: float) -> dict[str, Any]:
    """The row of a run that was refused at a time, in s: nothing else is known of it."""
    return {"passed": False, "refusal": text, "refused_at": at}


def told(scenario: Scenario, recording: Recording) -> dict[str, Any]:
    """The row of a run that went to its end."""
    made = Work(scenario, recording)
    broken = [found for found in check_work(made) if not found.passed]
    row = {
        "passed": not broken,
        "refusal": "",
        "broken": len(broken),
        "first_broken": broken[0].text if broken else "",
        "limits_broken": ", ".join(peak.name for peak in peaks(scenario, recording) if peak.exceeded),
    }
    return row | _work(made) | _fault(recording)


def _work(made: Work) -> dict[str, Any]:
    if made.production is None:
        return {"cuts": len(made.cuts), "cut_error": max((abs(cut.error) for cut in made.cuts), default=None)}
    worst = made.production.worst
    return {
        "cuts": made.production.cuts,
        "cut_error": max(made.production.gaps, default=None),
        "late": made.production.late,
        "skipped": made.production.skipped,
        "length_error": abs(worst.error) if worst else None,
    }


def _fault(recording: Recording) -> dict[str, Any]:
    if FAULT not in recording.values:
        return {}
    faults = recording.values[FAULT]
    at = np.flatnonzero(faults)[:1].tolist()
    return {"fault": int(faults[at[0]]), "faulted_at": float(recording.time[at[0]])} if at else {"fault": 0}
