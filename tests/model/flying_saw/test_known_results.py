"""Known results: the examples of TS5055 with all their characteristic values, and cyclic cuts."""

import math
from itertools import pairwise
from typing import Any

import pytest
from numpy.polynomial import Polynomial

from motionsync.flying_saw.characteristics import Characteristics
from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from tests.model.flying_saw.harness import (
    FIRST,
    INSTANT,
    SECOND,
    VELOCITY_CHECKS,
    FlyingSawHarness,
    first_example,
    near,
    second_example,
)


def values_of(curve: Polynomial, duration: float) -> tuple[float, float]:
    """Extremes of a polynomial of u in [0, 1]."""
    places = [0.0, 1.0, *(r.real for r in curve.deriv().roots() if abs(r.imag) < 1e-9 and 0.0 < r.real < 1.0)]
    return min(curve(places)), max(curve(places))


@pytest.mark.parametrize(
    ("example", "aims", "curve", "velocity", "acceleration", "jerk", "lowest"),
    [
        # c3 = 10 A - 4 B ..., A = D - v0 T, B = (v_s - v0) T: A 500, B 750; A 1750, B 3000
        (
            *(first_example, FIRST, [-250.0, 750.0, 0.0, 2000.0, -2250.0, 750.0]),
            *((250.0, 506.0), (-15.04601, 175.04601), (-155.556, 444.444), -250.0),
        ),
        (
            *(second_example, SECOND, [-500.0, -750.0, 0.0, 5500.0, -5250.0, 1500.0]),
            *((-250.0, 750.0), (0.0, 568.755), (-411.111, 1222.222), -620.638),
        ),
    ],
)
def test_a_quintic_and_all_its_characteristic_values(
    example: Any, aims: Any, curve: Any, velocity: Any, acceleration: Any, jerk: Any, lowest: float
) -> None:
    saw = example().give("gear_in_pos", **aims).run(1.0)
    result = saw.block.characteristics
    t = 3.0
    s = Polynomial(curve)
    v, a, j = s.deriv() / t, s.deriv(2) / t**2, s.deriv(3) / t**3
    assert result.profile == ProfileKind.P5
    assert saw.slave == near(s(1 / 3), v(1 / 3), a(1 / 3))
    assert saw["slave.jerk"] == near(j(1 / 3))
    assert (result.slave_velocity_min, result.slave_velocity_max) == pytest.approx(velocity, abs=5e-3)
    assert (result.slave_acceleration_min, result.slave_acceleration_max) == pytest.approx(acceleration, abs=5e-4)
    assert (result.slave_jerk_min, result.slave_jerk_max) == pytest.approx(jerk, abs=5e-4)
    assert result.slave_position_min == pytest.approx(lowest, abs=5e-4)
    assert_extremes(result, t, s, v, a, j)
    assert_integrals(result, t, s, v, a)
    assert_ends(result, s, v, j)


def assert_extremes(
    result: Characteristics, t: float, s: Polynomial, v: Polynomial, a: Polynomial, j: Polynomial
) -> None:
    """Extreme values and where they are, of polynomials of u in [0, 1]."""
    for name, of in [("position", s), ("velocity", v), ("acceleration", a), ("jerk", j)]:
        low, high = values_of(of, t)
        assert getattr(result, f"slave_{name}_min") == near(low, tolerance=1e-8)
        assert getattr(result, f"slave_{name}_max") == near(high)
    for name, of in [("position", s), ("velocity", v), ("acceleration", a)]:
        for side in ("min", "max"):
            at = (getattr(result, f"master_position_at_slave_{name}_{side}") + 500.0) / 1500.0
            assert of(at) == near(getattr(result, f"slave_{name}_{side}"), tolerance=1e-6)
            if name == "acceleration":
                assert getattr(result, f"slave_velocity_at_slave_acceleration_{side}") == near(v(at), tolerance=1e-6)


def assert_integrals(result: Characteristics, t: float, s: Polynomial, v: Polynomial, a: Polynomial) -> None:
    """Momentum, mean speed and effective acceleration."""
    power = values_of(v * a, t)
    assert (result.slave_dynamic_momentum_min, result.slave_dynamic_momentum_max) == near(*power)
    zeros = sorted({0.0, 1.0, *(r.real for r in v.roots() if abs(r.imag) < 1e-9 and 0.0 < r.real < 1.0)})
    distances = [abs(s(last) - s(first)) for first, last in pairwise(zeros)]
    assert result.slave_velocity_mean == near(sum(distances) / t)
    square = (a * a).integ()
    assert result.slave_acceleration_effective == near(math.sqrt(square(1.0) - square(0.0)))


def assert_ends(result: Characteristics, s: Polynomial, v: Polynomial, j: Polynomial) -> None:
    """Both axes at the profile's beginning and end."""
    assert (result.master_velocity_nominal, result.master_position_start, result.master_position_end) == near(
        500.0, -500.0, 1000.0
    )
    assert (result.slave_position_start, result.slave_velocity_start, result.slave_acceleration_start) == near(
        s(0.0), v(0.0), 0.0
    )
    assert (result.slave_position_end, result.slave_velocity_end, result.slave_acceleration_end) == near(
        s(1.0), v(1.0), 0.0
    )
    assert (result.slave_jerk_start, result.slave_jerk_end) == near(j(0.0), j(1.0))


@pytest.mark.parametrize(
    ("example", "aims", "duration", "change", "peak", "jerk"),
    [(first_example, FIRST, 2.0, 250.0, 187.5, 375.0), (second_example, SECOND, 2.5, 1000.0, 600.0, 960.0)],
)
def test_with_velocity_checks_a_ramp_and_then_the_synchronous_velocity(
    example: Any, aims: Any, duration: float, change: float, peak: float, jerk: float
) -> None:
    saw = example().modes(*VELOCITY_CHECKS).give("gear_in_pos", **aims)
    s0, v0 = saw["axis.initial_position"], saw["axis.initial_velocity"]
    saw.run(0.5 * duration)
    result = saw.block.characteristics
    assert result.profile == ProfileKind.P5_P1
    assert saw.slave == near(s0 + duration * (0.5 * v0 + change * (1 / 8 - 1 / 32)), v0 + 0.5 * change, peak)
    assert result.slave_acceleration_max == near(peak)
    assert (result.slave_jerk_min, result.slave_jerk_max) == near(-jerk, jerk)
    assert result.slave_acceleration_effective == near(change * math.sqrt(1.2 / duration / 3.0))
    saw.run(0.5 * duration).run(0.5 * (3.0 - duration))
    assert saw.state == State.SYNCHRONIZING
    assert saw.slave[1:] == near(v0 + change, 0.0)
    saw.run(0.5 * (3.0 - duration) + INSTANT)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(aims["slave_sync_position"] + (v0 + change) * INSTANT, v0 + change, 0.0)


@pytest.mark.parametrize(("modes", "duration"), [((), 0.45), (("check_max_jerk",), math.sqrt(0.9))])
def test_to_the_master_s_velocity_as_fast_as_acceleration_and_jerk_allow(
    modes: tuple[str, ...], duration: float
) -> None:
    """Section 3, example 1: the velocity goes from -250 to 500 with the limits 2500/2500/5000."""
    saw = FlyingSawHarness({"axis.initial_velocity": -250.0}, speed=500.0).modes(*modes)
    saw.give("gear_in_velo", acceleration=2500.0, deceleration=2500.0, jerk=5000.0).run(duration - 1e-6)
    assert saw.state == State.SYNCHRONIZING
    result = saw.block.characteristics
    assert (result.profile, result.slave_acceleration_max) == (ProfileKind.P5, near(1.5 * 750.0 / duration))
    assert result.slave_jerk_max == near(6.0 * 750.0 / duration**2)
    assert (result.master_position_end, result.slave_position_end) == near(500.0 * duration, 125.0 * duration)
    saw.run(2e-6)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(125.0 * duration + 500e-6, 500.0, 0.0, tolerance=1e-8)


def test_cuts_of_the_same_length_again_and_again() -> None:
    """Pieces of 1000: the saw meets each mark at 100, cuts for 0.3 s, and gets its next order while it returns."""
    length, x = 1000.0, 100.0
    saw = FlyingSawHarness(speed=500.0)
    saw.give("gear_in_pos", master_sync_position=x, slave_sync_position=x).run(0.2 + INSTANT)
    for n in range(20):
        assert saw.state == State.SYNCHRON
        for _ in range(3):
            assert saw.master_position - saw.slave[0] == pytest.approx(n * length, abs=1e-9 * max(n, 1))
            saw.run(0.1)
        saw.release("gear_in_pos").give("move_absolute", position=0.0).run(0.35)
        assert 0.0 < saw.slave[0] < x
        assert saw.slave[1] < 0.0
        saw.release("move_absolute")
        saw.give("gear_in_pos", master_sync_position=(n + 1) * length + x, slave_sync_position=x).run(INSTANT)
        assert saw.state == State.SYNCHRONIZING
        saw.run((n + 1) * 2.0 + 0.2 + (n + 2) * INSTANT - saw.time)
    assert saw.state == State.SYNCHRON
