"""The force of the carriage's motor in a plan: in closed form, and against a run with many cycles."""

import math
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.plan.line_plan import MachinePlan, plan_machine
from motionsync_fmu.plan.prediction import Prediction
from motionsync_fmu.plan.reader import read_machines
from motionsync_fmu.scenario.files.reader import load_scenario
from tests.oracle.measured_line import load as oracle
from tests.plan.machines import machine
from tests.support.project.command_line import Command, assert_one_line
from tests.support.scenarios.recordings import run_compiled
from tests.support.scenarios.scenario_texts import write_scenario

MOTOR = {"load.mass": "120", "load.friction": "150", "load.continuous_force": "900", "load.peak_force": "3000"}


def plan(settings: dict[str, str], lengths: list[float], velocities: list[float]) -> MachinePlan:
    return plan_machine(machine(settings), lengths, velocities)


def only(predictions: list[Prediction]) -> Prediction:
    (prediction,) = predictions
    return prediction


def force_in_a_run(folder: Path, length: float, velocity: float) -> float:
    """The rms of the force from the first cut of a run to the last one, by the oracle of the load."""
    text = f"""\
title = "The planned line"
fmu = "CutToLength"
stop_time = 15.0
step_size = 0.001
[start]
auto_start = true
length = {length}
[master]
velocity = {velocity}
[load]
mass = 120.0
friction = 150.0
"""
    (run,) = run_compiled(load_scenario(write_scenario(text, folder)))
    assert run.recording
    velocity, acceleration = (run.recording.values[f"slave.{name}"].tolist() for name in ("velocity", "acceleration"))
    force = [
        float(oracle.force(120.0, 150.0 * (abs(v) > 1e-3), a, v)) for v, a in zip(velocity, acceleration, strict=True)
    ]
    starts = np.flatnonzero(np.diff(run.recording.values["tool.cutting"]) > 0.0) + 1
    inside = slice(starts[0], starts[-1] + 1)
    return float(oracle.rms(run.recording.time[inside].tolist(), force[inside]))


@pytest.mark.parametrize(("length", "velocity"), [(800.0, 400.0), (800.0, 650.0), (1200.0, 500.0), (1700.0, 900.0)])
def test_the_force_for_a_length_at_a_line_velocity_is_that_of_a_run(
    tmp_path: Path, length: float, velocity: float
) -> None:
    """Not that at the limit, which is greater on a slower line."""
    made = plan(MOTOR, [length], [velocity])
    (point,) = made.working_points
    assert point.motor
    assert (point.length, point.velocity) == (length, velocity)
    assert point.motor.rms == pytest.approx(force_in_a_run(tmp_path, length, velocity), rel=4e-3)
    at_limit = only(made.over_length).motor
    assert at_limit
    assert point.motor.rms < at_limit.rms
    assert point.margin == pytest.approx(only(made.over_length).velocity / velocity - 1.0)


def test_a_line_that_is_too_fast_has_no_force() -> None:
    """The line of the first tutorial may run at 775.6 mm/s."""
    saw = {"kerf": "4", "axis.max_position": "650"}
    slow, fast = plan(MOTOR | saw, [800.0], [775.0, 776.0]).working_points
    assert slow.motor
    assert slow.margin > 0.0
    assert not fast.motor
    assert fast.margin < 0.0


def test_the_forces_are_those_of_a_run_with_many_cycles(tmp_path: Path) -> None:
    prediction = only(plan(MOTOR, [800.0], [500.0]).over_length)
    assert prediction.motor
    rms = force_in_a_run(tmp_path, 800.0, prediction.velocity * (1.0 - 1e-6))
    assert prediction.motor.rms == pytest.approx(rms, rel=2e-3)
    assert prediction.motor.peak == pytest.approx(120.0 * 10.0 + 150.0, rel=1e-3)
    assert prediction.motor.rms_share == pytest.approx(prediction.motor.rms / 900.0)
    assert prediction.motor.peak_share == pytest.approx(prediction.motor.peak / 3000.0)


def test_friction_alone_acts_while_the_carriage_moves() -> None:
    """With longer pieces it rests at home for longer; the rms is friction sqrt(moving time / time of a pitch)."""
    result = plan({"load.mass": "1e-9", "load.friction": "100"}, [800.0, 6000.0], [400.0])
    for prediction in result.predictions:
        assert prediction.motor
        assert prediction.cycle
        assert prediction.cycle_time
        assert prediction.length
        moving, pitch = (
            prediction.cycle_time - prediction.cycle["rest at home"],
            prediction.length / prediction.velocity,
        )
        assert prediction.motor.rms == pytest.approx(100.0 * math.sqrt(moving / pitch), rel=5e-3)
        assert prediction.motor.peak == pytest.approx(100.0, rel=1e-6)
        assert (prediction.motor.rms_share, prediction.motor.peak_share) == (None, None)
    short, long = (p.motor.rms for p in result.over_length if p.motor)
    assert long < 0.9 * short


def test_without_a_load_there_are_no_forces() -> None:
    assert all(p.motor is None for p in plan({}, [800.0], [400.0]).predictions)


def test_a_velocity_that_is_not_admissible_has_no_forces() -> None:
    assert only(plan(MOTOR, [800.0], [5000.0]).over_velocity).motor is None


def test_the_load_comes_from_the_file_and_the_options(tmp_path: Path) -> None:
    file = tmp_path / "saw.toml"
    file.write_text("[start]\n[load]\nmass = 10.0\nfriction = 3.0\n")
    load = read_machines([file], "", {"load.mass": "20"}, "")[0][0].load
    assert load
    assert (load.mass, load.friction, load.unit) == (20.0, 3.0, "mm")
    turning = read_machines([], "", {"load.inertia": "2"}, "deg")[0][0].load
    assert turning
    assert turning.turns


def test_the_command_prints_the_forces(motionsync: Command) -> None:
    settings = [part for name, value in MOTOR.items() for part in ("--set", f"{name}={value}")]
    outcome = motionsync("plan-line", *settings, "--length", "800", "--velocity", "400", "--no-report")
    assert outcome.status == 0
    assert outcome.out.count("force rms N") == outcome.out.count("force peak N") == 3
    assert "1350, 45 %" in outcome.out
    weak = [part.replace("load.peak_force=3000", "load.peak_force=1000") for part in settings]
    assert "1350, 135 %!" in motionsync("plan-line", *weak, "--length", "800", "--no-report").out


@pytest.mark.parametrize(
    ("setting", "parts"),
    [
        ("load.mass=-2", ("mass: -2 is not allowed: it must be > 0",)),
        ("load.mass=nan", ("mass: nan is not allowed: it must be finite",)),
        ("load.mass=heavy", ("load.mass=heavy", "'heavy' is not a number")),
        ("load.weight=3", ("weight: unknown key; there is mass, friction",)),
        ("load.inertia=3", ("inertia: the slave is in mm: what it moves is the mass",)),
        ("load.friction=3", ("mass: is missing",)),
    ],
)
def test_a_mistake_is_one_line(setting: str, parts: tuple[str, ...], motionsync: Command) -> None:
    assert_one_line(motionsync("plan-line", "--set", setting, "--no-report"), *parts)
