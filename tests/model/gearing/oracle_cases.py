"""Scripts for the Gearing's oracle, and what is read of its rows and events."""

from typing import Any

import pytest

from tests.oracle.gearing import events, reference
from tests.oracle.gearing_inputs import STATES

STOPPED, WAITING_START, GEAR_IN, ACTIVE, WAITING_STOP, GEAR_OUT = range(6)
CW_DIRECT, CCW_DIRECT, CW_CCW_DIRECT, CW_POSITION, CCW_POSITION, CW_CCW_POSITION, CONTINUE = range(1, 8)
NONE, MASTER, TIME = 1, 2, 3


def scenario(segments: list[dict[str, float]], *sets: dict[str, Any], **start: Any) -> dict[str, Any]:
    """A scenario of the segments' length; names have `__` for a dot, `position` and `velocity` are the master's."""
    master = {name: start.pop(name, 0.0) for name in ("position", "velocity", "acceleration")}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": {name.replace("__", "."): value for name, value in start.items()},
        "master": master | {"segments": segments},
        "set": [{name.replace("__", "."): value for name, value in table.items()} for table in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **start: Any) -> dict[str, Any]:
    """A master of constant velocity."""
    return scenario([{"duration": duration}], *sets, velocity=velocity, **start)


def on(time: float, **values: Any) -> dict[str, Any]:
    """A rising edge of start."""
    return {"at": time, "start": True, **values}


def off(time: float, **values: Any) -> dict[str, Any]:
    """A falling edge of start."""
    return {"at": time, "start": False, **values}


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float, float]:
    return (row["slave.position"], row["slave.velocity"], row["slave.acceleration"], row["slave.jerk"])


def states(given: dict[str, Any]) -> list[tuple[Any, int]]:
    """The states entered, with their times."""
    return [(close(time), STATES.index(name)) for time, name in events(given) if name in STATES]


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


def numbers(*values: float) -> tuple[Any, ...]:
    return tuple(close(value) for value in values)


TIMED: dict[str, Any] = {"gear_in__transition": TIME, "gear_in__time": 2.0}


def time_based(ahead: float, **options: Any) -> dict[str, Any]:
    """An edge at 1 s, the master at 100 with 100; the reference position `ahead` of it."""
    return steady(100.0, 5.0, on(1.0), gear_in__reference_position=100.0 + ahead, **TIMED | options)


ENGAGED: dict[str, Any] = {"gear_in__reference_position": 100.0}
"""With 100 u/s from 0 and an edge at 0.25 s: s = m - 100 from 1.5 s on."""


def engaged(*sets: dict[str, Any], duration: float = 6.0, **options: Any) -> dict[str, Any]:
    return steady(100.0, duration, on(0.25), *sets, **ENGAGED | options)
