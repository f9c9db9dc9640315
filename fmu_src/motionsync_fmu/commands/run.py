"""motionsync run"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import places
from ..build import Flavour
from ..builds import at_hand, ready
from ..errors import UserError
from ..pages.console import err, print_outcome
from ..pages.progress import doing

if TYPE_CHECKING:
    from ..scenario.outcome import Outcome
    from ..scenario.scenario import Scenario


def run(
    path: Annotated[list[Path], typer.Argument(help="Scenario files, or folders with scenarios in them.")],
    flavour: Annotated[Flavour | None, typer.Option(help="Which FMU to run; native if it can be compiled.")] = None,
    step_size: Annotated[float | None, typer.Option(help="In s, instead of the scenario's own.")] = None,
    output: Annotated[
        Path | None, typer.Option(help="Where results and reports go: OUTPUT/<FMU>/<scenario>/; else to build/reports.")
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Run scenarios through their FMUs with FMPy, compare with expectations and reference, write CSV and report.

    Without an up-to-date FMU in build/<flavour>/, one for this machine is built in the user's cache. The exit status is
    1 if anything was not as expected.

    Examples:

        motionsync run Synchronizer/polynomial

        motionsync run FlyingSaw --step-size 0.007 --no-report
    """
    scenarios = _loaded(path, step_size)
    fmus = ready([s.recipe for s in scenarios], flavour or at_hand(err.print)[0])
    reports = output or places.output(err.print) / "reports"
    outcomes: list[tuple[Scenario, Outcome]] = []
    refused: list[UserError] = []
    for i, (s, fmu) in enumerate(zip(scenarios, fmus, strict=True), 1):
        try:
            with doing(f"running {s.name} ({i} of {len(scenarios)})", at_once=False):
                outcomes.append((s, _run(s, fmu, step_size or s.step_size, reports, report=not no_report)))
        except UserError as e:  # reported at the end: the other scenarios' results are kept
            refused.append(e)
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


def _run(s: "Scenario", fmu: Path, step_size: float, output: Path, *, report: bool) -> "Outcome":
    from ..pages.results import write_outcome
    from ..scenario.run import simulate

    recording = simulate(s, fmu, step_size)
    return write_outcome(s, fmu, recording, step_size, output / s.recipe.name / s.name, report=report)
