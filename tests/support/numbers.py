"""Every number in an object, whatever it is made of: for tests that none of them is ever NaN or infinite."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any


def numbers_in(part: Any, but: tuple[str, ...] = ()) -> Iterator[float]:
    """The floats that an object and its parts hold, except the fields whose names are in `but`."""
    for field in fields(part):
        value = getattr(part, field.name)
        if is_dataclass(value):
            yield from numbers_in(value, but)
        elif isinstance(value, list):
            yield from value
        elif isinstance(value, float) and field.name not in but:
            yield value
