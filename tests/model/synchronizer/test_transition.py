"""The Synchronizer's two laws: their ends, peaks and known numbers, and where a ramp comes again."""

import math
from fractions import Fraction
from typing import Any

import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motionsync.numerics.grid import floor
from motionsync.synchronizer.interface import Curve
from motionsync.synchronizer.transition import PhasingTransition, half_law
from tests.support.blocks.drawn import drawn

repeatable = drawn()

mp = mpmath.mp.clone()
mp.dps = 50

EPS = 2.0**-52
PARABOLA, POLYNOMIAL = Curve.PARABOLA, Curve.POLYNOMIAL_3_4_5
curves = st.sampled_from([PARABOLA, POLYNOMIAL])
sides = st.sampled_from([True, False])
signs = st.sampled_from([1.0, -1.0])


def limits(curve: Curve, starting: bool, rest: Any, size: Any) -> tuple[Any, Any]:
    """x_b and x_e in mirrored coordinates, from the table of the two laws."""
    rest, size = mp.mpf(rest), mp.mpf(size)
    gentle = size if curve == PARABOLA else size * 7 / 8
    return (rest - gentle, rest + size) if starting else (rest - size, rest + gentle)


def transition(curve: Curve, starting: bool, phasing: float, rest: float) -> PhasingTransition:
    """A command aimed at without a period, for a master just at its beginning."""
    made = PhasingTransition()
    made.command(starting, curve, phasing, rest)
    made.aim(-math.inf * made.direction, 0.0)
    return made


@pytest.mark.parametrize(
    ("curve", "z", "expected"),
    [
        (PARABOLA, 0.0, (0.0, 0.0, 4.0, 0.0)),
        (PARABOLA, 0.25, (0.125, 1.0, 4.0, 0.0)),
        (PARABOLA, 0.5, (0.5, 2.0, 4.0, 0.0)),
        (POLYNOMIAL, 0.0, (0.0, 0.0, 0.0, 60.0)),
        (POLYNOMIAL, 0.25, (106.0 / 1024.0, 270.0 / 256.0, 5.625, -7.5)),
        (POLYNOMIAL, 0.5, (0.5, 1.875, 0.0, -30.0)),
    ],
)
def test_the_law_at_its_ends_and_in_the_middle(curve: Curve, z: float, expected: tuple[float, ...]) -> None:
    assert half_law(curve, z) == expected


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize(("size", "rest"), [(90.0, 180.0), (8.0, 0.0), (0.5, -3.25)])
def test_the_ends_join_rest_and_master(curve: Curve, sign: float, size: float, rest: float) -> None:
    start = transition(curve, True, sign * size, sign * rest)
    stop = transition(curve, False, sign * size, sign * rest)
    for it, slow, fast in [(start, start.begin, start.end), (stop, stop.end, stop.begin)]:
        position, d1, d2, _ = it.follow(sign * slow)
        assert (position, d1) == (sign * rest, 0.0)
        assert abs(d2) == (0.0 if curve == POLYNOMIAL else pytest.approx(0.5 / size, rel=1e-15))
        position, d1, d2, _ = it.follow(sign * fast)
        assert position == pytest.approx(sign * fast, rel=4 * EPS)
        assert d1 == pytest.approx(1.0, rel=4 * EPS)
        assert abs(d2) == (0.0 if curve == POLYNOMIAL else pytest.approx(0.5 / size, rel=1e-15))


@repeatable
@given(curves, sides, signs, st.floats(0.0, 10.0))
def test_outside_the_ramp_the_law_keeps_its_value_at_the_end(
    curve: Curve, starting: bool, sign: float, beyond: float
) -> None:
    it = transition(curve, starting, sign * 8.0, sign * 16.0)
    for end, away in [(it.begin, it.begin - beyond), (it.end, it.end + beyond)]:
        assert it.follow(sign * away)[:2] == it.follow(sign * end)[:2]


# --- peaks ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("starting", [True, False])
@pytest.mark.parametrize("phasing", [90.0, -90.0, 1e-9, 1e12, 0.37])
def test_peak_values_are_the_greatest_of_the_law(starting: bool, phasing: float) -> None:
    size = abs(phasing)
    parabola = transition(PARABOLA, starting, phasing, 0.0)
    assert parabola.peak_acceleration() == pytest.approx(1.0 / (2.0 * size), rel=1e-15)
    assert parabola.peak_jerk() == 0.0
    it = transition(POLYNOMIAL, starting, phasing, 0.0)
    assert it.peak_acceleration() == pytest.approx(128 * math.sqrt(3) / 135 / (2.0 * size), rel=1e-14)
    assert it.peak_jerk() == pytest.approx(512 / 225 / size**2, rel=1e-14)


# --- occurrences ------------------------------------------------------------------------------------------------------


@repeatable
@given(curves, sides, signs, st.floats(0.01, 100.0), st.floats(-100.0, 100.0), st.floats(-1e4, 1e4))
@example(PARABOLA, True, 1.0, 180.0, 180.0, 0.0)
@example(PARABOLA, True, 1.0, 180.0, 180.0, 360.0)
def test_the_occurrence_aimed_at_is_the_first_not_passed(
    curve: Curve, starting: bool, sign: float, size: float, rest: float, x: float
) -> None:
    for period in (360.0, 0.1, 7.7):
        it = PhasingTransition()
        it.command(starting, curve, sign * size, sign * rest)
        it.aim(sign * x, period)
        begin, end = limits(curve, starting, rest, size)
        turns = (mp.mpf(it.begin) - begin) / mp.mpf(period)
        rounding = 1e-14 * (abs(x) + abs(rest) + size + period)
        assert abs(turns - mp.nint(turns)) * period <= rounding
        tolerance = 1e-9 * size + 1e-15 * abs(x)
        assert it.begin + tolerance >= x - rounding
        assert it.begin + tolerance - period < x + rounding
        assert it.end - it.begin == pytest.approx(float(end - begin), abs=rounding)
        assert it.rest - it.begin == pytest.approx(float(mp.mpf(rest) - begin), abs=rounding)


@pytest.mark.parametrize(
    ("x", "begin"),
    [(-400.0, -270.0), (-270.0, -270.0), (-269.0, 90.0), (0.0, 90.0), (90.0, 90.0), (91.0, 450.0), (810.0, 810.0)],
)
def test_the_ramp_from_90_to_270_comes_again_every_turn(x: float, begin: float) -> None:
    it = PhasingTransition()
    it.command(True, PARABOLA, 90.0, 180.0)
    it.aim(x, 360.0)
    assert (it.begin, it.rest, it.end) == (begin, begin + 90.0, begin + 180.0)
    assert it.armed


@pytest.mark.parametrize(("x", "armed"), [(-1e12, True), (90.0, True), (90.0 + 8e-8, True), (90.0 + 1e-7, False)])
def test_without_a_period_a_command_is_armed_up_to_its_begin(x: float, armed: bool) -> None:
    """The tolerance is 1e-9 of the phasing of 90."""
    it = PhasingTransition()
    it.command(True, PARABOLA, 90.0, 180.0)
    it.aim(x, 0.0)
    assert (it.begin, it.armed) == (90.0, armed)


@pytest.mark.parametrize(("beyond", "armed"), [(9e-10, True), (1.2e-9, False)])
@pytest.mark.parametrize("period", [0.0, 5.0])
def test_far_out_the_begin_may_be_passed_by_a_few_roundings_of_the_position(
    beyond: float, armed: bool, period: float
) -> None:
    """At 1e6 by 1e-15 of it, where 1e-9 of the phasing would be 1e-12; the position itself is rounded to 1.2e-10."""
    it = PhasingTransition()
    it.command(True, PARABOLA, 0.001, 1e6 + 0.001)
    it.aim(1e6 + beyond, period)
    assert it.begin == pytest.approx(1e6 if armed or period == 0.0 else 1e6 + period, rel=4 * EPS)
    assert it.armed == (armed or period > 0.0)


@repeatable
@given(st.floats(-1e300, 1e300) | st.floats(-10.0, 10.0))
@example(-5e-324)
@example(-1e-20)
@example(2.0**53 + 2.0)
def test_floor_is_exact_for_any_number(x: float) -> None:
    assert Fraction(floor(x)) == math.floor(Fraction(x))
