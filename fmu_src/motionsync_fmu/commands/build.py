"""motionsync build"""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from .. import places
from ..archive import epoch
from ..build import Flavour, fmu_path
from ..build import build as build_fmu
from ..builds import at_hand
from ..errors import UserError
from ..interface.recipe import Recipe
from ..pages.console import err, out
from ..pages.progress import doing
from .options import UNITS


def build(
    fmu: Annotated[list[str] | None, typer.Argument(help="Blocks to build; all if none is named.")] = None,
    flavour: Annotated[
        list[Flavour] | None,
        typer.Option(help="native: compiled; python: in an embedded Python. May be repeated; else all possible ones."),
    ] = None,
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; velocities follow.")] = "mm",
    slave_unit: Annotated[
        str,
        typer.Option(metavar=UNITS, help="Unit of the slave's positions, of a block that tells them apart (Follower)."),
    ] = "",
    start: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Bake in a start value; may be repeated. For one block only."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Where to put the FMUs: OUTPUT/<flavour>/<FMU>.fmu; else into build.")
    ] = None,
) -> None:
    """Build FMUs.

    Examples:

        motionsync build

        motionsync build Synchronizer --unit deg --flavour native

        motionsync build Synchronizer --start curve=PARABOLA --start output_phasing=45

        motionsync build Follower --unit mm --slave-unit deg
    """
    names = fmu or list(BLOCKS)
    starts = dict(_assignment(text) for text in start or [])
    if starts and len(names) != 1:
        raise UserError("--start: name the one block that it is for, as in: motionsync build Synchronizer --start ...")
    recipes = [Recipe(name, unit, starts, slave_unit) for name in names]
    for recipe in recipes:
        recipe.block()  # reports every mistake before anything is built
    epoch()
    folder, flavours = output or places.output(err.print), flavour or at_hand(err.print)
    for recipe in recipes:
        for chosen in flavours:
            target = fmu_path(recipe, folder, chosen)
            target.parent.mkdir(parents=True, exist_ok=True)
            with doing(f"building {target}") as tell:
                build_fmu(chosen, recipe, target, tell)
            of_slave = f", the slave's in {slave_unit}" if slave_unit not in ("", unit) else ""
            out.print(f"{escape(str(target))}  {target.stat().st_size / 1000:.0f} kB, positions in {unit}{of_slave}")


def _assignment(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise UserError(f"--start {text}: write NAME=VALUE, as in: --start output_phasing=45")
    return name.strip(), value.strip()
