"""The knife between two windows, against the specification's numbers and the oracle's 50 digits."""

from math import inf, sqrt

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.motion.laws import chain_rule
from motionsync.rotary_knife.curves import FAR_BACK, Section, Way, ramp_travel, ramp_up_travel
from motionsync.rotary_knife.knife import Knife
from motionsync.rotary_knife.window import CurvePoint, Cut, Window
from tests.model.rotary_knife.geometry import Case, cases, derivatives, repeatable, window_of
from tests.oracle.numerics import mp
from tests.oracle.rotary_knife.curves import Cut as ExactCut
from tests.oracle.rotary_knife.curves import Quintic as ExactQuintic
from tests.oracle.rotary_knife.limits import Way as ExactWay
from tests.oracle.rotary_knife.limits import ramp_width, turning_margin

K = 0.6  # ° per mm
REFERENCE = Knife()


def way_for(piece: float, knife: Knife = REFERENCE, window: Window | None = None) -> Way:
    """From a cut at 0 to the next one."""
    window = window or window_of(knife, 30.0, 30.0)
    way = Way()
    way.plan(knife, window.after, window.end, Cut(piece, knife.spacing, window), True)
    return way


def slope_at(section: Section, master: float) -> float:
    _, d1, _, _ = section.at(master)
    return d1


# --- the specification's table ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("piece", "fastest", "middle"),
    [
        (600.0, 1.0, 1.0),
        (400.0, 2.102941, 2.102941),
        (300.0, 3.343750, 3.343750),
        (900.0, 1.0, 0.330357),
        (8520 / 7, 1.0, 0.0),
    ],
)
def test_a_piece_on_which_the_knife_turns_on(piece: float, fastest: float, middle: float) -> None:
    """In the middle the slope is k(1 + 15/8 D/Z) with Z = piece - 60 and D = 540 - Z."""
    way = way_for(piece)
    assert (way.exists, way.parks) == (True, False)
    assert way.peaks.d1 / K == pytest.approx(fastest, abs=1e-6)
    slope = slope_at(way.first, piece / 2) / K
    assert slope == pytest.approx(middle, abs=1e-6)
    assert slope == pytest.approx(1 + 15 / 8 * (600 - piece) / (piece - 60), abs=1e-12)


def test_the_next_longer_piece_parks() -> None:
    """15/7 of 540, and 60, is the longest piece without parking."""
    longest = 15 / 7 * 540 + 60
    assert [way_for(longest + beyond).parks for beyond in (-1e-6, 1e-6)] == [False, True]


def test_a_piece_of_1500_parks_on_two_ramps_of_540() -> None:
    """W = 2 D/k = 540 with D = 162; at 1000 mm/s 3/4 (k v)²/D and 3/2 (k v)³/D²."""
    way = way_for(1500.0)
    places = (way.first.begin, way.first.end, way.ramp_up.begin, way.ramp_up.end)
    assert places == pytest.approx((30.0, 570.0, 930.0, 1470.0))
    assert way.first.at(570.0) == pytest.approx((180.0, 0.0, 0.0, way.first.at(570.0)[3]), abs=1e-12)
    assert way.peaks.d1 == pytest.approx(K)
    assert way.peaks.d2 * 1000**2 == pytest.approx(1666.7, abs=0.05)
    assert way.peaks.d2 * 1000**2 == pytest.approx(3 / 4 * 600**2 / 162)
    assert way.peaks.d3 * 1000**3 == pytest.approx(3 / 2 * 600**3 / 162**2)


def test_a_piece_of_400_at_1000() -> None:
    way = way_for(400.0)
    assert way.peaks.d2 * 1000**2 == pytest.approx(5993.3, abs=0.05)
    assert way.peaks.d2 * 1000**2 == pytest.approx(10 / sqrt(3) * 200 / 340**2 * 1e6 * K)
    assert way.peaks.d3 * 1000**3 == pytest.approx(183187.0, abs=0.5)


def test_two_blades_turn_uniformly_for_300() -> None:
    way = way_for(300.0, Knife(spacing=180.0, park_angle=90.0))
    assert (way.peaks.d1, way.peaks.d2, way.peaks.d3) == pytest.approx((K, 0.0, 0.0), abs=1e-15)


def test_overspeed_makes_the_way_between_two_windows_slower() -> None:
    """S/k = 600 - 63 = 537 and D/k = 537 - 1.05 · 540 = -30, over Z = 540."""
    way = way_for(600.0, window=window_of(REFERENCE, 30.0, 30.0, overspeed=0.05))
    assert way.first.at(300.0)[:2] == pytest.approx((180.0, K * (1.05 - 15 / 8 * 30 / 540)))
    assert way.peaks.d2 == pytest.approx(10 / sqrt(3) * 30 * K / 540**2)


# --- in time ----------------------------------------------------------------------------------------------------------


def test_the_slave_in_time_on_a_line_that_speeds_up() -> None:
    """The third difference of positions over 20 ms of a line at 1000 mm/s and 500 mm/s²."""
    section, place, v, a = way_for(400.0).first, 120.0, 1000.0, 500.0

    def position(time: float) -> float:
        return section.at(place + v * time + a * time * time / 2)[0]

    _, d1, d2, d3 = section.at(place)
    h = 2.0**-10
    velocity, acceleration, jerk = chain_rule(d1, d2, d3, v, a)
    assert velocity == pytest.approx((position(h) - position(-h)) / (2 * h), rel=1e-4)
    assert acceleration == pytest.approx((position(h) - 2 * position(0) + position(-h)) / h**2, rel=1e-4)
    third = position(2 * h) - 2 * position(h) + 2 * position(-h) - position(-2 * h)
    assert jerk == pytest.approx(third / (2 * h**3), rel=1e-3)


# --- ramps ------------------------------------------------------------------------------------------------------------


@repeatable
@given(st.floats(1.0, 300.0), st.floats(0.1, 2.0), st.just(0.0) | st.floats(0.0, 0.05))
def test_a_ramp_joins_rest_and_window_and_never_turns_back(distance: float, slope: float, d2: float) -> None:
    """(4 D - V) w³ + (V - 3 D) w⁴ with V = slope W has at its end the slope V/W and the curvature -d2: over w it is
    6 (4 D - V) + 12 (V - 3 D) = 6 V - 12 D. Its slope is w² (3 (4 D - V) + 4 (V - 3 D) w), whose least factor is at an
    end: 12 D - 3 V or V."""
    w = ramp_travel(distance, slope, d2)
    v = slope * w
    assert (12 * distance - 6 * v) / w**2 == pytest.approx(d2, abs=1e-12)
    assert 12 * distance - 3 * v >= 0.0
    width = ramp_width(mp.mpf(distance), mp.mpf(slope), mp.mpf(d2))
    assert width is not None
    assert w == pytest.approx(float(width), rel=1e-14)


@pytest.mark.parametrize(
    ("distance", "slope", "d2"),
    [(0.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, -1.0, 0.0), (1.0, 1.0, -1.0)],
)
def test_a_state_to_which_no_ramp_leads(distance: float, slope: float, d2: float) -> None:
    """Not ahead; no slope; 9 - 12 < 0."""
    assert ramp_travel(distance, slope, d2) == 0.0


def test_the_rest_of_a_ramp_is_the_same_ramp() -> None:
    """Planned anew where the knife is, the ramp down ends where it would have ended: 270 of its 540 are left."""
    way = Way()
    window = window_of(REFERENCE, 30.0, 30.0)
    way.plan_ramp_down(REFERENCE, 30.0, window.end, 360.0)
    way.plan_ramp_down(REFERENCE, 300.0, CurvePoint(*way.first.at(300.0)), 360.0)
    assert (way.first.begin, way.first.end) == pytest.approx((300.0, 570.0))


def test_there_is_no_ramp_down_to_a_park_angle_that_has_passed() -> None:
    way = Way()
    way.plan_ramp_down(REFERENCE, 0.0, CurvePoint(181.0, K, 0.0, 0.0), 360.0)
    assert not way.exists


def test_a_ramp_up_begins_as_late_as_it_can_but_not_before_the_master_is_there() -> None:
    """Of the cut at 0 it is from -570 to -30; begun at -569.9, it is 0.1 shorter and ends at the same place."""
    window = window_of(REFERENCE, 30.0, 30.0)
    way, cut = Way(), Cut(0.0, 0.0, window)
    way.plan_ramp_up(REFERENCE, FAR_BACK, cut)
    assert way.exists
    assert (way.ramp_up.begin, way.ramp_up.end) == pytest.approx((-570.0, -30.0))
    assert way.ramp_up.at(-1000.0) == pytest.approx((-180.0, 0.0, 0.0, way.ramp_up.at(-570.0)[3]))
    assert ramp_up_travel(REFERENCE, window) == pytest.approx(540.0)
    way.plan_ramp_up(REFERENCE, -569.9, cut)
    assert (way.ramp_up.begin, way.ramp_up.end) == pytest.approx((-569.9, -30.0))
    assert way.ramp_up.at(-30.0)[:3] == pytest.approx((-18.0, K, 0.0))


def test_ramps_that_do_not_fit_are_shortened_in_the_same_ratio() -> None:
    """Park angle 60 of windows of ±60; with 9/10 of the travel that they need, each has 9/10 of its own."""
    knife = Knife(park_angle=60.0, is_horizontal=True)
    window = window_of(knife, 60.0, 60.0)
    down = ramp_travel(60.0 - window.end.position, window.end.d1, window.end.d2)
    up = ramp_travel(300.0 - window.end.position, window.end.d1, window.end.d2)
    way, cut = Way(), Cut(120.0 + 0.9 * (down + up), 360.0, window)
    way.plan_parking(knife, 60.0, window.end, cut, True)
    assert way.first.end - way.first.begin == pytest.approx(0.9 * down)
    assert way.ramp_up.end - way.ramp_up.begin == pytest.approx(0.9 * up)
    assert way.ramp_up.begin == pytest.approx(way.first.end)
    assert way.first.at(way.first.end)[:3] == pytest.approx((60.0, 0.0, 0.0), abs=1e-12)
    assert way.ramp_up.at(way.ramp_up.begin)[:3] == pytest.approx((60.0, 0.0, 0.0), abs=1e-12)
    way.plan_parking(knife, 60.0, window.end, cut, False)
    assert not way.exists


@pytest.mark.parametrize("piece", [60.0, 59.0, 10.0])
def test_two_windows_that_touch_leave_no_way(piece: float) -> None:
    way = way_for(piece)
    assert not way.exists


def test_a_knife_that_must_not_park_has_no_way_for_a_long_piece() -> None:
    assert not way_for(1500.0, Knife(may_park=False)).exists
    assert way_for(900.0, Knife(may_park=False)).exists


# --- the oracle -------------------------------------------------------------------------------------------------------


@repeatable
@given(cases(), st.floats(0.05, 6.0), st.floats(0.0, 1.0))
def test_any_way(case: Case, share: float, place: float) -> None:
    """Turning or parking, and where the knife is anywhere on it, as the oracle has it."""
    slope = case.window.slope
    pitch = case.around + share * case.window.way_to(case.window, case.knife.spacing) / slope
    exact = case.exact_window
    begin, point = exact.after, exact.at(exact.after)
    cut = ExactCut(exact, mp.mpf(pitch), case.spacing)
    assume(abs(turning_margin(begin, point, cut)) > 1e-9 * slope)
    expected = case.exact_knife.turning(begin, point, cut) or case.exact_knife.parking(begin, point, cut)
    way = way_for(pitch, case.knife, case.window)
    assert isinstance(expected, ExactWay)
    assert (way.exists, way.parks) == (True, expected.parks)
    for section, curve in zip((way.first, way.ramp_up), expected.curves, strict=False):
        assert_section(section, curve, place, case.knife.turn)
    peaks = (way.peaks.d1, way.peaks.d2, way.peaks.d3)
    limits = case.exact_knife.cycle_extremes(expected, None, exact)
    assert peaks == pytest.approx([float(x) for x in limits], rel=1e-10)


def assert_section(section: Section, curve: ExactQuintic, share: float, turn: float) -> None:
    width = float(curve.width)
    assert (section.begin, section.end) == pytest.approx((float(curve.begin), float(curve.end)), rel=1e-11)
    master = section.begin + share * (section.end - section.begin)
    for order, (value, expected) in enumerate(zip(section.at(master), curve.at(mp.mpf(master)), strict=True)):
        assert value == pytest.approx(float(expected), rel=1e-9, abs=1e-10 * turn / width**order)


@repeatable
@given(cases(), st.floats(0.02, 0.98), st.floats(0.05, 4.0))
def test_a_way_planned_anew(case: Case, place: float, share: float) -> None:
    """From anywhere on the ramp down to a cut at another place; without shortening."""
    way, window = Way(), case.window
    way.plan_ramp_down(case.knife, window.after, window.end, case.knife.spacing)
    begin = way.first.begin + place * (way.first.end - way.first.begin)
    point = CurvePoint(*way.first.at(begin))
    natural = (case.knife.spacing + window.begin.position - point.position) / window.slope
    cut = Cut(begin + share * natural + window.before, case.knife.spacing, window)
    exact = ExactCut(case.exact_window, mp.mpf(cut.place), case.spacing)
    assume(abs(turning_margin(mp.mpf(begin), derivatives(point), exact)) > 1e-9 * window.slope)
    way.plan(case.knife, begin, point, cut, False)
    departure = (mp.mpf(begin), derivatives(point), exact)
    expected = case.exact_knife.turning(*departure) or case.exact_knife.parking(*departure, shortened=False)
    assert way.exists == (expected is not None)
    if expected is not None:
        assert way.parks == expected.parks
        for section, curve in zip((way.first, way.ramp_up), expected.curves, strict=False):
            assert_section(section, curve, place, case.knife.turn)


@repeatable
@given(cases(), st.floats(0.05, 6.0))
def test_the_sections_join_the_windows(case: Case, share: float) -> None:
    """Position, slope and curvature of both windows, and rest in between."""
    window = case.window
    pitch = case.around + share * window.way_to(window, case.knife.spacing) / window.slope
    way = way_for(pitch, case.knife, window)
    last = way.ramp_up if way.parks else way.first
    arriving = Cut(pitch, case.knife.spacing, window)
    for order, tolerance in enumerate((1e-12, 1e-11, 1e-10)):
        scale = case.knife.turn / (last.end - last.begin) ** order
        assert last.at(inf)[order] == pytest.approx(arriving.at(arriving.begin())[order], abs=tolerance * scale)
        scale = case.knife.turn / (way.first.end - way.first.begin) ** order
        assert way.first.at(-inf)[order] == pytest.approx(window.at(window.after)[order], abs=tolerance * scale)
