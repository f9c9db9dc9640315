"""Exact paths of a master, and the random numbers of its tests."""

from collections.abc import Sequence
from fractions import Fraction

from hypothesis import strategies as st

from motionsync.master_path import MasterPath
from tests.support.blocks.drawn import drawn

EPS = 2.0**-52
repeatable = drawn(200)
TINY = 5e-324
moderate = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda x: 0.0 if abs(x) < 1e-6 else x)
allowed = st.floats(-1e12, 1e12) | st.sampled_from([0.0, 1e12, -1e12, TINY, -TINY, 1e-160, -1e-160])
sizable = allowed.map(lambda x: 0.0 if abs(x) < 1e-100 else x)
steps = st.floats(1e-4, 1e2)
any_steps = st.sampled_from([TINY, 1e-310, 1e-200, 1e-154, 1e-100, 1e-50, 1e-9, 1.0, 1e6]) | st.floats(TINY, 1e6)


def near(value: float, exact: Fraction, tolerance: float | Fraction) -> bool:
    return abs(Fraction(value) - exact) <= Fraction(tolerance) + Fraction(TINY)


def hermite(p: float, v: float, end: float, end_velocity: float, h: float) -> list[Fraction]:
    """Coefficients of the cubic in t, exact, the lowest first."""
    p0, v0, p1, v1, T = (Fraction(x) for x in (p, v, end, end_velocity, h))  # noqa: N806
    return [p0, v0, (3 * (p1 - p0) / T - 2 * v0 - v1) / T, (2 * (p0 - p1) / T + v0 + v1) / T**2]


def value(coefficients: Sequence[Fraction], t: Fraction) -> Fraction:
    result = Fraction(0)
    for coefficient in reversed(coefficients):
        result = result * t + coefficient
    return result


def slope(coefficients: Sequence[Fraction]) -> list[Fraction]:
    return [i * coefficient for i, coefficient in enumerate(coefficients)][1:]


def stretch(p: float, v: float, end: float, end_velocity: float, h: float) -> float:
    """What rounding errors of positions on the cubic are relative to."""
    return abs(p) + abs(end) + (abs(v) + abs(end_velocity)) * h


def coefficients(path: MasterPath) -> list[Fraction]:
    return [Fraction(x) for x in (path.origin, path.velocity, path.c2, path.c3)]
