"""A CutToLength moves the axis of BeltAxis.mo: two FMUs in co-simulation, the axis compiled from Modelica.

motionsync build CutToLength
pip install rumoca==0.9.12 ziglang
python examples/modelica/belt_axis.py build/native/CutToLength.fmu
"""

import math
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy
import numpy as np
import rumoca
from fmpy.fmi2 import FMU2Slave

MODEL = Path(__file__).with_name("BeltAxis.mo")
STIFF = {"belt_stiffness": 5e8, "belt_damping": 1e5}  # N/m, N s/m: the carriage is where the motor is
SOFT = {"belt_stiffness": 2e5, "belt_damping": 60.0}  # of 25 mm width, about 2 m long
CARRIAGE_MASS = 40.0  # kg
LINE, LENGTH = 500.0, 800.0  # mm/s, mm
STEP = 1e-4  # s; the README has the errors of others
SETPOINT = ("slave.position", "slave.velocity", "slave.acceleration")
INPUTS = ("setpoint_position", "setpoint_velocity", "setpoint_acceleration", "setpoint_time")
# zig need not compile its own runtime on Linux, which takes seconds the first time
LIBRARIES = ["-fPIC", "-nostdlib", "-lc", "-lm"] if sys.platform == "linux" else []


def build_axis(fmu: Path) -> None:
    """Compile BeltAxis.mo: rumoca makes C of it, and zig a library for this machine.

    Raises:
        rumoca.RumocaError: the model is wrong.
        subprocess.CalledProcessError: zig failed.
    """
    name = MODEL.stem
    library = f"binaries/{fmpy.platform}/{name}{fmpy.sharedLibraryExtension}"
    with TemporaryDirectory() as folder:
        work = Path(folder)
        rumoca.load(str(MODEL), model=name).codegen("fmi2").save_all(folder)
        (work / library).parent.mkdir(parents=True)
        command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-O2", f"sources/{name}.c", "-o", library]
        subprocess.run([*command, *LIBRARIES], cwd=work, check=True)
        with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in ("modelDescription.xml", library):
                archive.write(work / file, file)


class Unit:
    """An instance of an FMU, from its initialization with these start values until `close`."""

    def __init__(self, fmu: Path, start: Mapping[str, float]) -> None:
        # rumoca's description lacks units and derivatives, and has start values too many
        description = fmpy.read_model_description(fmu, validate=False)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.folder = fmpy.extract(fmu)
        identifier = description.coSimulation.modelIdentifier
        self.slave = FMU2Slave(
            guid=description.guid, modelIdentifier=identifier, instanceName=identifier, unzipDirectory=self.folder
        )
        self.slave.instantiate()
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.set(tuple(start), list(start.values()))
        self.slave.exitInitializationMode()

    def set(self, names: Sequence[str], values: Sequence[float]) -> None:
        self.slave.setReal([self.references[name] for name in names], values)

    def get(self, names: Sequence[str]) -> list[float]:
        return list(self.slave.getReal([self.references[name] for name in names]))

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass(frozen=True)
class Run:
    """What has happened at the communication points.

    Attributes:
        time: in s, shape (points,).
        setpoint: position, velocity and acceleration in mm and s, shape (points, 3).
        positions: of the carriage with each belt, in mm, shape (points, belts).
        cuts: how many.
    """

    time: np.ndarray[Any, Any]
    setpoint: np.ndarray[Any, Any]
    positions: np.ndarray[Any, Any]
    cuts: int

    def following_errors(self) -> np.ndarray[Any, Any]:
        """Of the carriage with each belt, in mm, shape (points, belts)."""
        return self.setpoint[:, :1] - self.positions


def co_simulate(
    saw_fmu: Path, axis_fmu: Path, belts: Sequence[Mapping[str, float]], step: float = STEP, stop_time: float = 6.0
) -> Run:
    """A saw with CutToLength's start values, and an axis with each belt, step by step: first the saw, then the axes,
    which get its setpoint for the end of the same step. Times in s."""
    saw = Unit(saw_fmu, {"master.velocity": LINE, "length": LENGTH})
    axes = [Unit(axis_fmu, belt) for belt in belts]
    saw.slave.setBoolean([saw.references["start"]], [True])
    rows = [[0.0, *saw.get(SETPOINT), *(0.0 for _ in axes)]]
    times = [i * step for i in range(round(stop_time / step) + 1)]
    for begin, end in pairwise(times):
        saw.set(["master.position"], [LINE * begin])
        saw.slave.doStep(begin, step)
        rows.append([end, *saw.get(SETPOINT)])
        inputs = [*rows[-1][1:], end]
        for axis in axes:
            axis.set(INPUTS, inputs)
            axis.slave.doStep(begin, step)
            rows[-1] += axis.get(["position"])
    (cuts,) = saw.slave.getInteger([saw.references["statistics.cuts"]])
    for unit in (saw, *axes):
        unit.close()
    table = np.array(rows)
    return Run(table[:, 0], table[:, 1:4], table[:, 4:], cuts)


def vibration(run: Run, belt: int, settling: float = 0.1) -> tuple[float, float]:
    """Frequency (Hz) and damping ratio of the carriage at the end of the run, when the saw waits at home.

    `settling`: the time (s) after which the controller's own transients are gone."""
    begin = np.flatnonzero(run.setpoint[:, 1])[-1] + round(settling / run.time[1])
    time, x = run.time[begin:], run.following_errors()[begin:, belt]
    before = np.flatnonzero(x[:-1] * x[1:] < 0.0)
    crossings = time[before] - x[before] * run.time[1] / (x[before + 1] - x[before])
    peaks = [abs(x[a:b]).max() for a, b in pairwise(before)]
    half_period = (crossings[-1] - crossings[0]) / (len(crossings) - 1)
    decrement = math.log(peaks[0] / peaks[-1]) / (len(peaks) - 1)
    return 0.5 / half_period, decrement / math.hypot(decrement, math.pi)


def to_words(run: Run) -> str:
    """What has happened with the belts STIFF and SOFT."""
    stiff, soft = abs(run.following_errors()).max(axis=0)
    frequency, damping = vibration(run, 1)
    natural = math.sqrt(SOFT["belt_stiffness"] / CARRIAGE_MASS) / math.tau
    return f"""{run.cuts} cuts
greatest following error: {stiff:.3f} mm with a stiff belt, {soft:.3f} mm with a soft one
vibration with the soft belt: {frequency:.2f} Hz, damping ratio {damping:.4f}; sqrt(k/m)/2pi is {natural:.2f} Hz"""


def main() -> None:
    with TemporaryDirectory() as folder:
        axis_fmu = Path(folder) / "BeltAxis.fmu"
        build_axis(axis_fmu)
        print(to_words(co_simulate(Path(sys.argv[1]), axis_fmu, [STIFF, SOFT])))


if __name__ == "__main__":
    main()
