"""motionsync explore"""

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from .. import places
from ..build import Flavour
from ..builds import ready
from ..errors import UserError
from ..extras import how_to_install, missing_for_native
from ..interface.recipe import Recipe
from ..pages.console import err, out
from ..pages.progress import doing

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario


def explore(
    what: Annotated[
        str, typer.Argument(metavar="BLOCK|SCENARIO", help="A block, or a scenario to begin with: a file, or a name.")
    ],
    folder: Annotated[
        Path | None, typer.Option(help="Where to put the page: FOLDER/<block>.html; else into build/explore.")
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
) -> None:
    """Write a page on which a block is moved by hand, without any tool and without a network.

    The page holds the block itself, compiled to WebAssembly, and all its scenarios. A slider that is moved runs the
    whole scenario anew. The bits are those of the native FMU, and a run can be written down as a scenario.

    Examples:

        motionsync explore FlyingSaw --open

        motionsync explore CutToLength/cyclic_orders
    """
    from ..explore.page import write_page

    if missing := missing_for_native():
        raise UserError(f"{missing} is not installed, with which the page is made: {how_to_install('native')}")
    name, scenarios = _chosen(what)
    (fmu,) = ready([Recipe(name)], Flavour.NATIVE)
    target = (folder or places.output(err.print) / "explore") / f"{name}.html"
    with doing(f"writing {target}") as tell:
        write_page(name, scenarios, fmu, target, tell)
    out.print(f"{escape(str(target))}  {target.stat().st_size / 1000:.0f} kB, {len(scenarios)} scenarios")
    if show:
        webbrowser.open(target.resolve().as_uri())


def _chosen(what: str) -> "tuple[str, list[Scenario]]":
    """The block, and its scenarios, the first one to begin with.

    Raises:
        UserError: neither a block nor a scenario has this name, or the scenarios are of several blocks.
    """
    from ..explore.page import scenarios_of
    from ..scenario.reader import load
    from ..scenario.shipped import find

    known = {name.lower(): name for name in BLOCKS}
    if what.lower() in known:
        return known[what.lower()], scenarios_of(known[what.lower()])
    own = [load(file) for file in find(Path(what))]
    names = sorted({s.recipe.name for s in own})
    if len(names) > 1:
        raise UserError(f"{what}: scenarios of several blocks, {', '.join(names)}; a page is of one block")
    given = {s.file.resolve() for s in own}
    return names[0], own + [s for s in scenarios_of(names[0]) if s.file.resolve() not in given]
