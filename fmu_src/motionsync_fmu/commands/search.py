"""motionsync search"""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..optional_dependencies import require
from ..pages.console import out
from ..pages.progress import report_count
from ..scenario.files.shipped import find_scenario, scenario_name
from .options import Sampling, Scheduler, Seed, Workers, Yes, number_parser, parse_factors


def command(
    path: Annotated[Path, typer.Argument(metavar="SCENARIO", help="A scenario's file or folder, or its short name.")],
    vary: Annotated[str, typer.Option(metavar="NAME=LOW..HIGH", help="The value to vary, and its range.")],
    until: Annotated[
        str,
        typer.Option(
            metavar="CONDITION",
            help="The condition on a row: columns compared with values, joined with and; a column may be a measure.",
        ),
    ],
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUES", help="The grid, as of motionsync sweep; may be repeated."),
    ] = None,
    samples: Annotated[int | None, typer.Option(help="How often the ranges in --set are sampled.")] = None,
    method: Sampling = "lhs",
    seed: Seed = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=KIND,...", help="Figures of an output at the boundary; may be repeated."),
    ] = None,
    relative: Annotated[
        float,
        typer.Option(
            parser=number_parser("--relative", "a number, as 1e-6"),
            metavar="SHARE",
            help="Distance of the values around a boundary, as a share of them.",
        ),
    ] = 1e-6,
    scheduler: Scheduler = "",
    workers: Workers = None,
    output: Annotated[Path | None, typer.Option(help="A folder for the rows, as Parquet and as CSV.")] = None,
    yes: Yes = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
) -> None:
    """Find the value at which a condition starts to hold, at each point of a grid: the shortest length that works.

    Each point is run at both ends of the range, which is then halved by further runs until the two values around the
    boundary are near enough to each other. Both have a column: at the first value the condition holds, at the second
    one, named .beside, it does not. The column holds shows the side on which the condition holds: above a shortest
    length, below a greatest velocity. If the condition holds at both ends, or at neither, there is no search, and the
    row shows that. If it changes more than once in the range, one of the boundaries is found.

    Examples:

        motionsync search CutToLength/any_length --vary length=50..6000 --until passed --set master.velocity=400:1200:5

        motionsync search CutToLength/any_length --vary master.velocity=100..1400 --until "late == 0 and skipped == 0"
    """
    require("sweep", "distributed", "pyarrow", "scipy")
    from ..api.search import search
    from ..sweeps.measures import parse_texts
    from ..sweeps.search_output import print_boundaries, records, write_csv
    from ..sweeps.sweep_plan import SamplingOptions

    file = find_scenario(path)
    options: SamplingOptions = {"samples": samples, "method": method, "seed": seed, "yes": yes}
    options["measures"] = parse_texts(measure or ())
    grid = parse_factors(setting or [])
    with report_count(f"searching {scenario_name(file)}", "points") as count:
        rows = search(
            file,
            vary=vary,
            until=until,
            set=grid,
            relative=relative,
            output=output,
            workers=workers,
            scheduler=scheduler,
            progress=count,
            notify=count.notify,
            **options,
        )
    table = write_csv(rows, output) if output else None
    if as_json:
        print(json.dumps(records(rows), indent=2))
        return
    print_boundaries(rows)
    if table:
        out.print(f"rows: {escape(str(table))}")
