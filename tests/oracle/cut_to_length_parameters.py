"""The ranges of what may be tuned while a cut-to-length machine runs."""

from collections.abc import Iterable, Mapping
from typing import Any

MINIMUM, MAXIMUM, LONGEST = 1e-12, 1e12, 1e6

SIZES = (MINIMUM, MAXIMUM)
LENGTHS, POSITIONS, TIMES = (0.0, MAXIMUM), (-MAXIMUM, MAXIMUM), (0.0, LONGEST)

LIMITS = (
    *(f"approach.{name}" for name in ("acceleration", "jerk")),
    *(f"homing.{name}" for name in ("velocity", "acceleration", "deceleration", "jerk")),
    "axis.max_deceleration",
)
"""Either 0 or within the range of sizes."""

RANGES: Mapping[str, tuple[float, float]] = {
    "home_position": POSITIONS,
    **dict.fromkeys(("material_factor", "gap.travel", "sample_length", "waste_length"), SIZES),
    **dict.fromkeys(("axis.max_velocity", "axis.max_acceleration", "axis.max_jerk", *LIMITS), SIZES),
    **dict.fromkeys(("approach.distance", "tool.cut_distance", "gap.distance", "kerf", "trim_length"), LENGTHS),
    **dict.fromkeys(("mark.spacing", "mark.window"), LENGTHS),
    **dict.fromkeys(("approach.reserve", "homing.settle_time", "homing.spare_time"), TIMES),
    **dict.fromkeys((f"tool.{n}" for n in ("settle_time", "on_delay", "cut_time", "retract_time", "timeout")), TIMES),
    "homing.slowest": (MINIMUM, 1.0),
    "front_position": POSITIONS,
    "mark.every": (1, MAXIMUM),
    **dict.fromkeys(("start_mode", "change_mode", "late_mode"), (1, 3)),
}

CYCLE = (
    *("home_position", "material_factor", "axis.max_velocity", "axis.max_acceleration", "axis.max_jerk", *LIMITS),
    *("approach.distance", "approach.reserve", "homing.settle_time", "homing.spare_time", "homing.slowest"),
    *("tool.settle_time", "tool.on_delay", "tool.cut_time", "tool.cut_distance", "tool.retract_time", "tool.timeout"),
    *("gap.distance", "gap.travel", "late_mode"),
)
"""What an approach, and what is computed of a cycle, reads."""


def are_valid(inputs: Mapping[str, Any], names: Iterable[str]) -> bool:
    """Whether all of them are within their ranges."""
    return all(_is_within_range(inputs, name) for name in names)


def _is_within_range(inputs: Mapping[str, Any], name: str) -> bool:
    value, (low, high) = inputs[name], RANGES[name]
    if name == "home_position":
        low, high = inputs["axis.min_position"], inputs["axis.max_position"]
    return low <= value <= high or (name in LIMITS and value == 0)


def valid_values(inputs: Mapping[str, Any], previous: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs, with their `previous` values for those that are out of their ranges."""
    return {
        name: previous[name] if name in RANGES and not _is_within_range(inputs, name) else inputs[name]
        for name in inputs
    }
