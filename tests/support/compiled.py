"""A block's compiled code in this process, without FMI: the quick way to compare it with the Python source."""

from ctypes import byref, c_bool, c_double, c_int64, c_void_p
from operator import attrgetter
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
    """Where a block's fields lie in memory. `bytes` gives the same as `image`, in a hundredth of the time."""

    def __init__(self, block: Any) -> None:
        self.memory = memory = dtype(block)
        scalars = [c for c in cells(block) if c.type is not list]
        lists = [c for c in cells(block) if c.type is list]
        self.scalars = attrgetter(*(c.name for c in scalars))
        self.places = {c.name: (offset(memory, c.name), Struct(f"={len(c.get())}d")) for c in lists}
        form, end = "=", 0
        for c in scalars:
            at, kind = offset(memory, c.name), {float: "d", bool: "?"}.get(c.type, "q")
            self.places[c.name] = at, Struct(f"={kind}")
            form += f"{at - end}x{kind}"
            end = at + (1 if c.type is bool else 8)
        self.form = Struct(f"{form}{memory.itemsize - end}x")
        self.lists = [(attrgetter(c.name), *self.places[c.name]) for c in lists]

    def bytes(self, block: Any) -> bytes:
        memory = bytearray(self.form.pack(*self.scalars(block)))
        for read, at, form in self.lists:
            form.pack_into(memory, at, *read(block))
        return bytes(memory)


def equal(block: Any, compiled: Compiled) -> bool:
    """Whether every field, declared or not, has the same bits."""
    return compiled.layout.bytes(block) == compiled.memory.tobytes()
