"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from dataclasses import replace
from pathlib import Path

from ..paths import replace_files
from ..scenario.evaluate.csv_files import command_line, write_inputs, write_outputs
from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .report.page import with_recorded_settings, write_report


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
