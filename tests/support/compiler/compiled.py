"""A block's compiled code in this process, without FMI: the quick way to compare it with the Python source."""

from ctypes import byref, c_bool, c_double, c_int64, c_void_p
from struct import Struct
from typing import Any

import numpy as np

from motionsync_fmu.batch.library import library
from motionsync_fmu.compiler.memory_layout import dtype, packer, places

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
    """

    def __init__(self, block: Any) -> None:
        self.memory = dtype(block)
        self.places = {
            name.lstrip("*").removeprefix("locate(").rstrip(")").removeprefix("block."): (at, Struct(f"={kind}"))
            for at, kind, name in places(block)
        }

    def bytes(self, block: Any) -> bytes:
        """The memory of a block of this type; of a series neither the address nor the length is in it."""
        return packer(type(block))(block, lambda numbers: (0, 0))


def equal(block: Any, compiled: Compiled) -> bool:
    """Whether every field, declared or not, has the same bits."""
    return compiled.layout.bytes(block) == compiled.memory.tobytes()
