"""motionsync error"""

from contextlib import suppress
from typing import Annotated

import typer

from motionsync.blocks import BLOCKS

from ..errors import UserError, spelled
from ..pages.console import out
from ..pages.description import Code, all_codes, print_code

NEAREST = 3  # codes that a message names where there is none of the number


def error(
    code: Annotated[
        list[str],
        typer.Argument(
            metavar="[BLOCK] CODE|WORDS", help="An error_id, decimal or as 0x42DE; or words of the message."
        ),
    ],
) -> None:
    """Explain a fault code.

    Examples:

        motionsync error 17118

        motionsync error FlyingSaw 0x42DE

        motionsync error sync positions
    """
    known = all_codes()
    words = list(code)
    if len(words) > 1 and words[0].lower() in (name.lower() for name in BLOCKS):
        block = spelled(BLOCKS, words.pop(0), "block")
        known = [c for c in known if c.block == block]
    for i, found in enumerate(_found(known, " ".join(words))):
        if i:
            out.print()
        print_code(found)


def _found(known: list[Code], text: str) -> list[Code]:
    """The codes of that number, or whose name or description has these words.

    Raises:
        UserError: there is none.
    """
    number: int | None = None
    with suppress(ValueError):
        number = int(text, 0)
    if number is None:
        found = [c for c in known if text.lower() in f"{c.member.name} {c.member.description}".lower()]
        if not found:
            raise UserError(f"no fault code speaks of {text!r}; motionsync describe lists those of a block")
        return found
    found = [c for c in known if c.member.value == number]
    if not found:
        near = sorted(known, key=lambda c: abs(c.member.value - number))[:NEAREST]
        named = ", ".join(f"{c.number} ({c.block})" for c in near)
        raise UserError(f"no block has the fault code {text}; the nearest are {named}")
    return found
