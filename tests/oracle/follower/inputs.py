"""The inputs of the Follower as its oracle reads them, and the ends of the steps at which limits are checked."""

from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

STILL = mp.mpf("1e-12")
"""Velocity, acceleration (u/s, u/s2) and, relatively, distance from a target below which they are 0."""

TUNABLE = {
    "master_cycle": 1000.0,
    "park_slave": 0.0,
    "sync_slave": 100.0,
    "sync_out": 300.0,
    "space_stop_slave": 100.0,
    "space_wait_in_park": 0.0,
    "k_slave_master": 1.0,
    "max_speed": 0.0,
    "max_acceleration": 0.0,
    "check_speed": True,
    "check_acceleration": True,
    "positioning.velocity": 500.0,
    "positioning.acceleration": 5000.0,
    "positioning.jerk": 50000.0,
}
EDGES = ("position_to_park", "position_to_cycle", "end_synchronism", "reset")
LEVELS = ("skip_next_cycle", "stop_after_forward", "sync_assumed")
SETTABLE: dict[str, Any] = {**TUNABLE, "sync_master": 0.0, **dict.fromkeys((*EDGES, *LEVELS), False)}
FIXED: dict[str, Any] = {
    "variable_cycle": False,
    "slave_cycle": 0.0,
    "align_center": False,
    "stop_in_park": True,
    "recover_late_sync": False,
    "slave.initial_position": 0.0,
    "master.period": 0.0,
}


def snapped(time: Number, breaks: Sequence[Number]) -> Number:
    """The break of the master's script that is meant by a time, else the time itself."""
    return next((b for b in breaks if abs(b - time) <= STILL * (1 + time)), time)


def has_limits(script: Mapping[str, Any]) -> bool:
    """Whether there is ever a limit to be checked at the ends of the steps."""
    tables = (script.get("start", {}), *script.get("set", ()))
    return any(table.get(name) for table in tables for name in ("max_speed", "max_acceleration"))


def step_ends(script: Mapping[str, Any], horizon: Number) -> list[Number]:
    """The ends of the steps up to the scenario's end."""
    stop, step = float(script["stop_time"]), float(script["step_size"])
    points = [i * step for i in range(1, int(stop / step * (1 + 1e-12)) + 1)]
    points += [float(table[key]) for table in script.get("expect", ()) for key in ("at", "from", "to") if key in table]
    breaks = accumulate(mp.mpf(segment["duration"]) for segment in script["master"].get("segments", ()))
    return [end for end in {*(mp.mpf(point) for point in {*points, stop}), *breaks} if 0 < end <= horizon]
