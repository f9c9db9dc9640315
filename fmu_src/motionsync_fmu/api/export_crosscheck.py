"""What `motionsync export-crosscheck` does."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Callable, Sequence
from pathlib import Path

from ..errors import UserError
from ..export.crosscheck import export, models
from ..fmus.prebuilt import Report
from ..interface.build_time import build_time
from ..optional_dependencies import how_to_install, missing_for_native
from .shown import shown


def export_crosscheck(
    folder: str | Path,
    model: Sequence[str] = (),
    *,
    report: Report | None = None,
    exported: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Write FMUs with inputs and references for the FMI cross-check; return the folders that have them.

    Args:
        folder: where to write, such as a clone of the cross-check's repository.
        model: scenarios, or blocks, whose examples are taken; all blocks if there are none.
        report: reports a task while it is done; by default this is shown in a notebook only.
        exported: called with each folder as soon as it is written.

    Raises:
        UserError: there is no such block or scenario, one is no model of the cross-check, or the compiler is not
            installed.
    """
    if missing := missing_for_native():
        raise UserError(f"{missing} builds the FMUs, and is not installed: {how_to_install('native')}")
    build_time()  # refuses a bad SOURCE_DATE_EPOCH
    folders: list[Path] = []
    for each in models(model):
        with shown(report)(f"building {each.name}") as notify:
            written = export(each, Path(folder), notify)
        for path in written:
            if exported:
                exported(path)
        folders += written
    return folders
