"""The Gearing with rotary axes: every occurrence of a position counts, and no turn is lost."""

from typing import Any

import pytest

from motionsync.gearing.interface import StartMode, StopMode
from tests.model.gearing.harness import (
    ACTIVE,
    GEAR_IN,
    INSTANT,
    NONE,
    STOPPED,
    TIME,
    WAITING_FOR_START,
    GearingHarness,
    in_gear,
    near,
    three_halves,
)
from tests.support.blocks.harness import grid


def rotary(master_position: float, speed: float, **values: Any) -> GearingHarness:
    return GearingHarness(
        three_halves(**{"master.period": 360.0, **values}), master_position=master_position, speed=speed
    )


@pytest.mark.parametrize(
    ("master_position", "trigger"), [(30.0, 40.0), (41.0, 400.0), (700.0, 760.0), (-500.0, -320.0)]
)
def test_each_occurrence_of_the_reference_position_counts(master_position: float, trigger: float) -> None:
    gear = rotary(master_position, 10.0).start(reference_position=50.0, distance=20.0).run(INSTANT)
    assert gear["local.trigger_position"] == near(40.0)
    gear.to(trigger - 0.1)
    assert gear.state == WAITING_FOR_START
    gear.to(trigger + 0.1)
    assert gear.state == GEAR_IN
    assert gear.to(trigger + 30.0).slave == near(1.5 * 20.0, 15.0, 0.0)


@pytest.mark.parametrize(("master_position", "missing"), [(30.0, 20.0), (50.0, 0.0), (51.0, 359.0), (-311.0, 1.0)])
def test_in_time_the_next_occurrence_is_meant(master_position: float, missing: float) -> None:
    gear = rotary(master_position, 10.0).start(reference_position=50.0, transition=TIME, time=1.0).run(2.0)
    assert gear.slave == near(1.5 * (20.0 - missing), 15.0, 0.0)


def test_the_synchronous_point_recurs_too() -> None:
    gear = rotary(0.0, 10.0).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, distance=20.0).run(INSTANT)
    assert gear.to(349.0).state == WAITING_FOR_START
    assert gear.to(380.0).slave == near(30.0, 15.0, 0.0)
    at_once = rotary(720.0, 0.0).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert at_once.state == ACTIVE


def test_a_slave_with_a_period_is_put_out_in_it() -> None:
    gear = rotary(0.0, 100.0, **{"slave.period": 90.0, "slave.initial_position": 100.0})
    assert gear.slave[0] == 10.0
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(40.0, cuts=grid(40.0, 0.7))
    assert gear.slave == near((10.0 + 6000.0) % 90.0, 150.0, 0.0)


def test_over_many_turns_nothing_is_lost() -> None:
    """400000 turns of the master, 3 to 4: the last bit of 1/8 is still there."""
    gear = rotary(0.125, 36000.0, **{"slave.period": 90.0, "gearing.denominator": 4})
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(4000.0, cuts=grid(4000.0, 0.5))
    assert gear.slave[0] == 0.0
    assert gear["local.line_offset"] == -0.09375


def test_a_stop_position_means_any_occurrence_that_is_ahead() -> None:
    gear = in_gear(**{"slave.period": 90.0})
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=10.0, distance=20.0).run(0.1)
    assert gear["local.trigger_position"] == near(10.0 / 1.5 - 10.0 + 60.0)
    gear.to(80.0)
    assert gear.state == STOPPED
    assert gear.slave == (10.0, 0.0, 0.0)


@pytest.mark.parametrize(("speed", "travel"), [(10.0, 85.0), (-10.0, -5.0)])
def test_in_time_a_stop_position_is_the_next_one_ahead(speed: float, travel: float) -> None:
    gear = in_gear(speed=speed, **{"slave.period": 90.0, "slave.initial_position": 15.0})
    gear.stop(stop_mode=StopMode.WITH_CW_CCW_STOP_POSITION, transition=TIME, time=8.0, stop_position=100.0)
    rows = gear.rows(8.0, cuts=grid(8.0, 0.1))
    assert gear.slave == near(10.0, 0.0, 0.0)
    unwrapped = 15.0
    for row in rows.values():
        unwrapped += (row["slave.position"] - unwrapped + 45.0) % 90.0 - 45.0
    assert unwrapped == near(15.0 + travel)


@pytest.mark.parametrize(("begin", "travel"), [(60.0, 40.0), (50.0, -40.0)])
def test_in_time_and_at_rest_the_nearest_stop_position_is_meant(begin: float, travel: float) -> None:
    gear = in_gear(speed=0.0, **{"slave.period": 90.0, "slave.initial_position": begin})
    gear.stop(stop_mode=StopMode.WITH_CW_CCW_STOP_POSITION, transition=TIME, time=2.0, stop_position=10.0).run(1.0)
    assert gear.slave[0] == near((begin + travel / 2) % 90.0)


def test_the_synchronous_point_outlives_the_slaves_turns() -> None:
    gear = in_gear(**{"slave.period": 90.0}).to(100.0)  # the line runs through (0, 0)
    gear.stop(transition=NONE, stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=30.0).to(150.0)  # at m = 140
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE)
    gear.speed = -10.0
    gear.to(139.0)
    assert gear.state == ACTIVE
    assert gear.slave == near(30.0 - 1.5, -15.0, 0.0)
