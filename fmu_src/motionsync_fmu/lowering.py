"""Numba's code as it was lowered: LLVM's text of functions and of all that they call, not optimised and not loaded.

Numba optimises, compiles and loads each function for itself, together with copies of all that it calls: of a block with
hundreds of methods that is most of its time, and none of it is used here.
"""

from collections.abc import Mapping
from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target


class _Library(JITCodeLibrary):  # type: ignore[misc]
    """One function's code, left as it is."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0

    def _get_module_for_linking(self) -> Any:
        """A function of Numba's own that was compiled here may later be needed by one that is compiled as usual."""
        if self._shared_module is None:
            link(self._final_module, _called(self))
        return super()._get_module_for_linking()


class _Codegen(JITCPUCodegen):  # type: ignore[misc]
    _library_class = _Library

    def set_env(self, name: str, environment: Any) -> None:
        """There is none: nothing is loaded."""


def lowered(functions: Mapping[str, tuple[Any, tuple[Any, ...]]]) -> tuple[llvm.ModuleRef, dict[str, str]]:
    """One module for functions with the types of their arguments, and which name in it stands for which function."""
    target = cpu_target.target_context
    with global_compiler_lock:
        usual, target._internal_codegen = target._internal_codegen, _Codegen("motionsync")
        try:
            for dispatcher, arguments in functions.values():
                dispatcher.compile(arguments)
        finally:
            target._internal_codegen = usual
    compiled = {name: dispatcher.overloads[arguments] for name, (dispatcher, arguments) in functions.items()}
    whole = llvm.parse_assembly("")
    link(whole, {library: None for c in compiled.values() for library in (*_called(c.library), c.library)})
    return whole, {c.fndesc.llvm_func_name: name for name, c in compiled.items()}


def link(whole: llvm.ModuleRef, libraries: Mapping[Any, None]) -> None:
    for library in libraries:
        module = library._final_module if isinstance(library, _Library) else library._get_module_for_linking()
        whole.link_in(module, preserve=True)


def _called(library: Any) -> dict[Any, None]:
    """The libraries that one needs, each once, in an order that is the same every time."""
    found: dict[Any, None] = {}
    wanted = [*library._linking_libraries]
    while wanted:
        other = wanted.pop()
        if other not in found and other is not library:
            found[other] = None
            wanted += other._linking_libraries if isinstance(other, _Library) else ()
    return found
