"""motionsync search"""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..errors import UserError
from ..extras import need
from ..pages.console import out
from ..pages.progress import counting
from ..scenario.shipped import called, find_one
from .options import Sampling, Scheduler, Seed, Workers, Yes


def _share(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UserError(f"--relative {text}: it must be a number, as 1e-6") from None


def search(
    path: Annotated[Path, typer.Argument(metavar="SCENARIO", help="A scenario's file or folder, or its short name.")],
    vary: Annotated[str, typer.Option(metavar="NAME=LOW..HIGH", help="What is varied, and between which values.")],
    until: Annotated[
        str,
        typer.Option(
            metavar="CONDITION",
            help="What is asked of a row: columns compared with values, joined with and; a column may be a measure.",
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
            parser=_share, metavar="SHARE", help="How near the two values beside a boundary are, as a share of them."
        ),
    ] = 1e-6,
    scheduler: Scheduler = "",
    workers: Workers = None,
    output: Annotated[Path | None, typer.Option(help="A folder for the rows, as Parquet and as CSV.")] = None,
    yes: Yes = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
) -> None:
    """Find the value at which a condition begins to hold, at each point of a grid: the shortest length that works.

    Each point is run at both ends of the range, and then again and again in the middle of what is left of it, until the
    two values beside the boundary are near enough to each other. At the value in the column of what is varied the
    condition holds, at the one in the column .beside it does not; both were run. The column holds says on which side
    of the boundary it does: above a shortest length, below a greatest velocity. If it holds at both ends, or at
    neither, no boundary is looked for, and the row says so. If it changes more than once in the range, one of the
    boundaries is found.

    Examples:

        motionsync search CutToLength/any_length --vary length=50..6000 --until passed --set master.velocity=400:1200:5

        motionsync search CutToLength/any_length --vary master.velocity=100..1400 --until "late == 0 and skipped == 0"
    """
    need("sweep", "distributed", "pyarrow", "scipy")
    from ..errors import choose
    from ..scenario.reader import load
    from ..sweep.boundaries import Search
    from ..sweep.found import print_found, records, write_csv
    from ..sweep.measures import parsed
    from ..sweep.samples import Method
    from ..sweep.search import found

    file = find_one(path)
    wanted = Search.of(
        file,
        vary,
        until,
        setting or [],
        relative=relative,
        samples=samples,
        method=choose({str(m): m for m in Method}, method, "method"),
        seed=seed,
        measures=parsed(measure, load(file).recipe) if measure else {},
        yes=yes,
    )
    with counting(f"searching {called(file)}", "points") as count:
        rows = found(wanted, output=output, workers=workers, scheduler=scheduler, progress=count, tell=count.tell)
    table = write_csv(rows, output) if output else None
    if as_json:
        print(json.dumps(records(rows), indent=2))
        return
    print_found(rows)
    if table:
        out.print(f"rows: {escape(str(table))}")
