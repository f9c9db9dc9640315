"""Motions of the axis itself in runs of the FlyingSaw's oracle, and PLCopen's rules for the outputs."""

import pytest

from tests.model.flying_saw.oracle_cases import (
    ACCELERATING,
    CONSTANT_VELOCITY,
    CONTINUOUS_MOTION,
    DECELERATING,
    DISCRETE_MOTION,
    INACTIVE,
    STANDSTILL,
    STOPPING,
    alone,
    at,
    close,
    example,
    motion,
    named,
    shows,
)


def test_move_absolute_from_rest() -> None:
    given = alone(12.0, {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 1000.0})
    assert named(given, "move_absolute done") == [close(10.8)]
    speeding, cruising, slowing, done = (at(given, time) for time in (0.5, 5.0, 10.5, 11.0))
    assert [row["state_code"] for row in (speeding, cruising, slowing, done)] == [
        ACCELERATING,
        CONSTANT_VELOCITY,
        DECELERATING,
        INACTIVE,
    ]
    assert cruising["slave.velocity"] == 100.0
    assert [row["plcopen_state"] for row in (speeding, done)] == [DISCRETE_MOTION, STANDSTILL]
    assert (shows(slowing, "move_absolute"), shows(done, "move_absolute")) == ({"busy", "active"}, {"done"})
    assert motion(done) == (1000.0, 0.0, 0.0)


def test_a_result_after_the_falling_edge_shows_for_one_step() -> None:
    """From 0.105 s, over 2 in 0.4 s."""
    sets = {"at": 0.105, "move_absolute__execute": True, "move_absolute__position": 2.0}
    given = alone(1.0, sets, {"at": 0.2, "move_absolute__execute": False})
    result = [shows(at(given, time), "move_absolute") for time in (0.3, 0.5, 0.51, 0.52)]
    assert result == [{"busy", "active"}, {"busy", "active"}, {"done"}, set()]
    coarse = given | {"step_size": 0.05}
    assert [shows(at(coarse, time), "move_absolute") for time in (0.5, 0.55, 0.6)] == [
        {"busy", "active"},
        {"done"},
        set(),
    ]


def test_simultaneous_edges_act_in_their_order() -> None:
    sets = {"at": 0.5, "move_velocity__execute": True, "move_velocity__velocity": 50.0, "halt__execute": True}
    given = alone(2.0, sets, axis__initial_velocity=30.0)
    row = at(given, 1.5)
    assert (shows(row, "halt"), shows(row, "move_velocity")) == ({"command_aborted"}, {"in_velocity"})
    assert named(given, "halt accepted") == named(given, "move_velocity accepted") == [0.5]


def test_in_velocity_turns_into_command_aborted_and_done_does_not() -> None:
    sets = (
        {"at": 0.1, "move_velocity__execute": True, "move_velocity__velocity": -50.0},
        {"at": 2.0, "halt__execute": True},
        {"at": 4.0, "move_absolute__execute": True},
    )
    given = alone(5.0, *sets)
    assert shows(at(given, 0.3), "move_velocity") == {"busy", "active"}
    assert at(given, 0.3)["plcopen_state"] == CONTINUOUS_MOTION
    assert shows(at(given, 1.0), "move_velocity") == {"in_velocity"}
    assert at(given, 1.0)["slave.velocity"] == -50.0
    halting = at(given, 2.1)
    assert (shows(halting, "move_velocity"), shows(halting, "halt")) == ({"command_aborted"}, {"busy", "active"})
    assert (halting["state_code"], halting["plcopen_state"]) == (DECELERATING, DISCRETE_MOTION)
    assert shows(at(given, 3.0), "halt") == {"done"}
    assert shows(at(given, 4.1), "halt") == {"done"}


def test_an_abortion_after_the_falling_edge_shows_for_one_step() -> None:
    sets = (
        {"at": 0.1, "move_velocity__execute": True, "move_velocity__velocity": 50.0},
        {"at": 1.0, "move_velocity__execute": False},
        {"at": 2.0, "halt__execute": True},
    )
    given = alone(3.0, *sets)
    result = [shows(at(given, time), "move_velocity") for time in (1.0, 1.01, 2.0, 2.01, 2.02)]
    assert result == [{"in_velocity"}, set(), set(), {"command_aborted"}, set()]
    together = alone(3.0, sets[0], {"at": 2.0, "halt__execute": True, "move_velocity__execute": False})
    result = [shows(at(together, time), "move_velocity") for time in (2.0, 2.01, 2.02)]
    assert result == [{"in_velocity"}, {"command_aborted"}, set()]


def test_a_velocity_of_zero_is_standstill() -> None:
    given = alone(3.0, {"at": 0.1, "move_velocity__execute": True}, axis__initial_velocity=30.0)
    row = at(given, 2.0)
    assert (row["plcopen_state"], row["state_code"], shows(row, "move_velocity")) == (
        STANDSTILL,
        INACTIVE,
        {"in_velocity"},
    )


def test_stop_locks_until_standstill_and_until_execute_falls() -> None:
    sets = (
        {"at": 1.0, "stop__execute": True, "halt__execute": True},
        {"at": 1.1, "move_absolute__execute": True, "reset__execute": True},
        {"at": 2.5, "gear_out__execute": True},
        {"at": 3.0, "stop__execute": False, "move_absolute__execute": False},
        {"at": 3.5, "move_absolute__execute": True, "move_absolute__position": 100.0},
    )
    given = alone(5.0, *sets, axis__initial_velocity=100.0)
    locked = at(given, 1.01)
    assert (shows(locked, "stop"), shows(locked, "halt")) == ({"busy", "active"}, {"error"})
    assert (locked["halt.error_id"], locked["error_id"], locked["error"]) == (0x42EF, 0x42EF, 1.0)
    assert named(given, "reset done") == [1.1]
    assert at(given, 1.2)["move_absolute.error_id"] == 0x42EF
    assert named(given, "stop done") == [close(1.7)]
    still = at(given, 2.0)
    assert (still["plcopen_state"], still["state_code"], shows(still, "stop")) == (STOPPING, INACTIVE, {"done"})
    assert shows(at(given, 2.6), "gear_out") == {"error"}
    free = at(given, 3.01)
    assert (free["plcopen_state"], shows(free, "stop"), free["error_id"]) == (STANDSTILL, set(), 0x42EF)
    assert (at(given, 3.6)["plcopen_state"], at(given, 3.6)["error"]) == (DISCRETE_MOTION, 0.0)


def test_a_stop_whose_execute_has_fallen_unlocks_at_standstill() -> None:
    sets = ({"at": 1.005, "stop__execute": True}, {"at": 1.2, "stop__execute": False})
    given = alone(3.0, *sets, axis__initial_velocity=100.0)
    assert [at(given, time)["plcopen_state"] for time in (1.5, 1.7, 1.71)] == [STOPPING, STOPPING, STANDSTILL]
    assert [shows(at(given, time), "stop") for time in (1.7, 1.71, 1.72)] == [{"busy", "active"}, {"done"}, set()]


def test_a_second_stop_edge_is_accepted() -> None:
    sets = (
        {"at": 1.0, "stop__execute": True, "stop__deceleration": 10.0},
        {"at": 1.5, "stop__execute": False},
        {"at": 2.0, "stop__execute": True, "stop__deceleration": 400.0},
    )
    given = alone(3.0, *sets, axis__initial_velocity=100.0)
    assert at(given, 2.9)["state_code"] == INACTIVE
    assert shows(at(given, 2.9), "stop") == {"done"}


@pytest.mark.parametrize(
    ("group", "values_", "error"),
    [
        ("move_velocity", {"velocity": 100.1}, 0x42DD),
        ("move_velocity", {"velocity": 50.0, "acceleration": -1.0}, 0x42DD),
        ("move_absolute", {"position": -1001.0}, 0x4372),
        ("move_absolute", {"position": 1001.0}, 0x4373),
        ("move_absolute", {"position": 1001.0, "jerk": -1.0}, 0x42DD),
        ("halt", {"deceleration": -1.0}, 0x42DD),
        ("stop", {"jerk": -1.0}, 0x42DD),
        ("gear_in_velo", {"ratio_denominator": 0}, 0x425B),
        ("gear_in_velo", {"ratio_numerator": 0.0, "velocity": -1.0}, 0x425B),
        ("gear_in_velo", {"velocity": -1.0}, 0x42DD),
        ("gear_in_velo", {}, 0x424A),
        ("gear_in_pos", {"master_start_distance": -1.0}, 0x426E),
    ],
)
def test_a_refused_command_leaves_the_slave_alone(group: str, values_: dict[str, float], error: int) -> None:
    inputs = {f"{group}__{name}": value for name, value in values_.items()} | {f"{group}__execute": True}
    sets = ({"at": 1.0, **inputs}, {"at": 2.0, f"{group}__execute": False}, {"at": 3.0, "reset__execute": True})
    limits = {"axis__min_position": -1000.0, "axis__max_position": 1000.0}
    given = alone(4.0, *sets, axis__initial_velocity=30.0, **limits)
    row, later = at(given, 1.5), at(given, 2.5)
    assert motion(row) == (close(45.0), 30.0, 0.0)
    assert (row[f"{group}.error_id"], row["error_id"], shows(row, group)) == (error, error, {"error"})
    assert (later[f"{group}.error_id"], later["error_id"], shows(later, group)) == (0.0, error, set())
    assert (at(given, 3.5)["error"], shows(at(given, 3.5), "reset")) == (0.0, {"done"})


def test_a_refused_command_does_not_abort_and_an_accepted_one_clears_the_error() -> None:
    sets = (
        {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 500.0},
        {"at": 1.0, "move_velocity__execute": True, "move_velocity__velocity": 1e6},
        {"at": 2.0, "gear_out__execute": True},
    )
    given = alone(8.0, *sets)
    assert shows(at(given, 1.5), "move_absolute") == {"busy", "active"}
    assert [at(given, time)["error"] for time in (1.5, 2.5)] == [1.0, 0.0]
    assert at(given, 7.0)["slave.position"] == 500.0


def test_a_command_refused_in_the_block_of_a_running_one_leaves_it_without_a_block() -> None:
    sets = (
        {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 100.0},
        {"at": 0.2, "move_absolute__execute": False},
        {"at": 0.3, "move_absolute__execute": True, "move_absolute__position": 1e10},
        {"at": 0.5, "move_absolute__execute": False},
    )
    given = alone(4.0, *sets)
    assert shows(at(given, 0.4), "move_absolute") == {"error"}
    assert shows(at(given, 0.6), "move_absolute") == set()
    assert at(given, 3.0)["slave.position"] == 100.0
    assert named(given, "move_absolute done") == []


def test_own_commands_uncouple_and_start_from_the_present_motion() -> None:
    given = example({"at": 2.0, "halt__execute": True, "halt__deceleration": 1000.0, "halt__jerk": 10000.0})
    before, after = at(given, 2.0), at(given, 2.0 + 1e-6)
    for name in ("position", "velocity", "acceleration"):
        assert after[f"slave.{name}"] == pytest.approx(before[f"slave.{name}"], abs=0.02)
    assert after["slave.jerk"] == -10000.0
    assert (after["coupled"], after["plcopen_state"]) == (0.0, DISCRETE_MOTION)
    assert (shows(after, "gear_in_pos"), shows(after, "halt")) == ({"command_aborted"}, {"busy", "active"})
    assert at(given, 3.5)["plcopen_state"] == STANDSTILL
