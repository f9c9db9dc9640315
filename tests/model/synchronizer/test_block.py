"""The Synchronizer, stepped directly: against its oracle on random scripts, and rule by rule with numbers by hand."""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import fields
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.faults import Refusal
from motionsync.synchronizer.interface import Curve, State
from tests.model.synchronizer.known_ramps import KNOWN_RAMPS
from tests.oracle.master import Stretch, mp, stretches
from tests.oracle.synchronizer import events, reference
from tests.support.numbers import numbers_in

settings.register_profile("synchronizer", derandomize=True, deadline=None, max_examples=250)
repeatable = settings.get_profile("synchronizer")

PARABOLA, POLYNOMIAL = Curve.PARABOLA, Curve.POLYNOMIAL_3_4_5
START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
READY, EXECUTING, STACKED = State.READY, State.EXECUTING, State.STACKED
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


# --- the block along a scripted master --------------------------------------------------------------------------------


def write(block: Synchronizer, values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        *path, last = name.split(".")
        part: Any = block
        for step in path:
            part = getattr(part, step)
        setattr(part, last, type(getattr(part, last))(value))


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
        self.begins = [stretch.begin for stretch in self.stretches]
        self.period = mp.mpf(scenario["start"].get("master.period", 0))

    def stretch(self, time: Any, after: bool) -> Stretch:
        """The stretch at `time`; where two meet the one after or before."""
        index = bisect_right(self.begins, time) - 1
        return self.stretches[index if after or self.begins[index] < time else index - 1]

    def put(self, block: Synchronizer, at: float, *, after: bool) -> None:
        time = mp.mpf(at)
        motion = self.stretch(time, after).at(time)
        position = motion.position
        if self.period:
            position -= mp.floor(position / self.period) * self.period
        block.master.position = float(position)
        if block.master.input_mode != ONLY:
            block.master.velocity, block.master.acceleration = float(motion.velocity), float(motion.acceleration)


def play(
    scenario: Mapping[str, Any], boundaries: Sequence[float], mode: MasterInput, kept: set[float]
) -> dict[float, Row]:
    """The block's outputs at the kept boundaries of its steps."""
    block, feed = Synchronizer(), Feed(scenario)
    write(block, {**scenario["start"], "master.input_mode": mode})
    feed.put(block, 0.0, after=True)
    assert block.initialize() == Refusal.NONE
    rows = {0.0: read(block)} if 0.0 in kept else {}
    sets: dict[float, dict[str, Any]] = {}
    for table in scenario["set"]:
        sets.setdefault(table["at"], {}).update({name: value for name, value in table.items() if name != "at"})
    for begin, end in pairwise(boundaries):
        write(block, sets.get(begin, {}))
        if mode == END:
            feed.put(block, end, after=False)
        else:
            feed.put(block, begin, after=True)
        assert block.step(end - begin) == Refusal.NONE
        if end in kept:
            rows[end] = read(block)
    return rows


def corners(scenario: Mapping[str, Any]) -> set[float]:
    """The times at which a step must end: sets and segment boundaries."""
    found, time = {0.0, scenario["stop_time"]}, 0.0
    for segment in scenario["master"]["segments"]:
        time += segment["duration"]
        found.add(time)
    return found | {table["at"] for table in scenario["set"]}


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
        self.place = max(float(abs(motion.position)) for motion in moved)
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


def differences(row: Row, wanted: Sequence[Row], tolerances: Row, period: float) -> list[str]:
    """Columns of `row` that lie neither at nor between the wanted ones; positions may differ by whole periods."""
    bad = []
    for name, tolerance in tolerances.items():
        value, allowed = row[name], [other[name] for other in wanted]
        if period > 0.0 and name in WRAPPED:
            good = any(abs(math.remainder(value - other, period)) <= tolerance for other in allowed)
            good = good and 0.0 <= value < period
        else:
            good = min(allowed) - tolerance <= value <= max(allowed) + tolerance
        if not good:
            bad.append(f"{name} is {value!r}, not {allowed}")
    return bad


def wanted(scenario: Mapping[str, Any], times: Sequence[float]) -> dict[float, list[Row]]:
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


# --- random scripts ---------------------------------------------------------------------------------------------------

PERIODS = [0.0, 0.0, 0.0, 0.1, 0.7, 6.2, 7.7, 31.4, 360.0]


def scripted(rng: Random, *, jumps: bool = True, single: bool = False, sound: bool = False) -> dict[str, Any]:
    """A master that mostly goes one way, and mostly commands for this way; evenly spread, so that much happens.

    `jumps`: of the velocity; `single`: one acceleration throughout; `sound`: no command is refused and nothing
    deactivated. Most stops are given in time.
    """
    span, way = rng.choice([1.0, 10.0, 60.0]), rng.choice([1.0, -1.0])
    period = 0.0 if single else rng.choice(PERIODS)
    kinds = ["acceleration", "acceleration", "steady", *(["velocity", "velocity", "stand"] if jumps else [])]
    segments: list[dict[str, float]] = []
    for _ in range(1 if single else rng.randint(1, 5)):
        segment = {"duration": 3.0 if single else rng.randint(64, 1024) / 1024.0}
        match "acceleration" if single else rng.choice(kinds):
            case "acceleration":
                segment["acceleration"] = way * span * rng.uniform(-3.0, 3.0) * (0.3 if single else 1.0)
            case "velocity":
                segment["velocity"] = way * span * rng.uniform(-1.0, 2.0)
            case "stand":
                segment["velocity"] = 0.0
        segments.append(segment)
    stop_time = sum(segment["duration"] for segment in segments)
    place, speed = way * span * rng.uniform(-1.0, 0.2), way * span * rng.uniform(-0.5, 1.5)
    master = {"position": place, "velocity": speed, "segments": segments}
    path = stretches(master, mp.mpf(stop_time))

    def phasing() -> float:
        sizes = [span * rng.uniform(0.06, 0.3), span * rng.uniform(0.06, 0.3), span * rng.uniform(0.06, 2.0)]
        if period > 0.06 * span:
            sizes += [0.5 * period, 0.5 * period, 1.5 * period]
        return way * rng.choice([1.0, 1.0, 1.0, -1.0]) * rng.choice(sizes)

    sets: list[dict[str, Any]] = []
    for _ in range(rng.randint(1, 7)):
        at = rng.uniform(0.2 if single else 0.0, 1.0) * (stop_time - 0.02)
        table: dict[str, Any] = {"at": at, **{name: True for name in ("start", "stop") if rng.random() < 0.5}}
        if rng.random() < 0.8:
            reached = float(next(stretch for stretch in path if stretch.end >= at).at(at).position)
            table["rest_value"] = reached + way * span * rng.choice([0.1, 0.3, 1.0]) * rng.uniform(-0.2, 2.0)
        if rng.random() < 0.3:
            bad = [] if sound else [rng.choice([0.0, 1e-10, -1e13, math.inf])]
            table["output_phasing"] = rng.choice([phasing(), phasing(), phasing(), *bad])
        if rng.random() < 0.15 and not sound:
            table["active"] = rng.random() < 0.6
        sets += [table, {"at": at + 0.01, "start": False, "stop": False}]
    start = {"curve": rng.choice([1, 2]), "output_phasing": phasing(), "master.period": period}
    if not sound:
        start |= {"active": rng.random() < 0.8, "start": rng.random() < 0.2}
    return {
        "stop_time": stop_time,
        "start": start,
        "master": master,
        "set": sorted(sets, key=lambda each: each["at"]),
    }


def scripts(**options: bool) -> st.SearchStrategy[dict[str, Any]]:
    return st.randoms(use_true_random=True).map(lambda rng: scripted(rng, **options))


parts = st.lists(st.floats(0.001, 0.999), min_size=3, max_size=40)


@repeatable
@given(scripts(), parts, st.integers(1, 8))
def test_with_inputs_of_the_step_s_start_the_block_is_its_oracle(
    scenario: dict[str, Any], cuts: list[float], often: int
) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    boundaries = times | every(scenario["stop_time"] / often, scenario)
    rows = play(scenario, sorted(boundaries), START, times)
    assert_as_oracle(scenario, rows, wanted(scenario, sorted(times)), Scales(scenario).tolerances())


@repeatable
@given(scripts(jumps=False), parts)
def test_with_inputs_of_the_step_s_end_the_block_is_its_oracle(scenario: dict[str, Any], cuts: list[float]) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    rows = play(scenario, sorted(times), END, times)
    assert_as_oracle(scenario, rows, wanted(scenario, sorted(times)), Scales(scenario).tolerances())


@repeatable
@given(scripts(single=True), st.sampled_from([0.05, 0.031, 0.1]))
def test_with_positions_only_the_block_is_its_oracle(scenario: dict[str, Any], h: float) -> None:
    """Once the velocity is known, after three samples; velocity and acceleration as exact as differences allow."""
    times = {time for time in corners(scenario) if time > 0.4} | {k * 0.25 for k in range(2, 13)}
    boundaries = sorted(corners(scenario) | every(h, scenario) | times)
    shortest = min(b - a for a, b in pairwise(boundaries))
    assume(shortest > 1e-3)
    scales = Scales(scenario)
    velocity = 32 * 2.0**-53 * (scales.place + scales.velocity) / shortest
    tolerances = scales.tolerances(velocity=velocity, acceleration=4 * velocity / shortest)
    rows = play(scenario, boundaries, ONLY, times)
    assert_as_oracle(scenario, rows, wanted(scenario, sorted(times)), tolerances)


@settings(repeatable, max_examples=60)
@given(scripts(), parts, parts)
def test_the_step_size_changes_nothing(scenario: dict[str, Any], cuts: list[float], irregular: list[float]) -> None:
    """1 ms, 7 ms and random steps agree with each other wherever nothing happens, and with the oracle everywhere."""
    stop, fixed = scenario["stop_time"], corners(scenario)
    times = sorted({0.0, stop} | {part * stop for part in cuts})
    grids = [every(0.001, scenario), every(0.007, scenario), {part * stop for part in irregular}]
    runs = [play(scenario, sorted(grid | fixed | set(times)), START, set(times)) for grid in grids]
    expected, scales = wanted(scenario, times), Scales(scenario)
    for run in runs:
        assert_as_oracle(scenario, run, expected, scales.tolerances())
    for time in times:
        if len(expected[time]) == 1:
            for run in runs[1:]:
                assert not differences(run[time], [runs[0][time]], scales.tolerances(), scales.period), (time, scenario)


def coinciding(rng: Random) -> dict[str, Any]:
    """Whole numbers and dyadic times: begins, ends, turning points, sets and step boundaries coincide exactly."""
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
    place, speed = float(rng.randint(-16, 16)), rng.choice([-8.0, -4.0, 0.0, 4.0, 8.0])
    return {
        "stop_time": stop_time,
        "start": {"curve": curve, "output_phasing": rng.choice(phasings), "master.period": period},
        "master": {"position": place, "velocity": speed, "segments": segments},
        "set": sorted(sets, key=lambda each: each["at"]),
    }


@settings(repeatable, max_examples=300)
@given(st.randoms(use_true_random=True).map(coinciding), st.sampled_from([1.0, 0.25, 0.0625]))
def test_events_may_coincide_with_steps_and_with_each_other(scenario: dict[str, Any], h: float) -> None:
    """Compared in between, where what has happened at such an instant has its consequences."""
    times = {k / 4 + 5 / 512 for k in range(int(4 * scenario["stop_time"]))}
    rows = play(scenario, sorted(corners(scenario) | every(h, scenario) | times), START, times)
    assert_as_oracle(scenario, rows, wanted(scenario, sorted(times)), Scales(scenario).tolerances())


# --- continuity and symmetries ----------------------------------------------------------------------------------------

JOINTS = ("ramp begins", "ramp left backwards", "completed start", "completed stop")


@settings(repeatable, max_examples=200)
@given(scripts(jumps=False, sound=True))
def test_position_velocity_and_for_the_polynomial_acceleration_join_at_every_transition(
    scenario: dict[str, Any],
) -> None:
    """Just before and just after; what the next derivative makes of the time between, by the trapezoidal rule, is
    taken off. The master's own acceleration must not jump there."""
    fixed, scales = corners(scenario), Scales(scenario)
    beside = 1e-7 * scales.length / scales.velocity
    joints = [time for time, name in events(scenario) if name in JOINTS]
    joints = [
        t for t in joints if min(abs(t - other) for other in fixed) > 4 * beside and t + beside < scenario["stop_time"]
    ]
    assume(joints)
    around = {t + side * beside for t in joints for side in (-1, 1)}
    rows = play(scenario, sorted(fixed | around), START, around)
    tolerances = scales.tolerances(4e-9)
    for t in joints:
        before, after = rows[t - beside], rows[t + beside]
        for name, rate in pairwise(MOTION):
            if name == "slave.acceleration" and scenario["start"]["curve"] == PARABOLA:
                continue
            gap = after[name] - before[name] - (after[rate] + before[rate]) * beside
            if name == "slave.position" and scales.period > 0.0:
                gap = math.remainder(gap, scales.period)
            assert abs(gap) <= tolerances[name], (t, name, scenario)


@repeatable
@given(scripts(), parts, st.sampled_from([START, END]))
def test_a_mirrored_master_gives_the_mirrored_slave_bit_for_bit(
    scenario: dict[str, Any], cuts: list[float], mode: MasterInput
) -> None:
    scenario["start"]["master.period"] = 0.0
    turned = deepcopy(scenario)
    for table in (turned["start"], turned["master"], *turned["master"]["segments"], *turned["set"]):
        for name in {"output_phasing", "rest_value", "position", "velocity", "acceleration"} & table.keys():
            table[name] = -table[name]
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    signs = dict.fromkeys((*MOTION, *WRAPPED), -1.0)
    ours, theirs = (play(each, sorted(times), mode, times) for each in (scenario, turned))
    for time, row in ours.items():
        assert {name: signs.get(name, 1.0) * value for name, value in row.items()} == theirs[time]


@repeatable
@given(
    st.sampled_from([PARABOLA, POLYNOMIAL]),
    st.booleans(),
    st.sampled_from([0.0, 100.0]),
    st.sampled_from([1.0, -1.0]),
    st.lists(st.floats(-0.4, 0.95), min_size=2, max_size=20),
)
def test_the_way_back_retraces_the_way_up(
    curve: Curve, starting: bool, period: float, sign: float, places: list[float]
) -> None:
    """Rest at 50, phasing 10; the master stands at each place, up from 36 and down again, in shares of the ramp."""
    rig = Rig(30.0 if sign > 0 else 70.0, period=period, curve=curve, output_phasing=sign * 10.0, mode=END)
    if starting:
        rig.rest_at(50.0)
    rig.go(rig.at, start=starting, stop=not starting, rest_value=50.0)
    before = 8.75 if starting and curve == POLYNOMIAL else 10.0
    distance = 20.0 if curve == PARABOLA else 18.75
    masters = [50.0 + sign * (part * distance - before) for part in sorted(places)]
    upwards = {}
    for master in masters:
        rig.stand(master)
        upwards[master] = rig.block.slave.position
        ramping = (master - 50.0) * sign >= -before
        assert rig.block.syn_ramp_on == ramping
        if not ramping:
            assert rig.block.slave.position == (50.0 if starting else master)
    assert [sign * s for s in upwards.values()] == sorted(sign * s for s in upwards.values())
    for master in [*masters[::-1], *masters]:
        rig.stand(master)
        assert rig.block.slave.position == upwards[master]
        assert rig.block.state == EXECUTING


extreme = st.floats(-1e12, 1e12) | st.sampled_from([0.0, 1e12, -1e12, 5e-324, -5e-324, 1e-160, 1.0])
calls = st.tuples(
    st.tuples(extreme, extreme, extreme),
    st.sampled_from([5e-324, 1e-310, 1e-154, 1e-100, 1e-9, 1.0, 1e6, 1e6]) | st.floats(5e-324, 1e6),
    st.sampled_from([(True, False), (False, True), (True, True), (False, False)]),
    st.integers(0, 9),
    extreme,
    st.sampled_from([1e-9, -1e-9, 1e12, -1e12, 1.0, 90.0, 0.0, math.nan, math.inf]),
)


@settings(repeatable, max_examples=300)
@given(
    st.sampled_from([START, END, ONLY]),
    st.sampled_from([PARABOLA, POLYNOMIAL]),
    st.sampled_from([0.0, 0.0, 1e-9, 0.1, 360.0, 1e12]),
    st.lists(calls, min_size=1, max_size=12),
)
def test_nothing_is_ever_nan_or_infinite_and_a_refused_step_changes_nothing(
    mode: MasterInput, curve: Curve, period: float, script: list[tuple[Any, ...]]
) -> None:
    block = Synchronizer(curve=curve)
    write(block, {"master.input_mode": mode, "master.period": period})
    assert block.initialize() == Refusal.NONE
    for (position, velocity, acceleration), h, (start, stop), inactive, rest, phasing in script:
        write(block, {"master.position": position, "master.velocity": velocity, "master.acceleration": acceleration})
        block.start, block.stop, block.active, block.rest_value = start, stop, inactive > 0, rest
        block.output_phasing = phasing
        before = deepcopy(block)
        if block.step(h) != Refusal.NONE:
            assert period > 0.0
            assert repr(block) == repr(before)
            continue
        assert all(math.isfinite(x) for x in numbers_in(block, ("output_phasing",)))
        assert period == 0.0 or 0.0 <= block.slave.position < period
        assert 0.0 <= block.local.progress <= 1.0
        assert block.local.distance_to_begin >= 0.0
        assert block.local.distance_to_end >= 0.0
        assert (block.state_code, block.ready) == (int(block.state), block.state == READY)
        assert block.status == block.syn_synchronized + 2 * block.syn_ramp_on
        assert block.error == (block.error_id != 0)


# --- rule by rule -----------------------------------------------------------------------------------------------------


class Rig:
    """A block whose master goes where a test says; each way is one step. Wrapped inputs with a period.

    The laws of the numbers below, rest R and phasing D: with the parabola both ramps lie from R - D to R + D, a start
    is R + (m - R + D)^2 / 4D, a stop R - (R + D - m)^2 / 4D.
    """

    def __init__(self, at: float = 0.0, *, period: float = 0.0, mode: MasterInput = START, **values: Any) -> None:
        self.at = at
        self.block = Synchronizer()
        write(self.block, {"curve": PARABOLA, "output_phasing": 10.0, **values})
        write(self.block, {"master.input_mode": mode, "master.period": period, "master.position": self.input})
        assert self.block.initialize() == Refusal.NONE

    @property
    def input(self) -> float:
        period = self.block.master.period
        return self.at % period if period > 0.0 else self.at

    def move(self, velocity: float, acceleration: float, h: float, **values: Any) -> "Rig":
        """The inputs given are set before the step, whose master is at `at` with this velocity and acceleration."""
        write(self.block, values)
        end = self.at + (velocity + 0.5 * acceleration * h) * h
        if self.block.master.input_mode == END:
            self.at, velocity = end, velocity + acceleration * h
        write(self.block, {"master.position": self.input, "master.velocity": velocity})
        self.block.master.acceleration = acceleration
        assert self.block.step(h) == Refusal.NONE
        self.at = end
        return self

    def go(self, *places: float, **values: Any) -> "Rig":
        """With constant velocity to each place, 1 s each; inputs are set before the first way."""
        for place in places:
            self.move(place - self.at, 0.0, 1.0, **values)
            values = {}
        return self

    def stand(self, place: float, **values: Any) -> "Rig":
        """END_OF_STEP: at rest at both ends of the way, which turns nowhere else."""
        write(self.block, values)
        self.at = place
        write(self.block, {"master.position": self.input, "master.velocity": 0.0, "master.acceleration": 0.0})
        assert self.block.step(1.0) == Refusal.NONE
        return self

    def pulse(self, **values: Any) -> "Rig":
        """Commands given to a standing master, and taken back."""
        self.go(self.at, **values)
        return self.go(self.at, start=False, stop=False)

    def rest_at(self, rest: float) -> "Rig":
        """READY and resting there, as a stop in an inactive block leaves it."""
        return self.pulse(active=False, stop=True, rest_value=rest).pulse(active=True)

    def shows(self, state: State, *, s: bool, ramp: bool = False, error: int = 0) -> "Rig":
        block = self.block
        assert (block.state, block.synchronized, block.syn_ramp_on, block.error_id) == (state, s, ramp, error)
        assert (block.state_code, block.ready, block.error) == (int(state), state == READY, error != 0)
        assert block.syn_synchronized == (s and not ramp)
        assert block.status == (1 if s and not ramp else 0) + (2 if ramp else 0)
        return self

    def slave(self, position: float, velocity: float | None = None) -> "Rig":
        assert self.block.slave.position == pytest.approx(position, rel=1e-12, abs=1e-12)
        if velocity is not None:
            assert self.block.slave.velocity == pytest.approx(velocity, rel=1e-12, abs=1e-12)
        return self


def test_initially_the_slave_is_the_master() -> None:
    rig = Rig(7.0).shows(READY, s=True).slave(7.0)
    local = rig.block.local
    assert [getattr(local, field.name) for field in fields(local)] == [0.0] * 8
    rig.go(12.0).shows(READY, s=True).slave(12.0, 5.0)
    rig.move(5.0, 2.0, 1.0).slave(18.0, 7.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (2.0, 0.0)
    Rig(370.0, period=360.0).slave(10.0)


def test_at_initialization_the_slave_has_the_master_s_velocity_unless_only_positions_are_known() -> None:
    for mode, expected in [(START, (3.0, 4.0)), (END, (3.0, 4.0)), (ONLY, (0.0, 0.0))]:
        block = Rig(0.0, mode=mode, **{"master.velocity": 3.0, "master.acceleration": 4.0}).block
        assert (block.slave.velocity, block.slave.acceleration) == expected


@pytest.mark.parametrize("command", ["start", "stop"])
def test_the_first_value_seen_is_no_edge(command: str) -> None:
    rig = Rig(0.0, **{command: True, "rest_value": 50.0})
    rig.go(1.0).shows(READY, s=True)
    rig.go(2.0, **{command: False}).shows(READY, s=True)
    rig.go(3.0, **{command: True}).shows(READY if command == "start" else EXECUTING, s=True)


def test_a_held_command_gives_one_edge() -> None:
    rig = Rig(0.0).go(60.0, stop=True, rest_value=20.0).shows(READY, s=False).slave(20.0)
    rig.block.rest_value = 100.0
    rig.go(80.0).shows(READY, s=False).slave(20.0)


# Commands that change nothing


@pytest.mark.parametrize("synchronized", [True, False])
def test_a_command_equal_to_s_is_ignored_when_ready(synchronized: bool) -> None:
    rig = Rig(0.0) if synchronized else Rig(0.0).rest_at(20.0)
    rig.go(0.0, start=synchronized, stop=not synchronized, rest_value=33.0).shows(READY, s=synchronized)
    rig.go(100.0).shows(READY, s=synchronized).slave(100.0 if synchronized else 20.0)


@pytest.mark.parametrize("place", [0.0, 25.0])
def test_a_command_equal_to_the_running_one_is_ignored_waiting_and_ramping(place: float) -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(place)
    rig.pulse(stop=True, rest_value=99.0, output_phasing=3.0).shows(EXECUTING, s=True, ramp=place > 20.0)
    rig.go(60.0).shows(READY, s=False).slave(30.0)
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(place).pulse(start=True, output_phasing=3.0)
    rig.shows(EXECUTING, s=False, ramp=place > 20.0).go(35.0).slave(30.0 + 225.0 / 40.0)


def test_stacked_everything_further_is_ignored_until_the_first_is_completed() -> None:
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).pulse(stop=True, rest_value=100.0).shows(STACKED, s=False)
    rig.pulse(stop=True, rest_value=70.0, output_phasing=5.0).shows(STACKED, s=False)
    rig.pulse(start=True).shows(STACKED, s=False)
    rig.pulse(start=True, stop=True, rest_value=60.0, output_phasing=0.0).shows(STACKED, s=False)
    rig.go(25.0, output_phasing=10.0).shows(STACKED, s=False, ramp=True).slave(30.0 + 25.0 / 40.0)
    rig.go(50.0).shows(EXECUTING, s=True).slave(50.0)
    rig.pulse(start=True).shows(STACKED, s=True)
    rig.go(100.0).shows(STACKED, s=True, ramp=True).slave(97.5)
    rig.go(120.0).shows(EXECUTING, s=False).slave(100.0)


# Stacked commands


@pytest.mark.parametrize("place", [0.0, 25.0])
def test_a_command_against_the_running_one_is_stacked_waiting_and_ramping(place: float) -> None:
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(place).pulse(stop=True, rest_value=60.0)
    rig.shows(STACKED, s=False, ramp=place > 20.0)
    rig.go(40.0).shows(EXECUTING, s=True).slave(40.0)
    rig.go(50.0).shows(EXECUTING, s=True, ramp=True).slave(50.0, 10.0)
    rig.go(60.0).slave(57.5, 5.0)
    rig.go(70.0).shows(READY, s=False).slave(60.0, 0.0)


def test_each_command_keeps_phasing_and_rest_value_of_its_edge() -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=50.0, output_phasing=20.0).pulse(start=True, output_phasing=4.0)
    rig.go(40.0, rest_value=-7.0, output_phasing=1.0).shows(STACKED, s=True, ramp=True).slave(50.0 - 900.0 / 80.0)
    assert rig.block.local.transition_distance == 40.0
    rig.go(70.0).shows(EXECUTING, s=False).slave(50.0)
    assert rig.block.local.transition_distance == 8.0
    assert (rig.block.local.ramp_begin, rig.block.local.ramp_end) == (46.0, 54.0)
    rig.go(50.0, 40.0).shows(EXECUTING, s=False).slave(50.0)  # too late: back to its beginning, without a period
    rig.go(50.0).shows(EXECUTING, s=False, ramp=True).slave(51.0, 5.0)
    rig.go(54.0).shows(READY, s=True).slave(54.0)


def test_a_stacked_start_takes_the_rest_position_of_the_running_stop() -> None:
    rig = Rig(0.0, period=360.0).pulse(stop=True, rest_value=50.0).pulse(start=True, rest_value=200.0)
    rig.go(60.0).shows(EXECUTING, s=False).slave(50.0)
    assert (rig.block.local.ramp_begin, rig.block.local.ramp_end) == (40.0, 60.0)
    assert rig.block.local.distance_to_begin == pytest.approx(340.0)
    rig.go(410.0).shows(EXECUTING, s=False, ramp=True).slave(52.5)
    rig.go(420.0).shows(READY, s=True).slave(60.0)


def test_a_stacked_command_begins_in_its_own_direction_from_the_first_one_s_end() -> None:
    """Start upwards, rest 0, ends at 10; the stop downwards begins at 10, which the master is leaving upwards."""
    rig = Rig(-30.0).rest_at(0.0).pulse(start=True).pulse(stop=True, rest_value=0.0, output_phasing=-10.0)
    rig.go(10.0).shows(EXECUTING, s=True, ramp=True).slave(10.0)
    rig.go(30.0).shows(EXECUTING, s=True).slave(30.0)
    rig.go(0.0).shows(EXECUTING, s=True, ramp=True).slave(0.0 + 2.5, -15.0)
    rig.go(-10.0).shows(READY, s=False).slave(0.0)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("period", [0.1, 0.7, 6.2, 7.7, 360.0])
@pytest.mark.parametrize("share", [0.00317, 0.0713, 0.917, 3.313])
def test_a_stop_stacked_at_the_narrow_gap_ramps_without_waiting_a_turn(
    curve: Curve, sign: float, period: float, share: float
) -> None:
    """Phasing P/2: the stop's beginning is the start's end. Steps of some share of a turn, from 20 turns on."""
    for rest in (0.0, 0.5 * period, 0.3 * period):
        rig = Rig(20.0 * period, period=period, curve=curve, output_phasing=sign * 0.5 * period).rest_at(rest)
        rig.pulse(start=True).pulse(stop=True, rest_value=rest).shows(STACKED, s=False, ramp=rig.block.syn_ramp_on)
        begin, travelled = rig.at, 0.0
        while rig.block.state == STACKED:
            assert travelled <= (2.1 + share) * period
            travelled += share * period
            rig.go(begin + sign * travelled)
        if share < 1.0:
            rig.shows(EXECUTING, s=True, ramp=True)
            way = rig.block.local.distance_to_end
            assert 0.0 < way < rig.block.local.transition_distance
            if curve == PARABOLA:
                gap = rig.block.slave.position - (rest - sign * way * way / (2.0 * period))
                assert math.remainder(gap, period) == pytest.approx(0.0, abs=1e-9 * period)
        while rig.block.state == EXECUTING:
            assert travelled <= (3.1 + share) * period
            travelled += share * period
            rig.go(begin + sign * travelled)
        rig.shows(READY, s=False)
        assert math.remainder(rig.block.slave.position - rest, period) == pytest.approx(0.0, abs=1e-12 * period)


def test_the_narrow_gap_in_degrees() -> None:
    """P 360, phasing 180, rest 180: the start ends at 360, where the stop begins."""
    rig = Rig(-10.0, period=360.0, output_phasing=180.0).rest_at(180.0)
    rig.pulse(start=True).pulse(stop=True, rest_value=180.0).go(180.0).shows(STACKED, s=False, ramp=True).slave(225.0)
    rig.go(359.0).shows(STACKED, s=False, ramp=True)
    rig.go(361.0).shows(EXECUTING, s=True, ramp=True).slave(180.0 - 359.0**2 / 720.0)
    rig.go(540.0).slave(135.0).go(720.0).shows(READY, s=False).slave(180.0)


# Start and stop at once


@pytest.mark.parametrize(
    ("synchronized", "state", "ends"),
    [(True, EXECUTING, False), (False, STACKED, False)],
)
def test_start_acts_before_stop_in_the_same_step(synchronized: bool, state: State, ends: bool) -> None:
    """Synchronized the start is ignored and the stop executed; at rest the stop is stacked on the start."""
    rig = Rig(0.0) if synchronized else Rig(0.0).rest_at(30.0)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(state, s=synchronized)
    rig.go(100.0).shows(READY, s=ends).slave(60.0)


def test_start_and_stop_at_once_while_a_command_runs() -> None:
    rig = Rig(0.0).rest_at(30.0).pulse(start=True)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(STACKED, s=False)
    rig.go(100.0).shows(READY, s=False).slave(60.0)
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(STACKED, s=True)
    rig.go(45.0).shows(EXECUTING, s=False).slave(30.0)  # the start, rest 30, waits: the stop was ignored
    rig.go(20.0, 30.0).shows(EXECUTING, s=False, ramp=True).slave(32.5)


# Refusals


@pytest.mark.parametrize("phasing", [0.0, -0.0, 9.9e-10, -9.9e-10, 1.001e12, -1e13, math.inf, -math.inf, math.nan])
def test_a_command_with_a_bad_phasing_is_refused_and_moves_nothing(phasing: float) -> None:
    rig = Rig(0.0).go(5.0, stop=True, rest_value=20.0, output_phasing=phasing).shows(READY, s=True, error=1).slave(5.0)
    rig.go(50.0, stop=False).shows(READY, s=True, error=1).slave(50.0)
    rig.go(0.0, output_phasing=10.0).shows(READY, s=True, error=1)
    rig.go(25.0, stop=True).shows(EXECUTING, s=True, ramp=True).slave(20.0 - 25.0 / 40.0)
    rig = Rig(0.0).rest_at(20.0).pulse(start=True, output_phasing=phasing).shows(READY, s=False, error=1)
    rig.go(50.0).slave(20.0)


@pytest.mark.parametrize("phasing", [1e-9, -1e-9, 1e12, -1e12])
def test_the_limits_of_the_phasing_are_allowed(phasing: float) -> None:
    rig = Rig(0.0).go(0.0, stop=True, rest_value=2 * phasing, output_phasing=phasing)
    rig.shows(EXECUTING, s=True).go(4 * phasing).shows(READY, s=False).slave(2 * phasing)


def test_a_refused_command_is_not_stacked_and_leaves_the_running_one() -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).pulse(start=True, output_phasing=0.0)
    rig.shows(EXECUTING, s=True, error=1).go(30.0).shows(EXECUTING, s=True, ramp=True, error=1).slave(27.5)
    rig.go(60.0).shows(READY, s=False, error=1).slave(30.0)


def test_an_ignored_command_is_not_refused_and_clears_the_error() -> None:
    rig = Rig(0.0).pulse(stop=True, output_phasing=0.0).shows(READY, s=True, error=1)
    rig.pulse(start=True).shows(READY, s=True)
    rig.pulse(stop=True).shows(READY, s=True, error=1).pulse(start=True, stop=True).shows(READY, s=True, error=1)
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).pulse(start=True, output_phasing=math.nan)
    rig.shows(EXECUTING, s=True, error=1).pulse(stop=True).shows(EXECUTING, s=True)
    rig.pulse(start=True, output_phasing=10.0).shows(STACKED, s=True)
    rig.pulse(start=True, output_phasing=0.0).shows(STACKED, s=True)


def test_an_inactive_block_does_not_look_at_the_phasing() -> None:
    rig = Rig(0.0).pulse(stop=True, output_phasing=0.0).shows(READY, s=True, error=1)
    rig.pulse(active=False, stop=True, rest_value=4.0).shows(READY, s=False).slave(4.0)
    rig.pulse(active=True, start=True).shows(READY, s=False, error=1)


# Inactive


def test_inactive_commands_act_at_once() -> None:
    rig = Rig(3.0, active=False).shows(READY, s=True).go(7.0, stop=True, rest_value=42.0)
    rig.shows(READY, s=False).slave(42.0, 0.0)
    rig.go(8.0, stop=False, rest_value=1.0).slave(42.0)
    rig.go(9.0, stop=True).slave(1.0)  # again, with another rest value: nothing is ignored
    rig.go(12.0, start=True).shows(READY, s=True).slave(12.0, 3.0)
    rig.go(20.0, start=False, stop=False).slave(20.0, 8.0)
    rig.go(21.0, start=True, stop=True, rest_value=5.0).shows(READY, s=False).slave(5.0)
    Rig(3.0, active=False, period=360.0).go(7.0, stop=True, rest_value=-10.0).slave(350.0)
    assert rig.block.local.transition_distance == 0.0


def test_inactive_the_output_is_master_or_rest_whatever_the_master_does() -> None:
    rig = Rig(0.0, active=False).pulse(stop=True, rest_value=30.0)
    rig.go(20.0, 30.0, 70.0, -50.0).shows(READY, s=False).slave(30.0, 0.0)


def test_activation_changes_nothing_by_itself() -> None:
    rig = Rig(0.0, active=False).pulse(stop=True, rest_value=30.0).go(20.0, active=True).shows(READY, s=False)
    rig.go(100.0).shows(READY, s=False).slave(30.0)
    rig = Rig(0.0, active=False, start=True, stop=True).go(1.0).shows(READY, s=True).go(2.0, active=True)
    rig.shows(READY, s=True).slave(2.0)


def test_an_activation_acts_before_a_command_of_the_same_step() -> None:
    rig = Rig(0.0, active=False).go(0.0, active=True, stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    rig.go(0.0, active=False, start=True, stop=False).shows(READY, s=True).slave(0.0)


def test_a_deactivation_acts_before_a_command_of_the_same_step() -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(5.0, active=False, start=True).shows(READY, s=True)
    rig.slave(5.0, 5.0)
    rig.go(6.0, stop=True, rest_value=1.0).shows(READY, s=False).slave(1.0)


@pytest.mark.parametrize("place", [0.0, 25.0])
def test_a_deactivation_in_executing_does_at_once_what_the_command_would(place: float) -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(place, rest_value=77.0)
    rig.go(place + 1.0, active=False).shows(READY, s=False).slave(30.0, 0.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (0.0, 0.0)
    rig.go(100.0, active=True).shows(READY, s=False).slave(30.0)
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(place, rest_value=77.0)
    rig.go(place + 1.0, active=False).shows(READY, s=True).slave(place + 1.0, 1.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (0.0, 0.0)


@pytest.mark.parametrize("place", [0.0, 25.0])
def test_a_deactivation_in_stacked_does_at_once_what_both_commands_would(place: float) -> None:
    rig = (
        Rig(0.0)
        .rest_at(30.0)
        .pulse(start=True)
        .go(place)
        .pulse(stop=True, rest_value=55.0)
        .shows(STACKED, s=False, ramp=place > 20.0)
    )
    rig.go(place, rest_value=99.0, active=False).shows(READY, s=False).slave(55.0, 0.0)
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(place).pulse(start=True)
    rig.go(place + 1.0, active=False).shows(READY, s=True).slave(place + 1.0, 1.0)
    rig.go(place, active=True, rest_value=99.0).pulse(stop=True, output_phasing=0.0)
    rig.shows(READY, s=True, error=1)


def test_a_deactivation_when_ready_changes_nothing() -> None:
    Rig(0.0).go(1.0, active=False).shows(READY, s=True).slave(1.0)
    Rig(0.0).rest_at(30.0).go(1.0, active=False).shows(READY, s=False).slave(30.0)
    Rig(0.0).pulse(stop=True, output_phasing=0.0).go(1.0, active=False).shows(READY, s=True, error=1)


def test_after_a_deactivation_the_ramp_shown_is_the_last_one() -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(25.0)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 0.25)
    rig.go(35.0, active=False)
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 0.25)
    assert (local.distance_to_begin, local.distance_to_end) == (0.0, 0.0)


# When a command is armed


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("period", [0.0, 360.0])
@pytest.mark.parametrize(("beyond", "ramps"), [(0.0, True), (5e-9, True), (2e-8, False)])
def test_a_command_given_at_its_begin_starts_at_once(curve: Curve, period: float, beyond: float, ramps: bool) -> None:
    """The begin may be passed by 1e-9 of the phasing of 10."""
    rig = Rig(20.0 + beyond, curve=curve, period=period).go(22.0, stop=True, rest_value=30.0)
    rig.shows(EXECUTING, s=True, ramp=ramps)
    if ramps and curve == PARABOLA:
        rig.slave(30.0 - 18.0**2 / 40.0)
    elif not ramps:
        rig.slave(22.0)


def test_at_exactly_its_ends_the_slave_is_on_the_ramp_or_beyond_it() -> None:
    rig = Rig(0.0).go(20.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True).slave(20.0, 20.0)
    assert rig.block.slave.acceleration == -(20.0**2) / 20.0
    assert rig.block.local.progress == 0.0
    rig.go(40.0).shows(READY, s=False).slave(30.0, 0.0)
    assert (rig.block.slave.acceleration, rig.block.local.progress) == (0.0, 1.0)


def test_a_command_given_too_late_waits_a_turn() -> None:
    rig = Rig(25.0, period=360.0).pulse(stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    local = rig.block.local
    assert (local.distance_to_begin, local.distance_to_end, local.progress) == (355.0, 375.0, 0.0)
    rig.go(45.0, 200.0, 379.0).shows(EXECUTING, s=True).slave(19.0)
    rig.go(390.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(500.0).shows(READY, s=False).slave(30.0)


def test_a_command_given_too_late_without_a_period_waits_for_the_master_to_come_back() -> None:
    rig = Rig(25.0).pulse(stop=True, rest_value=30.0).go(100.0).shows(EXECUTING, s=True).slave(100.0)
    local = rig.block.local
    assert (local.distance_to_begin, local.distance_to_end, local.progress) == (80.0, 100.0, 0.0)
    rig.go(20.5, 100.0).shows(EXECUTING, s=True)
    rig.go(-40.0).shows(EXECUTING, s=True).slave(-40.0)
    assert (local.distance_to_begin, local.distance_to_end) == (60.0, 80.0)
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(40.0).shows(READY, s=False)


def test_once_armed_a_command_stays_armed() -> None:
    rig = Rig(30.0).rest_at(50.0).go(30.0, 35.0, start=True).go(-1000.0, 39.0)
    rig.shows(EXECUTING, s=False).slave(50.0).go(50.0).shows(EXECUTING, s=False, ramp=True).slave(52.5)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_command_against_the_master_s_direction_waits_for_ever_and_deactivation_ends_it(direction: float) -> None:
    """With a period: never on a ramp but for instants, although the master passes 99 of them."""
    rig = Rig(3.0, period=50.0, output_phasing=direction * 10.0).pulse(stop=True, rest_value=30.0)
    for _ in range(700):
        rig.go(rig.at - direction * 7.0710678).shows(EXECUTING, s=True)
        rig.slave(rig.at % 50.0)
    rig.go(rig.at, active=False).shows(READY, s=False).slave(30.0)


@pytest.mark.parametrize(("lowest", "ramps"), [(20.0, True), (20.0 + 5e-9, True), (20.0 + 3e-8, False), (19.0, True)])
@pytest.mark.parametrize("h", [4.0, 1.0, 0.25])
def test_a_turning_point_at_the_begin_arms_a_late_command(lowest: float, ramps: bool, h: float) -> None:
    """m = lowest + (t - 2)²: given at 24, turning at 2 s, within the step or at its end; 29 at 5 s."""
    rig = Rig(lowest + 4.0)
    rig.go(rig.at, stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    for i in range(int(4.0 / h)):
        rig.move(2.0 * (i * h - 2.0), 2.0, h)
    rig.shows(EXECUTING, s=True, ramp=ramps)
    rig.slave(30.0 - (16.0 - (lowest - 20.0)) ** 2 / 40.0 if ramps else lowest + 4.0)


def test_a_turning_point_inside_a_step_completes_a_command() -> None:
    """m = 50 - 10 (t - 1)²... up past the end at 40 and back below it within one step of 2 s."""
    rig = Rig(15.0).pulse(stop=True, rest_value=30.0)
    rig.move(60.0, -60.0, 2.0).shows(READY, s=False).slave(30.0)
    assert rig.at == 15.0
    rig = Rig(15.0).pulse(stop=True, rest_value=30.0)
    rig.move(48.0, -48.0, 2.0).shows(EXECUTING, s=True).slave(15.0)  # only up to 39


def test_a_turning_point_on_the_cubic_completes_a_command() -> None:
    """From 15 and back in 2 s, with velocities of 60 and -60 at the ends: up to 45."""
    rig = Rig(15.0, mode=END, **{"master.velocity": 60.0})
    rig.move(60.0, -60.0, 2.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0)
    assert rig.at == 15.0


# Ramping


def test_back_below_the_begin_the_command_waits_again() -> None:
    rig = Rig(0.0).pulse(stop=True, rest_value=30.0).go(30.0).slave(27.5, 30.0 * 0.5)
    rig.go(25.0).shows(EXECUTING, s=True, ramp=True).slave(30.0 - 225.0 / 40.0)
    rig.go(19.0).shows(EXECUTING, s=True).slave(19.0, -6.0)
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5).go(41.0).shows(READY, s=False)
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(30.0).slave(32.5).go(19.0).shows(EXECUTING, s=False)
    rig.slave(30.0, 0.0).go(40.0).shows(READY, s=True).slave(40.0, 21.0)


@pytest.mark.parametrize("back", [1, 2, 7])
@pytest.mark.parametrize("steps", [1, 3, 100])
def test_backwards_past_whole_turns_the_command_aims_at_the_first_ramp_ahead(back: int, steps: int) -> None:
    """Ramps begin at 20 + 100 n. From inside a ramp back by whole turns and a little, then forwards again."""
    rig = Rig(0.0, period=100.0).pulse(stop=True, rest_value=30.0).go(30.0).shows(EXECUTING, s=True, ramp=True)
    lowest = 30.0 - 100.0 * back - 15.0
    rig.go(*(30.0 + (lowest - 30.0) * i / steps for i in range(1, steps + 1))).shows(EXECUTING, s=True)
    rig.slave(15.0)
    assert rig.block.local.distance_to_begin == pytest.approx(5.0)
    rig.go(lowest + 15.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(lowest + 25.0).shows(READY, s=False).slave(30.0)


def test_backwards_in_a_step_that_comes_back_again_the_command_is_ramped_where_it_ends() -> None:
    """From 30 down by 225 and up again in one step of 30 s: it turns at -195, aims at -180 and ends in -170."""
    rig = Rig(0.0, period=100.0).pulse(stop=True, rest_value=30.0).go(30.0).shows(EXECUTING, s=True, ramp=True)
    rig.move(-30.0, 2.0, 20.0).shows(EXECUTING, s=True, ramp=True)
    assert rig.at == -170.0
    rig.slave(27.5)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
def test_a_ramp_longer_than_the_period_spans_several_turns(curve: Curve) -> None:
    """P 100, phasing 230, rest 30: from -200 (3-4-5 stop alike) to 260, or to 231.25."""
    rig = Rig(-250.0, period=100.0, curve=curve, output_phasing=230.0).pulse(stop=True, rest_value=30.0)
    rig.go(-200.5).shows(EXECUTING, s=True)
    rig.go(-199.5).shows(EXECUTING, s=True, ramp=True)
    rig.go(-100.0, 0.0, 30.0).shows(EXECUTING, s=True, ramp=True)
    if curve == PARABOLA:
        rig.slave((30.0 - 230.0 / 4.0) % 100.0)
    end = 260.0 if curve == PARABOLA else 30.0 + 230.0 * 7 / 8
    rig.go(end - 0.5).shows(EXECUTING, s=True, ramp=True).go(end + 0.5).shows(READY, s=False).slave(30.0)
    rig.pulse(start=True, output_phasing=150.0)
    assert rig.block.local.distance_to_begin < 100.0
    while rig.block.state == EXECUTING:
        rig.go(rig.at + 33.0)
    rig.shows(READY, s=True).slave(rig.at % 100.0)


def test_the_slave_on_the_ramp_by_the_chain_rule() -> None:
    """Start, rest 30, master at 30 with v = 6 and a = 2: slope 1/2, curvature 1/20."""
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(25.0)
    rig.move(4.0, 2.0, 1.0)
    assert rig.at == 30.0
    slave = rig.block.slave
    assert (slave.position, slave.velocity) == (32.5, 3.0)
    assert slave.acceleration == pytest.approx(2.0 / 2 + 36.0 / 20)
    assert slave.jerk == pytest.approx(3 * 6.0 * 2.0 / 20)


def test_the_slave_on_the_polynomial_by_the_chain_rule() -> None:
    """Start, phasing 8, rest 7, from 0 to 15; at 7.5 z is 1/4: f = 53/512, f' = 135/128, f'' = 45/8, f''' = -15/2."""
    rig = Rig(-10.0, curve=POLYNOMIAL, output_phasing=8.0).rest_at(7.0).pulse(start=True)
    rig.go(4.5).move(2.0, 2.0, 1.0)
    assert rig.at == 7.5
    slave, height, stretch, v, a = rig.block.slave, 16.0, 30.0, 4.0, 2.0
    slope, curvature, twist = height * 135 / 128 / stretch, height * 5.625 / stretch**2, height * -7.5 / stretch**3
    assert slave.position == pytest.approx(7.0 + height * 53 / 512)
    assert slave.velocity == pytest.approx(slope * v)
    assert slave.acceleration == pytest.approx(slope * a + curvature * v**2)
    assert slave.jerk == pytest.approx(3 * curvature * v * a + twist * v**3)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.transition_distance) == (0.0, 15.0, 15.0)
    assert (local.progress, local.distance_to_begin, local.distance_to_end) == (0.5, 0.0, 7.5)
    assert local.peak_acceleration_per_v2 == pytest.approx(128 / 135 * math.sqrt(3) / 16)
    assert local.peak_jerk_per_v3 == pytest.approx(512 / 225 / 64)


@pytest.mark.parametrize(("curve", "phasing", "starting", "begin", "end", "middle"), KNOWN_RAMPS)
def test_known_results_in_degrees(
    curve: Curve, phasing: float, starting: bool, begin: float, end: float, middle: float
) -> None:
    sign = math.copysign(1.0, phasing)
    rig = Rig(180.0 - sign * 190.0, period=360.0, curve=curve, output_phasing=phasing)
    if starting:
        rig.rest_at(180.0)
    rig.pulse(start=starting, stop=not starting, rest_value=180.0)
    rig.go(begin - sign).shows(EXECUTING, s=not starting).slave(180.0 if starting else (begin - sign) % 360.0)
    assert rig.block.local.ramp_begin == pytest.approx(begin % 360.0)
    assert rig.block.local.ramp_end == pytest.approx(end % 360.0)
    rig.go(begin + sign).shows(EXECUTING, s=not starting, ramp=True)
    rig.go(180.0).shows(EXECUTING, s=not starting, ramp=True)
    assert rig.block.slave.position == pytest.approx(middle, abs=5e-8)
    rig.go(end - sign).shows(EXECUTING, s=not starting, ramp=True)
    rig.go(end).shows(READY, s=starting).slave(end % 360.0 if starting else 180.0)


# Within one step


def test_one_giant_step_may_complete_a_transition() -> None:
    rig = Rig(0.0).move(1e6, 0.0, 1.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0, 0.0)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 1.0)
    rig = Rig(0.0, period=360.0).move(1e6, 0.0, 1.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0)


@pytest.mark.parametrize("period", [0.0, 360.0])
@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
def test_one_giant_step_may_complete_a_start_and_the_stop_stacked_on_it(period: float, curve: Curve) -> None:
    """Given in the same step: the start from 30 and the stop at 200."""
    rig = Rig(0.0, period=period, curve=curve).rest_at(30.0)
    rig.go(1000.0, start=True, stop=True, rest_value=200.0).shows(READY, s=False).slave(200.0, 0.0)
    local = rig.block.local
    assert local.ramp_begin == pytest.approx(190.0)
    assert local.ramp_end == pytest.approx(210.0 if curve == PARABOLA else 208.75)


def test_one_giant_step_without_a_period_misses_a_stop_whose_begin_lies_before_the_start_s_end() -> None:
    """The stop at 45 begins at 35, the start ends at 40: taken up too late, it waits for the way back."""
    rig = Rig(0.0).rest_at(30.0).go(1000.0, start=True, stop=True, rest_value=45.0).shows(EXECUTING, s=True)
    rig.slave(1000.0)
    rig.go(0.0, 45.0).shows(EXECUTING, s=True, ramp=True).slave(42.5)


def test_one_giant_step_may_end_on_the_stacked_command_s_ramp() -> None:
    rig = Rig(0.0).rest_at(30.0).go(60.0, start=True, stop=True, rest_value=60.0)
    rig.shows(EXECUTING, s=True, ramp=True).slave(57.5, 30.0)


def test_a_step_may_complete_the_first_command_upwards_and_the_stacked_one_downwards() -> None:
    """Up to 45 and back to 15 in one step: the start from 30 ends at 40, the stop at 30 the other way begins there."""
    rig = Rig(15.0).rest_at(30.0).pulse(start=True).pulse(stop=True, rest_value=30.0, output_phasing=-10.0)
    rig.move(60.0, -60.0, 2.0).shows(READY, s=False).slave(30.0)


def test_the_seam_belongs_to_the_path_and_comes_before_the_commands() -> None:
    """The prediction ends at 39.9; the next input is 40.1. The start, up to 40, is completed in between; the stop given
    with that input, from 40 on, is too late: had it been stacked, it would ramp."""
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(39.9).shows(EXECUTING, s=False, ramp=True)
    rig.at = 40.1
    rig.go(40.2, stop=True, rest_value=50.0).shows(EXECUTING, s=True).slave(40.2)
    rig.go(1000.0).shows(EXECUTING, s=True).slave(1000.0)
    stacked = Rig(0.0).rest_at(30.0).pulse(start=True).go(39.9)
    stacked.go(40.2, stop=True, rest_value=50.0).shows(EXECUTING, s=True, ramp=True)


def test_a_start_that_ends_in_the_seam_is_no_longer_running_for_the_command_after_it() -> None:
    """The same start that would be taken up again is ignored, a stop is refused rather than stacked."""
    rig = Rig(0.0).rest_at(30.0).pulse(start=True).go(39.9)
    rig.at = 40.1
    rig.go(41.0, start=True, stop=True, output_phasing=0.0).shows(READY, s=True, error=1).slave(41.0)


def test_a_seam_backwards_may_arm_a_late_command() -> None:
    rig = Rig(25.0).pulse(stop=True, rest_value=30.0).go(24.0)
    rig.at = 19.0
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)


def test_the_first_step_has_no_seam() -> None:
    """Between initialization at 0 and the first input at 25 nothing is passed."""
    rig = Rig(0.0)
    rig.at = 25.0
    rig.go(26.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True).slave(26.0)
    rig.go(100.0).shows(EXECUTING, s=True)


def test_with_inputs_of_the_step_s_end_an_edge_acts_at_its_beginning() -> None:
    """The stop's ramp begins at 20: where the master stood at the call before, or at initialization."""
    rig = Rig(20.0, mode=END).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True)
    rig.slave(30.0 - 225.0 / 40.0)
    rig = Rig(0.0, mode=END).go(20.0).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True)
    rig = Rig(0.0, mode=END).go(21.0).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True)


# Many turns


@pytest.mark.parametrize("period", [360.0, 0.1, 7.7])
def test_after_ten_million_turns_a_ramp_lies_where_it_did(period: float) -> None:
    """The stop waits while the master goes back 10⁷ turns in 10 steps, then forwards."""
    rig = Rig(0.0, period=period, output_phasing=0.2 * period).pulse(stop=True, rest_value=0.5 * period)
    for _ in range(10):
        rig.at = 0.0
        rig.move(-1e6 * period, 0.0, 1.0).shows(EXECUTING, s=True)
    rig.at = 0.0
    for place in (0.29, 0.31, 0.5):
        rig.go(place * period).shows(EXECUTING, s=True, ramp=place > 0.3)
    assert rig.block.slave.position == pytest.approx(0.45 * period, rel=1e-14)
    rig.go(0.71 * period).shows(READY, s=False)
    assert rig.block.slave.position == 0.5 * period


def test_a_refused_step_changes_nothing() -> None:
    """Waiting for a ramp, three turns on, whole turns not yet dropped."""
    rig = Rig(0.0, period=1e-6, output_phasing=1e-7).pulse(stop=True, rest_value=5e-7, output_phasing=-1e-7).go(3.3e-6)
    write(rig.block, {"master.position": 0.0, "master.velocity": 1e12})
    before = deepcopy(rig.block)
    assert rig.block.step(1.0) == Refusal.MASTER_TURNS
    assert rig.block == before
