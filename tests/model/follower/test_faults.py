"""What is refused, what leads to an alarm and which one, how the slave stops, and how it goes on."""

import math
from typing import Any

import pytest

from motionsync.follower.block import Follower
from motionsync.follower.faults import Fault, Refusal
from motionsync.follower.interface import State
from motionsync.master import MasterInput
from tests.model.follower.harness import CYCLIC, END, ONLY, START, VARIABLE, FollowerHarness, near, parked, stopping


def refused(**values: Any) -> Refusal:
    """What `initialize` answers."""
    block = Follower()
    for name, value in values.items():
        setattr(block, name, value)
    return block.initialize()


@pytest.mark.parametrize(
    ("values", "refusal"),
    [
        ({}, Refusal.NONE),
        ({"sync_slave": 0.0}, Refusal.ORDER),
        ({"sync_out": 100.0}, Refusal.ORDER),
        ({"slave_cycle": 300.0}, Refusal.ORDER),
        ({"slave_cycle": 300.1}, Refusal.NONE),
        ({"master_cycle": 600.0}, Refusal.CYCLE_TOO_SHORT_LINEAR),  # 200 + 200 + 200
        ({"master_cycle": 600.1}, Refusal.NONE),
        ({"master_cycle": 1000.0, "space_wait_in_park": 400.0}, Refusal.CYCLE_TOO_SHORT_LINEAR),
        ({"master_cycle": 200.0, "slave_cycle": 400.0}, Refusal.CYCLE_TOO_SHORT_CYCLIC),
        ({"master_cycle": 200.1, "slave_cycle": 400.0}, Refusal.NONE),
        ({"master_cycle": 300.0, "slave_cycle": 400.0, "space_wait_in_park": 100.0}, Refusal.CYCLE_TOO_SHORT_CYCLIC),
    ],
)
def test_parameters_that_are_out_of_order_or_leave_no_travel_are_refused(values: Any, refusal: Refusal) -> None:
    assert refused(**values) == refusal


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"sync_slave": math.nan}, Fault.ORDER),
        ({"k_slave_master": 0.0}, Fault.RATIO),
        ({"k_slave_master": -1.0}, Fault.RATIO),
        ({"master_cycle": 0.0}, Fault.CYCLE_TOO_SHORT),
    ],
)
def test_at_the_park_they_are_checked_as_soon_as_no_start_can_be_computed(
    changed: dict[str, Any], fault: Fault
) -> None:
    follower = parked().to(100.0).set(changed).run(0.01)
    assert (follower.state, follower.fault, follower.slave) == (State.M_IN_ALARM, fault, (0.0, 0.0, 0.0))


def test_a_start_that_is_not_carried_out_is_not_checked() -> None:
    follower = parked().to(790.0).set({"sync_out": 90.0, "skip_next_cycle": True}).to(810.0)
    assert follower.state == State.M_WAITING_NEXT_CYCLE
    assert follower.set({"sync_out": 300.0, "skip_next_cycle": False}).to(1900.0).position == near(18.75)


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"sync_out": 90.0}, Fault.ORDER),
        ({"space_wait_in_park": -1.0}, Fault.ORDER),
        ({"space_stop_slave": 0.0}, Fault.ORDER),
        ({"master_cycle": 500.0}, Fault.CYCLE_TOO_SHORT),  # the meeting stays at 1000
        ({"space_wait_in_park": 500.0}, Fault.CYCLE_TOO_SHORT),
    ],
)
def test_later_they_are_checked_when_a_cycle_starts(changed: dict[str, Any], fault: Fault) -> None:
    follower = parked().to(400.0).set(changed).to(799.0)
    assert (follower.state, follower.fault) == (State.M_WAITING, Fault.NONE)
    follower.to(810.0)
    assert (follower.state, follower["state_code"], follower.fault, follower["error"]) == (
        State.M_IN_ALARM,
        -1,
        fault,
        True,
    )
    assert follower.slave == (0.0, 0.0, 0.0)


def test_the_way_home_is_checked_where_it_is_read() -> None:
    """The slave runs with 100 at 1200; it stops over 1 of it with 5000."""
    follower = parked().to(1100.0).set({"master_cycle": 500.0}).run(1.0 + 0.01)
    assert (follower.state, follower.fault, follower["cycle"]) == (State.M_IN_ALARM, Fault.CYCLE_TOO_SHORT, 1)
    assert follower.slave == near(300.0 + 1.0 - 0.25, 50.0, -5000.0)
    assert follower.run(1.0).slave == near(301.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("master_position", "speed", "acceleration"),
    [
        (900.0, Fault.SPEED_FOLLOWING, Fault.ACCELERATION_FOLLOWING),
        (1100.0, Fault.SPEED_SYNCHRONIZED, Fault.ACCELERATION_SYNCHRONIZED),
        (1300.0, Fault.SPEED_DECEL, Fault.ACCELERATION_DECEL),
        (1500.0, Fault.SPEED_HOMING, Fault.ACCELERATION_HOMING),
    ],
)
def test_limits_are_checked_in_each_phase(master_position: float, speed: Fault, acceleration: Fault) -> None:
    for fault, name in ((speed, "speed"), (acceleration, "acceleration")):
        follower = stopping(master_position, max_speed=1.0, max_acceleration=1.0).set({f"check_{name}": True})
        follower.run(0.01, acceleration=2.0)
        assert (follower.state, follower.fault) == (State.M_IN_ALARM, fault)
        assert (
            stopping(master_position, max_speed=1.0, max_acceleration=1.0).run(0.01, acceleration=2.0).fault
            == Fault.NONE
        )


def test_a_limit_that_is_just_reached_or_0_is_no_fault() -> None:
    assert parked(max_speed=100.0).to(1300.0, 500).fault == Fault.NONE
    assert parked(max_speed=99.99).to(1300.0, 500).fault in (Fault.SPEED_FOLLOWING, Fault.SPEED_SYNCHRONIZED)
    assert parked(max_acceleration=75.0).to(1300.0, 500).fault == Fault.NONE  # s'' = 0.0075 at most
    assert parked(max_acceleration=74.9).to(1300.0, 500).fault == Fault.ACCELERATION_FOLLOWING


def test_what_exceeds_a_limit_is_still_put_out_then_a_linear_ramp_stops_the_slave() -> None:
    follower = stopping(1100.0, max_speed=50.0, max_acceleration=200.0).set({"check_speed": True}).run(0.01)
    assert (follower.state, follower.slave) == (State.M_IN_ALARM, near(200.0, 100.0, 0.0))
    assert follower.run(0.25).slave == near(200.0 + 25.0 - 6.25, 50.0, -200.0)
    assert follower["slave.jerk"] == 0.0
    assert follower.run(0.25).slave == near(225.0, 0.0, 0.0)
    assert follower.run(9.0).slave == near(225.0, 0.0, 0.0)


def test_without_any_deceleration_the_slave_stops_at_once() -> None:
    follower = stopping(1100.0, max_speed=50.0, positioning__acceleration=0.0).set({"check_speed": True}).run(0.01)
    assert follower.run(0.01).slave == near(200.0, 0.0, 0.0)


def test_a_reset_leads_out_of_the_alarm_at_standstill_only() -> None:
    follower = stopping(1100.0, max_speed=50.0, max_acceleration=200.0).set({"check_speed": True}).run(0.01)
    follower.give("reset").run(0.1)
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.SPEED_SYNCHRONIZED)
    follower.run(1.0).give("position_to_park").run(0.1)
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.SPEED_SYNCHRONIZED)
    follower.give("reset").run(0.1)
    assert (follower.state, follower.fault, follower["error"], follower.position) == (
        State.M_IDLE,
        Fault.NONE,
        False,
        near(225.0),
    )
    follower.run(10.0)
    assert follower.state == State.M_IDLE
    assert follower.give("position_to_park").run(3.0).state in (State.M_WAITING, State.M_FOLLOWING)


def test_the_slave_that_was_interrupted_can_be_positioned_to_the_cycle() -> None:
    follower = stopping(1100.0, max_speed=50.0).set({"check_speed": True}).run(0.01)
    follower.set({"check_speed": False})
    follower.speed = 0.0
    follower.run(1.0).give("reset").run(0.1).give("position_to_cycle").run(1.0)
    assert (follower.state, follower.position) == (State.M_SYNCHRONIZED, near(200.0))
    follower.speed = 100.0
    assert follower.to(1300.0).position == near(381.25)


@pytest.mark.parametrize(
    ("master_position", "alarm"), [(900.0, True), (1100.0, True), (1300.0, True), (1500.0, True), (700.0, False)]
)
def test_the_master_must_not_turn_back_in_a_cycle(master_position: float, alarm: bool) -> None:
    follower = parked().to(master_position)
    follower.speed = 0.0
    follower.run(0.1)
    before = follower.slave
    follower.master_position -= 0.9e-6
    assert follower.run(0.1).slave == before  # within 1e-9 of the cycle
    follower.master_position += 0.9e-6
    assert follower.run(0.1).fault == Fault.NONE
    follower.master_position -= 1.1e-6
    follower.run(0.1)
    assert follower.state == (State.M_IN_ALARM if alarm else State.M_WAITING)
    assert follower.fault == (Fault.MASTER_BACKWARDS if alarm else Fault.NONE)
    assert follower.slave == before


def test_a_master_that_turns_back_inside_a_step_stops_the_slave_where_it_turns() -> None:
    follower = parked().to(1050.0).run(1.0 + 0.1, acceleration=-100.0)
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.MASTER_BACKWARDS)
    assert follower.slave == near(200.0, 0.0, 0.0)


def test_back_and_forth_at_the_park_the_meeting_is_chosen_anew() -> None:
    follower = parked().to(700.0)
    follower.speed = -100.0
    assert follower.to(-700.0).missing == near(500.0, 700.0, 900.0)
    follower.speed = 100.0
    assert follower.to(-100.0).position == near(18.75)


@pytest.mark.parametrize("mode", [START, END, ONLY])
def test_a_step_over_too_many_cycles_is_refused(mode: MasterInput) -> None:
    follower = parked(**CYCLIC, mode=mode).to(100.0).to(200.0)
    before = [cell.get() for cell in follower.stepper.cells.values()]
    last = dict(follower.read(("master.position", "master.velocity")))
    follower.set({"master.position": 1.1e9, "master.velocity": 1.1e9})
    assert follower.block.step(1.0) == Refusal.CYCLES
    assert [cell.get() for cell in follower.set(last).stepper.cells.values()] == before
    assert follower.to(900.0).position == near(18.75)


def test_with_wrong_parameters_a_positioning_to_the_cycle_is_refused() -> None:
    follower = FollowerHarness().set({"k_slave_master": 0.0}).give("position_to_cycle").run(5.0)
    assert (follower.state, follower.fault) == (State.M_IDLE, Fault.POSITIONING)
    follower = (
        FollowerHarness({"slave.initial_position": 10.0}).set({"k_slave_master": 0.0}).give("position_to_park").run(5.0)
    )
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.RATIO)  # at the park


def test_a_variable_meeting_without_travel_is_dropped() -> None:
    """M_f = 2 * 350 with sync_slave 350: home would take up to 2000 - 700 from 1400, which is behind."""
    changed = {"sync_slave": 350.0, "sync_out": 360.0, "space_wait_in_park": 80.0, "sync_master": 2000.0}
    follower = parked(**VARIABLE).to(1100.0).set({**changed, "master_cycle": 1000.0}).to(1199.0)
    follower.set({"master_cycle": 995.0}).to(1250.0)
    assert (follower.state, follower.fault) == (State.M_IN_ALARM, Fault.CYCLE_TOO_SHORT)
    follower = parked(**VARIABLE, slave_cycle=600.0).to(1100.0).set({"sync_master": 2000.0}).to(1250.0)
    assert (follower.state, follower["master_to_sync"]) == (State.M_HOMING, near(750.0))


def test_the_value_of_an_interrupted_cycle_still_counts() -> None:
    follower = stopping(1100.0, max_speed=50.0, **VARIABLE).set({"check_speed": True}).run(0.01)
    follower.set({"check_speed": False})
    follower.speed = 0.0
    follower.run(1.0).give("reset").run(0.1).give("position_to_cycle").run(1.0)
    assert (follower.state, follower.position) == (State.M_SYNCHRONIZED, near(200.0))
    follower.speed = 100.0
    assert follower.set({"sync_master": 2300.0}).to(1750.0).position == near(200.0)
    assert follower.to(2200.0).position == near(18.75)


@pytest.mark.parametrize(
    ("place", "fault"),
    [
        (900.0, Fault.SPEED_FOLLOWING),
        (1100.0, Fault.SPEED_SYNCHRONIZED),
        (1300.0, Fault.SPEED_DECEL),
        (1500.0, Fault.SPEED_HOMING),
    ],
)
def test_a_step_that_exceeds_both_limits_has_the_fault_of_the_speed(place: float, fault: Fault) -> None:
    follower = stopping(place, max_speed=1.0, max_acceleration=1.0)
    follower.set({"check_speed": True, "check_acceleration": True}).run(0.01, acceleration=2.0)
    assert follower.fault == fault
