"""The units of the columns of a sweep."""

from collections.abc import Mapping

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.scenario import Scenario
from ..sweep_plan import SweepPlan

RESULTS = {"cut_error": Unit.POSITION, "length_error": Unit.POSITION, "refused_at": Unit.TIME, "faulted_at": Unit.TIME}
KEYS = {  # of a scenario's file
    **{key: Unit[key.upper()] for key in ("position", "velocity", "acceleration", "jerk")},
    "length": Unit.POSITION,
    **dict.fromkeys(("at", "after", "time", "stop_time", "step_size", "duration", "until"), Unit.TIME),
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
    return {name: unit_name(kind, scenario.unit, scenario.slave_unit) for name, kind in kinds.items()}


def _measures(measures: Mapping[str, tuple[str, ...]], scenario: Scenario) -> dict[str, Unit]:
    units_by_column = {}
    for name, kinds in measures.items():
        own = scenario.recipe.variables[name].declaration.unit
        for kind in kinds:
            time = kind.endswith("_time") or kind.startswith("above:")
            units_by_column[f"{name}.{kind}"] = Unit.TIME if time else Unit.NONE if kind in COUNTS else own
    return units_by_column
