"""The ranges of what may be tuned while a machine that cuts to length runs."""

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

Range: TypeAlias = tuple[float, float]

MINIMUM, MAXIMUM, LONGEST = 1e-12, 1e12, 1e6

SIZES = (MINIMUM, MAXIMUM)
LENGTHS, POSITIONS, TIMES = (0.0, MAXIMUM), (-MAXIMUM, MAXIMUM), (0.0, LONGEST)

OF_PIECES: Mapping[str, Range] = {
    **dict.fromkeys(("material_factor", "sample_length", "waste_length"), SIZES),
    **dict.fromkeys(("kerf", "trim_length", "mark.spacing", "mark.window"), LENGTHS),
    "front_position": POSITIONS,
    "mark.every": (1, MAXIMUM),
    **dict.fromkeys(("start_mode", "change_mode", "late_mode"), (1, 3)),
}
"""Of what every such machine has."""


class Ranges:
    """The ranges by name; those of `or_zero` may also be 0."""

    def __init__(self, ranges: Mapping[str, Range], or_zero: Iterable[str] = ()) -> None:
        self.ranges, self.or_zero = {**OF_PIECES, **ranges}, frozenset(or_zero)

    def limits(self, inputs: Mapping[str, Any], name: str) -> Range:
        """The range of that variable, where the others are `inputs`."""
        return self.ranges[name]

    def are_valid(self, inputs: Mapping[str, Any], names: Iterable[str]) -> bool:
        """Whether all of them are within their ranges."""
        return all(self._is_within_range(inputs, name) for name in names)

    def valid_values(self, inputs: Mapping[str, Any], previous: Mapping[str, Any]) -> dict[str, Any]:
        """The inputs, with their `previous` values for those that are out of their ranges."""
        return {
            name: previous[name] if name in self.ranges and not self._is_within_range(inputs, name) else inputs[name]
            for name in inputs
        }

    def _is_within_range(self, inputs: Mapping[str, Any], name: str) -> bool:
        value, (low, high) = inputs[name], self.limits(inputs, name)
        return low <= value <= high or (name in self.or_zero and value == 0)
