"""An axis in Modelica, compiled by an open compiler, follows a CutToLength: examples/modelica, and what its page says.

The oracle is the position controller whose velocity loop is a lag of first order. The eigenvalues are those of the
equations, written here a second time, in m and s:

    M v' = (M + m)/Tv (-Kv x - v) - F    m w' = F    F = k (x - y) + d (v - w)    x' = v    y' = w
"""

import math
import re
from collections.abc import Callable
from functools import cache

import belt_axis
import numpy as np
import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.interface.recipe import Recipe
from tests import ROOT
from tests.oracle.measured_line.servo import Servo
from tests.support.hosts.fmus import Shared, build_for_host

README = (ROOT / "examples/modelica/README.md").read_text("utf-8")
GAIN, TIME_CONSTANT = 50.0, 0.003  # 1/s, s
MOTOR, CARRIAGE = 80.0, 40.0  # kg
ROW = 1e-3  # s, between the rows that are compared


@pytest.fixture(scope="module")
def run(shared: Shared) -> Callable[[float], belt_axis.Run]:
    """The run with a stiff and a soft belt, at a communication step in s."""
    folder = shared.once("modelica", lambda folder: belt_axis.build_axis(folder / "BeltAxis.fmu"))
    saw = shared.once(
        "modelica-saw",
        lambda folder: build_for_host(Flavour.NATIVE, Recipe("CutToLength"), folder / "CutToLength.fmu"),
    )
    belts = [belt_axis.STIFF, belt_axis.SOFT]
    return cache(lambda step: belt_axis.co_simulate(saw / "CutToLength.fmu", folder / "BeltAxis.fmu", belts, step))


def servo_difference(run: belt_axis.Run) -> tuple[float, float]:
    """The oracle's greatest following error in mm, and how far the stiff axis is off it, as a share of that."""
    every = round(ROW / run.time[1])
    time, setpoint, positions = (values[::every] for values in (run.time, run.setpoint, run.positions))
    oracle = Servo(GAIN, TIME_CONSTANT, feedforward=1.0, dead_time=0.0)
    expected, _, _ = oracle.run(time.tolist(), setpoint[:, 0].tolist(), setpoint[:, 1].tolist())
    exact = np.array(expected, float)
    greatest = abs(setpoint[:, 0] - exact).max()
    return greatest, abs(positions[:, 0] - exact).max() / greatest


def vibration(k: float, d: float) -> tuple[float, float]:
    """Frequency (Hz) and damping ratio of the equations' complex eigenvalues."""
    gain = (MOTOR + CARRIAGE) / TIME_CONSTANT
    matrix = [
        [0.0, 1.0, 0.0, 0.0],
        [-(gain * GAIN + k) / MOTOR, -(gain + d) / MOTOR, k / MOTOR, d / MOTOR],
        [0.0, 0.0, 0.0, 1.0],
        [k / CARRIAGE, d / CARRIAGE, -k / CARRIAGE, -d / CARRIAGE],
    ]
    (root,) = (root for root in np.linalg.eigvals(matrix) if root.imag > 0.0)
    return root.imag / math.tau, -root.real / abs(root)


def table() -> dict[float, list[float]]:
    """Error (a share), frequency (Hz) and damping ratio by the communication step in s, as the page has them."""
    rows = re.findall(r"^\| ([\d.]+) ms \| ([\d.]+) % \| ([\d.]+) Hz \| ([\d.]+) \|$", README, re.M)
    return {float(step) / 1e3: [float(error) / 100.0, float(f), float(d)] for step, error, f, d in rows}


def test_the_axis_is_the_servo_with_a_stiff_belt_and_vibrates_with_a_soft_one(
    run: Callable[[float], belt_axis.Run],
) -> None:
    """At the example's step. The soft belt's motor yields a little; so the closed form is right to a few per cent, the
    eigenvalues are right but for the error of Euler."""
    result = run(belt_axis.STEP)
    assert result.cuts == 3
    greatest, error = servo_difference(result)
    assert greatest == pytest.approx(10_000.0 * TIME_CONSTANT / GAIN, rel=0.02)
    assert error < 0.01
    frequency, damping = belt_axis.vibration(result, 1)
    stiffness, belt_damping = belt_axis.SOFT.values()
    assert frequency == pytest.approx(math.sqrt(stiffness / CARRIAGE) / math.tau, rel=0.03)
    expected = vibration(stiffness, belt_damping)
    assert frequency == pytest.approx(expected[0], rel=1e-3)
    assert damping == pytest.approx(expected[1], rel=0.02)
    assert f"at {expected[0]:.3f} Hz with a damping ratio of {expected[1]:.4f}." in README
    assert all(f"    {line}\n" in README for line in belt_axis.to_words(result).splitlines())


def test_the_table_of_step_sizes_is_right(
    run: Callable[[float], belt_axis.Run], soak: Callable[[int, int], int]
) -> None:
    """The shortest step, a run of some 20 s, in the long form alone."""
    rows = table()
    assert list(rows) == [1e-3, 1e-4, 1e-5]
    for step in list(rows)[: soak(2, 3)]:
        result = run(step)
        result_row = [servo_difference(result)[1], *belt_axis.vibration(result, 1)]
        assert result_row == [
            pytest.approx(x, abs=precision) for x, precision in zip(rows[step], (5.1e-5, 5.1e-4, 5.1e-5), strict=True)
        ]
