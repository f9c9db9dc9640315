"""One run of a sweep alone: a scenario with a value for each of some names, as `motionsync run --set` has them."""

from collections.abc import Mapping
from pathlib import Path

from ..errors import UserError
from ..scenario.scenario import Scenario
from .expressions import Expression
from .factors import Listed, read_values
from .varied import Target, Varied


def with_values(file: Path, given: Mapping[str, str]) -> Scenario:
    """The scenario in a file with other values.

    Raises:
        UserError: the scenario has nothing of such a name, or refuses the value.
    """
    try:
        text = file.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as e:
        raise UserError(f"{file}: cannot be read: {e}") from None
    varied = Varied(text, file)
    try:
        values = [(target, _value(target, value)) for name, value in given.items() for target in [varied.target(name)]]
        return varied.varied(values)
    except UserError as e:
        raise UserError(f"--set: {e}") from None


def _value(target: Target, text: str) -> float | bool | str:
    """The only value in a text."""
    values = read_values(text, target.kind)
    if isinstance(values, Expression):
        raise UserError(f"{target.name}={text}: {text!r} is no value")
    if not isinstance(values, Listed) or values.count != 1:
        raise UserError(f"{target.name}={text}: a run takes one value; motionsync sweep takes several")
    found: float | bool | str = values.values.tolist()[0]
    return found
