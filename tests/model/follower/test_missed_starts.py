"""When it is too late for the present cycle: the Follower then waits for the next one in M_WAITING_NEXT_CYCLE.

The slave is linear, from its park at 0 to sync at 100 L, out at 300 L, braking over 100 L, k = 1, in units of the scale
L: the way to a meeting Q starts at Q - 200 L, and the slave is back at its park one cycle later, less the wait.
"""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.follower.interface import State
from tests.model.follower.harness import FollowerHarness, near, parked
from tests.support.blocks.drawn import drawn

WAITING, NEXT_CYCLE, FOLLOWING = State.M_WAITING, State.M_WAITING_NEXT_CYCLE, State.M_FOLLOWING
repeatable = drawn(60)


@st.composite
def machines(draw: st.DrawFn) -> dict[str, Any]:
    """A cycle of 850 L and more, a wait for which the cycle is long enough, and a meeting anywhere."""
    scale = draw(st.sampled_from([1.0, 0.01, 5.0]))
    cycle = scale * draw(st.floats(850.0, 3000.0))
    return {
        "scale": scale,
        "master_cycle": cycle,
        "space_wait_in_park": draw(st.sampled_from([0.0, 0.3, 0.9])) * (cycle - 800.0 * scale),
        "sync_master": draw(st.floats(-2.0, 2.0)) * cycle,
        "sync_slave": 100.0 * scale,
        "sync_out": 300.0 * scale,
        "space_stop_slave": 100.0 * scale,
    }


def waits_for_the_next_cycle(follower: FollowerHarness, start: float, values: dict[str, Any]) -> None:
    """Up to the next start, less the wait, for the next cycle; then for the start."""
    wait, little = values["space_wait_in_park"], 1e-4 * values["master_cycle"]
    assert follower["master_to_start"] == near(start - follower.master_position, tolerance=1e-6)
    assert follower.to(start - wait - little).state == NEXT_CYCLE
    if wait > 0.0:
        assert follower.to(start - wait + little).state == WAITING
        assert follower.to(start - little).state == WAITING
    assert follower.to(start + little).state == FOLLOWING


@repeatable
@given(machines(), st.integers(-3, 3), st.floats(0.02, 0.98))
def test_positioned_between_the_start_and_its_meeting_the_slave_waits_for_the_next_cycle(
    values: dict[str, Any], cycles: int, share: float
) -> None:
    approach = 200.0 * values.pop("scale")
    start = values["sync_master"] + cycles * values["master_cycle"] - approach
    follower = parked(start + share * approach, values["master_cycle"] / 8.0, **values)
    assert follower.state == NEXT_CYCLE
    waits_for_the_next_cycle(follower, start + values["master_cycle"], values)


@repeatable
@given(machines(), st.integers(-3, 3), st.floats(0.02, 0.98))
def test_positioned_before_the_start_the_slave_waits_for_this_cycle(
    values: dict[str, Any], cycles: int, share: float
) -> None:
    """From the meeting before on."""
    approach = 200.0 * values.pop("scale")
    meeting = values["sync_master"] + cycles * values["master_cycle"]
    follower = parked(
        meeting - approach - share * (values["master_cycle"] - approach), values["master_cycle"] / 8.0, **values
    )
    assert follower.state == WAITING
    assert follower.to(meeting - 0.5 * approach).state == FOLLOWING


@repeatable
@given(machines(), st.floats(0.1, 0.9), st.floats(0.1, 0.9))
def test_a_change_that_moves_the_start_behind_the_master_is_too_late_for_this_cycle(
    values: dict[str, Any], missing: float, moved: float
) -> None:
    """The start is ahead by a share `missing` of M_f, and comes to be as much behind as `moved` says."""
    approach = 200.0 * values.pop("scale")
    start = values["sync_master"] - approach
    follower = parked(start - missing * approach, values["master_cycle"] / 8.0, **values)
    assert follower.run(2.0**-20).state == WAITING
    earlier = (missing + moved) * approach
    follower.set({"sync_master": values["sync_master"] - earlier}).run(2.0**-20)
    assert follower.state == NEXT_CYCLE
    waits_for_the_next_cycle(follower, start - earlier + values["master_cycle"], values)


@repeatable
@given(machines(), st.floats(0.3, 0.9), st.floats(0.1, 0.9))
def test_a_change_on_the_way_home_may_come_too_late_for_the_next_cycle(
    values: dict[str, Any], place: float, moved: float
) -> None:
    """The change comes between 400 L behind the meeting, where the way home starts, and the park, where the slave
    arrives one wait before the start that it was paced for."""
    scale = values.pop("scale")
    wait = values["space_wait_in_park"]
    start = values["sync_master"] - 200.0 * scale
    arrival = start + values["master_cycle"] - wait
    follower = parked(start - 10.0 * scale, values["master_cycle"] / 8.0, **values)
    home = values["sync_master"] + 400.0 * scale
    assert follower.to(home + place * (arrival - home)).state == State.M_HOMING
    earlier = wait + moved * (0.5 * values["master_cycle"] - wait) if wait < 0.4 * values["master_cycle"] else None
    if earlier is None:
        return
    follower.set({"sync_master": values["sync_master"] - earlier})
    assert follower.to(arrival + 1e-3 * scale).state == NEXT_CYCLE
    waits_for_the_next_cycle(follower, start - earlier + 2.0 * values["master_cycle"], values)


@pytest.mark.parametrize("to_sync", [100.0, 60.0])
def test_a_wait_that_follows_the_way_home_is_one_for_the_cycle_that_comes(to_sync: float) -> None:
    """A cyclic slave, whose way home ends long before the next start: 2.5 times 100 behind sync_out."""
    follower = parked(slave_cycle=400.0, sync_slave=to_sync, sync_master=500.0).to(500.0)
    assert follower.to(500.0 + (300.0 - to_sync) + 251.0).state == WAITING
    assert follower.to(1500.0 - 2.0 * to_sync + 1.0).state == FOLLOWING
