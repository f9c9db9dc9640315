"""Synchronizer, Gearing and Follower on measured lines: in sync the setpoint is the law of the path; states do not
flicker, on a line at rest either."""

from typing import Any

import numpy as np
import pytest

from motionsync.follower.faults import Fault
from motionsync.follower.interface import State
from motionsync.gearing.interface import StartMode, StopMode, Transition
from motionsync.gearing.interface import State as GearingState
from motionsync_fmu.batch.simulation import BatchResult, simulate_many
from tests.measured.lines import MEASURED, SEEDS, STEP, Reals, changes, halting, noisy, times

NOISE = 0.05
TIMES = times(8.0)
VELOCITY, DECELERATION = 200.0, 400.0
NARROW = np.linspace(-0.1, 0.1, SEEDS)[:, None]  # around a place where something happens
END = VELOCITY * (TIMES[-1] - 3.0 - VELOCITY / DECELERATION)  # of a line that halts for 3 s


def halt(rests: Any) -> Reals:
    return halting(np.broadcast_to(rests, (SEEDS, 1)), VELOCITY, DECELERATION, 3.0, TIMES)


def from_step(n: int) -> Reals:
    """A command that is given in step n."""
    return (np.arange(TIMES.size) >= n).astype(float)


def simulate(block: str, line: Reals, outputs: list[str], inputs: dict[str, Any], start: dict[str, Any]) -> BatchResult:
    names = ["master.smoothed_position", "slave.position", *outputs]
    start = {**MEASURED, "master.velocity": VELOCITY, **dict.fromkeys(inputs, False), **start}
    result = simulate_many(block, STEP, {"master.position": noisy(line, NOISE), **inputs}, names, start=start)
    assert not result.failures
    return result


def largest_jump(result: BatchResult) -> float:
    """Of the setpoint's position, less what its greatest velocity takes it on in a step."""
    return float(np.abs(np.diff(result["slave.position"], axis=1)).max()) - 1.1 * VELOCITY * STEP


# --- Synchronizer -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rests", [200.0 + NARROW, 300.0 + 1e3 * NARROW])
def test_a_synchronizer_ramps_once_each_way(rests: Reals) -> None:
    """It stops to rest at 300 over a ramp, with a line that halts where the ramp begins, or anywhere near it."""
    result = simulate(
        "Synchronizer",
        halt(rests),
        ["state", "syn_ramp_on", "syn_synchronized"],
        {"stop": from_step(100)},
        {"output_phasing": 100.0, "rest_value": 300.0},
    )
    assert (changes(result["state"]) == 2).all()
    assert (changes(result["syn_ramp_on"]) == 2).all()
    assert (changes(result["syn_synchronized"]) == 1).all()
    in_sync = result["syn_synchronized"] > 0.0
    np.testing.assert_array_equal(result["slave.position"][in_sync], result["master.smoothed_position"][in_sync])
    assert largest_jump(result) < 0.0
    assert (result["slave.position"][:, -1] == 300.0).all()


# --- Gearing ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("transition", [Transition.MASTER_BASED, Transition.TIME_BASED])
@pytest.mark.parametrize("rests", [250.0 + NARROW, 350.0 + NARROW, 300.0 + 2e3 * NARROW])
def test_a_gearing_engages_and_disengages_once(rests: Reals, transition: Transition) -> None:
    """It engages between 250 and 350, and is in gear from there on; the line halts at either end, or in between."""
    result = simulate(
        "Gearing",
        halt(rests),
        ["state", "in_gear", "local.line_offset"],
        {"start": from_step(1)},
        {
            "gearing.numerator": 3,
            "gearing.denominator": 2,
            "gear_in.start_mode": StartMode.WITH_CW_REFERENCE_POSITION,
            "gear_in.transition": transition,
            "gear_in.reference_position": 300.0,
        },
    )
    at_once = transition == Transition.TIME_BASED
    assert changes(result["state"]).max() == (2 if at_once else 3)
    assert (changes(result["in_gear"]) == 1).all()
    in_gear = result["in_gear"] > 0.0
    geared = 1.5 * result["master.smoothed_position"] + result["local.line_offset"]
    np.testing.assert_allclose(result["slave.position"][in_gear], geared[in_gear], atol=1e-9)


@pytest.mark.parametrize(("direction", "start_mode"), [(1, "CW_DIRECT"), (1, "CW_CCW_DIRECT"), (-1, "CW_CCW_DIRECT")])
def test_a_gearing_engages_directly_from_a_line_at_rest(direction: int, start_mode: str) -> None:
    """Whichever way noise goes first, it gets in gear; it falls back once at most."""
    line = direction * (halt(300.0) - 300.0)
    result = simulate(
        "Gearing",
        line,
        ["state", "in_gear"],
        {"start": from_step(3000)},
        {"gear_in.start_mode": start_mode, "gear_in.distance": 100.0, "master.velocity": direction * VELOCITY},
    )
    assert changes(result["state"]).max() <= 5
    assert (changes(result["in_gear"]) == 1).all()
    assert (result["state"][:, -1] == GearingState.ACTIVE).all()


def test_a_gearing_disengages_once() -> None:
    """On a line that halts where the transition to rest begins."""
    result = simulate(
        "Gearing",
        halt(450.3 + 3.0 * NARROW),
        ["state", "in_gear"],
        {"start": from_step(1) - from_step(1600)},
        {
            "gear_in.transition": Transition.NONE,
            "gear_in.start_mode": StartMode.CW_DIRECT,
            "gear_out.stop_mode": StopMode.WITH_CW_STOP_POSITION,
            "gear_out.stop_position": 500.0,
        },
    )
    assert (changes(result["in_gear"]) == 2).all()
    assert changes(result["state"]).max() <= 4
    assert largest_jump(result) < 0.0


# --- Follower ---------------------------------------------------------------------------------------------------------

LINEAR = {
    "master_cycle": 1000.0,
    "sync_slave": 100.0,
    "sync_out": 300.0,
    "space_stop_slave": 100.0,
    "positioning.velocity": 500.0,
    "positioning.acceleration": 2000.0,
    "positioning.jerk": 1e5,
}
CYCLIC = {**LINEAR, "slave_cycle": 600.0, "stop_in_park": False, "master_cycle": 900.0}
PHASES = [800.0 + NARROW, 1000.0 + NARROW, 1200.0 + NARROW, 1400.0 + NARROW, 1300.0 + 5e3 * NARROW]


@pytest.mark.parametrize("rests", PHASES, ids=["start", "meeting", "sync_out", "end of the stroke", "anywhere"])
@pytest.mark.parametrize("cycle", [LINEAR, CYCLIC], ids=["linear", "cyclic"])
def test_a_follower_goes_through_its_cycle_once(rests: Reals, cycle: dict[str, Any]) -> None:
    """No alarm, no state twice, no jump, where the line halts at the ends of cam sections or anywhere; 300 mm/s."""
    line = 1.5 * halt(rests / 1.5)
    result = simulate(
        "Follower", line, ["state", "error_id"], {"position_to_park": from_step(1)}, {**cycle, "master.velocity": 300.0}
    )
    assert not result["error_id"].any()
    ideal = simulate_many(
        "Follower",
        STEP,
        {"master.position": line, "position_to_park": from_step(1)},
        "state",
        start={"master.input_mode": "POSITION_ONLY", "position_to_park": False, **cycle},
    )
    np.testing.assert_array_equal(changes(result["state"]), changes(ideal["state"]))
    if "slave_cycle" not in cycle:
        in_sync = result["state"] == State.M_SYNCHRONIZED
        beyond = (result["master.smoothed_position"] - result["slave.position"])[in_sync]
        np.testing.assert_allclose(beyond, np.round(beyond / 1000.0) * 1000.0 - 100.0, atol=1e-9)
        assert (
            np.abs(np.diff(result["slave.position"], axis=1)).max() < 1.05 * 1.875 * 300.0 * STEP
        )  # the way home's quintic


def test_a_follower_is_positioned_on_a_line_at_rest() -> None:
    """From rest to the cycle, in sync 50 behind the meeting, and from there to its park; the noise is no motion of the
    line that would be an alarm, nor one of the slave that would refuse the positioning."""
    result = simulate(
        "Follower",
        np.broadcast_to(1050.0, (SEEDS, TIMES.size)),
        ["state", "error_id", "slave.velocity"],
        {"position_to_cycle": from_step(500), "position_to_park": from_step(4000)},
        {**LINEAR, "master.velocity": 0.0},
    )
    assert not result["error_id"].any()
    assert (result["state"][:, 3999] == State.M_SYNCHRONIZED).all()
    np.testing.assert_allclose(
        result["slave.position"][:, 3999], result["master.smoothed_position"][:, 3999] - 900.0, atol=1e-9
    )
    assert (result["state"][:, 4000] == State.M_POSITIONING).all()
    assert (result["state"][:, -1] == State.M_WAITING).all()
    assert not result["slave.position"][:, -1].any()
    leaves = np.diff(result["slave.position"], axis=1)[:, 3990:4010]
    assert np.abs(leaves).max() < 0.02


@pytest.mark.parametrize("speed", [100.0, 20.0])
def test_a_line_that_really_goes_back_is_an_alarm(speed: float) -> None:
    """Once it is back by more than 3 times 21 ms of its highest speed, and the slave brakes from where it is."""
    forward = np.minimum(300.0 * TIMES, 1100.0)
    line = forward - speed * np.maximum(TIMES - 4.0, 0.0)
    result = simulate(
        "Follower",
        np.broadcast_to(line, (SEEDS, TIMES.size)),
        ["state", "error_id"],
        {"position_to_park": from_step(1)},
        {**LINEAR, "master.velocity": 300.0},
    )
    assert (result["error_id"][:, -1] == Fault.MASTER_BACKWARDS).all()
    assert not result["error_id"][:, :4000].any()
    alarms = np.argmax(result["error_id"] > 0, axis=1)
    highest = result["master.smoothed_position"].max(axis=1)
    back = highest - result["master.smoothed_position"][np.arange(SEEDS), alarms]
    least = 3.0 * 0.021 * 300.0
    assert back.min() >= least
    assert back.max() < 1.2 * least + speed * STEP
    assert np.abs(np.diff(result["slave.position"], axis=1)).max() < 1.05 * 1.875 * 300.0 * STEP
