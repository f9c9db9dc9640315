"""The axis's own motions: halt, move_velocity, move_absolute."""

from typing import Any

import pytest

from motionsync.flying_saw.interface import PlcopenState, State
from tests.model.flying_saw.harness import (
    INSTANT,
    FlyingSawHarness,
    assert_refused,
    coupled,
    moving,
    near,
    stopped_half,
    under_way,
)


def test_halt_is_not_locked() -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0}).give("halt", deceleration=1000.0, jerk=10000.0).run(0.1)
    assert (saw.results("halt"), saw["plcopen_state"]) == ({"busy", "active"}, PlcopenState.DISCRETE_MOTION)
    assert saw.slave == near(10.0 - 10.0 / 6.0, 50.0, -1000.0)
    other = saw.twin().give("move_velocity", velocity=10.0).run(1.0)
    assert (other.results("halt"), other.slave[1:]) == ({"command_aborted"}, (10.0, 0.0))
    saw.run(0.1 + INSTANT)
    assert (saw.results("halt"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STANDSTILL)
    assert saw.slave == near(10.0, 0.0, 0.0)


def test_a_long_halt_keeps_the_deceleration() -> None:
    """From 300 with 1000 and 10000: 0.1 s of jerk, 0.2 s at -1000, 0.1 s of jerk; 300 * 0.4 / 2 u."""
    saw = FlyingSawHarness({"axis.initial_velocity": 300.0}).give("halt", deceleration=1000.0, jerk=10000.0).run(0.2)
    assert saw.slave[1:] == near(150.0, -1000.0)
    assert saw.run(0.2 + INSTANT).slave == near(60.0, 0.0, 0.0)


def test_move_velocity_and_its_result() -> None:
    """100 u/s with 1000 and 10000: 0.2 s and 10 u; then it goes on."""
    saw = FlyingSawHarness().give("move_velocity", velocity=100.0, acceleration=1000.0, jerk=10000.0).run(0.1)
    assert (saw.state, saw["plcopen_state"]) == (State.ACCELERATING, PlcopenState.CONTINUOUS_MOTION)
    assert (saw.results("move_velocity"), saw.slave) == ({"busy", "active"}, near(10.0 / 6.0, 50.0, 1000.0))
    saw.run(0.1 + INSTANT)
    assert (saw.results("move_velocity"), saw.state) == ({"in_velocity"}, State.CONSTANT_VELOCITY)
    saw.run(0.8 - INSTANT)
    assert (saw.slave, saw["plcopen_state"]) == (near(90.0, 100.0, 0.0), PlcopenState.CONTINUOUS_MOTION)
    saw.give("halt").run(INSTANT)
    assert saw.results("move_velocity") == {"command_aborted"}


def test_move_velocity_through_zero_takes_the_lower_limit() -> None:
    """From 100 to -100 with min(4000, 2000) and much jerk: at 2000 0.1 s and a little."""
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0})
    saw.give("move_velocity", velocity=-100.0, acceleration=4000.0, deceleration=2000.0, jerk=1e9).run(0.05)
    assert saw.slave[2] == -2000.0
    saw.run(0.05 + 3e-6)
    assert (saw.slave[1:], saw["slave.position"]) == (near(-100.0, 0.0), pytest.approx(0.0, abs=1e-3))


@pytest.mark.parametrize(("target", "limit"), [(200.0, 4000.0), (50.0, 2000.0)])
def test_faster_takes_the_acceleration_slower_the_deceleration(target: float, limit: float) -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0})
    saw.give("move_velocity", velocity=target, acceleration=4000.0, deceleration=2000.0, jerk=1e9).run(0.01)
    assert abs(saw.slave[2]) == limit


def test_move_velocity_to_0_is_standstill() -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0}).give("move_velocity", velocity=0.0).run(1.0)
    assert (saw.results("move_velocity"), saw.state) == ({"in_velocity"}, State.INACTIVE)
    assert saw["plcopen_state"] == PlcopenState.STANDSTILL


def test_the_velocity_limit_itself_is_allowed() -> None:
    for velocity in (2000.0, -2000.0):
        assert FlyingSawHarness().give("move_velocity", velocity=velocity).run(1.0).slave[1:] == (velocity, 0.0)


def test_move_absolute_along_seven_pieces() -> None:
    """v 100, a 1000, j 10000: 0.2 s and 10 u up, 80 u in 0.8 s, the same down."""
    saw = FlyingSawHarness({"axis.initial_position": 5.0})
    saw.give("move_absolute", position=105.0, velocity=100.0, acceleration=1000.0, deceleration=1000.0, jerk=10000.0)
    assert saw.run(0.1).slave == near(5.0 + 10.0 / 6.0, 50.0, 1000.0)
    assert (saw.state, saw["plcopen_state"]) == (State.ACCELERATING, PlcopenState.DISCRETE_MOTION)
    assert saw.run(0.5).slave == near(55.0, 100.0, 0.0)
    assert saw.state == State.CONSTANT_VELOCITY
    assert saw.run(0.5).slave == near(105.0 - 10.0 / 6.0, 50.0, -1000.0)
    assert saw.results("move_absolute") == {"busy", "active"}
    saw.run(0.1 + INSTANT)
    assert (saw.slave, saw.results("move_absolute")) == ((105.0, 0.0, 0.0), {"done"})
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)


@pytest.mark.parametrize("begin", [moving, under_way, coupled, stopped_half])
@pytest.mark.parametrize("target", [-300.0, 0.0, 1e-3, 400.0])
def test_move_absolute_ends_just_at_its_target_from_any_motion(begin: Any, target: float) -> None:
    saw = begin().release().give("move_absolute", position=target).run(3.0)
    assert (saw.slave, saw.results("move_absolute")) == ((target, 0.0, 0.0), {"done"})


def test_move_absolute_to_an_end_position_and_not_beyond() -> None:
    saw = FlyingSawHarness({"axis.min_position": -10.0, "axis.max_position": 20.0})
    assert_refused(saw, "move_absolute", 0x4373, position=20.0 + 1e-9)
    assert_refused(saw, "move_absolute", 0x4372, position=-10.0 - 1e-9)
    assert saw.give("move_absolute", position=20.0).run(2.0).slave == (20.0, 0.0, 0.0)
    assert saw.release().run(INSTANT).give("move_absolute", position=-10.0).run(2.0).slave == (-10.0, 0.0, 0.0)


def test_at_the_target_already_move_absolute_is_done() -> None:
    saw = FlyingSawHarness({"axis.initial_position": 7.0}).give("move_absolute", position=7.0).run(INSTANT)
    assert (saw.results("move_absolute"), saw.slave) == ({"done"}, (7.0, 0.0, 0.0))
