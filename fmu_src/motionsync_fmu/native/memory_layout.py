"""The memory of a block, as NumPy sees it: one record, with the layout that the block has in C."""

from dataclasses import fields, is_dataclass
from typing import Any, get_type_hints

import numpy as np

SCALARS = {float: np.float64, bool: np.bool_}  # int and every enumeration: np.int64


def dtype(block: Any) -> np.dtype[Any]:
    """The memory of one object, nested parts included, laid out as in C: a derived class begins with its whole base."""
    return _laid_out(type(block), block)


def _laid_out(cls: type, block: Any) -> np.dtype[Any]:
    """The fields of a class, and of those that it derives from, in one of its objects."""
    columns: dict[str, tuple[np.dtype[Any], int]] = {}  # type and offset
    end, alignment = 0, 1
    for base in filter(is_dataclass, cls.__bases__):
        whole: Any = _laid_out(base, block)
        columns = {name: whole.fields[name][:2] for name in whole.names}
        end, alignment = whole.itemsize, whole.alignment
    hints = get_type_hints(cls)
    for f in fields(cls):
        if f.name not in columns:
            column = _column(getattr(block, f.name), hints[f.name])
            begin = _aligned(end, column.alignment)
            columns[f.name] = column, begin
            end, alignment = begin + column.itemsize, max(alignment, column.alignment)
    formats, offsets = [column for column, _ in columns.values()], [begin for _, begin in columns.values()]
    size = _aligned(end, alignment)
    return np.dtype({"names": [*columns], "formats": formats, "offsets": offsets, "itemsize": size}, align=True)


def _aligned(place: int, alignment: int) -> int:
    """The first place from this one on that has this alignment."""
    return -(-place // alignment) * alignment


def _column(value: Any, hint: Any) -> np.dtype[Any]:
    """The type of one field, by its present value and its type hint."""
    if is_dataclass(value):
        return dtype(value)
    if isinstance(value, list):
        return np.dtype((np.float64, (len(value),)))
    return np.dtype(SCALARS.get(hint, np.int64))


def offset(layout: Any, name: str) -> int:
    """Where the variable of that name lies in a memory of that layout: the distance from its start in bytes."""
    total = 0
    for part in name.split("."):
        layout, here = layout.fields[part][:2]
        total += here
    return total


def image(block: Any) -> np.ndarray[Any, Any]:
    """The block's present values in the memory of its `dtype`; the bytes between the fields are 0."""
    memory = np.zeros((), dtype(block))
    _fill(memory, block)
    return memory


def _fill(memory: Any, block: Any) -> None:
    for f in fields(block):
        value = getattr(block, f.name)
        if is_dataclass(value):
            _fill(memory[f.name], value)
        else:
            memory[f.name] = value


def field(memory: Any, name: str) -> Any:
    """The values of the variable of that name in one memory or in an array of them: a view."""
    for part in name.split("."):
        memory = memory[part]
    return memory
