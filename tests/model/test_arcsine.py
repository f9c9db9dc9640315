"""The arcsine, against mpmath."""

import math
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from motionsync.numerics.arcsine import arcsine

ERROR = 2e-16  # relative


def error(y: float) -> float:
    with mp.workdps(40):
        exact = mp.asin(mpf(y))
        return float(abs(mpf(arcsine(y)) - exact) / abs(exact))


@pytest.mark.parametrize(
    ("y", "value"), [(0.0, 0.0), (0.5, math.pi / 6), (1.0, math.pi / 2), (-1.0, -math.pi / 2), (5e-324, 5e-324)]
)
def test_simple_angles(y: float, value: float) -> None:
    assert arcsine(y) == pytest.approx(value, rel=2e-16)


def test_the_sign_of_0_is_kept() -> None:
    assert math.copysign(1.0, arcsine(-0.0)) == -1.0


@pytest.mark.parametrize("y", [0.5, 0.94, 0.9424777960769379, 1.0, 1e-8, 0.25])
def test_neighbours_of_places_where_the_formula_changes(y: float) -> None:
    for value in (y, math.nextafter(y, 0.0), math.nextafter(y, 2.0)):
        if value <= 1.0:
            assert error(value) < ERROR


def test_many_numbers_at_random() -> None:
    r = Random(1)
    assert max(error(r.uniform(-1.0, 1.0)) for _ in range(20000)) < ERROR


@given(st.floats(-1.0, 1.0).filter(lambda y: abs(y) > 1e-300))
def test_any_number(y: float) -> None:
    assert error(y) < ERROR
    assert arcsine(-y) == -arcsine(y)


@given(st.floats(1e-16, 1e-3))
def test_near_1_it_keeps_its_digits(missing: float) -> None:
    assert error(1.0 - missing) < ERROR
