"""The Synchronizer on random scripts is its oracle, in steps of any size and with each kind of inputs."""

from itertools import pairwise
from typing import Any

from hypothesis import assume, given
from hypothesis import strategies as st

from tests.model.synchronizer.harness import END, ONLY, START
from tests.model.synchronizer.scripted_runs import Scales, assert_as_oracle, coinciding, parts, scripts
from tests.support.blocks.drawn import drawn
from tests.support.blocks.oracle_runs import corners, grid

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
