"""motionsync describe"""

from typing import Annotated

import typer

from ..pages.console import out
from ..pages.description import print_codes, print_enumerations, print_variables
from .options import UNITS


def command(
    fmu: Annotated[str, typer.Argument(metavar="BLOCK|FMU", help="A block's name, or the path of a built FMU.")],
    unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of all positions; a built FMU has its own.")] = "mm",
    slave_unit: Annotated[str, typer.Option(metavar=UNITS, help="Unit of the slave's positions; as for build.")] = "",
) -> None:
    """Show the variables, enumerations and fault codes of a block or of a built FMU.

    Examples:

        motionsync describe Synchronizer --unit deg

        motionsync describe build/python/Synchronizer.fmu
    """
    from ..api.describe import describe

    description = describe(fmu, unit=unit, slave_unit=slave_unit)
    out.print(f"{description.name}: {description.summary}")
    print_variables(description.groups)
    print_enumerations(description.enumerations)
    print_codes(description.codes)
