"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TextIO

import numpy as np

from ..paths import replace_files
from ..scenario.evaluate.expectations import check_expectations
from ..scenario.evaluate.key_figures import compute_key_figures
from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.evaluate.reference_comparison import compare_with_reference
from ..scenario.evaluate.reference_files import command_line, inputs_file, write_csv, write_inputs
from ..scenario.files.shipped import scenario_name
from ..scenario.recording import Reals, Recording
from ..scenario.scenario import Scenario
from .report.page import NO_CHANGES, with_recorded_settings, write_report

FIRST = ("state", "in_sync")  # columns of the CSV file, after time, master and slave
ROWS = 1000  # of the CSV file, that are made at a time: as Python's numbers they need a multiple of the memory
MASTER = ("position", "velocity", "acceleration", "jerk")


def write_outcome(
    scenario: Scenario,
    fmu: Path,
    recording: Recording,
    folder: Path,
    changes_to_file: Mapping[str, str] = NO_CHANGES,
    *,
    own_step: bool,
    report: bool,
) -> ScenarioOutcome:
    """Evaluate a recording, and write the results into the folder.

    `changes_to_file`: values in place of those in the scenario's file: then neither the reference nor the inputs next
    to the file belong to the run;
    `own_step`: whether the step size of the run is the one in the file, so that those inputs belong to it.

    Raises:
        UserError: the scenario's reference cannot be used.
    """
    name = scenario.recipe.name
    checks = check_expectations(scenario, recording)
    deviations = [] if changes_to_file else compare_with_reference(scenario, recording)
    inputs, results, page = inputs_file(scenario), folder / f"{name}_out.csv", folder / "report.html"
    with replace_files(folder) as part:
        with (part / results.name).open("w") as out:
            write_outputs(out, scenario, recording)
        if changes_to_file or not own_step or not inputs.exists():  # a user's own scenario may have no such file
            inputs = folder / inputs.name
            with (part / inputs.name).open("w") as out:
                write_inputs(out, with_recorded_settings(scenario, recording))
        if report:
            step_size = scenario.step_size
            write_report(
                part / page.name, scenario, recording, checks, deviations, step_size, fmu, results, changes_to_file
            )
    return ScenarioOutcome(
        scenario=scenario_name(scenario.file),
        name=scenario.label,
        title=scenario.title,
        fmu=name,
        step_size=scenario.step_size,
        figures=compute_key_figures(scenario, recording),
        expectations=checks,
        reference=deviations,
        messages=recording.messages,
        unmet=[f"{u.expected}: found {u.actual}" for u in recording.unmet if not u.reaction.required],
        result=str(results),
        report=str(page) if report else None,
        fmpy=command_line(scenario, fmu, inputs),
        overrides=changes_to_file,
    )


def write_outputs(out: TextIO, scenario: Scenario, recording: Recording) -> None:
    """Write time, the scripted axis, what is measured of it, the slave, the columns that are computed of it, state,
    in_sync, then the other variables; only Reals have a point."""
    kinds = {name: v.kind for name, v in scenario.columns.items()}
    values = recording.columns
    slave = [name for name in values if name.startswith("slave.")]
    names = [*slave, *recording.computed, *(name for name in FIRST if name in values)]
    names += [name for name in values if name not in names]
    measured = measured_inputs(scenario, recording)
    axis = "true_axis" if scenario.remote else "true.master" if measured else "master"
    types = [float] * (1 + len(MASTER) + len(measured)) + [float if kinds[n] == "Real" else int for n in names]
    columns = [recording.time, *recording.master.T, *measured.values(), *(values[n] for n in names)]

    def rows() -> Iterator[tuple[float, ...]]:
        for i in range(0, len(recording.time), ROWS):
            parts = (column[i : i + ROWS] for column in columns)
            yield from zip(*(part.astype(t).tolist() for part, t in zip(parts, types, strict=True)), strict=True)

    write_csv(out, ["time", *(f"{axis}.{n}" for n in MASTER), *measured, *names], rows())


def measured_inputs(scenario: Scenario, recording: Recording) -> dict[str, Reals]:
    """What the encoder says of the master at the communication points, by the names of the inputs; none without one."""
    encoder, line = scenario.encoder, recording.script or scenario.master
    if not encoder or scenario.is_recorded:
        return {}
    rows = [encoder.inputs(line, t, scenario.step_size, scenario.period)[:2] for t in recording.time.tolist()]
    return dict(zip(("master.position", "master.velocity"), np.array(rows).T, strict=True))
