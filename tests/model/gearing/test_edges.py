"""The edges of start in each state of the Gearing: they act, wait, are taken back or are ignored."""

from typing import Any

import pytest

from motionsync.gearing.faults import Fault
from motionsync.gearing.interface import StartMode, StopMode
from tests.model.gearing.harness import (
    ACTIVE,
    CCW,
    CW,
    GEAR_IN,
    GEAR_OUT,
    INSTANT,
    NONE,
    STOPPED,
    TIME,
    WAITING_FOR_START,
    WAITING_FOR_STOP,
    GearingHarness,
    in_gear,
    near,
    ratio,
    waiting_for_reference,
)


def test_a_falling_edge_while_waiting_ends_it() -> None:
    gear = waiting_for_reference().run(1.0).stop().run(9.0)
    assert (gear.state, gear.slave) == (STOPPED, (7.0, 0.0, 0.0))


def test_a_falling_edge_in_gear_in_direct_without_transition_is_rest_at_once() -> None:
    gear = waiting_for_reference().to(50.0).stop(transition=NONE).run(1.0)
    assert gear.state == STOPPED
    assert gear.slave == near(7.0 + 30.0 * 3 / 32, 0.0, 0.0)


def test_a_falling_edge_in_gear_in_to_stop_in_time_acts_at_once() -> None:
    gear = waiting_for_reference().to(50.0)
    s, v, a = gear.slave
    gear.stop(transition=TIME, time=2.0).run(INSTANT)
    assert gear.state == GEAR_OUT
    assert gear.slave == near(s, v, a, tolerance=1e-6)
    assert gear.run(2.0).slave == near(s, 0.0, 0.0)
    aimed = waiting_for_reference().to(50.0)
    aimed.stop(transition=TIME, time=2.0, stop_mode=StopMode.WITH_CCW_STOP_POSITION, stop_position=-3.0).run(2.0)
    assert aimed.slave == near(-3.0, 0.0, 0.0)


def test_a_falling_edge_in_gear_in_else_waits_for_its_end() -> None:
    gear = waiting_for_reference().to(45.0).stop(distance=20.0).to(59.0)
    assert gear.state == GEAR_IN
    gear.to(70.0)  # u = 1/2 from 60 on
    assert gear.state == GEAR_OUT
    assert gear.slave == near(7.0 + 15.0 + 30.0 * (1 / 2 - 3 / 32), 7.5, -1.5 * 1.5 * 5.0)
    assert gear.to(90.0).slave == near(7.0 + 15.0 + 15.0, 0.0, 0.0)
    stopped = (
        waiting_for_reference()
        .to(45.0)
        .stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, transition=NONE, stop_position=52.0)
    )
    assert stopped.to(79.0).state == WAITING_FOR_STOP
    assert stopped.to(81.0).slave == (52.0, 0.0, 0.0)


def test_a_falling_edge_that_waits_ends_with_the_master_below_the_trigger() -> None:
    gear = waiting_for_reference().to(45.0).stop()
    gear.speed = -10.0
    gear.to(39.0)
    assert gear.state == STOPPED
    gear.speed = 10.0
    assert gear.to(99.0).state == STOPPED


def test_a_falling_edge_that_waits_is_taken_back_by_a_rising_one() -> None:
    gear = waiting_for_reference().to(45.0).stop(distance=20.0).to(50.0).start(distance=5.0).to(70.0)
    assert gear.state == ACTIVE
    assert gear.slave == near(7.0 + 1.5 * 20.0, 15.0, 0.0)


def test_an_edge_that_has_waited_is_checked_and_read_when_it_acts() -> None:
    gear = waiting_for_reference().to(45.0).stop(distance=20.0).to(50.0).set({"gear_out.distance": 10.0}).to(71.0)
    assert gear.slave == near(7.0 + 15.0 + 7.5, 0.0, 0.0)
    gear = waiting_for_reference().to(45.0).stop(distance=20.0).to(50.0).set({"gear_out.distance": -1.0}).to(71.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, Fault.DISTANCE)
    gear = in_gear().stop(distance=20.0).to(10.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(0.1)
    refused = gear.twin().set(ratio(0, 1)).to(30.0)
    assert (refused.state, refused["error_id"]) == (STOPPED, Fault.NUMERATOR)
    assert gear.set(ratio(1, 1)).to(30.0).slave == near(15.0 + 10.0, 10.0, 0.0)


def test_a_rising_edge_while_leaving_returns() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=150.0).run(1.0)
    assert (gear.state, gear["in_gear"]) == (WAITING_FOR_STOP, False)
    gear.start().run(1.0)
    assert (gear.state, gear["in_gear"]) == (ACTIVE, True)
    assert gear.to(200.0).slave == near(300.0, 15.0, 0.0)


def test_a_rising_edge_in_gear_out_in_time_acts_at_once() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0)
    s, v, a = gear.slave
    gear.start(start_mode=CW, reference_position=25.0, transition=TIME, time=2.0).run(INSTANT)
    assert gear.state == GEAR_IN
    assert gear.slave == near(s, v, a, tolerance=1e-6)
    assert gear.run(2.5).slave == near(s + 1.5 * (gear.master_position - 25.0), 15.0, 0.0)


@pytest.mark.parametrize(
    "order",
    [
        {"start_mode": StartMode.CW_CCW_DIRECT, "transition": NONE},
        {"start_mode": CCW, "transition": TIME},
    ],
)
def test_a_rising_edge_in_gear_out_else_waits_for_the_rest(order: dict[str, Any]) -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).start(**order).to(19.0)
    assert gear.state == GEAR_OUT
    gear.to(30.0)
    if order["transition"] == NONE:
        assert gear.state == ACTIVE
        assert gear.slave == near(15.0 + 1.5 * 10.0, 15.0, 0.0)
    else:
        assert (gear.state, gear.slave[0]) == (WAITING_FOR_START, near(15.0))


def test_a_rising_edge_that_waits_is_taken_back_by_a_falling_one() -> None:
    gear = in_gear().stop(distance=20.0).to(5.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).to(10.0)
    assert gear.stop().to(50.0).state == STOPPED


def test_values_are_read_at_the_edges() -> None:
    gear = waiting_for_reference().run(0.1)
    gear.set({"gear_in.reference_position": 0.0, "gear_in.offset": 99.0, "gear_in.distance": 1.0})
    gear.set({"gear_in.transition": NONE, "gear_in.start_mode": CCW})
    assert gear.to(61.0).slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=52.0, distance=20.0).run(0.1)
    gear.set({"gear_out.stop_position": 0.0, "gear_out.distance": 1.0, "gear_out.transition": TIME})
    assert gear.to(99.0).slave == (52.0, 0.0, 0.0)


def test_the_first_value_of_start_is_no_edge() -> None:
    gear = GearingHarness({"start": True}, speed=10.0).run(50.0)
    assert gear.state == STOPPED
