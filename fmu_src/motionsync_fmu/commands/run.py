"""motionsync run"""

import json
import webbrowser
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from .. import paths
from ..errors import Interrupted, UserError
from ..fmus.fmu import Flavour
from ..fmus.prebuilt import prepare_fmus, select_flavours
from ..interface.recipe import Fmi
from ..pages.console import err, out
from ..pages.progress import report_progress
from .options import Version, number_parser, parse_assignments

if TYPE_CHECKING:
    from ..scenario.evaluate.outcome import ScenarioOutcome
    from ..scenario.scenario import Scenario


def command(
    path: Annotated[list[Path], typer.Argument(help="Scenario files, or folders with scenarios in them.")],
    flavour: Annotated[
        Flavour | None, typer.Option(case_sensitive=False, help="Which FMU to run; native if it can be compiled.")
    ] = None,
    fmi: Version = Fmi.TWO,
    step_size: Annotated[
        float | None,
        typer.Option(
            parser=number_parser("--step-size", "a number of seconds, as 0.005"),
            metavar="SECONDS",
            help="Instead of the scenario's own.",
        ),
    ] = None,
    setting: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A variable of the block or a number of the scenario, in place of the file's; may be repeated.",
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Target of results and reports: OUTPUT/FMU/SCENARIO/; else build/reports.")
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the report in the browser.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print every check and all log messages.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Run scenarios through their FMUs with FMPy, compare with expectations and reference, write CSV and report.

    One scenario has a line for each figure. Of several scenarios each has one line: ok or NOT, its name, its cuts or
    pieces, and the slave's greatest velocity v, acceleration a (or deceleration d) and jerk j next to the limits of its
    axis. A ! marks a note that is not a failure.

    With --set the scenario is run with other values, as in a run of a sweep: its expectations are checked, its
    reference is not, and the results go to a folder of their own.

    Without an up-to-date FMU in build/FLAVOUR/ or build/fmi3/, one for this machine is built in the user's cache. The
    exit status is 1 if anything was not as expected, and 2 if a file or an argument has a mistake.

    Examples:

        motionsync run Synchronizer/polynomial --open

        motionsync run FlyingSaw --step-size 0.007 --no-report

        motionsync run CutToLength/any_length --set master.velocity=650 --set axis.max_acceleration=4000
    """
    if show and no_report:
        raise UserError("--open shows the report, which --no-report leaves out")
    from ..api.run import run

    flavour = select_flavours(fmi, [flavour] if flavour else [], err.print)[0]
    batch = _load_batch(path, parse_assignments("--set", setting or [], "master.velocity=500"), step_size)
    prepare_fmus([replace(s.recipe, fmi=fmi) for s in batch.scenarios], flavour, report_progress)
    folder = output or paths.output_folder(err.print) / "reports"

    def run_one(s: "Scenario") -> "ScenarioOutcome":
        return run(s, flavour=flavour, fmi=fmi).write(folder / _folder_name(s), report=not no_report)

    try:
        batch.run_all(run_one, lambda outcome: None if as_json else _print_outcome(outcome, batch, verbose=verbose))
    finally:  # after an interruption, too
        _report_batch(batch, folder, as_json=as_json, show=show)
    if batch.errors:
        raise UserError("; ".join(map(str, batch.errors)))
    if not all(outcome.passed for outcome in batch.outcomes):
        raise typer.Exit(1)


@dataclass
class _ScenarioBatch:
    """Scenarios that are run one after the other, and their outcomes.

    Attributes:
        left_out: the names of scenarios without an outcome, by the reason.
        errors: why scenarios have no outcome although they are at the paths.
    """

    scenarios: "list[Scenario]"
    left_out: dict[str, list[str]]
    outcomes: "list[ScenarioOutcome]" = field(default_factory=list)
    errors: list[UserError] = field(default_factory=list)

    @property
    def is_single(self) -> bool:
        """Whether there is one scenario only, whose outcome may have many lines."""
        return len(self.scenarios) == 1 and (not self.left_out or bool(self.errors))

    def run_all(
        self, run_one: "Callable[[Scenario], ScenarioOutcome]", show: "Callable[[ScenarioOutcome], None]"
    ) -> None:
        """Run all scenarios, and show each outcome at once.

        Raises:
            Interrupted: the user interrupted the batch.
        """
        for number, s in enumerate(self.scenarios, 1):
            try:
                with report_progress(f"running {s.label} ({number} of {len(self.scenarios)})", at_once=False):
                    outcome = run_one(s)
            except UserError as e:  # reported at the end, so that the other scenarios have their outcomes
                self.errors.append(e)
                self.left_out.setdefault("refused, for the reason below", []).append(s.label)
                continue
            except KeyboardInterrupt:
                raise Interrupted(f"interrupted after {number - 1} of {len(self.scenarios)}") from None
            self.outcomes.append(outcome)
            show(outcome)


def _load_batch(paths: list[Path], overrides: Mapping[str, str], step_size: float | None) -> _ScenarioBatch:
    """The scenarios at these paths, with the overrides. A mistake is reported before anything runs, but one among the
    several files of a folder leaves out its own scenario only."""
    from ..api.scenario_source import load, with_step_size

    scenarios: list[Scenario] = []
    left_out: dict[str, list[str]] = {}
    errors: list[UserError] = []
    for path in paths:
        files = _find_scenario_files(path)
        for file in files:
            try:
                scenarios.append(load(file, set=overrides))
            except UserError as e:
                if len(files) == 1 or overrides:
                    raise
                errors.append(e)
                left_out.setdefault("not valid, for the reason below", []).append(str(file.parent))
    if errors and not scenarios:
        raise errors[0]
    folders: dict[str, Path] = {}
    for s in scenarios:
        if (other := folders.setdefault(s.label, s.file)) != s.file:
            raise UserError(f"{other} and {s.file} would write to the same folder {s.label}")
    if step_size is None:
        return _ScenarioBatch(scenarios, left_out, errors=errors)
    for s in scenarios:
        if reason := s.step_refusal(step_size):
            left_out.setdefault(reason, []).append(s.label)
    remaining = [with_step_size(s, step_size) for s in scenarios if not s.step_refusal(step_size)]
    if not remaining:
        raise UserError(f"--step-size {step_size:g}: {'; '.join(left_out)}")
    return _ScenarioBatch(remaining, left_out, errors=errors)


def _find_scenario_files(path: Path) -> list[Path]:
    """The scenario files at a path; for a line file the error names the command that runs it."""
    from ..scenario.files.shipped import LINE_FILES, find_files

    try:
        files = find_files(path)
    except UserError as no_scenario:
        try:
            files = find_files(path, LINE_FILES)
        except UserError:
            raise no_scenario from None
    if any(file.match(LINE_FILES) for file in files):
        raise UserError(f"{path}: this is a line, which another command runs: motionsync line {path}")
    return files


def _folder_name(s: "Scenario") -> str:
    """The folder of a scenario's results; one of its own for other values than those of its file."""
    if not s.overrides:
        return s.label
    return f"{s.label}-{sha256(json.dumps(sorted(s.overrides.items())).encode()).hexdigest()[:8]}"


def _print_outcome(outcome: "ScenarioOutcome", batch: _ScenarioBatch, *, verbose: bool) -> None:
    from ..pages.summary import print_result, print_row

    if batch.is_single or verbose:
        print_result(outcome, verbose=verbose)
    else:
        print_row(outcome, max(len(s.label) for s in batch.scenarios))


def _report_batch(batch: _ScenarioBatch, output: Path, *, as_json: bool, show: bool) -> None:
    """Print the summary and the report's address, or everything as JSON; open the report if `show` is true."""
    from ..pages.overview import write_overview
    from ..pages.summary import print_summary

    if as_json:
        print(json.dumps([outcome.as_json() for outcome in batch.outcomes], indent=2))
    elif not batch.is_single:
        print_summary(batch.outcomes, batch.left_out)
    reports = [Path(outcome.report) for outcome in batch.outcomes if outcome.report]
    if not reports:
        return
    page = reports[0] if batch.is_single else output / "index.html"
    if not batch.is_single:
        write_overview(page, batch.outcomes, batch.left_out)
    address = page.resolve().as_uri()
    if not as_json:
        out.print(f"report: {escape(address)}")
    if show:
        webbrowser.open(address)
