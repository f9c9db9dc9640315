"""The curves and limits of the RotaryKnife's oracle, against closed forms and numbers that were computed beforehand."""

from math import asin, cbrt, inf, pi, sqrt
from random import Random
from typing import Any

import pytest

from tests.oracle import mp
from tests.oracle.rotary_knife import DEFAULTS, FIXED
from tests.oracle.rotary_knife_curves import Cut, Quintic, Window
from tests.oracle.rotary_knife_limits import (
    Knife,
    cycle_velocity,
    longest_turning,
    ramp_velocity,
    ramp_width,
    shortest_way,
    way_between,
)

K = 0.6  # ° per mm
TURN = 360.0


def near(value: float, rel: float = 1e-9) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-9)


def knife(**values: Any) -> Knife:
    return Knife.of(DEFAULTS | FIXED | {name.replace("__", "."): value for name, value in values.items()})


def window(of: Knife, half: float = 30.0, overspeed: float = 0.0) -> Window:
    return of.window(1.0, half, half, overspeed)


@pytest.mark.parametrize(
    ("piece", "fastest", "middle"),
    [
        (600.0, 1.0, 1.0),
        (400.0, 2.102941, 2.102941),
        (300.0, 3.343750, 3.343750),
        (900.0, 1.0, 0.330357),
        (1217.142857, 1.0, 0.0),
    ],
)
def test_a_piece_on_which_the_knife_turns_on(piece: float, fastest: float, middle: float) -> None:
    """In the middle the slope is k(1 + 15/8 Δ/Z) with Z = piece - 60 and Δ = 540 - Z."""
    w = window(knife())
    way = way_between(knife(), w, w, piece)
    assert way is not None
    assert not way.parks
    assert float(way.extremes[0] / w.slope) == near(fastest, 1e-6)
    slope = way.curves[0].at(mp.mpf(piece) / 2)[1] / w.slope
    assert float(slope) == pytest.approx(middle, abs=1e-6)
    assert float(slope) == near(1 + 15 / 8 * (540 - (piece - 60)) / (piece - 60), 1e-8)


def test_the_longest_piece_without_parking() -> None:
    """Z = 15/7 · S/k = 15/7 · 540."""
    w = window(knife())
    assert float(longest_turning(knife(), w, w)) == near(15 / 7 * 540)
    at_last, beyond = (way_between(knife(), w, w, 15 / 7 * 540 + 60 + side * 1e-6) for side in (-1, 1))
    assert at_last is not None
    assert beyond is not None
    assert (at_last.parks, beyond.parks) == (False, True)


def test_a_piece_of_1500_parks_on_two_ramps_of_540() -> None:
    w = window(knife())
    way = way_between(knife(), w, w, 1500.0)
    assert way is not None
    down, up = way.curves
    assert [float(x) for x in (down.begin, down.width, up.begin, up.width)] == [near(x) for x in (30, 540, 930, 540)]
    assert (float(down.at(down.end)[0]), float(up.at(up.begin)[0])) == (near(180.0), near(180.0))
    assert float(way.extremes[0]) == near(K)
    assert float(way.extremes[1] * 1000**2) == near(3 / 4 * 600**2 / 162)
    assert float(way.extremes[2] * 1000**3) == near(3 / 2 * 600**3 / 162**2)


def test_extremes_of_a_piece_of_400_at_1000() -> None:
    w = window(knife())
    way = way_between(knife(), w, w, 400.0)
    assert way is not None
    assert float(way.extremes[1] * 1000**2) == near(5993.3, 1e-5)
    assert float(way.extremes[1] * 1000**2) == near(10 / sqrt(3) * 200 / 340**2 * 1e6 * 0.6)
    assert float(way.extremes[2] * 1000**3) == near(183187.0, 1e-5)
    assert float(way.extremes[2] * 1000**3) == near(60 * 200 / 340**3 * 1e9 * 0.6)


@pytest.mark.parametrize(
    ("piece", "fastest"),
    [(300, 1085.767047), (400, 1760.765087), (600, 6000), (900, 3800.184663), (1500, 4326.748711), (inf, 4326.748711)],
)
def test_the_greatest_line_velocity(piece: float, fastest: float) -> None:
    w = window(knife())
    assert float(cycle_velocity(knife(), w, w, mp.mpf(piece))) == near(fastest)


def test_the_greatest_line_velocity_out_of_rest() -> None:
    """Jerk 3/2 (k v)³/162² = 1e6."""
    fastest = float(ramp_velocity(knife(), window(knife())))
    assert fastest == near(4326.748711)
    assert fastest == near(cbrt(1e6 * 162**2 / 1.5) / K)


@pytest.mark.parametrize(("velocity", "shortest"), [(500, 183.312645), (1000, 284.730278), (2000, 427.567549)])
def test_the_shortest_piece(velocity: float, shortest: float) -> None:
    way = shortest_way(knife(), window(knife()), mp.mpf(velocity))
    assert way is not None
    assert float(way) + 60 == pytest.approx(shortest, abs=5e-7)


def test_a_line_for_which_no_piece_is_long_enough() -> None:
    assert shortest_way(knife(), window(knife()), mp.mpf(6000.1)) is None
    best = shortest_way(knife(), window(knife()), mp.mpf(6000))
    assert best is not None
    assert float(best) <= 540.0


def test_closed_forms_of_any_knife() -> None:
    """The slope k' + 15/8 Δ/Z, curvature 10/√3 |Δ|/Z² and third derivative 60 |Δ|/Z³ of knives at random."""
    random = Random(1)
    for _ in range(20):
        overspeed, blades = random.uniform(-0.2, 0.5), random.choice([1, 2, 3])
        turn, circumference = random.uniform(1.0, 400.0), random.uniform(200.0, 900.0)
        half = random.uniform(0.0, 0.15) * circumference / blades
        k = knife(
            knife__turn=turn,
            knife__circumference=circumference,
            knife__blades=blades,
            knife__park_angle=turn / blades / 2,
            axis__max_velocity=10 * turn,
            axis__max_acceleration=200 * turn,
            axis__max_jerk=3000 * turn,
        )
        w = k.window(1.0, half, half, overspeed)
        slope = turn / circumference * (1 + overspeed)
        travel = turn / blades - 2 * slope * half
        z = random.uniform(0.2, 2.0) * travel / slope
        delta = travel - slope * z
        peaks = (slope + max(15 / 8 * delta / z, 0), 10 / sqrt(3) * abs(delta) / z**2, 60 * abs(delta) / z**3)
        fastest = min(10 * turn / peaks[0], sqrt(200 * turn / peaks[1]), cbrt(3000 * turn / peaks[2]))
        way = way_between(k, w, w, mp.mpf(z + 2 * half))
        assert way is not None
        assert not way.parks
        assert [float(x) for x in way.extremes] == [near(x, 1e-8) for x in peaks]
        assert float(cycle_velocity(k, w, w, mp.mpf(z + 2 * half))) == near(fastest, 1e-8)
        assert float(longest_turning(k, w, w)) == near(15 / 7 * travel / slope, 1e-8)


def test_two_blades_turn_uniformly_for_300() -> None:
    two = knife(knife__blades=2, knife__park_angle=90.0)
    w = window(two)
    way = way_between(two, w, w, 300.0)
    assert way is not None
    assert [float(x) for x in way.extremes] == [near(K), near(0.0), near(0.0)]


def test_overspeed_makes_the_way_between_two_windows_slower() -> None:
    """S/k = 600 - 63 = 537 and Δ/k = 537 - 1.05 · 540 = -30, over Z = 540."""
    w = window(knife(), overspeed=0.05)
    way = way_between(knife(), w, w, 600.0)
    assert way is not None
    middle = way.curves[0].at(mp.mpf(300))
    assert float(middle[0]) == near(180.0)
    assert float(middle[1]) == near(K * (1.05 - 15 / 8 * 30 / 540))
    assert float(way.extremes[1]) == near(10 / sqrt(3) * 30 * K / 540**2)


# --- HORIZONTAL -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("half", "edge", "longest", "width", "fastest"),
    [(60.0, 38.926175447, 669.469446, 251.353875, 1342.58), (80.0, None, 455.986303, 134.861154, 674.55)],
)
def test_a_horizontal_window(half: float, edge: float | None, longest: float, width: float, fastest: float) -> None:
    """The greatest third derivative is k (2π/C)² (1 + 2y²)/(1 - y²)^2.5 at the window's ends, y = 2π half/C."""
    k = knife(sync__mode=2)
    w = window(k, half)
    y = 2 * pi * half / 600
    s, slope, curvature, third = (float(x) for x in w.at(w.after))
    assert s == near(TURN / (2 * pi) * asin(y))
    assert edge is None or (s, slope / K) == (near(edge), near(1.285419437))
    assert slope == near(K / sqrt(1 - y * y))
    assert curvature == near(K * 2 * pi / 600 * y / (1 - y * y) ** 1.5)
    assert third == near(K * (2 * pi / 600) ** 2 * (1 + 2 * y * y) / (1 - y * y) ** 2.5)
    assert float(longest_turning(k, w, w)) + 2 * half == pytest.approx(longest, abs=5e-7)
    assert float(k.ramp_up(Cut(w, mp.mpf(0), mp.mpf(0))).width) == pytest.approx(width, abs=5e-7)
    assert float(ramp_velocity(k, w)) == pytest.approx(fastest, abs=5e-3)
    assert float(ramp_velocity(k, w)) == near(cbrt(1e6 / third))


def test_a_wide_horizontal_window_parks_on_a_piece_of_600() -> None:
    k = knife(sync__mode=2)
    narrow, wide = (way_between(k, w, w, 600.0) for w in (window(k, 60.0), window(k, 80.0)))
    assert narrow is not None
    assert wide is not None
    assert (narrow.parks, wide.parks) == (False, True)


def test_windows_that_are_refused() -> None:
    """0.15 C = 90; the edge at 90 is at 360/(2π) · arcsin(0.3π) = 70.470°; a park angle has to be between."""
    k = knife(sync__mode=2)
    assert k.has_way(mp.mpf(90), mp.mpf(90), mp.mpf(0))
    assert not k.has_way(mp.mpf(90.1), mp.mpf(30), mp.mpf(0))
    assert not knife(sync__mode=2, knife__park_angle=70.0).has_way(mp.mpf(90), mp.mpf(90), mp.mpf(0))
    assert knife().has_way(mp.mpf(290), mp.mpf(290), mp.mpf(0))
    assert not knife().has_way(mp.mpf(300), mp.mpf(300), mp.mpf(0))
    assert not knife(knife__blades=2, knife__park_angle=180.0).has_way(mp.mpf(30), mp.mpf(30), mp.mpf(0))


# --- ramps ------------------------------------------------------------------------------------------------------------


def test_a_ramp_joins_rest_and_window_and_never_turns_back() -> None:
    """(4 D - V) w³ + (V - 3 D) w⁴ with V = slope · W ends with the curvature -alpha."""
    random = Random(2)
    for _ in range(30):
        distance, slope, alpha = (
            random.uniform(1, 300),
            random.uniform(0.1, 2),
            random.choice([0.0, random.uniform(0, 0.05)]),
        )
        width = ramp_width(mp.mpf(distance), mp.mpf(slope), mp.mpf(alpha))
        assert width is not None
        v = slope * float(width)
        assert (6 * v - 12 * distance) / float(width) ** 2 == pytest.approx(-alpha, abs=1e-12)
        ends = ((mp.mpf(0), mp.mpf(0), mp.mpf(0)), (mp.mpf(distance), mp.mpf(slope), mp.mpf(-alpha)))
        ramp = Quintic.through(mp.mpf(0), ends[0], width, ends[1])
        expected = [0, 0, 0, 4 * distance - v, v - 3 * distance, 0]
        assert [float(c) for c in ramp.coefficients] == pytest.approx(expected, abs=1e-9)
        assert ramp.least_slope() > -1e-40


def test_the_rest_of_a_ramp_is_the_same_ramp() -> None:
    """Laid anew where the knife is, the ramp down ends where it would have ended: 270 of its 540 are left."""
    k, w = knife(), window(knife())
    down = k.ramp_down(mp.mpf(30), w.at(mp.mpf(30)), mp.mpf(360))
    assert down is not None
    again = k.ramp_down(mp.mpf(300), down.at(mp.mpf(300)), mp.mpf(360))
    assert again is not None
    assert float(again.width) == near(270.0)


def test_ramps_that_do_not_fit_are_shortened_in_the_same_ratio() -> None:
    """Park angle 60 of windows of ±60: D down 60 - 38.926, up 360 - 60 - 38.926; they need 445 together."""
    k = knife(sync__mode=2, knife__park_angle=60.0)
    w = window(k, 60.0)
    down, up = k.ramp_down(w.after, w.at(w.after), k.spacing), k.ramp_up(Cut(w, mp.mpf(700), k.spacing))
    assert down is not None
    assert float(down.at(down.end)[0] - down.at(down.begin)[0]) == near(60 - 38.926175447, 1e-8)
    assert float(up.at(up.end)[0] - up.at(up.begin)[0]) == near(300 - 38.926175447)
    pitch = float(down.width + up.width) * 0.9 + 120
    way = k.parking(w.after, w.at(w.after), Cut(w, mp.mpf(pitch), k.spacing))
    assert way is not None
    assert [float(c.width) for c in way.curves] == [near(0.9 * float(c.width)) for c in (down, up)]
    assert float(way.curves[0].end) == near(float(way.curves[1].begin))
    assert min(c.least_slope() for c in way.curves) > -1e-40
    assert k.parking(w.after, w.at(w.after), Cut(w, mp.mpf(pitch), k.spacing), shortened=False) is None
