"""motionsync build"""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from .. import paths
from ..errors import UserError, resolve_name
from ..fmus.fmu import (
    NO_COMPONENT,
    BuildOptions,
    Finish,
    Flavour,
    fmu_path,
    optional_contents,
    start_build,
    why_outdated,
)
from ..fmus.prebuilt import select_flavours
from ..interface.build_time import build_time
from ..interface.causality import CausalityError, Interface
from ..interface.recipe import Fmi, Recipe
from ..interface.units import BASES
from ..pages.console import err, out
from ..pages.progress import report_progress
from .options import UNITS, Version, parse_assignments

PATTERNS = "Give variables this causality; may be repeated. For one block only."


def command(
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
        typer.Option(metavar=UNITS, help="Unit of the slave's positions, of a block that has both (Follower)."),
    ] = "",
    start: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Bake in a start value; may be repeated. For one block only."),
    ] = None,
    as_input: Annotated[list[str] | None, typer.Option(metavar="PATTERN", help=PATTERNS)] = None,
    as_output: Annotated[list[str] | None, typer.Option(metavar="PATTERN", help=PATTERNS)] = None,
    as_parameter: Annotated[list[str] | None, typer.Option(metavar="PATTERN", help=PATTERNS)] = None,
    as_local: Annotated[list[str] | None, typer.Option(metavar="PATTERN", help=PATTERNS)] = None,
    output: Annotated[
        Path | None,
        typer.Option(help="Target of the FMUs: OUTPUT/<flavour>/<FMU>.fmu, OUTPUT/fmi3/<FMU>.fmu; else in build."),
    ] = None,
    sources: Annotated[
        bool, typer.Option("--sources", help="Add the C code to the FMU, for any other processor; native flavour.")
    ] = False,
    wasm: Annotated[
        bool, typer.Option("--wasm", help="Add a WebAssembly component, of FMI 3.0 (experimental: a draft may change).")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Build FMUs that are up to date, too.")] = False,
) -> None:
    """Build FMUs that are missing or stale.

    A tunable parameter can become an input, an input a parameter, an output a local variable, and back.
    Such an FMU has a name of its own.

    Examples:

        motionsync build

        motionsync build Synchronizer --unit deg --flavour native

        motionsync build Synchronizer --start curve=PARABOLA --start output_phasing=45

        motionsync build FlyingSaw --fmi 3

        motionsync build Gearing --sources --flavour native

        motionsync build Follower --unit mm --slave-unit deg

        motionsync build Gearing --as-input "gearing.*" --as-parameter activate
    """
    names = [resolve_name(BLOCKS, name, "block") for name in fmu or BLOCKS]
    unit, slave_unit = resolve_name(BASES, unit, "unit"), resolve_name(["", *BASES], slave_unit, "slave unit")
    starts = parse_assignments("--start", start or [], "output_phasing=45")
    interface = Interface(as_input or (), as_output or (), as_parameter or (), as_local or ())
    override = next((f"--as-{causality}" for causality, _ in interface.patterns()), "")
    if (option := "--start" if starts else override) and len(names) != 1:
        example = f"motionsync build Synchronizer {option} ..."
        raise UserError(f"{option}: name the one block that it is for, as in: {example}")
    recipes = [Recipe(name, unit, starts, slave_unit, interface, fmi) for name in names]
    for recipe in recipes:
        _validate(recipe)
    build_time()  # refuses a bad SOURCE_DATE_EPOCH
    flavours, folder = select_flavours(fmi, flavour or [], err.print), output or paths.output_folder(err.print)
    if sources and Flavour.NATIVE not in flavours:
        raise UserError("--sources: the python flavour has no C; take --flavour native")
    if wasm and fmi != Fmi.THREE:
        raise UserError(NO_COMPONENT)
    builds = [
        RequestedBuild(recipe, fmu_path(recipe, folder, options.flavour), options, force)
        for recipe in recipes
        for options in (BuildOptions(each, (), sources and each == Flavour.NATIVE, wasm) for each in flavours)
    ]
    finish_next: Finish | None = None
    for this, following in zip(builds, [*builds[1:], None], strict=True):
        finish, finish_next = finish_next, None
        if this.is_up_to_date():
            out.print(f"{escape(str(this.target))}  is up to date")
            continue
        this.target.parent.mkdir(parents=True, exist_ok=True)
        with report_progress(f"building {this.target}") as notify:
            finish = finish or this.start()
            with suppress(UserError):  # its own iteration starts it again, and reports this error
                finish_next = following.start() if following and not following.is_up_to_date() else None
            finish(this.target, notify)
        of_slave = f", the slave's in {slave_unit}" if slave_unit not in ("", unit) else ""
        size = this.target.stat().st_size
        out.print(f"{escape(str(this.target))}  {size / 1000:.0f} kB, positions in {unit}{of_slave}")


@dataclass(frozen=True)
class RequestedBuild:
    """An FMU to build, and what it shall contain."""

    recipe: Recipe
    target: Path
    options: BuildOptions
    force: bool

    def is_up_to_date(self) -> bool:
        if self.force or why_outdated(self.target, self.recipe):
            return False
        return optional_contents(self.target) == (self.options.with_sources, self.options.with_component)

    def start(self) -> Finish:
        """Start the build: zig compiles this FMU while the previous one is finished."""
        return start_build(self.recipe, self.options)


def _validate(recipe: Recipe) -> None:
    """Report a mistake in a recipe before anything is built."""
    try:
        recipe.block()
    except CausalityError as e:
        raise UserError(f"--as-{e}") from None
