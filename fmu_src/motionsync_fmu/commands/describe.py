"""motionsync describe"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from ..interface.recipe import Recipe
from ..interface.variables import summary
from ..pages.console import out, print_variables
from .options import UNITS


def describe(
    fmu: Annotated[str, typer.Argument(help="A block's name, or the path of a built FMU.")],
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; a built FMU has its own.")] = "mm",
    slave_unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of the slave's positions; as for build.")] = "",
) -> None:
    """Show the variables: name, causality, type and unit, start value, allowed range, meaning.

    Examples:

        motionsync describe Synchronizer --unit deg

        motionsync describe build/python/Synchronizer.fmu
    """
    recipe = Recipe(fmu, unit, {}, slave_unit)
    if fmu.endswith(".fmu"):
        from ..scenario.fmu_instance import recipe_of

        recipe = recipe_of(Path(fmu))
    block = replace(recipe, starts={}).block()
    out.print(f"{recipe.name}: {summary(type(block))}\n")
    print_variables(block, recipe.unit, recipe.slave_unit, recipe.starts, recipe.turned)
