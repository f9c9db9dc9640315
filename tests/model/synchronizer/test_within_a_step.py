"""What happens within one step of the Synchronizer: its events in their order, and the input correction."""

import pytest

from motionsync.synchronizer.interface import Curve
from tests.model.synchronizer.harness import END, EXECUTING, PARABOLA, POLYNOMIAL, READY, Harness


def test_one_giant_step_may_complete_a_transition() -> None:
    rig = Harness(0.0).move(1e6, 0.0, 1.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0, 0.0)
    local = rig.block.local
    assert (local.ramp_begin, local.ramp_end, local.progress) == (20.0, 40.0, 1.0)
    rig = Harness(0.0, period=360.0).move(1e6, 0.0, 1.0, stop=True, rest_value=30.0).shows(READY, s=False).slave(30.0)


@pytest.mark.parametrize("period", [0.0, 360.0])
@pytest.mark.parametrize("curve", [PARABOLA, POLYNOMIAL])
def test_one_giant_step_may_complete_a_start_and_the_stop_stacked_on_it(period: float, curve: Curve) -> None:
    """Given in the same step: the start from 30 and the stop at 200."""
    rig = Harness(0.0, period=period, curve=curve).rest_at(30.0)
    rig.go(1000.0, start=True, stop=True, rest_value=200.0).shows(READY, s=False).slave(200.0, 0.0)
    local = rig.block.local
    assert local.ramp_begin == pytest.approx(190.0)
    assert local.ramp_end == pytest.approx(210.0 if curve == PARABOLA else 208.75)


def test_one_giant_step_without_a_period_misses_a_stop_whose_begin_is_before_the_start_s_end() -> None:
    """The stop at 45 starts at 35, the start ends at 40: taken up too late, it waits for the master to come back."""
    rig = Harness(0.0).rest_at(30.0).go(1000.0, start=True, stop=True, rest_value=45.0).shows(EXECUTING, s=True)
    rig.slave(1000.0)
    rig.go(0.0, 45.0).shows(EXECUTING, s=True, ramp=True).slave(42.5)


def test_one_giant_step_may_end_on_the_stacked_command_s_ramp() -> None:
    rig = Harness(0.0).rest_at(30.0).go(60.0, start=True, stop=True, rest_value=60.0)
    rig.shows(EXECUTING, s=True, ramp=True).slave(57.5, 30.0)


def test_a_step_may_complete_the_first_command_upwards_and_the_stacked_one_downwards() -> None:
    """Up to 45 and back to 15 in one step: the start from 30 ends at 40, the stop at 30 the other way starts there."""
    rig = Harness(15.0).rest_at(30.0).pulse(start=True).pulse(stop=True, rest_value=30.0, output_phasing=-10.0)
    rig.move(60.0, -60.0, 2.0).shows(READY, s=False).slave(30.0)


def test_the_input_correction_belongs_to_the_path_and_comes_before_the_commands() -> None:
    """The prediction ends at 39.9; the next input is 40.1. The start, up to 40, is completed in between; the stop given
    with that input, from 40 on, is too late: had it been stacked, it would ramp."""
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(39.9).shows(EXECUTING, s=False, ramp=True)
    rig.at = 40.1
    rig.go(40.2, stop=True, rest_value=50.0).shows(EXECUTING, s=True).slave(40.2)
    rig.go(1000.0).shows(EXECUTING, s=True).slave(1000.0)
    stacked = Harness(0.0).rest_at(30.0).pulse(start=True).go(39.9)
    stacked.go(40.2, stop=True, rest_value=50.0).shows(EXECUTING, s=True, ramp=True)


def test_a_start_that_ends_in_the_input_correction_is_no_longer_running_for_the_command_after_it() -> None:
    """The same start that would be taken up again is ignored, a stop is refused rather than stacked."""
    rig = Harness(0.0).rest_at(30.0).pulse(start=True).go(39.9)
    rig.at = 40.1
    rig.go(41.0, start=True, stop=True, output_phasing=0.0).shows(READY, s=True, error=1).slave(41.0)


def test_an_input_correction_backwards_may_arm_a_late_command() -> None:
    rig = Harness(25.0).pulse(stop=True, rest_value=30.0).go(24.0)
    rig.at = 19.0
    rig.go(30.0).shows(EXECUTING, s=True, ramp=True).slave(27.5)


def test_the_first_step_has_no_input_correction() -> None:
    """Between initialization at 0 and the first input at 25 nothing is passed."""
    rig = Harness(0.0)
    rig.at = 25.0
    rig.go(26.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True).slave(26.0)
    rig.go(100.0).shows(EXECUTING, s=True)


def test_with_inputs_of_the_step_s_end_an_edge_acts_at_its_beginning() -> None:
    """The stop's ramp starts at 20: where the master was at the call before, or at initialization."""
    rig = Harness(20.0, mode=END).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True)
    rig.slave(30.0 - 225.0 / 40.0)
    rig = Harness(0.0, mode=END).go(20.0).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True, ramp=True)
    rig = Harness(0.0, mode=END).go(21.0).go(25.0, stop=True, rest_value=30.0).shows(EXECUTING, s=True)
