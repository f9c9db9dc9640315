"""Runs of a line: by FMPy from the SSP package, by libcosim from the OSP structure, and a follower alone.

Both co-simulations are parallel (Jacobi): in the step from t to t+h each FMU has the inputs that were there at t, and
what it puts out for t+h reaches another FMU in the next step, from t+h on. RemoteSync's output, shifted by
delay_time_offset = h, is the axis at t+h. The follower reads this output in the step that begins at t+h, as the master
at the start of the step (START_OF_STEP). So the follower's master does not lag.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssd
from numpy.typing import NDArray

from ..errors import UserError
from ..extras import how_to_install
from ..scenario.fmu_instance import FmuError, FmuInstance
from ..scenario.recording import Reals
from .line import REMOTE, Line
from .package import Package

Inputs = Mapping[str, NDArray[Any]]  # each of shape (steps,)
Values = dict[str, Reals]  # outputs at the ends of the steps, each of shape (steps,)
KINDS = ("Real", "Integer", "Boolean")
BOOLEANS = {"true": True, "false": False}


class MissingLibraryError(Exception):
    """A library is not installed; the text says how to install it."""


# --- (a) FMPy ---


def run_ssp(line: Line, package: Package) -> dict[str, Values]:
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

    def feed(values: NDArray[Any]) -> Any:
        later = values.tolist()
        return lambda time: later[min(round(time / h) + 1, last)]

    try:
        table = simulate_ssp(
            str(package.ssp),
            stop_time=(line.steps - 0.5) * h,  # FMPy's time is a sum of steps, and so inexact
            step_size=h,
            parameter_set=_parameters(package),
            input={name: feed(values) for name, values in (line.telegrams | line.commands).items()},
        )
    except FMICallException as e:
        raise UserError(f"{line.follower.file}: FMPy's SSP simulation of {package.ssp} failed: {e}") from None
    return {
        name: {v.name: np.asarray(table[f"{name}.{v.name}"], float) for v in outputs}
        for name, outputs in line.outputs.items()
    }


def _parameters(package: Package) -> ParameterSet:
    """The package's own parameter set; FMPy reads a Boolean as text, and takes any text for true."""
    (binding,) = read_ssd(str(package.ssp)).system.parameterBindings
    (parameters,) = binding.parameterValues
    for p in parameters.parameters:
        p.value = BOOLEANS[p.value] if p.type == "Boolean" else p.value
    return parameters


# --- (b) libcosim ---


def run_cosim(line: Line, package: Package) -> dict[str, Values]:
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
    return cosim.values()


class _Cosim:
    """libcosim's execution of an OSP structure."""

    def __init__(self, line: Line, structure: Path) -> None:
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
        self.feeds: list[_Feed] = []
        self.reads: list[_Read] = []

    def wire(self, component: str) -> None:
        """Prepare, type by type, overriding the inputs of a component and reading its outputs."""
        slave = self.execution.slave_index_from_instance_name(component)
        references = {v.name.decode(): v.reference for v in self.execution.slave_variables(slave)}
        inputs = self.inputs[component]
        outputs = [v.name for v in self.line.outputs[component]]
        for kind in KINDS:
            chosen = [v.name for v in self.line.recipes[component].variables.values() if v.kind == kind]
            put = getattr(self.manipulator, f"slave_{kind.lower()}_values")
            get = getattr(self.observer, f"last_{kind.lower()}_values")
            if names := [n for n in chosen if n in inputs]:
                rows = list(zip(*(inputs[n].tolist() for n in names), strict=True))
                self.feeds.append(_Feed(partial(put, slave, [references[n] for n in names]), rows))
            if names := [n for n in outputs if n in chosen]:  # enumerations are in none of the KINDS
                values = np.empty((self.line.steps, len(names)))
                self.reads.append(_Read(partial(get, slave, [references[n] for n in names]), component, names, values))

    def step(self, i: int) -> None:
        """The step with this number.

        Raises:
            UserError: the step failed.
        """
        for feed in self.feeds:
            feed.give(i)
        if not self.execution.step() or self.execution.status().state == self.failed:
            raise UserError(f"{self.structure}: libcosim failed at {i * self.line.step_size:g} s")
        for read in self.reads:
            read.values[i] = read.get()

    def values(self) -> dict[str, Values]:
        """The outputs of each component at the ends of the steps."""
        found: dict[str, Values] = {name: {} for name in self.line.outputs}
        for read in self.reads:
            found[read.component] |= dict(zip(read.names, read.values.T, strict=True))
        return found


@dataclass(frozen=True)
class _Feed:
    """Inputs of one type of an FMU in libcosim.

    Attributes:
        put: the function that overrides the inputs.
        rows: the values of the inputs in each step.
    """

    put: Callable[[list[Any]], Any]
    rows: list[tuple[Any, ...]]

    def give(self, i: int) -> None:
        """Override the inputs for the step with this number; an override stays until the next one."""
        if i == 0 or self.rows[i] != self.rows[i - 1]:
            self.put(list(self.rows[i]))


@dataclass(frozen=True)
class _Read:
    """Outputs of one type of an FMU in libcosim.

    Attributes:
        get: the function that returns the present values of the outputs.
        values: the values at the ends of the steps, shape (steps, names).
    """

    get: Callable[[], list[Any]]
    component: str
    names: list[str]
    values: Reals


# --- one FMU alone ---


def run_alone(
    line: Line, package: Package, name: str, inputs: Inputs, start: Mapping[str, Any] | None = None
) -> Values:
    """The outputs of a component that runs alone with these inputs; `start` replaces some of its start values.

    Raises:
        UserError: the component refused a value or a step; the message has the time and what the component logged.
    """
    with FmuInstance(package.fmus[name]) as fmu:
        outputs = {kind: [v.name for v in line.outputs[name] if fmu.kinds[v.name][1] == kind] for kind in KINDS}
        found = {kind: np.empty((line.steps, len(names))) for kind, names in outputs.items()}
        given = {kind: [n for n in inputs if fmu.kinds[n][1] == kind] for kind in KINDS}
        puts = [
            (getattr(fmu.unit, f"set{kind}"), fmu.references(names), np.array([inputs[n] for n in names]).T.tolist())
            for kind, names in given.items()
            if names
        ]
        gets = [
            (getattr(fmu.unit, f"get{kind}"), fmu.references(names), found[kind]) for kind, names in outputs.items()
        ]
        i = 0
        try:
            _initialize(line, fmu, name, start)
            for i in range(line.steps):
                for put, references, rows in puts:
                    put(references, rows[i])
                fmu.call(fmu.unit.doStep, i * line.step_size, line.step_size)
                for get, references, values in gets:
                    values[i] = get(references)
        except FmuError as e:
            raise UserError(f"{line.follower.file}: at {i * line.step_size:g} s {name} refused: {e}") from None
    return {n: column for kind, names in outputs.items() for n, column in zip(names, found[kind].T, strict=True)}


def _initialize(line: Line, fmu: FmuInstance, name: str, start: Mapping[str, Any] | None = None) -> None:
    """Initialize a component with the line's start values, some of them replaced by `start`."""
    try:
        fmu.initialize({**line.parameters[name], **(start or {})})
    except FmuError as e:
        raise UserError(f"{line.follower.file}: {name} refused its start values: {e}") from None
