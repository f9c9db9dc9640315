"""The window about a cut, against hand-computed places and the oracle's 50 digits."""

from math import asin, cos, degrees, pi, sin, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.rotary_knife.knife import Knife
from motionsync.rotary_knife.window import Cut, is_narrow, leaves_way
from tests.model.rotary_knife.geometry import Case, cases, repeatable, window_of
from tests.oracle.numerics import mp

K = 0.6  # ° per mm


def horizontal(**values: float) -> Knife:
    return Knife(is_horizontal=True, **values)  # type: ignore[arg-type]


def test_a_tangential_window_is_a_straight_line() -> None:
    window = window_of(Knife(), 30.0, 20.0)
    assert window.at(10.0) == pytest.approx((6.0, K, 0.0, 0.0), abs=0.0)
    assert (window.begin.position, window.end.position) == pytest.approx((-18.0, 12.0))


def test_overspeed_and_factor_make_it_steeper() -> None:
    """1.05 of k, on a line whose material moves 1.2 of its master's travel; the window is 25 of the master long."""
    window = window_of(Knife(), 30.0, 30.0, factor=1.2, overspeed=0.05)
    assert window.slope == pytest.approx(1.05 * 1.2 * K)
    assert (window.before, window.after) == pytest.approx((25.0, 25.0))
    assert window.end.position == pytest.approx(30.0 * 1.05 * K)


def test_the_edge_of_a_horizontal_window() -> None:
    """Half of 60: arcsin(0.2 pi) = 38.926 degrees, the slope k / cos of it."""
    edge = window_of(horizontal(), 60.0, 60.0).end
    assert edge.position == pytest.approx(38.926175447, abs=5e-10)
    assert edge.position == pytest.approx(degrees(asin(0.2 * pi)), rel=1e-14)
    assert edge.d1 / K == pytest.approx(1.285419437, abs=5e-10)
    assert edge.d1 == pytest.approx(K / sqrt(1 - (0.2 * pi) ** 2), rel=1e-14)


@repeatable
@given(st.floats(-0.15, 0.15), st.floats(50.0, 5000.0))
def test_the_edge_is_at_the_material_and_as_fast_along_it(share: float, circumference: float) -> None:
    """The edge is at r sin(angle) along the material and moves along it with r cos(angle) times its angular speed."""
    radius = circumference / (2 * pi)
    travel = share * circumference
    slave, d1, d2, _ = window_of(horizontal(circumference=circumference), 1.0, 1.0).at(travel)
    angle, rate = slave * pi / 180, d1 * pi / 180
    assert radius * sin(angle) == pytest.approx(travel, rel=1e-13, abs=1e-300)
    assert radius * cos(angle) * rate == pytest.approx(1.0, rel=1e-13)
    assert cos(angle) * d2 * pi / 180 == pytest.approx(sin(angle) * rate**2, rel=1e-12, abs=1e-300)


@repeatable
@given(cases(), st.floats(-1.0, 1.0))
def test_any_window(case: Case, share: float) -> None:
    """Within a few roundings of 50 digits, in both halves and at both ends."""
    window, exact = case.window, case.exact_window
    travel = share * (window.after if share > 0.0 else window.before)
    for value, expected in zip(window.at(travel), exact.at(mp.mpf(travel)), strict=True):
        assert value == pytest.approx(float(expected), rel=3e-15, abs=1e-300)
    for point, place in ((window.begin, -exact.before), (window.end, exact.after)):
        for value, expected in zip((point.position, point.d1, point.d2, point.d3), exact.at(place), strict=True):
            assert value == pytest.approx(float(expected), rel=3e-15, abs=1e-300)


@repeatable
@given(cases(), st.floats(-1.0, 1.0))
def test_all_derivatives_are_greatest_at_the_ends(case: Case, share: float) -> None:
    window = case.window
    end = window.end if share > 0.0 else window.begin
    _, d1, d2, d3 = window.at(share * (window.after if share > 0.0 else window.before))
    assert d1 <= end.d1 * (1 + 1e-15)
    assert abs(d2) <= abs(end.d2) * (1 + 1e-15)
    assert d3 <= end.d3 * (1 + 1e-15)


@repeatable
@given(cases(), st.floats(-1e6, 1e6), st.floats(-1.0, 1.0))
def test_a_cut_has_its_window_where_it_is(case: Case, place: float, share: float) -> None:
    cut = Cut(place, 360.0, case.window)
    assert (cut.begin(), cut.end()) == (place - case.window.before, place + case.window.after)
    position, d1, _, _ = cut.at(place + share)
    offset, slope, _, _ = case.window.at((place + share) - place)
    assert (position, d1) == (360.0 + offset, slope)


@pytest.mark.parametrize(
    ("mode", "before", "after", "narrow"),
    [
        (True, 90.0, 90.0, True),
        (True, 90.1, 20.0, False),
        (True, 20.0, 90.1, False),
        (False, 250.0, 250.0, True),
    ],
)
def test_a_horizontal_window_is_at_most_so_wide(mode: bool, before: float, after: float, narrow: bool) -> None:
    """0.15 of 600 on either side."""
    knife = Knife(is_horizontal=mode)
    assert (is_narrow(knife, before) and is_narrow(knife, after)) == narrow


@pytest.mark.parametrize(
    ("blades", "park_angle", "half", "leaves"),
    [
        (1, 180.0, 290.0, True),
        (1, 180.0, 300.0, False),
        (2, 90.0, 30.0, True),
        (2, 180.0, 30.0, False),
        (1, 18.0, 30.0, False),
        (1, 18.001, 30.0, True),
        (1, 342.0, 30.0, False),
        (1, 341.999, 30.0, True),
    ],
)
def test_the_park_angle_has_to_be_between_two_windows(
    blades: int, park_angle: float, half: float, leaves: bool
) -> None:
    knife = Knife(spacing=360.0 / blades, park_angle=park_angle)
    assert leaves_way(knife, window_of(knife, half, half)) == leaves
