"""What a rotary knife can do, against the specification's figures, closed forms and the oracle's 50 digits."""

from math import cbrt, sqrt

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.cutting.piece import UNLIMITED
from motionsync.motion.laws import chain_rule
from motionsync.rotary_knife.curves import Peaks, admissible_velocity, keeps_limits
from motionsync.rotary_knife.knife import Knife
from motionsync.rotary_knife.limits import NO_LENGTH, CycleLimit, EarliestCut, LengthLimits
from motionsync.rotary_knife.window import CurvePoint, Cut, Window, leaves_way
from tests.model.rotary_knife.fake_blocks import KnifeGeometry
from tests.model.rotary_knife.geometry import Case, cases, derivatives, repeatable, window_of
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import Cut as ExactCut
from tests.oracle.rotary_knife.limits import (
    cycle_velocity,
    longest_turning,
    ramp_velocity,
    shortest_way,
)
from tests.oracle.rotary_knife.ways import Departure
from tests.support.blocks.drawn import drawn
from tests.support.compiler.compiled import Compiled, equal

K = 0.6  # ° per mm
REFERENCE = Knife()
WINDOW = window_of(REFERENCE, 30.0, 30.0)
HORIZONTAL = Knife(is_horizontal=True)
ROUNDING = 1e-9


def piece_velocity(pitch: float, knife: Knife = REFERENCE, window: Window = WINDOW) -> float:
    cycle = CycleLimit()
    cycle.solve_piece(knife, window, window, pitch)
    return cycle.max_line_velocity


def lengths_of(knife: Knife, window: Window) -> LengthLimits:
    lengths = LengthLimits()
    lengths.prepare(knife, window)
    return lengths


def shortest(velocity: float, knife: Knife = REFERENCE, window: Window = WINDOW) -> float:
    lengths = lengths_of(knife, window)
    lengths.solve_shortest(knife, window, velocity)
    return lengths.shortest


# --- the specification's figures --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pitch", "velocity"),
    [
        (300.0, 1085.767047),
        (400.0, 1760.765087),
        (600.0, 6000.0),
        (900.0, 3800.184663),
        (1500.0, 4326.748711),
        (UNLIMITED, 4326.748711),
        (60.0, 0.0),
        (10.0, 0.0),
    ],
)
def test_the_greatest_line_velocity(pitch: float, velocity: float) -> None:
    assert piece_velocity(pitch) == pytest.approx(velocity, abs=5e-7)


def test_the_greatest_line_velocity_out_of_rest() -> None:
    """Jerk 3/2 (k v)³/162² = 1e6; the ramp is 540 long and ends with the window's beginning."""
    cycle = CycleLimit()
    cycle.solve_ramp_up(REFERENCE, WINDOW)
    assert cycle.max_line_velocity == pytest.approx(4326.748711, abs=5e-7)
    assert cycle.max_line_velocity == pytest.approx(cbrt(1e6 * 162**2 / 1.5) / K, rel=1e-13)
    assert (cycle.way.ramp_up.begin, cycle.way.ramp_up.end) == pytest.approx((-570.0, -30.0))


@pytest.mark.parametrize(("velocity", "pitch"), [(500.0, 183.312645), (1000.0, 284.730278), (2000.0, 427.567549)])
def test_the_shortest_piece(velocity: float, pitch: float) -> None:
    assert shortest(velocity) == pytest.approx(pitch, abs=5e-7)


def test_no_piece_is_long_enough_for_a_line_faster_than_the_window_admits() -> None:
    assert shortest(6000.1) == NO_LENGTH
    assert shortest(6000.0) <= 600.0


@pytest.mark.parametrize(
    ("half", "longest", "width", "velocity"),
    [(60.0, 669.469446, 251.353875, 1342.58), (80.0, 455.986303, 134.861154, 674.55)],
)
def test_horizontal_windows(half: float, longest: float, width: float, velocity: float) -> None:
    """The jerk at the window's edge limits the line: k (2 pi/C)² (1 + 2 y²)/(1 - y²)^2.5, y = 2 pi half/C."""
    window = window_of(HORIZONTAL, half, half)
    lengths = lengths_of(HORIZONTAL, window)
    assert lengths.longest == pytest.approx(longest, abs=5e-7)
    y2 = (2 * 3.141592653589793 * half / 600) ** 2
    third = K * (2 * 3.141592653589793 / 600) ** 2 * (1 + 2 * y2) / (1 - y2) ** 2.5
    assert piece_velocity(600.0, HORIZONTAL, window) == pytest.approx(velocity, abs=5e-3)
    assert piece_velocity(600.0, HORIZONTAL, window) == pytest.approx(cbrt(1e6 / third), rel=1e-13)
    cycle = CycleLimit()
    cycle.solve_ramp_up(HORIZONTAL, window)
    assert -cycle.way.ramp_up.begin - half == pytest.approx(width, abs=5e-7)
    cycle.solve_piece(HORIZONTAL, window, window, 600.0)
    assert cycle.way.parks == (half == 80.0)


@pytest.mark.parametrize(("before", "after"), [(20.0, 80.0), (80.0, 20.0)])
def test_the_wider_half_of_a_horizontal_window_limits_the_line(before: float, after: float) -> None:
    """674.55 as for both halves of 80, whether the cycle leaves the window there or enters it; at the best length."""
    window = window_of(HORIZONTAL, before, after)
    lengths = lengths_of(HORIZONTAL, window)
    assert piece_velocity(lengths.fastest, HORIZONTAL, window) == pytest.approx(674.55, abs=5e-3)
    assert lengths.max_line_velocity == pytest.approx(674.55, abs=5e-3)


def test_the_longest_piece_without_parking() -> None:
    assert lengths_of(REFERENCE, WINDOW).longest == pytest.approx(1217.142857, abs=5e-7)
    assert lengths_of(REFERENCE, WINDOW).fastest == pytest.approx(600.0)


# --- closed forms -----------------------------------------------------------------------------------------------------


def test_the_least_of_three_limits_counts() -> None:
    """360/0.5 = 720, sqrt(7200/0.02) = 600, cbrt(8e6/0.001) = 2000; without a curve nothing limits the line."""
    knife = Knife(max_velocity=360.0, max_acceleration=7200.0, max_jerk=8e6)
    for peaks, velocity in (((0.5, 0.0, 0.0), 720.0), ((0.5, 0.02, 0.0), 600.0), ((0.0, 0.0, 0.001), 2000.0)):
        assert admissible_velocity(knife, Peaks(*peaks)) == pytest.approx(velocity, rel=1e-14)
    assert admissible_velocity(knife, Peaks()) == 1e300


def test_a_cut_is_late_above_the_limit_but_for_rounding() -> None:
    knife, peaks = Knife(max_velocity=500.0), Peaks(0.5, 0.0, 0.0)
    assert [keeps_limits(knife, peaks, 1000.0 * factor) for factor in (1.0, 1 + 0.9e-9, 1 + 1.1e-9)] == [
        True,
        True,
        False,
    ]


@repeatable
@given(cases(), st.floats(0.2, 2.1))
def test_closed_forms_of_turning_on(case: Case, share: float) -> None:
    """k' + 15/8 D/Z, 10/sqrt(3) |D|/Z², 60 |D|/Z³ of a TANGENTIAL knife."""
    assume(not case.knife.is_horizontal)
    knife, slope = case.knife, case.window.slope
    travel = case.window.way_to(case.window, knife.spacing)
    z = share * travel / slope
    delta = travel - slope * z
    d1, d2, d3 = (slope + max(15 / 8 * delta / z, 0.0), 10 / sqrt(3) * abs(delta) / z**2, 60 * abs(delta) / z**3)
    assume(d3 * z**3 > 1e-6 * travel)
    expected = min(knife.max_velocity / d1, sqrt(knife.max_acceleration / d2), cbrt(knife.max_jerk / d3))
    assert piece_velocity(case.around + z, knife, case.window) == pytest.approx(expected, rel=1e-9)


# --- sharpness --------------------------------------------------------------------------------------------------------


def greatest_share(knife: Knife, cycle: CycleLimit, window: Window, pitch: float, velocity: float) -> float:
    """The greatest share of a limit that is used at a constant line velocity, at 500 places of each curve."""
    sections = [cycle.way.first, cycle.way.ramp_up] if cycle.way.parks else [cycle.way.first]
    places = [section.at(place) for section in sections for place in spread(section.begin, section.end)]
    places += [window.at(travel) for travel in spread(-window.before, window.after)]
    shares = []
    for _, d1, d2, d3 in places:
        v, a, j = chain_rule(d1, d2, d3, velocity, 0.0)
        shares.append(max(abs(v) / knife.max_velocity, abs(a) / knife.max_acceleration, abs(j) / knife.max_jerk))
    return max(shares)


def spread(begin: float, end: float) -> list[float]:
    return [begin + (end - begin) * n / 500 for n in range(501)]


@drawn(30)
@given(cases(), st.floats(0.1, 4.0))
def test_at_the_limit_one_value_reaches_its_limit_and_none_exceeds_it(case: Case, share: float) -> None:
    pitch = case.around + share * case.window.way_to(case.window, case.knife.spacing) / case.window.slope
    cycle = CycleLimit()
    cycle.solve_piece(case.knife, case.window, case.window, pitch)
    below, above = (
        greatest_share(case.knife, cycle, case.window, pitch, cycle.max_line_velocity * factor)
        for factor in (0.999999, 1.0001)
    )
    assert below < 1.0
    assert above > 1.0


@repeatable
@given(cases(), st.floats(0.001, 0.999))
def test_the_shortest_piece_is_sharp(case: Case, share: float) -> None:
    """A piece that is longer by a millionth can be cut at that velocity, one that is shorter cannot."""
    lengths = lengths_of(case.knife, case.window)
    velocity = share * lengths.max_line_velocity
    lengths.solve_shortest(case.knife, case.window, velocity)
    z = lengths.shortest - case.around
    assert 0.0 < lengths.shortest <= lengths.fastest * (1 + 1e-12)
    longer = piece_velocity(case.around + z * (1 + 1e-6), case.knife, case.window)
    assert longer >= velocity or lengths.shortest > lengths.fastest * (1 - 1e-5)
    assert piece_velocity(case.around + z * (1 - 1e-6), case.knife, case.window) < velocity


# --- the oracle -------------------------------------------------------------------------------------------------------


@repeatable
@given(cases(), st.floats(0.05, 6.0))
def test_any_piece(case: Case, share: float) -> None:
    pitch = case.around + share * case.window.way_to(case.window, case.knife.spacing) / case.window.slope
    longest = lengths_of(case.knife, case.window).longest
    assume(abs(pitch - longest) > 1e-8 * longest)
    exact = cycle_velocity(case.exact_knife, case.exact_window, case.exact_window, mp.mpf(pitch))
    assert piece_velocity(pitch, case.knife, case.window) == pytest.approx(float(exact), rel=ROUNDING)


@repeatable
@given(cases(), cases(), st.floats(0.05, 6.0))
def test_windows_that_are_tuned_from_one_piece_to_the_next(case: Case, other: Case, share: float) -> None:
    """The first window with other halves, and where it is TANGENTIAL with another slope."""
    leaving, exact_leaving = Window(), case.exact_knife
    factor, circumference = case.window.slope / other.window.slope, case.knife.circumference
    assume(0.5 < factor < 2.0)
    before, after = (min(half, 0.1 * circumference) for half in (other.window.before, other.window.after))
    leaving.set(case.knife, 1.1, before, after, 0.05)
    assume(leaving.end.position < 0.9 * case.knife.park_angle)
    travel = leaving.way_to(case.window, case.knife.spacing)
    pitch = leaving.after + share * travel / case.window.slope + case.window.before
    exact = exact_leaving.window(mp.mpf(1.1), mp.mpf(before), mp.mpf(after), mp.mpf(0.05))
    expected = cycle_velocity(case.exact_knife, exact, case.exact_window, mp.mpf(pitch))
    cycle = CycleLimit()
    cycle.solve_piece(case.knife, leaving, case.window, pitch)
    least_slope = cycle.way.quintic_peaks.least_d1
    assume(cycle.way.parks or abs(least_slope) > 1e-8 * case.window.slope)
    assert cycle.max_line_velocity == pytest.approx(float(expected), rel=ROUNDING)


@repeatable
@given(cases())
def test_out_of_rest(case: Case) -> None:
    cycle = CycleLimit()
    cycle.solve_ramp_up(case.knife, case.window)
    exact = ramp_velocity(case.exact_knife, case.exact_window)
    assert cycle.max_line_velocity == pytest.approx(float(exact), rel=ROUNDING)
    cycle.solve_piece(case.knife, case.window, case.window, UNLIMITED)
    exact = cycle_velocity(case.exact_knife, case.exact_window, case.exact_window, mp.inf)
    assert cycle.max_line_velocity == pytest.approx(float(exact), rel=ROUNDING)


@repeatable
@given(cases())
def test_the_longest_piece_of_any_knife(case: Case) -> None:
    exact = longest_turning(case.exact_knife, case.exact_window, case.exact_window)
    longest = lengths_of(case.knife, case.window).longest
    assert longest == pytest.approx(float(exact) + case.around, rel=ROUNDING)


@drawn(40)
@given(cases(), st.floats(0.01, 0.99))
def test_the_shortest_piece_of_any_knife(case: Case, share: float) -> None:
    lengths = lengths_of(case.knife, case.window)
    velocity = share * lengths.max_line_velocity
    exact = shortest_way(case.exact_knife, case.exact_window, mp.mpf(velocity))
    assert exact is not None
    lengths.solve_shortest(case.knife, case.window, velocity)
    assert lengths.shortest == pytest.approx(float(exact) + case.around, rel=ROUNDING)


# --- the earliest cut -------------------------------------------------------------------------------------------------


@drawn(40)
@given(cases(), st.floats(0.05, 0.95), st.floats(0.05, 3.0), st.floats(0.1, 0.95))
def test_the_earliest_cut_that_is_reached_by_turning_on(case: Case, place: float, least: float, share: float) -> None:
    """From anywhere on the way to a cut that is as fast as can be, and before or beyond which one may be too early."""
    window, lengths = case.window, lengths_of(case.knife, case.window)
    cycle = CycleLimit()
    cycle.solve_piece(case.knife, window, window, lengths.fastest)
    velocity = share * cycle.max_line_velocity
    begin = window.after + place * (lengths.fastest - case.around)
    earliest = EarliestCut()
    point = CurvePoint(*cycle.way.first.at(begin))
    first = begin + least * (cycle.way.first.end - begin) + window.before
    earliest.search.start(begin, point, Cut(0.0, case.knife.spacing, window))
    earliest.find_turning(case.knife, velocity, first, UNLIMITED)

    def cut_after(z: Number) -> ExactCut:
        return ExactCut(case.exact_window, mp.mpf(begin) + z + case.exact_window.before, case.spacing)

    departure = Departure(case.exact_knife, mp.mpf(begin), derivatives(point), mp.mpf(velocity), None)
    z = mp.mpf(first) - mp.mpf(begin) - case.exact_window.before
    longest = departure.longest_turning(cut_after)
    assume(abs(z - longest) > 1e-6 * longest)
    expected = departure.earliest(cut_after, z, longest) if z < longest else None
    assert earliest.exists == (expected is not None)
    if expected is not None:
        assert earliest.search.cut.place == pytest.approx(float(expected[0].place), rel=ROUNDING)


@drawn(40)
@given(cases(), st.floats(0.05, 1.5), st.floats(0.1, 1.2))
def test_the_earliest_cut_that_is_reached_by_parking(case: Case, least: float, share: float) -> None:
    window, cycle = case.window, CycleLimit()
    cycle.solve_piece(case.knife, window, window, UNLIMITED)
    ramps = (cycle.way.first.end - cycle.way.first.begin) + (cycle.way.ramp_up.end - cycle.way.ramp_up.begin)
    velocity = share * admissible_velocity(case.knife, cycle.way.peaks)
    first = window.after + least * ramps + window.before
    earliest = EarliestCut()
    earliest.search.start(window.after, window.end, Cut(0.0, case.knife.spacing, window))
    earliest.find_parking(case.knife, velocity, first)
    exact = case.exact_window
    departure = Departure(case.exact_knife, exact.after, exact.at(exact.after), mp.mpf(velocity), None)
    z = mp.mpf(first) - exact.after - exact.before
    expected = departure.earliest_parking(lambda z: ExactCut(exact, exact.after + z + exact.before, case.spacing), z)
    assert earliest.exists == (expected is not None)
    if expected is not None:
        assert earliest.search.cut.place == pytest.approx(float(expected[0].place), rel=ROUNDING)


def test_a_cut_now_is_made_where_the_present_cut_would_have_been_no_later() -> None:
    """Turning on to a piece of 900 at 500 mm/s, from its window's end: at that velocity the shortest one is 183.3."""
    earliest = EarliestCut()
    earliest.search.start(30.0, WINDOW.end, Cut(0.0, 360.0, WINDOW))
    earliest.find_turning(REFERENCE, 500.0, 0.0, 900.0)
    assert earliest.exists
    assert earliest.search.cut.place == pytest.approx(183.312645, abs=5e-7)
    earliest.find_turning(REFERENCE, 500.0, 0.0, 183.0)
    assert not earliest.exists


def test_a_knife_that_must_not_park_reaches_nothing_out_of_rest() -> None:
    earliest = EarliestCut()
    knife = Knife(may_park=False)
    earliest.search.start(30.0, WINDOW.end, Cut(0.0, 360.0, WINDOW))
    earliest.find_parking(knife, 500.0, 900.0)
    assert not earliest.exists


# --- compiled ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@drawn(200)
@given(cases(), st.floats(0.0, 6.0), st.floats(0.01, 1.5), st.floats(0.0, 2.0))
def test_compiled_code_gives_the_bits_of_python(case: Case, share: float, faster: float, least: float) -> None:
    block = KnifeGeometry(knife=case.knife)
    block.before, block.after = case.window.before, case.window.after
    block.next_before, block.next_after = case.window.after, case.window.before
    swapped = Window()
    swapped.set(case.knife, 1.0, block.next_before, block.next_after, 0.0)
    assume(leaves_way(case.knife, swapped))
    travel = case.window.way_to(case.window, case.knife.spacing) / case.window.slope
    block.pitch = case.around + share * travel
    block.least = least * block.pitch
    block.place = case.window.after + 0.3 * share * travel
    block.velocity = faster * case.knife.max_velocity / case.window.slope
    compiled = Compiled(block)
    assert compiled.initialize() == block.initialize()
    assert compiled.step(0.0) == block.step(0.0)
    assert equal(block, compiled)
