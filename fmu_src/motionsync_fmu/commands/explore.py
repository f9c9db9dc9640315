"""motionsync explore"""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from .. import paths
from ..pages.console import err, out
from ..pages.progress import report_progress


def command(
    subject: Annotated[
        str, typer.Argument(metavar="BLOCK|SCENARIO", help="A block, or a scenario to start with: a file, or a name.")
    ],
    output: Annotated[
        Path | None, typer.Option(help="Where to write the page: OUTPUT/BLOCK.html; else into build/explore.")
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
) -> None:
    """Write a page on which a block is moved by hand, without any tool and without a network.

    The page holds the block itself, compiled to WebAssembly, and all its scenarios. Moving a slider runs the
    whole scenario again. The bits are those of the native FMU, and a run can be saved as a scenario.

    Examples:

        motionsync explore FlyingSaw --open

        motionsync explore CutToLength/cyclic_orders
    """
    from ..api.explore import explore

    folder = output or paths.output_folder(err.print) / "explore"
    page = explore(subject, output=folder, report=report_progress)
    out.print(f"{escape(str(page))}  {page.stat().st_size / 1000:.0f} kB")
    if show:
        webbrowser.open(page.resolve().as_uri())
