"""The memory of a block, as NumPy sees it: one record, with the layout that the block has in C."""

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from ..interface.variables import field_types

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
            column = _field_dtype(getattr(block, f.name), hints[f.name])
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
