"""The FlyingSaw on random scripts is its oracle, with all that its function blocks and characteristics show."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

import pytest

from motionsync.flying_saw.block import FlyingSaw
from motionsync.master import MasterInput
from motionsync.motion.exceeded_limit import Limit
from motionsync_fmu.interface.recipe import declared_variables
from tests.model.flying_saw.harness import VELOCITY_CHECKS
from tests.oracle.flying_saw import reference
from tests.support.blocks.harness import MOTION, Row
from tests.support.blocks.oracle_runs import Script, find_differences, grid, simulate

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
PEAKS = ("check_max_acceleration", "check_max_deceleration", "check_max_jerk")
Order = tuple[dict[str, Any], tuple[str, ...]]
"""What is set, and the groups that get an edge."""


@dataclass(frozen=True)
class Leg:
    """The master's acceleration for a time, and what is set before; `groups` get an edge."""

    duration: float
    acceleration: float = 0.0
    values: Mapping[str, Any] = field(default_factory=dict)
    groups: tuple[str, ...] = ()


@dataclass(frozen=True)
class Course:
    """Legs one after the other; the slave's lengths are about `length`."""

    start: dict[str, Any]
    master_position: float
    speed: float
    legs: list[Leg]
    length: float

    def script(self, step: float, late: float) -> Script:
        """`late`: which share of its leg has passed when something is set."""
        segments = [{"duration": leg.duration, "acceleration": leg.acceleration} for leg in self.legs]
        sets, time, held = [], 0.0, ()
        for leg in self.legs:
            edges = dict.fromkeys((f"{group}.execute" for group in held), False)
            edges |= dict.fromkeys((f"{group}.execute" for group in leg.groups), True)
            if edges:
                sets.append({"at": time + late * leg.duration, **leg.values, **edges})
            held, time = leg.groups, time + leg.duration
        master = {"position": self.master_position, "velocity": self.speed, "segments": segments}
        return {"stop_time": time, "step_size": step, "start": self.start, "master": master, "set": sets}


def dyadic(rng: Random, low: float, high: float) -> float:
    return round(rng.uniform(low, high) * 256) / 256


BITS = ("check_max_velocity", *PEAKS, *VELOCITY_CHECKS, "prefer_constant_velocity", "ignore_master_acceleration")
KINDS = ("position", "velocity", "time", "own", "reversal", "time reversal", "distance", "encoder")


def random_course(rng: Random, kind: str) -> Course:
    """A slave in motion, a command, and a master that changes its velocity; then the slave's own motion."""
    length = rng.choice([1.0, 30.0, 500.0])
    speed, master_position = rng.choice([1.0, -1.0]) * length * rng.uniform(0.5, 2.0), length * rng.uniform(-3.0, 3.0)
    limits = {"velocity": 20.0, "acceleration": 60.0, "deceleration": 40.0, "jerk": 900.0}
    start: dict[str, Any] = {f"axis.max_{name}": length * limit for name, limit in limits.items()}
    start["axis.initial_position"] = length * rng.uniform(-1.0, 1.0)
    start["axis.initial_velocity"] = length * rng.choice([0.0, rng.uniform(-0.5, 0.5)])
    start |= {f"sync_mode.{name}": rng.random() < 0.15 for name in BITS}
    start["sync_mode.time_based"] = kind in ("time", "time reversal")
    legs = [Leg(0.25)]
    if kind == "own":
        return Course(start, master_position, speed, [*legs, *own_motions(rng, length), Leg(1.5)], length)
    if rng.random() < 0.3:  # the slave is accelerated when the command comes
        motion = {"velocity": rng.uniform(-1.0, 1.0), "acceleration": 3.0, "jerk": 30.0}
        values = {f"move_velocity.{name}": length * value for name, value in motion.items()}
        legs.append(Leg(dyadic(rng, 0.02, 0.2), 0.0, values, ("move_velocity",)))
    first = master_position + speed * sum(leg.duration for leg in legs)
    second = start["axis.initial_position"] + 0.25 * start["axis.initial_velocity"]
    if kind in ("velocity", "time", "time reversal"):
        command = to_velocity(rng, length, speed)
    else:
        command = to_position(rng, first, second, speed, kind == "distance")
    gain = 0.0
    if kind == "encoder":
        gain = speed * rng.uniform(-0.5, 0.5)
        cycle = rng.choice([0.001, 0.01])
        counts = 0.5 * abs(gain) * cycle**2 * rng.choice([0.5, 2.0])
        start |= {"master.sample_time": cycle, "master.encoder_scaling": counts}
    if kind == "time reversal":  # slow enough that the master turns before sync
        slow = {name: length * rng.uniform(0.3, 1.0) for name in ("acceleration", "deceleration")}
        command[0].update({f"gear_in_velo.{name}": limit for name, limit in slow.items()})
    legs.append(Leg(dyadic(rng, 0.05, 0.5), gain, *command))
    if kind in ("reversal", "time reversal"):
        start |= {f"sync_mode.{name}": rng.random() < 0.5 for name in ("rollback_lock", "instant_stop_on_rollback")}
        legs += reversal(rng, length, speed, legs[-1].duration)
    else:
        for _ in range(rng.randint(1, 4)):
            legs.append(Leg(dyadic(rng, 0.1, 0.6), speed * rng.choice([0.0, rng.uniform(-0.5, 1.0)])))
        legs.append(Leg(1.0))
    last = rng.choice(["gear_out", "halt", "stop", "move_absolute"])
    legs.append(Leg(0.25, length * rng.uniform(-0.3, 0.3), {"move_absolute.position": 0.0}, (last,)))
    return Course(start, master_position, speed, [*legs, Leg(0.75)], length)


def own_motions(rng: Random, length: float) -> list[Leg]:
    legs = []
    for group in rng.sample(["move_absolute", "move_velocity", "halt", "stop"], rng.randint(1, 4)):
        values = {
            "move_absolute.position": length * rng.uniform(-4.0, 4.0),
            "move_absolute.velocity": length * rng.uniform(0.5, 6.0),
            "move_absolute.jerk": length * rng.uniform(30.0, 900.0),
            "move_velocity.velocity": length * rng.uniform(-4.0, 4.0),
        }
        legs.append(Leg(dyadic(rng, 0.02, 1.0), length * rng.gauss(0.0, 1.0), values, (group,)))
    return legs


def to_velocity(rng: Random, length: float, speed: float) -> Order:
    ratio = rng.choice([1.0, 0.5, rng.uniform(0.3, 2.0)])
    values = {
        "ratio_numerator": ratio,
        "acceleration": length * rng.uniform(2.0, 20.0),
        "deceleration": length * rng.uniform(2.0, 20.0),
        "jerk": length * rng.uniform(20.0, 200.0),
        "velocity": rng.choice([0.0, 0.0, abs(ratio * speed) * rng.uniform(1.0, 1.3)]),
    }
    return {f"gear_in_velo.{name}": value for name, value in values.items()}, ("gear_in_velo",)


def to_position(rng: Random, master: float, slave: float, speed: float, later: bool) -> Order:
    """From about there to a point 0.5 to 1.5 s ahead, `later`: with a start distance."""
    ratio, ahead = rng.choice([1.0, 0.5, rng.uniform(0.3, 2.0)]), speed * rng.uniform(0.5, 1.5)
    values = {
        "ratio_numerator": ratio,
        "master_sync_position": master + ahead,
        "slave_sync_position": slave + ratio * ahead * rng.uniform(0.4, 1.5),
        "master_start_distance": abs(ahead) * rng.uniform(0.2, 0.8) if later else 0.0,
    }
    return {f"gear_in_pos.{name}": value for name, value in values.items()}, ("gear_in_pos",)


def reversal(rng: Random, length: float, speed: float, gone: float) -> list[Leg]:
    """After some time on, the master turns, goes back beyond where it came from, turns again and comes by."""
    on, turning = dyadic(rng, 0.01, 2.0), dyadic(rng, 0.3, 0.8)
    gain = -speed / turning * rng.uniform(1.5, 2.0)
    distance, back = abs(speed) * (gone + on + 0.5), max(abs(speed + gain * turning), 0.1 * length)
    legs = [Leg(on), Leg(turning, gain), Leg(dyadic(rng, 0.1, 1.0) + math.ceil(4.0 * distance / back) / 4.0)]
    return [*legs, Leg(2.0 * turning, -gain * rng.uniform(0.5, 1.0)), Leg(4.0)]


# --- scripts at the limits of the axis --------------------------------------------------------------------------------


GROUPS = ("gear_in_pos", "gear_in_velo", "move_absolute", "move_velocity", "halt", "gear_out")


def script_at_the_limits(r: Random) -> dict[str, Any]:
    """Commands to a slave whose axis has limits near to what they ask for; the master changes its velocity."""
    speed = r.choice((-1.0, 1.0)) * r.uniform(50.0, 500.0)
    start: dict[str, Any] = {
        "axis.initial_velocity": r.choice((0.0, 0.5 * speed, r.uniform(-1.0, 2.0) * speed)),
        "axis.max_velocity": abs(speed) * r.uniform(0.8, 3.0),
        "axis.max_acceleration": abs(speed) * r.uniform(1.0, 20.0),
        "axis.max_deceleration": abs(speed) * r.choice((0.0, r.uniform(1.0, 20.0))),
        "axis.max_jerk": abs(speed) * 10.0 ** r.uniform(1.0, 3.0),
        "axis.min_position": -abs(speed) * r.uniform(0.1, 3.0),
        "axis.max_position": abs(speed) * r.uniform(0.1, 3.0),
        "sync_mode.rollback_lock": r.random() < 0.5,
        "sync_mode.instant_stop_on_rollback": r.random() < 0.3,
        "sync_mode.prefer_constant_velocity": r.random() < 0.2,
        "sync_mode.check_undershoot_velocity": r.random() < 0.2,
        "sync_mode.check_max_jerk": r.random() < 0.2,
    }
    limits = ("min_position", "max_position", "max_velocity", "max_acceleration", "max_deceleration")
    start |= {f"sync_mode.check_{name}": r.random() < 0.3 for name in limits}
    segments = [{"duration": r.uniform(0.3, 1.0), "acceleration": speed * r.choice((0.0, 0.5, -2.0))} for _ in range(8)]
    sets: list[dict[str, Any]] = []
    for at in sorted(r.uniform(0.05, 4.0) for _ in range(3)):
        group = r.choice(GROUPS)
        sets.append({"at": at, **_order(r, group, speed, at), f"{group}.execute": True})
        sets.append({"at": at + 0.03, f"{group}.execute": False})
    master = {"velocity": speed, "segments": segments}
    return {"stop_time": 5.0, "step_size": r.choice([0.02, 0.5]), "start": start, "master": master, "set": sets}


def _order(r: Random, group: str, speed: float, at: float) -> dict[str, Any]:
    values: dict[str, Any] = {}
    if group == "gear_in_pos":
        values["master_sync_position"] = speed * (at + r.uniform(0.2, 2.0))
        values["slave_sync_position"] = speed * r.uniform(-0.5, 2.0)
    if group.startswith("gear_in"):
        values["ratio_numerator"] = r.choice((1.0, 1.0, 0.5, -1.5))
    if group == "move_absolute":
        values["position"] = speed * r.uniform(-1.0, 1.0)
    if group == "move_velocity":
        values["velocity"] = speed * r.uniform(-0.8, 0.8)
    if group in ("gear_in_velo", "gear_in_pos", "move_absolute", "move_velocity"):
        values["acceleration"] = abs(speed) * r.choice((0.0, 0.0, r.uniform(1.0, 30.0)))
        values["deceleration"] = abs(speed) * r.choice((0.0, 0.0, r.uniform(1.0, 30.0)))
    return {f"{group}.{name}": value for name, value in values.items()}


# --- the comparison ---------------------------------------------------------------------------------------------------

OUTPUTS = {v.name: v for v in declared_variables(FlyingSaw).values() if v.causality in ("output", "local")}
LIMITS = {"limit_exceeded", "local.exceeded_limit"}
PLACES = ("_at_slave_", "nominal")  # where an extreme is, which may be at several places


def tolerances(rows: list[Row], length: float, speed: float) -> Row:
    """Relative to the greatest values of the run; what is no Real is the same."""
    v, a, j = (max(abs(row[name]) for row in rows) for name in MOTION[1:])
    jerks = ("characteristics.slave_jerk_min", "characteristics.slave_jerk_max")
    v = max(v, abs(speed))
    a = a + v * v / length
    j = max(j + v**3 / length**2, *(abs(row[name]) for row in rows for name in jerks))
    sizes = {"momentum": v * a, "jerk": j, "acceleration": a, "deceleration": a, "velocity": v}

    def tolerance(name: str) -> float:
        if OUTPUTS[name].kind != "Real":
            return 0.0
        if any(place in name for place in PLACES):
            return math.inf
        return 1e-9 * next((size for quantity, size in sizes.items() if quantity in name), length)

    return {name: tolerance(name) for name in rows[0] if name != "time"}


def assert_as_the_oracle(
    script: Script, mode: MasterInput, length: float, left_out: set[str] = frozenset()
) -> list[Row]:
    """At the ends of the script's steps; the rows of the block."""
    (first, *_) = reference(script, [0.0])
    names = [name for name in first if name in OUTPUTS and name not in left_out]
    ends = grid(script, script["step_size"])
    rows = simulate(FlyingSaw(), script, ends, names, mode=mode, recorded=ends)
    allowed = tolerances(rows, length, script["master"]["velocity"])
    assert find_differences(reference, script, rows, allowed) == [], script
    return rows


@pytest.mark.slow
@pytest.mark.parametrize("mode", [START, END])
@pytest.mark.parametrize("kind", KINDS)
def test_the_block_is_its_oracle(kind: str, mode: MasterInput) -> None:
    """With inputs of the step's end nothing is set where the master's acceleration jumps, of which they know nothing;
    limits show some steps later then, or not at all."""
    for seed in range(54):
        rng = Random(f"{seed}{kind}")
        course = random_course(rng, kind)
        script = course.script(rng.choice([2.0**-6, 0.125, 0.5]), 0.25 if mode == END else 0.0)
        size = course.length + 1e-4 * abs(course.master_position)
        assert_as_the_oracle(script, mode, size, LIMITS if mode == END or "reversal" in kind else set())


@pytest.mark.slow
def test_at_the_limits_of_the_axis_the_block_is_its_oracle() -> None:
    """Together the runs exceed every limit; a stop at once has scenarios of its own."""
    met: set[float] = set()
    for seed in range(256):
        script = script_at_the_limits(Random(seed))
        rows = assert_as_the_oracle(script, START, abs(script["master"]["velocity"]))
        met |= {row["local.exceeded_limit"] for row in rows}
    assert met >= set(Limit) - {Limit.INSTANT_STOP}
