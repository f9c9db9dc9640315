"""A block with all that it needs, as two files of C; or another class, as one file that the C of its owner includes."""

import ast
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..memory_layout import dtype
from ..subset.package import CheckedFunction, Kind
from .context import TYPES, Context
from .function_writer import FunctionWriter
from .helpers import helper_texts
from .part_functions import PartFunctions
from .structs import StructWriter
from .text import append_comment, docstring, literal

HEADER = """\
/* {name}, as portable C99: generated from the Python source, whose names, words and order it keeps.
 *
 * A block's memory is one struct of fixed size, without pointers. `block_start` puts the start values into it; then
 * `block_initialize` may be called again and again. It and `block_step` return the refusal, 0 if there is none. They
 * set `failed` where Python would raise, at a division by zero for instance: the memory then holds no good values, and
 * is to get the start values anew. */
#ifndef BLOCK_H
#define BLOCK_H

#include <stdbool.h>
#include <stdint.h>

{types}
typedef {name} Block;

void block_start(Block *self);
int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed); /* from t to t + h, in s */

#endif
"""
HEAD = """\
/* {name}, as portable C99: generated from the Python source, whose names, words and order it keeps.
 *
 * The same bits everywhere: IEEE 754 doubles, rounded to nearest, no fused operations, no extended precision.
 * `failed` becomes true, and stays so, where Python would raise: at a division by zero, at an index outside a list. */
#include "block.h"
{requirements}"""
REQUIREMENTS = """\
#include <float.h>
#include <math.h>

#if DBL_MANT_DIG != 53 || DBL_MAX_EXP != 1024
#error "needs IEEE 754 doubles of 64 bits"
#endif
#if defined FLT_EVAL_METHOD && FLT_EVAL_METHOD != 0
#error "needs arithmetic in double: no x87"
#endif
#if defined __FAST_MATH__ || (defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__) || defined __ASSOCIATIVE_MATH__ \\
    || defined __RECIPROCAL_MATH__ || defined __NO_SIGNED_ZEROS__ || defined _M_FP_FAST
#error "needs IEEE 754 arithmetic: no -ffast-math, nor any part of it"
#endif
#if defined __clang__
#pragma STDC FP_CONTRACT OFF
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize") /* that pass fuses operations nevertheless */
#elif defined _MSC_VER
#pragma fp_contract(off)
#endif

"""
INCLUDED = """\
/* {name}, as portable C99: generated from the Python source, whose names, words and order it keeps.
 *
 * All functions are static: the loop that includes this file has no calls. `failed` becomes true, and stays so, where
 * Python would raise. */
#include <stdbool.h>
#include <stdint.h>
{requirements}
"""
SERIES = """\
typedef struct { /* the address of the first number, and how many there are; 64 bits also where an address has 32 */
    int64_t address, count;
} Series;

#define REALS(series) ((double *)(intptr_t)(series).address)
#define WHOLES(series) ((int64_t *)(intptr_t)(series).address)
"""
METHODS = ("initialize", "step")  # of a block
HELPERS = """\
#if defined __GNUC__ || defined __clang__
#define APART __attribute__((noinline)) /* not made part of what calls it */
#else
#define APART
#endif

/* --- as Python does it --- */
"""
PARTS = "/* --- parts of one class, field by field --- */\n"
TUPLES = "/* --- what functions return that return several values --- */\n"
BLOCK = """\
/* ===== the block ===== */

typedef char doubles_are_aligned_to_8_bytes[sizeof(Block) == {size} ? 1 : -1]; /* else no variable would be found */

static const Block START = {start};

void block_start(Block *self) {{
    *self = START;
}}
"""
ENTRY = """\
int64_t block_{method}(Block *self{parameter}, bool *failed) {{
    {unused}return {call};
}}
"""


class Program:
    """The functions of a block's class and of all that it needs, translated.

    `texts`: of its modules, as `module_texts` gives them.

    Raises:
        UserError: the block is outside the kernel subset.
    """

    def __init__(self, block_class: type[Any], texts: Mapping[str, str], entries: Sequence[str] = METHODS) -> None:
        self.context = context = Context(block_class, texts)
        context.is_inline = entries != METHODS
        self.package, self.names = context.package, context.names
        self.structs = StructWriter(context)
        methods = (self.package.find_method(context.block_class, name) for name in entries)
        self.entries = [self.package.functions[method] for method in methods if method]
        self.writers = {
            function: FunctionWriter(context, function) for function in context.effects.reachable_from(self.entries)
        }
        self.bodies = {function: writer.text() for function, writer in self.writers.items()}
        context.types |= context.required_classes(context.block_class)

    # --- the files ---

    def included(self) -> str:
        """The class and its functions as one text, for another file to include; with all enumerations."""
        self.context.types |= dict.fromkeys(self.package.enumerations)
        head = INCLUDED.format(name=self.names.name_of(self.context.block_class), requirements=REQUIREMENTS)
        return head + "\n".join([*self.types(), *self.functions()])

    def header(self) -> str:
        name = self.names.name_of(self.context.block_class)
        return HEADER.format(name=name, types="\n".join(self.types()))

    def types(self) -> list[str]:
        parts = []
        for file in self.modules():
            types = [self.structs.text(node) for node in self.package.trees[file].body if node in self.context.types]
            parts += [f"/* ===== {file} ===== */\n", *types] if types else []
        return [SERIES, *parts] if self.package.has_series(self.context.block_class) else parts

    def source(self, block: Any) -> str:
        """The text of block.c; `block` has the start values."""
        memory = BLOCK.format(size=dtype(block).itemsize, start=self.structs.start(block))
        head = HEAD.format(name=self.names.name_of(self.context.block_class), requirements=REQUIREMENTS)
        return head + "\n".join([*self.functions(), memory, *map(self.entry, self.entries)])

    def functions(self) -> list[str]:
        """All functions, with the constants and helpers that they need."""
        modules = [part for file in self.modules() for part in self.module(file)]
        tuples = [self.tuple_text(*shape) for shape in sorted(self.context.tuples.items())]
        helpers = list(helper_texts(self.context.helpers))
        parts = list(PartFunctions(self.context).texts())
        sections = ((HELPERS, helpers), (TUPLES, tuples), (PARTS, parts))
        return [text for heading, texts in sections if texts for text in (heading, *texts)] + modules

    def modules(self) -> dict[str, None]:
        """The modules, each after those that it imports from."""
        ordered: dict[str, None] = {}
        for file in self.package.trees:
            self.add_module(file, ordered, ())
        return ordered

    def add_module(self, file: str, ordered: dict[str, None], importing: tuple[str, ...]) -> None:
        if file in ordered or file in importing:
            return
        for node in self.package.trees[file].body:
            if isinstance(node, ast.ImportFrom):
                other = f"{self.package.import_path(file, node)}.py"
                if other in self.package.trees:
                    self.add_module(other, ordered, (*importing, file))
        ordered[file] = None

    def module(self, file: str) -> Iterator[str]:
        tree = self.package.trees[file]
        if header := self.package.header(file):
            yield header
            return
        constants = [line for n in tree.body if n in self.context.constants for line in self.constant_text(file, n)]
        functions = sorted((f for f in self.bodies if f.file == file), key=lambda f: f.node.lineno)
        prototypes = [line for function in functions for line in self.writers[function].prototype()]
        if constants or functions:
            yield f"/* ===== {file} ===== */\n"
            if lines := docstring(tree):
                yield "\n".join([*lines, ""])
            yield from ("\n".join([*lines, ""]) for lines in (constants, prototypes) if lines)
            yield from (self.bodies[function] for function in functions)

    def constant_text(self, file: str, node: ast.stmt) -> list[str]:
        """A constant; one that is computed has its formula as a comment."""
        assert isinstance(node, ast.Assign | ast.AnnAssign)
        value = self.package.constant_value(file, node.value)
        assert value is not None
        is_negative_number = isinstance(node.value, ast.UnaryOp) and isinstance(node.value.operand, ast.Constant)
        expression = None if is_negative_number else node.value
        formula = [ast.unparse(expression)] if not isinstance(expression, ast.Constant) and expression else []
        own, words = self.context.comments[file].get(node.lineno, (True, ""))
        kind = {float: "double", bool: "bool"}.get(type(value), "int64_t")
        line = f"static const {kind} {self.context.constants[node]} = {literal(value)};"
        return append_comment(line, formula if own else [*formula, words])

    def tuple_text(self, name: str, kinds: tuple[Kind, ...]) -> str:
        types = [TYPES[kind] if isinstance(kind, str) else "int64_t" for kind in kinds]
        rows = "".join(f"    {kind} v{i};\n" for i, kind in enumerate(types))
        return f"typedef struct {{\n{rows}}} {name};\n"

    def entry(self, function: CheckedFunction) -> str:
        failing = function in self.context.raising.failing
        arguments = ["self", *(["h"] if function.node.name == "step" else []), *(["failed"] if failing else [])]
        return ENTRY.format(
            method=function.node.name,
            parameter=", double h" if "h" in arguments else "",
            unused="" if failing else "(void)failed;\n    ",
            call=f"{self.names.name_of(function.node)}({', '.join(arguments)})",
        )
