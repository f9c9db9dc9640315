"""The ranges of what may be tuned while a cut-to-length machine runs."""

from collections.abc import Mapping
from typing import Any

from tests.oracle.cutting.ranges import LENGTHS, MINIMUM, POSITIONS, SIZES, TIMES, Range, Ranges

LIMITS = (
    *(f"approach.{name}" for name in ("acceleration", "jerk")),
    *(f"homing.{name}" for name in ("velocity", "acceleration", "deceleration", "jerk")),
    "axis.max_deceleration",
)
"""Either 0 or within the range of sizes."""


class _SawRanges(Ranges):
    """Home is between the ends of the stroke."""

    def limits(self, inputs: Mapping[str, Any], name: str) -> Range:
        if name == "home_position":
            return float(inputs["axis.min_position"]), float(inputs["axis.max_position"])
        return super().limits(inputs, name)


RANGES = _SawRanges(
    {
        "home_position": POSITIONS,
        "gap.travel": SIZES,
        **dict.fromkeys(("axis.max_velocity", "axis.max_acceleration", "axis.max_jerk", *LIMITS), SIZES),
        **dict.fromkeys(("approach.distance", "tool.cut_distance", "gap.distance"), LENGTHS),
        **dict.fromkeys(("approach.reserve", "homing.settle_time", "homing.spare_time"), TIMES),
        **dict.fromkeys(
            (f"tool.{n}" for n in ("settle_time", "on_delay", "cut_time", "retract_time", "timeout")), TIMES
        ),
        "homing.slowest": (MINIMUM, 1.0),
    },
    or_zero=LIMITS,
)

CYCLE = (
    *("home_position", "material_factor", "axis.max_velocity", "axis.max_acceleration", "axis.max_jerk", *LIMITS),
    *("approach.distance", "approach.reserve", "homing.settle_time", "homing.spare_time", "homing.slowest"),
    *("tool.settle_time", "tool.on_delay", "tool.cut_time", "tool.cut_distance", "tool.retract_time", "tool.timeout"),
    *("gap.distance", "gap.travel", "late_mode"),
)
"""What an approach, and what is computed of a cycle, reads."""
