"""Which outputs of a run are needed to judge it: a recording of these alone gives the same checks and figures."""

from collections.abc import Iterator
from dataclasses import astuple

from motionsync.var import Role

from ..interface.roles import books, with_role
from .scenario import AtTime, Scenario, When, Within

MOTION = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")
LIMITS = (
    Role.MIN_POSITION,
    Role.MAX_POSITION,
    Role.MAX_VELOCITY,
    Role.MAX_ACCELERATION,
    Role.MAX_DECELERATION,
    Role.MAX_JERK,
)


def judged_outputs(scenario: Scenario) -> list[str]:
    """The outputs and local variables that `judge.check` and `figures.figures` read, in the order of the variables."""
    names = set(_named(scenario))
    return [v.name for v in scenario.recipe.variables.values() if v.name in names and not v.settable]


def _named(scenario: Scenario) -> Iterator[str]:
    """The variables that both read; they know parameters and inputs from what is set."""
    yield from MOTION
    for e in scenario.expectations:
        match e:
            case AtTime():
                yield from e.values
            case When():
                yield e.name
            case Within():
                yield from e.limits
    if scenario.cuts:
        yield scenario.cuts.name
    if scenario.remote:
        yield scenario.remote.names.corrected_index
    variables = scenario.recipe.variables.values()
    yield from (v.name for role in LIMITS if (v := with_role(variables, role)))
    if told := books(variables):
        for names in astuple(told):
            yield from [names] if isinstance(names, str) else names
