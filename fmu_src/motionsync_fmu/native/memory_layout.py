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
    base = next((base for base in cls.__bases__ if is_dataclass(base)), None)
    inherited = _laid_out(base, block) if base else None
    columns: dict[str, tuple[Any, int]] = {n: inherited.fields[n][:2] for n in inherited.names} if inherited else {}
    size, widest = (inherited.itemsize, inherited.alignment) if inherited else (0, 1)
    hints = get_type_hints(cls)
    for f in fields(cls):
        if f.name not in columns:
            column = _column(getattr(block, f.name), hints[f.name])
            place = -(-size // column.alignment) * column.alignment
            columns[f.name] = column, place
            size, widest = place + column.itemsize, max(widest, column.alignment)
    formats, offsets = zip(*columns.values(), strict=True) if columns else ((), ())
    size = -(-size // widest) * widest
    return np.dtype(
        {"names": list(columns), "formats": list(formats), "offsets": list(offsets), "itemsize": size}, align=True
    )


def _column(value: Any, hint: Any) -> np.dtype[Any]:
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
