"""The commands within a cycle: skipped starts, a synchronism ended early, a slave that is held at its stroke's end."""

import pytest

from motionsync.follower.interface import State
from tests.model.follower.harness import VARIABLE, near, parked


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_start_is_not_carried_out_while_a_level_is_set(name: str) -> None:
    follower = parked(space_wait_in_park=100.0).to(790.0).set({name: True}).to(801.0).set({name: False})
    assert (follower.state, follower["cycle"], follower.missing) == (
        State.M_WAITING_NEXT_CYCLE,
        0,
        near(999.0, 1199.0, 1399.0),
    )
    assert follower.to(1699.0).state == State.M_WAITING_NEXT_CYCLE
    assert follower.to(1701.0).state == State.M_WAITING
    assert follower.to(1900.0).slave == near(18.75, 50.0, 75.0)


@pytest.mark.parametrize("turns_at", [1650.0, 1750.0])  # while the next cycle is awaited, or after that
def test_a_skipped_cycle_stays_skipped_if_the_master_comes_back(turns_at: float) -> None:
    """The start at 800 is skipped; the next is at 1800, and it is waited for from 1700 on."""
    follower = parked(space_wait_in_park=100.0).to(790.0).set({"skip_next_cycle": True}).to(810.0)
    follower.set({"skip_next_cycle": False}).to(turns_at)
    follower.speed = -100.0
    follower.to(650.0)
    follower.speed = 100.0
    assert follower.to(900.0).missing == near(900.0, 1100.0, 1300.0)
    assert follower.to(1900.0).position == near(18.75)


@pytest.mark.parametrize("change", [-300.0, 300.0])
def test_a_meeting_that_moves_by_less_than_half_a_cycle_after_the_skip_is_skipped_too(change: float) -> None:
    """The start at 800 to the meeting at 1000 is skipped. The next meeting is a cycle after where it is now."""
    follower = parked().to(790.0).set({"skip_next_cycle": True}).to(810.0)
    follower.set({"skip_next_cycle": False, "sync_master": 1000.0 + change}).to(820.0)
    assert (follower.state, follower.missing) == (
        State.M_WAITING_NEXT_CYCLE,
        near(980.0 + change, 1180.0 + change, 1380.0 + change),
    )


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_level_set_after_the_start_does_not_matter_to_this_cycle(name: str) -> None:
    follower = parked().to(801.0).set({name: True}).to(1100.0)
    assert (follower.state, follower.position) == (State.M_SYNCHRONIZED, near(200.0))
    assert follower.to(1790.0).state == State.M_HOMING
    assert follower.to(1810.0).state == State.M_WAITING_NEXT_CYCLE
    assert follower.to(4790.0, 3).position == 0.0
    assert follower.set({name: False}).to(4900.0).position == near(18.75)


@pytest.mark.parametrize("steps", [1, 10])
def test_ending_the_synchronism_puts_the_end_where_the_slave_is(steps: int) -> None:
    follower = parked().to(1100.0).give("end_synchronism").to(1200.0, steps)
    assert (follower.state, follower["cycle"]) == (State.M_DECEL, 1)
    assert follower.slave == near(281.25, 50.0, -75.0)  # from 200 over 100
    assert follower.to(1300.0).slave == near(300.0, 0.0, 0.0)
    assert follower.to(1550.0).position == near(150.0)  # home from 1300 to 1800
    assert follower.to(2150.0).position == near(250.0)  # this cycle only


def test_ending_the_synchronism_elsewhere_is_lost() -> None:
    follower = parked().to(900.0).give("end_synchronism").to(1100.0)
    assert follower.state == State.M_SYNCHRONIZED
    assert follower.to(1250.0).give("end_synchronism").to(1300.0).position == near(381.25)


def test_the_slave_is_held_at_the_end_of_its_stroke_until_a_full_travel_home_is_left() -> None:
    """Undisturbed 400. Released at 1500: 1800 is too near, so home from 1500 to 2800."""
    follower = parked().set({"stop_after_forward": True}).to(1500.0)
    assert (follower.state, follower.slave) == (State.M_DECEL, (near(400.0), 0.0, 0.0))
    follower.set({"stop_after_forward": False}).to(2150.0)
    assert (follower.state, follower.position, follower["master_to_sync"]) == (State.M_HOMING, near(200.0), near(850.0))
    assert follower.to(2900.0).position == near(18.75)


def test_released_just_at_the_end_of_the_stroke_nothing_is_lost() -> None:
    follower = parked().set({"stop_after_forward": True}).to(1400.0).set({"stop_after_forward": False}).to(1600.0)
    assert (follower.position, follower["master_to_sync"]) == (near(200.0), near(400.0))


def test_held_for_several_cycles() -> None:
    follower = parked(space_wait_in_park=100.0).set({"stop_after_forward": True}).to(5350.0)
    follower.set({"stop_after_forward": False}).to(5525.0)  # undisturbed 300: 5350 to 5700
    assert follower.position == near(200.0)


def test_a_hold_that_is_gone_when_the_stroke_ends_does_not_matter() -> None:
    follower = parked().set({"stop_after_forward": True}).to(1390.0).set({"stop_after_forward": False}).to(1410.0)
    assert follower.state == State.M_HOMING
    assert follower.set({"stop_after_forward": True}).to(1600.0).position == near(200.0)


def test_in_a_variable_cycle_the_slave_goes_home_over_the_undisturbed_travel() -> None:
    follower = parked(**VARIABLE).set({"stop_after_forward": True}).to(1510.0)
    follower.set({"stop_after_forward": False}).to(1710.0)
    assert (follower.state, follower.position) == (State.M_HOMING, near(200.0))
    assert follower.to(1911.0).state == State.M_WAITING
