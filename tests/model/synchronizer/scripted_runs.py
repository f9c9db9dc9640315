"""Random scripts of a master with commands, and the comparison of the Synchronizer with its oracle along one."""

import math
from collections.abc import Iterable, Mapping
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.block import Synchronizer
from tests.oracle.master import stretches
from tests.oracle.numerics import mp
from tests.oracle.synchronizer import reference
from tests.support.blocks.harness import MOTION, Row
from tests.support.blocks.oracle_runs import Script, find_differences, simulate

WRAPPED = ("slave.position", "local.ramp_begin", "local.ramp_end")
LENGTHS = ("local.distance_to_begin", "local.distance_to_end", "local.transition_distance")
CODES = (
    *("state_code", "ready", "synchronized", "syn_synchronized", "syn_ramp_on"),
    *("status", "error", "error_id"),
)
PEAKS = ("local.peak_acceleration_per_v2", "local.peak_jerk_per_v3")
OUTPUTS = (*MOTION, *CODES, *WRAPPED[1:], "local.progress", *LENGTHS, *PEAKS)


class Scales:
    """The sizes to which errors are relative: the shortest phasing, the greatest velocity and acceleration."""

    def __init__(self, scenario: Mapping[str, Any]) -> None:
        phasings = [table.get("output_phasing", 0.0) for table in (scenario["start"], *scenario["set"])]
        self.length = min(abs(phasing) for phasing in phasings if 1e-9 <= abs(phasing) <= 1e12)
        moved = [
            s.at(t) for s in stretches(scenario["master"], mp.mpf(scenario["stop_time"])) for t in (s.begin, s.end)
        ]
        self.velocity = max(1e-3 * self.length, *(float(abs(motion.velocity)) for motion in moved))
        self.acceleration = max(float(abs(motion.acceleration)) for motion in moved)
        self.master_position = max(float(abs(motion.position)) for motion in moved)
        self.period = float(scenario["start"].get("master.period", 0.0))

    def tolerances(self, relative: float = 1e-9, velocity: float = 0.0, acceleration: float = 0.0) -> Row:
        """`velocity`, `acceleration`: what the inputs themselves leave uncertain."""
        l, v, a = self.length, self.velocity, self.acceleration  # noqa: E741
        tolerances = dict.fromkeys(CODES, 0.0) | dict.fromkeys((*WRAPPED, *LENGTHS), relative * l)
        tolerances["slave.velocity"] = relative * v + velocity
        tolerances["slave.acceleration"] = relative * (a + v * v / l) + acceleration + 4 * velocity * v / l
        tolerances["slave.jerk"] = relative * (v**3 / l**2 + 3 * v * a / l)
        tolerances["slave.jerk"] += 8 * (velocity * v**2 / l**2 + velocity * a / l + acceleration * v / l)
        tolerances["local.progress"] = relative
        tolerances |= {PEAKS[0]: 1e-12 / l, PEAKS[1]: 1e-12 / l**2}
        return tolerances


def assert_as_oracle(
    scenario: Script, ends: Iterable[float], mode: MasterInput, times: set[float], tolerances: Row
) -> None:
    """In steps that end at `ends` and where the script needs it, at these times."""
    rows = simulate(Synchronizer(), scenario, ends, OUTPUTS, mode=mode, recorded=times)
    periods = dict.fromkeys(WRAPPED, float(scenario["start"].get("master.period", 0.0)))
    assert find_differences(reference, scenario, rows, tolerances, periods) == [], scenario


PERIODS = [0.0, 0.0, 0.0, 0.1, 0.7, 6.2, 7.7, 31.4, 360.0]


def random_segments(rng: Random, reach: float, jumps: bool, single: bool) -> list[dict[str, float]]:
    """What the master does; `reach`: how far it comes in about a second, with the sign of its direction."""
    kinds = ["acceleration", "acceleration", "steady", *(["velocity", "velocity", "stand"] if jumps else [])]
    segments: list[dict[str, float]] = []
    for _ in range(1 if single else rng.randint(1, 5)):
        segment = {"duration": 3.0 if single else rng.randint(64, 1024) / 1024.0}
        match "acceleration" if single else rng.choice(kinds):
            case "acceleration":
                segment["acceleration"] = reach * rng.uniform(-3.0, 3.0) * (0.3 if single else 1.0)
            case "velocity":
                segment["velocity"] = reach * rng.uniform(-1.0, 2.0)
            case "stand":
                segment["velocity"] = 0.0
        segments.append(segment)
    return segments


def scripted(rng: Random, *, jumps: bool = True, single: bool = False) -> dict[str, Any]:
    """A master that mostly moves in one direction, and commands mostly for this direction; most stops are in time.

    `jumps`: of the velocity; `single`: one acceleration."""
    span, direction = rng.choice([1.0, 10.0, 60.0]), rng.choice([1.0, -1.0])
    period = 0.0 if single else rng.choice(PERIODS)
    segments = random_segments(rng, span * direction, jumps, single)
    stop_time = sum(segment["duration"] for segment in segments)
    master_position, speed = direction * span * rng.uniform(-1.0, 0.2), direction * span * rng.uniform(-0.5, 1.5)
    master = {"position": master_position, "velocity": speed, "segments": segments}
    path = stretches(master, mp.mpf(stop_time))

    def phasing() -> float:
        sizes = [span * rng.uniform(0.06, 0.3), span * rng.uniform(0.06, 0.3), span * rng.uniform(0.06, 2.0)]
        if period > 0.06 * span:
            sizes += [0.5 * period, 0.5 * period, 1.5 * period]
        return direction * rng.choice([1.0, 1.0, 1.0, -1.0]) * rng.choice(sizes)

    sets: list[dict[str, Any]] = []
    for _ in range(rng.randint(1, 7)):
        at = rng.uniform(0.2 if single else 0.0, 1.0) * (stop_time - 0.02)
        table: dict[str, Any] = {"at": at, **{name: True for name in ("start", "stop") if rng.random() < 0.5}}
        if rng.random() < 0.8:
            reached = float(next(stretch for stretch in path if stretch.end >= at).at(at).position)
            table["rest_value"] = reached + direction * span * rng.choice([0.1, 0.3, 1.0]) * rng.uniform(-0.2, 2.0)
        if rng.random() < 0.3:
            bad = [rng.choice([0.0, 1e-10, -1e13, math.inf])]
            table["output_phasing"] = rng.choice([phasing(), phasing(), phasing(), *bad])
        if rng.random() < 0.15:
            table["active"] = rng.random() < 0.6
        sets += [table, {"at": at + 0.01, "start": False, "stop": False}]
    start = {"curve": rng.choice([1, 2]), "output_phasing": phasing(), "master.period": period}
    start |= {"active": rng.random() < 0.8, "start": rng.random() < 0.2}
    sets.sort(key=lambda each: each["at"])
    return {"stop_time": stop_time, "start": start, "master": master, "set": sets}


def scripts(**options: bool) -> st.SearchStrategy[dict[str, Any]]:
    return st.randoms(use_true_random=True).map(lambda rng: scripted(rng, **options))


parts = st.lists(st.floats(0.001, 0.999), min_size=3, max_size=40)


def coinciding(rng: Random) -> dict[str, Any]:
    """Whole numbers and dyadic times: starts, ends, turning points, sets and step boundaries coincide exactly."""
    segments: list[dict[str, float]] = []
    for _ in range(rng.randint(1, 6)):
        segment: dict[str, float] = {"duration": rng.choice([0.5, 1.0, 2.0])}
        kind = rng.randint(0, 3)
        if kind > 1:
            segment["acceleration"] = rng.choice([-8.0, -4.0, -2.0, 2.0, 4.0, 8.0])
        elif kind == 1:
            segment["velocity"] = rng.choice([-8.0, -4.0, 0.0, 4.0, 8.0, 16.0])
        segments.append(segment)
    stop_time = sum(segment["duration"] for segment in segments)
    phasings = [2.0, 4.0, 8.0, 16.0, -2.0, -4.0, -8.0, -16.0]
    sets: list[dict[str, Any]] = []
    for _ in range(rng.randint(1, 6)):
        table: dict[str, Any] = {"at": rng.randint(1, int(4 * stop_time) - 1) / 4}
        table |= rng.choice([{"start": True}, {"stop": True}, {"start": True, "stop": True}])
        table |= {"rest_value": 2.0 * rng.randint(-6, 6), "output_phasing": rng.choice(phasings)}
        sets += [table, {"at": table["at"] + 0.125, "start": False, "stop": False}]
    period, curve = rng.choice([0.0, 0.0, 4.0, 8.0, 16.0]), rng.choice([1, 2])
    master_position, speed = float(rng.randint(-16, 16)), rng.choice([-8.0, -4.0, 0.0, 4.0, 8.0])
    return {
        "stop_time": stop_time,
        "start": {"curve": curve, "output_phasing": rng.choice(phasings), "master.period": period},
        "master": {"position": master_position, "velocity": speed, "segments": segments},
        "set": sorted(sets, key=lambda each: each["at"]),
    }
