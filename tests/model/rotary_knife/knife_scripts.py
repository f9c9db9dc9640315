"""The reference knife, as a script for its oracle: C = 600 mm, one blade, windows of ±30 mm, k = 0.6 °/mm."""

from itertools import pairwise
from typing import Any

import pytest

from tests.oracle.rotary_knife import events, reference

FAULT, OFF, PARKING, WAITING, ENGAGING, SYNCHRONOUS, TURNING, DISENGAGING = range(-1, 7)
PRODUCT, SAMPLE, WASTE, TRIM, SHORT, MERGED = range(1, 7)
SKIP, LATE, STOP_LINE = 1, 2, 3
HORIZONTAL = 2
K = 0.6  # ° per mm

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


def row_at(run: Script, time: float) -> Row:
    """The row just after `time`."""
    return reference(run, [time])[-1]


def rows(run: Script, step: float, begin: float = 0.0, end: float | None = None) -> list[Row]:
    last = run["stop_time"] if end is None else end
    return reference(run, [begin + i * step for i in range(1, round((last - begin) / step) + 1)])


def times(run: Script, name: str) -> list[float]:
    return [time for time, event in events(run) if event == name]


def lengths(run: Script) -> list[float]:
    """Of the pieces, as each cut records its own."""
    return [reference(run, [time])[-1]["last.length"] for time in times(run, "cut")]


def jumps(run: Script, name: str) -> float:
    """How far a variable jumps at most where something happens."""
    return max(abs(b[name] - a[name]) for time, _ in events(run) for a, b in pairwise(reference(run, [time]) * 2))


def near(value: float, rel: float = 1e-9) -> Any:
    """What equals the value to this relative tolerance, or to 1e-9."""
    return pytest.approx(value, rel=rel, abs=1e-9)
