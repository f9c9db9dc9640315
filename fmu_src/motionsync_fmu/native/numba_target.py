"""Numba as it lowers a function and all that it calls to LLVM's text, which is neither optimised nor loaded.

As usual Numba optimises, compiles and loads each function for itself, with copies of all that it calls: of a block with
hundreds of methods that is most of its time, and none of it is used here. So the blocks are compiled for a target of
their own (numba.core.target_extension): the usual one stays as it is, and what it has compiled is not found here.
"""

from collections.abc import Callable, Mapping
from functools import cached_property, partial
from typing import Any

import llvmlite.binding as llvm
from numba import jit
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.cpu import CPUContext
from numba.core.registry import CPUDispatcher, CPUTarget
from numba.core.target_extension import CPU, dispatcher_registry, jit_registry, target_registry

TARGET = "text"


class _Library(JITCodeLibrary):  # type: ignore[misc]
    """One function's code, left as it is."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _Codegen(JITCPUCodegen):  # type: ignore[misc]
    _library_class = _Library

    def set_env(self, name: str, environment: Any) -> None:
        """There is none: nothing is loaded."""


class _Context(CPUContext):  # type: ignore[misc]
    def init(self) -> None:
        super().init()
        self._internal_codegen = _Codegen("motionsync")


class _Descriptor(CPUTarget):  # type: ignore[misc]
    @cached_property
    def _toplevel_target_context(self) -> _Context:
        return _Context(self.typing_context, TARGET)


class _Dispatcher(CPUDispatcher):  # type: ignore[misc]
    targetdescr = _Descriptor(TARGET)


class _Text(CPU):  # type: ignore[misc]
    """All that is made for a CPU is for this target too."""


target_registry[TARGET] = _Text
dispatcher_registry[_Text] = _Dispatcher
text_of: Callable[..., Any] = partial(jit, _target=TARGET)
jit_registry[_Text] = text_of


def lowered(functions: Mapping[str, tuple[Any, tuple[Any, ...]]]) -> tuple[llvm.ModuleRef, dict[str, str]]:
    """One module for functions (from `text_of`) of arguments of these types, and which name in it stands for which."""
    libraries: dict[Any, None] = {}
    names = {}
    for name, (function, arguments) in functions.items():
        function.compile(arguments)
        compiled = function.overloads[arguments]
        names[compiled.fndesc.llvm_func_name] = name
        _collect(compiled.library, libraries)
    whole = llvm.parse_assembly("")
    for library in libraries:
        whole.link_in(library._final_module, preserve=True)
    return whole, names


def _collect(library: Any, found: dict[Any, None]) -> None:
    """A library and all that it needs, each once, in an order that is the same every time."""
    if library not in found:
        found[library] = None
        for other in library._linking_libraries:
            _collect(other, found)
