"""When the master's path passes a position, against exact rational numbers and mpmath."""

import math
from collections.abc import Sequence
from fractions import Fraction

import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motionsync.master_path import MasterPath
from tests.model.exact_paths import (
    EPS,
    TINY,
    any_steps,
    coefficients,
    hermite,
    moderate,
    near,
    repeatable,
    sizable,
    slope,
    steps,
    stretch,
    value,
)


def crossing_time(path: MasterPath, section: int, position: float) -> float:
    """When a section of the path passes a position."""
    path.enter(section)
    return path.crossing_time(position)


def assert_crossings(path: MasterPath, parts: Sequence[float]) -> None:
    """At that time the path is at the position, to the rounding of position, time and the path's own terms.

    The bound is computed in fractions: as a float it would be 0 in steps of subnormal length."""
    exact, eps, tiny = coefficients(path), Fraction(EPS), Fraction(TINY)
    for piece in range(1, path.sections):
        first, last = path.times[piece], path.times[piece + 1]
        low, high = path.positions[piece], path.positions[piece + 1]
        assert crossing_time(path, piece, low) == first
        if high != low:
            assert crossing_time(path, piece, high) == last
            beyond = math.copysign(1.0, high - low) * (1.0 + abs(high))
            assert crossing_time(path, piece, low - beyond) == first
            assert crossing_time(path, piece, high + beyond) == last
        for part in parts:
            place = max(min(low, high), min(low + part * (high - low), max(low, high)))
            time = crossing_time(path, piece, place)
            assert first <= time <= last
            t = Fraction(time)
            size = sum(abs(c) * t**i for i, c in enumerate(exact)) + abs(Fraction(place))
            speed = abs(value(slope(exact), t)) + 2 * sum(abs(c) for c in slope(exact)) * eps * min(t, 1)
            assert abs(value(exact, t) - Fraction(place)) <= 16 * eps * size + (2 * eps * t + tiny) * speed


@repeatable
@given(sizable, sizable, sizable, any_steps, st.floats(0.0, 1.0))
@example(0.0, 2.0, -4.0, 1.0, 0.5)
@example(0.0, -2.0, 4.0, 1.0, 0.999999)
@example(1e12, 1.0, 0.0, 1e-10, 0.5)
@example(5.0, 0.0, 0.0, 1.0, 0.5)
def test_a_parabola_passes_a_place_when_it_says(p: float, v: float, a: float, h: float, part: float) -> None:
    path = MasterPath()
    path.set_parabola(p, p, v, a, h)
    assert_crossings(path, [part, 1e-9, 0.5, 1.0 - 1e-9])


@repeatable
@given(moderate, moderate, moderate, moderate, steps, st.floats(0.0, 1.0))
@example(0.0, 1.0, 0.0, 1.0, 1.0, 0.5)
@example(0.0, 1.0, 1.0, 1.0, 1.0, 0.25)
@example(0.0, 0.0, 0.0, 0.0, 1.0, 0.25)
def test_a_cubic_passes_a_place_when_it_says(
    p: float, v: float, end: float, end_velocity: float, h: float, part: float
) -> None:
    path = MasterPath()
    path.set_cubic(p, v, end, end_velocity, h)
    rounding = 256 * EPS * stretch(p, v, end, end_velocity, h)
    cubic = hermite(p, v, end, end_velocity, h)
    for piece in range(1, path.sections):
        low, high = path.positions[piece], path.positions[piece + 1]
        place = max(min(low, high), min(low + part * (high - low), max(low, high)))
        time = crossing_time(path, piece, place)
        assert path.times[piece] <= time <= path.times[piece + 1]
        assert near(float(value(cubic, Fraction(time))), Fraction(place), rounding)


@pytest.mark.parametrize(
    ("p", "v", "end", "end_velocity", "h"),
    [
        (0.0, 1.0, 0.2, 1.0, 1.0),
        (-3.0, 20.0, 5.0, -4.0, 0.5),
        (100.0, -7.0, 30.0, -90.0, 2.0),
        (0.0, 0.0, 1.0, 0.0, 1.0),
    ],
)
@pytest.mark.parametrize("part", [0.1, 0.37, 0.5, 0.8])
def test_a_cubic_is_crossed_when_mpmath_says(
    p: float, v: float, end: float, end_velocity: float, h: float, part: float
) -> None:
    path = MasterPath()
    path.set_cubic(p, v, end, end_velocity, h)
    exact = [mpmath.mpf(c.numerator) / c.denominator for c in hermite(p, v, end, end_velocity, h)]
    for piece in range(1, path.sections):
        first, last = path.times[piece], path.times[piece + 1]
        place = path.positions[piece] + part * (path.positions[piece + 1] - path.positions[piece])
        result = mpmath.findroot(
            lambda t, place=place: sum(c * t**i for i, c in enumerate(exact)) - place, (first, last), solver="anderson"
        )
        assert crossing_time(path, piece, place) == pytest.approx(float(result), abs=1e-13 * h, rel=1e-13)


@pytest.mark.parametrize("v", [1.0, -1.0, 3.0])
@pytest.mark.parametrize("a", [1e-12, -1e-12, 0.3, -0.3, 0.0])
@pytest.mark.parametrize("way", [1e-300, 1e-30, 1e-12, 1e-3])
def test_a_crossing_near_the_beginning_loses_no_digits(v: float, a: float, way: float) -> None:
    path = MasterPath()
    path.set_parabola(0.0, 0.0, v, a, 1.0)
    with mpmath.workdps(400):
        place = mpmath.mpf(math.copysign(way, v))
        root = mpmath.sqrt(mpmath.mpf(v) ** 2 + 2 * mpmath.mpf(a) * place)
        exact = float(2 * place / (v + mpmath.sign(v) * root))
    assert crossing_time(path, 1, math.copysign(way, v)) == pytest.approx(exact, rel=4 * EPS, abs=0.0)


def test_both_ways_through_a_place_have_their_own_time() -> None:
    path = MasterPath()
    path.set_parabola(0.0, 0.0, 2.0, -4.0, 1.0)  # up to 0.5 at 0.5 s and back
    assert path.sections == 3
    assert crossing_time(path, 1, 0.375) == 0.25
    assert crossing_time(path, 2, 0.375) == 0.75
    path.set_cubic(0.0, 1.0, 0.0, 1.0, 1.0)  # x = t (2 t - 1) (t - 1): through 0.05 up, down; -0.05 down, up
    assert path.sections == 4
    for piece, place in [(1, 0.05), (2, 0.05), (2, -0.05), (3, -0.05)]:
        t = crossing_time(path, piece, place)
        assert t * (2 * t - 1) * (t - 1) == pytest.approx(place, abs=1e-15)
    assert crossing_time(path, 2, 0.0) == pytest.approx(0.5, abs=1e-15)


@pytest.mark.parametrize(
    ("p", "v", "h"), [(1e12, 1.0, 1e-10), (1.0, 1.0, 1e-20), (1.0, -1e12, 1e-30), (5.0, 1.0, TINY)]
)
def test_a_step_too_short_to_move_the_master_is_crossed_at_its_beginning(p: float, v: float, h: float) -> None:
    """The velocity is not 0 but p + v h = p."""
    path = MasterPath()
    path.set_parabola(p, p, v, 0.0, h)
    assert path.positions[: path.sections + 1] == [p, p, p]
    assert crossing_time(path, 1, p) == 0.0
