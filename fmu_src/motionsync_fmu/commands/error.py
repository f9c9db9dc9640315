"""motionsync error"""

from typing import Annotated

import typer

from ..pages.console import out
from ..pages.description import print_code


def command(
    code: Annotated[
        list[str],
        typer.Argument(
            metavar="[BLOCK] CODE|WORDS",
            help="An error_id, or the code of another variable, decimal or as 0x42DE; or words of the message.",
        ),
    ],
) -> None:
    """Explain a fault code.

    Examples:

        motionsync error 17118

        motionsync error FlyingSaw 0x42DE

        motionsync error sync positions
    """
    from ..api.error import error

    for i, match in enumerate(error(*code)):
        if i:
            out.print()
        print_code(match)
