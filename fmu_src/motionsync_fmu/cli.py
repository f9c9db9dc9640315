"""The command line: build FMUs, tell what there is, run scenarios and report."""

import io
import json
import math
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import fmpy
import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from motionsync.blocks import BLOCKS
from motionsync.var import Unit

from .build import Flavour, fmu_path, outdated
from .build import build as build_fmu
from .errors import UserError, choose
from .interface.recipe import Recipe, check_slave_unit
from .interface.table import groups
from .interface.units import BASES, unit_name
from .interface.variables import members, summary, variables
from .line.judge import Result, examine
from .line.line import Line
from .line.package import Package, write_package
from .line.reader import PATTERN, load_line
from .line.report import write_line_report
from .pages.report import write_report
from .scenario.crosscheck import command_line, csv_text, inputs_csv, inputs_file
from .scenario.cuts import find_cuts
from .scenario.judge import check, compare
from .scenario.reader import FILE, MOST_STEPS, find, load
from .scenario.run import simulate
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
out = Console(highlight=False, soft_wrap=True)
wide = Console(highlight=False, markup=False, width=1000)  # for tables: a terminal breaks lines, it cuts nothing
err = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)
UNITS = "|".join(BASES)
USAGE: Any = typer.BadParameter.__base__  # what typer raises at wrong usage; it has no public name of its own


def main() -> None:
    """The console script; a mistake of the user is one line and exit status 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a console that has no ± still tells the rest
    try:
        sys.exit(app(standalone_mode=False))  # what a command told by typer.Exit; else nothing, which is 0
    except USAGE as e:
        text = e.format_message()  # without any argument it is the help
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
        recipe.block()  # every mistake is told before anything is built
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
    blocks = Table("block", "what it does", title="Blocks", title_justify="left", box=None)
    for name, registered in BLOCKS.items():
        blocks.add_row(name, summary(registered.type))
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
    name, symbol, of_slave, starts = _built(Path(fmu)) if fmu.endswith(".fmu") else (fmu, unit, slave_unit, {})
    registered = choose(BLOCKS, name, "block")
    choose(BASES, symbol, "unit")
    out.print(f"{name}: {summary(registered.type)}\n")
    columns = ("name", "causality", "type", "unit", "start", "allowed_range", "description")
    table = Table(*(column.removeprefix("allowed_") for column in columns), box=None)
    table.columns[0].no_wrap = True
    block = registered.type()
    check_slave_unit(block, of_slave)
    for i, group in enumerate(groups(block, symbol, of_slave)):
        if i:
            table.add_row()
        for row in group.rows:
            shown = replace(row, start=starts.get(row.name, row.start))
            table.add_row(*(getattr(shown, column) for column in columns))
    wide.print(table)
    for choice in dict.fromkeys(v.cell.type for v in variables(block) if v.choices):
        out.print(f"\n{choice.__name__}: {summary(choice)}")
        for member in members(choice):
            out.print(f"  {member.value:3d} {member.name}: {member.description}")


def _built(fmu: Path) -> tuple[str, str, str, dict[str, str]]:
    """A built FMU's block, the unit of its positions, that of its slave's (empty: the same), and its start values."""
    try:
        description = fmpy.read_model_description(str(fmu))
    except Exception as e:  # FMPy raises whatever it meets in a file that is no FMU
        raise UserError(f"{fmu}: not an FMU that can be read: {str(e).strip().splitlines()[0]}") from None
    units = {t.name: t.unit for t in description.typeDefinitions}
    starts = {v.name: v.start for v in description.modelVariables if v.start is not None}
    return description.modelName, units.get("Position") or "1", units.get("SlavePosition") or "", starts


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
    scenarios = _loaded(path, step_size)
    for target, recipe in {fmu_path(s.recipe, Path("build"), flavour): s.recipe for s in scenarios}.items():
        if why := outdated(target, recipe):
            build_fmu(flavour, recipe, target, err.print)
            err.print(f"{target} was {why}: built")
    results: list[tuple[Scenario, dict[str, Any]]] = []
    refused: list[UserError] = []
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=err, transient=True, disable=len(scenarios) < 2 or not err.is_terminal) as progress:
        task = progress.add_task("scenarios", total=len(scenarios))
        for s in scenarios:
            progress.update(task, description=s.name)
            try:
                results.append((s, _run(s, flavour, step_size or s.step_size, output, report=not no_report)))
            except UserError as e:  # told at the end: the other scenarios' results are not lost
                refused.append(e)
            progress.advance(task)
    if as_json:
        print(json.dumps([result for _, result in results], indent=2))
    else:
        for s, result in results:
            _show(s, result)
    if refused:
        raise UserError("; ".join(map(str, refused)))
    if not all(result["passed"] for _, result in results):
        raise typer.Exit(1)


def _loaded(paths: list[Path], step_size: float | None) -> list[Scenario]:
    """The scenarios at these paths; every mistake is told before anything runs."""
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


def _run(s: Scenario, flavour: Flavour, step_size: float, output: Path, *, report: bool) -> dict[str, Any]:
    """One scenario: what was found, and where it was written."""
    fmu = fmu_path(s.recipe, Path("build"), flavour)
    recording = simulate(s, fmu, step_size)
    checks, deviations = check(s, recording), compare(s, recording)
    folder = output / s.recipe.name / s.name
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / f"{s.recipe.name}_out.csv"
    results.write_text(csv_text(["time", *recording.values], recording.rows()))
    inputs = inputs_file(s)
    if not inputs.exists():  # a scenario of the user's own
        inputs = folder / inputs.name
        inputs.write_text(inputs_csv(s))
    page = folder / "report.html"
    if report:
        write_report(page, s, recording, checks, deviations, step_size)
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
        "cuts": [asdict(c) for c in find_cuts(s.cuts, recording)] if s.cuts else [],
        "messages": recording.messages,
        "result": str(results),
        "report": str(page) if report else None,
        "fmpy": command_line(s, fmu, inputs),
    }


def _cuts_told(cuts: list[dict[str, float]], unit: str) -> str:
    """How many cuts there were, and how far the worst one is from its mark."""
    if not cuts:
        return "cuts: none"
    worst = max(range(len(cuts)), key=lambda i: abs(cuts[i]["error"]))
    error, mark = f"{abs(cuts[worst]['error']):.2g} {unit}".strip(), f"{cuts[worst]['mark']:.10g} {unit}".strip()
    return f"cuts: {len(cuts)}, the worst {error} from its mark: cut {worst + 1}, mark {mark}"


def _show(s: Scenario, result: dict[str, Any]) -> None:
    mark = "[green]as expected[/]" if result["passed"] else "[red]NOT as expected[/]"
    out.print(f"[bold]{escape(s.title)}[/] ({escape(result['scenario'])}): {mark}")
    for c in result["expectations"]:
        out.print(f"  {'kept  ' if c['passed'] else '[red]broken[/]'}  {escape(c['expected'])}: found {c['found']}")
    for d in result["reference"]:
        out.print(
            f"  {'kept  ' if d['passed'] else '[red]broken[/]'}  {d['variable']}: max |difference| "
            f"{d['max_difference']:.2g} from the reference, {d['allowed']:.2g} allowed"
        )
    if s.cuts:
        out.print(f"  {_cuts_told(result['cuts'], unit_name(Unit.POSITION, s.unit))}")
    for message in result["messages"]:
        out.print(f"  the FMU logged: {escape(message)}")
    out.print(f"  result: {escape(result['result'])}")
    if result["report"]:
        out.print(f"  report: {escape(result['report'])}")
    out.print(f"  the same with FMPy alone: {escape(result['fmpy'])}\n")


@app.command()
def line(
    path: Annotated[list[Path] | None, typer.Argument(help="Line files, or folders with line*.toml in them.")] = None,
    output: Annotated[
        Path, typer.Option(help="Where all goes: OUTPUT/<line>.ssp, OUTPUT/<line>/, OUTPUT/reports/line/<line>/.")
    ] = Path("build"),
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Wire a remote axis through RemoteSync into a follower, run it, and tell the errors with and without RemoteSync.

    A line file scripts an axis on another controller with a clock of its own. Its telegrams go through the FMU of
    RemoteSync into that of a follower (FlyingSaw, Synchronizer, ...), wired twice: as an SSP package, run by FMPy's SSP
    simulation, and as an OSP system structure, run by libcosim (if libcosimpy is installed: pip install
    'motionsync[line]'). Both must agree. For comparison the follower also sees the raw telegrams, and other estimators.

    FMUs that are missing or stale are built first. The exit status is 1 if anything was not as expected. The format of
    the file is told in scenarios/line/README.md.

    Examples:

        motionsync line scenarios/line

        motionsync line scenarios/line/line.toml --output elsewhere
    """
    lines = [load_line(file) for p in path or [Path("scenarios/line")] for file in find(p, PATTERN)]
    files: dict[str, Path] = {}
    for each in lines:
        if (other := files.setdefault(each.name, each.follower.file)) != each.follower.file:
            raise UserError(f"{other} and {each.follower.file} would write to the same package {each.name}.ssp")
    results = []
    for each in lines:
        package = write_package(each, output, err.print)
        result = _examined(each, package)
        results.append(_line_written(each, package, result, output / "reports" / "line" / each.name, no_report))
        if not as_json:
            _show_line(each, result, results[-1])
    if as_json:
        print(json.dumps(results, indent=2))
    if not all(result["passed"] for result in results):
        raise typer.Exit(1)


def _examined(line: Line, package: Package) -> Result:
    with err.status(line.name) as status:
        return examine(line, package, lambda text: status.update(f"{line.name}: {text}"))


def _line_written(line: Line, package: Package, result: Result, folder: Path, no_report: bool) -> dict[str, Any]:
    """What was found, and where it was written."""
    folder.mkdir(parents=True, exist_ok=True)
    recordings = {"RemoteSync": result.remote, line.follower.recipe.name: result.wired.recording.values}
    columns = {
        f"{component}.{n}": values.tolist() for component, given in recordings.items() for n, values in given.items()
    }
    file = folder / f"{line.name}_out.csv"
    file.write_text(csv_text(["time", *columns], zip(line.times.tolist(), *columns.values(), strict=True)))
    page = folder / "report.html"
    if not no_report:
        write_line_report(page, line, result)
    return {
        "line": str(line.follower.file),
        "title": line.follower.title,
        "passed": result.passed,
        "synced": None if math.isinf(result.synced) else result.synced,
        "before": [asdict(f) for f in result.before],
        "in_sync": [asdict(f) for f in result.after],
        "expectations": [asdict(c) for c in result.checks],
        "agreement": [asdict(a) for a in result.agreements],
        "libcosim_missing": result.missing,
        "ssp": str(package.ssp),
        "osp": str(package.osp),
        "result": str(file),
        "report": None if no_report else str(page),
    }


def _show_line(line: Line, result: Result, written: dict[str, Any]) -> None:
    unit = unit_name(Unit.POSITION, line.unit)
    mark = "[green]as expected[/]" if result.passed else "[red]NOT as expected[/]"
    out.print(f"[bold]{escape(line.follower.title)}[/] ({escape(written['line'])}): {mark}")
    for c in result.checks:
        out.print(f"  {'kept  ' if c.passed else '[red]broken[/]'}  {escape(c.expected)}: found {c.found}")
    if result.missing:
        out.print(f"  [red]not run in libcosim[/]: {escape(result.missing)}")
    for title, rows in (("before", result.before), (f"in sync, from {result.settled:.5g} s on", result.after)):
        shown = {  # heading, figure; what has nothing to tell is left out
            "cuts": [f"{f.cuts}" if f.cuts else "" for f in rows],
            "worst": [_told(f.worst, unit) for f in rows],
            "mean": [_told(f.mean, unit) for f in rows],
            "spread": [_told(f.spread, unit) for f in rows],
            "worst switch": [_told(f.switches, unit) for f in rows],
            "slave, worst": [_told(f.away, unit) for f in rows],
            "jump in a step": [_told(f.jump, unit) for f in rows],
            "index, spread": [_told(f.index, "cycles") for f in rows],
        }
        kept = {heading: texts for heading, texts in shown.items() if any(texts)}
        table = Table(f"  {title}", *kept, box=None)
        for i, f in enumerate(rows):
            table.add_row(f"  {f.name}", *(texts[i] for texts in kept.values()))
        wide.print(table)
    for name in ("ssp", "osp", "result", "report"):
        if written[name]:
            out.print(f"  {name}: {escape(written[name])}")
    out.print()


def _told(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.2g} {unit}".strip()
