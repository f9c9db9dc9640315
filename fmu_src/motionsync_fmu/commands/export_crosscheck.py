"""motionsync export-crosscheck"""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..pages.console import out
from ..pages.progress import report_progress


def command(
    folder: Annotated[Path, typer.Argument(help="Where to write, such as a clone of the cross-check's repository.")],
    model: Annotated[
        list[str] | None, typer.Argument(help="Scenarios, or blocks, whose examples are taken; else all blocks.")
    ] = None,
) -> None:
    """Write FMUs with inputs and references for the FMI cross-check.

    Each goes to FOLDER/fmus/2.0/cs/PLATFORM/motionsync/VERSION/MODEL/: the native FMU with its start values baked
    in, MODEL_in.csv, MODEL_ref.csv, MODEL_ref.opt and README.md. The references come from solutions that are
    independent of the FMUs.

    Examples:

        motionsync export-crosscheck fmi-cross-check

        motionsync export-crosscheck fmi-cross-check Gearing Synchronizer/polynomial
    """
    from ..api.export_crosscheck import export_crosscheck

    export_crosscheck(
        folder, model or [], report=report_progress, exported=lambda written: out.print(escape(str(written)))
    )
