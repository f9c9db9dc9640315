"""When the Follower reads its parameters: at the start of a cycle, where it leaves the master, and at the park."""

import pytest

from motionsync.follower.faults import Fault
from motionsync.follower.interface import State
from tests.model.follower.harness import near, parked


def test_parameters_are_not_read_inside_a_phase() -> None:
    changed = {"sync_slave": 90.0, "sync_out": 400.0, "k_slave_master": 1.5, "park_slave": 1.0, "master_cycle": 3000.0}
    follower = parked().to(850.0).set(changed).to(900.0)
    assert follower.position == near(18.75)
    assert follower.to(1100.0).position == near(200.0)
    assert follower.set({"sync_out": 300.0}).to(1300.0).position == near(381.25)


def test_the_way_home_is_read_where_the_synchronized_phase_ends() -> None:
    """M_f = 2 (120 - 20) / 1.25 = 160, next meeting 2040: home from 1200 + 2 * 150 up to 2040 - 160 - 80."""
    follower = parked().to(1100.0)
    follower.set({"park_slave": 20.0, "sync_slave": 120.0, "k_slave_master": 1.25, "space_stop_slave": 150.0})
    follower.set({"sync_master": 40.0, "space_wait_in_park": 80.0}).to(1250.0)
    follower.set({"park_slave": 0.0, "space_stop_slave": 10.0, "space_wait_in_park": 0.0})
    assert follower.missing == near(630.0, 790.0, 790.0 + 180.0 / 1.25)
    assert follower.to(1500.0).slave == near(450.0, 0.0, 0.0)
    assert follower.to(1650.0).position == near(235.0)
    assert (follower.to(1800.0).state, follower.position) == (State.M_WAITING, near(20.0))
    assert follower.to(1960.0).slave == near(20.0 + 100.0 * 3.0 / 16.0, 62.5, 1.25 * 1.5 / 160.0 * 1e4)  # u = 1/2
    assert follower.to(2050.0).slave == near(132.5, 125.0, 0.0)


@pytest.mark.parametrize(
    ("value", "meeting"),
    [(30.0, 2030.0), (-30.0, 1970.0), (-499.0, 1501.0 + 1000.0), (-400.0, 1600.0), (600.0, 1600.0)],
)
def test_the_next_meeting_is_the_first_one_that_is_half_a_cycle_ahead(value: float, meeting: float) -> None:
    values = {} if meeting != 1600.0 else {"sync_out": 110.0, "space_stop_slave": 10.0}
    follower = parked(**values).to(1005.0).set({"sync_master": value}).to(1250.0)
    if value == -499.0:  # 1501 - 200 is before the end of the stroke
        assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.CYCLE_TOO_SHORT)
    else:
        assert follower["master_to_sync"] == near(meeting - 1250.0)
        assert follower.to(meeting).position == near(100.0)


def test_at_the_park_the_meeting_is_chosen_anew() -> None:
    follower = parked().to(700.0).set({"sync_master": 50.0}).run(0.01)
    assert follower["master_to_sync"] == near(349.0)
    follower.set({"sync_master": -50.0, "sync_slave": 50.0}).run(0.01)
    assert follower.missing == near(148.0, 248.0, 498.0)
    assert follower.to(900.0).position == near(50.0 * 3.0 / 16.0)


def test_a_start_that_a_change_moves_behind_the_master_is_left_for_the_next_one() -> None:
    follower = parked(space_wait_in_park=100.0).to(700.0).set({"sync_master": -150.0}).run(0.01)
    assert (follower.state, follower["master_to_sync"]) == (State.M_WAITING_NEXT_CYCLE, near(1149.0))
    assert follower.to(1750.0).position == near(18.75)


def test_a_new_park_is_taken_on_the_way_home_only() -> None:
    follower = parked().set({"park_slave": 10.0}).to(900.0)
    assert follower.position == near(18.75)
    assert follower.to(1820.0).slave == near(10.0, 0.0, 0.0)  # 2000 - 2 * 90
    assert follower.to(1910.0).position == near(10.0 + 90.0 * 3.0 / 16.0)
