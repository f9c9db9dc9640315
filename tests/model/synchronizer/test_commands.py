"""The commands of the Synchronizer: edges, what is ignored, what is stacked; with numbers by hand."""

import math
from dataclasses import fields

import pytest

from motionsync.synchronizer.interface import Curve, State
from tests.model.synchronizer.harness import (
    END,
    EXECUTING,
    ONLY,
    PARABOLA,
    POLYNOMIAL,
    READY,
    STACKED,
    START,
    Harness,
)


def test_initially_the_slave_is_the_master() -> None:
    rig = Harness(7.0).shows(READY, s=True).slave(7.0)
    local = rig.block.local
    assert [getattr(local, field.name) for field in fields(local)] == [0.0] * 8
    rig.go(12.0).shows(READY, s=True).slave(12.0, 5.0)
    rig.move(5.0, 2.0, 1.0).slave(18.0, 7.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (2.0, 0.0)
    Harness(370.0, period=360.0).slave(10.0)


def test_at_initialization_the_slave_has_the_master_s_velocity_unless_only_positions_are_known() -> None:
    for mode, expected in [(START, (3.0, 4.0)), (END, (3.0, 4.0)), (ONLY, (0.0, 0.0))]:
        block = Harness(0.0, mode=mode, **{"master.velocity": 3.0, "master.acceleration": 4.0}).block
        assert (block.slave.velocity, block.slave.acceleration) == expected


@pytest.mark.parametrize("command", ["start", "stop"])
def test_the_first_value_seen_is_no_edge(command: str) -> None:
    rig = Harness(0.0, **{command: True, "rest_value": 50.0})
    rig.go(1.0).shows(READY, s=True)
    rig.go(2.0, **{command: False}).shows(READY, s=True)
    rig.go(3.0, **{command: True}).shows(READY if command == "start" else EXECUTING, s=True)


def test_a_held_command_gives_one_edge() -> None:
    rig = Harness(0.0).go(60.0, stop=True, rest_value=20.0).shows(READY, s=False).slave(20.0)
    rig.block.rest_value = 100.0
    rig.go(80.0).shows(READY, s=False).slave(20.0)


@pytest.mark.parametrize("synchronized", [True, False])
def test_a_command_equal_to_s_is_ignored_when_ready(synchronized: bool) -> None:
    rig = Harness(0.0) if synchronized else Harness(0.0).rest_at(20.0)
    rig.go(0.0, start=synchronized, stop=not synchronized, rest_value=33.0).shows(READY, s=synchronized)
    rig.go(100.0).shows(READY, s=synchronized).slave(100.0 if synchronized else 20.0)


@pytest.mark.parametrize("master_position", [0.0, 25.0])
def test_a_command_equal_to_the_running_one_is_ignored_waiting_and_ramping(master_position: float) -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(master_position)
    rig.pulse(stop=True, rest_value=99.0, output_phasing=3.0).shows(EXECUTING, s=True, ramp=master_position > 20.0)
    rig.go(60.0).shows(READY, s=False).slave(30.0)
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(master_position).pulse(start=True, output_phasing=3.0)
    rig.shows(EXECUTING, s=False, ramp=master_position > 20.0).go(35.0).slave(30.0 + 225.0 / 40.0)


def test_stacked_everything_further_is_ignored_until_the_first_is_completed() -> None:
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).pulse(stop=True, rest_value=100.0).shows(STACKED, s=False)
    rig.pulse(stop=True, rest_value=70.0, output_phasing=5.0).shows(STACKED, s=False)
    rig.pulse(start=True).shows(STACKED, s=False)
    rig.pulse(start=True, stop=True, rest_value=60.0, output_phasing=0.0).shows(STACKED, s=False)
    rig.go(25.0, output_phasing=10.0).shows(STACKED, s=False, ramp=True).slave(30.0 + 25.0 / 40.0)
    rig.go(50.0).shows(EXECUTING, s=True).slave(50.0)
    rig.pulse(start=True).shows(STACKED, s=True)
    rig.go(100.0).shows(STACKED, s=True, ramp=True).slave(97.5)
    rig.go(120.0).shows(EXECUTING, s=False).slave(100.0)


@pytest.mark.parametrize("master_position", [0.0, 25.0])
def test_a_command_against_the_running_one_is_stacked_waiting_and_ramping(master_position: float) -> None:
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(master_position).pulse(stop=True, rest_value=60.0)
    rig.shows(STACKED, s=False, ramp=master_position > 20.0)
    rig.go(40.0).shows(EXECUTING, s=True).slave(40.0)
    rig.go(50.0).shows(EXECUTING, s=True, ramp=True).slave(50.0, 10.0)
    rig.go(60.0).slave(57.5, 5.0)
    rig.go(70.0).shows(READY, s=False).slave(60.0, 0.0)


def test_each_command_keeps_phasing_and_rest_value_of_its_edge() -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=50.0, output_phasing=20.0).pulse(start=True, output_phasing=4.0)
    rig.go(40.0, rest_value=-7.0, output_phasing=1.0).shows(STACKED, s=True, ramp=True).slave(50.0 - 900.0 / 80.0)
    assert rig.block.local.transition_distance == 40.0
    rig.go(70.0).shows(EXECUTING, s=False).slave(50.0)
    assert rig.block.local.transition_distance == 8.0
    assert (rig.block.local.ramp_begin, rig.block.local.ramp_end) == (46.0, 54.0)
    rig.go(50.0, 40.0).shows(EXECUTING, s=False).slave(50.0)  # too late: back to its beginning, without a period
    rig.go(50.0).shows(EXECUTING, s=False, ramp=True).slave(51.0, 5.0)
    rig.go(54.0).shows(READY, s=True).slave(54.0)


def test_a_stacked_start_takes_the_rest_position_of_the_running_stop() -> None:
    rig = Harness(0.0, period=360.0).pulse(stop=True, rest_value=50.0).pulse(start=True, rest_value=200.0)
    rig.go(60.0).shows(EXECUTING, s=False).slave(50.0)
    assert (rig.block.local.ramp_begin, rig.block.local.ramp_end) == (40.0, 60.0)
    assert rig.block.local.distance_to_begin == pytest.approx(340.0)
    rig.go(410.0).shows(EXECUTING, s=False, ramp=True).slave(52.5)
    rig.go(420.0).shows(READY, s=True).slave(60.0)


def test_a_stacked_command_begins_in_its_own_direction_from_the_first_one_s_end() -> None:
    """Start upwards, rest 0, ends at 10; the stop downwards starts at 10, which the master is leaving upwards."""
    rig = Harness(-30.0).rest_at(0.0).pulse(start=True).pulse(stop=True, rest_value=0.0, output_phasing=-10.0)
    rig.go(10.0).shows(EXECUTING, s=True, ramp=True).slave(10.0)
    rig.go(30.0).shows(EXECUTING, s=True).slave(30.0)
    rig.go(0.0).shows(EXECUTING, s=True, ramp=True).slave(0.0 + 2.5, -15.0)
    rig.go(-10.0).shows(READY, s=False).slave(0.0)


@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("period", [0.1, 0.7, 6.2, 7.7, 360.0])
@pytest.mark.parametrize("share", [0.00317, 0.0713, 0.917, 3.313])
def test_a_stop_stacked_at_the_narrow_gap_ramps_without_waiting_a_turn(
    curve: Curve, sign: float, period: float, share: float
) -> None:
    """Phasing P/2: the stop's beginning is the start's end. Steps of some share of a turn, from 20 turns on."""
    for rest in (0.0, 0.5 * period, 0.3 * period):
        rig = Harness(20.0 * period, period=period, curve=curve, output_phasing=sign * 0.5 * period).rest_at(rest)
        rig.pulse(start=True).pulse(stop=True, rest_value=rest).shows(STACKED, s=False, ramp=rig.block.syn_ramp_on)
        begin, travelled = rig.at, 0.0
        while rig.block.state == STACKED:
            assert travelled <= (2.1 + share) * period
            travelled += share * period
            rig.go(begin + sign * travelled)
        if share < 1.0:
            rig.shows(EXECUTING, s=True, ramp=True)
            missing = rig.block.local.distance_to_end
            assert 0.0 < missing < rig.block.local.transition_distance
            if curve == PARABOLA:
                gap = rig.block.slave.position - (rest - sign * missing * missing / (2.0 * period))
                assert math.remainder(gap, period) == pytest.approx(0.0, abs=1e-9 * period)
        while rig.block.state == EXECUTING:
            assert travelled <= (3.1 + share) * period
            travelled += share * period
            rig.go(begin + sign * travelled)
        rig.shows(READY, s=False)
        assert math.remainder(rig.block.slave.position - rest, period) == pytest.approx(0.0, abs=1e-12 * period)


def test_the_narrow_gap_in_degrees() -> None:
    """P 360, phasing 180, rest 180: the start ends at 360, where the stop starts."""
    rig = Harness(-10.0, period=360.0, output_phasing=180.0).rest_at(180.0)
    rig.pulse(start=True).pulse(stop=True, rest_value=180.0).go(180.0).shows(STACKED, s=False, ramp=True).slave(225.0)
    rig.go(359.0).shows(STACKED, s=False, ramp=True)
    rig.go(361.0).shows(EXECUTING, s=True, ramp=True).slave(180.0 - 359.0**2 / 720.0)
    rig.go(540.0).slave(135.0).go(720.0).shows(READY, s=False).slave(180.0)


@pytest.mark.parametrize(
    ("synchronized", "state", "ends"),
    [(True, EXECUTING, False), (False, STACKED, False)],
)
def test_start_acts_before_stop_in_the_same_step(synchronized: bool, state: State, ends: bool) -> None:
    """Synchronized the start is ignored and the stop executed; at rest the stop is stacked on the start."""
    rig = Harness(0.0) if synchronized else Harness(0.0).rest_at(30.0)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(state, s=synchronized)
    rig.go(100.0).shows(READY, s=ends).slave(60.0)


def test_start_and_stop_at_once_while_a_command_runs() -> None:
    rig = Harness(0.0).rest_at(30.0).pulse(start=True)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(STACKED, s=False)
    rig.go(100.0).shows(READY, s=False).slave(60.0)
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0)
    rig.pulse(start=True, stop=True, rest_value=60.0).shows(STACKED, s=True)
    rig.go(45.0).shows(EXECUTING, s=False).slave(30.0)  # the start, rest 30, waits: the stop was ignored
    rig.go(20.0, 30.0).shows(EXECUTING, s=False, ramp=True).slave(32.5)
