"""Commands of the Synchronizer that are refused: a phasing out of its range."""

import math

import pytest

from tests.model.synchronizer.harness import EXECUTING, READY, STACKED, Harness


@pytest.mark.parametrize("phasing", [0.0, -0.0, 9.9e-10, -9.9e-10, 1.001e12, -1e13, math.inf, -math.inf, math.nan])
def test_a_command_with_a_bad_phasing_is_refused_and_moves_nothing(phasing: float) -> None:
    rig = (
        Harness(0.0)
        .go(5.0, stop=True, rest_value=20.0, output_phasing=phasing)
        .shows(READY, s=True, error=1)
        .slave(5.0)
    )
    rig.go(50.0, stop=False).shows(READY, s=True, error=1).slave(50.0)
    rig.go(0.0, output_phasing=10.0).shows(READY, s=True, error=1)
    rig.go(25.0, stop=True).shows(EXECUTING, s=True, ramp=True).slave(20.0 - 25.0 / 40.0)
    rig = Harness(0.0).rest_at(20.0).pulse(start=True, output_phasing=phasing).shows(READY, s=False, error=1)
    rig.go(50.0).slave(20.0)


@pytest.mark.parametrize("phasing", [1e-9, -1e-9, 1e12, -1e12])
def test_the_limits_of_the_phasing_are_allowed(phasing: float) -> None:
    rig = Harness(0.0).go(0.0, stop=True, rest_value=2 * phasing, output_phasing=phasing)
    rig.shows(EXECUTING, s=True).go(4 * phasing).shows(READY, s=False).slave(2 * phasing)


def test_a_refused_command_is_not_stacked_and_leaves_the_running_one() -> None:
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).pulse(start=True, output_phasing=0.0)
    rig.shows(EXECUTING, s=True, error=1).go(30.0).shows(EXECUTING, s=True, ramp=True, error=1).slave(27.5)
    rig.go(60.0).shows(READY, s=False, error=1).slave(30.0)


def test_an_ignored_command_is_not_refused_and_clears_the_error() -> None:
    rig = Harness(0.0).pulse(stop=True, output_phasing=0.0).shows(READY, s=True, error=1)
    rig.pulse(start=True).shows(READY, s=True)
    rig.pulse(stop=True).shows(READY, s=True, error=1).pulse(start=True, stop=True).shows(READY, s=True, error=1)
    rig = Harness(0.0).pulse(stop=True, rest_value=30.0).pulse(start=True, output_phasing=math.nan)
    rig.shows(EXECUTING, s=True, error=1).pulse(stop=True).shows(EXECUTING, s=True)
    rig.pulse(start=True, output_phasing=10.0).shows(STACKED, s=True)
    rig.pulse(start=True, output_phasing=0.0).shows(STACKED, s=True)


def test_an_inactive_block_does_not_look_at_the_phasing() -> None:
    rig = Harness(0.0).pulse(stop=True, output_phasing=0.0).shows(READY, s=True, error=1)
    rig.pulse(active=False, stop=True, rest_value=4.0).shows(READY, s=False).slave(4.0)
    rig.pulse(active=True, start=True).shows(READY, s=False, error=1)
