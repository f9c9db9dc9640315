"""The generator of two clocks: which telegram is seen when, and what is true then."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.runner.telegrams import Telegrams
from motionsync_fmu.scenario.clocks import Clocks, Rate
from motionsync_fmu.scenario.script import Script, Segment

T = 0.002


def clocks(ppm: float = 0.0, **values: object) -> Clocks:
    """A sender that is faster by so many ppm."""
    return Clocks(T, (Rate(0.0, T / (1.0 + 1e-6 * ppm)),), **values)  # type: ignore[arg-type]


@given(st.floats(-5000.0, 5000.0), st.floats(0.0, 0.999))
def test_without_jitter_the_latest_telegram_is_the_whole_part_of_the_true_index(ppm: float, phase: float) -> None:
    """But where the true index is whole to rounding."""
    c = clocks(ppm, phase=phase)
    true = c.true_index(np.arange(3000) * T)
    np.testing.assert_allclose(true, phase + np.arange(3000) * (1.0 + 1e-6 * ppm), rtol=1e-12)
    clear = np.abs(true - np.round(true)) > 1e-9
    np.testing.assert_array_equal(c.received_indices(3000)[clear], np.floor(true)[clear])


@pytest.mark.parametrize(("ppm", "step"), [(1000.0, 2), (-1000.0, 0)])
def test_a_beat_comes_each_million_over_ppm_cycles(ppm: float, step: int) -> None:
    """A faster sender's index then skips one, a slower one's repeats."""
    steps = np.diff(clocks(ppm, phase=0.5).received_indices(4400))
    beats = np.flatnonzero(steps != 1)
    assert steps[beats].tolist() == [step] * 4
    assert np.diff(beats).tolist() == [1000] * 3


@pytest.mark.parametrize(("cycle", "steps"), [(2.0 * T, [0, 1]), (0.5 * T, [2]), (3.0 * T, [0, 0, 1])])
def test_a_data_cycle_may_be_a_multiple_or_a_part(cycle: float, steps: list[int]) -> None:
    index = Clocks(T, (Rate(0.0, cycle),), phase=0.3).received_indices(60)
    assert sorted(np.diff(index)[: len(steps)].tolist()) == sorted(steps)
    assert index[-1] == int(0.3 + 59 * T / cycle)


def test_a_telegram_shows_the_axis_at_its_instant_without_jitter() -> None:
    axis = Script(10.0, 100.0, 0.0, [Segment(1.0), Segment(2.0, acceleration=-30.0)])
    c = clocks(300.0, phase=0.4, jitter=0.05, seed=3, first_index=65000)
    seen = c.telegrams(axis, 1200)
    sent = (seen.index - 65000 - 0.4) * T / 1.0003
    later = np.maximum(sent - 1.0, 0.0)
    np.testing.assert_allclose(seen.motion[:, 0], 10.0 + 100.0 * sent - 15.0 * later**2, atol=1e-9)
    np.testing.assert_allclose(seen.motion[:, 1], 100.0 - 30.0 * later, atol=1e-9)
    np.testing.assert_array_equal(seen.motion[:, 2], np.where(later > 0.0, -30.0, 0.0))
    np.testing.assert_allclose(c.send_times(seen.index), sent, atol=1e-12)


def test_the_index_wraps_as_a_word_does_and_the_true_one_never() -> None:
    axis = Script(0.0, 1.0, 0.0, [])
    seen = clocks(0.0, phase=0.5, first_index=65530).telegrams(axis, 20)
    assert seen.cycle_index.tolist() == [*range(65530, 65536), *range(14)]
    assert seen.index.tolist() == list(range(65530, 65550))
    np.testing.assert_allclose(seen.true_index, 65530.5 + np.arange(20))


def test_before_the_first_telegram_arrives_the_one_before_is_seen() -> None:
    axis = Script(0.0, 1.0, 0.0, [])
    late = next(s for s in range(100) if clocks(jitter=0.01, seed=s).received_indices(1)[0] == -1)
    seen = clocks(jitter=0.01, seed=late).telegrams(axis, 1)
    assert seen.cycle_index.tolist() == [65535]
    assert seen.motion[0, 0] == -T


def test_lost_telegrams_leave_the_one_before_them() -> None:
    c = clocks(phase=0.5, lost=((10, 15), (20, 20)))
    assert c.received_indices(24).tolist() == [*range(10), *[9] * 6, 16, 17, 18, 19, 19, 21, 22, 23]
    shifted = clocks(phase=0.5, lost=((110, 115), (120, 120)), first_index=100)
    np.testing.assert_array_equal(shifted.received_indices(24), c.received_indices(24) + 100)


def test_a_change_of_the_sender_s_cycle_keeps_the_phase() -> None:
    rates = (Rate(0.0, T), Rate(1.0, T / 1.001), Rate(3.0, T / 0.999))
    c = Clocks(T, rates, phase=0.25)
    times = np.array([-0.01, 0.5, 1.0, 2.0, 3.0, 4.0])
    expected = [0.25 - 5.0, 250.25, 500.25, 1000.75, 1501.25, 2000.75]
    np.testing.assert_allclose(c.true_index(times), expected, atol=1e-9)
    index = np.arange(-5, 2500)
    np.testing.assert_allclose(c.true_index(c.send_times(index)), index, atol=1e-9)


def normal(x: float) -> float:
    """The probability that a normal number of deviation 1 is below x."""
    return 0.5 * (1.0 + math.erf(x / math.sqrt(2.0)))


@pytest.mark.parametrize("cycle", [T, 2.0 * T, 0.5 * T])
def test_jitter_is_gaussian_and_independent_on_both_sides(cycle: float) -> None:
    """A telegram that is due in d has arrived with the probability that two normal numbers differ by more than d."""
    cycles, seeds = 20_000, range(50)
    due = np.array([-0.02, -0.01, 0.0, 0.01, 0.02])  # of the receiver's cycle
    arrived = np.zeros((len(seeds), len(due)))
    for seed in seeds:
        c = Clocks(T, (Rate(0.0, cycle / 1.00001),), phase=0.95, jitter=0.01, seed=seed)
        true = c.true_index(np.arange(cycles) * T)
        result = c.received_indices(cycles) >= np.round(true)
        distance = (np.round(true) - true) * cycle / T
        arrived[seed] = [result[np.abs(distance - d) < 0.0005].mean() for d in due]
    share = [normal(-d / (0.01 * math.sqrt(2.0))) for d in due]
    np.testing.assert_allclose(arrived.mean(axis=0), share, atol=0.02)
    assert len(np.unique(arrived[:, 2])) > 10


def test_jitter_never_changes_the_order() -> None:
    """However great it is: a cycle never sees an older telegram than the one before it."""
    for cycle in (T, 3.0 * T, T / 3.0):
        index = Clocks(T, (Rate(0.0, cycle / 1.0002),), jitter=1.0, seed=1).received_indices(20_000)
        assert np.diff(index).min() >= 0


def test_the_same_seed_gives_the_same_run_however_long() -> None:
    c = clocks(100.0, phase=0.99, jitter=0.02, seed=7)
    np.testing.assert_array_equal(c.received_indices(500), c.received_indices(3000)[:500])
    assert (c.received_indices(3000) != clocks(100.0, phase=0.99, jitter=0.02, seed=8).received_indices(3000)).any()


@pytest.mark.parametrize(
    ("begin", "end", "shown"),
    [
        (0.0, 0.0, 0),  # the initialization
        (0.0, T, 0),
        (T, 2.0 * T, 1),
        (3 * 0.1, 3 * 0.1 + T, 150),  # a little after the instant, by rounding
        (0.3 - 1e-9, 0.3, 149),  # a little before it: it acts with the next step
        (1.2 * T, 1.9 * T, 1),  # no cycle in the step: what has been shown
        (0.7 * T, 1.4 * T, 1),  # the cycle acts within the step
        (0.5 * T, 4.5 * T, 1),  # the first of several
    ],
)
def test_a_step_shows_its_first_cycle_s_telegram(begin: float, end: float, shown: int) -> None:
    assert Telegrams(T).shown(begin, end) == shown


def test_steps_up_to_a_cycle_show_each_telegram_with_the_step_in_which_its_cycle_acts() -> None:
    c = clocks()
    for h in (T, 0.0007, 0.0019999):
        grid = [i * h for i in range(int(1.0 / h))]
        acting = [(begin, end) for begin, end in pairwise(grid) if c.count_cycles(end) > c.count_cycles(begin)]
        assert [Telegrams(T).shown(begin, end) for begin, end in acting] == list(range(c.count_cycles(grid[-1])))
