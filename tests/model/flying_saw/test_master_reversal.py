"""A master that turns back past the coupling position: halt, backstop, and the new plan."""

import math
from typing import Any

import pytest

from motionsync.flying_saw.interface import PlcopenState, State
from tests.model.flying_saw.harness import FIRST, INSTANT, FlyingSawHarness, first_example, near


def reversed_master(
    *modes: str, sync: bool = False, v0: float = 250.0, back: float = -300.0, **values: Any
) -> FlyingSawHarness:
    """Example 1, in sync or not; then the master has come back to the coupling position -500 at constant velocity."""
    saw = first_example(**{"axis.initial_velocity": v0, **values}).modes(*modes)
    saw.give("gear_in_pos", **FIRST).run(3.5 if sync else 1.0)
    saw.speed = back
    return saw.run((saw.master_position + 500.0) / -back)


def test_in_sync_without_the_lock_the_slave_runs_back_too() -> None:
    for modes in [(), ("instant_stop_on_rollback",)]:
        saw = reversed_master(*modes, sync=True).run(1.0)
        assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
        assert (saw.state, saw.slave) == (State.SYNCHRON, near(-800.0, -300.0, 0.0))


HALT = 1.5 * 150.0 / 2500.0  # from -150 to 0


@pytest.mark.parametrize("modes", [(), ("rollback_lock",)])
def test_not_in_sync_the_slave_halts_along_a_ramp_in_time(modes: tuple[str, ...]) -> None:
    """The halt starts at -250 with -150, half the master's velocity, and takes T = 1.5 * 150 / 2500 and 75 T."""
    saw = reversed_master(*modes)
    assert saw.slave == near(-250.0, -150.0, 0.0)
    assert saw.state == State.SYNCHRONIZING
    saw.run(0.5 * HALT)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert saw.slave == near(-250.0 - HALT * (75.0 - 150.0 * (1 / 8 - 1 / 32)), -75.0, 2500.0)
    saw.run(0.6 * HALT)
    assert saw.slave == near(-250.0 - 75.0 * HALT, 0.0, 0.0)
    assert (saw.state, saw["in_sync"], saw["coupled"]) == (State.PREPHASE, False, True)
    assert saw["plcopen_state"] == PlcopenState.SYNCHRONIZED_MOTION


def test_the_halt_keeps_the_jerk_limit_if_it_is_checked() -> None:
    """With the jerk limit the halt takes sqrt(6 * 150 / 5000) = 0.424 s."""
    halt = math.sqrt(0.18)
    saw = reversed_master("check_max_jerk").run(0.5 * halt)
    assert saw.slave[1:] == near(-75.0, 225.0 / halt)
    assert saw.run(0.51 * halt).slave == near(-250.0 - 75.0 * halt, 0.0, 0.0)


@pytest.mark.parametrize("modes", [("instant_stop_on_rollback",), ("rollback_lock", "instant_stop_on_rollback")])
def test_not_in_sync_with_the_instant_stop_the_slave_is_at_rest_at_once(modes: tuple[str, ...]) -> None:
    saw = reversed_master(*modes).run(0.25)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(-250.0, 0.0, 0.0))
    assert saw.results("gear_in_pos") >= {"busy", "active"}


def test_in_sync_the_backstop_halts_along_a_ramp_in_time() -> None:
    """On the line the slave is at -500 where the synchronisation started; the halt takes 1.5 * 300 / 2500 s."""
    saw = reversed_master("rollback_lock", sync=True)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(-500.0, -300.0, 0.0))
    saw.run(0.09)
    assert (saw.state, saw.slave[1:]) == (State.PREPHASE, near(-150.0, 2500.0))
    assert "in_sync" not in saw.results("gear_in_pos")
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert saw.run(0.1).slave == near(-500.0 - 27.0, 0.0, 0.0)


def test_in_sync_the_backstop_with_the_instant_stop() -> None:
    saw = reversed_master("rollback_lock", "instant_stop_on_rollback", sync=True).run(0.25)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(-500.0, 0.0, 0.0))
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert not saw["in_sync"]


@pytest.mark.parametrize("correction", [1e-14, 0.01])  # rounding, and what a predicted path is off by
@pytest.mark.parametrize("modes", [(), ("time_based",)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_input_that_is_ahead_of_the_path_of_a_master_that_goes_back_is_no_passing_forwards(
    sign: float, modes: tuple[str, ...], correction: float
) -> None:
    """Coupled at 0, the master turns. A step ends just behind 0, and the next input is just before it, still backwards."""
    saw = FlyingSawHarness(speed=sign * 400.0).modes("rollback_lock", "instant_stop_on_rollback", *modes)
    saw.give("gear_in_velo", acceleration=500.0, deceleration=500.0).run(0.1)
    saw.speed = sign * -300.0
    saw.run((40.0 + correction) / 300.0)
    position, *_ = saw.slave
    assert (saw.state, saw.slave) == (State.PREPHASE, (position, 0.0, 0.0))
    saw.master_position = sign * correction
    assert (saw.run(0.5).state, saw.slave) == (State.PREPHASE, (position, 0.0, 0.0))


@pytest.mark.parametrize("modes", [(), ("rollback_lock",), ("instant_stop_on_rollback",)])
def test_forwards_again_the_synchronisation_is_planned_anew(modes: tuple[str, ...]) -> None:
    """The parked slave meets the master at 1000/1000 again, and the coupling position stays where it was."""
    saw = reversed_master(*modes).run(1.0)
    rest = saw.slave[0]
    saw.speed = 600.0
    assert saw.run(0.5).state == State.PREPHASE  # at the coupling position
    saw.run(0.01)
    assert saw.state == State.SYNCHRONIZING
    result = saw.block.characteristics
    assert (result.master_velocity_nominal, result.master_position_start, result.master_position_end) == near(
        600.0, -500.0, 1000.0
    )
    assert (result.slave_position_start, result.slave_velocity_start, result.slave_velocity_end) == near(
        rest, 0.0, 600.0
    )
    saw.run(2.49 + INSTANT)
    assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
    assert saw.slave == near(1000.0 + 600.0 * INSTANT, 600.0, 0.0)
    saw.speed = -600.0
    saw.run(2.5 + 2 * INSTANT + 0.1)
    assert saw.state == (State.PREPHASE if "rollback_lock" in modes else State.SYNCHRON)


def test_forwards_again_even_in_the_halt() -> None:
    """Half through the halt the master moves with +300; the new plan starts with -75 and 2500."""
    saw = reversed_master().run(0.5 * HALT)
    position = saw.slave[0]
    saw.master_position, saw.speed = -499.0, 300.0  # the input correction passes the coupling position
    saw.run(INSTANT)
    result = saw.block.characteristics
    assert saw.state == State.SYNCHRONIZING
    assert (result.slave_position_start, result.slave_velocity_start) == near(position, -75.0)
    assert result.slave_acceleration_start == near(2500.0)
    saw.run(1499.0 / 300.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(300.0, 0.0))


@pytest.mark.parametrize("in_halt", [False, True])
def test_a_refused_new_plan_leaves_the_axis_uncoupled_and_standing(in_halt: bool) -> None:
    """At 600 the synchronous velocity alone exceeds the limit of 550."""
    saw = reversed_master("check_max_velocity", **{"axis.max_velocity": 550.0}).run(0.5 * HALT if in_halt else 1.0)
    saw.master_position, saw.speed = -500.0, 600.0
    fastest = abs(saw.slave[1])
    for _ in range(100):
        assert abs(saw.run(0.005).slave[1]) <= fastest
    assert saw.results("gear_in_pos") == {"error"}
    assert (saw["gear_in_pos.error_id"], saw["error_id"], saw["coupled"]) == (0x42DD, 0x42DD, False)
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)
    assert saw.slave[1:] == (0.0, 0.0)
    saw.release("gear_in_pos").give("move_absolute", position=0.0).run(5.0)
    assert saw.slave == (0.0, 0.0, 0.0)


def test_gear_in_velo_is_planned_anew_too() -> None:
    """From -100 to 100 with 400 takes 0.75 s; reversed, v = v0 v_m' / v_m = 50 there."""
    saw = FlyingSawHarness({"axis.initial_velocity": -100.0}, speed=100.0)
    saw.give("gear_in_velo", acceleration=400.0, deceleration=400.0).run(0.15)
    saw.speed = -50.0
    saw.run(0.3)
    assert (saw.state, saw.slave) == (State.SYNCHRONIZING, near(0.0, 50.0, 0.0))
    saw.run(1.0)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(25.0 * 1.5 * 50.0 / 400.0, 0.0, 0.0))
    saw.speed = 200.0
    assert saw.run(0.25 + 0.75 - INSTANT).state == State.SYNCHRONIZING
    assert saw.run(2 * INSTANT).state == State.SYNCHRON
    assert saw.slave[1:] == near(200.0, 0.0)


def test_gear_in_velo_may_be_refused_when_planned_anew() -> None:
    saw = (
        FlyingSawHarness(speed=100.0)
        .modes("check_max_velocity")
        .give("gear_in_velo", velocity=150.0, acceleration=100.0)
    )
    saw.run(0.1).speed = -100.0
    assert saw.run(0.5).state == State.PREPHASE
    saw.speed = 200.0
    saw.run(1.0)
    assert (saw.results("gear_in_velo"), saw["error_id"]) == ({"error"}, 0x42DD)
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_coupling_to_a_standing_master_takes_its_direction_from_the_first_motion(sign: float) -> None:
    saw = (
        FlyingSawHarness(master_position=5.0)
        .modes("rollback_lock", "instant_stop_on_rollback")
        .give("gear_in_velo")
        .run(1.0)
    )
    saw.speed = sign * 10.0
    saw.run(1.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(sign * 10.0, sign * 10.0, 0.0))
    saw.speed = -sign * 10.0
    saw.run(1.5)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(0.0, 0.0, 0.0))
    assert saw.results("gear_in_velo") >= {"busy", "active"}
    saw.speed = sign * 10.0
    saw.run(1.5)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}
