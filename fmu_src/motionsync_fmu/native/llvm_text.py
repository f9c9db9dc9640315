"""A block's `initialize` and `step` as LLVM text: the same for every platform, with the same bits as in Python."""

import re
from typing import Any

import llvmlite.binding as llvm
from numba import types

from .memory_layout import entry, record
from .numba_target import lowered

# Numba stores an exception's kind and message, and a None result, for the interpreter. A native unit has no
# interpreter, so these stores are dead.
DEAD_STORE = re.compile(r"^ +store ptr (?:\S+, ptr %excinfo|null, ptr %retptr),.*\n", re.M)

# What the compiled block may call of the C library and of LLVM: all of it exact by IEEE 754, or without floating point.
EXACT = {"sqrt", "floor", "rint", "fmod", "fabs"}
PLAIN = re.compile(r"llvm\.(?:(?:mem(?:set|cpy|move)|lifetime|assume|is\.fpclass)\b.*|\w+\.i\d+)")
# Flags and calls that would let processors round differently. Only this check excludes them, since -ffp-contract has
# no effect on LLVM text.
INEXACT = re.compile(
    r"\b(?:f(?:add|sub|mul|div|rem|neg|cmp)|select|phi|call)\b[^\n]*?"
    r"\b(?:fast|contract|reassoc|arcp|afn|nnan|ninf|nsz)\b|@llvm\.fma|@llvm\.fmuladd"
)


def llvm_text(block: Any) -> str:
    """`model_initialize` and `model_step` with all that they call, and nothing else: no Python, no unknown symbol.

    Raises:
        RuntimeError: the compiled block would call something unknown, or may be rounded differently elsewhere.
    """
    this = record(block)
    methods = {"initialize": (this,), "step": (this, types.float64)}
    whole, entries = lowered({f"model_{m}": (entry(type(block), m), arguments) for m, arguments in methods.items()})
    whole = llvm.parse_assembly(DEAD_STORE.sub("", str(whole)))
    _hide_all_but(whole, entries)
    _optimise(whole)
    return portable(str(whole))


def _hide_all_but(module: llvm.ModuleRef, entries: dict[str, str]) -> None:
    """Give the entry points their names, and let the optimisation drop what they do not need.

    Numba's own names contain a counter of what the process has compiled before; therefore they are replaced, too."""
    for i, symbol in enumerate((*module.functions, *module.global_variables)):
        if symbol.name in entries:
            symbol.linkage, symbol.visibility, symbol.name = "external", "hidden", entries[symbol.name]
        elif not symbol.is_declaration:
            symbol.linkage, symbol.name = "internal", f"internal_{i}"


def _optimise(module: llvm.ModuleRef) -> None:
    """Optimise once for all platforms, and for size: most of a large block is planning, which few steps do."""
    for function in module.functions:
        if not function.is_declaration:
            for attribute in ("optsize", "nounwind"):  # nounwind: no tables for C++ exceptions
                function.add_function_attribute(attribute)
    llvm.initialize_native_target()
    machine = llvm.Target.from_default_triple().create_target_machine()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    first = llvm.create_new_module_pass_manager()
    first.add_merge_functions_pass()  # equal inherited methods become one before they are inlined
    first.run(module, builder)
    builder.getModulePassManager().run(module, builder)


def portable(text: str) -> str:
    """The LLVM text without the target that it names.

    Raises:
        RuntimeError: the text calls anything outside the allow-list, may be rounded differently elsewhere, or is for
            one processor only.
    """
    text = re.sub(r"^(target|source_filename|; ModuleID).*\n", "", text, flags=re.M)
    called = re.findall(r"^declare .*?@([\w.]+)\(", text, re.M)
    foreign = [n for n in called if re.sub(r"^llvm\.|\.f64$", "", n) not in EXACT and not PLAIN.fullmatch(n)]
    if foreign:
        raise RuntimeError(f"the compiled block needs {sorted(foreign)}")
    if inexact := INEXACT.search(text):
        raise RuntimeError(f"not the same bits everywhere: {inexact[0]}")
    if "target-" in text:
        raise RuntimeError("the compiled block is for one processor only")
    return text
