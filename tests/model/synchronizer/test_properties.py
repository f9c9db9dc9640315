"""The Synchronizer on random scripts: the oracle, step sizes, continuity, symmetries, no NaN."""

import math
from copy import deepcopy
from itertools import pairwise
from typing import Any

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.interface import Curve
from tests.model.synchronizer.harness import (
    END,
    EXECUTING,
    ONLY,
    PARABOLA,
    POLYNOMIAL,
    START,
    Harness,
)
from tests.model.synchronizer.scripted_runs import (
    MOTION,
    WRAPPED,
    Scales,
    assert_as_oracle,
    coinciding,
    compute_expected,
    corners,
    differences,
    every,
    parts,
    play,
    scripts,
)
from tests.oracle.synchronizer import events

settings.register_profile("synchronizer", derandomize=True, deadline=None, max_examples=250)
repeatable = settings.get_profile("synchronizer")


@repeatable
@given(scripts(), parts, st.integers(1, 8))
def test_with_inputs_of_the_step_s_start_the_block_is_its_oracle(
    scenario: dict[str, Any], cuts: list[float], often: int
) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    boundaries = times | every(scenario["stop_time"] / often, scenario)
    rows = play(scenario, sorted(boundaries), START, times)
    assert_as_oracle(scenario, rows, compute_expected(scenario, sorted(times)), Scales(scenario).tolerances())


@repeatable
@given(scripts(jumps=False), parts)
def test_with_inputs_of_the_step_s_end_the_block_is_its_oracle(scenario: dict[str, Any], cuts: list[float]) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    rows = play(scenario, sorted(times), END, times)
    assert_as_oracle(scenario, rows, compute_expected(scenario, sorted(times)), Scales(scenario).tolerances())


@repeatable
@given(scripts(single=True), st.sampled_from([0.05, 0.031, 0.1]))
def test_with_positions_only_the_block_is_its_oracle(scenario: dict[str, Any], h: float) -> None:
    """Once the velocity is known, after three samples; velocity and acceleration as exact as differences allow."""
    times = {time for time in corners(scenario) if time > 0.4} | {k * 0.25 for k in range(2, 13)}
    boundaries = sorted(corners(scenario) | every(h, scenario) | times)
    shortest = min(b - a for a, b in pairwise(boundaries))
    assume(shortest > 1e-3)
    scales = Scales(scenario)
    velocity = 32 * 2.0**-53 * (scales.master_position + scales.velocity) / shortest
    tolerances = scales.tolerances(velocity=velocity, acceleration=4 * velocity / shortest)
    rows = play(scenario, boundaries, ONLY, times)
    assert_as_oracle(scenario, rows, compute_expected(scenario, sorted(times)), tolerances)


@settings(repeatable, max_examples=60)
@given(scripts(), parts, parts)
def test_the_step_size_changes_nothing(scenario: dict[str, Any], cuts: list[float], irregular: list[float]) -> None:
    """1 ms, 7 ms and random steps agree with each other wherever nothing happens, and with the oracle everywhere."""
    stop, fixed = scenario["stop_time"], corners(scenario)
    times = sorted({0.0, stop} | {part * stop for part in cuts})
    grids = [every(0.001, scenario), every(0.007, scenario), {part * stop for part in irregular}]
    runs = [play(scenario, sorted(grid | fixed | set(times)), START, set(times)) for grid in grids]
    expected, scales = compute_expected(scenario, times), Scales(scenario)
    for run in runs:
        assert_as_oracle(scenario, run, expected, scales.tolerances())
    for time in times:
        if len(expected[time]) == 1:
            for run in runs[1:]:
                assert not differences(run[time], [runs[0][time]], scales.tolerances(), scales.period), (time, scenario)


@settings(repeatable, max_examples=300)
@given(st.randoms(use_true_random=True).map(coinciding), st.sampled_from([1.0, 0.25, 0.0625]))
def test_events_may_coincide_with_steps_and_with_each_other(scenario: dict[str, Any], h: float) -> None:
    """Compared in between, where what has happened at such an instant has its consequences."""
    times = {k / 4 + 5 / 512 for k in range(int(4 * scenario["stop_time"]))}
    rows = play(scenario, sorted(corners(scenario) | every(h, scenario) | times), START, times)
    assert_as_oracle(scenario, rows, compute_expected(scenario, sorted(times)), Scales(scenario).tolerances())


JOINTS = ("ramp starts", "ramp left backwards", "completed start", "completed stop")


@settings(repeatable, max_examples=200)
@given(scripts(jumps=False, sound=True))
def test_position_velocity_and_for_the_polynomial_acceleration_join_at_every_transition(
    scenario: dict[str, Any],
) -> None:
    """Just before and just after; what the next derivative makes of the time between, by the trapezoidal rule, is
    taken off. The master's own acceleration must not jump there."""
    fixed, scales = corners(scenario), Scales(scenario)
    offset = 1e-7 * scales.length / scales.velocity
    joints = [time for time, name in events(scenario) if name in JOINTS]
    joints = [
        t for t in joints if min(abs(t - other) for other in fixed) > 4 * offset and t + offset < scenario["stop_time"]
    ]
    assume(joints)
    around = {t + side * offset for t in joints for side in (-1, 1)}
    rows = play(scenario, sorted(fixed | around), START, around)
    tolerances = scales.tolerances(4e-9)
    for t in joints:
        before, after = rows[t - offset], rows[t + offset]
        for name, rate in pairwise(MOTION):
            if name == "slave.acceleration" and scenario["start"]["curve"] == PARABOLA:
                continue
            gap = after[name] - before[name] - (after[rate] + before[rate]) * offset
            if name == "slave.position" and scales.period > 0.0:
                gap = math.remainder(gap, scales.period)
            assert abs(gap) <= tolerances[name], (t, name, scenario)


@repeatable
@given(scripts(), parts, st.sampled_from([START, END]))
def test_a_mirrored_master_gives_the_mirrored_slave_bit_for_bit(
    scenario: dict[str, Any], cuts: list[float], mode: MasterInput
) -> None:
    scenario["start"]["master.period"] = 0.0
    mirrored = deepcopy(scenario)
    for table in (mirrored["start"], mirrored["master"], *mirrored["master"]["segments"], *mirrored["set"]):
        for name in {"output_phasing", "rest_value", "position", "velocity", "acceleration"} & table.keys():
            table[name] = -table[name]
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    signs = dict.fromkeys((*MOTION, *WRAPPED), -1.0)
    ours, theirs = (play(each, sorted(times), mode, times) for each in (scenario, mirrored))
    for time, row in ours.items():
        assert {name: signs.get(name, 1.0) * value for name, value in row.items()} == theirs[time]


dyadic = st.integers(1, 64).map(lambda number: number / 16)


@repeatable
@given(
    st.sampled_from([PARABOLA, POLYNOMIAL]),
    st.booleans(),
    st.sampled_from([1.0, -1.0]),
    st.sampled_from([START, END, ONLY]),
    st.sampled_from([0.0, 100.0, 360.0]),
    dyadic,
    st.sampled_from([1.0, 0.25, 2.0**-7]),
    st.lists(dyadic, min_size=2, max_size=12),
    st.integers(0, 10),
)
def test_against_the_sign_nothing_ramps_at_any_communication_point(
    curve: Curve,
    starting: bool,
    sign: float,
    mode: MasterInput,
    period: float,
    size: float,
    h: float,
    speeds: list[float],
    hit: int,
) -> None:
    """The master goes against the sign, from speed to speed or (its position alone) at one speed. All numbers are
    dyadic, so that a communication point is exactly where the ramp would begin: D before the rest position, of a
    polynomial's start 7/8 D. The slave stays at rest, or is the master."""
    before = size * 7 / 8 if starting and curve == POLYNOMIAL else size
    pairs = list(pairwise(speeds if mode != ONLY else speeds[:1] * len(speeds)))
    motions = [(-sign * first, -sign * (second - first) / h) for first, second in pairs]
    travels = [(velocity + 0.5 * acceleration * h) * h for velocity, acceleration in motions]
    begin = sum(travels[: hit % len(travels) + 1])
    rest = begin + sign * before
    rig = Harness(0.0, period=period, curve=curve, output_phasing=sign * size, mode=mode)
    rig.block.master.velocity = motions[0][0]
    if starting:
        rig.rest_at(rest)
    commands = {"start": starting, "stop": not starting, "rest_value": rest}
    for velocity, acceleration in motions:
        rig.move(velocity, acceleration, h, **commands).shows(EXECUTING, s=not starting)
        slave, master = rig.block.slave, rig.block.master
        if starting:
            at_rest = rest % period if period > 0.0 else rest
            assert (slave.position, slave.velocity, slave.acceleration, slave.jerk) == (at_rest, 0.0, 0.0, 0.0)
        else:
            assert (slave.position, slave.velocity) == (master.smoothed_position, master.end_velocity)
            assert (slave.acceleration, slave.jerk) == (master.end_acceleration, 0.0)


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
    """Rest at 50, phasing 10; the master rests at each position, up from 36, down again, in shares of the ramp."""
    rig = Harness(30.0 if sign > 0 else 70.0, period=period, curve=curve, output_phasing=sign * 10.0, mode=END)
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
