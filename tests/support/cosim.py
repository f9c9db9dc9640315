"""A line in libcosim: the second opinion on FMPy's co-simulation of its package."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.production_line.line import REMOTE, ProductionLine
from motionsync_fmu.production_line.package import LinePackage
from motionsync_fmu.production_line.runs import Inputs, Values
from motionsync_fmu.scenario.recording import Reals

KINDS = ("Real", "Integer", "Boolean")
CLASSES = ("CosimExecution", "CosimLogging", "CosimManipulator", "CosimObserver")


def run_cosim(line: ProductionLine, package: LinePackage) -> dict[str, Values]:
    """The outputs of each component, by libcosim's fixed-step co-simulation of the OSP structure; telegrams and
    commands override the inputs. It cannot read enumerations: these are missing. The test is skipped without it."""
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
        pytest.importorskip("libcosimpy")
        execution, logging, manipulator, observer = (import_module(f"libcosimpy.{name}") for name in CLASSES)
        logging.log_output_level(logging.CosimLogLevel.ERROR)
        self.execution = execution.CosimExecution.from_osp_config_file(str(structure))
        self.line = line
        self.inputs: Mapping[str, Inputs] = {REMOTE: line.telegrams, line.follower.recipe.name: line.commands}
        self.failed = import_module("libcosimpy.CosimEnums").CosimExecutionState.ERROR.value
        self.manipulator = manipulator.CosimManipulator.create_override()
        self.observer = observer.CosimObserver.create_last_value()
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
        """Do the step with this number."""
        for override, rows in self.overrides:
            if i == 0 or rows[i] != rows[i - 1]:  # an override stays until the next one
                override(list(rows[i]))
        assert self.execution.step()
        assert self.execution.status().state != self.failed, f"at {i * self.line.step_size:g} s"
        for get, values in self.reads:
            values[i] = get()
