"""A Numba target that stops at LLVM's text: functions and all that they call, neither optimised nor loaded.

Numba's usual target optimises, compiles and loads each function by itself, with copies of all functions that it calls.
For a block with hundreds of methods that takes most of Numba's time, and nothing of it is used here. So the blocks are
compiled for a target of their own (numba.core.target_extension); neither target sees what the other one has compiled.
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
        """Do nothing: code that is not loaded has no environment."""


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
    """This target may use everything that Numba has for a CPU."""


target_registry[TARGET] = _Text
dispatcher_registry[_Text] = _Dispatcher
text_of: Callable[..., Any] = partial(jit, _target=TARGET)
jit_registry[_Text] = text_of


def lowered(functions: Mapping[str, tuple[Any, tuple[Any, ...]]]) -> tuple[llvm.ModuleRef, dict[str, str]]:
    """One module with these functions (made by `text_of`) for arguments of these types.

    Returns:
        The module, and a table from each function's name in the module to the name under which it was given.
    """
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
    """Add a library and all that it needs, each once, in an order that is always the same."""
    if library not in found:
        found[library] = None
        for other in library._linking_libraries:
            _collect(other, found)
