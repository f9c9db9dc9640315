"""The ranges and start values of what may be set while a machine that cuts to length runs."""

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

PIECE_DEFAULTS: Mapping[str, Any] = {
    "material_factor": 1.0,
    "kerf": 0.0,
    "length_tolerance": 0.5,
    "start_mode": 1,
    "front_position": 0.0,
    "trim_length": 0.0,
    "change_mode": 1,
    "late_mode": 1,
    "sample_length": 100.0,
    "waste_length": 100.0,
    "batch_size": 0,
    "mark.sensor_distance": 1000.0,
    "mark.cut_offset": 0.0,
    "mark.spacing": 0.0,
    "mark.window": 0.0,
    "mark.every": 1,
    "mark.max_missing": 3,
    "mark.substitute": True,
    "mark.delay": 0.0,
    "order.repeat": False,
    "line.margin": 0.02,
    "hold": False,
    "length": 1000.0,
    "length_correction": 0.0,
    "order.length": 0.0,
    "order.quantity": 1,
    "waste": False,
    "mark.position": 0.0,
    "calibration.measured_length": 0.0,
    "line.wanted_velocity": 1000000000.0,
}
"""The start values of what every such machine has, but for its commands."""


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
