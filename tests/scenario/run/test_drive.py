"""Scenarios whose master follows a velocity that the block puts out: its motion at every step size, and what the
reader refuses.

With the time constant 0.3 s and scans of 0.01 s a lag of first order keeps, from each scan to the next, the share
Q = exp(-1/30) of its distance from what is asked for. The first scan is that at 0.01 s.
"""

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.pages.results import write_results
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.scenario.evaluate.csv_files import inputs_csv
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Reals, Recording
from motionsync_fmu.scenario.run.simulation import run_in_process, simulate
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT, regenerate
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.scenario_texts import COUPLED, FREE_SAW, assert_refused, write_scenario
from tests.support.scenarios.stored_references import keep

FREE = FREE_SAW + 'follows = "slave.velocity"\ntime_constant = 0.3\n'
STEP_SIZES = (0.01, 0.001, 0.007, 0.0333, 0.3)  # s
Q = math.exp(-0.01 / 0.3)
LOOK = 0.01 / 128.0  # s


def ran(text: str, folder: Path, step_size: float = 0.01) -> Recording:
    return run_in_process(load_scenario(write_scenario(text, folder)), step_size)


def of_the_master(recording: Recording, times: Iterator[float] | list[float]) -> Reals:
    """Position, velocity and acceleration of the master at these times, shape (times, 3)."""
    rows = [int(np.argmin(np.abs(recording.time - t))) for t in times]
    assert recording.time[rows] == pytest.approx(list(times), abs=1e-12)
    return recording.master[rows, :3]


# --- the motion ---


@pytest.mark.parametrize("step_size", STEP_SIZES)
@pytest.mark.parametrize("mode", ["START_OF_STEP", "END_OF_STEP", "POSITION_ONLY"])
def test_a_master_follows_with_the_lag_of_its_time_constant(mode: str, step_size: float, tmp_path: Path) -> None:
    """It rests until the first scan, and n scans later has the velocity 100 (1 - Q^n): after a time constant, n = 30,
    100 (1 - 1/e) = 63.21. Each scan it goes 0.01 times the mean of two such velocities; their sum up to n = 30 is
    100 (30 - (1 + Q)/2 (1 - Q^30)/(1 - Q))."""
    text = FREE.replace("[start]\n", f'[start]\n"master.input_mode" = "{mode}"\n')
    recording = ran(text, tmp_path, step_size)
    result = of_the_master(recording, [0.01, 0.02, 0.31, 1.81])
    velocities = [0.0, 100.0 * (1.0 - Q), 100.0 * (1.0 - math.exp(-1.0)), 100.0 * (1.0 - math.exp(-6.0))]
    assert result[:, 1] == pytest.approx(velocities, abs=1e-10)
    way = 100.0 * (30.0 - (1.0 + Q) / 2.0 * (1.0 - math.exp(-1.0)) / (1.0 - Q)) * 0.01
    assert result[[0, 2], 0] == pytest.approx([0.0, way], abs=1e-10)


@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_its_acceleration_is_constant_within_a_scan_and_limited(step_size: float, tmp_path: Path) -> None:
    """The lag alone would start with 100 (1 - Q)/0.01 = 327.8 mm/s2. With 200 the velocity rises by 2 each scan, and
    the lag needs less than that from 100 - 200/3.278 = 39.0 on: n = 20, at 40. Half a second later, 50 scans,
    100 - 60 Q^50 = 88.67."""
    recording = ran(FREE + "max_acceleration = 200.0\n", tmp_path, step_size)
    result = of_the_master(recording, [0.11, 0.21, 0.71])
    assert result[:, 1] == pytest.approx([20.0, 40.0, 100.0 - 60.0 * Q**50], abs=1e-10)
    assert result[0, 0] == pytest.approx(200.0 * 0.1**2 / 2.0, abs=1e-10)
    time, accelerations = recording.time[1:], recording.master[1:, 2]
    scans = np.ceil(time / 0.01 - 1e-6)
    assert all(np.ptp(accelerations[scans == n]) == 0.0 for n in range(1, 200))
    assert (accelerations[scans == 1] == 0.0).all()
    assert np.abs(accelerations).max() == 200.0


@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_a_scan_takes_what_was_there_shortly_before_it(step_size: float, tmp_path: Path) -> None:
    """The line has the saw's 100 mm/s when, at 0.5 s, the saw starts to speed up with a jerk of 100000: after t it has
    100 + 50000 t^2."""
    text = FREE.replace("[master]\n", "[master]\nvelocity = 100.0\n")
    recording = ran(
        text + '[[set]]\nat = 0.5\n"move_velocity.velocity" = 300.0\n"move_velocity.execute" = true\n',
        tmp_path,
        step_size,
    )
    asked = [100.0 + 50000.0 * (t - LOOK) ** 2 for t in (0.01, 0.02, 0.03)]
    velocity, velocities = 100.0, [100.0, 100.0]
    for one in asked:
        velocity = one + (velocity - one) * Q
        velocities.append(velocity)
    assert of_the_master(recording, [0.5, 0.51, 0.52, 0.53, 0.54])[:, 1] == pytest.approx(velocities, abs=1e-9)


@pytest.mark.parametrize("mode", ["START_OF_STEP", "END_OF_STEP"])
@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_the_loop_through_the_block_is_closed(mode: str, step_size: float, tmp_path: Path) -> None:
    """Until 0.1 the slave is at rest, and the line slows down from 100; then the slave has half of the line's velocity.
    What a scan sees of it is a look before: less than at the scan by that part of the line's last change."""
    text = COUPLED.replace("[start]\n", f'[start]\n"master.input_mode" = "{mode}"\n')
    velocities = [100.0, 100.0]  # at 0 and at the first scan
    while len(velocities) < 200:
        last, now = velocities[-2:]
        scan = len(velocities) - 1
        asked = 0.5 * (now - (now - last) / 128.0) if scan > 10 else 0.0
        velocities.append(asked + (now - asked) * Q)
    recording = ran(text, tmp_path, step_size)
    result = of_the_master(recording, [round(0.01 * n, 12) for n in range(200)])
    assert result[:, 1] == pytest.approx(velocities, abs=1e-9)
    way = 0.01 * sum((one + other) / 2.0 for one, other in pairwise(velocities))
    assert result[-1, 0] == pytest.approx(way, abs=1e-9)
    slave = recording.values["slave.velocity"][recording.time > 0.1 + 1e-9]
    assert slave == pytest.approx(recording.master[recording.time > 0.1 + 1e-9, 1] / 2.0, abs=1e-9)


def test_the_position_is_wrapped_into_the_period_of_the_master(tmp_path: Path) -> None:
    """The scripted axis of the recording is the unwrapped one; what the block gets is below the period."""
    text = COUPLED.replace("[start]\n", '[start]\n"master.period" = 20.0\n')
    scenario = load_scenario(write_scenario(text, tmp_path))
    recording = run_in_process(scenario, 0.01)
    assert recording.master[-1, 0] > 40.0
    assert recording.script
    rows = inputs_csv(scenario.with_recorded_inputs(recording.settings, recording.script)).splitlines()[1:]
    assert all(0.0 <= float(row.split(",")[2]) < 20.0 for row in rows)


# --- what a run leaves ---


@pytest.mark.parametrize("step_size", [0.01, 0.007])
def test_an_fmu_leads_to_the_same_numbers(step_size: float, tmp_path: Path, fmus: Fmus) -> None:
    scenario = load_scenario(write_scenario(COUPLED, tmp_path))
    one, other = run_in_process(scenario, step_size), simulate(scenario, fmus.python("Gearing"), step_size)
    assert one.master.tolist() == other.master.tolist()
    assert one.values["slave.position"].tolist() == other.values["slave.position"].tolist()


@pytest.mark.parametrize("mode", ["START_OF_STEP", "END_OF_STEP", "POSITION_ONLY"])
def test_the_settled_scenario_has_the_motion_of_the_run(mode: str, tmp_path: Path) -> None:
    """It neither reacts nor follows, and gives the same master at another step size, too."""
    text = COUPLED.replace("[start]\n", f'[start]\n"master.input_mode" = "{mode}"\n')
    scenario = load_scenario(write_scenario(text, tmp_path))
    recording = run_in_process(scenario, 0.01)
    assert recording.script
    settled = scenario.with_recorded_inputs(recording.settings, recording.script)
    assert (scenario.reacts, settled.reacts) == (True, False)
    again = run_in_process(settled, 0.007)
    common, i, j = np.intersect1d(recording.time, again.time, return_indices=True)
    assert len(common) >= 200
    assert recording.master[i].tolist() == again.master[j].tolist()


def test_a_run_does_not_change_the_scenario(tmp_path: Path) -> None:
    scenario = load_scenario(write_scenario(FREE, tmp_path))
    one, other = (run_in_process(scenario, 0.01) for _ in range(2))
    assert one.master.tolist() == other.master.tolist()
    assert scenario.master.breaks == [0.0]


@pytest.mark.parametrize("limit", ["", "max_acceleration = 800.0\n"])
def test_the_oracle_finds_the_same_by_itself(limit: str, tmp_path: Path) -> None:
    """The saw's velocity is constant at first; then it changes from scan to scan, and is constant again."""
    change = '[[set]]\nat = 0.4\n"move_velocity.velocity" = 300.0\n"move_velocity.execute" = true\n'
    scenario = load_scenario(
        write_scenario(FREE.replace("stop_time = 2.0", "stop_time = 1.0") + limit + change, tmp_path)
    )
    recording = run_in_process(scenario, 0.01)
    script, _ = regenerate.solved(scenario, [])
    assert "follows" not in script["master"]
    result = regenerate.master(scenario, script)
    motions = [result.until(t) for t in recording.time.tolist()]
    expected = [(m.position, m.velocity, m.acceleration) for m in motions]
    np.testing.assert_allclose(recording.master[:, :3], expected, atol=1e-9, rtol=0.0)
    settled, _ = regenerate.with_reference(scenario.file)
    _, *rows = inputs_csv(settled).splitlines()
    time, _, _, velocity, *_ = map(float, rows[31].split(","))
    assert (time, velocity) == pytest.approx((0.31, 100.0 * (1.0 - math.exp(-1.0))), abs=1e-10)


def outcome(text: str, folder: Path) -> tuple[Scenario, Path]:
    """The scenario, and the folder into which a run of it has written its files."""
    scenario = load_scenario(write_scenario(text, folder))
    recording = run_in_process(scenario, 0.01)
    evaluated = evaluate_run(scenario, recording)
    write_results(evaluated, scenario, recording, folder / "none.fmu", folder / "out", report=False)
    write_report(folder / "report.html", scenario, recording, evaluated)
    return scenario, folder / "out"


def test_the_inputs_for_fmpy_have_the_motion_of_the_run(tmp_path: Path) -> None:
    """The row of a scan holds the acceleration from there on: at 0.01 s (100 - 0) (1 - Q)/0.01."""
    _, folder = outcome(FREE, tmp_path)
    header, *rows = (folder / "FlyingSaw_in.csv").read_text().splitlines()
    assert header == '"time","master.acceleration","master.position","master.velocity"'
    assert [float(x) for x in rows[1].split(",")] == pytest.approx([0.01, 100.0 * (1.0 - Q) / 0.01, 0.0, 0.0])
    assert len(rows) == 200


def test_the_report_says_what_the_master_follows(tmp_path: Path) -> None:
    outcome(FREE.replace("[master]\n", "[master]\nposition = 7.5\n") + "max_acceleration = 500.0\n", tmp_path)
    text = " ".join((tmp_path / "report.html").read_text("utf-8").split())
    sentence = "starts at 7.5 mm with 0 mm/s, and follows <code>slave.velocity</code> with a lag"
    assert sentence in text
    assert "time constant 0.3 s, at most 500 mm/s². It reads this velocity every 0.01 s." in text


# --- the flagship ---

FLAGSHIP = ROOT / "scenarios" / "CutToLength" / "cyclic_orders" / "scenario.toml"


def numbers(text: str) -> Reals:
    """The rows of a file of inputs."""
    return np.array([[float(x) for x in line.split(",")] for line in text.splitlines()[1:]])


@pytest.mark.parametrize("step_size", [0.01, 0.007])
def test_the_flagship_s_line_runs_as_the_oracle_s(step_size: float) -> None:
    """The oracle has closed the loop by itself; the inputs of it are time, the master and the commands."""
    scenario = load_scenario(FLAGSHIP)
    recording = run_in_process(scenario, step_size)
    assert recording.script
    result = numbers(inputs_csv(scenario.with_recorded_inputs(recording.settings, recording.script)))
    settled, _ = regenerate.with_reference(FLAGSHIP, keep)
    expected = numbers(inputs_csv(settled))
    np.testing.assert_allclose(result, expected, atol=1e-7, rtol=0.0)


@pytest.mark.parametrize(
    ("limit", "lengths"),
    [
        (800.0, [1500.0] * 4 + [600.0] * 5 + [2400.0] * 3),
        (400.0, [1500.0] * 4 + [1204.0] + [600.0] * 5 + [2400.0] * 3),
    ],
)
def test_a_line_that_slows_down_too_late_costs_a_cut(limit: float, lengths: list[float], tmp_path: Path) -> None:
    """From 1200 to the 693 that pieces of 600 need it takes 1.3 s with 400 mm/s2, but only 1504 mm of timber are left
    for it, 1.25 s at full speed: the first short cut is missed. The piece of 600 + 4 + 600 is made again."""
    text = FLAGSHIP.read_text().replace("max_acceleration = 800.0", f"max_acceleration = {limit}")
    recording = ran(text, tmp_path)
    cuts = np.flatnonzero(np.diff(recording.values["statistics.cuts"])) + 1
    assert recording.values["last.length"][cuts][: len(lengths)] == pytest.approx(lengths, abs=1e-9)
    assert recording.values["order.completed"][-1] == 4.0


# --- files with a mistake ---

MISTAKES = {
    "unknown output": ('"slave.velocity"', '"slave.velocty"', "follows", 11, ("FlyingSaw has no", "'slave.velocity'")),
    "position": ('"slave.velocity"', '"slave.position"', "follows", 11, ("slave.position is a", "is a velocity")),
    "Boolean": ('"slave.velocity"', '"in_sync"', "follows", 11, ("in_sync is a", "is a velocity")),
    "input": ('"slave.velocity"', '"master.velocity"', "follows", 11, ("master.velocity is a", "input", "output or")),
    "no text": ('"slave.velocity"', "1.0", "follows", 11, ("1.0 is not a text",)),
    "no time constant": ("time_constant = 0.3\n", "", "time_constant", 10, ("is missing",)),
    "no time": ("time_constant = 0.3", "time_constant = 0", "time_constant", 12, ("0 is not", "> 0")),
    "no number": ("time_constant = 0.3", "time_constant = true", "time_constant", 12, ("True is not a number",)),
    "no limit": ("= 0.3", "= 0.3\nmax_acceleration = -1", "max_acceleration", 13, ("-1 is not", "> 0")),
    "not followed": ('follows = "slave.velocity"\n', "", "time_constant", 11, ("follows is missing",)),
    "scripted": ("= 0.3", "= 0.3\nsegments = [{ duration = 1.0 }]", "segments", 13, ("position and velocity alone",)),
    "accelerated": ("= 0.3", "= 0.3\nacceleration = 1.0", "acceleration", 13, ("position and velocity alone",)),
    "unknown key": ("= 0.3", "= 0.3\nfollow = 1.0", "follow", 13, ("unknown key", "follows")),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, key, line, words = MISTAKES[name]
    assert load_scenario(write_scenario(FREE, tmp_path))
    assert_refused(FREE.replace(old, new, 1), tmp_path, line, key, *words)


def test_the_remote_axis_of_a_scenario_or_a_line_does_not_follow(tmp_path: Path) -> None:
    for place, read in (("RemoteSync/no_drift/scenario.toml", load_scenario), ("line/line.toml", load_line)):
        text = (ROOT / "scenarios" / place).read_text()
        file = write_scenario(text.replace("[remote]", '[remote]\nfollows = "slave.velocity"', 1), tmp_path)
        with pytest.raises(UserError, match="follows: unknown key"):
            read(file)
