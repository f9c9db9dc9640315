"""A block's compiled code in this process, without zig and FMI: the quick way to compare it with the Python source."""

from ctypes import CFUNCTYPE, byref, c_double, c_int32, c_int64, c_void_p
from typing import Any

from motionsync_fmu.loop import code
from motionsync_fmu.record import image


class Compiled:
    """One block in compiled code, with the present values of a Python one.

    Attributes:
        memory: all its fields, as NumPy names them.
    """

    def __init__(self, block: Any) -> None:
        self.memory = image(block)
        compiled = code(type(block))
        self._initialize = CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p)(compiled.initialize)
        self._step = CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_double)(compiled.step)

    def set(self, name: str, value: Any) -> None:
        *parts, last = name.split(".")
        owner: Any = self.memory
        for part in parts:
            owner = owner[part]
        owner[last] = value

    def initialize(self) -> int:
        """The refusal, 0 if there is none.

        Raises:
            ArithmeticError: the compiled code raised an exception.
        """
        return self._call(self._initialize)

    def step(self, h: float) -> int:
        """As `initialize`."""
        return self._call(self._step, h)

    def _call(self, function: Any, *arguments: float) -> int:
        refusal, exception = c_int64(), c_void_p()
        if function(byref(refusal), byref(exception), self.memory.ctypes.data, *arguments):
            raise ArithmeticError
        return refusal.value


def equal(block: Any, compiled: Compiled) -> bool:
    """Whether every field, registered or not, has the same bits."""
    return image(block).tobytes() == compiled.memory.tobytes()
