"""motionsync export-crosscheck"""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..archive import build_time
from ..errors import UserError
from ..extras import how_to_install, missing_for_native
from ..pages.console import out
from ..pages.progress import doing


def export_crosscheck(
    folder: Annotated[Path, typer.Argument(help="Where to put all: a clone of the cross-check's repository, say.")],
    model: Annotated[
        list[str] | None, typer.Argument(help="Blocks, which stand for their examples, or scenarios; else all blocks.")
    ] = None,
) -> None:
    """Write FMUs with inputs and references for the FMI cross-check.

    Each goes to FOLDER/fmus/2.0/cs/<platform>/motionsync/<version>/<model>/: the native FMU with its start values baked
    in, <model>_in.csv, <model>_ref.csv, <model>_ref.opt and README.md. The references come from solutions that are
    independent of the FMUs.

    Examples:

        motionsync export-crosscheck fmi-cross-check

        motionsync export-crosscheck fmi-cross-check Gearing Synchronizer/polynomial
    """
    from ..crosscheck import export, models

    if missing := missing_for_native():
        raise UserError(f"{missing} is not installed, with which the FMUs are built: {how_to_install('native')}")
    build_time()  # refuses a bad SOURCE_DATE_EPOCH
    for each in models(model or []):
        with doing(f"building {each.name}") as tell:
            places = export(each, folder, tell)
        for place in places:
            out.print(escape(str(place)))
