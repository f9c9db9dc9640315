"""What `motionsync sweep-plot` does."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Sequence
from pathlib import Path

from ..optional_dependencies import require


def sweep_plot(
    folder: str | Path,
    *,
    x: str,
    y: str = "",
    colour: str = "",
    amount: str = "",
    better: str = "",
    comparisons: Sequence[str] = (),
    passed: str = "",
    output: str | Path | None = None,
) -> Path:
    """Write a page about a sweep: a map, curves, the Pareto front, and how each run is repeated; return its path.

    Args:
        folder: of the sweep.
        x: the column along the horizontal axis.
        y: the column along the vertical axis; without it the page has a histogram of x.
        colour: the result that the map's colours show, or a factor with a line for each value; by default whether runs
            passed.
        amount: the statistic of the runs in a cell, `"mean"`, `"min"`, `"max"` or `"count"`.
        better: the better direction for the Pareto front, `"x=min,y=max"`; by default less of both.
        comparisons: further results over x, next to y.
        passed: when a run counts as passed, `"late == 0 and skipped == 0"`; by default if it is as expected.
        output: the page's file; by default `plot.html` in the folder.

    Raises:
        UserError: the folder is none of a sweep, or what is asked for has no answer; the message lists the columns.
    """
    require("sweep", "duckdb", "pyarrow", "scipy")
    from ..sweeps.plot.page import make_page  # noqa: PLC0415 (part of an extra, like the next one)
    from ..sweeps.plot.view import Question  # noqa: PLC0415

    question = Question(x, y, colour, amount, better, comparisons, passed)
    return make_page(Path(folder), question, Path(output) if output else None)
