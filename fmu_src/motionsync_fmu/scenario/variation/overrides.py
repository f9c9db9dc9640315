"""A scenario with other values than its file has: `set` of `run`."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from ...errors import UserError
from ...interface.quantities import describe_number
from ..scenario import Scenario
from .expressions import Expression
from .scenario_variation import ScenarioVariation, Target
from .values import Listed, read_values


def with_overrides(text: str, file: Path, overrides: Mapping[str, str]) -> Scenario:
    """The scenario of a file with other values, as texts by name; `text`: what the file has in it.

    Raises:
        UserError: the scenario has nothing of such a name, or refuses the value.
    """
    variation = ScenarioVariation(text, file)
    try:
        targets = [(variation.target(name), value) for name, value in overrides.items()]
        scenario = variation.with_values((target, _value(target, value)) for target, value in targets)
    except UserError as e:
        raise UserError(f"--set: {e}") from None
    return replace(scenario, overrides=overrides)


def _value(target: Target, text: str) -> float | bool | str:
    """The only value in a text; a number with a unit is one in the unit of the scenario."""
    try:
        values = read_values(text, target.kind)
    except UserError as e:
        raise UserError(f"{target.name}={text}: {e}") from None
    if isinstance(values, Expression):
        required = "true or false" if target.kind.name == "Boolean" else describe_number(target.unit or "")
        raise UserError(f"{target.name}={text}: {text!r} is not allowed: it must be {required}")
    if not isinstance(values, Listed) or values.count != 1:
        raise UserError(f"{target.name}={text}: a run takes one value; motionsync sweep takes several")
    value: float | bool | str = values.values.tolist()[0]
    return value
