"""What the master's period and input correction mean to the Follower."""

from typing import Any

import pytest

from motionsync.follower.interface import State
from motionsync.master import MasterInput
from tests.model.follower.harness import CYCLIC, END, ONLY, PASSING, START, near, parked


@pytest.mark.parametrize("mode", [START, END, ONLY])
@pytest.mark.parametrize("period", [0.0, 1000.0, 3000.0, 700.0, 5000.0])
@pytest.mark.parametrize("values", [{}, {**PASSING, "master_cycle": 500.0}, {**CYCLIC, "master_cycle": 400.0}])
def test_a_period_of_the_master_changes_nothing(mode: MasterInput, period: float, values: dict[str, Any]) -> None:
    follower, other = (parked(**values, mode=mode, master__period=p) for p in (0.0, period))
    for _ in range(100):
        master_position = follower.master_position + 93.7
        assert other.to(master_position).slave == near(*follower.to(master_position).slave, tolerance=1e-8)
        assert other.missing == near(*follower.missing, tolerance=1e-8)


def test_positions_count_from_the_present_turn() -> None:
    """So they keep their last bits over any number of turns."""
    follower = parked(master__period=1000.0)
    for _ in range(50):
        follower.to(follower.master_position + 7083.7)
        current = follower.block.sequence.current
        places = (follower.block.master.end, current.meeting, current.cam_section.begin, current.cam_section.end)
        assert max(abs(x) for x in places) < 3000.0
    assert follower["cycle"] == 353  # 354185 - 1200


def test_the_input_correction_may_hold_a_start() -> None:
    """The master jumps over it between two steps."""
    follower = parked().to(790.0)
    follower.master_position = 900.0
    follower.run(2.0**-30)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(18.75, tolerance=1e-6))
