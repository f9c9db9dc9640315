"""Every number in an object, whatever it is made of: for tests that none of them is ever NaN or infinite."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from operator import attrgetter
from typing import Any

Getter = Any  # of operator.attrgetter
_places: dict[tuple[type[Any], tuple[str, ...]], tuple[Getter, list[Getter]]] = {}


def numbers_in(part: Any, but: tuple[str, ...] = ()) -> Iterator[float]:
    """The floats that an object and its parts hold, except the fields whose names are in `but`: first those that stand
    alone, then those in lists. All objects of a class have theirs at the same places."""
    key = type(part), but
    if key not in _places:
        found = dict(_paths(part, "", but))
        alone = [path for path, value in found.items() if isinstance(value, float)]
        lists = [attrgetter(path) for path, value in found.items() if isinstance(value, list)]
        _places[key] = attrgetter(*alone), lists
    numbers, lists = _places[key]
    yield from numbers(part)
    for get in lists:
        yield from get(part)


def _paths(part: Any, prefix: str, but: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """The fields of an object and of its parts, each with its present value."""
    for field in fields(part):
        value = getattr(part, field.name)
        if is_dataclass(value):
            yield from _paths(value, f"{prefix}{field.name}.", but)
        elif isinstance(value, list) or field.name not in but:
            yield f"{prefix}{field.name}", value


# Greater than 0, from the least number that there is (a denormal one) to where products of a few are ordinary again.
TINY = (5e-324, 1e-323, 1e-318, 1e-310, 2.3e-308, 1e-300, 4e-282, 1e-200, 1e-160, 1e-150, 1e-108, 1e-80, 1e-50, 1e-20)
