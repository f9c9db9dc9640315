"""Couplings to a velocity in runs of the FlyingSaw's oracle: the master's reversal, and profiles in time."""

from itertools import pairwise
from typing import Any

import pytest

from tests.model.flying_saw.oracle_cases import (
    AXIS,
    INACTIVE,
    PREPHASE,
    STANDSTILL,
    SYNCHRON,
    SYNCHRONIZED_MOTION,
    SYNCHRONIZING,
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
from tests.oracle.flying_saw import reference
from tests.oracle.flying_saw_plan import (
    JERK_LIMITED,
    NONE,
)

# --- coupling to a velocity -------------------------------------------------------------------------------------------


def test_gear_in_velo_of_two_standing_axes_is_in_sync_at_once() -> None:
    segments = [{"duration": 1.0, "velocity": 0.0}, {"duration": 1.0, "acceleration": 100.0}]
    sets = {"at": 0.5, "gear_in_velo__execute": True}
    options = {"gear_in_velo__ratio_numerator": 3.0, "gear_in_velo__ratio_denominator": 2}
    given = scenario(segments, sets, **AXIS | options, axis__initial_position=5.0)
    row = at(given, 0.51)
    assert (row["state_code"], row["in_sync"], row["coupling_factor"]) == (SYNCHRON, 1.0, 1.5)
    assert shows(row, "gear_in_velo") == {"start_sync", "in_sync"}
    assert row["characteristics.profile"] == NONE
    assert motion(at(given, 1.5)) == (close(5.0 + 12.5 * 1.5), close(75.0), close(150.0))


def test_the_diagonal_saw_is_faster_by_the_cosine() -> None:
    given = steady(100.0, 2.0, {"at": 0.5, "gear_in_velo__execute": True}, diagonal_angle=60.0)
    row = at(given, 1.5)
    assert (row["coupling_factor"], row["slave.velocity"]) == (close(2.0), close(200.0))


TURN = [
    {"duration": 1.0, "velocity": 100.0},
    {"duration": 2.0, "velocity": -100.0},
    {"duration": 2.0, "velocity": 100.0},
]


def reversing(acceleration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """gear_in_velo at 0.5 s (master at 50) from 20 u/s; up to 100 at 1 s, through 50 at 1.5 s and, after 3 s, 4.5 s.

    The ramp takes 1.5·80/acceleration.
    """
    limits = {"gear_in_velo__acceleration": acceleration, "gear_in_velo__deceleration": 100.0}
    given = {"axis__initial_velocity": 20.0, "axis__max_jerk": 1e9} | limits | options
    return scenario(TURN, {"at": 0.5, "gear_in_velo__execute": True}, *sets, **given)


LOCK, INSTANT = {"sync_mode__rollback_lock": True}, {"sync_mode__instant_stop_on_rollback": True}


@pytest.mark.parametrize("bits", [{}, INSTANT])
def test_without_the_lock_a_synchronous_slave_runs_back(bits: dict[str, bool]) -> None:
    """Cases 1 and 4: in sync after 0.3 s (master at 80, slave at 10 + 18)."""
    given = reversing(400.0, **bits)
    assert named(given, "in sync") == [close(0.8)]
    for time, position in ((1.4, 60.0), (2.5, -50.0), (4.9, 90.0)):
        assert motion(at(given, time)) == (close(28.0 + position - 80.0), -100.0 if time < 3 else 100.0, 0.0)
        assert at(given, time)["state_code"] == SYNCHRON


@pytest.mark.parametrize("lock", [{}, LOCK])
def test_before_sync_a_reversal_halts_smoothly(lock: dict[str, bool]) -> None:
    """Case 2 and 5: through 50 the slave has -20; T = 1.5·20/100 = 0.3 s, 3 further back."""
    given = reversing(100.0, **lock)
    back = at(given, 1.4)
    assert (back["state_code"], back["slave.velocity"] < 0) == (SYNCHRONIZING, True)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(10.0), close(-20.0), close(0.0))
    assert (before["state_code"], after["state_code"]) == (SYNCHRONIZING, PREPHASE)
    halting = at(given, 1.65)
    assert motion(halting) == (close(10 - 6 * 13 / 32), close(-10.0), close(100.0))
    assert shows(halting, "gear_in_velo") == {"busy", "active"}
    assert (halting["coupled"], halting["plcopen_state"], halting["in_sync"]) == (1.0, SYNCHRONIZED_MOTION, 0.0)
    parked = at(given, 2.5)
    assert motion(parked) == (close(7.0), 0.0, 0.0)
    assert (parked["state_code"], shows(parked, "gear_in_velo")) == (PREPHASE, {"busy", "active"})
    again = at(given, 4.6)
    assert (again["state_code"], shows(again, "gear_in_velo")) == (SYNCHRONIZING, {"start_sync", "busy", "active"})
    assert again["characteristics.master_position_start"] == close(50.0)
    assert again["characteristics.slave_position_start"] == close(7.0)
    assert again["characteristics.slave_velocity_start"] == 0.0


@pytest.mark.parametrize("lock", [{}, LOCK])
def test_before_sync_a_reversal_stops_at_once(lock: dict[str, bool]) -> None:
    """Cases 3 and 7."""
    given = reversing(100.0, **lock, **INSTANT)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(10.0), close(-20.0), close(0.0))
    assert motion(after) == (close(10.0), 0.0, 0.0)
    assert after["state_code"] == PREPHASE


def test_the_backstop_halts_a_synchronous_slave() -> None:
    """Case 6: at 1.5 s the slave is at 28 - 30 with -100; T = 1.5 s, 75 further back; again at 4.5 s."""
    given = reversing(400.0, **LOCK)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(-2.0), -100.0, 0.0)
    assert (before["state_code"], after["state_code"], after["in_sync"]) == (SYNCHRON, PREPHASE, 0.0)
    assert shows(after, "gear_in_velo") == {"busy", "active"}
    assert motion(at(given, 2.25)) == (close(-2 - 75 * 13 / 16), close(-50.0), close(100.0))
    assert motion(at(given, 3.2)) == (close(-77.0), 0.0, 0.0)
    assert named(given, "in sync") == [close(0.8), close(4.5 + 1.5 * 100 / 400)]
    assert shows(at(given, 4.95), "gear_in_velo") == {"start_sync", "in_sync"}


def test_the_backstop_stops_a_synchronous_slave_at_once() -> None:
    """Case 8."""
    given = reversing(400.0, **LOCK, **INSTANT)
    assert motion(reference(given, [1.5])[1]) == (close(-2.0), 0.0, 0.0)
    assert motion(at(given, 4.0)) == (close(-2.0), 0.0, 0.0)


def test_a_master_that_turns_round_early_is_followed_out_of_the_halt() -> None:
    """Forwards through 50 again at 1.7 s, in the halt of 1.5 s."""
    segments = [{"duration": 1.0, "velocity": 100.0}, {"duration": 0.6, "velocity": -100.0}]
    segments.append({"duration": 2.0, "velocity": 100.0})
    given = reversing(400.0, **LOCK)
    given["master"]["segments"] = segments
    before, after = reference(given, [1.7])
    assert (before["state_code"], after["state_code"]) == (PREPHASE, SYNCHRONIZING)
    assert -100.0 < after["slave.velocity"] < 0.0
    for index, name in enumerate(("position", "velocity", "acceleration")):
        assert motion(after)[index] == close(motion(before)[index])
        assert after[f"characteristics.slave_{name}_start"] == close(motion(before)[index])


def test_a_refused_new_start_leaves_the_slave_standing() -> None:
    """In sync with the factor 2 below 500 u/s; parked, the master comes back with 300 u/s: 600."""
    segments = [
        {"duration": 2.0, "velocity": 100.0},
        {"duration": 3.0, "velocity": -100.0},
        {"duration": 3.0, "velocity": 300.0},
    ]
    limits = {"gear_in_pos__velocity": 500.0, "sync_mode__check_max_velocity": True, "axis__max_deceleration": 1000.0}
    options = {"gear_in_pos__ratio_numerator": 2.0, "gear_in_pos__master_sync_position": 100.0}
    options |= {"gear_in_pos__slave_sync_position": 100.0, **limits, **LOCK}
    given = scenario(
        segments, {"at": 0.5, "gear_in_pos__execute": True}, {"at": 3.0, "gear_in_pos__execute": False}, **options
    )
    assert named(given, "parked") == [close(3.5)]
    assert named(given, "gear_in_pos refused 0x42dd") == [close(5 + 150 / 300)]
    parked, refused = at(given, 5.3), at(given, 5.51)
    assert (parked["state_code"], refused["state_code"], refused["plcopen_state"]) == (PREPHASE, INACTIVE, STANDSTILL)
    assert (refused["error_id"], refused["coupled"]) == (0x42DD, 0.0)
    shown = [(shows(row, "gear_in_pos"), row["gear_in_pos.error_id"]) for row in (at(given, 5.5), at(given, 5.52))]
    assert shown[1] == (set(), 0.0)
    assert shows(at(given, 5.45), "gear_in_pos") == {"busy", "active"}


def test_a_coupling_is_planned_anew_from_the_present_motion() -> None:
    sets = {"at": 2.0, "gear_in_velo__execute": True, "gear_in_velo__ratio_numerator": 0.5}
    given = example(sets, gear_in_velo__acceleration=500.0, gear_in_velo__deceleration=500.0)
    before, after = at(given, 2.0), at(given, 2.01)
    assert after["characteristics.slave_position_start"] == close(before["slave.position"])
    assert after["characteristics.slave_acceleration_start"] == close(before["slave.acceleration"])
    assert (shows(after, "gear_in_pos"), after["state_code"]) == ({"command_aborted"}, SYNCHRONIZING)
    late = at(given, 5.9)
    assert (late["state_code"], late["slave.velocity"], late["coupling_factor"]) == (SYNCHRON, 250.0, 0.5)


# --- time based -------------------------------------------------------------------------------------------------------


def test_time_based_at_constant_velocity() -> None:
    """0 to 200 with 500 and 5000: 0.4 + 0.1 s over 50; the master then at 100 + 100."""
    given = timed([{"duration": 3.0, "velocity": 200.0}])
    assert named(given, "in sync") == [close(1.0)]
    assert motion(reference(given, [1.0])[1]) == (close(50.0), 200.0, 0.0)
    assert at(given, 2.0)["slave.position"] == close(250.0)
    assert at(given, 0.8)["characteristics.profile"] == JERK_LIMITED
    assert at(given, 0.8)["characteristics.master_position_end"] == close(200.0)


def test_time_based_catches_up_with_an_accelerating_master() -> None:
    given = timed([{"duration": 0.6, "velocity": 100.0}, {"duration": 2.4, "acceleration": 100.0}, {"duration": 3.0}])
    synchronous = named(given, "in sync")
    assert len(synchronous) == 1
    rows = reference(given, [0.5 + 0.01 * i for i in range(300)])
    assert max(row["slave.acceleration"] for row in rows) <= 500.0 + 1e-9
    assert 0.8 < synchronous[0] < 1.2
    late = at(given, synchronous[0] + 0.01)
    assert (late["slave.acceleration"], late["state_code"]) == (100.0, SYNCHRON)
    for before, after in pairwise(rows):
        step = after["time"] - before["time"]
        mean = (before["slave.velocity"] + after["slave.velocity"]) / 2
        assert after["slave.position"] - before["slave.position"] == pytest.approx(mean * step, abs=5000 * step**3)
        assert abs(after["slave.velocity"] - before["slave.velocity"]) <= 500.0 * step + 1e-9
    early, late = at(given, 0.6 - 1e-7), at(given, 0.6 + 1e-7)
    assert late["slave.acceleration"] == pytest.approx(early["slave.acceleration"], abs=1e-2)


def test_time_based_starts_anew_where_the_master_jumps() -> None:
    given = timed([{"duration": 0.7, "velocity": 200.0}, {"duration": 3.0, "velocity": -50.0}])
    before, after = at(given, 0.7), at(given, 0.7 + 1e-7)
    assert motion(after) == pytest.approx(motion(before), rel=1e-5)
    assert at(given, 3.0)["slave.velocity"] == -50.0
    assert len(named(given, "in sync")) == 1


def test_a_target_beyond_the_velocity_limit_is_waited_for() -> None:
    """The master rises from 100 at 0.6 s to 300 and falls again: beyond 150 from 0.85 s to 2.35 s."""
    segments = [{"duration": 0.6, "velocity": 100.0}, {"duration": 1.0, "acceleration": 200.0}]
    segments += [{"duration": 1.2, "acceleration": -200.0}, {"duration": 1.0}]
    given = timed(segments, gear_in_velo__velocity=150.0, gear_in_velo__acceleration=250.0)
    beyond = at(given, 2.3)
    assert (beyond["slave.velocity"], beyond["slave.acceleration"], beyond["state_code"]) == (150.0, 0.0, SYNCHRONIZING)
    assert max(row["slave.velocity"] for row in reference(given, [0.02 * i for i in range(190)])) <= 150.0 + 1e-9
    synchronous = named(given, "in sync")
    assert len(synchronous) == 1
    assert synchronous[0] > 2.35
    row = at(given, 3.7)
    assert (row["slave.velocity"], row["state_code"]) == (close(60.0), SYNCHRON)
