"""The Follower's oracle against numbers worked out by hand: positioning, alarms, parameters."""

from typing import Any

import pytest

from tests.model.follower.oracle_cases import (
    CYCLIC,
    DECEL,
    FOLLOWING,
    HOMING,
    IDLE,
    IN_ALARM,
    NEXT_CYCLE,
    PARK,
    POSITIONING,
    SYNCHRONIZED,
    VARIABLE,
    WAITING,
    at,
    close,
    motion,
    named,
    scenario,
    shown,
    steady,
    to_go,
)
from tests.oracle.follower import events, reference

# --- positioning ------------------------------------------------------------------------------------------------------

STANDING = [{"duration": 5.0, "velocity": 0.0}, {"duration": 10.0, "velocity": 100.0}]


def test_positioning_to_park() -> None:
    """1000 with 500, 5000, 50000: 2 + 0.1 + 0.1 s."""
    given = scenario(STANDING, PARK, slave__initial_position=1000.0)
    assert shown(given, 0.5 + 1.1) == (POSITIONING, 500.0)
    assert motion(at(given, 1.6)) == (close(500.0), close(-500.0), close(0.0))
    assert named(given, "at park") == [close(2.7)]
    assert shown(given, 3.0) == (WAITING, 0.0)
    assert at(given, 0.55)["slave.jerk"] == -50000.0


@pytest.mark.parametrize(("start", "moved"), [(350.0, 50.0), (150.0, -150.0), (200.0, 200.0), (-30.0, 30.0)])
def test_a_cyclic_slave_goes_to_the_nearest_turn_of_park(start: float, moved: float) -> None:
    given = scenario(STANDING, PARK, slave__initial_position=start, **CYCLIC)
    assert at(given, 0.0)["slave.position"] == start % 400
    row = at(given, 0.52)
    assert row["slave.jerk"] * moved > 0
    assert shown(given, 4.0) == (WAITING, 0.0)


def test_a_slave_at_park_needs_no_limits() -> None:
    limits = {f"positioning__{name}": 0.0 for name in ("velocity", "acceleration", "jerk")}
    assert at(scenario(STANDING, PARK, **limits), 0.6)["state"] == WAITING
    refused = at(scenario(STANDING, PARK, slave__initial_position=1.0, **limits), 0.6)
    assert (refused["state"], refused["error_id"], refused["error"]) == (IDLE, 1.0, 1.0)


def test_positioning_needs_a_standstill() -> None:
    """In following it is refused, and reset clears the error; with the master at rest it is accepted."""
    sets = {"at": 4.0, "position_to_cycle": True}, {"at": 4.5, "reset": True}
    given = steady(*sets)
    assert [at(given, t)["error_id"] for t in (4.0, 4.1, 4.6)] == [0.0, 1.0, 0.0]
    assert at(given, 4.1)["state"] == FOLLOWING
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 5.0, "velocity": 0.0}]
    stopped = scenario(segments, PARK, {"at": 4.2, "position_to_park": False}, {"at": 4.5, "position_to_park": True})
    assert at(stopped, 4.51)["state"] == POSITIONING
    assert shown(stopped, 6.0) == (NEXT_CYCLE, 0.0)


@pytest.mark.parametrize(
    ("position", "state", "slave"),
    [
        (250.0, WAITING, 0.0),
        (300.0, FOLLOWING, 0.0),
        (400.0, FOLLOWING, 18.75),
        (600.0, SYNCHRONIZED, 200.0),
        (700.0, DECEL, 300.0),
        (800.0, DECEL, 381.25),
        (1000.0, HOMING, 358.59375),
        (1350.0 - 4 * 1100.0, WAITING, 0.0),
    ],
)
def test_positioning_to_the_cycle(position: float, state: float, slave: float) -> None:
    """With a wait of 100 and a cycle of 1100 the homing ends at 1300, the next start is 1400."""
    command = {"at": 0.5, "position_to_cycle": True}
    options = {"master_cycle": 1100.0, "space_wait_in_park": 100.0}
    given = scenario(STANDING, command, position=position, slave__initial_position=50.0, **options)
    assert at(given, 0.52)["state"] == POSITIONING
    assert shown(given, 4.0) == (state, close(slave))
    assert at(given, 4.0)["cycle"] == 0.0
    never_stopped = scenario([{"duration": 24.0, "velocity": 100.0}], PARK, **options)
    later = 11.0 + ((position + 100.0) / 100 % 11.0)
    assert at(given, 6.0)["slave.position"] == close(at(never_stopped, later)["slave.position"])


@pytest.mark.parametrize(
    ("position", "state", "slave", "options"),
    [
        (925.0, FOLLOWING, 26.5625, {}),
        (775.0, HOMING, 373.4375, {}),
        (600.0, SYNCHRONIZED, 200.0, {}),
        (775.0, FOLLOWING, 364.6484375, {"stop_in_park": False}),
        (700.0, FOLLOWING, 300.0, {"stop_in_park": False}),
        (500.0, SYNCHRONIZED, 100.0, {"stop_in_park": False}),
    ],
)
def test_positioning_a_cyclic_slave_to_the_cycle(
    position: float, state: float, slave: float, options: dict[str, Any]
) -> None:
    """C = 500, everywhere as in every cycle; from 50 below, over the nearest turn."""
    command = {"at": 0.5, "position_to_cycle": True}
    options = {"master_cycle": 500.0, "slave__initial_position": slave - 50 + 800.0} | CYCLIC | options
    given = scenario(STANDING, command, position=position, **options)
    assert at(given, 0.52)["slave.velocity"] > 0
    assert shown(given, 4.0) == (state, close(slave))
    assert at(given, 5.0 + (1200.5 - position) / 100)["cycle"] == 1.0 + (position < 700)


def test_positioning_to_a_variable_cycle() -> None:
    command = {"at": 0.5, "position_to_cycle": True}
    assert shown(scenario(STANDING, command, position=600.0, **VARIABLE), 4.0) == (SYNCHRONIZED, 200.0)
    waiting = scenario(STANDING, command, position=0.0, **VARIABLE)
    assert named(waiting, "following") == [close(8.0)]
    late = scenario(STANDING, command, position=1350.0, **VARIABLE)
    assert (at(late, 4.0)["state"], named(late, "following")) == (WAITING, [])


def test_a_variable_cycle_without_a_value() -> None:
    """The value's cycle is over at 1300; with the master standing at 1350 there is none."""
    segments = [{"duration": 13.5, "velocity": 100.0}, {"duration": 3.0, "velocity": 0.0}]
    given = scenario(segments, PARK, {"at": 14.0, "position_to_cycle": True}, **VARIABLE)
    row = at(given, 14.1)
    assert (row["state"], row["error_id"]) == (WAITING, 1.0)


def test_an_interrupted_cycle_is_taken_up_again() -> None:
    """Alarm in following at 400 (the master stops at once), positioned elsewhere, then back to the cycle."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 6.0, "velocity": 0.0}, {"duration": 8.0}]
    segments[2]["velocity"] = 100.0
    sets = [{"at": 3.5, "max_speed": 40.0}, {"at": 4.5, "max_speed": 0.0, "reset": True}]
    sets.append({"at": 6.0, "position_to_cycle": True})
    for options in ({}, VARIABLE):
        given = scenario(segments, PARK, *sets, **options)
        assert named(given, "alarm 6")[0] < 4.0
        assert (at(given, 4.2)["state"], at(given, 5.0)["state"]) == (IN_ALARM, IDLE)
        assert shown(given, 8.0) == (FOLLOWING, 18.75)
        assert named(given, "synchronized") == [close(11.0)]


@pytest.mark.parametrize("velocity", [1.0, -1.0])
def test_the_master_must_stand_during_positioning_to_the_cycle(velocity: float) -> None:
    """1e-6 u at 1 u/s: 1 us into the movement at 0.6 s, with the velocity reached by then: 250, 5000."""
    segments = [{"duration": 0.6, "velocity": 0.0}, {"duration": 2.0, "velocity": velocity}]
    command = {"at": 0.5, "position_to_cycle": True}
    given = scenario(segments, command, position=250.0, slave__initial_position=500.0)
    assert named(given, "alarm 2") == [close(0.6 + 1e-6)]
    row = at(given, 0.62)
    assert (row["state"], row["error_id"], row["slave.acceleration"]) == (IN_ALARM, 2.0, 5000.0)
    speed = 250 + 5000e-6
    assert motion(at(given, 1.0))[0] == pytest.approx(500 - 25 / 3 - 250e-6 - speed**2 / 1e4, abs=1e-6)
    assert motion(at(given, 1.0))[1:] == (0.0, 0.0)
    to_park = scenario(segments, PARK, position=250.0, slave__initial_position=500.0)
    assert at(to_park, 2.0)["state"] == WAITING


# --- alarms -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sets", "options", "fault", "state"),
    [
        ([], {"max_speed": 90.0}, 6, FOLLOWING),
        ([{"at": 6.0, "max_speed": 90.0}], {}, 7, SYNCHRONIZED),
        ([{"at": 7.5, "max_speed": 50.0}], {}, 8, DECEL),
        ([], {"max_speed": 150.0}, 9, HOMING),
        ([], {"max_acceleration": 70.0}, 10, FOLLOWING),
        ([{"at": 7.3, "max_acceleration": 50.0}], {}, 12, DECEL),
        ([], {"max_acceleration": 100.0}, 13, HOMING),
    ],
)
def test_limits_of_each_phase(sets: list[dict[str, Any]], options: dict[str, Any], fault: int, state: float) -> None:
    given = steady(*sets, **options)
    (time,) = named(given, f"alarm {fault}")
    before, after = reference(given, [time])
    assert (before["state"], after["state"], after["error_id"]) == (state, IN_ALARM, fault)
    assert motion(before) == motion(after)
    previous = reference(given, [time - 0.01])[0]
    column, limit = ("slave.velocity", "max_speed") if fault < 10 else ("slave.acceleration", "max_acceleration")
    limits = [x[limit] for x in [options, *sets] if limit in x]
    assert abs(after[column]) > limits[0]
    assert abs(previous[column]) <= limits[0] or sets
    off = {"check_speed": False, "check_acceleration": False}
    assert not any("alarm" in name for _, name in events(steady(*sets, **options | off)))


def test_the_acceleration_while_synchronized() -> None:
    segments = [{"duration": 5.5, "velocity": 100.0}, {"duration": 1.0, "acceleration": 60.0}]
    given = scenario(segments, PARK, {"at": 5.2, "max_acceleration": 50.0})
    assert named(given, "alarm 11") == [close(5.51)]


@pytest.mark.parametrize(("step", "time"), [(0.01, 4.61), (0.1, 4.7)])
def test_limits_are_checked_at_the_ends_of_the_steps(step: float, time: float) -> None:
    """3u² - 2u³ > 0.9 from u = 0.8042, at 4.6084 s; the stop ramp is linear, with 1000."""
    given = steady(max_speed=90.0, max_acceleration=1000.0) | {"step_size": step}
    assert named(given, "alarm 6") == [close(time)]
    u = (time - 3) / 2
    speed = 100 * (3 * u**2 - 2 * u**3)
    position = 200 * (u**3 - u**4 / 2)
    row = at(given, time)
    assert motion(row) == (close(position), close(speed), close(3 * u * (1 - u) / 100 * 1e4))
    row = at(given, time + 0.05)
    assert motion(row) == (close(position + 0.05 * speed - 1.25), close(speed - 50), -1000.0)
    assert row["slave.jerk"] == 0.0
    assert motion(at(given, time + 0.2)) == (close(position + speed**2 / 2000), 0.0, 0.0)
    assert to_go(row) == [0.0, 0.0, 0.0]


def test_a_limit_exactly_reached_is_no_fault() -> None:
    assert not any("alarm" in name for _, name in events(steady(max_speed=187.5)))


def test_both_limits_at_once_are_the_fault_of_the_speed() -> None:
    """In homing: at 10 s the speed is 105, the acceleration 141."""
    given = steady({"at": 10.0, "max_speed": 1.0, "max_acceleration": 1.0})
    assert at(given, 10.02)["error_id"] == 9.0


def test_reset() -> None:
    """Ignored while the stop ramp lasts (2 s with 50); then idle until a new positioning."""
    sets = {"at": 5.5, "max_speed": 90.0, "max_acceleration": 50.0}, {"at": 6.0, "reset": True}
    more = (
        {"at": 7.0, "reset": False, "position_to_park": False, "max_speed": 0.0, "max_acceleration": 0.0},
        {"at": 9.0, "reset": True},
    )
    last = {"at": 9.5, "position_to_park": True}, {"at": 8.5, "position_to_cycle": True}
    given = steady(*sets, *more, *last)
    assert named(given, "alarm 7", "stopped") == [close(5.51), close(7.51)]
    row = at(given, 8.0)
    assert (row["state"], row["error_id"], *motion(row)) == (IN_ALARM, 7.0, close(151.0 + 100.0), 0.0, 0.0)
    assert at(given, 8.9)["error_id"] == 7.0
    row = at(given, 9.2)
    assert (row["state"], row["error"], row["error_id"]) == (IDLE, 0.0, 0.0)
    assert at(given, 9.6)["state"] == POSITIONING
    assert named(given, "following") == [close(3.0), close(13.0), close(23.0)]


@pytest.mark.parametrize(
    ("jump", "time"), [({"velocity": -50.0}, 6.0 + 1e-6 / 50), ({"acceleration": -100.0}, 7.0 + (2e-8) ** 0.5)]
)
def test_the_master_must_not_go_back(jump: dict[str, float], time: float) -> None:
    """More than 1e-6 below the largest value, there at rest: 600; or 650 after one second of braking."""
    given = scenario([{"duration": 6.0, "velocity": 100.0}, {"duration": 3.0, **jump}], PARK)
    assert named(given, "alarm 14") == [pytest.approx(time, rel=1e-9)]
    row = at(given, 8.0)
    assert (row["state"], row["error_id"]) == (IN_ALARM, 14.0)
    assert motion(row) == (close(200.0 if "velocity" in jump else 250.0), 0.0, 0.0)


def test_a_little_back_is_no_fall() -> None:
    """0.9e-6 back and on again: the largest value is used."""
    segments = [{"duration": 6.0, "velocity": 100.0}, {"duration": 0.5, "velocity": -1.8e-6}]
    given = scenario([*segments, {"duration": 3.0, "velocity": 100.0}], PARK)
    assert not any("alarm" in name for _, name in events(given))
    assert motion(at(given, 6.3)) == (close(200.0), 0.0, 0.0)
    assert named(given, "decel") == [close(6.5 + (100 + 0.9e-6) / 100)]


def test_at_park_the_master_may_go_back() -> None:
    """From 290 back to -750, past the start at -700: that one is then the next."""
    segments = [{"duration": 2.9, "velocity": 100.0}, {"duration": 10.4, "velocity": -100.0}]
    given = scenario([*segments, {"duration": 5.0, "velocity": 100.0}], PARK)
    assert named(given, "following") == [close(13.8)]
    assert to_go(at(given, 5.0))[0] == close(220.0)
    assert to_go(at(given, 13.0))[0] == close(20.0)


# --- parameters -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"sync_slave": 0.0}, 3),
        ({"sync_out": 100.0}, 3),
        ({"slave_cycle": 300.0}, 3),
        ({"k_slave_master": 0.0}, 4),
        ({"k_slave_master": -1.0}, 4),
        ({"master_cycle": 600.0}, 5),
        ({"master_cycle": 1000.0, "space_wait_in_park": 400.0}, 5),
        ({"slave_cycle": 400.0, "master_cycle": 200.0}, 5),
        ({"slave_cycle": 400.0, "master_cycle": 300.0, "space_wait_in_park": 100.0}, 5),
    ],
)
def test_parameters_with_which_no_cycle_runs(options: dict[str, Any], fault: int) -> None:
    with pytest.raises(ValueError, match=f"fault {fault} "):
        events(steady(**options))


@pytest.mark.parametrize(
    ("values", "fault", "time"),
    [
        ({"sync_out": 90.0}, 3, 3.0),
        ({"k_slave_master": 0.0}, 4, 1.0),
        ({"master_cycle": 600.0}, 5, 3.0),
        ({"space_wait_in_park": 400.0}, 5, 3.0),
    ],
)
def test_parameters_are_checked_when_a_cycle_starts(values: dict[str, Any], fault: int, time: float) -> None:
    given = steady({"at": 1.0, **values})
    assert named(given, f"alarm {fault}") == [close(time)]
    assert motion(at(given, time + 0.1)) == (0.0, 0.0, 0.0)


def test_a_wrong_script_is_refused() -> None:
    with pytest.raises(ValueError, match="never an edge"):
        events(steady({"at": 0.0, "reset": True}))
    with pytest.raises(ValueError, match="slave_cycle cannot be set"):
        events(steady({"at": 1.0, "slave_cycle": 300.0}))
