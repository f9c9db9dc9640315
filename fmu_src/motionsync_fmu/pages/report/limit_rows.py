"""The rows of the table "The limits in use"."""

from collections.abc import Mapping

from ...interface.limits_in_use import find_limits_in_use
from ...interface.units import unit_name
from ...interface.variables import Variable
from ..style import typeset


def limit_rows(
    variables: Mapping[str, Variable], start: Mapping[str, float], unit: str, slave_unit: str = ""
) -> list[tuple[str, str, str]]:
    """The name of each limit, its value with its unit, and why it has that value."""
    return [
        (
            limit.variable.name,
            f"{limit.value:.10g} {typeset(unit_name(limit.variable.declaration.unit, unit, slave_unit))}".rstrip(),
            limit.reason,
        )
        for limit in find_limits_in_use(variables, start)
    ]
