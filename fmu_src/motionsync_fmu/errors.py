"""Mistakes of the user, which are reported in one line and without a traceback."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import TypeVar

T = TypeVar("T")


class UserError(Exception):
    """One sentence that names what was wrong, its value and what is allowed."""


class Interrupted(Exception):  # noqa: N818 (no error: the user wants it)
    """The user broke off a command; the text says how far it had come."""


def spelled(known: Iterable[str], name: str, what: str) -> str:
    """The name as it is known, whatever the case of the letters that were given.

    Raises:
        UserError: there is none, or several differ in case only; the message lists all names, or the nearest of many.
    """
    names = list(known)
    same = [n for n in names if n == name] or [n for n in names if n.lower() == name.lower()]
    if len(same) == 1:
        return same[0]
    by_lower = {n.lower(): n for n in names}
    near = [by_lower[n] for n in get_close_matches(name.lower(), by_lower)]
    listed = names if len(names) <= 8 else near or [*names[:8], "..."]
    hint = f"; did you mean {near[0]}" if near and len(names) <= 8 else ""
    raise UserError(f"no {what} is named {name!r}{hint}; there is {', '.join(listed)}")


def choose(known: Mapping[str, T], name: str, what: str) -> T:
    """The entry of exactly that name.

    Raises:
        UserError: there is none; the message lists all names, or the nearest ones of many.
    """
    if name in known:
        return known[name]
    near = list(known) if len(known) <= 8 else get_close_matches(name, known) or [*list(known)[:8], "..."]
    raise UserError(f"no {what} is named {name!r}; there is {', '.join(near)}")
