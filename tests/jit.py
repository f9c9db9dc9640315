"""A block's compiled code in this process, without zig and FMI: the quick way to compare it with the Python source."""

from ctypes import CFUNCTYPE, byref, c_double, c_int32, c_int64, c_void_p
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from motionsync_fmu.native import llvm_text
from motionsync_fmu.record import image


@cache
def engine(block_type: type) -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=2)
    return llvm.create_mcjit_compiler(llvm.parse_assembly(llvm_text(block_type())), machine)


class Compiled:
    """One block in compiled code, with the present values of a Python one.

    Attributes:
        memory: all its fields, as NumPy names them.
    """

    def __init__(self, block: Any) -> None:
        self.memory = image(block)
        address = engine(type(block)).get_function_address
        self._initialize = CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p)(address("model_initialize"))
        self._step = CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_double)(address("model_step"))

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
