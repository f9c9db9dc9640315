"""When a command of the Synchronizer is armed, and in which turn of the master its ramp starts."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.interface import Curve
from tests.model.synchronizer.harness import END, EXECUTING, ONLY, PARABOLA, POLYNOMIAL, READY, START, Harness
from tests.support.blocks.drawn import drawn


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("period", [0.0, 360.0])
@pytest.mark.parametrize(("beyond", "ramps"), [(0.0, True), (5e-9, True), (2e-8, False)])
def test_a_command_given_at_its_begin_starts_at_once(curve: Curve, period: float, beyond: float, ramps: bool) -> None:
    """The begin may be passed by 1e-9 of the phasing of 10."""
    rig = Harness(20.0 + beyond, curve=curve, period=period).go(22.0, stop=True, rest_value=30.0)
    rig.shows(EXECUTING, s=True, ramp=ramps)
    if ramps and curve == PARABOLA:
        rig.slave(30.0 - 18.0**2 / 40.0)
    elif not ramps:
        rig.slave(22.0)


def test_at_exactly_its_ends_the_slave_is_on_the_ramp_or_beyond_it() -> None:
    rig = Harness(0.0).go(20.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True).slave(20.0, 20.0)
    assert rig.block.slave.acceleration == -(20.0**2) / 20.0
    assert rig.block.local.progress == 0.0
    rig.go(40.0).shows(READY, s=False).slave(30.0, 0.0)
    assert (rig.block.slave.acceleration, rig.block.local.progress) == (0.0, 1.0)


def test_a_command_given_too_late_waits_a_turn() -> None:
    rig = Harness(25.0, period=360.0).pulse(stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    local = rig.block.local
    assert (local.distance_to_begin, local.distance_to_end, local.progress) == (355.0, 375.0, 0.0)
    rig.go(45.0, 200.0, 379.0).shows(EXECUTING, s=True).slave(19.0)
    rig.go(390.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(500.0).shows(READY, s=False).slave(30.0)


def test_a_command_given_too_late_without_a_period_waits_for_the_master_to_come_back() -> None:
    rig = Harness(25.0).pulse(stop=True, rest_value=30.0).go(100.0).shows(EXECUTING, s=True).slave(100.0)
    local = rig.block.local
    assert (local.distance_to_begin, local.distance_to_end, local.progress) == (80.0, 100.0, 0.0)
    rig.go(20.5, 100.0).shows(EXECUTING, s=True)
    rig.go(-40.0).shows(EXECUTING, s=True).slave(-40.0)
    assert (local.distance_to_begin, local.distance_to_end) == (60.0, 80.0)
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)
    rig.go(40.0).shows(READY, s=False)


def test_once_armed_a_command_stays_armed() -> None:
    rig = Harness(30.0).rest_at(50.0).go(30.0, 35.0, start=True).go(-1000.0, 39.0)
    rig.shows(EXECUTING, s=False).slave(50.0).go(50.0).shows(EXECUTING, s=False, ramp=True).slave(52.5)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_command_against_the_master_s_direction_waits_for_ever_and_deactivation_ends_it(direction: float) -> None:
    """With a period: never on a ramp, although the master passes 99 of them."""
    rig = Harness(3.0, period=50.0, output_phasing=direction * 10.0).pulse(stop=True, rest_value=30.0)
    for _ in range(700):
        rig.go(rig.at - direction * 7.0710678).shows(EXECUTING, s=True)
        rig.slave(rig.at % 50.0)
    rig.go(rig.at, active=False).shows(READY, s=False).slave(30.0)


@pytest.mark.parametrize(("lowest", "ramps"), [(20.0, True), (20.0 + 5e-9, True), (20.0 + 3e-8, False), (19.0, True)])
@pytest.mark.parametrize("h", [4.0, 1.0, 0.25])
def test_a_turning_point_at_the_begin_arms_a_late_command(lowest: float, ramps: bool, h: float) -> None:
    """m = lowest + (t - 2)²: given at 24, turning at 2 s, within the step or at its end; 29 at 5 s."""
    rig = Harness(lowest + 4.0)
    rig.go(rig.at, stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    for i in range(int(4.0 / h)):
        rig.move(2.0 * (i * h - 2.0), 2.0, h)
    rig.shows(EXECUTING, s=True, ramp=ramps)
    rig.slave(30.0 - (16.0 - (lowest - 20.0)) ** 2 / 40.0 if ramps else lowest + 4.0)


def test_a_turning_point_inside_a_step_completes_a_command() -> None:
    """m = 50 - 10 (t - 1)²... up past the end at 40 and back below it within one step of 2 s."""
    rig = Harness(15.0).pulse(stop=True, rest_value=30.0)
    rig.move(60.0, -60.0, 2.0).shows(READY, s=False).slave(30.0)
    assert rig.at == 15.0
    rig = Harness(15.0).pulse(stop=True, rest_value=30.0)
    rig.move(48.0, -48.0, 2.0).shows(EXECUTING, s=True).slave(15.0)  # only up to 39


def test_a_turning_point_on_the_cubic_completes_a_command() -> None:
    """From 15 and back in 2 s, with velocities of 60 and -60 at the ends: up to 45."""
    rig = Harness(15.0, mode=END, **{"master.velocity": 60.0})
    rig.move(60.0, -60.0, 2.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0)
    assert rig.at == 15.0


@pytest.mark.parametrize("turns", [1, 2, 7])
@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
def test_back_from_the_ramp_to_where_an_earlier_turn_s_begins_the_slave_is_not_on_that_one(
    curve: Curve, turns: int
) -> None:
    """The stop's ramp begins at 20 of each turn of 50; the master goes back from 25 to such a 20 within one step."""
    rig = Harness(0.0, curve=curve, period=50.0).go(25.0, stop=True, rest_value=30.0)
    rig.shows(EXECUTING, s=True, ramp=True).go(20.0 - 50.0 * turns).shows(EXECUTING, s=True).slave(20.0)
    assert rig.block.slave.acceleration == 0.0
    rig.go(25.0 - 50.0 * turns).shows(EXECUTING, s=True, ramp=True)


def test_a_correction_of_a_master_that_goes_against_the_sign_does_not_lead_onto_the_ramp() -> None:
    """The prediction ends at 19.5, before the beginning at 20; the master has slowed down to 1 and is at 20.5."""
    rig = Harness(30.0, period=50.0).rest_at(30.0).pulse(start=True).go(19.5)
    rig.at = 20.5
    rig.move(-1.0, 0.0, 0.25).shows(EXECUTING, s=False).slave(30.0, 0.0)
    assert rig.block.local.distance_to_begin == pytest.approx(49.75)


dyadic = st.integers(1, 64).map(lambda number: number / 16)


@drawn(250)
@given(
    st.sampled_from([PARABOLA, POLYNOMIAL]),
    st.booleans(),
    st.sampled_from([1.0, -1.0]),
    st.sampled_from([START, END, ONLY]),
    st.sampled_from([0.0, 100.0, 360.0]),
    dyadic,
    st.sampled_from([1.0, 0.25, 2.0**-7]),
    st.lists(dyadic, min_size=2, max_size=12),
    st.integers(0, 10),
)
def test_against_the_sign_nothing_ramps_at_any_communication_point(
    curve: Curve,
    starting: bool,
    sign: float,
    mode: MasterInput,
    period: float,
    size: float,
    h: float,
    speeds: list[float],
    hit: int,
) -> None:
    """The master goes against the sign, from speed to speed or (its position alone) at one speed. All numbers are
    dyadic, so that a communication point is exactly where the ramp would begin: D before the rest position, of a
    polynomial's start 7/8 D. The slave stays at rest, or is the master."""
    before = size * 7 / 8 if starting and curve == POLYNOMIAL else size
    pairs = list(pairwise(speeds if mode != ONLY else speeds[:1] * len(speeds)))
    motions = [(-sign * first, -sign * (second - first) / h) for first, second in pairs]
    travels = [(velocity + 0.5 * acceleration * h) * h for velocity, acceleration in motions]
    begin = sum(travels[: hit % len(travels) + 1])
    rest = begin + sign * before
    rig = Harness(0.0, period=period, curve=curve, output_phasing=sign * size, mode=mode)
    rig.block.master.velocity = motions[0][0]
    if starting:
        rig.rest_at(rest)
    commands = {"start": starting, "stop": not starting, "rest_value": rest}
    for velocity, acceleration in motions:
        rig.move(velocity, acceleration, h, **commands).shows(EXECUTING, s=not starting)
        slave, master = rig.block.slave, rig.block.master
        if starting:
            at_rest = rest % period if period > 0.0 else rest
            assert (slave.position, slave.velocity, slave.acceleration, slave.jerk) == (at_rest, 0.0, 0.0, 0.0)
        else:
            assert (slave.position, slave.velocity) == (master.smoothed_position, master.end_velocity)
            assert (slave.acceleration, slave.jerk) == (master.end_acceleration, 0.0)
