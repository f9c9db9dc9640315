"""A block's compiled code in this process, without FMI: the quick way to compare it with the Python source."""

from collections.abc import Callable
from ctypes import byref, c_bool, c_double, c_int64, c_void_p
from struct import Struct
from typing import Any

import numpy as np

from motionsync_fmu.batch.library import library
from motionsync_fmu.compiler.memory_layout import dtype, offset
from motionsync_fmu.interface.variables import cells

_layouts: dict[type[Any], "Layout"] = {}  # a block's lists have the same lengths in all its objects


class Compiled:
    """One block in compiled code, with the present values of a Python one.

    Attributes:
        memory: all fields of the block, as a NumPy record.
    """

    def __init__(self, block: Any) -> None:
        if type(block) not in _layouts:
            _layouts[type(block)] = Layout(block)
        self.layout = _layouts[type(block)]
        self.memory = np.zeros((), self.layout.memory)
        self.memory[...] = np.frombuffer(self.layout.bytes(block), self.layout.memory)[0]
        self._bytes = self.memory.reshape(1).view(np.uint8).data
        self._address = c_void_p(self.memory.ctypes.data)
        self._initialize, self._step = map(library(type(block)).__getitem__, ("block_initialize", "block_step"))
        self._initialize.restype = self._step.restype = c_int64

    def set(self, name: str, value: Any) -> None:
        at, form = self.layout.places[name]
        form.pack_into(self._bytes, at, *(value if isinstance(value, list) else (value,)))

    def initialize(self) -> int:
        """The refusal, 0 if there is none.

        Raises:
            ArithmeticError: the compiled code raised an exception.
        """
        return self._call(self._initialize)

    def step(self, h: float) -> int:
        """The refusal, 0 if there is none; raises as `initialize` does."""
        return self._call(self._step, c_double(h))

    def _call(self, function: Any, *arguments: c_double) -> int:
        failed = c_bool()
        refusal: int = function(self._address, *arguments, byref(failed))
        if failed:
            raise ArithmeticError
        return refusal


class Layout:
    """Where a block's fields lie in memory.

    Attributes:
        memory: the record of all fields.
        places: of each field, its offset in bytes and how its value is packed.
        bytes: a function that gives the same as `image` of a block of this type, in a thousandth of the time.
    """

    def __init__(self, block: Any) -> None:
        self.memory = memory = dtype(block)
        self.places: dict[str, tuple[int, Struct]] = {}
        parts, form, end, values = {"": "block"}, "=", 0, []
        for c in cells(block):
            at, listed = offset(memory, c.name), c.type is list
            kind = f"{len(c.get())}d" if listed else {float: "d", bool: "?"}.get(c.type, "q")
            self.places[c.name] = at, Struct(f"={kind}")
            form += f"{at - end}x{kind}"
            end = at + self.places[c.name][1].size
            values.append(f"{'*' * listed}{_part(c.name.rpartition('.')[0], parts)}.{c.attribute}")
        pack = Struct(f"{form}{memory.itemsize - end}x").pack
        self.bytes: Callable[[Any], bytes] = eval(f"lambda block: pack({', '.join(values)})", {"pack": pack})


def _part(name: str, parts: dict[str, str]) -> str:
    """An expression for a block's part of that name; at its first use it gets a variable in `parts`."""
    if name in parts:
        return parts[name]
    outer, _, attribute = name.rpartition(".")
    whole = _part(outer, parts)
    parts[name] = f"part{len(parts)}"
    return f"({parts[name]} := {whole}.{attribute})"


def equal(block: Any, compiled: Compiled) -> bool:
    """Whether every field, declared or not, has the same bits."""
    return compiled.layout.bytes(block) == compiled.memory.tobytes()
