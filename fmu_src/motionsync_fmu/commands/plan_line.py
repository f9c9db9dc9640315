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
    machines: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[MACHINE]...",
            help="A TOML file with a machine's data, or a scenario of CutToLength or RotaryKnife; two are compared.",
        ),
    ] = None,
    machine: Annotated[
        str,
        typer.Option(
            metavar="saw|knife|both",
            help="The machine, with the block's own values unless it is in a file; both compares. Without a file: saw.",
        ),
    ] = "",
    setting: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A parameter of the block or load.NAME, in place of the file's value; may be repeated.",
        ),
    ] = None,
    length: Annotated[
        str, typer.Option(metavar="LENGTHS", help="Lengths to plan for: 500,1000 or 6 m or a range, 300..3000.")
    ] = "",
    velocity: Annotated[
        str,
        typer.Option(
            metavar="VELOCITIES", help="Line velocities to plan for: 400,800 or 40 m/min or a range, 100..1200."
        ),
    ] = "",
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; else the file's, else mm.")] = "",
    output: Annotated[
        Path | None, typer.Option(help="Target of the page: OUTPUT/MACHINE/report.html; else build/reports/plan.")
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML page.")] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print what every run of the block did.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the plan as JSON.")] = False,
) -> None:
    """Show how fast a line may run, and how short its pieces may be, for a machine that cuts to length; and
    which of two machines is the better one.

    For each length: the greatest line velocity; for a saw also the velocity above which cuts are lost (in between, the
    approach's reserve is used up). For each line velocity: the shortest length; for a knife also longer ones for which
    that line is too fast. For both: the parts of the cycle, what limits, and what one per cent more of a limit, or less
    of a time, would bring.

    All of it is computed from the machine's data before any cut is made, and then confirmed: the block is run a
    millionth below each figure, where it has to make every cut, and a millionth above it, where it has to warn, and
    then to miss some. If it does not, the exit status is 1.

    A saw is the block CutToLength, a knife RotaryKnife. With --machine both, or with two files, one chart shows over
    length and line velocity where each machine reaches, and a sentence says which one is better: for --length and
    --velocity if they are given, else for what the scenario cuts.

    A file has the block's parameters by name (motionsync describe CutToLength lists them); a scenario has its machine
    in the same table:

    \b
        title = "Saw 3"
        machine = "saw"
        lengths = [500, 1000, 1500]
        velocities = "100..1200"
        [start]
        "axis.max_velocity" = 1500.0
        "tool.cut_time" = 0.25

    With a table [load], as in a scenario, or --set load.mass=120 (load.inertia of a knife), the plan has the rms and
    the peak of the force that the motor has to give in each cycle, and with load.continuous_force and load.peak_force
    the share of the motor that is used.

    Examples:

        motionsync plan-line CutToLength/basic_cut --open

        motionsync plan-line saw.toml --set axis.max_jerk=400000 --set "axis.max_velocity=120 m/min"

        motionsync plan-line --machine knife --set knife.blades=2 --length 150..1500

        motionsync plan-line RotaryKnife/formats --machine both --set CutToLength.axis.max_position=1500 --open
    """
    from ..api.plan_line import plan_line
    from ..plan.console import print_plan

    if show and no_report:
        raise UserError("--open shows the page, which --no-report leaves out")
    settings = parse_assignments("--set", setting or [], "axis.max_velocity=1500")
    target = output or paths.output_folder(err.print) / "reports" / "plan"
    with report_progress("planning the line", at_once=False):
        plan = plan_line(*(machines or ()), machine=machine, set=settings, length=length, velocity=velocity, unit=unit)
        page = None if no_report else plan.report(target / plan.name / "report.html")
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
