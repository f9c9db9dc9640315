"""Random scripts of a master with commands, the Synchronizer's run along one, and its comparison with the oracle."""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from itertools import pairwise
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.faults import Refusal
from tests.model.synchronizer.harness import END, ONLY, write
from tests.oracle import mp
from tests.oracle.master import Stretch, stretches
from tests.oracle.synchronizer import reference

Row = dict[str, float]
MOTION = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")
WRAPPED = ("slave.position", "local.ramp_begin", "local.ramp_end")
LENGTHS = ("local.distance_to_begin", "local.distance_to_end", "local.transition_distance")
CODES = (
    *("state_code", "ready", "synchronized", "syn_synchronized", "syn_ramp_on"),
    *("status", "error", "error_id"),
)
PEAKS = ("local.peak_acceleration_per_v2", "local.peak_jerk_per_v3")
OUTPUTS = (*MOTION, *CODES, *WRAPPED[1:], "local.progress", *LENGTHS, *PEAKS)


def read(block: Synchronizer) -> Row:
    row = {}
    for name in OUTPUTS:
        value: Any = block
        for step in name.split("."):
            value = getattr(value, step)
        row[name] = float(value)
    return row


class Feed:
    """What a simulator would set at the master's inputs: exact values of the script, rounded once."""

    def __init__(self, scenario: Mapping[str, Any]) -> None:
        self.stretches = stretches(scenario["master"], mp.mpf(scenario["stop_time"]) + 1)
        self.begin_times = [stretch.begin for stretch in self.stretches]
        self.period = mp.mpf(scenario["start"].get("master.period", 0))

    def stretch(self, time: Any, after: bool) -> Stretch:
        """The stretch at `time`; where two meet the one after or before."""
        index = bisect_right(self.begin_times, time) - 1
        return self.stretches[index if after or self.begin_times[index] < time else index - 1]

    def set_master(self, block: Synchronizer, at: float, *, after: bool) -> None:
        time = mp.mpf(at)
        motion = self.stretch(time, after).at(time)
        position = motion.position
        if self.period:
            position -= mp.floor(position / self.period) * self.period
        block.master.position = float(position)
        if block.master.input_mode != ONLY:
            block.master.velocity, block.master.acceleration = float(motion.velocity), float(motion.acceleration)


def play(
    scenario: Mapping[str, Any], boundaries: Sequence[float], mode: MasterInput, retained: set[float]
) -> dict[float, Row]:
    """The block's outputs at the kept boundaries of its steps."""
    block, feed = Synchronizer(), Feed(scenario)
    write(block, {**scenario["start"], "master.input_mode": mode})
    feed.set_master(block, 0.0, after=True)
    assert block.initialize() == Refusal.NONE
    rows = {0.0: read(block)} if 0.0 in retained else {}
    sets: dict[float, dict[str, Any]] = {}
    for table in scenario["set"]:
        sets.setdefault(table["at"], {}).update({name: value for name, value in table.items() if name != "at"})
    for begin, end in pairwise(boundaries):
        write(block, sets.get(begin, {}))
        if mode == END:
            feed.set_master(block, end, after=False)
        else:
            feed.set_master(block, begin, after=True)
        assert block.step(end - begin) == Refusal.NONE
        if end in retained:
            rows[end] = read(block)
    return rows


def corners(scenario: Mapping[str, Any]) -> set[float]:
    """The times at which a step must end: sets and segment boundaries."""
    result, time = {0.0, scenario["stop_time"]}, 0.0
    for segment in scenario["master"]["segments"]:
        time += segment["duration"]
        result.add(time)
    return result | {table["at"] for table in scenario["set"]}


def every(h: float, scenario: Mapping[str, Any]) -> set[float]:
    return {k * h for k in range(math.ceil(scenario["stop_time"] / h))}


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


def differences(row: Row, expected: Sequence[Row], tolerances: Row, period: float) -> list[str]:
    """Columns of `row` that are neither at nor between the expected ones; positions may differ by whole periods."""
    bad = []
    for name, tolerance in tolerances.items():
        value, allowed = row[name], [other[name] for other in expected]
        if period > 0.0 and name in WRAPPED:
            is_allowed = any(abs(math.remainder(value - other, period)) <= tolerance for other in allowed)
            is_allowed = is_allowed and 0.0 <= value < period
        else:
            is_allowed = min(allowed) - tolerance <= value <= max(allowed) + tolerance
        if not is_allowed:
            bad.append(f"{name} is {value!r}, not {allowed}")
    return bad


def compute_expected(scenario: Mapping[str, Any], times: Sequence[float]) -> dict[float, list[Row]]:
    rows: dict[float, list[Row]] = {}
    for row in reference(scenario, times):
        rows.setdefault(row["time"], []).append(row)
    return rows


def assert_as_oracle(
    scenario: Mapping[str, Any], rows: Mapping[float, Row], expected: Mapping[float, list[Row]], tolerances: Row
) -> None:
    period = float(scenario["start"].get("master.period", 0.0))
    for time, row in rows.items():
        assert not differences(row, expected[time], tolerances, period), (time, scenario)


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


def scripted(rng: Random, *, jumps: bool = True, single: bool = False, sound: bool = False) -> dict[str, Any]:
    """A master that mostly moves in one direction, and commands mostly for this direction; most stops are in time.

    `jumps`: of the velocity; `single`: one acceleration; `sound`: no command is refused and nothing deactivated."""
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
            bad = [] if sound else [rng.choice([0.0, 1e-10, -1e13, math.inf])]
            table["output_phasing"] = rng.choice([phasing(), phasing(), phasing(), *bad])
        if rng.random() < 0.15 and not sound:
            table["active"] = rng.random() < 0.6
        sets += [table, {"at": at + 0.01, "start": False, "stop": False}]
    start = {"curve": rng.choice([1, 2]), "output_phasing": phasing(), "master.period": period}
    if not sound:
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
