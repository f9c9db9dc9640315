"""motionsync error"""

from contextlib import suppress
from typing import Annotated

import typer

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..pages.console import out
from ..pages.description import CodeMeaning, all_codes, print_code

NEAREST = 3  # codes that a message names if no code has the number


def command(
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
    codes = all_codes()
    words = list(code)
    if len(words) > 1 and words[0].lower() in (name.lower() for name in BLOCKS):
        block = resolve_name(BLOCKS, words.pop(0), "block")
        codes = [c for c in codes if c.block == block]
    for i, match in enumerate(_find_codes(codes, " ".join(words))):
        if i:
            out.print()
        print_code(match)


def _find_codes(codes: list[CodeMeaning], text: str) -> list[CodeMeaning]:
    """The codes with this number, or with this text in their name or description.

    Raises:
        UserError: there is none.
    """
    number: int | None = None
    with suppress(ValueError):
        number = int(text, 0)
    if number is None:
        matches = [c for c in codes if text.lower() in f"{c.member.name} {c.member.description}".lower()]
        if not matches:
            raise UserError(f"no fault code mentions {text!r}; motionsync describe lists those of a block")
        return matches
    matches = [c for c in codes if c.member.value == number]
    if not matches:
        nearest = sorted(codes, key=lambda c: abs(c.member.value - number))[:NEAREST]
        listed = ", ".join(f"{c.number} ({c.block})" for c in nearest)
        raise UserError(f"no block has the fault code {text}; the nearest are {listed}")
    return matches
