"""Errors of the user, which are reported in one line and without a traceback."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import TypeVar

T = TypeVar("T")

MOST_LISTED = 8  # a message lists at most this many names; of more names only the similar ones


class UserError(Exception):
    """One sentence that names what was wrong, its value and what is allowed."""


class Interrupted(Exception):  # noqa: N818 (not an error: the user asked for it)
    """The user interrupted a command; the text states how far it had come."""


def resolve_name(available: Iterable[str], name: str, what: str) -> str:
    """The available name that equals the given one, apart from upper and lower case.

    Raises:
        UserError: there is none, or several differ in case only; the message lists names.
    """
    names = list(available)
    matches = [n for n in names if n == name] or [n for n in names if n.lower() == name.lower()]
    if len(matches) == 1:
        return matches[0]
    by_lower = {n.lower(): n for n in names}
    similar = [by_lower[n] for n in get_close_matches(name.lower(), by_lower)]
    listed = names if len(names) <= MOST_LISTED else similar or _nearest(name, names)
    hint = f"; did you mean {similar[0]}" if similar and len(names) <= MOST_LISTED else ""
    raise UserError(f"no {what} is named {name!r}{hint}; there is {', '.join(listed)}")


def choose(available: Mapping[str, T], name: str, what: str) -> T:
    """The entry of exactly this name.

    Raises:
        UserError: there is none; the message lists names.
    """
    try:
        return available[name]
    except KeyError:
        names = list(available)
        listed = names if len(names) <= MOST_LISTED else get_close_matches(name, names) or _nearest(name, names)
        raise UserError(f"no {what} is named {name!r}; there is {', '.join(listed)}") from None


def _nearest(name: str, names: list[str]) -> list[str]:
    """The names that a message lists if no name is similar: the nearest ones of many."""
    return [*get_close_matches(name, names, MOST_LISTED, 0.0), "..."]
