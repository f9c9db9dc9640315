"""The motor's force and power: against the oracle, at standstill, and in the units of the axis."""

from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.load import Load
from motionsync_fmu.scenario.run.simulation import run_in_process
from tests.oracle.measured_line import load as oracle
from tests.support.scenarios.scenario_texts import FREE_SAW, check_mistake, write_scenario

UNITS = ("mm", "m", "deg", "rad", "1")


@pytest.mark.parametrize("unit", UNITS)
def test_force_and_power_are_those_of_the_oracle(unit: str) -> None:
    velocity = np.array([1500.0, -300.0, 0.0, 2.0, -2.0])
    acceleration = np.array([-1e4, 2e3, 5e3, 0.0, 1e3])
    axis = Load(120.0, 150.0, unit)
    force = axis.force(velocity, acceleration)
    power = axis.power(force, velocity)
    for i, (v, a) in enumerate(zip(velocity.tolist(), acceleration.tolist(), strict=True)):
        exact = oracle.force(120.0, 150.0, a, v, unit)
        assert force[i] == pytest.approx(float(exact), rel=1e-14)
        assert power[i] == pytest.approx(float(oracle.power(exact, v, unit)), rel=1e-14)


@pytest.mark.parametrize("unit", UNITS)
def test_an_axis_that_needs_a_second_for_a_micrometre_has_no_friction(unit: str) -> None:
    slow = 1e-6 / float(oracle.IN_BASE_UNITS[unit])
    velocity = slow * np.array([0.999, -0.999, 1.001, -1.001])
    np.testing.assert_array_equal(Load(1.0, 7.0, unit).force(velocity, np.zeros(4)), [0.0, 0.0, 7.0, -7.0])


def test_without_a_servo_the_setpoint_is_the_motion(tmp_path: Path) -> None:
    text = FREE_SAW + '[[set]]\nat = 0.5\n"halt.execute" = true\n[load]\nmass = 120.0\nfriction = 150.0\n'
    scenario = load_scenario(write_scenario(text, tmp_path))
    recording = run_in_process(scenario, scenario.step_size)
    velocity, acceleration = (recording.values[f"slave.{name}"].tolist() for name in ("velocity", "acceleration"))
    assert min(acceleration) < 0.0 < max(velocity)
    exact = [float(oracle.force(120.0, 150.0, a, v)) for v, a in zip(velocity, acceleration, strict=True)]
    np.testing.assert_allclose(recording.computed["load.force"], exact, rtol=1e-14)


MISTAKES = {
    "an unknown key": ("mass = 1.0\nweight = 3.0", "weight", "unknown key; there is mass, friction"),
    "no mass": ("friction = 3.0", "mass", "is missing"),
    "no mass at all": ("mass = 0.0", "mass", "0 is not allowed: it must be > 0"),
    "a negative friction": ("mass = 1.0\nfriction = -1.0", "friction", "-1 is not allowed: it must be >= 0"),
    "no force": ("mass = 1.0\npeak_force = 0", "peak_force", "0 is not allowed: it must be > 0"),
    "an infinite force": ("mass = 1.0\ncontinuous_force = inf", "continuous_force", "inf is not allowed"),
    "an inertia of a carriage": ("inertia = 1.0", "inertia", "the slave is in mm: what it moves is the mass, in kg"),
}


@pytest.mark.parametrize(("text", "key", "why"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_line_with_its_place(text: str, key: str, why: str, tmp_path: Path) -> None:
    check_mistake("load", text, key, why, tmp_path)


def test_an_axis_that_turns_has_an_inertia(tmp_path: Path) -> None:
    turning = FREE_SAW.replace('fmu = "FlyingSaw"', 'fmu = "FlyingSaw"\nunit = "deg"')
    assert load_scenario(write_scenario(turning + "[load]\ninertia = 2.0\n", tmp_path)).load == Load(2.0, 0.0, "deg")
    with pytest.raises(UserError, match="mass: the slave is in deg: what it moves is the inertia, in kg m2"):
        load_scenario(write_scenario(turning + "[load]\nmass = 2.0\n", tmp_path))
