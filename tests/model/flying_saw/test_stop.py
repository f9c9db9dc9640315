"""stop: to rest, and the lock."""

from typing import Any

import pytest

from motionsync.flying_saw.interface import PlcopenState, State
from tests.model.flying_saw.harness import INSTANT, FlyingSawHarness, assert_refused, near


def stopping(**values: Any) -> FlyingSawHarness:
    """A stop from 100 with 1000 and 10000 takes 0.2 s and 10 u: a triangle."""
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0, **values}, speed=100.0)
    return saw.give("stop", deceleration=1000.0, jerk=10000.0)


def test_stop_leads_to_rest_and_locks_until_execute_is_false() -> None:
    saw = stopping().run(0.1)
    assert (saw.state, saw["plcopen_state"]) == (State.DECELERATING, PlcopenState.STOPPING)
    assert saw.results("stop") == {"busy", "active"}
    assert saw.slave == near(100.0 * 0.1 - 10000.0 * 0.1**3 / 6.0, 50.0, -1000.0)
    saw.run(0.1 + INSTANT)
    assert saw.slave == near(10.0, 0.0, 0.0)
    assert saw.results("stop") == {"done"}
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STOPPING)
    saw.run(5.0)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)
    assert_refused(saw, "move_absolute", 0x42EF, position=5.0)
    saw.release("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == (set(), PlcopenState.STANDSTILL)
    assert saw.give("move_absolute", position=5.0).run(1.0).slave == (5.0, 0.0, 0.0)


def test_the_lock_lasts_until_standstill_though_execute_is_false() -> None:
    saw = stopping().run(0.05).release("stop").run(0.05)
    assert saw.results("stop") == {"busy", "active"}
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    assert_refused(saw, "halt", 0x42EF)
    saw.run(0.2 - saw.time - INSTANT)
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    saw.run(2 * INSTANT)
    assert saw.results("stop") == {"done"}  # for exactly this step
    assert saw["plcopen_state"] == PlcopenState.STANDSTILL
    saw.run(INSTANT)
    assert saw.results("stop") == set()
    assert saw.give("move_velocity", velocity=1.0).run(INSTANT).results("move_velocity") >= {"busy"}


def test_execute_that_falls_with_another_command_s_edge_releases_it() -> None:
    saw = stopping().run(1.0).release("stop").give("move_absolute", position=7.0).run(1.0)
    assert saw.slave == (7.0, 0.0, 0.0)


def test_reset_does_not_release_the_lock_but_clears_the_error() -> None:
    saw = assert_refused(stopping().run(0.05), "halt", 0x42EF).give("reset").run(INSTANT)
    assert (saw["error"], saw["error_id"], saw.results("reset")) == (False, 0, {"done"})
    assert_refused(saw, "halt", 0x42EF)


def test_a_second_stop_edge_is_accepted() -> None:
    """The second stop is gentler: after 0.1 s with the jerk 10000 the slave has 50 and -1000, and goes on with 200."""
    saw = stopping().run(0.1).release("stop").run(INSTANT).give("stop", deceleration=2000.0, jerk=1e6).run(INSTANT)
    assert saw.results("stop") == {"busy", "active"}
    saw.run(0.06)
    assert saw.slave[1:] == (0.0, 0.0)
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    saw.release("stop").run(INSTANT).give("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)


def test_a_stop_at_standstill_is_done_and_locks() -> None:
    saw = FlyingSawHarness().give("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)
    assert_refused(saw, "gear_in_velo", 0x42EF)


@pytest.mark.parametrize("group", ["gear_in_velo", "move_velocity", "halt", "move_absolute"])
def test_stop_aborts_what_runs(group: str) -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 50.0}, speed=100.0)
    saw.give(group, **({"velocity": 30.0} if group == "move_velocity" else {})).run(0.005)
    assert saw.results(group) >= {"busy"}
    saw.give("stop").run(INSTANT)
    assert saw.results(group) == {"command_aborted"}
