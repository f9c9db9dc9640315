"""The inactive Synchronizer, and what activation and deactivation do."""

import pytest

from tests.model.synchronizer.harness import EXECUTING, READY, STACKED, Harness


def test_inactive_commands_act_at_once() -> None:
    rig = Harness(3.0, active=False).shows(READY, s=True).go(7.0, stop=True, rest_value=42.0)
    rig.shows(READY, s=False).slave(42.0, 0.0)
    rig.go(8.0, stop=False, rest_value=1.0).slave(42.0)
    rig.go(9.0, stop=True).slave(1.0)  # again, with another rest value: nothing is ignored
    rig.go(12.0, start=True).shows(READY, s=True).slave(12.0, 3.0)
    rig.go(20.0, start=False, stop=False).slave(20.0, 8.0)
    rig.go(21.0, start=True, stop=True, rest_value=5.0).shows(READY, s=False).slave(5.0)
    Harness(3.0, active=False, period=360.0).go(7.0, stop=True, rest_value=-10.0).slave(350.0)
    assert rig.block.local.transition_distance == 0.0


def test_inactive_the_output_is_master_or_rest_whatever_the_master_does() -> None:
    rig = Harness(0.0, active=False).pulse(stop=True, rest_value=30.0)
    rig.go(20.0, 30.0, 70.0, -50.0).shows(READY, s=False).slave(30.0, 0.0)


def test_activation_changes_nothing_by_itself() -> None:
    rig = Harness(0.0, active=False).pulse(stop=True, rest_value=30.0).go(20.0, active=True).shows(READY, s=False)
    rig.go(100.0).shows(READY, s=False).slave(30.0)
    rig = Harness(0.0, active=False, start=True, stop=True).go(1.0).shows(READY, s=True).go(2.0, active=True)
    rig.shows(READY, s=True).slave(2.0)


def test_an_activation_acts_before_a_command_of_the_same_step() -> None:
    rig = Harness(0.0, active=False).go(0.0, active=True, stop=True, rest_value=30.0).shows(EXECUTING, s=True)
    rig.go(0.0, active=False, start=True, stop=False).shows(READY, s=True).slave(0.0)


def test_a_deactivation_acts_before_a_command_of_the_same_step() -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(5.0, active=False, start=True).shows(READY, s=True)
    rig.slave(5.0, 5.0)
    rig.go(6.0, stop=True, rest_value=1.0).shows(READY, s=False).slave(1.0)


@pytest.mark.parametrize("master_position", [0.0, 25.0])
def test_a_deactivation_in_executing_does_at_once_what_the_command_would(master_position: float) -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(master_position, rest_value=77.0)
    rig.go(master_position + 1.0, active=False).shows(READY, s=False).slave(30.0, 0.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (0.0, 0.0)
    rig.go(100.0, active=True).shows(READY, s=False).slave(30.0)
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(master_position, rest_value=77.0)
    rig.go(master_position + 1.0, active=False).shows(READY, s=True).slave(master_position + 1.0, 1.0)
    assert (rig.block.slave.acceleration, rig.block.slave.jerk) == (0.0, 0.0)


@pytest.mark.parametrize("master_position", [0.0, 25.0])
def test_a_deactivation_in_stacked_does_at_once_what_both_commands_would(master_position: float) -> None:
    rig = (
        Harness(0.0)
        .rest_at(30.0)
        .pulse(start=True)
        .go(master_position)
        .pulse(stop=True, rest_value=55.0)
        .shows(STACKED, s=False, ramp=master_position > 20.0)
    )
    rig.go(master_position, rest_value=99.0, active=False).shows(READY, s=False).slave(55.0, 0.0)
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(master_position).pulse(start=True)
    rig.go(master_position + 1.0, active=False).shows(READY, s=True).slave(master_position + 1.0, 1.0)
    rig.go(master_position, active=True, rest_value=99.0).pulse(stop=True, output_phasing=0.0)
    rig.shows(READY, s=True, error=1)


def test_a_deactivation_when_ready_changes_nothing() -> None:
    Harness(0.0).go(1.0, active=False).shows(READY, s=True).slave(1.0)
    Harness(0.0).rest_at(30.0).go(1.0, active=False).shows(READY, s=False).slave(30.0)
    Harness(0.0).pulse(stop=True, output_phasing=0.0).go(1.0, active=False).shows(READY, s=True, error=1)


def test_after_a_deactivation_the_ramp_shown_is_the_last_one() -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).go(25.0)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 0.25)
    rig.go(35.0, active=False)
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 0.25)
    assert (local.distance_to_begin, local.distance_to_end) == (0.0, 0.0)
