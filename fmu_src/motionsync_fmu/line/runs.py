"""Runs of a line: by FMPy from the SSP package, by libcosim from the OSP structure, and a follower alone.

Both co-simulations are parallel (Jacobi): in the step from t to t+h each FMU has the inputs that were there at t, and
what it puts out for t+h another one sees in the next step, from t+h on. RemoteSync's output, shifted by
delay_time_offset = h, is the axis at t+h; the follower sees it as START_OF_STEP at t+h. Nothing lags.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssd
from numpy.typing import NDArray

from ..errors import UserError
from ..interface.variables import variables
from ..scenario.fmu_instance import FmuError, FmuInstance
from ..scenario.recording import Reals
from .line import REMOTE, Line
from .package import Package

Inputs = Mapping[str, NDArray[Any]]  # each of shape (steps,)
Values = dict[str, Reals]  # outputs at the ends of the steps, each of shape (steps,)
KINDS = ("Real", "Integer", "Boolean")
BOOLEANS = {"true": True, "false": False}


class MissingLibraryError(Exception):
    """A library is not installed; the text tells how to get it."""


# --- (a) FMPy ---


def run_ssp(line: Line, package: Package) -> dict[str, Values]:
    """FMPy's SSP simulation of the package: of each component, the outputs at the ends of the steps.

    What FMPy does beside the standard: it applies no parameter set of the package but the one it is given; a value at a
    system's input reaches its component one step later, and in the first step all inputs are zero. So the inputs are
    fed at t+h.

    Raises:
        UserError: an FMU refused a value or a step.
    """
    for name in line.recipes:  # FMPy tells nothing of what an FMU logs
        with FmuInstance(package.fmus[name]) as host:
            _initialized(line, host, name)
    h, last = line.step_size, line.steps - 1

    def feed(values: NDArray[Any]) -> Any:
        told = values.tolist()
        return lambda time: told[min(round(time / h) + 1, last)]

    try:
        table = simulate_ssp(
            str(package.ssp),
            stop_time=(line.steps - 0.5) * h,  # its time is a sum of steps, and so inexact
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
    """libcosim's fixed-step co-simulation of the OSP structure; telegrams and commands override the inputs.

    Raises:
        MissingLibraryError: libcosimpy is not installed.
        UserError: libcosim refused the structure or a step.
    """
    try:
        from libcosimpy.CosimEnums import CosimExecutionState  # noqa: PLC0415 (an optional library)
        from libcosimpy.CosimExecution import CosimExecution  # noqa: PLC0415
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level  # noqa: PLC0415
        from libcosimpy.CosimManipulator import CosimManipulator  # noqa: PLC0415
        from libcosimpy.CosimObserver import CosimObserver  # noqa: PLC0415
    except ModuleNotFoundError:
        raise MissingLibraryError("libcosimpy is not installed: pip install 'motionsync[line]'") from None
    log_output_level(CosimLogLevel.ERROR)
    try:
        execution = CosimExecution.from_osp_config_file(str(package.osp))
    except AssertionError as e:
        raise UserError(f"{package.osp}: libcosim refused it: {e}") from None
    manipulator, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    inputs: Mapping[str, Inputs] = {REMOTE: line.telegrams, line.follower.recipe.name: line.commands}
    feeds, reads = [], []
    for name, recipe in line.recipes.items():
        slave = execution.slave_index_from_instance_name(name)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
        for kind in KINDS:
            chosen = [v.name for v in variables(recipe.block()) if v.kind == kind]
            put = getattr(manipulator, f"slave_{kind.lower()}_values")
            get = getattr(observer, f"last_{kind.lower()}_values")
            if names := [n for n in chosen if n in inputs[name]]:
                rows = list(zip(*(inputs[name][n].tolist() for n in names), strict=True))
                feeds.append(_Feed(partial(put, slave, [references[n] for n in names]), rows))
            if names := [v.name for v in line.outputs[name] if v.name in chosen]:
                values = np.empty((line.steps, len(names)))
                reads.append(_Read(partial(get, slave, [references[n] for n in names]), name, names, values))
    for i in range(line.steps):
        for feed in feeds:
            feed.give(i)
        if not execution.step() or execution.status().state == CosimExecutionState.ERROR.value:
            raise UserError(f"{package.osp}: libcosim failed at {i * line.step_size:g} s")
        for read in reads:
            read.values[i] = read.get()
    found: dict[str, Values] = {name: {} for name in line.outputs}
    for read in reads:
        found[read.component] |= dict(zip(read.names, read.values.T, strict=True))
    return found


@dataclass(frozen=True)
class _Feed:
    """Inputs of one type of an FMU in libcosim: how to override them, and their values in each step."""

    put: Callable[[list[Any]], Any]
    rows: list[tuple[Any, ...]]

    def give(self, i: int) -> None:
        """An override stays until the next one."""
        if i == 0 or self.rows[i] != self.rows[i - 1]:
            self.put(list(self.rows[i]))


@dataclass(frozen=True)
class _Read:
    """Outputs of one type of an FMU in libcosim, and room for their values, shape (steps, names)."""

    get: Callable[[], list[Any]]
    component: str
    names: list[str]
    values: Reals


# --- one FMU alone ---


def run_alone(
    line: Line, package: Package, name: str, inputs: Inputs, start: Mapping[str, Any] | None = None
) -> Values:
    """A component of the line, driven by these inputs; `start`: in place of some of its start values.

    Raises:
        UserError: it refused a value or a step; the message has the time and what it logged.
    """
    outputs = {kind: [v.name for v in line.outputs[name] if v.kind == kind] for kind in KINDS}
    found = {kind: np.empty((line.steps, len(names))) for kind, names in outputs.items()}
    with FmuInstance(package.fmus[name]) as host:

        def references(names: Iterable[str]) -> list[int]:
            return [host.kinds[n][0] for n in names]

        groups = {kind: [n for n in inputs if host.kinds[n][1] == kind] for kind in KINDS}
        puts = [
            (getattr(host.unit, f"set{kind}"), references(names), np.array([inputs[n] for n in names]).T.tolist())
            for kind, names in groups.items()
            if names
        ]
        gets = [(getattr(host.unit, f"get{kind}"), references(names), found[kind]) for kind, names in outputs.items()]
        i = 0
        try:
            _initialized(line, host, name, start)
            for i in range(line.steps):
                for put, at, rows in puts:
                    put(at, rows[i])
                host.call(host.unit.doStep, i * line.step_size, line.step_size)
                for get, at, values in gets:
                    values[i] = get(at)
        except FmuError as e:
            raise UserError(f"{line.follower.file}: at {i * line.step_size:g} s {name} refused: {e}") from None
    return {n: column for kind, names in outputs.items() for n, column in zip(names, found[kind].T, strict=True)}


def _initialized(line: Line, host: FmuInstance, name: str, start: Mapping[str, Any] | None = None) -> None:
    try:
        host.initialize({**line.parameters[name], **(start or {})})
    except FmuError as e:
        raise UserError(f"{line.follower.file}: {name} refused its start values: {e}") from None
