"""A line in libcosim: the second opinion on FMPy's co-simulation of its package."""

from functools import partial

import numpy as np

from motionsync_fmu.production_line.line import REMOTE, ProductionLine
from motionsync_fmu.production_line.package import LinePackage
from motionsync_fmu.production_line.runs import Values
from tests.support.hosts.importers import load_libcosim


def run_cosim(line: ProductionLine, package: LinePackage) -> dict[str, Values]:
    """The outputs of each component, by libcosim's fixed-step co-simulation of the OSP structure; telegrams and
    commands override the inputs. It cannot read enumerations: these are missing. The test is skipped without it."""
    cosim = load_libcosim()
    execution = cosim["CosimExecution"].from_osp_config_file(str(package.osp))
    manipulator, observer = cosim["CosimManipulator"].create_override(), cosim["CosimObserver"].create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    outputs: dict[str, Values] = {}
    overrides, reads = [], []  # of each component and type
    for component, inputs in {REMOTE: line.telegrams, line.follower.recipe.name: line.commands}.items():
        slave = execution.slave_index_from_instance_name(component)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
        outputs[component] = {}
        for kind in ("Real", "Integer", "Boolean"):
            of_kind = {v.name for v in line.recipes[component].variables.values() if v.kind == kind}
            if names := [n for n in inputs if n in of_kind]:
                override = getattr(manipulator, f"slave_{kind.lower()}_values")
                rows = list(zip(*(inputs[n].tolist() for n in names), strict=True))
                overrides.append((partial(override, slave, [references[n] for n in names]), rows))
            if names := [v.name for v in line.outputs[component] if v.name in of_kind]:
                values = np.empty((line.steps, len(names)))
                get = getattr(observer, f"last_{kind.lower()}_values")
                reads.append((partial(get, slave, [references[n] for n in names]), values))
                outputs[component] |= dict(zip(names, values.T, strict=True))
    for i in range(line.steps):
        for override, rows in overrides:
            if i == 0 or rows[i] != rows[i - 1]:  # an override stays until the next one
                override(list(rows[i]))
        assert execution.step()
        assert execution.status().state != cosim["CosimExecutionState"].ERROR.value, f"at {i * line.step_size:g} s"
        for get, values in reads:
            values[i] = get()
    return outputs
