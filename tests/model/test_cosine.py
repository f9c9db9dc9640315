"""The cosine in degrees, against mpmath."""

import math
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from motionsync.numerics.cosine import cosine

ANGLES = st.floats(-90.0, 90.0)
ERROR = 3e-16


def exact(degrees: float) -> mpf:
    with mp.workdps(40):
        return mp.cos(mpf(degrees) * mp.pi / 180)


def error(degrees: float) -> float:
    return abs(float(mpf(cosine(degrees)) - exact(degrees)))


@pytest.mark.parametrize(
    ("degrees", "value"), [(0.0, 1.0), (60.0, 0.5), (-60.0, 0.5), (90.0, 0.0), (-90.0, 0.0), (-0.0, 1.0), (5e-324, 1.0)]
)
def test_what_is_a_simple_number_is_exact(degrees: float, value: float) -> None:
    assert cosine(degrees) == value


@pytest.mark.parametrize("degrees", range(91))
def test_whole_degrees_and_their_neighbours(degrees: int) -> None:
    for angle in (degrees, math.nextafter(degrees, 0.0), math.nextafter(degrees, 90.0), degrees + 0.5):
        if angle <= 90.0:
            assert error(float(angle)) < ERROR


def test_many_angles_at_random() -> None:
    r = Random(1)
    assert max(error(r.uniform(-90.0, 90.0)) for _ in range(5000)) < ERROR


@given(ANGLES)
def test_any_angle(degrees: float) -> None:
    assert error(degrees) < ERROR
    assert 0.0 <= cosine(degrees) <= 1.0


@given(ANGLES)
def test_it_is_symmetric(degrees: float) -> None:
    assert cosine(degrees) == cosine(-degrees)


@given(st.floats(1e-12, 1e-3))
def test_near_a_right_angle_it_keeps_its_digits(missing: float) -> None:
    degrees = 90.0 - missing
    assert cosine(degrees) == pytest.approx(float(exact(degrees)), rel=4e-16)
