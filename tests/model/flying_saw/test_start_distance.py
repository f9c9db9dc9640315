"""A gear_in_pos that waits until the master passes its start."""

from typing import Any

import pytest
from numpy.polynomial import Polynomial

from motionsync.flying_saw.interface import PlcopenState, State
from tests.model.flying_saw.harness import INSTANT, FlyingSawHarness, coupled, near


def waiting(sign: float = 1.0, **values: Any) -> FlyingSawHarness:
    """The master goes from 0 with 100 to 1000; the slave is to start at 700, 300 before that, and to meet at 150."""
    saw = FlyingSawHarness({"axis.initial_position": 0.0, **values}, speed=sign * 100.0)
    aims = {"master_sync_position": sign * 1000.0, "slave_sync_position": sign * 150.0, "ratio_numerator": 0.5}
    return saw.give("gear_in_pos", **aims, master_start_distance=300.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_slave_waits_for_the_start_distance(sign: float) -> None:
    """The slave goes from 0 to 150 in 3 s and has 50 then: the quintic with A = B = 150."""
    saw = waiting(sign).run(7.0 - INSTANT)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") == {"busy", "active"}
    assert (saw["plcopen_state"], saw["coupled"]) == (PlcopenState.SYNCHRONIZED_MOTION, True)
    assert saw.slave == (0.0, 0.0, 0.0)
    saw.run(1.5)
    assert saw.state == State.SYNCHRONIZING
    assert saw.results("gear_in_pos") == {"start_sync", "busy", "active"}
    curve = Polynomial([0.0, 0.0, 0.0, 6.0, -8.0, 3.0]) * 150.0 * sign
    u = 0.5 - INSTANT / 3.0
    assert saw.slave == near(curve(u), curve.deriv()(u) / 3.0, curve.deriv(2)(u) / 9.0)
    assert saw["characteristics.master_position_start"] == near(sign * 700.0)
    saw.run(2.0 + INSTANT)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(sign * 175.0, sign * 50.0, 0.0))


def test_a_start_already_passed_is_now() -> None:
    saw = waiting()
    saw.master_position = 800.0
    assert saw.run(0.5).state == State.SYNCHRONIZING
    assert saw["characteristics.master_position_start"] == near(800.0)
    assert saw.run(2.0).slave[0] == near(150.0 + 0.5 * 50.0)


def test_only_forwards_the_start_is_passed() -> None:
    """The master comes to 650 in 6.5 s, goes back, and comes again."""
    saw = waiting().run(6.5)
    saw.speed = -100.0
    saw.run(8.0)
    saw.speed = 50.0
    assert saw.run(16.9).state == State.PREPHASE
    assert saw.run(0.2).state == State.SYNCHRONIZING
    assert saw["characteristics.master_velocity_nominal"] == near(50.0)
    saw.run(7.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(150.0 + 0.5 * (saw.master_position - 1000.0), 25.0, 0.0))


def test_meanwhile_the_slave_s_own_motion_goes_on() -> None:
    saw = waiting(**{"axis.max_jerk": 1000.0, "axis.max_acceleration": 100.0}).release("gear_in_pos")
    twin = saw.twin()
    for each in (saw, twin):
        each.give("move_absolute", position=60.0, velocity=30.0).run(1.0)
    saw.set({"gear_in_pos.execute": True}).run(1.0)
    assert saw.results("move_absolute") == {"command_aborted"}
    assert saw.slave == twin.run(1.0).slave
    assert saw.run(3.0).state == State.PREPHASE
    assert saw.slave == twin.run(3.0).slave == (60.0, 0.0, 0.0)


@pytest.mark.parametrize("group", ["gear_out", "halt", "stop"])
def test_the_waiting_is_cancelled(group: str) -> None:
    saw = waiting(**{"axis.initial_velocity": 5.0}).run(2.0)
    twin = FlyingSawHarness({"axis.initial_velocity": 5.0}).run(2.0)
    for each in (saw, twin):
        each.give(group, **({} if group == "gear_out" else {"deceleration": 20.0})).run(0.125)
    assert saw.results("gear_in_pos") == {"command_aborted"}
    assert saw.slave == twin.slave
    assert saw.run(20.0).slave == twin.run(20.0).slave
    assert saw.state == twin.state == (State.CONSTANT_VELOCITY if group == "gear_out" else State.INACTIVE)


def test_a_start_that_is_refused_when_it_comes() -> None:
    """With 30 u/s the slave has passed 150 when the master passes the start."""
    saw = waiting(**{"axis.initial_velocity": 30.0}).run(6.9)
    assert saw.results("gear_in_pos") == {"busy", "active"}
    saw.run(0.2)
    assert saw.results("gear_in_pos") == {"error"}
    assert (saw["gear_in_pos.error_id"], saw["error_id"]) == (0x42DE, 0x42DE)
    assert (saw.state, saw.slave) == (State.CONSTANT_VELOCITY, near(213.0, 30.0, 0.0))


def test_the_values_are_those_of_the_edge_when_the_start_comes() -> None:
    saw = waiting().run(1.0).modes("check_max_acceleration")
    saw.set({"gear_in_pos.slave_sync_position": 1.0, "gear_in_pos.ratio_numerator": 9.0, "axis.max_acceleration": 1.0})
    saw.run(10.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(200.0, 50.0, 0.0))


@pytest.mark.parametrize(("position", "code"), [(400.0, 0), (20.0, 0x42DE)])
def test_a_coupled_slave_waits_for_the_start_distance_too(position: float, code: int) -> None:
    """The slave is in sync from 0.3 s on; 2 s later the start comes, and the slave has passed 20 already."""
    saw = coupled()
    aims = {"master_sync_position": saw.master_position + 500.0, "slave_sync_position": position}
    saw.give("gear_in_pos", **aims, master_start_distance=300.0).run(1.9)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") == {"busy", "active"}
    assert saw.results("gear_in_velo") == {"command_aborted"}  # in this step
    before = saw.slave[0]
    saw.run(0.2)
    assert saw["gear_in_pos.error_id"] == code
    if code:
        assert (saw.state, saw.slave) == (State.CONSTANT_VELOCITY, near(before + 20.0, 100.0, 0.0))
    else:
        assert saw.run(3.0).results("gear_in_pos") == {"start_sync", "in_sync"}
        assert saw.slave == near(400.0 + 10.0, 100.0, 0.0)
