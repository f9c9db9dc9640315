"""A block with all that it needs, as two files of C."""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any

from ...archive import sources
from ...errors import UserError
from ..memory_layout import dtype
from ..subset import order
from ..subset.effects import Effects
from ..subset.modules import read_block
from ..subset.package import MODEL, Kind, Package, Reading, name_of
from .expressions import TYPES
from .functions import Function
from .helpers import texts
from .names import Names
from .raising import Raising
from .structs import Structs
from .text import comments, docstring, literal, with_comment

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
HELPERS = """\
#if defined __GNUC__ || defined __clang__
#define APART __attribute__((noinline)) /* not made part of what calls it */
#else
#define APART
#endif

/* --- as Python does it --- */
"""
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
    """All that a block needs, and its text.

    Raises:
        UserError: the block is outside the kernel subset.
    """

    def __init__(self, block: Any) -> None:
        self.block = block
        module = type(block).__module__
        self.root = module.partition(".")[0]
        found = texts_of(module)
        self.package = Package(found)
        self.main = self.class_of(type(block))
        if violations := read_block(self.package, self.main):
            raise UserError("\n".join(map(str, violations)))
        self.effects = Effects(self.package)
        if violations := order.violations(self.effects):
            raise UserError("\n".join(map(str, violations)))
        self.raising = Raising(self.effects)
        self.names = Names(self.package)
        self.texts = {file: text.splitlines() for file, text in found.items()}
        self.comments = {file: dict(comments(text)) for file, text in found.items()}
        self.helpers: set[str] = set()
        self.constants: dict[ast.stmt, str] = {}
        self.tuples: dict[str, tuple[Kind, ...]] = {}
        self.types: dict[ast.ClassDef, None] = {}
        self.structs = Structs(self)
        self.entries = [self.package.readings[self.package.method(self.main, m)] for m in ("initialize", "step")]
        self.bodies = {reading: Function(self, reading).text() for reading in self.needed()}
        self.types |= self.structs.in_order(self.main)

    # --- what is where ---

    def class_of(self, cls: type) -> ast.ClassDef:
        own = (node for node in self.package.homes if isinstance(node, ast.ClassDef) and node.name == cls.__name__)
        return next(node for node in own if self.running(node) is cls)

    def running(self, node: ast.ClassDef) -> Any:
        """The class itself, as it runs."""
        parts = PurePosixPath(self.package.homes[node]).with_suffix("").parts
        inside = () if parts[0] == self.root else (MODEL,)
        return getattr(importlib.import_module(".".join((*inside, *parts))), node.name)

    def needed(self) -> list[Reading]:
        """The functions that the block calls, each after nothing in particular."""
        found = dict.fromkeys(self.entries)
        wanted = list(found)
        while wanted:
            wanted = [callee for one in wanted for callee in self.effects.callees(one) if callee not in found]
            found |= dict.fromkeys(wanted)
        return list(found)

    # --- names that the text needs ---

    def constant(self, statement: ast.stmt) -> str:
        return self.constants.setdefault(statement, self.names.of(statement))

    def enumerator(self, node: ast.ClassDef, member: str) -> str:
        self.types.setdefault(node)
        item = next(item for item in node.body if name_of(item) == member)
        return self.names.of(item)

    def type_of(self, kind: Kind) -> str:
        if isinstance(kind, ast.ClassDef):
            self.types.setdefault(kind)
            return self.names.of(kind)
        if isinstance(kind, tuple):
            letters = "".join({"float": "d", "bool": "b"}.get(str(part), "i") for part in kind)
            name = f"Real{len(kind)}" if set(letters) == {"d"} else f"Tuple_{letters}"
            self.tuples[name] = kind
            return name
        return TYPES[kind]

    # --- the files ---

    def header(self) -> str:
        parts = []
        for file in self.modules():
            types = [self.structs.text(node) for node in self.package.trees[file].body if node in self.types]
            parts += [f"/* ===== {file} ===== */\n", *types] if types else []
        return HEADER.format(name=self.names.of(self.main), types="\n".join(parts))

    def source(self) -> str:
        modules = [part for file in self.modules() for part in self.module(file)]
        tuples = [self.tuple_text(*shape) for shape in sorted(self.tuples.items())]
        helpers = list(texts(self.helpers))
        parts = [*([HELPERS, *helpers] if helpers else []), *([TUPLES, *tuples] if tuples else []), *modules]
        block = BLOCK.format(size=dtype(self.block).itemsize, start=self.structs.start(self.block))
        return HEAD.format(name=self.names.of(self.main)) + "\n".join([*parts, block, *map(self.entry, self.entries)])

    def modules(self) -> dict[str, None]:
        """Each after those that it imports from."""
        found: dict[str, None] = {}
        for file in self.package.trees:
            self.follow(file, found, ())
        return found

    def follow(self, file: str, found: dict[str, None], above: tuple[str, ...]) -> None:
        if file in found or file in above:
            return
        for node in self.package.trees[file].body:
            if isinstance(node, ast.ImportFrom):
                other = f"{self.package.origin(file, node)}.py"
                if other in self.package.trees:
                    self.follow(other, found, (*above, file))
        found[file] = None

    def module(self, file: str) -> Iterator[str]:
        tree = self.package.trees[file]
        constants = [line for n in tree.body if n in self.constants for line in self.constant_text(file, n)]
        readings = sorted((r for r in self.bodies if r.file == file), key=lambda reading: reading.node.lineno)
        prototypes = [line for reading in readings for line in Function(self, reading).prototype()]
        if constants or readings:
            yield f"/* ===== {file} ===== */\n"
            if lines := docstring(tree):
                yield "\n".join([*lines, ""])
            yield from ("\n".join([*lines, ""]) for lines in (constants, prototypes) if lines)
            yield from (self.bodies[reading] for reading in readings)

    def constant_text(self, file: str, node: ast.stmt) -> list[str]:
        """A constant; one that is computed has its formula as a comment."""
        assert isinstance(node, ast.Assign | ast.AnnAssign)
        value = self.package.number(file, node.value)
        assert value is not None
        plain = isinstance(node.value, ast.UnaryOp) and isinstance(node.value.operand, ast.Constant)
        expression = None if plain else node.value
        said = [ast.unparse(expression)] if not isinstance(expression, ast.Constant) and expression else []
        own, words = self.comments[file].get(node.lineno, (True, ""))
        kind = {float: "double", bool: "bool"}.get(type(value), "int64_t")
        line = f"static const {kind} {self.constants[node]} = {literal(value)};"
        return with_comment(line, said if own else [*said, words])

    def tuple_text(self, name: str, kinds: tuple[Kind, ...]) -> str:
        types = [TYPES[kind] if isinstance(kind, str) else "int64_t" for kind in kinds]
        rows = "".join(f"    {kind} v{i};\n" for i, kind in enumerate(types))
        return f"typedef struct {{\n{rows}}} {name};\n"

    def entry(self, reading: Reading) -> str:
        failing = reading in self.raising.failing
        arguments = ["self", *(["h"] if reading.node.name == "step" else []), *(["failed"] if failing else [])]
        return ENTRY.format(
            method=reading.node.name,
            parameter=", double h" if "h" in arguments else "",
            unused="" if failing else "(void)failed;\n    ",
            call=f"{self.names.function(reading)}({', '.join(arguments)})",
        )


def texts_of(module: str) -> dict[str, str]:
    """The text of a module, and of those of its package and of the model that it imports, by their paths.

    Paths of the model begin inside its package; those of another package begin with its name."""
    root = module.partition(".")[0]
    if root == MODEL:
        return {name: text.decode() for name, text in sources(module).items()}
    if "." in module:
        own = {f"{root}/{name}": text.decode() for name, text in sources(module).items()}
    else:
        own = {f"{root}.py": Path(str(importlib.import_module(module).__file__)).read_text("utf-8")}
    imports = [node for text in own.values() for node in ast.parse(text).body if isinstance(node, ast.ImportFrom)]
    of_model = {str(node.module) for node in imports if not node.level and f"{node.module}".startswith(f"{MODEL}.")}
    return {name: text for other in sorted(of_model) for name, text in texts_of(other).items()} | own
