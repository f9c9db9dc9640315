"""motionsync line"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import paths
from ..errors import UserError
from ..fmus.fmu import Flavour
from ..fmus.prebuilt import available_flavours
from ..pages.console import err
from ..pages.progress import report_progress

if TYPE_CHECKING:
    from ..production_line.line import ProductionLine


def command(
    path: Annotated[list[Path] | None, typer.Argument(help="Line files, or folders with line*.toml in them.")] = None,
    flavour: Annotated[Flavour | None, typer.Option(help="Which FMUs to wire; native if they can be compiled.")] = None,
    output: Annotated[
        Path | None,
        typer.Option(help="Where to write: OUTPUT/LINE.ssp, OUTPUT/LINE/, OUTPUT/reports/line/LINE/; else into build."),
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Wire a remote axis through RemoteSync into a follower, and report the errors with and without RemoteSync.

    A line file scripts an axis on another controller with a clock of its own. Its telegrams go through the FMU of
    RemoteSync into that of a follower (FlyingSaw, Synchronizer, CutToLength, ...), wired in an SSP package, which runs
    in FMPy's SSP simulation. For comparison the follower also sees the raw telegrams, and other estimators.

    FMUs that are missing or stale are built first. The exit status is 1 if anything was not as expected. The format of
    the file is described in scenarios/line/README.md.

    Examples:

        motionsync line

        motionsync line line/line.toml --output elsewhere
    """
    from ..api.line import line
    from ..production_line.console import print_line

    outcomes = []
    lines = _load_lines(path or [Path("line")])
    flavour, output = flavour or available_flavours(err.print)[0], output or paths.output_folder(err.print)
    for each in lines:
        outcomes.append(line(each, flavour=flavour, output=output, page=not no_report, report=report_progress))
        if not as_json:
            print_line(each, outcomes[-1])
    if as_json:
        print(json.dumps([outcome.as_json() for outcome in outcomes], indent=2))
    if not all(outcome.passed for outcome in outcomes):
        raise typer.Exit(1)


def _load_lines(paths: list[Path]) -> "list[ProductionLine]":
    """The lines at these paths; every mistake in them is reported before anything runs."""
    from ..production_line.reader import load_line
    from ..scenario.files.shipped import LINE_FILES, find_files

    lines = [load_line(file) for path in paths for file in find_files(path, LINE_FILES)]
    files: dict[str, Path] = {}
    for line in lines:
        if (other := files.setdefault(line.name, line.follower.file)) != line.follower.file:
            raise UserError(f"{other} and {line.follower.file} would write to the same package {line.name}.ssp")
    return lines
