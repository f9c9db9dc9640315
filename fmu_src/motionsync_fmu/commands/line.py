"""motionsync line"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import UserError
from ..pages.console import err

if TYPE_CHECKING:
    from ..line.judge import Result
    from ..line.line import Line
    from ..line.package import Package


def line(
    path: Annotated[list[Path] | None, typer.Argument(help="Line files, or folders with line*.toml in them.")] = None,
    output: Annotated[
        Path, typer.Option(help="Where all goes: OUTPUT/<line>.ssp, OUTPUT/<line>/, OUTPUT/reports/line/<line>/.")
    ] = Path("build"),
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Wire a remote axis through RemoteSync into a follower, and report the errors with and without RemoteSync.

    A line file scripts an axis on another controller with a clock of its own. Its telegrams go through the FMU of
    RemoteSync into that of a follower (FlyingSaw, Synchronizer, ...), wired twice: as an SSP package, run by FMPy's SSP
    simulation, and as an OSP system structure, run by libcosim (if libcosimpy is installed: pip install
    'motionsync[line]'). Both must agree. For comparison the follower also sees the raw telegrams, and other estimators.

    FMUs that are missing or stale are built first. The exit status is 1 if anything was not as expected. The format of
    the file is described in scenarios/line/README.md.

    Examples:

        motionsync line

        motionsync line line/line.toml --output elsewhere
    """
    from ..line.console import print_line
    from ..line.outcome import write_outcome
    from ..line.package import write_package

    outcomes = []
    for each in _lines(path or [Path("line")]):
        package = write_package(each, output, err.print)
        result = _examined(each, package)
        folder = output / "reports" / "line" / each.name
        outcomes.append(write_outcome(each, package, result, folder, report=not no_report))
        if not as_json:
            print_line(each, outcomes[-1], result.settled)
    if as_json:
        print(json.dumps([outcome.as_json() for outcome in outcomes], indent=2))
    if not all(outcome.passed for outcome in outcomes):
        raise typer.Exit(1)


def _lines(paths: list[Path]) -> "list[Line]":
    """The lines at these paths; every mistake in them is reported before anything runs."""
    from ..line.reader import load_line
    from ..scenario.shipped import LINES, find

    lines = [load_line(file) for path in paths for file in find(path, LINES)]
    files: dict[str, Path] = {}
    for line in lines:
        if (other := files.setdefault(line.name, line.follower.file)) != line.follower.file:
            raise UserError(f"{other} and {line.follower.file} would write to the same package {line.name}.ssp")
    return lines


def _examined(line: "Line", package: "Package") -> "Result":
    from ..line.judge import examine

    with err.status(line.name) as status:
        return examine(line, package, lambda text: status.update(f"{line.name}: {text}"))
