"""The Synchronizer on random scripts is its oracle; no ramp begins against its sign, wherever a step ends."""

from itertools import pairwise
from typing import Any

from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.interface import Curve
from tests.model.synchronizer.harness import END, EXECUTING, ONLY, PARABOLA, POLYNOMIAL, START, Harness
from tests.model.synchronizer.scripted_runs import Scales, assert_as_oracle, coinciding, parts, scripts
from tests.support.drawn import drawn
from tests.support.oracle_runs import corners, grid

repeatable = drawn(250)


@repeatable
@given(scripts(), parts, st.sampled_from([1, 3, 8, 100]))
def test_with_inputs_of_the_step_s_start_the_block_is_its_oracle(
    scenario: dict[str, Any], cuts: list[float], often: int
) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    ends = times | grid(scenario, scenario["stop_time"] / often)
    assert_as_oracle(scenario, ends, START, times, Scales(scenario).tolerances())


@repeatable
@given(scripts(jumps=False), parts)
def test_with_inputs_of_the_step_s_end_the_block_is_its_oracle(scenario: dict[str, Any], cuts: list[float]) -> None:
    times = corners(scenario) | {part * scenario["stop_time"] for part in cuts}
    assert_as_oracle(scenario, times, END, times, Scales(scenario).tolerances())


@repeatable
@given(scripts(single=True), st.sampled_from([0.05, 0.031, 0.1]))
def test_with_positions_only_the_block_is_its_oracle(scenario: dict[str, Any], h: float) -> None:
    """Once the velocity is known, after three samples; velocity and acceleration as exact as differences allow."""
    times = {time for time in corners(scenario) if time > 0.4} | {k * 0.25 for k in range(2, 13)}
    ends = corners(scenario) | grid(scenario, h) | times
    shortest = min(b - a for a, b in pairwise(sorted(ends)))
    assume(shortest > 1e-3)
    scales = Scales(scenario)
    velocity = 32 * 2.0**-53 * (scales.master_position + scales.velocity) / shortest
    tolerances = scales.tolerances(velocity=velocity, acceleration=4 * velocity / shortest)
    assert_as_oracle(scenario, ends, ONLY, times, tolerances)


@drawn(300)
@given(st.randoms(use_true_random=True).map(coinciding), st.sampled_from([1.0, 0.25, 0.0625]))
def test_events_may_coincide_with_steps_and_with_each_other(scenario: dict[str, Any], h: float) -> None:
    """Compared in between, where what has happened at such an instant has its consequences."""
    times = {k / 4 + 5 / 512 for k in range(int(4 * scenario["stop_time"]))}
    assert_as_oracle(scenario, grid(scenario, h) | times, START, times, Scales(scenario).tolerances())


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
