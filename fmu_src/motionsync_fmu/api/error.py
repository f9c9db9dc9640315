"""What `motionsync error` looks up."""

from contextlib import suppress

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..interface.codes import FaultCode, all_codes

NEAREST = 3  # codes that a message names if no code has the number


def error(*code: str | int) -> list[FaultCode]:
    """The fault codes with a number, or with some words in their name or description: those of a block together, of
    which those that an `error_id` shows come first.

    Args:
        code: an `error_id`, `17118` or `"0x42DE"`, or words of the message; before it the name of a block, if only its
            codes are meant, or this name alone, for all of them.

    Raises:
        UserError: there is none; the message has the nearest ones.
    """
    codes, words, block = sorted(all_codes(), key=_place), [str(word) for word in code], ""
    if words and words[0].lower() in (name.lower() for name in BLOCKS):
        block = resolve_name(BLOCKS, words.pop(0), "block")
        codes = [c for c in codes if c.block == block]
    text = " ".join(words)
    if not block and not text.strip():
        raise UserError("name a fault code, a block, or words of a message")
    number: int | None = None
    with suppress(ValueError):
        number = int(text, 0)
    if number is None:
        matches = [c for c in codes if text.lower() in f"{c.name} {c.description}".lower()]
        if not matches:
            of_block = f" of {block}" if block else ""
            raise UserError(f"no fault code{of_block} mentions {text!r}; motionsync describe lists those of a block")
        return matches
    matches = [c for c in codes if c.number == number]
    if not matches:
        nearest = sorted(codes, key=lambda c: abs(c.number - number))
        listed = ", ".join([*dict.fromkeys(f"{c.number_text} ({c.block})" for c in nearest)][:NEAREST])
        none = f"{block} has no" if block else "no block has the"
        raise UserError(f"{none} fault code {text}; the nearest are {listed}")
    return matches


def _place(code: FaultCode) -> tuple[int, bool]:
    """Where a code comes in a list: by its block, and first if an `error_id` shows it."""
    return [*BLOCKS].index(code.block), not any(name.endswith("error_id") for name in code.carriers)
