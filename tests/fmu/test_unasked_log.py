"""Warnings and errors reach an importer that has not asked for a log: both flavours, FMPy's functions and its command
line. FMPy prints them by itself."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from ctypes import c_double, c_int, c_uint
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.simulation import instantiate_fmu

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
from tests.support.hosts.fmus import Fmus

WARNING, ERROR = 1, 3
BAD_VALUE = "axis.max_velocity = -5 is not allowed: it must be 1e-12 to 1e+12"
BAD_COMMAND = (
    "gear_in_pos: refused (0x426E): the master is at rest and never reaches a sync position "
    "(master.position = 0, master.velocity = 0)"
)
COMMAND = np.array([(0.0, False), (0.01, True)], [("time", "f8"), ("gear_in_pos.execute", "?")])  # an edge at 0.01 s
OWN_LOGGER = """
import json, sys
import numpy as np
from fmpy import simulate_fmu

messages = [[], []]

def logger(to):
    return lambda environment, name, status, category, text: to.append(
        [status, (category or b"").decode(), text.decode()]
    )

try:
    simulate_fmu(sys.argv[1], start_values={"axis.max_velocity": -5.0}, logger=logger(messages[0]))
except Exception:
    pass
command = np.array([(0.0, False), (0.01, True)], [("time", "f8"), ("gear_in_pos.execute", "?")])
simulate_fmu(sys.argv[1], input=command, stop_time=0.1, output_interval=0.01, logger=logger(messages[1]))
print(json.dumps(messages))
"""


@pytest.fixture(params=Flavour)
def saw(fmus: Fmus, request: pytest.FixtureRequest) -> Path:
    """FlyingSaw's FMU in each flavour."""
    return fmus.built(request.param, "FlyingSaw")


@pytest.fixture(params=Flavour)
def quiet(fmus: Fmus, request: pytest.FixtureRequest) -> Iterator[FmuInstance]:
    """The Synchronizer in each flavour, with logging switched off after it was instantiated."""
    with FmuInstance(fmus.built(request.param, "Synchronizer")) as host:
        host.unit.setDebugLogging(False, [])
        yield host


def test_a_refused_value_is_printed_by_fmpy(saw: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(FMICallException, match="fmi2ExitInitializationMode"):
        simulate_fmu(str(saw), start_values={"axis.max_velocity": -5.0})
    assert f"[ERROR] {BAD_VALUE}" in capfd.readouterr().out.splitlines()


def test_a_refused_command_is_printed_by_fmpy(saw: Path, capfd: pytest.CaptureFixture[str]) -> None:
    simulate_fmu(str(saw), input=COMMAND, stop_time=0.1, output_interval=0.01)
    lines = [line for line in capfd.readouterr().out.splitlines() if line.startswith("[")]
    assert lines == [f"[WARNING] {BAD_COMMAND}"]


def test_an_importers_own_logger_gets_both(saw: Path) -> None:
    """In a process of its own: FMPy keeps one logger for all FMUs, the last one, even when it is gone."""
    done = subprocess.run([sys.executable, "-c", OWN_LOGGER, saw], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    refused, warned = json.loads(done.stdout.splitlines()[-1])
    assert refused[0] == [ERROR, "logStatusError", BAD_VALUE]
    assert warned == [[WARNING, "logStatusWarning", BAD_COMMAND]]


def test_fmpys_command_line_shows_both(saw: Path, tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("time,gear_in_pos.execute\n" + "".join(f"{t},{x:d}\n" for t, x in COMMAND))
    options = ["--stop-time", "0.1", "--output-interval", "0.01", "--output-file", "out.csv"]
    refused = fmpy(saw, tmp_path, *options, "--start-values", "axis.max_velocity", "-5")
    assert refused.returncode == 1
    assert f"[ERROR] {BAD_VALUE}" in refused.stdout.splitlines()
    warned = fmpy(saw, tmp_path, *options, "--input-file", "in.csv")
    assert warned.returncode == 0, warned.stderr
    assert f"[WARNING] {BAD_COMMAND}" in warned.stdout.splitlines()


def fmpy(fmu: Path, folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "fmpy", "simulate", str(fmu), *options]
    return subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)


def test_a_refused_value_is_reported_with_logging_switched_off(quiet: FmuInstance) -> None:
    with pytest.raises(FmuError, match=r"output_phasing = 0 is not allowed: it must be"):
        quiet.initialize({"output_phasing": 0.0})


def test_a_failed_step_and_a_refused_command_are_reported_with_logging_switched_off(quiet: FmuInstance) -> None:
    quiet.initialize({"output_phasing": 45.0})
    quiet.set({"master.position": 2e12})
    with pytest.raises(FMICallException):
        quiet.unit.doStep(0.0, 0.1)
    assert quiet.messages == ["master.position = 2e+12 is not allowed: it must be -1e+12 to 1e+12"]
    quiet.unit.setDebugLogging(False, [])
    quiet.step(0.1, {"master.position": 0.0, "output_phasing": 1e-10, "stop": True})
    text = "command refused: output_phasing must have a magnitude of 1e-9 to 1e12 (output_phasing = 1e-10)"
    assert quiet.messages[1:] == [text]


def test_logging_on_for_one_category_still_leaves_out_the_others(quiet: FmuInstance) -> None:
    quiet.unit.setDebugLogging(True, ["logStatusError"])
    quiet.initialize({"output_phasing": 45.0})
    quiet.step(0.1, {"output_phasing": 1e-10, "stop": True})
    assert not quiet.messages
    quiet.set({"master.position": 2e12})
    with pytest.raises(FMICallException):
        quiet.unit.doStep(0.1, 0.1)
    assert len(quiet.messages) == 1


@pytest.mark.parametrize(
    ("flavour", "text"),
    [
        (
            Flavour.NATIVE,
            "[WARNING] fmi2SetRealInputDerivatives: ignored but for orders 1 and 2 of the master's position",
        ),
        (Flavour.PYTHON, "[ERROR] FMI function not supported: fmi2SetRealInputDerivatives"),  # PythonFMU's own words
    ],
)
def test_derivatives_of_an_input_that_are_not_used_are_reported(
    fmus: Fmus, tmp_path: Path, capfd: pytest.CaptureFixture[str], flavour: Flavour, text: str
) -> None:
    fmu = str(fmus.built(flavour, "Synchronizer"))
    description = read_model_description(fmu)
    (reference,) = (v.valueReference for v in description.modelVariables if v.name == "rest_value")
    unit = instantiate_fmu(extract(fmu, str(tmp_path)), description, "CoSimulation")
    try:
        unit.setupExperiment()
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        with suppress(FMICallException):  # PythonFMU's status is that of an error
            unit.fmi2SetRealInputDerivatives(
                unit.component, (c_uint * 1)(reference), 1, (c_int * 1)(1), (c_double * 1)(1.0)
            )
        assert text in capfd.readouterr().out
    finally:
        unit.freeInstance()
