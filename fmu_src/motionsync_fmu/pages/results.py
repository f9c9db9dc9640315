"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from collections.abc import Mapping
from pathlib import Path

from ..paths import replace_files
from ..scenario.evaluate.expectations import check_expectations
from ..scenario.evaluate.key_figures import compute_key_figures
from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.evaluate.reference_comparison import compare_with_reference
from ..scenario.evaluate.reference_files import command_line, csv_text, inputs_csv, inputs_file
from ..scenario.files.shipped import scenario_name
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .report.page import NO_CHANGES, with_recorded_settings, write_report

FIRST = ("state", "in_sync")  # columns of the CSV file, after time, master and slave
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
        (part / results.name).write_text(_outputs_csv(scenario, recording))
        if changes_to_file or not own_step or not inputs.exists():  # a user's own scenario may have no such file
            inputs = folder / inputs.name
            (part / inputs.name).write_text(inputs_csv(with_recorded_settings(scenario, recording)))
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


def _outputs_csv(scenario: Scenario, recording: Recording) -> str:
    """Time, the scripted axis, the slave, state and in_sync, then the other variables; only Reals have a point."""
    kinds = {name: v.kind for name, v in scenario.recipe.variables.items()}
    slave = [name for name in recording.values if name.startswith("slave.")]
    names = [*slave, *(name for name in FIRST if name in recording.values)]
    names += [name for name in recording.values if name not in names]
    axis = "true_axis" if scenario.remote else "master"
    columns = [recording.time.tolist(), *recording.master.T.tolist()]
    columns += [(v if kinds[n] == "Real" else v.astype(int)).tolist() for n in names for v in [recording.values[n]]]
    return csv_text(["time", *(f"{axis}.{n}" for n in MASTER), *names], zip(*columns, strict=True))
