"""Writes the results of a run of a scenario: the outputs, the inputs for FMPy, and the report."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from ..scenario.crosscheck import command_line, csv_text, inputs_csv, inputs_file
from ..scenario.figures import figures
from ..scenario.judge import check, compare
from ..scenario.outcome import Outcome
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from ..scenario.shipped import called
from .report.page import AS_FILED, happened, write_report

FIRST = ("state", "in_sync")  # columns of the CSV file, after time, master and slave
MASTER = ("position", "velocity", "acceleration", "jerk")


def write_outcome(
    scenario: Scenario,
    fmu: Path,
    recording: Recording,
    folder: Path,
    given: Mapping[str, str] = AS_FILED,
    *,
    own_step: bool,
    report: bool,
) -> Outcome:
    """Judge a recording, and write it into the folder.

    `given`: what the scenario has in place of its file's values: then neither the reference nor the inputs beside the
    file belong to the run;
    `own_step`: whether the step size of the run is the one in the file, so that those inputs belong to it.

    Raises:
        UserError: the scenario's reference cannot be used.
    """
    name = scenario.recipe.name
    checks, deviations = check(scenario, recording), [] if given else compare(scenario, recording)
    inputs, results, page = inputs_file(scenario), folder / f"{name}_out.csv", folder / "report.html"
    with _filled(folder) as part:
        (part / results.name).write_text(_outputs_csv(scenario, recording))
        if given or not own_step or not inputs.exists():  # a user's own scenario may have no such file
            inputs = folder / inputs.name
            (part / inputs.name).write_text(inputs_csv(happened(scenario, recording)))
        if report:
            step_size = scenario.step_size
            write_report(part / page.name, scenario, recording, checks, deviations, step_size, fmu, results, given)
    return Outcome(
        scenario=called(scenario.file),
        name=scenario.label,
        title=scenario.title,
        fmu=name,
        step_size=scenario.step_size,
        figures=figures(scenario, recording),
        expectations=checks,
        reference=deviations,
        messages=recording.messages,
        unmet=[f"{u.expected}: found {u.found}" for u in recording.unmet if not u.reaction.required],
        result=str(results),
        report=str(page) if report else None,
        fmpy=command_line(scenario, fmu, inputs),
        given=given,
    )


@contextmanager
def _filled(folder: Path) -> Iterator[Path]:
    """A folder to write into, whose files come into `folder` at the end, all together: an interruption leaves none."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=folder.parent, prefix=".part-") as part:
        yield Path(part)
        folder.mkdir(exist_ok=True)
        for file in sorted(Path(part).iterdir()):
            file.replace(folder / file.name)


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
