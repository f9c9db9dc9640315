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


# Greater than 0, from the least number that there is (a denormal one) to where products of a few are ordinary again.
TINY = (5e-324, 1e-323, 1e-318, 1e-310, 2.3e-308, 1e-300, 4e-282, 1e-200, 1e-160, 1e-150, 1e-108, 1e-80, 1e-50, 1e-20)
