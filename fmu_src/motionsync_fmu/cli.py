"""The command line: build FMUs, list and describe them, run scenarios and report the results.

Each command imports what it needs: the libraries of all of them together take a second to load.
"""

import io
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from motionsync.blocks import BLOCKS

from .build import Flavour, fmu_path, outdated
from .build import build as build_fmu
from .errors import UserError
from .interface.recipe import Recipe
from .interface.units import BASES
from .interface.variables import summary
from .pages.console import err, out, print_outcome, print_variables, wide

if TYPE_CHECKING:
    from .line.judge import Result
    from .line.line import Line
    from .line.package import Package
    from .scenario.outcome import Outcome
    from .scenario.scenario import Scenario

app = typer.Typer(
    name="motionsync",
    help="FMI 2.0 co-simulation units of master/slave motion synchronisation.",
    epilog="""Begin with:\n
    motionsync list\n
    motionsync build Synchronizer\n
    motionsync run scenarios/Synchronizer\n
    motionsync line scenarios/line""",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
UNITS = "|".join(BASES)
USAGE: Any = typer.BadParameter.__base__  # what typer raises at wrong usage; it has no public name of its own


def main() -> None:
    """The console script. A mistake of the user is reported in one line, with exit status 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a console without ± still prints the rest
    try:
        sys.exit(app(standalone_mode=False))  # the status that a command gave to typer.Exit; else None, which is 0
    except USAGE as e:
        text = e.format_message()  # if no argument was given, this text is the help
        err.print(text if len(sys.argv) == 1 else f"motionsync: {' '.join(text.split())}")
        sys.exit(2)
    except UserError as e:
        err.print(f"motionsync: {' '.join(str(e).split())}")
        sys.exit(2)
    except OSError as e:  # a folder that cannot be written, a full disk
        err.print(f"motionsync: {e.filename}: {e.strerror}" if e.filename else f"motionsync: {e}")
        sys.exit(2)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(130)


@app.command()
def build(
    fmu: Annotated[list[str] | None, typer.Argument(help="Blocks to build; all if none is named.")] = None,
    flavour: Annotated[
        list[Flavour] | None,
        typer.Option(help="native: compiled; python: in an embedded Python. May be repeated; both if not given."),
    ] = None,
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; velocities follow.")] = "mm",
    slave_unit: Annotated[
        str,
        typer.Option(metavar=UNITS, help="Unit of the slave's positions, of a block that tells them apart (Follower)."),
    ] = "",
    start: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Bake in a start value; may be repeated. For one block only."),
    ] = None,
    output: Annotated[Path, typer.Option(help="Where to put the FMUs: OUTPUT/<flavour>/<FMU>.fmu.")] = Path("build"),
) -> None:
    """Build FMUs.

    Examples:

        motionsync build

        motionsync build Synchronizer --unit deg --flavour native

        motionsync build Synchronizer --start curve=PARABOLA --start output_phasing=45

        motionsync build Follower --unit mm --slave-unit deg
    """
    names = fmu or list(BLOCKS)
    starts = dict(_assignment(text) for text in start or [])
    if starts and len(names) != 1:
        raise UserError("--start: name the one block that it is for, as in: motionsync build Synchronizer --start ...")
    recipes = [Recipe(name, unit, starts, slave_unit) for name in names]
    for recipe in recipes:
        recipe.block()  # reports every mistake before anything is built
    for recipe in recipes:
        for chosen in flavour or Flavour:
            target = fmu_path(recipe, output, chosen)
            with err.status(f"building {target}"):
                build_fmu(chosen, recipe, target, err.print)
            of_slave = f", the slave's in {slave_unit}" if slave_unit not in ("", unit) else ""
            out.print(f"{escape(str(target))}  {target.stat().st_size / 1000:.0f} kB, positions in {unit}{of_slave}")


def _assignment(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise UserError(f"--start {text}: write NAME=VALUE, as in: --start output_phasing=45")
    return name.strip(), value.strip()


@app.command("list")
def list_all(
    scenarios: Annotated[Path, typer.Option(help="Where scenarios lie.")] = Path("scenarios"),
) -> None:
    """List the blocks that can be built, and the scenarios and lines that can be run.

    Example: motionsync list --scenarios scenarios/Synchronizer
    """
    from .line.reader import PATTERN, load_line
    from .scenario.reader import FILE, load

    blocks = Table("block", "what it does", title="Blocks", title_justify="left", box=None)
    for name, block_type in BLOCKS.items():
        blocks.add_row(name, summary(block_type))
    wide.print(blocks)
    if not scenarios.is_dir():
        out.print(f"\nNo scenarios: there is no folder {escape(str(scenarios))}")
        return
    table = Table("path", "title", "source", title="\nScenarios", title_justify="left", box=None)
    for file in sorted(scenarios.rglob(FILE)):
        s = load(file)
        table.add_row(str(file.parent), s.title, s.source)
    wide.print(table)
    lines = Table("path", "title", "source", title="\nLines", title_justify="left", box=None)
    for file in sorted(scenarios.rglob(PATTERN)):
        s = load_line(file).follower
        lines.add_row(str(file), s.title, s.source)
    if lines.rows:
        wide.print(lines)


@app.command()
def describe(
    fmu: Annotated[str, typer.Argument(help="A block's name, or the path of a built FMU.")],
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; a built FMU has its own.")] = "mm",
    slave_unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of the slave's positions; as for build.")] = "",
) -> None:
    """Show the variables: name, causality, type and unit, start value, allowed range, meaning.

    Examples:

        motionsync describe Synchronizer --unit deg

        motionsync describe build/python/Synchronizer.fmu
    """
    recipe = Recipe(fmu, unit, {}, slave_unit)
    if fmu.endswith(".fmu"):
        from .scenario.fmu_instance import recipe_of

        recipe = recipe_of(Path(fmu))
    block = replace(recipe, starts={}).block()
    out.print(f"{recipe.name}: {summary(type(block))}\n")
    print_variables(block, recipe.unit, recipe.slave_unit, recipe.starts)


@app.command()
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

        motionsync run scenarios/Synchronizer/polynomial

        motionsync run scenarios --step-size 0.007 --no-report
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
    from .scenario.reader import MOST_STEPS, find, load

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
    from .pages.results import write_outcome
    from .scenario.run import simulate

    fmu = fmu_path(s.recipe, Path("build"), flavour)
    recording = simulate(s, fmu, step_size)
    return write_outcome(s, fmu, recording, step_size, output / s.recipe.name / s.name, report=report)


@app.command()
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

        motionsync line scenarios/line

        motionsync line scenarios/line/line.toml --output elsewhere
    """
    from .line.console import print_line
    from .line.outcome import write_outcome
    from .line.package import write_package

    outcomes = []
    for each in _lines(path or [Path("scenarios/line")]):
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
    from .line.reader import PATTERN, load_line
    from .scenario.reader import find

    lines = [load_line(file) for path in paths for file in find(path, PATTERN)]
    files: dict[str, Path] = {}
    for line in lines:
        if (other := files.setdefault(line.name, line.follower.file)) != line.follower.file:
            raise UserError(f"{other} and {line.follower.file} would write to the same package {line.name}.ssp")
    return lines


def _examined(line: "Line", package: "Package") -> "Result":
    from .line.judge import examine

    with err.status(line.name) as status:
        return examine(line, package, lambda text: status.update(f"{line.name}: {text}"))


if __name__ == "__main__":
    main()
