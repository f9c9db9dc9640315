"""Runs of a line: by FMPy from the SSP package, by libcosim from the OSP structure, and a follower alone.

Both co-simulations are parallel (Jacobi): in the step from t to t+h each FMU has the inputs that were there at t, and
its outputs at t+h reach another FMU in the next step, from t+h on. RemoteSync's output, shifted by
delay_time_offset = h, is the axis at t+h. The follower reads this output in the step that starts at t+h, as the master
at the start of the step (START_OF_STEP). So the follower's master does not lag.
"""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssd
from numpy.typing import NDArray

from ..errors import UserError
from ..optional_dependencies import how_to_install
from ..scenario.recording import Reals
from ..scenario.run.fmu_instance import FmuError, FmuInstance
from .line import REMOTE, ProductionLine
from .package import LinePackage

Inputs = Mapping[str, NDArray[Any]]  # each of shape (steps,)
Values = dict[str, Reals]  # outputs at the ends of the steps, each of shape (steps,)
KINDS = ("Real", "Integer", "Boolean")
BOOLEANS = {"true": True, "false": False}


class MissingLibraryError(Exception):
    """A library is not installed; the text states how to install it."""


# --- (a) FMPy ---


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


# --- (b) libcosim ---


def run_cosim(line: ProductionLine, package: LinePackage) -> dict[str, Values]:
    """libcosim's fixed-step co-simulation of the OSP structure; telegrams and commands override the inputs. It cannot
    read enumerations: these are missing.

    Raises:
        MissingLibraryError: libcosimpy is not installed.
        UserError: libcosim refused the structure or a step.
    """
    cosim = _Cosim(line, package.osp)
    for name in line.recipes:
        cosim.wire(name)
    for i in range(line.steps):
        cosim.step(i)
    return cosim.outputs


class _Cosim:
    """libcosim's execution of an OSP structure.

    Attributes:
        outputs: those of each component at the ends of the steps.
        overrides: the functions that override inputs, each of those of one type, with the values in each step.
        reads: the functions that return outputs, each of those of one type, with their array of shape (steps, names).
    """

    def __init__(self, line: ProductionLine, structure: Path) -> None:
        """Open the structure.

        Raises:
            MissingLibraryError: libcosimpy is not installed.
            UserError: libcosim refused the structure.
        """
        try:
            from libcosimpy.CosimEnums import CosimExecutionState  # noqa: PLC0415 (an optional library)
            from libcosimpy.CosimExecution import CosimExecution  # noqa: PLC0415
            from libcosimpy.CosimLogging import CosimLogLevel, log_output_level  # noqa: PLC0415
            from libcosimpy.CosimManipulator import CosimManipulator  # noqa: PLC0415
            from libcosimpy.CosimObserver import CosimObserver  # noqa: PLC0415
        except ModuleNotFoundError:
            raise MissingLibraryError(f"libcosimpy is not installed ({how_to_install('line')})") from None
        log_output_level(CosimLogLevel.ERROR)
        try:
            self.execution = CosimExecution.from_osp_config_file(str(structure))
        except AssertionError as e:
            raise UserError(f"{structure}: libcosim refused it: {e}") from None
        self.line = line
        self.structure = structure
        self.inputs: Mapping[str, Inputs] = {REMOTE: line.telegrams, line.follower.recipe.name: line.commands}
        self.failed = CosimExecutionState.ERROR.value
        self.manipulator, self.observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
        self.execution.add_manipulator(self.manipulator)
        self.execution.add_observer(self.observer)
        self.outputs: dict[str, Values] = {name: {} for name in line.recipes}
        self.overrides: list[tuple[Callable[[list[Any]], Any], list[tuple[Any, ...]]]] = []
        self.reads: list[tuple[Callable[[], list[Any]], Reals]] = []

    def wire(self, component: str) -> None:
        """Prepare, type by type, overriding the inputs of a component and reading its outputs."""
        slave = self.execution.slave_index_from_instance_name(component)
        references = {v.name.decode(): v.reference for v in self.execution.slave_variables(slave)}
        inputs = self.inputs[component]
        outputs = [v.name for v in self.line.outputs[component]]
        for kind in KINDS:
            names_of_kind = [v.name for v in self.line.recipes[component].variables.values() if v.kind == kind]
            override = getattr(self.manipulator, f"slave_{kind.lower()}_values")
            get = getattr(self.observer, f"last_{kind.lower()}_values")
            if names := [n for n in names_of_kind if n in inputs]:
                rows = list(zip(*(inputs[n].tolist() for n in names), strict=True))
                self.overrides.append((partial(override, slave, [references[n] for n in names]), rows))
            if names := [n for n in outputs if n in names_of_kind]:  # enumerations are in none of the KINDS
                values = np.empty((self.line.steps, len(names)))
                self.reads.append((partial(get, slave, [references[n] for n in names]), values))
                self.outputs[component] |= dict(zip(names, values.T, strict=True))

    def step(self, i: int) -> None:
        """Do the step with this number.

        Raises:
            UserError: the step failed.
        """
        for override, rows in self.overrides:
            if i == 0 or rows[i] != rows[i - 1]:  # an override stays until the next one
                override(list(rows[i]))
        if not self.execution.step() or self.execution.status().state == self.failed:
            raise UserError(f"{self.structure}: libcosim failed at {i * self.line.step_size:g} s")
        for get, values in self.reads:
            values[i] = get()


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
