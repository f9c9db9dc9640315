"""motionsync sweep-plot"""

import webbrowser
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..pages.console import out
from ..pages.progress import report_progress


class AmountOption(StrEnum):
    """The statistic of the runs in a cell."""

    MEAN = "mean"
    MIN = "min"
    MAX = "max"
    COUNT = "count"


def command(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a sweep: its plan.toml and its parts.")],
    x: Annotated[str, typer.Option("--x", metavar="NAME", help="The column along the x axis, with numbers.")],
    y: Annotated[
        str,
        typer.Option(
            "--y",
            metavar="NAME",
            help="The column along the y axis; Booleans are allowed. Without it, a histogram of x.",
        ),
    ] = "",
    colour: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="The result for the map's colours, or a factor with a line per value; else passed."
        ),
    ] = "",
    amount: Annotated[
        AmountOption | None,
        typer.Option(case_sensitive=False, help="The statistic of the runs in a cell; else the mean."),
    ] = None,
    better: Annotated[
        str, typer.Option(metavar="x=min,y=max", help="The better direction, for the Pareto front; else less of both.")
    ] = "",
    comparisons: Annotated[
        list[str] | None,
        typer.Option("--beside", metavar="NAME", help="A further result over x, next to y; may be repeated."),
    ] = None,
    passed: Annotated[
        str,
        typer.Option(
            metavar="CONDITION", help="When a run counts as passed; else if it meets its scenario's expectations."
        ),
    ] = "",
    output: Annotated[Path | None, typer.Option(help="The page's file; else plot.html in the sweep's folder.")] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
) -> None:
    """Write a page about a sweep: a map, curves, the Pareto front, and how each run is repeated.

    Columns are the factors, the derived values and the results; the message about a wrong name lists them. The page
    shows, depending on x and y:

    \b
        x and y are varied    from which y on the runs pass, over x; the map
        y is a result         y over x, a line for each value of --colour
        both are results      the map, and the Pareto front
        there is no y         the histogram of x, and its quantiles

    Of true_length_errors the histogram has the products of all runs, with their tolerance, and the process capability
    C_pk with its confidence interval.

    The page has cells in place of single rows, and stays below 3 MB. Under the pointer, or with the arrow keys, each
    cell shows how many runs it has, and the command that repeats one of them.

    Examples:

        motionsync sweep-plot out --x master.velocity --y length --passed "late == 0 and skipped == 0" --open

        motionsync sweep-plot out --x master.velocity --y cut_error --colour axis.max_acceleration

        motionsync sweep-plot out --x slave.acceleration.max --y cuts --better x=min,y=max

        motionsync sweep-plot out --x true_length_errors
    """
    from ..api.sweep_plot import sweep_plot

    with report_progress(f"reading {folder}", at_once=False):
        page = sweep_plot(
            folder,
            x=x,
            y=y,
            colour=colour,
            amount=amount or "",
            better=better,
            comparisons=comparisons or [],
            passed=passed,
            output=output,
        )
    out.print(f"page: {escape(page.resolve().as_uri())}")
    if show:
        webbrowser.open(page.resolve().as_uri())
