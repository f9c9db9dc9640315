"""motionsync explore"""

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from .. import paths
from ..build.fmu import Flavour
from ..build.prebuilt import prepare_fmus
from ..errors import UserError
from ..interface.recipe import Recipe
from ..optional_dependencies import how_to_install, missing_for_native
from ..pages.console import err, out
from ..pages.progress import report_progress

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario


def explore(
    subject: Annotated[
        str, typer.Argument(metavar="BLOCK|SCENARIO", help="A block, or a scenario to start with: a file, or a name.")
    ],
    folder: Annotated[
        Path | None, typer.Option(help="Where to write the page: FOLDER/<block>.html; else into build/explore.")
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
    from ..explore.page import write_page

    if missing := missing_for_native():
        raise UserError(f"{missing} builds the page, and is not installed: {how_to_install('native')}")
    name, scenarios = _find_scenarios(subject)
    (fmu,) = prepare_fmus([Recipe(name)], Flavour.NATIVE)
    target = (folder or paths.output_folder(err.print) / "explore") / f"{name}.html"
    with report_progress(f"writing {target}") as notify:
        write_page(name, scenarios, fmu, target, notify)
    out.print(f"{escape(str(target))}  {target.stat().st_size / 1000:.0f} kB, {len(scenarios)} scenarios")
    if show:
        webbrowser.open(target.resolve().as_uri())


def _find_scenarios(subject: str) -> "tuple[str, list[Scenario]]":
    """The block's name and its scenarios; the page starts with the first one.

    Raises:
        UserError: neither a block nor a scenario has this name, or the scenarios are of several blocks.
    """
    from ..explore.page import scenarios_of
    from ..scenario.files.reader import load_scenario
    from ..scenario.files.shipped import find_files

    if block := {name.lower(): name for name in BLOCKS}.get(subject.lower()):
        return block, scenarios_of(block)
    requested = [load_scenario(file) for file in find_files(Path(subject))]
    names = sorted({s.recipe.name for s in requested})
    if len(names) > 1:
        raise UserError(f"{subject}: scenarios of several blocks, {', '.join(names)}; a page is of one block")
    files = {s.file.resolve() for s in requested}
    return names[0], requested + [s for s in scenarios_of(names[0]) if s.file.resolve() not in files]
