"""What a scenario sets at known times, by its tables [[set]]."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any


def gathered(
    tables: Sequence[Mapping[str, Any]],
    settable: Collection[str],
    number: Callable[[str, Any], Any] = lambda name, value: value,
) -> dict[float, dict[str, Any]]:
    """The values that are set at each time, the times in order.

    `settable`: the names that may be set; `number`: of a name and what the table gives, the value as a number.

    Raises:
        ValueError: a name that cannot be set, or a time at which nothing can.
    """
    result: dict[float, dict[str, Any]] = {}
    for table in sorted(tables, key=lambda table: float(table["at"])):
        values = {name: value for name, value in table.items() if name != "at"}
        if unknown := sorted(values.keys() - set(settable)):
            raise ValueError(f"{', '.join(unknown)} cannot be set; inputs and tunable parameters can")
        if table["at"] <= 0:
            raise ValueError(f"a set is given at {table['at']}; a set at 0 or before is never an edge")
        result.setdefault(float(table["at"]), {}).update((name, number(name, x)) for name, x in values.items())
    return result
