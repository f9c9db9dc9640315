"""What the master's period and input correction mean to the Follower."""

from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.follower.faults import Fault
from motionsync.follower.interface import State
from motionsync.master import MasterInput
from tests.model.follower.harness import CYCLIC, END, ONLY, PASSING, START, near, parked
from tests.support.blocks.drawn import drawn


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


@drawn()
@given(
    st.sampled_from([{}, CYCLIC, {**PASSING, "master_cycle": 512.0}]),
    st.sampled_from([START, END, ONLY]),
    st.integers(1, 64),
    st.sampled_from([1.0, 0.25, 2.0**-7]),
    st.integers(1, 20),
)
def test_a_master_that_comes_back_to_a_start_exactly_at_a_communication_point_starts_nothing(
    values: dict[str, Any], mode: MasterInput, size: int, h: float, steps: int
) -> None:
    """The way to the meeting starts 200 before it: there the master is after `steps` steps back, not at first."""
    assume(size * steps % values.get("master_cycle", 1000.0) != 0)
    follower = parked(0.0, 0.0, mode, **values, sync_master=200.0 - size * steps)
    follower.speed = -size / h
    for _ in range(steps + 3):
        assert follower.run(h).state in (State.M_WAITING, State.M_WAITING_NEXT_CYCLE)
        assert (follower.fault, follower.slave) == (Fault.NONE, (0.0, 0.0, 0.0))


@pytest.mark.parametrize("beyond", [0.5, 8.0])
def test_a_correction_of_a_master_that_comes_back_starts_nothing(beyond: float) -> None:
    """The prediction ends before the start at 800; the master is behind it and still falls."""
    follower = parked(900.0, -100.0).to(800.0 - beyond)
    follower.master_position = 800.0 + beyond
    follower.speed = -1.0
    assert (follower.run(0.25).state, follower.fault) == (State.M_WAITING_NEXT_CYCLE, Fault.NONE)
    assert follower.missing[0] == near(1000.0 - beyond + 0.25)
