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

from .. import places
from ..build import Flavour
from ..builds import chosen, ready
from ..errors import Interrupted, UserError
from ..interface.recipe import Fmi
from ..pages.console import err, out
from ..pages.progress import doing
from .options import Version, assignments

if TYPE_CHECKING:
    from ..scenario.outcome import Outcome
    from ..scenario.scenario import Scenario


def _seconds(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UserError(f"--step-size {text}: it must be a number of seconds, as 0.005") from None


def run(
    path: Annotated[list[Path], typer.Argument(help="Scenario files, or folders with scenarios in them.")],
    flavour: Annotated[
        Flavour | None, typer.Option(case_sensitive=False, help="Which FMU to run; native if it can be compiled.")
    ] = None,
    fmi: Version = Fmi.TWO,
    step_size: Annotated[
        float | None, typer.Option(parser=_seconds, metavar="SECONDS", help="Instead of the scenario's own.")
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
        Path | None, typer.Option(help="Where results and reports go: OUTPUT/<FMU>/<scenario>/; else to build/reports.")
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the report in the browser.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print all that was judged and logged.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Run scenarios through their FMUs with FMPy, compare with expectations and reference, write CSV and report.

    A scenario has one line: ok or NOT, its name, its cuts or pieces, and the slave's greatest velocity v, acceleration
    a (or deceleration d) and jerk j beside the limits of its axis. A ! marks what is not judged, but has to be known.

    With --set the scenario is run with other values, as in a run of a sweep: its expectations are judged, its reference
    is not compared, and the results go to a folder of their own.

    Without an up-to-date FMU in build/<flavour>/ or build/fmi3/, one for this machine is built in the user's cache. The
    exit status is 1 if anything was not as expected.

    Examples:

        motionsync run Synchronizer/polynomial --open

        motionsync run FlyingSaw --step-size 0.007 --no-report

        motionsync run CutToLength/basic_cut --set master.velocity=650 --set axis.max_acceleration=4000
    """
    if show and no_report:
        raise UserError("--open shows the report, which --no-report leaves out")
    flavour = chosen(fmi, [flavour] if flavour else [], err.print)[0]
    given = assignments("--set", setting or [], "master.velocity=500")
    batch = _loaded(path, given, step_size)
    fmus = ready([replace(s.recipe, fmi=fmi) for s in batch.scenarios], flavour)
    fmu_of = dict(zip((s.label for s in batch.scenarios), fmus, strict=True))
    folder = output or places.output(err.print) / "reports"

    def judged(s: "Scenario") -> "Outcome":
        return _run(s, fmu_of[s.label], folder, given, own_step=step_size is None, report=not no_report)

    try:
        batch.go(judged, lambda outcome: None if as_json else _print(outcome, batch, verbose=verbose))
    finally:  # after an interruption, too
        _close(batch, folder, as_json=as_json, show=show)
    if batch.refused:
        raise UserError("; ".join(map(str, batch.refused)))
    if not all(outcome.passed for outcome in batch.outcomes):
        raise typer.Exit(1)


@dataclass
class _Batch:
    """Scenarios that are run one after the other, and what has become of them.

    Attributes:
        left_out: the names of scenarios without a result, by the reason.
        refused: why scenarios have no result although they were run.
    """

    scenarios: "list[Scenario]"
    left_out: dict[str, list[str]]
    outcomes: "list[Outcome]" = field(default_factory=list)
    refused: list[UserError] = field(default_factory=list)

    @property
    def alone(self) -> bool:
        """Whether there is one scenario, whose result may have many lines."""
        return len(self.scenarios) == 1 and (not self.left_out or bool(self.refused))

    def go(self, judged: "Callable[[Scenario], Outcome]", show: "Callable[[Outcome], None]") -> None:
        """Run all; show each outcome as soon as it is there.

        Raises:
            Interrupted: the user broke it off.
        """
        for number, s in enumerate(self.scenarios, 1):
            try:
                with doing(f"running {s.label} ({number} of {len(self.scenarios)})", at_once=False):
                    outcome = judged(s)
            except UserError as e:  # told at the end: the other scenarios' results are kept
                self.refused.append(e)
                self.left_out.setdefault("refused, as told below", []).append(s.label)
                continue
            except KeyboardInterrupt:
                raise Interrupted(f"interrupted after {number - 1} of {len(self.scenarios)}") from None
            self.outcomes.append(outcome)
            show(outcome)


def _loaded(paths: list[Path], given: Mapping[str, str], step_size: float | None) -> _Batch:
    """The scenarios at these paths, with other values where some are given. Every mistake in them is reported before
    anything runs."""
    from ..scenario.reader import MOST_STEPS, load
    from ..sweep.repeat import with_values

    files = [file for path in paths for file in _files(path)]
    scenarios = [with_values(file, given) if given else load(file) for file in files]
    folders: dict[str, Path] = {}
    for s in scenarios:
        if (other := folders.setdefault(s.label, s.file)) != s.file:
            raise UserError(f"{other} and {s.file} would write to the same folder {s.label}")
    if step_size is None:
        return _Batch(scenarios, {})
    if not 0.0 < step_size <= min(s.stop_time for s in scenarios):
        raise UserError(f"--step-size {step_size:g} is not allowed: it must be > 0 and at most the stop time")
    if (longest := max(s.stop_time for s in scenarios)) / step_size > MOST_STEPS:
        raise UserError(f"--step-size {step_size:g} makes more than {MOST_STEPS:,} steps up to {longest:g} s")
    left_out: dict[str, list[str]] = {}
    for s in scenarios:
        if reason := s.step_refusal(step_size):
            left_out.setdefault(reason, []).append(s.label)
    kept = [replace(s, step_size=step_size) for s in scenarios if not s.step_refusal(step_size)]
    if not kept:
        raise UserError(f"--step-size {step_size:g}: {'; '.join(left_out)}")
    return _Batch(kept, left_out)


def _files(path: Path) -> list[Path]:
    """The scenario files at a path; a line is told where to go."""
    from ..scenario.shipped import LINES, find

    try:
        found = find(path)
    except UserError as no_scenario:
        try:
            found = find(path, LINES)
        except UserError:
            raise no_scenario from None
    if any(file.match(LINES) for file in found):
        raise UserError(f"{path}: this is a line, which another command runs: motionsync line {path}")
    return found


def _run(
    s: "Scenario", fmu: Path, output: Path, given: Mapping[str, str], *, own_step: bool, report: bool
) -> "Outcome":
    from ..pages.results import write_outcome
    from ..scenario.run import simulate

    recording = simulate(s, fmu, s.step_size)
    folder = output / (f"{s.label}-{_short(given)}" if given else s.label)
    return write_outcome(s, fmu, recording, folder, given, own_step=own_step, report=report)


def _short(given: Mapping[str, str]) -> str:
    """A short text that is another one for other values."""
    return sha256(json.dumps(sorted(given.items())).encode()).hexdigest()[:8]


def _print(outcome: "Outcome", batch: _Batch, *, verbose: bool) -> None:
    from ..pages.summary import print_result, print_row

    if batch.alone or verbose:
        print_result(outcome, verbose=verbose)
    else:
        print_row(outcome, max(len(s.label) for s in batch.scenarios))


def _close(batch: _Batch, output: Path, *, as_json: bool, show: bool) -> None:
    """Print the summary and, last, the report's address, or everything as JSON; open the report if asked to."""
    from ..pages.overview import write_overview
    from ..pages.summary import print_summary

    if as_json:
        print(json.dumps([outcome.as_json() for outcome in batch.outcomes], indent=2))
    elif not batch.alone:
        print_summary(batch.outcomes, batch.left_out)
    reports = [Path(outcome.report) for outcome in batch.outcomes if outcome.report]
    if not reports:
        return
    page = reports[0] if batch.alone else output / "index.html"
    if not batch.alone:
        write_overview(page, batch.outcomes, batch.left_out)
    address = page.resolve().as_uri()
    if not as_json:
        out.print(f"report: {escape(address)}")
    if show:
        webbrowser.open(address)
