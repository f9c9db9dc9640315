"""Slaves that turn: whatever is compared, cut or followed does not see where a turn ends."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.cutting import CutSpec
from motionsync_fmu.scenario.evaluate.cuts import find_cuts
from motionsync_fmu.scenario.evaluate.expectations import check_expectations
from motionsync_fmu.scenario.evaluate.reference_comparison import compare_with_reference
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Reals, Recording, unwrapped
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import AtTime, Scenario
from motionsync_fmu.scenario.servo import Servo
from tests import ROOT
from tests.oracle.measured_line.servo import Servo as Oracle

ROTARY = [name for name in BLOCKS if Recipe(name).variables["slave.position"].period]
MOST_POINTS = 1200  # of a run that the oracle follows, which computes with many digits
GEARED = """\
title = "A slave that turns"
fmu = "Gearing"
stop_time = 4.0
step_size = 0.25
[start]
"slave.period" = 360.0
start = true
[master]
velocity = 90.0
"""


def turning_scenarios(block: str) -> Iterator[Scenario]:
    """The shipped scenarios of a block whose slaves are wrapped."""
    for file in sorted((ROOT / "scenarios" / block).glob("*/scenario.toml")):
        scenario = load_scenario(file)
        if scenario.slave_period:
            yield scenario


@pytest.mark.all_blocks
def test_each_block_whose_slave_turns_declares_its_period() -> None:
    """A wrapped position jumps back again and again; one without a period does so once, by a command, at most."""
    assert {"Follower", "Gearing", "RotaryKnife", "Synchronizer"} <= {*ROTARY}
    for block in BLOCKS:
        for file in (ROOT / "scenarios" / block).glob("*/scenario.toml"):
            scenario = load_scenario(file)
            if scenario.slave_period or scenario.stop_time / scenario.step_size > MOST_POINTS:
                continue
            recording = run_in_process(scenario, scenario.step_size)
            position = recording.values["slave.position"]
            span = float(np.ptp(position))
            assert np.count_nonzero(np.abs(np.diff(position)) > 0.5 * max(span, 1e-9)) <= 1, scenario.label


def test_a_servo_follows_a_slave_that_turns_as_one_that_does_not() -> None:
    """The oracle of the servo follows the setpoint without turns, which NumPy unwraps: in a step it goes by less than
    half a turn."""
    servo, oracle = Servo(50.0, 0.003, 0.9, 0.002), Oracle(50.0, 0.003, 0.9, 0.002)
    used = Counter[str]()
    for scenario in chain.from_iterable(map(turning_scenarios, ROTARY)):
        block = scenario.recipe.name
        if scenario.stop_time / scenario.step_size > MOST_POINTS or used[block] > 1:
            continue
        recording = run_in_process(replace(scenario, servo=servo), scenario.step_size)
        time, velocity = recording.time, recording.values["slave.velocity"]
        if np.abs(velocity).max() * np.diff(time).max() > 0.4 * scenario.slave_period:
            continue
        straight = np.unwrap(recording.values["slave.position"], period=scenario.slave_period)
        if np.ptp(straight - recording.values["slave.position"]) < 0.5 * scenario.slave_period:
            continue  # it passes no end of a turn
        used[block] += 1
        exact, *_ = oracle.run(time.tolist(), straight.tolist(), velocity.tolist())
        error = straight - np.array([float(x) for x in exact])
        assert np.abs(error).max() < 0.5 * scenario.slave_period
        np.testing.assert_allclose(recording.computed["actual.slave.following_error"], error, rtol=0, atol=1e-7)
    assert {"Follower", "Gearing", "RotaryKnife", "Synchronizer"} <= {*used}


@pytest.mark.parametrize("turn", [360.0, 6.283185307179586, 1.0])
@pytest.mark.parametrize("blades", [1, 3])
def test_the_servo_of_a_knife_sees_no_jump_at_a_turn(turn: float, blades: int) -> None:
    """Pieces of a blade's share of the circumference: the knife turns evenly by V = turn v / circumference. A servo
    with full feedforward and a dead time T lags by V T once it has settled, at the ends of turns, too."""
    file = ROOT / "scenarios/RotaryKnife/formats/scenario.toml"
    scenario = load_scenario(file)
    start = dict(scenario.start) | {
        "length": 600.0 / blades,
        "knife.blades": blades,
        "knife.turn": turn,
        "knife.park_angle": turn / blades / 2.0,
        "auto_start": True,
    }
    start |= {f"axis.max_{of}": 1e9 for of in ("velocity", "acceleration", "jerk")}
    even = replace(scenario, start=start, settings=(), expectations=(), servo=Servo(50.0, 0.003, 1.0, 0.004))
    recording = run_in_process(even, 0.01)
    settled = recording.time > 4.0
    lag = turn * 1000.0 / 600.0 * 0.004
    np.testing.assert_allclose(recording.computed["actual.slave.following_error"][settled], lag, rtol=1e-6)


@given(
    st.floats(0.1, 1000.0),
    st.floats(-3.0, 3.0),
    st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=30),
)
def test_positions_are_unwrapped_whatever_the_velocity(period: float, start: float, steps: list[float]) -> None:
    """A motion of constant acceleration in each step, up to several turns a step."""
    velocity = period * np.cumsum([0.0, *(2.0 * s for s in steps)])
    time = np.arange(len(velocity), dtype=float)
    travel = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))])
    straight = period * start + travel
    shown = unwrapped(time, straight % period, velocity, period)
    np.testing.assert_allclose(shown - shown[0], straight - straight[0], rtol=0, atol=1e-9 * period)


# --- compared ---------------------------------------------------------------------------------------------------------


def geared(folder: Path, extra: str = "") -> Scenario:
    (folder / "scenario.toml").write_text(GEARED + extra)
    return load_scenario(folder / "scenario.toml")


def recording_at(positions: Reals) -> Recording:
    """A slave at these positions, at 0, 1, 2 ... s."""
    n = len(positions)
    values = {"slave.position": np.array(positions), "slave.velocity": np.zeros(n)}
    return Recording(np.arange(n, dtype=float), values, np.zeros((n, 4)), [])


@pytest.mark.parametrize(
    ("expected", "actual", "passes"),
    [(0.0, 359.99999, True), (359.99999, 0.0, True), (0.0, 359.9, False), (180.0, 0.0, False), (720.0, 0.0, True)],
)
def test_a_value_is_expected_within_a_turn(expected: float, actual: float, passes: bool, tmp_path: Path) -> None:
    scenario = replace(geared(tmp_path), expectations=(AtTime(1.0, {"slave.position": expected}, 1e-4),))
    (check,) = check_expectations(scenario, recording_at(np.array([0.0, actual, 0.0])))
    assert check.passed == passes


@pytest.mark.parametrize(
    ("actual", "greatest"),
    [(0.0, 0.0), (360.0 - 1e-7, 1e-7), (1e-7, 1e-7), (180.0, 180.0), (90.0, 90.0), (300.0, 60.0)],
)
def test_the_end_of_a_turn_in_a_reference_is_no_jump(actual: float, greatest: float, tmp_path: Path) -> None:
    """At 1 s the reference has 360 before the end of a turn and 0 after it: not each value in between agrees."""
    scenario = geared(tmp_path)
    (tmp_path / "Gearing_ref.csv").write_text('"time","slave.position"\n0,270\n1,360\n1,0\n2,90\n')
    (deviation,) = compare_with_reference(scenario, recording_at(np.array([270.0, actual, 90.0])))
    assert deviation.greatest == pytest.approx(greatest, abs=1e-9)


@pytest.mark.parametrize("ratio", [1.0, -1.0, 0.5])
@pytest.mark.parametrize("turns", [0, 3])
def test_a_cut_across_the_end_of_a_turn_is_one_place(ratio: float, turns: int) -> None:
    """The tool turns once a mark, period = |ratio| length, and is 0.25 behind: it passes 0 while it cuts."""
    length, time = 40.0, np.arange(9.0)
    master = np.zeros((9, 4))
    master[:, 0], master[:, 1] = turns * length + np.linspace(-8.0, 8.0, 9), 2.0
    period = abs(ratio) * length
    values = {
        "slave.position": ratio * (master[:, 0] - turns * length - 0.25) % period,
        "slave.velocity": np.full(9, 2.0 * ratio),
        "in_sync": np.ones(9),
    }
    (cut,) = find_cuts(CutSpec("in_sync", length, 0.0, ratio, 0.1, None), Recording(time, values, master, []), period)
    assert (cut.mark, cut.error) == (turns * length, pytest.approx(0.25))
