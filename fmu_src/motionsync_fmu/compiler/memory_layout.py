"""The memory of a block, as NumPy sees it: one record, with the layout that the block has in C."""

from array import array
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from struct import Struct, calcsize
from typing import Any, TypeAlias

import numpy as np

from ..interface.variables import field_types

SERIES = np.dtype([("address", np.int64), ("count", np.int64)], align=True)
Locate: TypeAlias = Callable[[Any], tuple[int, int]]
NOTHING = array("d", [0.0])
SCALARS = {float: np.float64, bool: np.bool_}  # int and every enumeration: np.int64


def dtype(block: Any) -> np.dtype[Any]:
    """The memory of one object, nested parts included, laid out as in C: a derived class starts with its whole base."""
    return _class_dtype(type(block), block)


def _class_dtype(cls: type, block: Any) -> np.dtype[Any]:
    """The fields of a class, and of those that it derives from, in one of its objects."""
    columns: dict[str, tuple[np.dtype[Any], int]] = {}  # type and offset
    end, alignment = 0, 1
    for base in filter(is_dataclass, cls.__bases__):
        base_dtype: Any = _class_dtype(base, block)
        columns = {name: base_dtype.fields[name][:2] for name in base_dtype.names}
        end, alignment = base_dtype.itemsize, base_dtype.alignment
    hints = field_types(cls)
    for f in fields(cls):
        if f.name not in columns:
            is_series = f.metadata.get("series", False)
            column = SERIES if is_series else _field_dtype(getattr(block, f.name), hints[f.name])
            start = _align(end, column.alignment)
            columns[f.name] = column, start
            end, alignment = start + column.itemsize, max(alignment, column.alignment)
    formats, offsets = [column for column, _ in columns.values()], [start for _, start in columns.values()]
    size = _align(end, alignment)
    return np.dtype({"names": [*columns], "formats": formats, "offsets": offsets, "itemsize": size}, align=True)


def _align(offset: int, alignment: int) -> int:
    """The first offset from this one on that has this alignment."""
    return -(-offset // alignment) * alignment


def _field_dtype(value: Any, hint: Any) -> np.dtype[Any]:
    """The type of one field, by its present value and its type hint."""
    if is_dataclass(value):
        return dtype(value)
    if isinstance(value, list):
        return np.dtype((np.float64, (len(value),)))
    return np.dtype(SCALARS.get(hint, np.int64))


def offset(layout: Any, name: str) -> int:
    """The offset of the variable of that name in a memory of that layout, in bytes."""
    total = 0
    for part in name.split("."):
        layout, part_offset = layout.fields[part][:2]
        total += part_offset
    return total


def address_and_count(numbers: Any) -> tuple[int, int]:
    """Where an `array`, or one of NumPy, is in the memory of this process, and how many numbers it has.

    An empty one has an address too: after a failure compiled code goes on with the first element."""
    given = numbers if len(numbers) else NOTHING
    address: int = given.buffer_info()[0] if isinstance(given, array) else given.ctypes.data
    return address, len(numbers)


def image(block: Any, locate: Locate = address_and_count) -> np.ndarray[Any, Any]:
    """The block's present values in the memory of its `dtype`; the bytes between the fields are 0."""
    owner: type = type(block)
    return np.frombuffer(bytearray(packer(owner)(block, locate)), dtype(block)).reshape(())


@cache
def packer(owner: type) -> Callable[[Any, Locate], bytes]:
    """A function that gives the bytes of `image` for an object of a class, written as one expression: it is a hundred
    times as quick.

    Its second argument says where compiled code finds the numbers of a series, and how many there are."""
    block, form, values, end = owner(), "=", list[str](), 0
    for start, kind, value in places(block):
        form += f"{start - end}x{kind}"
        end = start + calcsize(f"={kind}")
        values.append(value)
    pack = Struct(f"{form}{dtype(block).itemsize - end}x").pack
    function: Callable[[Any, Locate], bytes] = eval(f"lambda block, locate: pack({', '.join(values)})", {"pack": pack})
    return function


def places(block: Any) -> Iterator[tuple[int, str, str]]:
    """Of each field the offset, how it is packed, and an expression for the values: `block.master.position`."""
    return _places("block", block, dtype(block))


def _places(path: str, block: Any, layout: Any) -> Iterator[tuple[int, str, str]]:
    part_class: type = type(block)
    hints = field_types(part_class)
    for f in fields(block):
        column, start = layout.fields[f.name][:2]
        value, name = getattr(block, f.name), f"{path}.{f.name}"
        if is_dataclass(value):
            yield from ((start + inner, *place) for inner, *place in _places(name, value, column))
        elif f.metadata.get("series", False):
            yield start, "qq", f"*locate({name})"
        elif isinstance(value, list):
            yield start, f"{len(value)}d", f"*{name}"
        else:
            yield start, {float: "d", bool: "?"}.get(hints[f.name], "q"), name


def field(memory: Any, name: str) -> Any:
    """The values of the variable of that name in one memory or in an array of them: a view."""
    for part in name.split("."):
        memory = memory[part]
    return memory
