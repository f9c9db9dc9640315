"""What `motionsync line` does with a line."""

from __future__ import annotations  # help() shows the types as they are written here

from pathlib import Path

from .. import paths
from ..errors import choose
from ..fmus.fmu import Flavour, ignore
from ..fmus.prebuilt import Report, select_flavours
from ..interface.recipe import Fmi
from ..production_line.evaluation import evaluate_line
from ..production_line.line import ProductionLine
from ..production_line.outcome import LineOutcome, write_outcome
from ..production_line.package import write_package
from ..production_line.reader import load_line
from ..scenario.files.shipped import LINE_FILES, find_scenario
from .shown import shown


def line(
    line: str | Path | ProductionLine,
    *,
    flavour: str | None = None,
    output: str | Path | None = None,
    page: bool = True,
    report: Report | None = None,
) -> LineOutcome:
    """Wire a remote axis through RemoteSync into a follower, and compute its errors with and without RemoteSync.

    The line runs in FMPy's SSP simulation. FMUs that are missing or stale are built first.

    Args:
        line: its file, its short name (`"line/line.toml"`), or a loaded line.
        flavour: of the FMUs that are wired, `"native"` or `"python"`; by default native, if it can be compiled here.
        output: the folder for the package, its FMUs, the outputs and the page; by default `build`.
        page: whether the HTML page is written.
        report: reports a task while it is done; by default this is shown in a notebook only.

    Raises:
        UserError: there is no such line, something in it or in an argument is not allowed, or an FMU refused a value.
    """
    each = line if isinstance(line, ProductionLine) else load_line(find_scenario(Path(line), LINE_FILES))
    requested = [choose({str(f): f for f in Flavour}, flavour, "flavour")] if flavour else []
    (chosen, *_) = select_flavours(Fmi.TWO, requested, ignore)
    folder = Path(output) if output else paths.output_folder(ignore)
    with shown(report)(f"{each.name}: its FMUs") as notify:
        package = write_package(each, chosen, folder, notify)
    with shown(report)(f"{each.name}: its runs") as notify:
        result = evaluate_line(each, package, notify)
    return write_outcome(each, package, result, folder / "reports" / "line" / each.name, report=page)
