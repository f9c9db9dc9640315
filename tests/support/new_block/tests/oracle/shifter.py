"""The Shifter a second time, from its description alone."""

from collections.abc import Mapping, Sequence
from typing import Any

COLUMNS = ("slave.position", "slave.velocity", "slave.acceleration")


def slave_position(master: float, offset: float, period: float) -> float:
    """Where the slave is with its master there."""
    return (master + offset) % period if period else master + offset


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The slave's motion at these times, for a master of constant velocity; at the time of a command, before it."""
    rows = []
    for time in times:
        master = script["master"].get("position", 0.0) + script["master"]["velocity"] * time
        position = slave_position(master, offset_at(script, time), script["start"].get("master.period", 0.0))
        velocity = script["master"]["velocity"]
        rows.append({"time": time, **dict(zip(COLUMNS, (position, velocity, 0.0), strict=True))})
    return rows


def offset_at(script: Mapping[str, Any], time: float) -> float:
    """The offset that the last accepted command before `time` has set."""
    limits = script["start"].get("least_offset", -100.0), script["start"].get("greatest_offset", 100.0)
    taken, given, level = 0.0, 0.0, False
    for values in sorted(script.get("set", []), key=lambda values: float(values["at"])):
        if values["at"] >= time:
            break
        given = values.get("offset", given)
        if values.get("apply", level) and not level and limits[0] <= given <= limits[1]:
            taken = given
        level = values.get("apply", level)
    return taken
