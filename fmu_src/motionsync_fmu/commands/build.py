"""motionsync build"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from ..fmus.fmu import Flavour
from ..interface.recipe import Fmi
from ..pages.console import err, out
from ..pages.progress import report_progress
from .options import UNITS, Version, parse_assignments

if TYPE_CHECKING:
    from ..api.build import BuiltFmu

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
        typer.Option(
            metavar=UNITS,
            help="Unit of the slave's positions, of a block that has both; else deg for a tool that turns, or --unit.",
        ),
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
        typer.Option(help="Target of the FMUs: OUTPUT/FLAVOUR/FMU.fmu, OUTPUT/fmi3/FMU.fmu; else in build."),
    ] = None,
    terminals: Annotated[
        bool,
        typer.Option("--terminals", help="Add terminals to FMUs of FMI 2.0, too: FMILibrary 3 logs an error on them."),
    ] = False,
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

        motionsync build CutToLength --unit m --start "kerf=4 mm"

        motionsync build FlyingSaw --fmi 3

        motionsync build Gearing --sources --flavour native

        motionsync build Follower --unit mm --slave-unit deg

        motionsync build Gearing --as-input "gearing.*" --as-parameter activate
    """
    from ..api.build import build

    build(
        fmu or [],
        flavour=flavour or [],
        fmi=fmi,
        unit=unit,
        slave_unit=slave_unit,
        start=parse_assignments("--start", start or [], "output_phasing=45"),
        as_input=as_input or [],
        as_output=as_output or [],
        as_parameter=as_parameter or [],
        as_local=as_local or [],
        output=output,
        terminals=terminals,
        sources=sources,
        wasm=wasm,
        force=force,
        report=report_progress,
        notify=err.print,
        finished=_print_built,
    )


def _print_built(fmu: "BuiltFmu") -> None:
    """Print an FMU's path, and what is new about it."""
    if not fmu.is_new:
        out.print(f"{escape(str(fmu.path))}  is up to date")
        return
    unit, slave_unit = fmu.recipe.unit, fmu.recipe.slave_unit
    of_slave = f", the slave's in {slave_unit}" if slave_unit not in ("", unit) else ""
    starts = (
        f", start values: {', '.join(f'{n} = {v}' for n, v in fmu.recipe.starts.items())}" if fmu.recipe.starts else ""
    )
    replaced = "; it replaces the FMU that was there" if fmu.has_replaced else ""
    size = f"{fmu.path.stat().st_size / 1000:.0f} kB"
    out.print(f"{escape(str(fmu.path))}  {size}, positions in {unit}{of_slave}{escape(starts)}{replaced}")
