"""PLCopen's rules for the function blocks: edges, results, several commands."""

from motionsync.flying_saw.interface import State
from tests.model.flying_saw.harness import (
    AIMS,
    FIRST,
    GROUPS,
    INSTANT,
    OUTPUTS,
    FlyingSawHarness,
    assert_refused,
    first_example,
    moving,
    near,
    under_way,
)


def test_simultaneous_edges_act_in_the_documented_order() -> None:
    """The last command, move_absolute, moves the axis; the ones before it are aborted, and gear_out is done."""
    saw = FlyingSawHarness({"axis.initial_velocity": 50.0}, speed=100.0)
    saw.give("halt").give("gear_out").give("gear_in_velo").give("gear_in_pos", **AIMS)
    saw.give("move_velocity", velocity=3.0).give("move_absolute", position=9.0).run(INSTANT)
    shown = {group: saw.results(group) - {"start_sync"} for group in GROUPS}
    assert shown.pop("move_absolute") == {"busy", "active"}
    assert shown.pop("gear_out") == {"done"}
    assert shown.pop("stop") == shown.pop("reset") == set()
    assert all(value == {"command_aborted"} for value in shown.values())
    assert saw.run(2.0).slave == (9.0, 0.0, 0.0)


def test_a_stop_together_with_others_refuses_them() -> None:
    saw = (
        FlyingSawHarness({"axis.initial_velocity": 50.0}, speed=100.0)
        .give("reset")
        .give("stop")
        .give("halt")
        .give("gear_out")
    )
    saw.give("gear_in_velo").give("move_absolute", position=9.0).run(INSTANT)
    assert (saw.results("stop"), saw.results("reset")) == ({"busy", "active"}, {"done"})
    for group in ("halt", "gear_out", "gear_in_velo", "move_absolute"):
        assert (saw.results(group), saw[f"{group}.error_id"]) == ({"error"}, 0x42EF)
    assert saw["error_id"] == 0x42EF


def test_the_first_value_seen_is_no_edge() -> None:
    values = {f"{group}.execute": True for group in GROUPS}
    saw = FlyingSawHarness({"axis.initial_velocity": 50.0, **values}, speed=100.0).run(1.0)
    assert all(saw.results(group) == set() for group in GROUPS)
    assert saw.slave == near(50.0, 50.0, 0.0)


def test_a_result_after_the_falling_edge_is_shown_for_one_step() -> None:
    for group, values, result in [
        ("gear_in_velo", {"acceleration": 1000.0}, "in_sync"),
        ("gear_in_pos", AIMS, "in_sync"),
        ("halt", {}, "done"),
        ("move_velocity", {"velocity": 7.0}, "in_velocity"),
        ("move_absolute", {"position": 7.0}, "done"),
    ]:
        saw = FlyingSawHarness({"axis.initial_velocity": 50.0}, speed=100.0).give(group, **values).run(0.001)
        saw.release().run(0.001)
        assert saw.results(group) - {"start_sync"} == {"busy", "active"}, group
        saw.run(20.0)
        assert saw.results(group) - {"start_sync"} == {result}, group
        saw.run(INSTANT)
        assert saw.results(group) - {"start_sync"} == set(), group


def test_an_abortion_after_the_falling_edge_is_shown_for_one_step() -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 50.0}).give("move_absolute", position=700.0).run(0.1)
    saw.release().run(0.1).give("halt").run(0.01)
    assert saw.results("move_absolute") == {"command_aborted"}
    assert saw.run(0.01).results("move_absolute") == set()


def test_done_and_error_stay_but_in_sync_and_in_velocity_are_aborted() -> None:
    saw = (
        FlyingSawHarness(speed=100.0)
        .give("move_absolute", position=1.0)
        .run(1.0)
        .give("gear_in_velo", acceleration=1e3)
        .run(1.0)
    )
    assert saw.results("move_absolute") == {"done"}
    saw.give("move_velocity", velocity=-1.0).run(1.0)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert saw.results("move_velocity") == {"in_velocity"}
    saw.give("gear_in_pos", **(AIMS | {"slave_sync_position": -1e6})).run(INSTANT)
    assert (saw.results("gear_in_pos"), saw.results("move_velocity")) == ({"error"}, {"in_velocity"})
    saw.give("halt").run(1.0)
    assert (saw.results("gear_in_pos"), saw.results("move_velocity")) == ({"error"}, {"command_aborted"})
    assert (saw.results("move_absolute"), saw.results("halt")) == ({"done"}, {"done"})


def test_errors_last_until_reset_or_the_next_accepted_command() -> None:
    saw = assert_refused(moving(), "gear_in_velo", 0x425B, ratio_numerator=0.0)
    assert_refused(saw, "move_velocity", 0x42DD, velocity=1e9)
    reset = saw.twin().give("reset").run(INSTANT)
    assert (reset["error"], reset["error_id"], reset.results("reset")) == (False, 0, {"done"})
    assert reset.run(INSTANT).results("reset") == {"done"}
    assert reset.release().run(INSTANT).results("reset") == set()
    saw.give("move_velocity", velocity=5.0).run(INSTANT)
    assert (saw["error"], saw["error_id"]) == (False, 0)


def test_reset_aborts_nothing() -> None:
    saw = under_way()
    twin = saw.twin().run(0.01)
    saw.give("reset").run(0.01)
    assert all(saw[name] == twin[name] for name in OUTPUTS if name != "reset.done")


def test_sync_mode_and_values_are_read_at_the_edge() -> None:
    saw = first_example().give("gear_in_pos", **FIRST).run(1.0).modes("check_max_acceleration", "rollback_lock")
    saw.set({"gear_in_pos.slave_sync_position": 0.0, "gear_in_pos.ratio_numerator": 7.0, "gear_in_pos.velocity": 1.0})
    saw.run(3.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(1500.0, 500.0, 0.0))
