"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from pathlib import Path

from ..scenario.crosscheck import command_line, csv_text, inputs_csv, inputs_file
from ..scenario.cuts import find_cuts
from ..scenario.judge import check, compare
from ..scenario.outcome import Outcome
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .report.page import write_report


def write_outcome(
    scenario: Scenario, fmu: Path, recording: Recording, step_size: float, folder: Path, *, report: bool
) -> Outcome:
    """Judge a recording, and write it into the folder.

    Raises:
        UserError: the scenario's reference cannot be used.
    """
    name = scenario.recipe.name
    checks, deviations = check(scenario, recording), compare(scenario, recording)
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / f"{name}_out.csv"
    results.write_text(csv_text(["time", *recording.values], recording.rows()))
    inputs = inputs_file(scenario)
    if not inputs.exists():  # a user's own scenario may have no such file
        inputs = folder / inputs.name
        inputs.write_text(inputs_csv(scenario.settled(recording.settings)))
    page = folder / "report.html"
    if report:
        write_report(page, scenario, recording, checks, deviations, step_size, fmu, results)
    return Outcome(
        scenario=str(scenario.file.parent),
        title=scenario.title,
        fmu=name,
        step_size=step_size,
        passed=all(c.passed for c in checks) and all(d.passed for d in deviations),
        expectations=checks,
        reference=deviations,
        cuts=find_cuts(scenario.cuts, recording) if scenario.cuts else [],
        messages=recording.messages,
        result=str(results),
        report=str(page) if report else None,
        fmpy=command_line(scenario, fmu, inputs),
    )
