"""The Gearing continues on the line through the last synchronous point, which can be set."""

from motionsync.gearing.interface import StartMode
from tests.model.gearing.harness import (
    ACTIVE,
    GEAR_IN,
    NONE,
    TIME,
    WAITING_FOR_START,
    GearingHarness,
    continuing,
    near,
    three_halves,
)


def test_it_continues_on_the_line_through_the_last_synchronous_point() -> None:
    gear = continuing()
    gear.speed = -10.0
    gear.to(12.5)
    assert gear["local.trigger_position"] == near(12.0)  # the line has the slave at 15 with the master at 10
    assert gear.to(11.0).state == GEAR_IN
    assert gear.to(6.0).slave == near(1.5 * 6.0, -15.0, 0.0)


def test_it_continues_in_time_on_that_line() -> None:
    gear = continuing(transition=TIME, time=1.0).run(1.5)
    assert gear.slave == near(1.5 * gear.master_position, 15.0, 0.0)


def test_it_continues_at_once_where_the_slave_is_on_the_line_already() -> None:
    gear = GearingHarness({"slave.initial_position": 7.0})
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert (gear.state, gear.slave) == (ACTIVE, (7.0, 0.0, 0.0))  # at rest; initially (0, initial_position)
    near_by = (
        GearingHarness(master_position=1e-10)
        .start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE)
        .run(1.0)
    )
    assert near_by.state == ACTIVE
    far = (
        GearingHarness(master_position=1e-8).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    )
    assert far.state == WAITING_FOR_START
    waits = GearingHarness().start(start_mode=StartMode.CONTINUE_SYNCHRONIZED).run(1.0)
    assert waits.state == WAITING_FOR_START


def test_both_halves_of_the_synchronous_point_can_be_set_while_inactive() -> None:
    gear = GearingHarness(three_halves(activate=False), speed=10.0)
    gear.set({"set_master.execute": True, "set_master.value": 40.0, "set_slave.execute": True, "set_slave.value": 6.0})
    gear.run(0.1)
    assert gear.slave == (6.0, 0.0, 0.0)
    gear.set({"set_slave.execute": False}).run(0.1).set({"set_slave.execute": True, "set_slave.value": 9.0}).run(0.1)
    gear.set({"set_master.value": 70.0, "activate": True}).run(0.1)
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, distance=20.0).run(0.1)
    assert gear["local.trigger_position"] == near(30.0)
    assert gear.to(60.0).slave == near(9.0 + 1.5 * 20.0, 15.0, 0.0)


def test_the_synchronous_point_is_not_set_while_active() -> None:
    gear = GearingHarness().set({"set_slave.execute": True, "set_slave.value": 6.0}).run(0.1)
    assert gear.slave[0] == 0.0
    assert gear.set({"activate": False}).run(0.1).slave[0] == 0.0  # no edge
