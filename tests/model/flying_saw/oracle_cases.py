"""Plans and scripts for the tests of the FlyingSaw's oracle, and what the tests read from them."""

import random
from typing import Any

import pytest

from tests.oracle.flying_saw import events, reference
from tests.oracle.flying_saw_plan import (
    Plan,
)

INACTIVE, CONSTANT_VELOCITY, ACCELERATING, DECELERATING = 0.0, 3.0, 4.0, 5.0
PREPHASE, SYNCHRONIZING, SYNCHRON = 11.0, 12.0, 13.0
STANDSTILL, DISCRETE_MOTION, CONTINUOUS_MOTION, SYNCHRONIZED_MOTION, STOPPING = 1.0, 2.0, 3.0, 4.0, 5.0


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


EXAMPLE_4_1: dict[str, Any] = {
    "mode": "gear_in_pos",
    "master": (-500, 500, 0),
    "slave": (-250, 250, 0),
    "factor": 1,
    "limits": (2000, 2500, 2500, 5000),
    "sync": (1000, 1000),
}
EXAMPLE_4_2: dict[str, Any] = {
    "mode": "gear_in_pos",
    "master": (-500, 500, 0),
    "slave": (-500, -250, 0),
    "factor": 1.5,
    "limits": (2000, 10000, 10000, 50000),
    "sync": (1000, 500),
}
EXAMPLE_3: dict[str, Any] = {
    "mode": "gear_in_velo",
    "master": (0, 500, 0),
    "slave": (0, -250, 0),
    "factor": 1,
    "limits": (2000, 2500, 2500, 5000),
}
VELOCITY_CHECKS = ("check_overshoot_velocity", "check_undershoot_velocity")


def values(planned: Plan, *names: str) -> list[float]:
    result = planned.characteristics
    return [float(result[name]) for name in names]


def limits_of(planned: Plan, quantity: str) -> list[float]:
    return values(planned, f"slave_{quantity}_min", f"slave_{quantity}_max")


def random_plan(chance: random.Random, mode: str, **changes: Any) -> dict[str, Any]:
    """A plan of any state, mostly accepted; gear_in_pos meets ahead."""
    direction, factor = chance.choice([1, -1]), chance.choice([1, -1]) * 10 ** chance.uniform(-1, 1)
    velocity, time = direction * 10 ** chance.uniform(1, 3), 10 ** chance.uniform(-0.5, 1)
    accelerated = chance.random() < 0.5
    master = (chance.uniform(-500, 500), velocity, chance.uniform(-1, 1) * 0.2 * abs(velocity) if accelerated else 0.0)
    slow = chance.uniform(-1.5, 1.5) * factor * velocity
    slave = (chance.uniform(-500, 500), slow, chance.uniform(-1, 1) * abs(slow) if accelerated else 0.0)
    sync = (master[0] + velocity * time, slave[0] + factor * velocity * time * chance.uniform(0.2, 1.5))
    scale = abs(factor * velocity)
    limits = tuple(scale * 10 ** chance.uniform(*ends) for ends in ((0.2, 0.6), (-0.3, 1), (-0.3, 1), (0, 2)))
    given = {"mode": mode, "master": master, "slave": slave, "factor": factor, "limits": limits, "sync": sync}
    return given | changes


def mirrored(given: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The same with the slave's direction reversed."""
    result = given | {"slave": tuple(-x for x in given["slave"]), "factor": -given["factor"]} | changes
    return result | {"sync": (given["sync"][0], -given["sync"][1])}


def scenario(
    segments: list[dict[str, float]], *sets: dict[str, Any], position: float = 0.0, **start: Any
) -> dict[str, Any]:
    """A scenario of the segments' length; names in `start` and in the sets have `__` for a dot."""
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": {name.replace("__", "."): value for name, value in start.items()},
        "master": {"position": position, "velocity": segments[0].get("velocity", 0.0), "segments": segments},
        "set": [{name.replace("__", "."): value for name, value in one.items()} for one in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    return scenario([{"duration": duration, "velocity": velocity}], *sets, **options)


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`, but for what is set then."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float]:
    return row["slave.position"], row["slave.velocity"], row["slave.acceleration"]


def shows(row: dict[str, float], group: str) -> set[str]:
    """The Boolean outputs of a group that are true."""
    names = (name for name in row if name.startswith(f"{group}.") and not name.endswith("error_id"))
    return {name.partition(".")[2] for name in names if row[name]}


def named(given: dict[str, Any], name: str) -> list[float]:
    return [time for time, event in events(given) if event == name]


MEET = {"gear_in_pos__master_sync_position": 1000.0, "gear_in_pos__slave_sync_position": 1000.0}
MOVING = {"axis__initial_position": -375.0, "axis__initial_velocity": 250.0}


def example(*sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """TS5055 section 4 example 1: gear_in_pos at 0.5 s, in sync at 3.5 s."""
    first = {"at": 0.5, "gear_in_pos__execute": True}
    return steady(500.0, 6.0, first, *sets, **{"position": -750.0} | MOVING | MEET | options)


AXIS = {
    "axis__max_velocity": 100.0,
    "axis__max_acceleration": 200.0,
    "axis__max_deceleration": 200.0,
    "axis__max_jerk": 1000.0,
}


def alone(duration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    return steady(0.0, duration, *sets, **AXIS | options)


TIMED = {"sync_mode__time_based": True, "gear_in_velo__acceleration": 500.0, "gear_in_velo__deceleration": 500.0}


def timed(segments: list[dict[str, float]], **options: Any) -> dict[str, Any]:
    """gear_in_velo at 0.5 s from rest."""
    return scenario(
        segments, {"at": 0.5, "gear_in_velo__execute": True}, **TIMED | {"gear_in_velo__jerk": 5000.0} | options
    )
