"""The columns of the rows of a sweep: the run's number, its values, its results and its measures."""

from collections.abc import Mapping

import pyarrow as pa

from ..interface.roles import piece_variables
from ..scenario.scenario import Scenario
from ..scenario.variation.expressions import Array
from .axis_limit_check import AxisLimitCheck
from .measures import Measures
from .sweep_plan import SweepPlan

FAULT_VARIABLE = "error_id"  # the variable with the fault of a block; 0: there is none
LIMITS_BROKEN = "limits_broken"
ALWAYS = {
    "passed": pa.bool_(),
    "refusal": pa.string(),
    "refused_at": pa.float64(),
    "broken": pa.int64(),
    "first_broken": pa.string(),
}
CUTS = {"cuts": pa.int64(), "cut_error": pa.float64()}
PIECES = {"late": pa.int64(), "skipped": pa.int64(), "length_error": pa.float64()}
TRUE_LENGTH_ERRORS, TOLERANCE = "true_length_errors", "tolerance"
TRUE_PIECES = dict.fromkeys(
    ("true_length_mean", "true_length_sigma", "true_length_worst", "c_pk", "cut_movement", TOLERANCE), pa.float64()
) | {TRUE_LENGTH_ERRORS: pa.list_(pa.float64())}  # of a list, a value for each piece
SERVO = {"following_error": pa.float64()}
LOAD = {"force_rms": pa.float64(), "force_peak": pa.float64()}
LIMITS = {LIMITS_BROKEN: pa.string()}
FAULTS = {"fault": pa.int64(), "faulted_at": pa.float64()}


def schema(plan: SweepPlan, values: Mapping[str, Array] | None = None) -> pa.Schema:
    """All columns with their types. `values`: of any runs; without them the plan computes those of the first run, which
    takes long if samples far behind it were the last ones: see `samples.py`."""
    types = {name: pa.array(of_runs[:0]).type for name, of_runs in (values or plan.values(0, 1)).items()}
    measured = dict.fromkeys(measure_columns(plan.measures), pa.float64())
    return pa.schema({"run": pa.int64()} | types | result_columns(plan.variation.scenario) | measured)


def result_columns(scenario: Scenario) -> dict[str, pa.DataType]:
    """The types of the results by their names; those that the scenario cannot have are left out."""
    variables = scenario.recipe.variables
    reports_pieces = piece_variables(variables.values()) is not None
    columns = ALWAYS | (CUTS if scenario.cuts or reports_pieces else {}) | (PIECES if reports_pieces else {})
    columns |= TRUE_PIECES if scenario.has_true_places and (scenario.cuts or reports_pieces) else {}
    columns |= (SERVO if scenario.servo else {}) | (LOAD if scenario.load else {})
    columns |= LIMITS if AxisLimitCheck(variables.values()) else {}
    return columns | (FAULTS if FAULT_VARIABLE in variables else {})


def measure_columns(measures: Measures) -> list[str]:
    """The names of the columns of measures: `slave.velocity.max`."""
    return [f"{name}.{kind}" for name, kinds in measures.items() for kind in kinds]
