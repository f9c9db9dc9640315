"""The master axis against exact rational numbers: its input modes, periods and input corrections."""

import math
from collections.abc import Sequence
from copy import deepcopy
from fractions import Fraction
from itertools import pairwise

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from motionsync.master import Master, MasterInput
from motionsync.master_path import MasterPath
from motionsync.numerics.grid import wrap
from tests.model.exact_paths import (
    EPS,
    TINY,
    allowed,
    any_steps,
    hermite,
    moderate,
    near,
    repeatable,
    slope,
    steps,
    stretch,
    value,
)
from tests.model.test_master_path import crossing_time
from tests.support.blocks.drawn import drawn
from tests.support.blocks.numbers import numbers_in

START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
periods = st.sampled_from([0.1, 0.7, 6.2, 7.7, 360.0]) | st.floats(1e-3, 1e3)


def master(mode: MasterInput, period: float = 0.0, at: Sequence[float] = (0.0, 0.0, 0.0)) -> Master:
    """An initialized master."""
    made = Master(input_mode=mode, period=period)
    set_inputs(made, *at)
    assert made.try_initialize()
    return made


def set_inputs(to: Master, position: float, velocity: float = 0.0, acceleration: float = 0.0) -> None:
    to.position, to.velocity, to.acceleration = position, velocity, acceleration


def advance(it: Master, h: float, position: float, velocity: float = 0.0, acceleration: float = 0.0) -> None:
    set_inputs(it, position, velocity, acceleration)
    assert it.try_advance(h)


def apart(value: float, exact: Fraction, period: float) -> float:
    """The distance of two positions on a circle."""
    turn = Fraction(period)
    way = (Fraction(value) - exact) % turn
    return float(min(way, turn - way))


# --- START_OF_STEP ----------------------------------------------------------------------------------------------------


@repeatable
@given(moderate, moderate, moderate, steps)
@example(1.0, 2.0, -4.0, 1.0)
@example(0.0, 0.0, 0.0, 1.0)
def test_the_start_of_a_step_is_carried_on_with_constant_acceleration(p: float, v: float, a: float, h: float) -> None:
    it = master(START)
    advance(it, h, p, v, a)
    way, gain = Fraction(v) * Fraction(h), Fraction(a) * Fraction(h)
    end = Fraction(p) + way + gain * Fraction(h) / 2
    assert it.begin == p
    assert near(it.end, end, 4 * EPS * (abs(Fraction(p)) + abs(way) + abs(gain) * Fraction(h)))
    assert near(it.end_velocity, v + gain, 2 * EPS * (abs(v) + abs(gain)))
    assert it.end_acceleration == a
    assert it.path.positions[it.path.sections] == it.end


@pytest.mark.parametrize(
    ("v", "a", "h", "times", "places"),
    [
        (2.0, -4.0, 1.0, [0.0, 0.5, 1.0], [1.0, 1.5, 1.0]),
        (-2.0, 4.0, 1.0, [0.0, 0.5, 1.0], [1.0, 0.5, 1.0]),
        (2.0, -4.0, 0.5, [0.0, 0.5], [1.0, 1.5]),
        (2.0, -4.0, 0.25, [0.0, 0.25], [1.0, 1.375]),
        (0.0, -4.0, 1.0, [0.0, 1.0], [1.0, -1.0]),
        (0.0, 0.0, 2.0, [0.0, 2.0], [1.0, 1.0]),
        (2.0, 4.0, 1.0, [0.0, 1.0], [1.0, 5.0]),
    ],
)
def test_the_parabola_is_cut_where_the_master_turns_inside_the_step(
    v: float, a: float, h: float, times: list[float], places: list[float]
) -> None:
    it = master(START)
    advance(it, h, 1.0, v, a)
    last = it.path.sections + 1
    assert (it.path.times[1:last], it.path.positions[1:last]) == (times, places)


@repeatable
@given(allowed, allowed, allowed, any_steps)
@example(0.0, 1e-320, -TINY, 1e6)
@example(1e12, 1e12, -1e12, 1.0)
def test_the_pieces_of_a_parabola_cover_the_step_and_turn_where_the_velocity_is_0(
    p: float, v: float, a: float, h: float
) -> None:
    it = master(START)
    advance(it, h, p, v, a)
    path, turn = it.path, Fraction(v) + Fraction(a) * Fraction(h)
    assert (path.times[1], path.times[path.sections], path.positions[1]) == (0.0, h, p)
    assert list(path.times[: path.sections + 1]) == sorted(path.times[: path.sections + 1])
    if abs(turn) > 2 * EPS * abs(v) and abs(v) > 1e-150 and abs(turn) > 1e-150:
        assert path.sections == (3 if turn * Fraction(v) < 0 else 2)
    if path.sections == 3:
        t = Fraction(path.times[2])
        assert near(path.times[2], -Fraction(v) / Fraction(a), EPS * t)
        top = Fraction(p) - Fraction(v) ** 2 / (2 * Fraction(a))
        assert near(path.positions[2], top, 4 * EPS * (abs(Fraction(p)) + abs(Fraction(v)) * t))


# --- END_OF_STEP ------------------------------------------------------------------------------------------------------


@repeatable
@given(moderate, moderate, moderate, moderate, moderate, steps)
@example(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
@example(0.0, 1.0, 0.0, 1.0, 5.0, 1.0)
@example(0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
def test_the_end_of_a_step_is_used_as_it_is_and_reached_along_the_cubic(
    p: float, v: float, end: float, end_velocity: float, a: float, h: float
) -> None:
    it = master(END, at=(p, v, 0.0))
    advance(it, h, end, end_velocity, a)
    assert (it.begin, it.path.positions[0]) == (p, p)
    assert (it.end, it.end_velocity, it.end_acceleration) == (end, end_velocity, a)
    cubic, tolerance = hermite(p, v, end, end_velocity, h), 64 * EPS * stretch(p, v, end, end_velocity, h)
    path = it.path
    assert (path.times[1], path.times[path.sections]) == (0.0, h)
    assert (path.positions[1], path.positions[path.sections]) == (p, end)
    for i in range(1, path.sections):
        first, last = Fraction(path.times[i]), Fraction(path.times[i + 1])
        low, high = sorted([Fraction(path.positions[i]), Fraction(path.positions[i + 1])])
        for k in range(9):
            t = first + (last - first) * k / 8
            x = value(cubic, t)
            assert low - Fraction(tolerance) <= x <= high + Fraction(tolerance)
            assert near(path.position(float(t)), x, tolerance + 4 * EPS * float(abs(value(slope(cubic), t)) * t))


@repeatable
@given(moderate, moderate, moderate, moderate, steps)
@example(0.0, 1.0, 0.0, 1.0, 1.0)
@example(0.0, -3.0, 1.0, -3.0, 2.0)
def test_a_cubic_is_cut_at_the_roots_of_its_velocity(
    p: float, v: float, end: float, end_velocity: float, h: float
) -> None:
    path = MasterPath()
    path.set_cubic(p, v, end, end_velocity, h)
    c, b, a = slope(hermite(p, v, end, end_velocity, h))
    discriminant = b * b - 4 * a * c
    scale = abs(Fraction(v)) + abs(Fraction(end_velocity)) + abs(b) * Fraction(h) + abs(a) * Fraction(h) ** 2
    for t in path.times[2 : path.sections]:
        assert 0.0 < t < h
        assert abs(value([c, b, a], Fraction(t))) <= 64 * EPS * scale
    assume(abs(discriminant) * Fraction(h) ** 2 > 1e-9 * scale**2 and abs(a) * Fraction(h) ** 2 > 1e-9 * scale)
    roots = []
    if discriminant > 0:
        with mpmath.workdps(60):
            root = mpmath.sqrt(mpmath.mpf(discriminant.numerator) / discriminant.denominator)
            a_, b_ = (mpmath.mpf(x.numerator) / x.denominator for x in (a, b))
            roots = [(-b_ + side * root) / (2 * a_) / h for side in (-1, 1)]
    assume(all(abs(u) > 1e-9 and abs(u - 1) > 1e-9 for u in roots))
    inside = sorted(float(u) for u in roots if 0 < u < 1)
    assert [t / h for t in path.times[2 : path.sections]] == pytest.approx(inside, abs=1e-6)


def test_the_first_step_to_an_end_begins_at_the_initial_inputs() -> None:
    it = master(END, at=(10.0, 2.0, 0.0))
    advance(it, 1.0, 12.0, 2.0)
    assert (it.path.positions[0], it.begin, it.path.positions[1], it.end) == (10.0, 10.0, 10.0, 12.0)
    assert it.path.velocity == 2.0


# --- POSITION_ONLY ----------------------------------------------------------------------------------------------------


@repeatable
@given(st.lists(st.tuples(moderate, steps), min_size=4, max_size=8))
def test_positions_alone_give_the_parabola_through_the_last_three(samples: list[tuple[float, float]]) -> None:
    """1st sample: at rest; 2nd: constant velocity; from the 3rd on: value, slope and bend of Lagrange's parabola."""
    it = master(ONLY, at=(7.0, 99.0, 99.0))
    assert (it.end, it.end_velocity, it.end_acceleration) == (7.0, 0.0, 0.0)
    for i, (position, h) in enumerate(samples):
        advance(it, h, position, 99.0, 99.0)
        v, a = Fraction(0), Fraction(0)
        noise = Fraction(0)
        if i > 0:
            before, h1 = Fraction(samples[i - 1][0]), Fraction(samples[i - 1][1])
            v = rate = (Fraction(position) - before) / h1
            noise = abs(rate) * EPS * 4
        if i > 1:
            oldest, h2 = Fraction(samples[i - 2][0]), Fraction(samples[i - 2][1])
            older = (before - oldest) / h2
            a = 2 * (rate - older) / (h1 + h2)
            v = rate + a * h1 / 2
            noise = (abs(rate) + abs(older)) * EPS * 16
        bend = noise / Fraction(min(step for _, step in samples))
        assert it.begin == position
        assert near(it.end_acceleration, a, bend)
        assert near(it.path.velocity, v, noise)
        assert near(it.end_velocity, v + a * Fraction(h), noise + bend * Fraction(h) + EPS * abs(a) * Fraction(h))


def test_positions_alone_agree_with_a_fitted_parabola() -> None:
    samples = [(0.0, 0.1), (1.0, 0.2), (1.5, 0.05), (4.0, 0.3), (3.0, 0.15)]
    it, times = master(ONLY), np.concatenate([[0.0], np.cumsum([h for _, h in samples])])
    for i, (position, h) in enumerate(samples):
        advance(it, h, position)
        if i >= 2:
            relative_times = times[i - 2 : i + 1] - times[i]
            bend, velocity, _ = np.polyfit(relative_times, [p for p, _ in samples[i - 2 : i + 1]], 2)
            assert it.path.velocity == pytest.approx(velocity, rel=1e-11)
            assert it.end_acceleration == pytest.approx(2 * bend, rel=1e-11)
            assert it.end == pytest.approx(np.polyval([bend, velocity, position], h), rel=1e-11)


def test_positions_alone_are_exact_from_the_third_on_for_constant_acceleration() -> None:
    it, t = master(ONLY, at=(5.0, 0.0, 0.0)), 0.0
    ends = []
    for h in [0.5, 0.25, 1.0, 0.125, 2.0, 0.5]:
        advance(it, h, 5.0 - 3.0 * t + 2.0 * t * t)
        t += h
        ends.append(it.end - (5.0 - 3.0 * t + 2.0 * t * t))
    assert ends[0] == 1.0
    assert ends[1] != 0.0
    assert ends[2:] == [0.0] * 4


def test_positions_in_nearly_the_same_instant_give_no_infinite_velocity() -> None:
    it = master(ONLY)
    for position in [0.0, 1e12, -1e12, 1e12, 0.0, 1.0]:
        advance(it, TINY, position)
        assert abs(it.end_velocity) <= 1e12
        assert abs(it.end_acceleration) <= 1e12
    advance(it, 1e6, 1.0)
    assert math.isfinite(it.end)


# --- periods ----------------------------------------------------------------------------------------------------------


@repeatable
@given(periods, st.sampled_from([START, END]), st.lists(st.integers(-1000, 1000), min_size=2, max_size=8))
def test_a_wrapped_input_is_unwrapped_next_to_where_the_master_was_expected(
    period: float, mode: MasterInput, moves: list[int]
) -> None:
    """Any number of turns in a step is followed, since the velocity gives it."""
    at, speed, turn = Fraction(0), Fraction(0), Fraction(period)
    tolerance = 8 * EPS * 150 * period
    it = master(mode, period)
    for move in moves:
        velocity = move * period / 7.0
        way = Fraction(velocity) if mode == START else (speed + Fraction(velocity)) / 2
        before, at, speed = at, at + way, Fraction(velocity)
        advance(it, 1.0, float((before if mode == START else at) % turn), velocity)
        assert near(it.end - it.begin, way, 2 * tolerance)
        assert apart(it.end, at, period) <= tolerance
        assert abs(it.begin - it.path.positions[0]) <= 2 * tolerance
        it.rebase()
        assert -tolerance <= it.end <= period + tolerance


@repeatable
@given(periods, st.sampled_from([START, END, ONLY]), st.integers(-5, 5), st.floats(0.01, 0.45))
def test_whole_turns_in_the_input_mean_nothing(period: float, mode: MasterInput, turns: int, part: float) -> None:
    plain, shifted = master(mode, period), master(mode, period)
    for i in range(1, 7):
        velocity = 0.0 if mode == ONLY else part * period
        advance(plain, 1.0, i * part * period % period, velocity)
        advance(shifted, 1.0, i * part * period % period + (turns if i > 1 else 0) * period, velocity)
        assert shifted.end == pytest.approx(plain.end, abs=32 * EPS * period * (6 + abs(turns)))
        assert shifted.begin == pytest.approx(plain.begin, abs=32 * EPS * period * (6 + abs(turns)))


def test_positions_alone_must_move_less_than_half_a_turn_only_until_the_velocity_is_known() -> None:
    it = master(ONLY, 360.0)
    at = [0.0, 80.0, 320.0, 720.0, 1280.0, 2000.0, 2880.0]  # 80 t²
    for true in at:
        advance(it, 1.0, true % 360.0)
        assert it.begin == true
    assert it.end == 3920.0


def test_a_rebased_master_is_in_the_first_turn_and_keeps_its_samples_together() -> None:
    it = master(ONLY, 10.0)
    for true in [0.0, 4.0, 8.0, 12.0, 16.0]:
        advance(it, 1.0, true % 10.0)
        it.rebase()
        assert 0.0 <= it.end < 10.0
        if true >= 8.0:
            assert (it.end_velocity, it.end_acceleration) == (4.0, 0.0)
    assert it.end == 0.0
    linear = master(START)
    advance(linear, 1.0, 1e7)
    linear.rebase()
    assert linear.end == 1e7


@pytest.mark.parametrize("period", [0.1, 0.7, 6.2, 7.7, 360.0])
@pytest.mark.parametrize("turns", [10**5 + 1, -(10**7) - 3, 10**7 + 3])
@pytest.mark.parametrize("mode", list(MasterInput))
def test_an_unwrapped_master_is_taken_into_its_turn_without_loss(mode: MasterInput, turns: int, period: float) -> None:
    """A linear encoder on a rotary machine: the input itself has many turns; its remainder is exact."""
    position = period * turns + period / 3.0
    master = Master()
    master.input_mode = mode
    master.period = period
    master.position = position
    assert master.try_initialize()
    exact = float(Fraction(position) % Fraction(period))
    for _ in range(4):
        assert master.try_advance(1e-3)
        assert wrap(master.end, period) == pytest.approx(exact, abs=1e-15 * period)
        master.rebase()


TURNS = 10_000_000


@pytest.mark.parametrize("mode", [START, END])
@pytest.mark.parametrize("period", [360.0, 0.1, 7.7])
def test_many_steps_over_ten_million_turns_leave_the_position_exact(period: float, mode: MasterInput) -> None:
    turn, h, count = Fraction(period), 1.0 / 64.0, TURNS // 500
    velocity = 500.37 * period * 64.0
    advanced = Fraction(velocity) / 64
    it = master(mode, period, (0.0, velocity, 0.0))
    for i in range(count):
        it.rebase()
        set_inputs(it, float((i if mode == START else i + 1) * advanced % turn), velocity)
        it.try_advance(h)
        if i % 500 == 0:
            assert apart(wrap(it.end, period), (i + 1) * advanced, period) <= 2 * EPS * velocity * h
    for _ in range(2):  # after a first one the master is known to stand
        it.rebase()
        advance(it, h, float(count * advanced % turn))
    assert count * advanced / turn > TURNS
    assert apart(wrap(it.end, period), count * advanced, period) <= 2 * EPS * period


@pytest.mark.parametrize("mode", [START, END])
@pytest.mark.parametrize("period", [360.0, 0.1, 7.7])
def test_few_steps_over_ten_million_turns_leave_the_position_exact(period: float, mode: MasterInput) -> None:
    """Each step is as exact as its own travel; nothing of it stays in the next one."""
    turn, velocity = Fraction(period), 1_000_000.37 * period
    it = master(mode, period, (0.0, velocity, 0.0))
    for i in range(10):
        it.rebase()
        advance(it, 1.0, float((i if mode == START else i + 1) * Fraction(velocity) % turn), velocity)
        assert apart(wrap(it.end, period), (i + 1) * Fraction(velocity), period) <= 2 * EPS * velocity
    position = Fraction(velocity) * (
        10 if mode == START else Fraction(21, 2)
    )  # half the last speed's way more, slowing down
    for _ in range(2):
        it.rebase()
        advance(it, 1.0, float(position % turn))
    assert apart(wrap(it.end, period), position, period) <= 2 * EPS * period


def test_positions_alone_are_followed_over_ten_million_turns() -> None:
    """A constant acceleration that starts gently; positions are whole and dyadic numbers, so that all is exact."""
    it, h, a = master(ONLY, 360.0), 1.0 / 64.0, 819200.0  # 100 degrees in the first step
    exact = Fraction(0)
    for i in range(6000):
        exact = Fraction(a) * i * i / (2 * 64**2)
        advance(it, h, float(exact % 360))
        following = Fraction(a) * (i + 1) ** 2 / (2 * 64**2)
        if i >= 2:
            assert apart(wrap(it.end, 360.0), following, 360.0) == 0.0
        it.rebase()
    assert exact / 360 > TURNS // 2


@pytest.mark.parametrize(("position", "period"), [(1e6 * (1 + 1e-9), 1e-9), (-1e7, 1e-9), (1e12, 9e-4)])
@pytest.mark.parametrize("mode", [START, END, ONLY])
def test_a_position_beyond_1e15_periods_is_refused(mode: MasterInput, position: float, period: float) -> None:
    it = Master(input_mode=mode, period=period, position=position)
    assert not it.try_initialize()
    it = master(mode, period)
    advance(it, 1.0, 0.0)
    before = deepcopy(it)
    it.position = before.position = position
    assert not it.try_advance(1.0)
    assert it == before
    advance(it, 1.0, 0.0)


@pytest.mark.parametrize("mode", [START, END])
def test_a_prediction_beyond_1e15_periods_is_refused(mode: MasterInput) -> None:
    it = master(mode, 1e-9)
    set_inputs(it, 0.0, 1e12)
    before = deepcopy(it)
    assert not it.try_advance(1.0)
    assert it == before
    advance(it, 1e-7, 0.0, 1e12)


def test_positions_alone_that_predict_too_many_turns_are_refused() -> None:
    it = master(ONLY, 1e-6)
    advance(it, 1e-9, 0.0)
    set_inputs(it, 4e-7)  # 400 u/s for 1e6 s: 4e14 periods, and 4e15 at the tenfold speed
    assert deepcopy(it).try_advance(1e6)
    faster = master(ONLY, 1e-6)
    advance(faster, 1e-10, 0.0)
    set_inputs(faster, 4e-7)
    before = deepcopy(faster)
    assert not faster.try_advance(1e6)
    assert faster == before


def test_1e15_periods_themselves_are_allowed() -> None:
    assert Master(period=0.001, position=1e12).try_initialize()
    assert Master(period=1.0, position=-1e12).try_initialize()


# --- the input correction ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", [START, ONLY])
def test_a_step_begins_where_the_one_before_ended_but_for_the_first(mode: MasterInput) -> None:
    it = master(mode, at=(3.0, 0.0, 0.0))
    advance(it, 1.0, 10.0, 2.0)
    assert (it.path.positions[0], it.begin) == (10.0, 10.0)
    end = it.end
    assert end == (12.0 if mode == START else 10.0)
    advance(it, 1.0, 20.0, -1.0)
    assert (it.path.positions[0], it.begin, it.path.positions[1]) == (end, 20.0, 20.0)


def test_with_a_period_the_input_correction_takes_the_short_way() -> None:
    it = master(START, 360.0)
    advance(it, 1.0, 350.0, 5.0)
    it.rebase()
    assert it.end == 355.0
    advance(it, 1.0, 2.0, 5.0)
    assert (it.path.positions[0], it.begin, it.end) == (355.0, 362.0, 367.0)
    it.rebase()
    assert it.end == 7.0
    advance(it, 1.0, 350.0, 0.0)
    assert (it.path.positions[0], it.begin, it.end) == (7.0, -10.0, -10.0)
    it.rebase()
    assert it.end == 350.0


def test_an_end_has_no_input_correction() -> None:
    it = master(END, at=(3.0, 0.0, 0.0))
    for place in [10.0, -5.0, 7.0]:
        before = it.end
        advance(it, 1.0, place, 1.0)
        assert (it.path.positions[0], it.begin) == (before, before)


# --- extremes ---------------------------------------------------------------------------------------------------------


@drawn(150)
@given(
    st.sampled_from([START, END, ONLY]),
    st.sampled_from([0.0, 0.0, 1e-9, 0.1, 360.0, 1e12]),
    st.lists(st.tuples(allowed, allowed, allowed, any_steps), min_size=1, max_size=8),
)
@example(END, 0.0, [(1e12, 1e12, 0.0, TINY), (-1e12, 1e12, 0.0, TINY)])
@example(START, 0.0, [(1e12, 1e12, 1e12, 1e6)])
@example(ONLY, 0.0, [(0.0, 0.0, 0.0, TINY), (1e12, 0.0, 0.0, TINY), (-1e12, 0.0, 0.0, 1e6)])
def test_nothing_inside_is_ever_nan_or_infinite(
    mode: MasterInput, period: float, calls: list[tuple[float, float, float, float]]
) -> None:
    it = master(mode, period)
    for position, velocity, acceleration, h in calls:
        set_inputs(it, position, velocity, acceleration)
        before = deepcopy(it)
        if not it.try_advance(h):
            assert it == before
            continue
        assert all(math.isfinite(x) for x in numbers_in(it))
        path = it.path
        assert path.times[: path.sections + 1] == sorted(path.times[: path.sections + 1])
        for piece in range(1, path.sections):
            assert math.isfinite(path.position(path.times[piece]))
            for place in (
                path.positions[piece],
                0.5 * path.positions[piece] + 0.5 * path.positions[piece + 1],
                position,
            ):
                assert path.times[piece] <= crossing_time(path, piece, place) <= path.times[piece + 1]
        it.rebase()


@pytest.mark.parametrize("mode", [START, END, ONLY])
def test_a_master_at_rest_stays_at_rest(mode: MasterInput) -> None:
    for place in [0.0, -7.25, 1e12, 0.1]:
        it = master(mode, at=(place, 0.0, 0.0))
        for h in [TINY, 1e-9, 1.0, 1e6]:
            advance(it, h, place)
            assert (it.path.positions[0], it.begin, it.end, it.end_velocity, it.end_acceleration) == (
                place,
                place,
                place,
                0.0,
                0.0,
            )
            assert it.path.sections == 2
            assert all(low == high for low, high in pairwise(it.path.positions[:3]))


def test_the_position_is_wrapped_into_its_period() -> None:
    assert [wrap(x, 360.0) for x in (0.0, 360.0, 370.0, -10.0, -360.0, -1e-20)] == [0.0, 0.0, 10.0, 350.0, 0.0, 0.0]
    assert [wrap(x, 0.0) for x in (-5.0, 1e12)] == [-5.0, 1e12]
