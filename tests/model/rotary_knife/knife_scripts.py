"""The reference knife, as a script for its oracle: C = 600 mm, one blade, windows of ±30 mm, k = 0.6 °/mm."""

from typing import Any

LATE, STOP_LINE = 2, 3
HORIZONTAL = 2

Script = dict[str, Any]
Row = dict[str, float]


def script(segments: list[dict[str, float]], *sets: dict[str, Any], **values: Any) -> Script:
    """The knife on a line; a name has `__` for a dot. `position`, `velocity` are the line's first ones."""
    start = {"sync.before": 30.0, "sync.after": 30.0} | _dotted(values)
    line = {name: start.pop(name, 0.0) for name in ("position", "velocity", "acceleration")}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": start.pop("step_size", 0.01),
        "start": start,
        "master": line | {"segments": segments},
        "set": [_dotted(table) for table in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **values: Any) -> Script:
    """A line of constant velocity; `start` is given at 0.2 s."""
    return script([{"duration": duration}], {"at": 0.2, "start": True}, *sets, velocity=velocity, **values)


def _dotted(values: dict[str, Any]) -> dict[str, Any]:
    return {name.replace("__", "."): value for name, value in values.items()}
