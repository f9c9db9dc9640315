"""What a plan predicts of a rotary knife, by hand; that runs of the block confirm it, and nothing else.

The knife has the circumference 600, one blade, a TANGENTIAL window of 30 before and after the cut, and the slave turns
in degrees: k = 0.6 degrees per mm. Between two windows the master travels Z = p - 60. With d = 0.6 (600 - p) the jerk
is 60 d/Z3 v3, so that a limit of 1e6 admits v = Z cbrt(1e6/(60 d))."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.plan.confirmation import confirm
from motionsync_fmu.plan.knife import NO_WAY
from motionsync_fmu.plan.line_plan import default_lengths, default_velocities, plan_machine
from motionsync_fmu.plan.prediction import ACCELERATION, JERK, NOT_TAKEN, VELOCITY
from tests.plan.machines import KNIFE, TORQUES, knife
from tests.support.blocks.drawn import drawn

PARKING = 4326.748711  # 1.5 (0.6 v)3/1622 = 1e6, with 162 degrees from the window to the park angle


@pytest.mark.parametrize(
    ("length", "velocity", "bound"),
    [
        (300.0, 240.0 * math.cbrt(1e6 / (60 * 180)), JERK),
        (400.0, 340.0 * math.cbrt(1e6 / (60 * 120)), JERK),
        (600.0, 3600 / 0.6, VELOCITY),
        (900.0, 840.0 * math.cbrt(1e6 / (60 * 180)), JERK),
        (1500.0, PARKING, JERK),
    ],
)
def test_the_greatest_line_velocity_and_what_limits_it(length: float, velocity: float, bound: str) -> None:
    point = knife(KNIFE).predict_greatest_velocity(length)
    assert point.velocity == pytest.approx(velocity, rel=1e-9)
    assert point.lost == point.velocity
    assert point.bound == bound


def test_a_weak_motor_is_limited_by_its_acceleration() -> None:
    """10/sqrt(3) 180/2402 v2 = 720."""
    point = knife(KNIFE, axis_max_acceleration="720").predict_greatest_velocity(300.0)
    assert point.velocity == pytest.approx(240.0 * math.sqrt(720 * math.sqrt(3) / (10 * 180)), rel=1e-9)
    assert point.bound == ACCELERATION


def test_the_parts_of_a_cycle() -> None:
    """Two ramps of 2 162/0.6 = 540, and a rest of 1500 - 60 - 1080 = 360; on 300 it turns on over 240."""
    long, short = (knife(KNIFE).predict_greatest_velocity(length) for length in (1500.0, 300.0))
    travels = [{name: time * p.velocity for name, time in (p.cycle or {}).items()} for p in (long, short)]
    zero = pytest.approx(0.0, abs=1e-9)
    assert travels[0] == pytest.approx(
        {"in sync": 60.0, "turning on": 0.0, "ramp down": 540.0, "rest at park": 360.0, "ramp up": 540.0}
    )
    assert travels[1] == {
        "in sync": pytest.approx(60.0),
        "turning on": pytest.approx(240.0),
        "ramp down": zero,
        "rest at park": zero,
        "ramp up": zero,
    }
    assert short.cycle_time == pytest.approx(300.0 / short.velocity)


def test_the_peaks_of_a_cycle() -> None:
    """On 400 the knife is 2.102941 times as fast as in sync, and its acceleration is 10/sqrt(3) 120/3402 v2."""
    point = knife(KNIFE).predict_greatest_velocity(400.0)
    assert point.figures["knife's velocity"].value == pytest.approx(2.102941 * 0.6 * point.velocity, rel=1e-6)
    acceleration = 10 / math.sqrt(3) * 120 / 340**2 * point.velocity**2
    assert point.figures["knife's acceleration"].value == pytest.approx(acceleration, rel=1e-9)
    assert point.figures["knife's acceleration"].unit == "deg/s2"


def test_gains_by_hand() -> None:
    """What the jerk limits goes with its cube root. A window narrower by 1 % leaves 240.6 between two windows, and d
    does not change. Where the knife turns evenly its velocity alone counts."""
    short = knife(KNIFE).predict_greatest_velocity(300.0)
    assert short.gains[JERK] == pytest.approx(math.cbrt(1.01) - 1.0, rel=1e-6)
    assert short.gains["window"] == pytest.approx(240.6 / 240.0 - 1.0, rel=1e-6)
    assert short.gains[VELOCITY] == short.gains[ACCELERATION] == 0.0
    even = knife(KNIFE).predict_greatest_velocity(600.0)
    assert even.gains[VELOCITY] == pytest.approx(0.01, rel=1e-6)
    assert even.gains[JERK] == 0.0


@pytest.mark.parametrize(("velocity", "length"), [(500.0, 183.312645), (1000.0, 284.730278), (2000.0, 427.567549)])
def test_the_shortest_length(velocity: float, length: float) -> None:
    point = knife(KNIFE).predict_shortest_length(velocity)
    assert point.length == pytest.approx(length, abs=5e-7)
    assert point.gap is None


def roots(velocity: float) -> list[float]:
    """The lengths 600 + x > 600 with 60 0.6 x/(540 + x)3 v3 = 1e6."""
    c = 1e6 / (36.0 * velocity**3)
    solutions = np.roots([c, 3 * c * 540, 3 * c * 540**2 - 1.0, c * 540**3])
    return [600.0 + float(x.real) for x in sorted(solutions, key=lambda x: x.real) if x.real > 0.0]


def test_a_fast_line_is_too_fast_for_some_longer_pieces() -> None:
    """At 4000 the jerk is too great between the two roots; above 4326.7 also where the knife parks."""
    data = knife(KNIFE)
    gap = data.predict_shortest_length(4000.0).gap
    assert gap
    assert (gap.begin, gap.end) == pytest.approx(tuple(roots(4000.0)), rel=1e-9)
    assert gap.end
    assert gap.end < 1217.142857
    gap = data.predict_shortest_length(5000.0).gap
    assert gap
    assert gap.begin == pytest.approx(roots(5000.0)[0], rel=1e-9)
    assert gap.end is None


def test_a_line_that_is_too_fast_has_no_length() -> None:
    assert knife(KNIFE).predict_shortest_length(6000.1).length is None
    assert knife(KNIFE).predict_shortest_length(6000.0).length == pytest.approx(600.0)
    assert knife(KNIFE).greatest_velocity == pytest.approx(6000.0)


def test_kerf_and_measuring_wheel() -> None:
    """L 404, b 4, f 1.02 have the pitch 400. k' is 0.612 degrees per travel of the master, and 30 of material are
    29.411765 of it: Z = 341.176471, d = 360 - 0.612 400 = 115.2."""
    point = knife(KNIFE | {"kerf": "4", "material_factor": "1.02"}).predict_greatest_velocity(404.0)
    assert point.velocity == pytest.approx((400 - 60 / 1.02) * math.cbrt(1e6 / (60 * 115.2)), rel=1e-9)


def test_pieces_that_no_line_velocity_admits() -> None:
    data = knife(KNIFE | {"allow_parking": "false"})
    points = [data.predict_greatest_velocity(length) for length in (60.0, 1217.0, 1218.0)]
    assert [point.velocity > 0.0 for point in points] == [False, True, False]
    assert [point.bound for point in points] == [NO_WAY, JERK, NOT_TAKEN]
    for point in (points[0], points[2]):
        assert confirm(data, point).is_confirmed


def test_the_defaults_show_the_synchronous_length_and_parking() -> None:
    data = knife(KNIFE)
    lengths, velocities = default_lengths(data), default_velocities(data)
    assert 600.0 in [pytest.approx(length) for length in lengths]
    assert max(lengths) > 1217.142857
    assert velocities[-1] == pytest.approx(6000.0)


# --- confirmed by the block -------------------------------------------------------------------------------------------


def test_runs_confirm_what_is_predicted() -> None:
    """Also where the line is faster than the ramp up admits: there the first cut is made on a slower line."""
    plan = plan_machine(knife(KNIFE), [300.0, 600.0, 900.0, 1500.0], [1000.0, 5000.0, 6000.0, 7000.0])
    assert plan.is_confirmed, [check.text for point in plan.predictions for check in point.checks if not check.passed]
    assert [len(point.checks) for point in plan.predictions] == [3, 3, 3, 3, 3, 3, 3, 1]


@pytest.mark.parametrize("length", [300.0, 600.0, 1500.0])
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_runs_confirm_no_other_velocity(length: float, share: float) -> None:
    data = knife(KNIFE)
    point = data.predict_greatest_velocity(length)
    other = share * point.velocity
    assert not confirm(data, replace(point, velocity=other, lost=other)).is_confirmed


def test_runs_confirm_no_other_rest() -> None:
    data = knife(KNIFE)
    point = data.predict_greatest_velocity(1500.0)
    assert point.cycle
    cycle = dict(point.cycle) | {"rest at park": 1.0001 * point.cycle["rest at park"]}
    assert not confirm(data, replace(point, cycle=cycle)).is_confirmed


values = {
    "knife.blades": st.sampled_from(("1", "2")),
    "knife.park_angle": st.sampled_from(("85", "95")),
    "sync.mode": st.sampled_from(("TANGENTIAL", "HORIZONTAL")),
    "sync.before": st.sampled_from(("20", "40")),
    "sync.overspeed": st.sampled_from(("0", "0.05")),
    "axis.max_acceleration": st.sampled_from(("5000", "72000")),
    "axis.max_jerk": st.sampled_from(("1e5", "1e6")),
    "kerf": st.sampled_from(("0", "4")),
    "material_factor": st.sampled_from(("1", "1.02")),
}


@drawn(6, shrink=False)
@given(st.fixed_dictionaries(values), st.sampled_from((250.0, 400.0, 1500.0)), st.sampled_from((300.0, 700.0)))
def test_runs_confirm_any_knife(given_values: dict[str, str], length: float, velocity: float) -> None:
    plan = plan_machine(knife(given_values), [length], [velocity])
    assert plan.is_confirmed, [check.text for point in plan.predictions for check in point.checks if not check.passed]


# --- the motor --------------------------------------------------------------------------------------------------------


def test_the_motor_gives_friction_while_the_knife_turns_evenly() -> None:
    (point,) = plan_machine(knife(KNIFE | TORQUES), [600.0], [1000.0]).over_length
    assert point.motor
    assert (point.motor.rms, point.motor.peak) == pytest.approx((4.0, 4.0), rel=1e-6)
    assert (point.motor.rms_share, point.motor.peak_share) == pytest.approx((4 / 30, 4 / 100), rel=1e-6)
    assert point.motor.unit == "N m"


def test_the_motor_accelerates_on_the_ramps() -> None:
    """A ramp over W = 540 has the acceleration 12 D w (1 - w) (v/W)2, w from 0 to 1: its peak is 3 D (v/W)2, the mean
    of its square 144/30 (D (v/W)2)2. Two of them are 1080 of 1500."""
    (point,) = plan_machine(knife(KNIFE, load_inertia="0.5"), [1500.0], [1000.0]).over_length
    assert point.motor
    scale = 0.5 * math.radians(162.0 * (point.velocity / 540.0) ** 2)
    assert point.motor.peak == pytest.approx(3.0 * scale, rel=1e-4)
    assert point.motor.rms == pytest.approx(scale * math.sqrt(144 / 30 * 1080 / 1500), rel=1e-4)
