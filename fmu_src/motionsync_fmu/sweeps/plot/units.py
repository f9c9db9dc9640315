"""The units of the columns of a sweep."""

from collections.abc import Mapping

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.evaluate.axis_figures import force_unit
from ...scenario.scenario import Scenario
from ..result_columns import TRUE_LENGTH_ERRORS
from ..sweep_plan import SweepPlan

RESULTS = {
    **dict.fromkeys(("cut_error", "length_error", "cut_movement", "tolerance"), Unit.POSITION),
    **dict.fromkeys(("true_length_mean", "true_length_sigma", "true_length_worst"), Unit.POSITION),
    TRUE_LENGTH_ERRORS: Unit.POSITION,
    "following_error": Unit.SLAVE_POSITION,
    **dict.fromkeys(("refused_at", "faulted_at"), Unit.TIME),
}
FORCES = ("force_rms", "force_peak")
KEYS = {  # of a scenario's file
    **{key: Unit[key.upper()] for key in ("position", "velocity", "acceleration", "jerk")},
    "length": Unit.POSITION,
    **dict.fromkeys(("resolution", "noise", "amplitude", "tolerance"), Unit.POSITION),
    **dict.fromkeys(("at", "after", "time", "stop_time", "step_size", "duration", "until"), Unit.TIME),
    **dict.fromkeys(("delay", "sample_time", "velocity_time_constant", "dead_time"), Unit.TIME),
}
COUNTS = ("rises",)


def units(plan: SweepPlan) -> dict[str, str]:
    """The unit of each column that has one."""
    scenario = plan.variation.scenario
    kinds: dict[str, Unit] = dict(RESULTS)
    for factor in plan.factors:
        variable = plan.variation.target(factor.name).variable
        key = KEYS.get(factor.name.rpartition(".")[2], Unit.NONE)
        kinds[factor.name] = variable.declaration.unit if variable else key
    kinds |= _measures(plan.measures, scenario)
    named = {name: unit_name(kind, scenario.unit, scenario.slave_unit) for name, kind in kinds.items()}
    return named | (dict.fromkeys(FORCES, force_unit(scenario.load)) if scenario.load else {})


def _measures(measures: Mapping[str, tuple[str, ...]], scenario: Scenario) -> dict[str, Unit]:
    units_by_column = {}
    for name, kinds in measures.items():
        own = scenario.recipe.variables[name].declaration.unit
        for kind in kinds:
            time = kind.endswith("_time") or kind.startswith("above:")
            units_by_column[f"{name}.{kind}"] = Unit.TIME if time else Unit.NONE if kind in COUNTS else own
    return units_by_column
