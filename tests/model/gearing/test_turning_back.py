"""The master reverses during an engagement of the Gearing."""

from motionsync.gearing.interface import StartMode
from tests.model.gearing.harness import (
    ACTIVE,
    WAITING_FOR_START,
    engaging_direct,
    near,
    waiting_for_reference,
)


def test_the_slave_goes_back_along_the_curve_and_rests_below_the_trigger() -> None:
    gear = waiting_for_reference().to(45.0)
    forwards = gear.slave
    gear.to(55.0)
    gear.speed = -10.0
    gear.to(45.0)
    assert gear.slave == near(forwards[0], -forwards[1], forwards[2])
    gear.to(39.0)
    assert (gear.state, gear.slave) == (WAITING_FOR_START, (7.0, 0.0, 0.0))
    gear.speed = 10.0
    assert gear.to(61.0).slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_a_direct_transition_keeps_its_trigger() -> None:
    gear = engaging_direct(StartMode.CW_CCW_DIRECT, 10.0).run(1.0)
    gear.speed = -10.0
    assert gear.to(-20.0).state == WAITING_FOR_START
    assert gear["local.trigger_position"] == 5.0
    gear.speed = 10.0
    assert gear.to(30.0).slave == near(7.0 + 1.5 * 15.0, 15.0, 0.0)


def test_completion_is_final() -> None:
    gear = waiting_for_reference().to(60.5)
    gear.speed = -10.0
    assert gear.to(30.0).state == ACTIVE
    assert gear.slave == near(7.0 - 1.5 * 20.0, -15.0, 0.0)
