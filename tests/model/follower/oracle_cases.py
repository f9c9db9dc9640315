"""Scripts for the Follower's oracle, and what is read of its rows and events."""

from typing import Any

import pytest

from tests.oracle.follower import events, reference

IN_ALARM, IDLE, POSITIONING, WAITING, NEXT_CYCLE, FOLLOWING = -1.0, 1.0, 2.0, 3.0, 4.0, 5.0
SYNCHRONIZED, DECEL, HOMING = 8.0, 9.0, 10.0

PARK = {"at": 0.5, "position_to_park": True}
CYCLIC = {"slave_cycle": 400.0}
ON_AND_ON = {"slave_cycle": 400.0, "stop_in_park": False}
VARIABLE = {"variable_cycle": True}
RECOVER = {**ON_AND_ON, **VARIABLE, "recover_late_sync": True}


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


def scenario(
    segments: list[dict[str, float]], *sets: dict[str, Any], position: float = 0.0, **start: Any
) -> dict[str, Any]:
    """A scenario of the segments' length, in steps of 10 ms; names have `__` for a dot; the meeting is at 500."""
    dotted = {name.replace("__", "."): value for name, value in ({"sync_master": 500.0} | start).items()}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": dotted,
        "master": {"position": position, "velocity": segments[0].get("velocity", 0.0), "segments": segments},
        "set": [{name.replace("__", "."): value for name, value in table.items()} for table in sets],
    }


def steady(*sets: dict[str, Any], duration: float = 30.0, velocity: float = 100.0, **options: Any) -> dict[str, Any]:
    """Positioned to park at 0.5 s, the master at 100 u/s from 0: it is at 100·t."""
    return scenario([{"duration": duration, "velocity": velocity}], PARK, *sets, **options)


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float]:
    return row["slave.position"], row["slave.velocity"], row["slave.acceleration"]


def shown(given: dict[str, Any], time: float) -> tuple[float, Any]:
    row = at(given, time)
    return row["state"], close(row["slave.position"])


def named(given: dict[str, Any], *names: str) -> list[float]:
    return [time for time, event in events(given) if event in names]


def to_go(row: dict[str, float]) -> list[float]:
    return [row[f"master_to_{point}"] for point in ("start", "sync", "out")]
