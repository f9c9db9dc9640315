"""The cycle of a cyclic slave, which parks or passes its park, with numbers by hand."""

import pytest

from motionsync.follower.interface import State
from tests.model.follower.harness import CYCLIC, PASSING, near, parked, quintic


@pytest.mark.parametrize(
    ("cycle", "master_position", "state", "position"),
    [
        (1000.0, 900.0, State.M_FOLLOWING, 18.75),
        (1000.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (1000.0, 1325.0, State.M_HOMING, 389.0625),  # over 2.5 * 100, though 600 are left
        (1000.0, 1451.0, State.M_WAITING, 0.0),
        (1000.0, 1900.0, State.M_FOLLOWING, 18.75),
        (600.0, 575.0, State.M_FOLLOWING, 200.0 * (0.875**3 - 0.5 * 0.875**4)),
        (600.0, 900.0, State.M_HOMING, quintic(200.0, 300.0, 1.0, 400.0, 0.0, 100.0)),  # R = 400: just 2 (L + S_h)
        (600.0, 1000.0, State.M_FOLLOWING, 0.0),
        (500.0, 400.0, State.M_FOLLOWING, 18.75),  # the first one from the park: always 200
        (500.0, 775.0, State.M_HOMING, quintic(150.0, 300.0, 1.0, 400.0, 0.0, 75.0)),  # R = 300: 150 each
        (500.0, 925.0, State.M_FOLLOWING, 26.5625),
        (500.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (300.0, 175.0, State.M_FOLLOWING, 200.0 * (0.375**3 - 0.5 * 0.375**4)),
        (300.0, 525.0, State.M_HOMING, quintic(50.0, 300.0, 1.0, 400.0, 0.0, 25.0)),
        (300.0, 575.0, State.M_FOLLOWING, quintic(50.0, 0.0, 0.0, 100.0, 1.0, 25.0)),
    ],
)
def test_a_cyclic_slave_that_rests_at_its_park(
    cycle: float, master_position: float, state: State, position: float
) -> None:
    follower = parked(**CYCLIC, master_cycle=cycle).to(master_position)
    assert (follower.state, follower.position) == (state, near(position))


def test_the_wait_counts_in_what_is_left_of_the_cycle() -> None:
    """R = 1000 - 200 - 550 = 250: 125 each; home at 1325, rest up to 1875."""
    follower = parked(**CYCLIC, space_wait_in_park=550.0).to(1262.5)
    assert follower.position == near(quintic(125.0, 300.0, 1.0, 400.0, 0.0, 62.5))
    assert (follower.to(1326.0).state, follower.position) == (State.M_WAITING, 0.0)
    assert (follower.to(1874.0).state, follower.position) == (State.M_WAITING, 0.0)
    assert follower.to(1937.5).position == near(quintic(125.0, 0.0, 0.0, 100.0, 1.0, 62.5))


def test_a_meeting_that_moves_between_two_cycles_is_met_by_a_cyclic_slave_too() -> None:
    """R = 280 instead of 300: 140 each."""
    follower = parked(**CYCLIC, master_cycle=500.0).to(650.0).set({"sync_master": -20.0}).to(770.0)
    assert follower.position == near(quintic(140.0, 300.0, 1.0, 400.0, 0.0, 70.0))
    assert follower.to(910.0).position == near(quintic(140.0, 0.0, 0.0, 100.0, 1.0, 70.0))
    assert follower.to(1080.0).position == near(200.0)


@pytest.mark.parametrize(
    ("cycle", "master_position", "state", "position"),
    [
        (500.0, 850.0, State.M_FOLLOWING, 0.0),  # M = 300 < 2 S = 400
        (500.0, 775.0, State.M_FOLLOWING, quintic(300.0, 300.0, 1.0, 500.0, 1.0, 75.0)),
        (500.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (1500.0, 1800.0, State.M_FOLLOWING, 381.25),  # M = 1300: down over 100, rest, up over 100
        (1500.0, 1900.0, State.M_FOLLOWING, 0.0),
        (1500.0, 2800.0, State.M_FOLLOWING, 0.0),
        (1500.0, 2900.0, State.M_FOLLOWING, 18.75),
        (1500.0, 3100.0, State.M_SYNCHRONIZED, 200.0),
        (600.0, 900.0, State.M_FOLLOWING, 381.25),  # M = 400, just 2 S
        (600.0, 1100.0, State.M_FOLLOWING, 18.75),
    ],
)
def test_a_cyclic_slave_that_does_not_rest_at_its_park(
    cycle: float, master_position: float, state: State, position: float
) -> None:
    follower = parked(**PASSING, master_cycle=cycle).to(master_position)
    assert (follower.state, follower.position) == (state, near(position))


def test_the_intermediate_stop_may_be_elsewhere_than_the_park() -> None:
    follower = parked(**PASSING, park_slave=-20.0, master_cycle=1500.0).to(2200.0)
    assert (follower.state, follower.slave) == (State.M_FOLLOWING, (near(0.0), 0.0, 0.0))


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_slave_that_passes_its_park_stops_there_if_the_level_is_set_at_the_end_of_the_phase(name: str) -> None:
    follower = parked(**PASSING).to(1199.0).set({name: True}).to(1325.0)
    assert (follower.state, follower.position) == (State.M_HOMING, near(389.0625))
    assert (follower.set({name: False}).to(1790.0).state, follower.position) == (State.M_WAITING, 0.0)
    assert follower.to(1900.0).position == near(18.75)  # read again at the start
    follower.set({name: True}).to(2810.0)
    assert follower.state == State.M_WAITING_NEXT_CYCLE


def test_ending_the_synchronism_of_a_cyclic_slave() -> None:
    """At 200: S_h = 200, R = 900, home over 2.5 * 200."""
    follower = parked(**CYCLIC).to(1100.0).give("end_synchronism").to(1350.0)
    assert (follower.state, follower.position) == (State.M_HOMING, near(quintic(500.0, 200.0, 1.0, 400.0, 0.0, 250.0)))


def test_the_position_of_a_cyclic_slave_lies_in_its_cycle() -> None:
    follower = parked(**CYCLIC, master_cycle=500.0, park_slave=-30.0, slave__initial_position=-30.0)
    assert follower.position == 370.0
    positions = [follower.to(follower.master_position + 7.3).position for _ in range(300)]
    assert all(0.0 <= position < 400.0 for position in positions)
