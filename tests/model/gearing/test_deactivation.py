"""The Gearing is deactivated and activated again."""

import pytest

from motionsync.gearing.interface import StartMode
from tests.model.gearing.harness import (
    ACTIVE,
    GEAR_IN,
    INSTANT,
    NONE,
    STOPPED,
    WAITING_FOR_START,
    GearingHarness,
    in_gear,
    near,
    waiting_for_reference,
)


@pytest.mark.parametrize("master_position", [30.0, 50.0, 70.0])
def test_deactivated_the_slave_stops_at_its_last_setpoint(master_position: float) -> None:
    gear = waiting_for_reference().to(master_position)
    position = gear.slave[0]
    gear.set({"activate": False}).run(1.0)
    assert gear.slave == near(position, 0.0, 0.0)
    assert gear.state == {30.0: WAITING_FOR_START, 50.0: GEAR_IN, 70.0: ACTIVE}[master_position]
    reset = gear.twin().set({"reset": True}).run(1.0)
    assert (reset.state, reset.slave) == (STOPPED, near(position, 0.0, 0.0))
    gear.set({"activate": True}).run(10.0)
    assert (gear.state, gear.slave) == (STOPPED, near(position, 0.0, 0.0))


def test_edges_are_lost_while_inactive() -> None:
    gear = (
        GearingHarness({"activate": False}, speed=10.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(1.0)
    )
    assert gear.set({"activate": True}).run(1.0).state == STOPPED
    assert gear.stop().run(1.0).start().run(1.0).state == ACTIVE


def test_deactivating_saves_the_synchronous_point() -> None:
    gear = in_gear().to(20.0).set({"activate": False}).to(40.0)
    gear.set({"activate": True, "start": False}).run(INSTANT)
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(INSTANT)
    assert gear.state == WAITING_FOR_START
    gear.speed = -10.0
    assert gear.to(10.0).slave == near(15.0, -15.0, 0.0, tolerance=1e-7)


def test_a_new_edge_together_with_activate_counts() -> None:
    gear = GearingHarness({"activate": False}, speed=10.0).run(1.0).set({"activate": True})
    assert gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(1.0).state == ACTIVE
