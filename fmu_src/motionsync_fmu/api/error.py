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
            codes are meant.

    Raises:
        UserError: there is none; the message has the nearest ones.
    """
    codes, words = sorted(all_codes(), key=_place), [str(word) for word in code]
    if len(words) > 1 and words[0].lower() in (name.lower() for name in BLOCKS):
        block = resolve_name(BLOCKS, words.pop(0), "block")
        codes = [c for c in codes if c.block == block]
    text = " ".join(words)
    number: int | None = None
    with suppress(ValueError):
        number = int(text, 0)
    if number is None:
        matches = [c for c in codes if text.lower() in f"{c.name} {c.description}".lower()]
        if not matches:
            raise UserError(f"no fault code mentions {text!r}; motionsync describe lists those of a block")
        return matches
    matches = [c for c in codes if c.number == number]
    if not matches:
        nearest = sorted(codes, key=lambda c: abs(c.number - number))[:NEAREST]
        listed = ", ".join(f"{c.number_text} ({c.block})" for c in nearest)
        raise UserError(f"no block has the fault code {text}; the nearest are {listed}")
    return matches


def _place(code: FaultCode) -> tuple[int, bool]:
    """Where a code comes in a list: by its block, and first if an `error_id` shows it."""
    return [*BLOCKS].index(code.block), not any(name.endswith("error_id") for name in code.carriers)
