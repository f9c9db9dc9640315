"""motionsync run"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..build import Flavour, fmu_path, outdated
from ..build import build as build_fmu
from ..errors import UserError
from ..pages.console import err, print_outcome

if TYPE_CHECKING:
    from ..scenario.outcome import Outcome
    from ..scenario.scenario import Scenario


def run(
    path: Annotated[list[Path], typer.Argument(help="Scenario files, or folders with scenarios in them.")],
    flavour: Annotated[Flavour, typer.Option(help="Which FMU to run.")] = Flavour.NATIVE,
    step_size: Annotated[float | None, typer.Option(help="In s, instead of the scenario's own.")] = None,
    output: Annotated[Path, typer.Option(help="Where results and reports go: OUTPUT/<FMU>/<scenario>/.")] = Path(
        "build/reports"
    ),
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Run scenarios through their FMUs with FMPy, compare with expectations and reference, write CSV and report.

    An FMU that is missing or stale is built first. The exit status is 1 if anything was not as expected.

    Examples:

        motionsync run Synchronizer/polynomial

        motionsync run FlyingSaw --step-size 0.007 --no-report
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    scenarios = _loaded(path, step_size)
    for target, recipe in {fmu_path(s.recipe, Path("build"), flavour): s.recipe for s in scenarios}.items():
        if why := outdated(target, recipe):
            build_fmu(flavour, recipe, target, err.print)
            err.print(f"{target} was {why}: built")
    outcomes: list[tuple[Scenario, Outcome]] = []
    refused: list[UserError] = []
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=err, transient=True, disable=len(scenarios) < 2 or not err.is_terminal) as progress:
        task = progress.add_task("scenarios", total=len(scenarios))
        for s in scenarios:
            progress.update(task, description=s.name)
            try:
                outcomes.append((s, _run(s, flavour, step_size or s.step_size, output, report=not no_report)))
            except UserError as e:  # reported at the end: the other scenarios' results are kept
                refused.append(e)
            progress.advance(task)
    if as_json:
        print(json.dumps([outcome.as_json() for _, outcome in outcomes], indent=2))
    else:
        for s, outcome in outcomes:
            print_outcome(s, outcome)
    if refused:
        raise UserError("; ".join(map(str, refused)))
    if not all(outcome.passed for _, outcome in outcomes):
        raise typer.Exit(1)


def _loaded(paths: list[Path], step_size: float | None) -> "list[Scenario]":
    """The scenarios at these paths; every mistake in them is reported before anything runs."""
    from ..scenario.reader import MOST_STEPS, load
    from ..scenario.shipped import find

    scenarios = [load(file) for path in paths for file in find(path)]
    if step_size is not None and not 0.0 < step_size <= min(s.stop_time for s in scenarios):
        raise UserError(f"--step-size {step_size:g} is not allowed: it must be > 0 and at most the stop time")
    if step_size is not None and (longest := max(s.stop_time for s in scenarios)) / step_size > MOST_STEPS:
        raise UserError(f"--step-size {step_size:g} makes more than {MOST_STEPS:,} steps up to {longest:g} s")
    folders: dict[tuple[str, str], Path] = {}
    for s in scenarios:
        if (other := folders.setdefault((s.recipe.name, s.name), s.file)) != s.file:
            raise UserError(f"{other} and {s.file} would write to the same folder {s.recipe.name}/{s.name}")
    return scenarios


def _run(s: "Scenario", flavour: Flavour, step_size: float, output: Path, *, report: bool) -> "Outcome":
    from ..pages.results import write_outcome
    from ..scenario.run import simulate

    fmu = fmu_path(s.recipe, Path("build"), flavour)
    recording = simulate(s, fmu, step_size)
    return write_outcome(s, fmu, recording, step_size, output / s.recipe.name / s.name, report=report)
