"""The command line: build FMUs, tell what there is, run scenarios and report."""

import json
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from motionsync.blocks import BLOCKS

from .build import Flavour, Recipe, fmu_path, outdated
from .build import build as build_fmu
from .description import BASES, summary
from .documentation import row
from .errors import UserError, choose
from .references import command_line, csv_text
from .report import write_report
from .scenario import FILE, Scenario, find, load
from .simulation import check, compare, simulate
from .variables import members, variables

app = typer.Typer(
    name="motionsync",
    help="FMI 2.0 co-simulation units of master/slave motion synchronisation.",
    epilog="""Begin with:\n
    motionsync list\n
    motionsync build Synchronizer\n
    motionsync run scenarios/Synchronizer""",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
out = Console(highlight=False, soft_wrap=True)
err = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)

Unit = StrEnum("Unit", [(name, name) for name in BASES])  # type: ignore[misc]
MILLIMETRES = Unit("mm")


def main() -> None:
    """The console script; a mistake of the user is one line and exit status 2."""
    try:
        app()
    except UserError as e:
        err.print(f"motionsync: {e}")
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)


@app.command()
def build(
    fmu: Annotated[list[str] | None, typer.Argument(help="Blocks to build; all if none is named.")] = None,
    flavour: Annotated[
        list[Flavour] | None,
        typer.Option(help="native: compiled; python: in an embedded Python. May be repeated; both if not given."),
    ] = None,
    unit: Annotated[Unit, typer.Option(help="Unit of all positions; velocities follow.")] = MILLIMETRES,
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
    """
    names = fmu or list(BLOCKS)
    starts = dict(_assignment(text) for text in start or [])
    if starts and len(names) != 1:
        raise UserError("--start: name the one block that it is for, as in: motionsync build Synchronizer --start ...")
    recipes = [Recipe(name, unit.value, starts) for name in names]
    for recipe in recipes:
        recipe.block()  # every mistake is told before anything is built
    for recipe in recipes:
        for chosen in flavour or Flavour:
            target = output / chosen / f"{recipe.name}.fmu"
            with err.status(f"building {target}"):
                build_fmu(chosen, recipe, target, err.print)
            out.print(f"{target}  {target.stat().st_size / 1000:.0f} kB, positions in {unit.value}")


def _assignment(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise UserError(f"--start {text}: write NAME=VALUE, as in: --start output_phasing=45")
    return name.strip(), value.strip()


@app.command("list")
def list_all(
    scenarios: Annotated[Path, typer.Option(help="Where scenarios lie.")] = Path("scenarios"),
) -> None:
    """List the blocks that can be built and the scenarios that can be run."""
    blocks = Table("block", "what it does", title="Blocks", title_justify="left", box=None)
    for name, registered in BLOCKS.items():
        blocks.add_row(name, summary(registered.type))
    out.print(blocks)
    if not scenarios.is_dir():
        out.print(f"\nNo scenarios: there is no folder {scenarios}")
        return
    table = Table("path", "title", "source", title="\nScenarios", title_justify="left", box=None)
    for file in sorted(scenarios.rglob(FILE)):
        s = load(file)
        table.add_row(str(file.parent), s.title, s.source)
    out.print(table)


@app.command()
def describe(
    fmu: Annotated[str, typer.Argument(help="A block's name.")],
    unit: Annotated[Unit, typer.Option(help="Unit of all positions.")] = MILLIMETRES,
) -> None:
    """Show a block's variables: name, causality, type and unit, start value, allowed range, meaning.

    Example: motionsync describe Synchronizer
    """
    registered = choose(BLOCKS, fmu, "block")
    block = registered.type()
    out.print(f"{fmu}: {summary(registered.type)}\n")
    table = Table("name", "causality", "type", "unit", "start", "range", "meaning", box=None)
    for v in variables(block):
        r = row(v, unit.value)
        table.add_row(*(r[key] for key in ("name", "causality", "type", "unit", "start", "range", "description")))
    out.print(table)
    for choice in dict.fromkeys(v.cell.type for v in variables(block) if v.choices):
        out.print(f"\n{choice.__name__}: {summary(choice)}")
        for member in members(choice):
            out.print(f"  {member.value:3d} {member.name}: {member.description}")


@app.command()
def run(
    path: Annotated[list[Path], typer.Argument(help="Scenario files, or folders with scenarios in them.")],
    flavour: Annotated[Flavour, typer.Option(help="Which FMU to run.")] = Flavour.PYTHON,
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

        motionsync run scenarios/Synchronizer/start_stop_polynomial

        motionsync run scenarios --step-size 0.007 --no-report
    """
    scenarios = [load(file) for p in path for file in find(p)]
    if step_size is not None and not 0.0 < step_size <= min(s.stop_time for s in scenarios):
        raise UserError(f"--step-size {step_size:g} is not allowed: it must be > 0 and at most the stop time")
    for s in scenarios:
        target = fmu_path(s.recipe, Path("build"), flavour)
        if why := outdated(target, s.recipe):
            build_fmu(flavour, s.recipe, target, err.print)
            err.print(f"{target} was {why}: built")
    results = []
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=err, transient=True, disable=len(scenarios) < 2 or not err.is_terminal) as progress:
        task = progress.add_task("scenarios", total=len(scenarios))
        for s in scenarios:
            progress.update(task, description=s.name)
            results.append(_run(s, flavour, step_size or s.step_size, output, report=not no_report))
            progress.advance(task)
    if as_json:
        print(json.dumps(results, indent=2))
    else:
        for s, result in zip(scenarios, results, strict=True):
            _show(s, result)
    if not all(r["passed"] for r in results):
        raise typer.Exit(1)


def _run(s: Scenario, flavour: Flavour, step_size: float, output: Path, *, report: bool) -> dict[str, Any]:
    """One scenario: what was found, and where it was written."""
    fmu = fmu_path(s.recipe, Path("build"), flavour)
    course = simulate(s, fmu, step_size)
    checks, deviations = check(s, course), compare(s, course)
    folder = output / s.recipe.name / s.name
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / f"{s.recipe.name}_out.csv"
    results.write_text(csv_text(["time", *course.values], course.rows()))
    page = folder / "report.html"
    if report:
        write_report(page, s, course, checks, deviations, step_size)
    return {
        "scenario": str(s.file.parent),
        "title": s.title,
        "fmu": s.recipe.name,
        "step_size": step_size,
        "passed": all(c.passed for c in checks) and all(d.passed for d in deviations),
        "expectations": [{"expected": c.expected, "found": c.found, "passed": c.passed} for c in checks],
        "reference": [
            {"variable": d.name, "max_difference": d.greatest, "at": d.at, "allowed": d.allowed, "passed": d.passed}
            for d in deviations
        ],
        "messages": course.messages,
        "result": str(results),
        "report": str(page) if report else None,
        "fmpy": command_line(s, fmu),
    }


def _show(s: Scenario, result: dict[str, Any]) -> None:
    mark = "[green]as expected[/]" if result["passed"] else "[red]NOT as expected[/]"
    out.print(f"[bold]{s.title}[/] ({result['scenario']}): {mark}")
    for c in result["expectations"]:
        out.print(f"  {'kept  ' if c['passed'] else '[red]broken[/]'}  {c['expected']}: found {c['found']}")
    for d in result["reference"]:
        out.print(
            f"  {'kept  ' if d['passed'] else '[red]broken[/]'}  {d['variable']}: max |difference| "
            f"{d['max_difference']:.2g} from the reference, {d['allowed']:.2g} allowed"
        )
    for message in result["messages"]:
        out.print(f"  the FMU logged: {message}")
    out.print(f"  result: {result['result']}")
    if result["report"]:
        out.print(f"  report: {result['report']}")
    out.print(f"  the same with FMPy alone: {result['fmpy']}\n")
