"""The option `--set` of `motionsync run`: a scenario with other values than its file has."""

from collections.abc import Mapping
from pathlib import Path

from ..errors import UserError
from ..scenario.files.toml_tables import read_file
from ..scenario.scenario import Scenario
from ..sweep.expressions import Expression
from ..sweep.factors import Listed, read_values
from ..sweep.scenario_variation import ScenarioVariation, Target


def load_with_values(file: Path, overrides: Mapping[str, str]) -> Scenario:
    """The scenario in a file with other values, as texts by name.

    Raises:
        UserError: the scenario has nothing of such a name, or refuses the value.
    """
    variation = ScenarioVariation(read_file(file), file)
    try:
        targets = [(variation.target(name), text) for name, text in overrides.items()]
        return variation.with_values((target, _value(target, text)) for target, text in targets)
    except UserError as e:
        raise UserError(f"--set: {e}") from None


def _value(target: Target, text: str) -> float | bool | str:
    """The only value in a text."""
    values = read_values(text, target.kind)
    if isinstance(values, Expression):
        raise UserError(f"{target.name}={text}: {text!r} is no value")
    if not isinstance(values, Listed) or values.count != 1:
        raise UserError(f"{target.name}={text}: a run takes one value; motionsync sweep takes several")
    value: float | bool | str = values.values.tolist()[0]
    return value
