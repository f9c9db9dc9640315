"""Runs of a line: by FMPy from the SSP package, and a component alone.

FMPy's co-simulation of a package is parallel (Jacobi): in the step from t to t+h each FMU has the inputs that were
there at t, and its outputs at t+h reach another FMU in the next step, from t+h on. RemoteSync's output, shifted by
delay_time_offset = h, is the axis at t+h. The follower reads this output in the step that starts at t+h, as the master
at the start of the step (START_OF_STEP). So the follower's master does not lag.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssd
from numpy.typing import NDArray

from ..errors import UserError
from ..scenario.recording import Reals
from ..scenario.run.fmu_instance import FmuError, FmuInstance
from .line import ProductionLine
from .package import LinePackage

Inputs = Mapping[str, NDArray[Any]]  # each of shape (steps,)
Values = dict[str, Reals]  # outputs at the ends of the steps, each of shape (steps,)
BOOLEANS = {"true": True, "false": False}


# --- the package in FMPy ---


def run_ssp(line: ProductionLine, package: LinePackage) -> dict[str, Values]:
    """FMPy's SSP simulation of the package: the outputs of each component at the ends of the steps.

    FMPy deviates from the standard. It applies only the parameter set that is passed to it, none of the package. A
    value at an input of the system reaches its component one step later, and in the first step all inputs are zero;
    therefore FMPy gets at t the inputs for t+h.

    Raises:
        UserError: an FMU refused a value or a step.
    """
    for name in line.recipes:  # each FMU alone first: FMPy's SSP simulation does not show what it logs
        with FmuInstance(package.fmus[name]) as fmu:
            _initialize(line, fmu, name)
    h, last = line.step_size, line.steps - 1

    def make_input(values: NDArray[Any]) -> Any:
        steps = values.tolist()
        return lambda time: steps[min(round(time / h) + 1, last)]

    try:
        table = simulate_ssp(
            str(package.ssp),
            stop_time=(line.steps - 0.5) * h,  # FMPy's time is a sum of steps, and so inexact
            step_size=h,
            parameter_set=_read_parameters(package),
            input={name: make_input(values) for name, values in (line.telegrams | line.commands).items()},
        )
    except FMICallException as e:
        raise UserError(f"{line.follower.file}: FMPy's SSP simulation of {package.ssp} failed: {e}") from None
    return {
        name: {v.name: np.asarray(table[f"{name}.{v.name}"], float) for v in outputs}
        for name, outputs in line.outputs.items()
    }


def _read_parameters(package: LinePackage) -> ParameterSet:
    """The package's own parameter set; FMPy reads a Boolean as text, and takes any text for true."""
    (binding,) = read_ssd(str(package.ssp)).system.parameterBindings
    (parameters,) = binding.parameterValues
    for p in parameters.parameters:
        p.value = BOOLEANS[p.value] if p.type == "Boolean" else p.value
    return parameters


# --- one FMU alone ---


def run_alone(
    line: ProductionLine, package: LinePackage, name: str, inputs: Inputs, start: Mapping[str, Any] | None = None
) -> Values:
    """The outputs of a component that runs alone with these inputs; `start` replaces some of its start values.

    Raises:
        UserError: the component refused a value or a step; the message has the time and what the component logged.
    """
    names = [v.name for v in line.outputs[name]]
    outputs = np.empty((line.steps, len(names)))
    i = 0
    with FmuInstance(package.fmus[name]) as fmu:
        try:
            _initialize(line, fmu, name, start)
            for i, row in enumerate(zip(*(values.tolist() for values in inputs.values()), strict=True)):
                fmu.time = i * line.step_size  # exactly, not a sum of steps
                fmu.step(line.step_size, dict(zip(inputs, row, strict=True)))
                outputs[i] = [*map(fmu.get(names).__getitem__, names)]
        except FmuError as e:
            raise UserError(f"{line.follower.file}: at {i * line.step_size:g} s {name} refused: {e}") from None
    return dict(zip(names, outputs.T, strict=True))


def _initialize(line: ProductionLine, fmu: FmuInstance, name: str, start: Mapping[str, Any] | None = None) -> None:
    """Initialize a component with the line's start values, some of them replaced by `start`."""
    try:
        fmu.initialize({**line.parameters[name], **(start or {})})
    except FmuError as e:
        raise UserError(f"{line.follower.file}: {name} refused its start values: {e}") from None
