"""motionsync error"""

from typing import Annotated

import typer

from ..pages.description import print_explanations


def command(
    code: Annotated[
        list[str],
        typer.Argument(
            metavar="[BLOCK] [CODE|WORDS]",
            help="An error_id, or the code of another variable, decimal or as 0x42DE; or words of the message.",
        ),
    ],
) -> None:
    """Explain a fault code.

    A small number means something else in each block: all its meanings are shown, those of a block together, that of
    its error_id first. With the name of a block only its own are shown, and with the name alone all of them.

    Examples:

        motionsync error 17118

        motionsync error FlyingSaw 0x42DE

        motionsync error sync positions
    """
    from ..api.error import error

    codes = error(*code)
    words = code[1:] if code[0].lower() == codes[0].block.lower() else code
    print_explanations(codes, " ".join(words))
