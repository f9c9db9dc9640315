"""The cube root, against mpmath."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from motionsync.numerics.cube_root import cube_root


@pytest.mark.parametrize(("x", "root"), [(0.0, 0.0), (1.0, 1.0), (8.0, 2.0), (27.0, 3.0), (1e-300, 1e-100)])
def test_simple_roots(x: float, root: float) -> None:
    assert cube_root(x) == pytest.approx(root, rel=4e-16)


@given(st.floats(1e-300, 1e300) | st.floats(-300.0, 300.0).map(lambda n: 10.0**n))
def test_any_number(x: float) -> None:
    with mp.workdps(40):
        exact = mp.cbrt(mpf(x))
        assert abs(mpf(cube_root(x)) - exact) < 4e-16 * exact
