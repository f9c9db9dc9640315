"""Every number in an object and its parts, for tests that none of them is ever NaN or infinite."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from operator import attrgetter
from typing import Any

Getter = Any  # of operator.attrgetter
_getters: dict[tuple[type[Any], tuple[str, ...]], tuple[Getter, list[Getter]]] = {}


def numbers_in(part: Any, but: tuple[str, ...] = ()) -> Iterator[float]:
    """The floats in an object and its parts: first single ones, then those in lists, without the fields named in `but`.

    All objects of a class have the same fields."""
    key = type(part), but
    if key not in _getters:
        values = dict(_paths(part, "", but))
        single = [path for path, value in values.items() if isinstance(value, float)]
        lists = [attrgetter(path) for path, value in values.items() if isinstance(value, list)]
        _getters[key] = attrgetter(*single), lists
    numbers, lists = _getters[key]
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


# Greater than 0, from the least (denormal) number to those whose products are normal numbers again.
TINY = (5e-324, 1e-323, 1e-318, 1e-310, 2.3e-308, 1e-300, 4e-282, 1e-200, 1e-160, 1e-150, 1e-108, 1e-80, 1e-50, 1e-20)
