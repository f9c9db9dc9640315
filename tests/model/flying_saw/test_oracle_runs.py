"""Whole runs of the FlyingSaw's oracle to a position: synchronisation, start distance, periods and cuts."""

import math
from itertools import pairwise
from typing import Any

import pytest

from tests.model.flying_saw.oracle_cases import (
    CONSTANT_VELOCITY,
    CONTINUOUS_MOTION,
    MEET,
    MOVING,
    PREPHASE,
    SYNCHRON,
    SYNCHRONIZED_MOTION,
    SYNCHRONIZING,
    alone,
    at,
    close,
    example,
    motion,
    named,
    scenario,
    shows,
    steady,
    timed,
)
from tests.oracle import mp
from tests.oracle.flying_saw import events, reference
from tests.oracle.flying_saw_plan import (
    NONE,
)
from tests.oracle.master import stretches

# --- scenarios --------------------------------------------------------------------------------------------------------


def test_synchronisation_to_a_position_from_start_to_end() -> None:
    given = example({"at": 4.5, "gear_out__execute": True}, {"at": 5.0, "gear_in_pos__execute": False})
    early = at(given, 0.5)
    assert motion(early) == (-250.0, 250.0, 0.0)
    assert (early["state_code"], early["plcopen_state"]) == (CONSTANT_VELOCITY, CONTINUOUS_MOTION)
    assert (early["coupled"], early["coupling_factor"], shows(early, "gear_in_pos")) == (0.0, 0.0, set())
    assert early["characteristics.profile"] == 0.0
    middle = at(given, 2.3)  # master at 400: 0.6 of the way
    assert (middle["state_code"], middle["plcopen_state"]) == (SYNCHRONIZING, SYNCHRONIZED_MOTION)
    assert (middle["coupled"], middle["coupling_factor"], middle["in_sync"]) == (1.0, 1.0, 0.0)
    assert shows(middle, "gear_in_pos") == {"start_sync", "busy", "active"}
    assert middle["characteristics.slave_velocity_max"] == close(506.0)
    before, after = reference(given, [3.5])
    assert (before["state_code"], after["state_code"], after["in_sync"]) == (SYNCHRONIZING, SYNCHRON, 1.0)
    assert (before["slave.jerk"], after["slave.jerk"]) == (close(1000 / 9), 0.0)
    assert motion(after) == (1000.0, 500.0, 0.0)
    assert shows(after, "gear_in_pos") == {"start_sync", "in_sync"}
    assert at(given, 4.0)["slave.position"] == 1250.0
    aborted = at(given, 4.51)
    assert (shows(aborted, "gear_in_pos"), shows(aborted, "gear_out")) == ({"command_aborted"}, {"done"})
    assert motion(aborted) == (close(1505.0), 500.0, 0.0)
    assert (aborted["state_code"], aborted["plcopen_state"]) == (CONSTANT_VELOCITY, CONTINUOUS_MOTION)
    assert (aborted["coupled"], aborted["coupling_factor"]) == (0.0, 0.0)
    assert aborted["characteristics.slave_velocity_max"] == close(506.0)
    assert shows(at(given, 5.0), "gear_in_pos") == {"command_aborted"}
    assert shows(at(given, 5.01), "gear_in_pos") == set()


def test_a_set_shows_from_the_next_row_on_and_makes_no_second_row() -> None:
    given = example({"at": 4.0, "gear_out__execute": True})
    rows = reference(given, [0.5, 4.0])
    assert [(row["time"], row["state_code"]) for row in rows] == [(0.5, CONSTANT_VELOCITY), (4.0, SYNCHRON)]


def test_uncoupled_while_accelerating_the_slave_keeps_its_velocity() -> None:
    given = example({"at": 1.5, "gear_out__execute": True})
    before, after = at(given, 1.5), at(given, 2.0)
    assert before["slave.acceleration"] > 100.0
    assert after["slave.velocity"] == before["slave.velocity"]
    assert after["slave.acceleration"] == 0.0
    assert after["slave.position"] == close(before["slave.position"] + 0.5 * before["slave.velocity"])


def test_the_slave_follows_the_curve_of_a_master_that_changes_speed() -> None:
    """The position depends on the master's alone; velocity, acceleration and jerk are its derivatives."""
    segments = [{"duration": 1.5, "velocity": 500.0}, {"duration": 1.0, "acceleration": -300.0}]
    segments += [{"duration": 2.0, "acceleration": 0.0}, {"duration": 3.0, "acceleration": 400.0}]
    options = {"position": -750.0} | MOVING | MEET
    given = scenario(segments, {"at": 0.5, "gear_in_pos__execute": True}, **options)
    still = example()
    assert at(given, 2.5)["slave.position"] == close(at(still, 1.5 + 0.7)["slave.position"])  # master at 350
    assert at(given, 3.0)["slave.velocity"] == close(at(still, 2.4)["slave.velocity"] * 0.4)
    for time in (1.2, 2.1, 3.3, 5.1):
        early, row, late = (at(given, time + shift) for shift in (-1e-4, 0.0, 1e-4))
        for name, rate in (("position", "velocity"), ("velocity", "acceleration"), ("acceleration", "jerk")):
            difference = (late[f"slave.{name}"] - early[f"slave.{name}"]) / 2e-4
            assert difference == pytest.approx(row[f"slave.{rate}"], rel=1e-5, abs=1e-3)


# --- waiting, periods, cuts -------------------------------------------------------------------------------------------


def waiting(*sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """gear_in_pos at 0.5 s; it starts when the master passes 1000 - 800, at 1.9 s; meanwhile a move to 60."""
    move_ = {
        "at": 0.2,
        "move_absolute__execute": True,
        "move_absolute__position": 60.0,
        "move_absolute__velocity": 50.0,
    }
    options = {"position": -750.0, "gear_in_pos__master_start_distance": 800.0} | MEET | options
    return steady(500.0, 6.0, move_, {"at": 0.5, "gear_in_pos__execute": True}, *sets, **options)


def test_waiting_for_the_start_distance_the_own_motion_goes_on() -> None:
    given = waiting()
    row = at(given, 1.0)
    assert (row["state_code"], row["plcopen_state"], row["coupled"]) == (PREPHASE, SYNCHRONIZED_MOTION, 1.0)
    assert (shows(row, "gear_in_pos"), shows(row, "move_absolute")) == ({"busy", "active"}, {"command_aborted"})
    assert row["slave.velocity"] == 50.0
    assert motion(at(given, 1.89)) == (60.0, 0.0, 0.0)
    assert row["characteristics.profile"] == NONE
    started = at(given, 2.0)
    assert (started["state_code"], shows(started, "gear_in_pos")) == (SYNCHRONIZING, {"start_sync", "busy", "active"})
    assert started["characteristics.master_position_start"] == close(200.0)
    assert at(given, 4.0)["slave.position"] == close(1250.0)


def test_a_start_distance_already_passed_starts_at_once() -> None:
    given = waiting(gear_in_pos__master_start_distance=2000.0)
    assert at(given, 0.51)["state_code"] == SYNCHRONIZING
    refused = waiting(gear_in_pos__master_start_distance=-1.0)
    assert at(refused, 0.51)["gear_in_pos.error_id"] == 0x42DE
    assert shows(at(refused, 0.51), "move_absolute") == {"busy", "active"}


@pytest.mark.parametrize("group", ["gear_out", "halt", "stop"])
def test_waiting_ends_by_command(group: str) -> None:
    given = waiting({"at": 0.8, f"{group}__execute": True})
    row = at(given, 2.5)
    assert (row["coupled"], shows(row, "gear_in_pos")) == (0.0, {"command_aborted"})
    assert row["slave.velocity"] == (50.0 if group == "gear_out" else 0.0)


def test_a_start_refused_after_waiting_leaves_the_own_motion() -> None:
    given = waiting(gear_in_pos__slave_sync_position=50.0)
    assert shows(at(given, 1.5), "gear_in_pos") == {"busy", "active"}
    row = at(given, 2.0)
    assert (row["gear_in_pos.error_id"], row["error_id"], row["coupled"]) == (0x42DE, 0x42DE, 0.0)
    assert motion(row) == (60.0, 0.0, 0.0)


@pytest.mark.parametrize(("velocity", "travel"), [(100.0, 10.0), (-100.0, 330.0)])
def test_a_sync_position_within_the_period_is_the_next_one_ahead(velocity: float, travel: float) -> None:
    """The master at 360 or 340 at 0.1 s, 10 being meant: 370 forwards, 10 backwards."""
    slave = math.copysign(20.0, velocity)
    sync = {"gear_in_pos__master_sync_position": 10.0, "gear_in_pos__slave_sync_position": slave}
    given = steady(
        velocity, 4.0, {"at": 0.1, "gear_in_pos__execute": True}, position=710.0, master__period=360.0, **sync
    )
    assert named(given, "in sync") == [close(0.1 + travel / 100)]
    row = at(given, 0.15)
    assert row["characteristics.master_position_start"] == close(0.0 if velocity > 0 else 340.0)
    assert row["characteristics.master_position_end"] == close(10.0)
    assert at(given, 3.9)["slave.position"] == close(slave + math.copysign(380.0 - travel, velocity))


def test_a_sync_position_outside_the_period_is_meant_literally() -> None:
    sync = {"gear_in_pos__master_sync_position": 800.0, "gear_in_pos__slave_sync_position": 100.0}
    given = steady(100.0, 6.0, {"at": 0.1, "gear_in_pos__execute": True}, position=710.0, master__period=360.0, **sync)
    assert named(given, "in sync") == [close(0.1 + (800 - 360) / 100)]


def test_twenty_cuts_lie_one_length_apart() -> None:
    """Each synchronisation is commanded in the return travel; while in sync m - s = n·L. The master changes speed."""
    length, x, sets = 1000.0, 300.0, []
    for n in range(20):
        begin = 2.0 * n + 0.1
        sync = {"gear_in_pos__master_sync_position": n * length + x, "gear_in_pos__slave_sync_position": x}
        sets += [
            {"at": begin, "gear_in_pos__execute": True, "move_absolute__execute": False, "gear_out__execute": False}
            | sync,
            {"at": begin + 1.2, "gear_out__execute": True, "gear_in_pos__execute": False},
            {"at": begin + 1.25, "move_absolute__execute": True},
        ]
    segments = [{"duration": 20.0, "velocity": 500.0}, {"duration": 2.0, "acceleration": 20.0}]
    segments += [{"duration": 2.0, "acceleration": -20.0}, {"duration": 16.0, "velocity": 500.0}]
    given = scenario(segments, *sets, position=-200.0, axis__max_velocity=3000.0)
    rows = reference(given, [0.2 * i for i in range(200)])
    assert sum(after["in_sync"] > before["in_sync"] for before, after in pairwise(rows)) == 20
    master = stretches(given["master"], mp.mpf(40))
    for row in rows:
        if row["in_sync"]:
            position = next(s for s in reversed(master) if s.begin <= row["time"]).at(mp.mpf(row["time"])).position
            cuts = float(position - mp.mpf(row["slave.position"])) / length
            assert cuts == pytest.approx(round(cuts), abs=1e-12)


def test_a_wrong_script_is_refused() -> None:
    with pytest.raises(ValueError, match="never an edge"):
        events(alone(1.0, {"at": 0.0, "halt__execute": True}))
    with pytest.raises(ValueError, match="exekute"):
        events(alone(1.0, {"at": 0.5, "halt__exekute": True}))
    with pytest.raises(ValueError, match="constant in each segment"):
        events(timed([{"duration": 0.6, "velocity": 100.0}, {"duration": 1.0, "jerk": 100.0}]))
