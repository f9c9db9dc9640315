"""The Synchronizer after many turns of its master, and at the limit of turns."""

from copy import deepcopy

import pytest

from motionsync.synchronizer.faults import Refusal
from tests.model.synchronizer.harness import EXECUTING, READY, Harness, write


@pytest.mark.parametrize("period", [360.0, 0.1, 7.7])
def test_after_ten_million_turns_a_ramp_is_where_it_was(period: float) -> None:
    """The stop waits while the master goes back 10⁷ turns in 10 steps, then forwards."""
    rig = Harness(0.0, period=period, output_phasing=0.2 * period).pulse(stop=True, rest_value=0.5 * period)
    for _ in range(10):
        rig.at = 0.0
        rig.move(-1e6 * period, 0.0, 1.0).shows(EXECUTING, s=True)
    rig.at = 0.0
    for master_position in (0.29, 0.31, 0.5):
        rig.go(master_position * period).shows(EXECUTING, s=True, ramp=master_position > 0.3)
    assert rig.block.slave.position == pytest.approx(0.45 * period, rel=1e-14)
    rig.go(0.71 * period).shows(READY, s=False)
    assert rig.block.slave.position == 0.5 * period


def test_a_refused_step_changes_nothing() -> None:
    """Waiting for a ramp, three turns on, whole turns not yet dropped."""
    rig = (
        Harness(0.0, period=1e-6, output_phasing=1e-7)
        .pulse(stop=True, rest_value=5e-7, output_phasing=-1e-7)
        .go(3.3e-6)
    )
    write(rig.block, {"master.position": 0.0, "master.velocity": 1e12})
    before = deepcopy(rig.block)
    assert rig.block.step(1.0) == Refusal.MASTER_TURNS
    assert rig.block == before
