"""The motion behind a servo: against the oracle, in closed form, and as columns of runs in Python and compiled code."""

import csv
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.evaluate.csv_files import write_outputs
from motionsync_fmu.scenario.evaluate.expectations import check_expectations
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Reals
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.servo import CHUNK, Servo
from tests import ROOT
from tests.oracle.measured_line.servo import Servo as Oracle
from tests.support.scenarios.recordings import assert_as_in_python
from tests.support.scenarios.scenario_texts import EVEN_RAMP, FREE_SAW, check_mistake, write_scenario

SERVO = "[servo]\nposition_gain = 50.0\nvelocity_time_constant = 0.003\ndead_time = 0.002\n"
SERVOS = {
    "two real roots": Servo(50.0, 0.003, 1.0, 0.002),
    "conjugate roots": Servo(50.0, 0.02, 0.5, 0.0137),
    "a double root": Servo(50.0, 0.005, 0.9),
    "nearly a double root": Servo(50.0, 0.005 * (1.0 + 1e-12), 1.0, 0.001),
    "first order": Servo(50.0, 0.0, 0.8, 0.0037),
    "first order at once": Servo(200.0),
    "faster than the step": Servo(50.0, 1e-6, 1.0, 0.0005),
    "as slow as the run": Servo(5.0, 0.2, 0.0, 0.01),
    "dead for longer than the run": Servo(50.0, 0.003, 1.0, 10.0),
}


def swing(time: Reals) -> tuple[Reals, Reals]:
    """Positions and velocities of a setpoint that is already moving when it begins."""
    return 300.0 * np.sin(7.0 * time) + 1000.0 * time + 500.0, 2100.0 * np.cos(7.0 * time) + 1000.0


def uneven_times(points: int) -> Reals:
    """Steps of 1 ms, and pairs of steps as scans make them: all but a 128th of 1 ms, and that 128th."""
    steps = np.full(points - 1, 1e-3)
    steps[100:160:2], steps[101:161:2] = 1e-3 * 127.0 / 128.0, 1e-3 / 128.0
    return np.concatenate([[0.0], np.cumsum(steps)])


def greatest_difference(values: Reals, exact: list[Any]) -> float:
    return max(abs(float(b - a)) for a, b in zip(values.tolist(), exact, strict=True))


@pytest.mark.parametrize("servo", SERVOS.values(), ids=SERVOS)
def test_the_motion_is_that_of_the_oracle(servo: Servo) -> None:
    time = uneven_times(300)
    position, velocity = swing(time)
    actual = servo.follow(time, position, velocity)
    oracle = Oracle(servo.position_gain, servo.velocity_time_constant, servo.feedforward, servo.dead_time)
    p, v, a = oracle.run(time.tolist(), position.tolist(), velocity.tolist())
    assert greatest_difference(actual.position, p) <= 1e-11 * 1000.0
    assert greatest_difference(actual.velocity, v) <= 1e-12 * 3100.0 / max(1e-3, servo.velocity_time_constant)
    assert greatest_difference(actual.acceleration, a) <= 1e-9 * max(map(abs, a))


@pytest.mark.parametrize("servo", [Servo(50.0, 0.003, 0.7, 0.002), Servo(50.0, 0.02), Servo(50.0, 0.0, 0.5)])
def test_a_long_motion_is_computed_in_parts_that_join(servo: Servo) -> None:
    """Of an axis that starts at rest the first part is that of a shorter motion; and a late start changes nothing
    but the times: at the end the same motion comes out of other parts."""
    time = np.arange(2 * CHUNK + 10) * 1e-3
    position, velocity = swing(time)
    whole = servo.follow(time, position, velocity)
    short = servo.follow(time[:500], position[:500], velocity[:500])
    np.testing.assert_allclose(whole.position[:500], short.position, rtol=0, atol=1e-10)
    wait = np.arange(777) * 1e-3
    rest = np.full(777, position[0])
    late = servo.follow(
        np.concatenate([wait, time + 0.777]),
        np.concatenate([rest, position]),
        np.concatenate([np.zeros(777), velocity]),
    )
    np.testing.assert_allclose(late.position[777 + 2000 :], whole.position[2000:], rtol=0, atol=1e-9)
    np.testing.assert_allclose(late.velocity[777 + 2000 :], whole.velocity[2000:], rtol=0, atol=1e-7)


def test_the_lag_at_constant_velocity_and_at_constant_acceleration() -> None:
    """V (dead_time + (1 - feedforward)/Kv), and a Tv/Kv with full feedforward."""
    time = np.arange(2000) * 1e-3
    v = np.full(2000, 500.0)
    lag = (500.0 * time - Servo(50.0, 0.003, 0.9, 0.002).follow(time, 500.0 * time, v).position)[-1]
    assert lag == pytest.approx(500.0 * (0.002 + 0.1 / 50.0), abs=1e-9)
    s = 500.0 * time * time
    assert (s - Servo(50.0, 0.003).follow(time, s, 1000.0 * time).position)[-1] == pytest.approx(0.06, abs=1e-9)


def test_very_short_steps_do_no_harm() -> None:
    """There the difference of two positions is rounding, and so would be the acceleration of a cubic."""
    time = np.arange(0.0, 0.5, 1e-3)
    position, velocity = swing(time)
    plain = Servo(50.0, 0.003).follow(time, position, velocity)
    doubled = np.sort(np.concatenate([time, time[1:-1] + 2e-12]))
    position, velocity = swing(doubled)
    short = Servo(50.0, 0.003).follow(doubled, position, velocity)
    np.testing.assert_allclose(short.position[1:-1:2], plain.position[1:-1], rtol=0, atol=1e-8)
    np.testing.assert_allclose(short.acceleration[1:-1:2], plain.acceleration[1:-1], rtol=0, atol=1e-2)


# --- in runs ----------------------------------------------------------------------------------------------------------


def scenario(folder: Path, text: str) -> Scenario:
    return load_scenario(write_scenario(text, folder))


def test_runs_in_python_and_in_compiled_code_have_the_same_columns(tmp_path: Path) -> None:
    load = "[load]\nmass = 120.0\nfriction = 150.0\n"
    for tables in (SERVO, SERVO + load, load):
        recording = assert_as_in_python(scenario(tmp_path, EVEN_RAMP + tables)).recording
        assert recording
        assert ("actual.slave.position" in recording.computed) == ("[servo]" in tables)
        assert ("load.force" in recording.computed) == ("[load]" in tables)


def test_the_saw_in_sync_lags_by_the_dead_time(tmp_path: Path) -> None:
    s = scenario(tmp_path, EVEN_RAMP + SERVO)
    assert s.servo == Servo(50.0, 0.003, 1.0, 0.002)
    recording = assert_as_in_python(s).recording
    assert recording
    assert recording.computed["actual.slave.following_error"][-1] == pytest.approx(500.0 * 0.002, abs=1e-6)
    setpoint = recording.values["slave.position"]
    oracle = Oracle(50.0, 0.003, 1.0, 0.002)
    exact, v, _ = oracle.run(recording.time.tolist(), setpoint.tolist(), recording.values["slave.velocity"].tolist())
    assert greatest_difference(recording.computed["actual.slave.position"], exact) <= 1e-9
    assert greatest_difference(recording.computed["actual.slave.velocity"], v) <= 1e-7


def test_a_wrapped_slave_is_unwrapped() -> None:
    wrapped = replace(
        load_scenario(ROOT / "scenarios/Gearing/rotary_axes/scenario.toml"), servo=Servo(50.0, 0.003, 1.0, 0.002)
    )
    start = {name: value for name, value in wrapped.start.items() if name != "slave.period"}
    turning = assert_as_in_python(wrapped).recording
    straight = assert_as_in_python(replace(wrapped, start=start)).recording
    assert turning
    assert straight
    assert np.ptp(turning.values["slave.position"]) < wrapped.slave_period < np.ptp(straight.values["slave.position"])
    for name, values in straight.computed.items():
        np.testing.assert_allclose(turning.computed[name], values, rtol=0, atol=1e-8)


def test_columns_can_be_expected(tmp_path: Path) -> None:
    expected = """
[[expect]]
at = 1.0
"actual.slave.following_error" = 1.0
tolerance = 1e-6
[[expect]]
when = "actual.slave.position > 100"
time = 0.75
[[expect]]
from = 0.0
to = 1.0
"actual.slave.velocity" = { max = 400.0 }
"""
    s = scenario(tmp_path, EVEN_RAMP + SERVO + expected)
    recording = assert_as_in_python(s).recording
    assert recording
    position = recording.computed["actual.slave.position"]
    first = recording.time[np.argmax(position > 100.0)]
    timed, when, within = check_expectations(s, recording)
    assert timed.passed
    assert when.actual == f"{first:.10g} s"
    assert not within.passed
    assert within.expected.startswith("actual.slave.velocity")


def test_without_a_table_there_is_no_such_column(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r":\d+: actual.slave.velocity: FlyingSaw has no variable"):
        scenario(tmp_path, FREE_SAW + '[[expect]]\nat = 1.0\n"actual.slave.velocity" = 1.0\n')


def test_the_columns_are_in_the_file_of_results(tmp_path: Path) -> None:
    s = scenario(tmp_path, FREE_SAW + SERVO + "[load]\nmass = 2.0\n")
    out = io.StringIO()
    write_outputs(out, s, run_in_process(s, s.step_size))
    header, *rows = csv.reader(io.StringIO(out.getvalue()))
    table = dict(zip(header, np.array(rows, float).T, strict=True))
    lag = table["actual.slave.following_error"]
    np.testing.assert_array_equal(lag, table["slave.position"] - table["actual.slave.position"])
    assert lag[-1] == pytest.approx(0.2, abs=1e-6)
    power = table["load.force"] * table["actual.slave.velocity"] / 1000.0
    np.testing.assert_allclose(table["load.power"], power, rtol=1e-12, atol=1e-15)


MISTAKES = {
    "an unknown key": ("position_gain = 50.0\ngain = 3.0", "gain", "unknown key"),
    "no gain": ("dead_time = 0.1", "position_gain", "is missing"),
    "no gain at all": ("position_gain = 0.0", "position_gain", "0 is not allowed: it must be >= 0.001"),
    "a text": ('position_gain = "50"', "position_gain", "'50' is not a number"),
    "a negative time": ("position_gain = 50.0\nvelocity_time_constant = -1e-3", "velocity_time_constant", "-0.001 is"),
    "a tiny time": ("position_gain = 50.0\nvelocity_time_constant = 1e-12", "velocity_time_constant", "0, or 1e-09"),
    "a negative dead time": ("position_gain = 50.0\ndead_time = -1.0", "dead_time", "-1 is not allowed: it must be >="),
    "a negative feedforward": ("position_gain = 50.0\nfeedforward = -1.0", "feedforward", "-1 is not allowed"),
}


@pytest.mark.parametrize(("text", "key", "why"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_line_with_its_place(text: str, key: str, why: str, tmp_path: Path) -> None:
    check_mistake("servo", text, key, why, tmp_path)
