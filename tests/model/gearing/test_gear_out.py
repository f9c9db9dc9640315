"""The Gearing disengages: directly, at a stop position, in time; and the master reverses meanwhile."""

import pytest

from motionsync.gearing.interface import StopMode
from tests.model.gearing.harness import (
    ACTIVE,
    CW,
    GEAR_OUT,
    MASTER,
    NONE,
    STOPPED,
    TIME,
    WAITING_FOR_STOP,
    in_gear,
    near,
)


@pytest.mark.parametrize(
    ("mode", "speed", "met"),
    [
        (StopMode.CW_DIRECT, 10.0, True),
        (StopMode.CW_DIRECT, -10.0, False),
        (StopMode.CW_DIRECT, 0.0, False),
        (StopMode.CCW_DIRECT, -10.0, True),
        (StopMode.CCW_DIRECT, 10.0, False),
        (StopMode.CW_CCW_DIRECT, 10.0, True),
        (StopMode.CW_CCW_DIRECT, -10.0, True),
        (StopMode.CW_CCW_DIRECT, 0.0, True),
    ],
)
def test_direct_disengaging_begins_at_the_edge_if_the_master_moves_as_it_has_to(
    mode: StopMode, speed: float, met: bool
) -> None:
    for transition, reached in [(NONE, STOPPED), (MASTER, GEAR_OUT), (TIME, GEAR_OUT)]:
        gear = in_gear(speed=speed).stop(stop_mode=mode, transition=transition).run(0.5)
        assert gear.state == (reached if met else WAITING_FOR_STOP)
        assert not gear["in_gear"]
        if not met:
            assert gear.slave == near(0.75 * speed, 1.5 * speed, 0.0, tolerance=1e-7)


def test_master_based_it_travels_half_the_distance() -> None:
    gear = in_gear().stop(distance=20.0).to(5.0)
    assert gear["local.progress"] == near(0.25)
    assert gear.slave == near(30.0 * (1 / 4 - 1 / 64 + 1 / 512), 15.0 * (1 - 3 / 16 + 2 / 64), -1.5 * (9 / 8) * 5.0)
    assert gear.to(25.0).slave == near(15.0, 0.0, 0.0)
    assert gear.state == STOPPED


def test_without_transition_the_slave_rests_where_it_is() -> None:
    gear = in_gear().to(10.0).stop(transition=NONE).run(1.0)
    assert gear.slave == near(15.0, 0.0, 0.0)


def test_in_time_it_overruns_and_comes_back() -> None:
    gear = in_gear().stop(transition=TIME, time=3.0).run(1.0)
    assert gear.slave == near(0.19753086419753085 * 15.0 * 3.0, 0.0, -15.0 / 3.0 * 32.0 / 9.0, tolerance=1e-6)
    assert gear.run(2.0).slave == near(0.0, 0.0, 0.0, tolerance=1e-6)
    assert gear.state == STOPPED


def test_direct_disengaging_waits_for_the_master_to_turn() -> None:
    gear = in_gear().stop(stop_mode=StopMode.CCW_DIRECT, distance=20.0).run(3.0, acceleration=-5.0)  # turns at 10
    assert gear.state == GEAR_OUT
    assert gear["local.trigger_position"] == near(10.0)
    u = 2.5 / 20.0
    assert gear.slave[0] == near(15.0 - 30.0 * (u - u**3 + u**4 / 2), tolerance=1e-7)


def test_from_where_the_master_came_before_the_edge_does_not_count() -> None:
    """It comes down to where the slave is at the stop position, and rests; after the edge it starts upwards."""
    gear = in_gear(speed=-10.0).to(-10.0)
    gear.speed = 0.0
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=-15.0, transition=NONE)
    assert gear.run(1.0).state == WAITING_FOR_STOP
    assert gear.run(1.0, acceleration=1.0).state == STOPPED
    assert gear.slave == near(-15.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("mode", "speed"), [(StopMode.WITH_CW_STOP_POSITION, 10.0), (StopMode.WITH_CCW_STOP_POSITION, -10.0)]
)
@pytest.mark.parametrize("either", [False, True])
def test_a_stop_position_is_met_exactly(mode: StopMode, speed: float, either: bool) -> None:
    side = speed / 10.0
    chosen = StopMode.WITH_CW_CCW_STOP_POSITION if either else mode
    gear = in_gear(speed=speed).stop(stop_mode=chosen, stop_position=45.7 * side, distance=20.0)
    gear.to(side * (45.7 / 1.5 - 10.1))
    assert gear.state == WAITING_FOR_STOP
    assert gear["local.trigger_position"] == near(side * (45.7 / 1.5 - 10.0))
    gear.to(side * 45.7 / 1.5)
    assert gear.state == GEAR_OUT
    assert gear.slave[0] == near(side * (45.7 - 15.0 + 30.0 * (1 / 2 - 3 / 32)), tolerance=1e-7)
    gear.to(side * 60.0)
    assert (gear.state, gear.slave) == (STOPPED, (45.7 * side, 0.0, 0.0))


def test_without_transition_it_stops_where_the_line_reaches_the_stop_position() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=45.0, transition=NONE).to(29.9)
    assert gear.state == WAITING_FOR_STOP
    assert gear.to(30.1).slave == (45.0, 0.0, 0.0)
    assert gear.state == STOPPED


def test_a_stop_position_that_is_behind_is_met_when_the_master_comes_again() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=-45.0, distance=20.0).run(1.0)
    assert gear.state == WAITING_FOR_STOP
    gear.speed = -10.0
    assert gear.to(-50.0).state == WAITING_FOR_STOP
    gear.speed = 10.0
    assert gear.to(0.0).slave == (-45.0, 0.0, 0.0)


def test_in_time_to_a_stop_position() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=-45.0, transition=TIME, time=2.0)
    assert gear.run(1.0).state == GEAR_OUT
    assert gear.run(1.0).slave == (-45.0, 0.0, 0.0)


@pytest.mark.parametrize(("mode", "triggered"), [(StopMode.CW_CCW_DIRECT, 0.0), (StopMode.WITH_CW_STOP_POSITION, 10.0)])
def test_a_disengagement_falls_back_on_to_the_line(mode: StopMode, triggered: float) -> None:
    gear = in_gear().stop(stop_mode=mode, stop_position=30.0, distance=20.0).to(triggered + 10.0)
    assert gear.state == GEAR_OUT
    gear.speed = -10.0
    gear.to(triggered - 5.0)
    assert gear.state == WAITING_FOR_STOP
    assert gear.slave == near(1.5 * (triggered - 5.0), -15.0, 0.0, tolerance=1e-7)
    gear.speed = 10.0
    gear.to(triggered + 20.5)
    assert gear.state == STOPPED
    assert gear.slave == near(1.5 * triggered + 15.0, 0.0, 0.0, tolerance=1e-7)


def test_a_rising_edge_that_waits_acts_on_the_line_if_the_disengagement_falls_back() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).start(start_mode=CW, distance=5.0)
    gear.speed = -10.0
    assert gear.to(-5.0).state == ACTIVE
