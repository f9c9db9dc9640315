"""The cycle of a linear slave, sentence by sentence with numbers by hand; the harness says which machine it is."""

import pytest

from motionsync.follower.interface import State
from motionsync.master import MasterInput
from tests.model.follower.harness import END, START, FollowerHarness, near, parked


def test_without_a_positioning_nothing_moves() -> None:
    follower = FollowerHarness({"slave.initial_position": 7.0}, speed=100.0)
    assert (follower.state, follower["state_code"], follower.slave) == (State.M_IDLE, 1, (7.0, 0.0, 0.0))
    follower.to(5000.0)
    assert (follower.state, follower.slave, follower["cycle"]) == (State.M_IDLE, (7.0, 0.0, 0.0), 0)


@pytest.mark.parametrize("steps", [1, 7, 1000])
@pytest.mark.parametrize(
    ("master_position", "state", "position", "d1", "d2"),
    [
        (799.0, State.M_WAITING, 0.0, 0.0, 0.0),
        (900.0, State.M_FOLLOWING, 18.75, 0.5, 0.0075),  # 200 q(1/2), q = 3/32, q' = 1/2, q'' = 3/2
        (1000.0, State.M_SYNCHRONIZED, 100.0, 1.0, 0.0),
        (1100.0, State.M_SYNCHRONIZED, 200.0, 1.0, 0.0),
        (1200.0, State.M_DECEL, 300.0, 1.0, 0.0),
        (1300.0, State.M_DECEL, 381.25, 0.5, -0.0075),  # 300 + 200 (1/2 - 3/32)
        (1400.0, State.M_HOMING, 400.0, 0.0, 0.0),
        (1500.0, State.M_HOMING, 400.0 * (1.0 - 53.0 / 512.0), -135.0 / 128.0, -9.0 / 640.0),  # u = 1/4
        (1600.0, State.M_HOMING, 200.0, -1.875, 0.0),
        (1900.0, State.M_FOLLOWING, 18.75, 0.5, 0.0075),
        (10600.0, State.M_HOMING, 200.0, -1.875, 0.0),
    ],
)
def test_the_cycle_of_a_linear_slave(
    master_position: float, state: State, position: float, d1: float, d2: float, steps: int
) -> None:
    follower = parked().to(master_position, steps)
    assert follower.state == state
    assert follower.slave == near(position, 100.0 * d1, 1e4 * d2, tolerance=1e-8)
    assert follower["cycle"] == max(0, int((master_position - 200.0) // 1000.0))


@pytest.mark.parametrize("mode", [START, END])
def test_velocity_and_acceleration_follow_the_chain_rule(mode: MasterInput) -> None:
    """u = 1/2: s' = 1/2, s'' = 3/2/200, s''' = 0; then 3 s'' v a is the jerk."""
    follower = parked(mode=mode).to(800.0).run(1.0, acceleration=-20.0, cuts=[0.3]).run(10.0 / 80.0)
    assert follower.master_position == near(900.0)
    follower.run(2.0**-30, acceleration=-20.0)
    assert follower.slave == near(18.75, 40.0, 0.5 * -20.0 + 0.0075 * 6400.0, tolerance=1e-6)
    assert follower["slave.jerk"] == near(3.0 * 0.0075 * 80.0 * -20.0, tolerance=1e-6)


def test_the_ratio_scales_the_master_travels() -> None:
    """k = 1/2: M_f = 400, synchronized 400, M_d = 400."""
    follower = parked(k_slave_master=0.5, master_cycle=2000.0, sync_master=1000.0)
    assert follower.missing == near(600.0, 1000.0, 1400.0, tolerance=1e-3)
    assert follower.to(800.0).slave == near(18.75, 25.0, 0.5 * 0.0075 * 1e4 * 0.5)
    assert follower.to(1200.0).slave == near(200.0, 50.0, 0.0)
    assert follower.to(1600.0).slave == near(381.25, 25.0, -0.5 * 0.0075 * 1e4 * 0.5)


def test_the_first_meeting_may_be_a_negative_number_of_cycles_away() -> None:
    follower = parked(master_position=-5000.0, sync_master=30.0)
    assert follower.missing == near(830.0, 1030.0, 1230.0, tolerance=1e-3)
    follower.to(-4970.0 + 900.0)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(18.75))


def test_the_wait_in_the_park_shortens_the_way_home() -> None:
    follower = parked(space_wait_in_park=100.0).to(1550.0)  # 1400 to 1700
    assert follower.slave == near(200.0, -400.0 / 300.0 * 1.875 * 100.0, 0.0)
    assert (follower.to(1700.0).state, follower.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))
    assert follower.to(1800.0).state == State.M_FOLLOWING


def test_the_master_may_stand_anywhere() -> None:
    follower = parked().to(900.0).run(1.0, acceleration=-100.0)
    assert follower.master_position == 950.0
    slave = follower.slave
    assert slave[1] == 0.0
    follower.run(100.0)
    assert follower.slave == (slave[0], 0.0, 0.0)
    follower.run(1.0, acceleration=100.0)
    assert follower.state == State.M_SYNCHRONIZED
    assert follower.slave == near(100.0, 100.0, 100.0)


@pytest.mark.parametrize("at_center", [False, True])
def test_the_middle_of_the_synchronized_phase_can_be_aligned(at_center: bool) -> None:
    follower = parked(align_center=at_center, k_slave_master=0.8, master_cycle=2000.0)
    meeting = 2000.0 - (125.0 if at_center else 0.0)
    assert follower.to(100.0)["master_to_sync"] == near(meeting - 100.0)
    assert follower.to(2000.0).position == near(200.0 if at_center else 100.0)


def test_where_the_current_meeting_and_after_it_the_next_one_is() -> None:
    follower = parked(space_wait_in_park=100.0)
    assert follower.to(300.0).missing == near(500.0, 700.0, 900.0)
    assert follower.to(900.0).missing == near(0.0, 100.0, 300.0)
    assert follower.to(1100.0).missing == near(0.0, 0.0, 100.0)
    assert follower.to(1300.0).missing == near(500.0, 700.0, 900.0)
    assert follower.to(1500.0).missing == near(300.0, 500.0, 700.0)
    assert follower.to(1750.0).missing == near(50.0, 250.0, 450.0)


def test_the_locals_show_where_the_meeting_is_and_how_far_the_phase_has_come() -> None:
    follower = parked(master__period=300.0).to(850.0)
    names = ("meeting_known", "meeting_position", "start_position", "following_travel", "progress")
    assert [follower[f"local.{name}"] for name in names] == near(1.0, 100.0, 200.0, 200.0, 0.25)
    assert follower.to(1600.0)["local.progress"] == near(0.5)
