"""The ratio of the Gearing changes while it runs."""

import pytest

from motionsync.gearing.interface import StartMode, StopMode
from tests.model.gearing.harness import (
    INSTANT,
    NONE,
    continuing,
    engaging_in_time,
    in_gear,
    near,
    ratio,
    waiting_for_reference,
)


def test_in_gear_the_line_turns_about_the_present_point() -> None:
    gear = in_gear().to(20.0).set(ratio(-1, 4)).to(60.0)
    assert gear.slave == near(30.0 - 10.0, -2.5, 0.0)
    assert gear["local.line_offset"] == near(30.0 + 5.0)
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=0.0, transition=NONE).run(0.1)
    gear.set(ratio(-1, 2)).run(3.9)
    assert gear.slave[0] == near(20.0 - 0.25 - 0.5 * 39.0)
    assert gear.to(101.0).slave == (0.0, 0.0, 0.0)


def test_in_time_the_line_turns_and_what_lacks_to_it_stays() -> None:
    gear = engaging_in_time(10.0).run(0.5)
    position, at = gear.slave[0], 1.5 * (105.0 - 110.0)
    gear.set(ratio(3, 1)).run(INSTANT)
    assert gear.slave[0] == near(position, tolerance=1e-6)
    assert gear.run(2.0).slave == near(at + 3.0 * (gear.master_position - 105.0), 30.0, 0.0)


def test_in_a_master_based_transition_the_curve_turns_about_the_present_point() -> None:
    gear = waiting_for_reference().to(50.0)
    position = gear.slave[0]
    gear.set(ratio(3, 1)).run(INSTANT)
    assert gear.slave[0] == near(position, tolerance=1e-6)
    s_a = 7.0 + (1.5 - 3.0) * 20.0 * 3 / 32
    gear.to(55.0)
    assert gear.slave[0] == near(s_a + 60.0 * (27 / 64 - 81 / 512))
    assert gear.to(70.0).slave == near(s_a + 3.0 * 20.0, 30.0, 0.0)
    gear = waiting_for_reference().to(50.0).set(ratio(3, 1))
    gear.speed = -10.0
    assert gear.to(30.0).slave == near(s_a, 0.0, 0.0)


def test_in_gear_out_it_takes_effect_at_the_next_engagement() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).set(ratio(1, 1)).to(30.0)
    assert gear.slave == near(15.0, 0.0, 0.0)
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).to(40.0)
    assert gear.slave == near(25.0, 10.0, 0.0)
    back = in_gear().stop(distance=20.0).to(10.0).set(ratio(1, 1)).run(0.1)
    back.speed = -10.0
    assert back.to(-10.0).slave == near(-15.0, -15.0, 0.0)
    assert back.start().run(1.0).slave == near(-30.0, -15.0, 0.0)


def test_while_waiting_the_synchronous_line_turns() -> None:
    gear = continuing(transition=NONE).run(0.1).set(ratio(1, 2))
    gear.to(31.0)  # through (0, 0): at 15 with the master at 30
    assert gear.slave == near(15.5, 5.0, 0.0)


@pytest.mark.parametrize(("numerator", "denominator", "fault"), [(0, 1, 2), (1, 0, 1), (0, 0, 1)])
def test_a_ratio_of_0_while_running_is_refused(numerator: int, denominator: int, fault: int) -> None:
    gear = in_gear().set(ratio(numerator, denominator)).to(20.0)
    assert (gear["error"], gear["error_id"]) == (True, fault)
    assert gear.slave == near(30.0, 15.0, 0.0)
    gear.set({"reset": True}).run(0.1)
    assert (gear["error"], gear["error_id"]) == (False, 0)
