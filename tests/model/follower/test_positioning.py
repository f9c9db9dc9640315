"""The positionings: to the park, and to where the undisturbed cycle has the slave."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.follower.faults import Fault
from motionsync.follower.interface import State
from tests.model.follower.harness import CYCLIC, PASSING, VARIABLE, FollowerHarness, near, parked, quintic
from tests.support.blocks.drawn import drawn


def test_the_move_to_the_park_is_time_optimal() -> None:
    """From 500: v 500, a 5000, j 50000: ramps of 0.2 s and 50 each, 400 at 500: 1.2 s."""
    follower = FollowerHarness({"slave.initial_position": 500.0}).give("position_to_park").run(0.1)
    assert follower.state == State.M_POSITIONING
    assert follower.slave == near(500.0 - 50000.0 * 0.001 / 6.0, -250.0, -5000.0)
    assert follower.run(0.5).slave == near(250.0, -500.0, 0.0)
    assert follower.run(0.599).state == State.M_POSITIONING
    assert (follower.run(0.002).state, follower.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))


def test_what_the_master_does_during_the_move_to_the_park_does_not_matter() -> None:
    """The move ends after 1.2 s, when the master is at 120."""
    follower = FollowerHarness({"slave.initial_position": 500.0}, speed=100.0).give("position_to_park").run(9.0)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(18.75))
    follower = (
        FollowerHarness({"slave.initial_position": 500.0}, speed=-100.0, master_position=700.0)
        .give("position_to_park")
        .run(1.0)
    )
    follower.speed = 100.0
    follower.run(0.1).run(0.1)
    assert (follower.state, follower.fault, follower["master_to_start"]) == (State.M_WAITING, Fault.NONE, near(180.0))


@pytest.mark.parametrize(("initial", "first"), [(390.0, 1.0), (10.0, -1.0), (-30.0, 1.0), (599.0, -1.0), (601.0, 1.0)])
def test_a_cyclic_slave_goes_to_the_nearest_turn_of_its_park(initial: float, first: float) -> None:
    follower = FollowerHarness({**CYCLIC, "slave.initial_position": initial}).give("position_to_park").run(0.02)
    assert math.copysign(1.0, follower.slave[1]) == first
    assert (follower.run(5.0).state, follower.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))


def test_a_slave_that_is_in_position_is_positioned_at_once_and_needs_no_limits() -> None:
    limits = {f"positioning.{name}": 0.0 for name in ("velocity", "acceleration", "jerk")}
    follower = FollowerHarness(limits, speed=100.0).give("position_to_park").to(900.0)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(18.75))
    follower = FollowerHarness({**limits, "slave.initial_position": 1.0}).give("position_to_park").run(1.0)
    assert (follower.state, follower.fault, follower.position) == (State.M_IDLE, Fault.POSITIONING, 1.0)


def test_a_positioning_is_refused_while_the_slave_moves() -> None:
    follower = parked().to(1100.0).give("position_to_park").to(1150.0)
    assert (follower.state, follower.fault, follower["error"]) == (State.M_SYNCHRONIZED, Fault.POSITIONING, True)
    assert follower.position == near(250.0)
    follower.give("reset").to(1160.0)
    assert (follower.state, follower.fault, follower["error"]) == (State.M_SYNCHRONIZED, Fault.NONE, False)


def test_the_next_accepted_command_clears_a_refusal() -> None:
    follower = parked().to(1050.0).give("position_to_cycle").run(0.01)
    assert follower.fault == Fault.POSITIONING
    assert follower.give("end_synchronism").run(0.01).fault == Fault.NONE


def test_where_the_master_is_at_rest_the_slave_can_be_positioned_to_its_park_in_the_middle_of_a_cycle() -> None:
    follower = parked().to(1100.0)
    follower.speed = 0.0
    follower.run(0.1).give("position_to_park").run(3.0)
    assert (follower.state, follower.position, follower["master_to_sync"]) == (State.M_WAITING, 0.0, near(900.0))


@pytest.mark.parametrize(
    ("master_position", "values", "state", "position"),
    [
        (500.0, {}, State.M_HOMING, 400.0 * (1.0 - quintic(400.0, 0.0, 0.0, 1.0, 0.0, 100.0))),
        (500.0, {"space_wait_in_park": 300.0, "master_cycle": 2000.0, "sync_master": 2000.0}, State.M_HOMING, None),
        (1700.0, {"space_wait_in_park": 300.0}, State.M_WAITING, 0.0),
        (900.0, {}, State.M_FOLLOWING, 18.75),
        (1100.0, {}, State.M_SYNCHRONIZED, 200.0),
        (1300.0, {}, State.M_DECEL, 381.25),
        (1100.0, {"align_center": True}, State.M_DECEL, 300.0),
        (-700.0, {}, State.M_DECEL, 381.25),
        (1325.0, CYCLIC, State.M_HOMING, 389.0625),
        (1500.0, CYCLIC, State.M_WAITING, 0.0),
        (925.0, {**CYCLIC, "master_cycle": 500.0}, State.M_FOLLOWING, 26.5625),  # the undisturbed cycle's way
        (775.0, {**PASSING, "master_cycle": 500.0}, State.M_FOLLOWING, quintic(300.0, 300.0, 1.0, 500.0, 1.0, 75.0)),
        (2000.0, {**PASSING, "master_cycle": 1500.0}, State.M_FOLLOWING, 0.0),
        (2900.0, {**PASSING, "master_cycle": 1500.0}, State.M_FOLLOWING, 18.75),
        (700.0, VARIABLE, State.M_WAITING, 0.0),
        (900.0, VARIABLE, State.M_FOLLOWING, 18.75),
        (1600.0, VARIABLE, State.M_HOMING, 200.0),
        (1900.0, VARIABLE, State.M_WAITING, 0.0),
        (1325.0, {**PASSING, **VARIABLE}, State.M_HOMING, 389.0625),
    ],
)
def test_a_positioning_to_the_cycle_leads_to_where_the_cycle_has_the_slave(
    master_position: float, values: dict[str, Any], state: State, position: float | None
) -> None:
    follower = (
        FollowerHarness({**values, "slave.initial_position": 20.0}, master_position=master_position)
        .give("position_to_cycle")
        .run(0.01)
    )
    assert follower.state == State.M_POSITIONING
    follower.run(3.0)
    assert follower.state == state
    if position is not None:
        assert follower.slave == near(position, 0.0, 0.0)
    if values in ({}, CYCLIC):  # then it goes on as one that has never done anything else
        follower.speed = 100.0
        other = parked(master_position=master_position - 2000.0, **values).to(master_position + 333.0, 100)
        assert follower.to(master_position + 333.0).slave == near(*other.slave, tolerance=1e-8)


def test_in_a_variable_cycle_without_a_value_there_is_no_cycle_to_be_positioned_to() -> None:
    follower = parked(**VARIABLE).to(3000.0)
    follower.speed = 0.0
    follower.give("position_to_cycle").run(1.0)
    assert (follower.state, follower.fault) == (State.M_WAITING, Fault.POSITIONING)


def test_the_master_must_not_move_during_the_positioning_to_the_cycle() -> None:
    """1e-6 is passed after 0.1 s at 1e-5; the slave has then 250 and slows down with 5000."""
    follower = (
        FollowerHarness({"slave.initial_position": 20.0}, master_position=1600.0, speed=1e-5)
        .give("position_to_cycle")
        .run(0.0999)
    )
    assert follower.state == State.M_POSITIONING
    follower.run(0.0011)
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.MASTER_MOVED)
    assert follower.slave[1] == near(250.0 - 5.0, tolerance=1e-5)
    assert follower.slave[2] == -5000.0


def test_the_master_may_move_a_little() -> None:
    follower = (
        FollowerHarness({"slave.initial_position": 20.0}, master_position=1600.0, speed=1e-7)
        .give("position_to_cycle")
        .run(3.0)
    )
    assert (follower.state, follower.position) == (State.M_HOMING, near(200.0, tolerance=1e-6))


@drawn(60)
@given(
    st.booleans(),
    st.sampled_from(["speed", "acceleration"]),
    st.booleans(),
    st.floats(0.3, 0.95) | st.floats(1.05, 3.0),
    st.floats(-500.0, -10.0),
    st.sampled_from([0.003, 0.02]),
)
def test_limits_are_checked_in_a_positioning(
    to_cycle: bool, kind: str, is_checked: bool, share: float, begin: float, h: float
) -> None:
    """The move has full velocity (100) and acceleration (1000) on its way, for 10 and more; the limit is this share of
    them. What exceeds it is put out in M_IN_ALARM; what does not leads to the target."""
    limit = share * {"speed": 100.0, "acceleration": 1000.0}[kind]
    follower = FollowerHarness(
        {
            "slave.initial_position": begin - 15.0,
            "positioning.velocity": 100.0,
            "positioning.acceleration": 1000.0,
            "positioning.jerk": 1e5,
            f"max_{kind}": limit,
            f"check_{kind}": is_checked,
        },
        master_position=900.0,
    ).give("position_to_cycle" if to_cycle else "position_to_park")
    number = {"speed": 1, "acceleration": 2}[kind]
    for _ in range(int(8.0 / h)):
        follower.run(h)
        size = abs(follower.slave[number])
        if follower.state == State.M_IN_ALARM:
            assert is_checked
            assert size > limit
            assert follower.fault == {"speed": 15, "acceleration": 16}[kind]
            assert follower.run(5.0).slave[1:] == (0.0, 0.0)
            return
        assert not is_checked or size <= limit * (1.0 + 1e-9)
    assert share > 1.0 or not is_checked
    assert follower.position == near(18.75 if to_cycle else 0.0)
