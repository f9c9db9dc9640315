"""What ends a coupling: gear_out, and a gear-in command given anew."""

import pytest

from motionsync.flying_saw.interface import PlcopenState, State
from tests.model.flying_saw.harness import (
    INSTANT,
    OUTPUTS,
    FlyingSawHarness,
    coupled,
    moving,
    near,
    stopped_half,
    under_way,
)


def test_gear_out_takes_the_acceleration_away_at_once() -> None:
    saw = under_way()
    position, velocity, acceleration = saw.slave
    assert acceleration > 100.0
    saw.give("gear_out").run(0.5)
    assert saw.results("gear_out") == {"done"}
    assert (saw.state, saw["plcopen_state"]) == (State.CONSTANT_VELOCITY, PlcopenState.CONTINUOUS_MOTION)
    assert saw.slave == near(position + 0.5 * velocity, velocity, 0.0)
    assert saw.run(1000.0).slave == near(position + 1000.5 * velocity, velocity, 0.0)


@pytest.mark.parametrize("sync", [False, True])
@pytest.mark.parametrize("group", ["gear_out", "halt", "stop", "move_velocity", "move_absolute"])
def test_uncoupled_the_gear_in_block_shows_that_it_is_aborted(group: str, sync: bool) -> None:
    saw = FlyingSawHarness(speed=100.0).give("gear_in_velo", acceleration=1000.0).run(1.0 if sync else 0.1)
    assert saw.results("gear_in_velo") == ({"start_sync", "in_sync"} if sync else {"start_sync", "busy", "active"})
    before = saw.slave
    saw.give(group).run(INSTANT)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert (saw["coupled"], saw["in_sync"]) == (False, False)
    assert saw.slave[:2] == near(*before[:2], tolerance=2e-3)
    assert saw.slave[2] == (0.0 if group == "gear_out" else pytest.approx(before[2], abs=0.5))


def test_gear_out_of_an_uncoupled_axis_is_done_and_does_nothing() -> None:
    for begin in (FlyingSawHarness, moving, stopped_half):
        saw = begin()
        twin = saw.twin()
        saw.give("gear_out").run(0.01)
        twin.run(0.01)
        assert saw.results("gear_out") == {"done"}
        assert all(saw[name] == twin[name] for name in OUTPUTS if name != "gear_out.done")
        assert saw.run(1.0).results("gear_out") == {"done"}
        assert saw.release().run(INSTANT).results("gear_out") == set()


def test_a_gear_in_on_a_coupled_axis_plans_anew_from_the_present_motion() -> None:
    """The slave is in sync with 100; then it goes to twice the master's velocity in 1.5 * 100 / 1000 = 0.15 s."""
    saw = coupled()
    saw.give("gear_in_velo", ratio_numerator=2.0, acceleration=1000.0).run(0.075)
    assert saw.results("gear_in_velo") == {"start_sync", "busy", "active"}
    assert saw.slave[1:] == near(150.0, 1000.0)
    assert saw["coupling_factor"] == 2.0
    position, _, _ = saw.run(0.075 + INSTANT).slave
    assert saw.slave[1:] == near(200.0, 0.0)
    saw.give("gear_in_pos", master_sync_position=saw.master_position + 100.0, slave_sync_position=position + 150.0)
    saw.run(1.0 + INSTANT)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
    assert saw.slave == near(position + 150.0 + 100.0 * INSTANT, 100.0, 0.0)
