"""Importers of FMUs: each runs an FMU of the versions that it knows, and gets the bits of FMPy; fmutool's check of one.

Each gives all variables that it can get, initially and after each step.
"""

import logging
from array import array
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.interface.recipe import Fmi
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance, read_description
from tests.support.blocks.runs import BlockRun

Row = dict[str, Any]
COSIM = {  # libcosim's classes, and their modules
    "CosimExecutionState": "CosimEnums",
    "CosimExecution": "CosimExecution",
    "CosimManipulator": "CosimManipulator",
    "CosimObserver": "CosimObserver",
    "CosimLocalSlave": "CosimSlave",
    "CosimLogLevel": "CosimLogging",
    "log_output_level": "CosimLogging",
}


class Logged(FmuInstance):
    """Keeps status and category of each message, too."""

    lines: list[tuple[int, str, str]]

    def _log(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        super()._log(environment, name, status, category, message)
        self.lines = [*getattr(self, "lines", []), (status, category.decode(), message.decode())]


def bits(values: Row) -> Row:
    """The bits of the values, of whole numbers as those of a double; the time, a variable of FMI 3.0 alone, is left
    out."""
    result = dict(zip(values, array("q", array("d", values.values()).tobytes()), strict=True))
    result.pop("time", None)
    return result


def through_fmpy(fmu: Path, run: BlockRun) -> list[Row]:
    with FmuInstance(fmu) as host:
        host.initialize(run.start)
        rows = [bits(host.get())]
        for h, values in run.steps:
            host.step(h, values)
            rows.append(bits(host.get()))
    return rows


def through_fmuloader(fmu: Path, run: BlockRun) -> list[Row]:
    with FmuInstance(fmu) as host:
        fmi, kinds, name, token = host.fmi, host.kinds, host.description.modelName, host.description.guid
    loader = pytest.importorskip(f"fmuloader.fmi{fmi}")
    by_kind: dict[str, dict[str, int]] = {}
    for variable, (reference, kind) in kinds.items():
        by_kind.setdefault(kind.lower(), {})[variable] = reference
    with getattr(loader, f"Fmi{fmi}Slave")(fmu, model_identifier=name) as unit:

        def put(values: Row) -> None:
            for variable, value in values.items():
                reference, kind = kinds[variable]
                getattr(unit, f"set_{kind.lower()}")([reference], [value])

        def look() -> Row:
            values: Row = {}
            for kind, references in by_kind.items():
                values |= zip(references, getattr(unit, f"get_{kind}")(list(references.values())), strict=True)
            return bits(values)

        if fmi == Fmi.THREE:
            unit.instantiate_co_simulation("unit", instantiation_token=token)
            unit.enter_initialization_mode(start_time=0.0)
        else:
            unit.instantiate("unit", loader.Fmi2Type.CO_SIMULATION, guid=token)
            unit.setup_experiment(start_time=0.0)
            unit.enter_initialization_mode()
        put(run.start)
        unit.exit_initialization_mode()
        rows, time = [look()], 0.0
        for h, values in run.steps:
            put(values)
            unit.do_step(time, h)
            time += h
            rows.append(look())
        unit.terminate()
    return rows


# --- importers whose start values are those in the FMU, whose steps are all of one size, and which know no enumerations


def types_by_name(fmu: Path) -> dict[str, tuple[int, str]]:
    """Value references and types of all variables but enumerations, by name; the types are those of FMI 2.0."""
    types = {"Float64": "Real", "Int32": "Integer"}
    variables = read_description(fmu).modelVariables
    return {v.name: (v.valueReference, types.get(v.type, v.type)) for v in variables if v.type != "Enumeration"}


def through_ecos(fmu: Path, run: BlockRun) -> list[Row]:
    """From the first step on. The library of Ecos needs libtbb.so.12 (Debian: libtbb12)."""
    try:
        ecospy = import_module("ecospy")
    except (ImportError, OSError) as e:
        pytest.skip(f"ecospy cannot be loaded: {e}")
    types, rows = types_by_name(fmu), []
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("unit", str(fmu))
        with ecospy.EcosSimulation(structure=structure, step_size=run.steps[0][0]) as simulation:
            set_by = {"Real": simulation.set_real, "Integer": simulation.set_integer, "Boolean": simulation.set_bool}
            get_by = {"Real": simulation.get_real, "Integer": simulation.get_integer, "Boolean": simulation.get_bool}
            simulation.init()
            for _, values in run.steps:
                for name, value in values.items():
                    set_by[types[name][1]](f"unit::{name}", value)
                simulation.step()
                rows.append(bits({name: get_by[kind](f"unit::{name}") for name, (_, kind) in types.items()}))
            simulation.terminate()
    return rows


def load_libcosim() -> dict[str, Any]:
    """libcosim's classes, by name. The test is skipped without it."""
    pytest.importorskip("libcosimpy")
    cosim = {name: getattr(import_module(f"libcosimpy.{module}"), name) for name, module in COSIM.items()}
    cosim["log_output_level"](cosim["CosimLogLevel"].ERROR)
    return cosim


def through_libcosim(fmu: Path, run: BlockRun) -> list[Row]:
    """From the first step on. libcosim has wheels for Linux on x86-64 and for Windows only, and steps in
    nanoseconds: a step of 2^-7 s is one exactly."""
    cosim = load_libcosim()
    execution = cosim["CosimExecution"].from_step_size(step_size=round(run.steps[0][0] * 1e9))
    slave = execution.add_local_slave(cosim["CosimLocalSlave"](fmu_path=str(fmu), instance_name="unit"))
    manipulator, observer = cosim["CosimManipulator"].create_override(), cosim["CosimObserver"].create_last_value()
    assert execution.add_manipulator(manipulator)
    assert execution.add_observer(observer)
    set_by = {
        "Real": manipulator.slave_real_values,
        "Integer": manipulator.slave_integer_values,
        "Boolean": manipulator.slave_boolean_values,
    }
    get_by = {
        "Real": observer.last_real_values,
        "Integer": observer.last_integer_values,
        "Boolean": observer.last_boolean_values,
    }
    types, rows = types_by_name(fmu), []
    names = {kind: [name for name, (_, k) in types.items() if k == kind] for kind in get_by}
    for _, values in run.steps:
        for name, value in values.items():
            reference, kind = types[name]
            assert set_by[kind](slave, [reference], [value])
        assert execution.step()
        assert execution.status().state != cosim["CosimExecutionState"].ERROR.value
        rows.append({})
        for kind, get in get_by.items():
            rows[-1] |= zip(names[kind], get(slave, [types[name][0] for name in names[kind]]), strict=True)
    return [bits(row) for row in rows]


def check_by_fmutool(fmu: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Check that `fmutool -check` finds neither an error nor a warning. A process of its own would import for a second.

    Raises:
        AssertionError: it does; the text is what it says.
    """
    from fmu_manipulation_toolbox.checker import get_checkers  # noqa: PLC0415 (a moment that other tests need not wait)
    from fmu_manipulation_toolbox.operations import FMU  # noqa: PLC0415

    with caplog.at_level(logging.INFO, "fmu_manipulation_toolbox"), FMU(str(fmu)) as opened:
        checkers = [checker() for checker in get_checkers()]
        for checker in checkers:
            opened.apply_operation(checker)
    text = caplog.text
    assert "compliant with FMI-2.0" in text
    assert "No semantic error" in text
    assert all(record.levelno < logging.WARNING for record in caplog.records), text
