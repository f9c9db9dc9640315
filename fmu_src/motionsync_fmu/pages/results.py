"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TextIO

import numpy as np

from ..paths import replace_files
from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.evaluate.reference_files import command_line, write_csv, write_inputs
from ..scenario.recording import Reals, Recording
from ..scenario.scenario import Scenario
from .report.page import with_recorded_settings, write_report

FIRST = ("state", "in_sync")  # columns of the CSV file, after time, master and slave
ROWS = 1000  # of the CSV file, that are made at a time: as Python's numbers they need a multiple of the memory
MASTER = ("position", "velocity", "acceleration", "jerk")


def write_results(
    outcome: ScenarioOutcome, scenario: Scenario, recording: Recording, fmu: Path, folder: Path, *, report: bool
) -> ScenarioOutcome:
    """Write the results of a run into a folder; the outcome that is returned names the files."""
    inputs, results = (folder / f"{scenario.recipe.name}_{kind}.csv" for kind in ("in", "out"))
    page = folder / "report.html" if report else None
    with replace_files(folder) as part:
        with part(results.name).open("w") as out:
            write_outputs(out, scenario, recording)
        with part(inputs.name).open("w") as out:
            write_inputs(out, with_recorded_settings(scenario, recording))
        if page:
            write_report(part(page.name), scenario, recording, outcome, fmu, results)
    shown = str(page) if page else None
    return replace(outcome, result=str(results), report=shown, fmpy=command_line(scenario, fmu, inputs))


def write_outputs(out: TextIO, scenario: Scenario, recording: Recording) -> None:
    """Write all columns of a run; only Reals have a point."""
    kinds = {name: v.kind for name, v in scenario.columns.items()}
    columns = output_columns(scenario, recording)
    types = [float if kinds.get(name, "Real") == "Real" else int for name in columns]

    def rows() -> Iterator[tuple[float, ...]]:
        for i in range(0, len(recording.time), ROWS):
            parts = (column[i : i + ROWS] for column in columns.values())
            yield from zip(*(part.astype(t).tolist() for part, t in zip(parts, types, strict=True)), strict=True)

    write_csv(out, list(columns), rows())


def output_columns(scenario: Scenario, recording: Recording) -> dict[str, Reals]:
    """Time, the scripted axis, what is measured of it, the slave, the columns that are computed of it, state, in_sync,
    then the other variables, each of shape (points,)."""
    values = recording.columns
    slave = [name for name in values if name.startswith("slave.")]
    names = [*slave, *recording.computed, *(name for name in FIRST if name in values)]
    measured = measured_inputs(scenario, recording)
    axis = "true_axis" if scenario.remote else "true.master" if measured else "master"
    master = {f"{axis}.{name}": column for name, column in zip(MASTER, recording.master.T, strict=True)}
    return {"time": recording.time, **master, **measured, **{name: values[name] for name in names}, **values}


def measured_inputs(scenario: Scenario, recording: Recording) -> dict[str, Reals]:
    """What the encoder says of the master at the communication points, by the names of the inputs; none without one."""
    encoder, line = scenario.encoder, recording.script or scenario.master
    if not encoder or scenario.is_recorded:
        return {}
    rows = [encoder.inputs(line, t, scenario.step_size, scenario.period)[:2] for t in recording.time.tolist()]
    return dict(zip(("master.position", "master.velocity"), np.array(rows).T, strict=True))
