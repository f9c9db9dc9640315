"""motionsync plan-line"""

import json
import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from .. import paths
from ..errors import UserError
from ..pages.console import err, out
from ..pages.progress import report_progress
from .options import UNITS, parse_assignments


def command(
    machine: Annotated[
        Path | None,
        typer.Argument(
            help="A TOML file with a machine's data, or a CutToLength scenario; else the block's own values."
        ),
    ] = None,
    setting: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A parameter of CutToLength or load.NAME, in place of the file's value; may be repeated.",
        ),
    ] = None,
    length: Annotated[
        str, typer.Option(metavar="LENGTHS", help="Lengths to plan for: 500,1000,1500 or a range, 300..3000.")
    ] = "",
    velocity: Annotated[
        str, typer.Option(metavar="VELOCITIES", help="Line velocities to plan for: 400,800 or a range, 100..1200.")
    ] = "",
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; else the file's, else mm.")] = "",
    output: Annotated[
        Path | None, typer.Option(help="Target of the page: OUTPUT/<machine>/report.html; else build/reports/plan.")
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML page.")] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print what every run of the block did.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the plan as JSON.")] = False,
) -> None:
    """Show how fast a line may run, and how short its pieces may be, for a machine that cuts to length.

    For each length: the greatest line velocity, and the velocity above which cuts are lost (in between, the
    approach's reserve is used up). For each line velocity: the shortest length. For both: the parts of the cycle (way
    to the synchronous motion, settling, cut, gap, clearing, way home, rest at home), the stroke, what limits, and what
    one per cent more of a limit, or less of a time, would bring.

    All of it is computed from the machine's data before any cut is made, and then confirmed: the block CutToLength is
    run a millionth below each figure, where it has to make every cut, and a millionth above it, where it has to
    warn, and then to miss some. If it does not, the exit status is 1.

    The file has the block's parameters by name (motionsync describe CutToLength
    lists them); a scenario of CutToLength has its machine in the same table:

    \b
        title = "Saw 3"
        lengths = [500, 1000, 1500]
        velocities = "100..1200"
        [start]
        "axis.max_velocity" = 1500.0
        "tool.cut_time" = 0.25

    With a table [load], as in a scenario, or --set load.mass=120, the plan has the
    rms and the peak of the force that the motor has to give in each cycle, and with
    load.continuous_force and load.peak_force the share of the motor that is used.

    Examples:

        motionsync plan-line CutToLength/basic_cut --open

        motionsync plan-line saw.toml --set axis.max_jerk=400000

        motionsync plan-line --set axis.max_position=650 --length 300..1500
    """
    from ..plan.console import print_plan
    from ..plan.line_plan import make_plan
    from ..plan.reader import check_length, read_machine, read_option
    from ..plan.report import write_plan

    if show and no_report:
        raise UserError("--open shows the page, which --no-report leaves out")
    settings = parse_assignments("--set", setting or [], "axis.max_velocity=1500")
    data, lengths, velocities = read_machine(machine, settings, unit)
    lengths, velocities = read_option("length", length) or lengths, read_option("velocity", velocity) or velocities
    for each in lengths:
        check_length(data, each)
    folder = (output or paths.output_folder(err.print) / "reports" / "plan") / data.name
    with report_progress(f"planning {data.name}", at_once=False):
        plan = make_plan(data, lengths, velocities)
        page = None if no_report else write_plan(plan, folder)
    if as_json:
        print(json.dumps(plan.as_json(), indent=2))
    else:
        print_plan(plan, verbose=verbose)
        if page:
            out.print(f"report: {escape(page.resolve().as_uri())}")
    if page and show:
        webbrowser.open(page.resolve().as_uri())
    if not plan.is_confirmed:
        raise typer.Exit(1)
