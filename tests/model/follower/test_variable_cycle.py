"""A variable cycle: each new value of sync_master is one meeting."""

import pytest

from motionsync.follower.faults import DropReason
from motionsync.follower.interface import State
from tests.model.follower.harness import PASSING, VARIABLE, near, parked, quintic


def test_each_new_value_is_one_meeting() -> None:
    follower = parked(**VARIABLE).to(900.0)
    assert follower.position == near(18.75)
    follower.set({"sync_master": 2300.0}).to(1750.0)  # home from 1400 to 2100
    assert (follower.position, follower["master_to_sync"]) == (near(200.0), near(550.0))
    assert follower.to(2200.0).position == near(18.75)
    assert follower.to(3000.0).missing == (0.0, 0.0, 0.0)  # none known: home as if it were 3300
    assert follower.position == near(400.0 * (1.0 - quintic(400.0, 0.0, 0.0, 1.0, 0.0, 300.0)))
    assert (follower.to(9000.0).state, follower.position, follower["cycle"]) == (State.M_WAITING, 0.0, 2)


def test_the_last_value_counts() -> None:
    follower = parked(**VARIABLE).to(850.0).set({"sync_master": 2300.0}).to(1050.0).set({"sync_master": 2100.0})
    assert follower.to(1650.0).position == near(200.0)
    assert follower.to(2000.0).position == near(18.75)


@pytest.mark.parametrize("meeting", [1999.0, 1200.0, -5.0])
def test_a_value_less_than_a_cycle_ahead_sends_the_slave_to_its_park(meeting: float) -> None:
    follower = parked(**VARIABLE).to(1050.0).set({"sync_master": meeting}).to(1600.0)
    assert (follower.state, follower.position, follower.missing) == (State.M_HOMING, near(200.0), (0.0, 0.0, 0.0))
    assert (follower.to(5000.0).state, follower["cycle"]) == (State.M_WAITING, 1)


def test_a_value_just_a_cycle_ahead_is_in_time_whatever_its_last_digit() -> None:
    follower = parked(**{**VARIABLE, "sync_master": 1000.1}).to(1050.0).set({"sync_master": 0.1 + 2000.0}).to(2100.0)
    assert follower.position == near(199.9)


@pytest.mark.parametrize(("meeting", "used"), [(2100.0, True), (2000.0, True), (1990.0, False), (1500.0, False)])
def test_a_value_set_on_the_way_home_is_used_at_the_park_if_it_is_not_too_late(meeting: float, used: bool) -> None:
    follower = parked(**VARIABLE).to(1300.0).set({"sync_master": meeting}).to(1799.0)
    assert (follower.state, follower["master_to_sync"]) == (State.M_HOMING, near(max(meeting - 1799.0, 0.0)))
    if used:
        assert follower.to(meeting + 50.0).position == near(150.0)
    else:
        assert (follower.to(1801.0).state, follower["local.drop_reason"]) == (State.M_WAITING, DropReason.TOO_SOON)
        assert (follower.to(5000.0).state, follower["cycle"]) == (State.M_WAITING, 1)


def test_a_value_at_the_park() -> None:
    follower = parked(**VARIABLE).to(3000.0).set({"sync_master": 3100.0}).run(0.01)
    assert follower.state == State.M_WAITING_NEXT_CYCLE  # 2900 is behind
    follower.set({"sync_master": 3300.0}).run(0.01)
    assert (follower.state, follower["master_to_start"]) == (State.M_WAITING_NEXT_CYCLE, near(98.0))
    assert follower.to(3200.0).position == near(18.75)


def test_the_value_at_the_initialization_counts_as_the_first() -> None:
    assert parked(**{**VARIABLE, "sync_master": 5000.0}).missing == near(4800.0, 5000.0, 5200.0, tolerance=1e-3)
    assert parked(**{**VARIABLE, "sync_master": 100.0}).state == State.M_WAITING_NEXT_CYCLE


def test_a_value_whose_start_is_skipped_is_used_up() -> None:
    follower = parked(**VARIABLE).set({"sync_assumed": True}).to(810.0)
    assert (follower.state, follower.missing) == (State.M_WAITING_NEXT_CYCLE, (0.0, 0.0, 0.0))
    follower.set({"sync_assumed": False}).to(3000.0)
    assert (follower.state, follower.position) == (State.M_WAITING, 0.0)


def test_a_value_that_does_not_change_is_none() -> None:
    follower = parked(**VARIABLE).to(1300.0).set({"sync_master": 1000.0}).to(9000.0)
    assert (follower.state, follower["cycle"]) == (State.M_WAITING, 1)


def test_with_a_period_a_value_is_its_first_occurrence_ahead() -> None:
    follower = parked(**VARIABLE, master__period=5000.0).to(1100.0).set({"sync_master": 900.0}).to(1250.0)
    assert follower["master_to_sync"] == near(4650.0)  # 5900
    assert follower.to(5950.0, 20).position == near(150.0)
    follower.set({"sync_master": 2000.0}).to(7050.0, 3)
    assert follower.position == near(150.0)


def test_in_a_variable_cycle_too_the_meetings_of_a_passing_slave_are_joined() -> None:
    follower = parked(**PASSING, **VARIABLE).to(900.0).set({"sync_master": 2000.0}).to(1300.0)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(381.25))
    assert follower.to(2350.0).position == near(quintic(250.0, 300.0, 1.0, 400.0, 0.0, 150.0))  # none: to the park
