"""The shown states through a cycle, and what stays after it."""

import pytest

from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from tests.model.flying_saw.harness import FIRST, INSTANT, OUTPUTS, FlyingSawHarness, assert_refused, first_example


def test_states_through_a_cycle() -> None:
    """The slave waits until the master passes 100 and is in sync at 200; a halt takes 0.2 s, the return 0.8 s."""
    saw = FlyingSawHarness(speed=100.0)
    limits = {"velocity": 100.0, "acceleration": 1000.0, "deceleration": 1000.0, "jerk": 10000.0}
    start = {"master_sync_position": 200.0, "slave_sync_position": 50.0, "master_start_distance": 100.0}
    for group, values, duration, state, plcopen in [
        ("reset", {}, 0.1, "INACTIVE", "STANDSTILL"),
        ("gear_in_pos", start, 0.5, "PREPHASE", "SYNCHRONIZED_MOTION"),
        ("", {}, 1.0, "SYNCHRONIZING", "SYNCHRONIZED_MOTION"),
        ("", {}, 0.5, "SYNCHRON", "SYNCHRONIZED_MOTION"),
        ("gear_out", {}, 0.1, "CONSTANT_VELOCITY", "CONTINUOUS_MOTION"),
        ("halt", {"deceleration": 1000.0, "jerk": 10000.0}, 0.1, "DECELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.2, "INACTIVE", "STANDSTILL"),
        ("move_absolute", {"position": 20.0, **limits}, 0.1, "ACCELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.15, "CONSTANT_VELOCITY", "DISCRETE_MOTION"),
        ("", {}, 0.45, "DECELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.5, "INACTIVE", "STANDSTILL"),
        ("move_velocity", limits | {"velocity": -100.0}, 0.1, "ACCELERATING", "CONTINUOUS_MOTION"),
        ("stop", {"deceleration": 1000.0, "jerk": 10000.0}, 0.15, "DECELERATING", "STOPPING"),
        ("", {}, 0.2, "INACTIVE", "STOPPING"),
    ]:
        if group:
            saw.give(group, **values)
        saw.run(duration)
        assert (saw.state.name, saw["plcopen_state"].name) == (state, plcopen)
        assert saw["state_code"] == int(saw.state)
        assert saw["coupled"] == (plcopen == "SYNCHRONIZED_MOTION")
        assert saw["in_sync"] == (state == "SYNCHRON")


def test_an_axis_may_start_in_motion() -> None:
    saw = FlyingSawHarness({"axis.initial_position": 3.0, "axis.initial_velocity": -2.0})
    assert (saw.state, saw["plcopen_state"]) == (State.CONSTANT_VELOCITY, PlcopenState.CONTINUOUS_MOTION)
    assert saw.slave == (3.0, -2.0, 0.0)
    assert saw.run(2.0).slave == (-1.0, -2.0, 0.0)


def test_at_the_master_s_velocity_already_it_is_in_sync_at_once() -> None:
    """There is nothing to synchronise: start and end of the profile are the same."""
    saw = FlyingSawHarness(
        {"axis.initial_position": 9.0, "axis.initial_velocity": 50.0}, master_position=4.0, speed=100.0
    )
    saw.give("gear_in_velo", ratio_denominator=2).run(0.1)
    assert (saw.results("gear_in_velo"), saw.state) == ({"start_sync", "in_sync"}, State.SYNCHRON)
    result = saw.block.characteristics
    assert (result.profile, result.master_velocity_nominal) == (ProfileKind.NONE, 100.0)
    assert (result.master_position_start, result.master_position_end) == (4.0, 4.0)
    assert (result.slave_position_start, result.slave_position_end) == (9.0, 9.0)
    assert (result.slave_position_min, result.slave_position_max) == (9.0, 9.0)
    assert (result.slave_velocity_start, result.slave_velocity_end, result.slave_velocity_mean) == (50.0, 50.0, 50.0)
    assert (result.slave_acceleration_start, result.slave_acceleration_effective, result.slave_jerk_max) == (
        0.0,
        0.0,
        0.0,
    )


def test_characteristic_values_stay_when_uncoupled_and_when_a_command_is_refused() -> None:
    saw = first_example().give("gear_in_pos", **FIRST).run(4.0).give("gear_out").run(1.0)
    before = saw.read(name for name in OUTPUTS if name.startswith("characteristics."))
    saw.release().run(INSTANT)
    assert_refused(saw, "gear_in_pos", 0x42DE, master_sync_position=-9e3)
    assert saw.read(before) == before
    assert before["characteristics.slave_velocity_max"] == pytest.approx(506.0, abs=5e-3)
