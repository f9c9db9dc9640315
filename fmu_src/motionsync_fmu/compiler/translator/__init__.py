"""A block as readable C99: the kernel subset, translated with its names, comments and docstrings.

The translator uses what the checker of the subset has determined (the kind of each expression, the fields that each
function changes); the descriptions of fields and the start values come from the classes as Python runs them.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from ...interface.fingerprint import Files
from .context import module_texts
from .program import Program


def c_source(block: Any) -> Files:
    """The C of a block: block.h, with its memory and its two functions, and block.c.

    The text is the same in every process. It needs of a C library sqrt, floor, rint, fmod and fabs only.

    Raises:
        UserError: the block is outside the kernel subset; the message has file, line and rule of each violation.
    """
    block_class = block.__class__
    program = _program(block_class, tuple(module_texts(block_class.__module__).items()))
    source = program.source(block)
    return {"block.h": program.header().encode(), "block.c": source.encode()}


def c_text(owner: type[Any], entries: Sequence[str]) -> str:
    """The C of a class that is no block, with these methods and all that they need, for the C that owns it to include.

    Raises:
        UserError: the class is outside the kernel subset.
    """
    return Program(owner, module_texts(owner.__module__), entries).included()


@lru_cache(maxsize=8)
def _program(block_class: Any, texts: tuple[tuple[str, str], ...]) -> Program:
    """The translation of a class, which the FMUs of both versions and of all start values have in common."""
    return Program(block_class, dict(texts))
