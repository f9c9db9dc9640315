"""motionsync build"""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from .. import places
from ..archive import build_time
from ..build import NO_COMPONENT, Finish, Flavour, begun, fmu_path, has_component, has_sources, outdated
from ..builds import chosen
from ..errors import UserError, spelled
from ..interface.recipe import Fmi, Recipe
from ..interface.turns import Interface, TurnError
from ..interface.units import BASES
from ..pages.console import err, out
from ..pages.progress import doing
from .options import UNITS, Version, assignments

Turned = Annotated[
    list[str] | None,
    typer.Option(metavar="PATTERN", help="Turn these variables to such ones; may be repeated. For one block only."),
]


def build(
    fmu: Annotated[list[str] | None, typer.Argument(help="Blocks to build; all if none is named.")] = None,
    flavour: Annotated[
        list[Flavour] | None,
        typer.Option(
            case_sensitive=False,
            help="native: compiled; python: in an embedded Python. May be repeated; else all possible ones.",
        ),
    ] = None,
    fmi: Version = Fmi.TWO,
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; velocities follow.")] = "mm",
    slave_unit: Annotated[
        str,
        typer.Option(metavar=UNITS, help="Unit of the slave's positions, of a block that tells them apart (Follower)."),
    ] = "",
    start: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Bake in a start value; may be repeated. For one block only."),
    ] = None,
    input: Turned = None,
    output: Turned = None,
    parameter: Turned = None,
    local: Turned = None,
    folder: Annotated[
        Path | None,
        typer.Option(help="Where to put the FMUs: FOLDER/<flavour>/<FMU>.fmu, FOLDER/fmi3/<FMU>.fmu; else into build."),
    ] = None,
    sources: Annotated[
        bool, typer.Option("--sources", help="Put the C into the FMU, for any other processor; native flavour.")
    ] = False,
    wasm: Annotated[
        bool, typer.Option("--wasm", help="Add a WebAssembly component, of FMI 3.0 (experimental: a draft may change).")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Build FMUs that are up to date, too.")] = False,
) -> None:
    """Build FMUs that are missing or stale.

    A tunable parameter can be turned to an input, an input to a parameter, an output to a local variable, and back.
    Such an FMU has a name of its own.

    Examples:

        motionsync build

        motionsync build Synchronizer --unit deg --flavour native

        motionsync build Synchronizer --start curve=PARABOLA --start output_phasing=45

        motionsync build FlyingSaw --fmi 3

        motionsync build Gearing --sources --flavour native

        motionsync build Follower --unit mm --slave-unit deg

        motionsync build Gearing --input "gearing.*" --parameter activate
    """
    names = [spelled(BLOCKS, name, "block") for name in fmu or BLOCKS]
    unit, slave_unit = spelled(BASES, unit, "unit"), spelled(["", *BASES], slave_unit, "slave unit")
    starts = assignments("--start", start or [], "output_phasing=45")
    interface = Interface(input or (), output or (), parameter or (), local or ())
    turned = next((f"--{causality}" for causality, _ in interface.patterns()), "")
    if (option := "--start" if starts else turned) and len(names) != 1:
        one = f"motionsync build Synchronizer {option} ..."
        raise UserError(f"{option}: name the one block that it is for, as in: {one}")
    recipes = [Recipe(name, unit, starts, slave_unit, interface, fmi) for name in names]
    for recipe in recipes:
        _check(recipe)
    build_time()  # refuses a bad SOURCE_DATE_EPOCH
    flavours, folder = chosen(fmi, flavour or [], err.print), folder or places.output(err.print)
    if sources and Flavour.NATIVE not in flavours:
        raise UserError("--sources: the python flavour has no C; take --flavour native")
    if wasm and fmi != Fmi.THREE:
        raise UserError(NO_COMPONENT)
    wanted = [
        Wanted(recipe, one, fmu_path(recipe, folder, one), sources and one == Flavour.NATIVE, wasm, force)
        for recipe in recipes
        for one in flavours
    ]
    ahead: Finish | None = None
    for this, following in zip(wanted, [*wanted[1:], None], strict=True):
        finish, ahead = ahead, None
        if this.is_up_to_date():
            out.print(f"{escape(str(this.target))}  is up to date")
            continue
        this.target.parent.mkdir(parents=True, exist_ok=True)
        with doing(f"building {this.target}") as tell:
            finish = finish or this.begun()
            with suppress(UserError):  # it is told when the following one's turn comes
                ahead = following.begun() if following and not following.is_up_to_date() else None
            finish(this.target, tell)
        of_slave = f", the slave's in {slave_unit}" if slave_unit not in ("", unit) else ""
        size = this.target.stat().st_size
        out.print(f"{escape(str(this.target))}  {size / 1000:.0f} kB, positions in {unit}{of_slave}")


@dataclass(frozen=True)
class Wanted:
    """An FMU that is asked for, and what is to be in it."""

    recipe: Recipe
    flavour: Flavour
    target: Path
    sources: bool
    wasm: bool
    force: bool

    def is_up_to_date(self) -> bool:
        stale = self.force or outdated(self.target, self.recipe) or has_sources(self.target) != self.sources
        return not stale and has_component(self.target) == self.wasm

    def begun(self) -> Finish:
        """Its build, begun: zig compiles it while the one before is finished."""
        return begun(self.flavour, self.recipe, with_sources=self.sources, with_component=self.wasm)


def _check(recipe: Recipe) -> None:
    """Report every mistake before anything is built."""
    try:
        recipe.block()
    except TurnError as e:
        raise UserError(f"--{e}") from None
