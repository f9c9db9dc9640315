"""The Synchronizer's slave on the ramp, and what it does where the master reverses."""

import math

import pytest

from motionsync.synchronizer.interface import Curve
from tests.model.synchronizer.harness import EXECUTING, PARABOLA, POLYNOMIAL, READY, Harness


def test_back_below_the_begin_the_command_waits_again() -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(30.0).slave(27.5, 30.0 * 0.5)
    rig.go(25.0).shows(EXECUTING, s=True, ramp=True).slave(30.0 - 225.0 / 40.0)
    rig.go(19.0).shows(EXECUTING, s=True).slave(19.0, -6.0)
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5).go(41.0).shows(READY, s=False)
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(30.0).slave(32.5).go(19.0).shows(EXECUTING, s=False)
    rig.slave(30.0, 0.0).go(40.0).shows(READY, s=True).slave(40.0, 21.0)


@pytest.mark.parametrize("back", [1, 2, 7])
@pytest.mark.parametrize("steps", [1, 3, 100])
def test_backwards_past_whole_turns_the_command_aims_at_the_first_ramp_ahead(back: int, steps: int) -> None:
    """Ramps begin at 20 + 100 n. From inside a ramp back by whole turns and a little, then forwards again."""
    rig = Harness(0.0, period=100.0).pulse(stop=True, rest_value=30.0).go(30.0).shows(EXECUTING, s=True, ramp=True)
    lowest = 30.0 - 100.0 * back - 15.0
    rig.go(*(30.0 + (lowest - 30.0) * i / steps for i in range(1, steps + 1))).shows(EXECUTING, s=True)
    rig.slave(15.0)
    assert rig.block.local.distance_to_begin == pytest.approx(5.0)
    rig.go(lowest + 15.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(lowest + 25.0).shows(READY, s=False).slave(30.0)


def test_backwards_in_a_step_that_comes_back_again_the_command_is_ramped_where_it_ends() -> None:
    """From 30 down by 225 and up again in one step of 30 s: it turns at -195, aims at -180 and ends in -170."""
    rig = Harness(0.0, period=100.0).pulse(stop=True, rest_value=30.0).go(30.0).shows(EXECUTING, s=True, ramp=True)
    rig.move(-30.0, 2.0, 20.0).shows(EXECUTING, s=True, ramp=True)
    assert rig.at == -170.0
    rig.slave(27.5)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
def test_a_ramp_longer_than_the_period_spans_several_turns(curve: Curve) -> None:
    """P 100, phasing 230, rest 30: from -200 (3-4-5 stop alike) to 260, or to 231.25."""
    rig = Harness(-250.0, period=100.0, curve=curve, output_phasing=230.0).pulse(stop=True, rest_value=30.0)
    rig.go(-200.5).shows(EXECUTING, s=True)
    rig.go(-199.5).shows(EXECUTING, s=True, ramp=True)
    rig.go(-100.0, 0.0, 30.0).shows(EXECUTING, s=True, ramp=True)
    if curve == PARABOLA:
        rig.slave((30.0 - 230.0 / 4.0) % 100.0)
    end = 260.0 if curve == PARABOLA else 30.0 + 230.0 * 7 / 8
    rig.go(end - 0.5).shows(EXECUTING, s=True, ramp=True).go(end + 0.5).shows(READY, s=False).slave(30.0)
    rig.pulse(start=True, output_phasing=150.0)
    assert rig.block.local.distance_to_begin < 100.0
    while rig.block.state == EXECUTING:
        rig.go(rig.at + 33.0)
    rig.shows(READY, s=True).slave(rig.at % 100.0)


def test_the_slave_on_the_ramp_by_the_chain_rule() -> None:
    """Start, rest 30, master at 30 with v = 6 and a = 2: slope 1/2, curvature 1/20."""
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(25.0)
    rig.move(4.0, 2.0, 1.0)
    assert rig.at == 30.0
    slave = rig.block.slave
    assert (slave.position, slave.velocity) == (32.5, 3.0)
    assert slave.acceleration == pytest.approx(2.0 / 2 + 36.0 / 20)
    assert slave.jerk == pytest.approx(3 * 6.0 * 2.0 / 20)


def test_the_slave_on_the_polynomial_by_the_chain_rule() -> None:
    """Start, phasing 8, rest 7, from 0 to 15; at 7.5 z is 1/4: f = 53/512, f' = 135/128, f'' = 45/8, f''' = -15/2."""
    rig = Harness(-10.0, curve=POLYNOMIAL, output_phasing=8.0).rest_at(7.0).pulse(start=True)
    rig.go(4.5).move(2.0, 2.0, 1.0)
    assert rig.at == 7.5
    slave, height, stretch, v, a = rig.block.slave, 16.0, 30.0, 4.0, 2.0
    slope, curvature, twist = height * 135 / 128 / stretch, height * 5.625 / stretch**2, height * -7.5 / stretch**3
    assert slave.position == pytest.approx(7.0 + height * 53 / 512)
    assert slave.velocity == pytest.approx(slope * v)
    assert slave.acceleration == pytest.approx(slope * a + curvature * v**2)
    assert slave.jerk == pytest.approx(3 * curvature * v * a + twist * v**3)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.transition_distance) == (0.0, 15.0, 15.0)
    assert (local.progress, local.distance_to_begin, local.distance_to_end) == (0.5, 0.0, 7.5)
    assert local.peak_acceleration_per_v2 == pytest.approx(128 / 135 * math.sqrt(3) / 16)
    assert local.peak_jerk_per_v3 == pytest.approx(512 / 225 / 64)


# Ramps known by hand, in degrees, rest position 180: the examples of the source text and their mirror images.
# law, phasing, whether it is a start, master at the ramp's beginning and end, slave where the master is at 180
RAMP_RESULTS = [
    (PARABOLA, 90.0, True, 90.0, 270.0, 202.5),
    (PARABOLA, 90.0, False, 90.0, 270.0, 157.5),
    (PARABOLA, 180.0, True, 0.0, 360.0, 225.0),
    (PARABOLA, 180.0, False, 0.0, 360.0, 135.0),
    (POLYNOMIAL, 90.0, True, 101.25, 270.0, 195.6103111),
    (POLYNOMIAL, 90.0, False, 90.0, 258.75, 164.3896889),
    (PARABOLA, -90.0, True, 270.0, 90.0, 157.5),
    (PARABOLA, -90.0, False, 270.0, 90.0, 202.5),
    (POLYNOMIAL, -90.0, True, 258.75, 90.0, 164.3896889),
    (POLYNOMIAL, -90.0, False, 270.0, 101.25, 195.6103111),
]


@pytest.mark.parametrize(("curve", "phasing", "starting", "begin", "end", "middle"), RAMP_RESULTS)
def test_known_results_in_degrees(
    curve: Curve, phasing: float, starting: bool, begin: float, end: float, middle: float
) -> None:
    sign = math.copysign(1.0, phasing)
    rig = Harness(180.0 - sign * 190.0, period=360.0, curve=curve, output_phasing=phasing)
    if starting:
        rig.rest_at(180.0)
    rig.pulse(start=starting, stop=not starting, rest_value=180.0)
    rig.go(begin - sign).shows(EXECUTING, s=not starting).slave(180.0 if starting else (begin - sign) % 360.0)
    assert rig.block.local.ramp_begin == pytest.approx(begin % 360.0)
    assert rig.block.local.ramp_end == pytest.approx(end % 360.0)
    rig.go(begin + sign).shows(EXECUTING, s=not starting, ramp=True)
    rig.go(180.0).shows(EXECUTING, s=not starting, ramp=True)
    assert rig.block.slave.position == pytest.approx(middle, abs=5e-8)
    rig.go(end - sign).shows(EXECUTING, s=not starting, ramp=True)
    rig.go(end).shows(READY, s=starting).slave(end % 360.0 if starting else 180.0)
