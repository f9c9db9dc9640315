"""motionsync describe"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..interface.recipe import Recipe
from ..interface.units import BASES
from ..interface.variables import summary
from ..pages.console import out
from ..pages.description import codes_of, print_codes, print_enumerations, print_variables
from .options import UNITS


def command(
    fmu: Annotated[str, typer.Argument(help="A block's name, or the path of a built FMU.")],
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; a built FMU has its own.")] = "mm",
    slave_unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of the slave's positions; as for build.")] = "",
) -> None:
    """Show the variables, enumerations and fault codes of a block or of a built FMU.

    Examples:

        motionsync describe Synchronizer --unit deg

        motionsync describe build/python/Synchronizer.fmu
    """
    recipe = _recipe(fmu, unit, slave_unit)
    block = replace(recipe, starts={}).block()
    out.print(f"{recipe.name}: {summary(type(block))}")
    print_variables(block, recipe.unit, recipe.slave_unit, recipe.starts, recipe.causality_overrides)
    print_enumerations(block)
    print_codes(codes_of(recipe.name, block))


def _recipe(fmu: str, unit: str, slave_unit: str) -> Recipe:
    """The recipe of the FMU or block that the argument names."""
    path = Path(fmu)
    if path.is_file() or path.suffix.lower() == ".fmu":
        from ..scenario.run.fmu_instance import read_recipe

        if not path.is_file():
            raise UserError(f"{fmu}: no such file")
        return read_recipe(path)
    if path.name != fmu:
        raise UserError(f"{fmu}: no such file; name a block, or the path of a built FMU")
    slaves = resolve_name(BASES, slave_unit, "slave unit") if slave_unit else ""
    return Recipe(resolve_name(BLOCKS, fmu, "block"), resolve_name(BASES, unit, "unit"), {}, slaves)
