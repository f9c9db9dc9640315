"""Mistakes of the user, which are reported in one line and without a traceback."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import TypeVar

T = TypeVar("T")


class UserError(Exception):
    """One sentence that names what was wrong, its value and what is allowed."""


class Interrupted(Exception):  # noqa: N818 (no error: the user wants it)
    """The user broke off a command; the text says how far it had come."""


def choose(known: Mapping[str, T], name: str, what: str) -> T:
    """The entry of that name.

    Raises:
        UserError: there is none; the message lists all names, or the nearest ones of many.
    """
    if name in known:
        return known[name]
    near = list(known) if len(known) <= 8 else get_close_matches(name, known) or [*list(known)[:8], "..."]
    raise UserError(f"no {what} is named {name!r}; there is {', '.join(near)}")
