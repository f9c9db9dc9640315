"""A block as portable C99: a struct for each dataclass, a function for each method, with the source's names and words.

The checker of the kernel subset (`functions.Body`) tells the kind of each expression; the running classes tell fields,
lengths and start values. An analysis of the whole program tells what a function writes (`const`; and that the order in
which C evaluates cannot matter) and whether Python might raise in it: such a function has a parameter `failed`, which
becomes true, and stays so, with a division by zero, an index outside a list or a whole number beyond 64 bits.
"""

import ast
import importlib
import io
import math
import textwrap
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from enum import IntEnum
from pathlib import Path, PurePosixPath
from typing import Any

from ...archive import Files, sources
from ..memory_layout import dtype
from ..subset.expressions import COPY
from ..subset.functions import Body, without_docstring
from ..subset.package import Kind, Package

WIDTH = 120
RESERVED = set(
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool true "
    "false asm failed".split()
)
# How tight operators bind.
PRIMARY, UNARY, PRODUCT, SUM, RELATION, EQUALITY, AND, OR, CHOICE = 15, 14, 13, 12, 10, 9, 5, 4, 3
ARITHMETIC = {ast.Add: ("+", SUM), ast.Sub: ("-", SUM), ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT)}
COMPARISON = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
TYPES = {"float": "double", "list": "double", "int": "int64_t", "bool": "bool", "None": "void"}
BREAKS = {",": 0, "?": 1, ":": 1, "||": 2, "&&": 3, "+": 4, "-": 4, "*": 5}  # where a line is broken first
ANY_LIST = ("list", "")  # what an access to an element of any list counts as
Effect = set[tuple[str, str]]  # classes and fields
Code = tuple[str, int]  # text, and how tight it binds

HELPERS = {  # what Python does and C does not: type, parameters, body; those that may fail have the parameter `failed`
    "py_divided": ("double", "double x, double y", "if (y == 0.0) *failed = true;\nreturn x / y;"),
    "py_min": ("double", "double a, double b", "return b < a ? b : a;"),
    "py_max": ("double", "double a, double b", "return b > a ? b : a;"),
    "py_min_int": ("int64_t", "int64_t a, int64_t b", "return b < a ? b : a;"),
    "py_max_int": ("int64_t", "int64_t a, int64_t b", "return b > a ? b : a;"),
    "py_abs_int": ("int64_t", "int64_t a", "return a < 0 ? -a : a;"),
    "py_isfinite": ("bool", "double x", "return fabs(x) <= DBL_MAX;"),
    "py_int": (
        "int64_t",
        "double x",
        "if (x >= -9223372036854775808.0 && x < 9223372036854775808.0) return (int64_t)x;\n*failed = true;\nreturn 0;",
    ),
    "py_floor": (
        "double",
        "double x",
        "if (!(fabs(x) <= DBL_MAX)) *failed = true;\nreturn floor(x) + 0.0; /* no -0.0 */",
    ),
    "py_round": (
        "double",
        "double x",
        "if (!(fabs(x) <= DBL_MAX)) *failed = true;\nreturn rint(x) + 0.0; /* halves to even; no -0.0 */",
    ),
    "py_at": (
        "int64_t",
        "int64_t i, int64_t length",
        "if (i < 0) i += length;\nif (i >= 0 && i < length) return i;\n*failed = true;\nreturn 0;",
    ),
    "py_mod_int": (
        "int64_t",
        "int64_t a, int64_t b",
        "if (b == 0) {\n    *failed = true;\n    return 0;\n}\nconst int64_t rest = a % b;\n"
        "return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;",
    ),
    "py_floordiv_int": (
        "int64_t",
        "int64_t a, int64_t b",
        "const int64_t rest = py_mod_int(a, b, failed);\nreturn b == 0 ? 0 : (a - rest) / b;",
    ),
    "py_mod": (
        "double",
        "double x, double y",
        "if (y == 0.0) *failed = true;\nconst double rest = fmod(x, y);\n"
        "if (rest == 0.0) return y < 0.0 ? -0.0 : 0.0;\nreturn (rest < 0.0) != (y < 0.0) ? rest + y : rest;",
    ),
}
FAILING = {name for name, (_, _, body) in HELPERS.items() if "failed" in body}
HEADER = """\
/* {name}, as portable C99: generated from the Python source, whose names, words and order it keeps.
 *
 * A block's memory is one struct, of fixed size and without pointers: START is its content before `block_initialize`,
 * which may be called again and again. Both functions return the refusal, 0 if there is none. They set `failed` where
 * Python would raise: at a division by zero, at an index outside a list; the block is to be started anew then. */
#ifndef BLOCK_H
#define BLOCK_H

#include <stdbool.h>
#include <stdint.h>

{types}
typedef {name} Block;

extern const Block START;

int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed);

#endif
"""
HEAD = """\
/* {name}, as portable C99: generated from the Python source, whose names, words and order it keeps.
 *
 * The same bits everywhere: IEEE 754 doubles, rounded to nearest, no fused operations, no extended precision.
 * `failed` becomes true, and stays so, where Python would raise: a division by zero, an index outside a list. */
#include "block.h"
#include <float.h>
#include <math.h>
#include <stddef.h>
#if defined __FAST_MATH__ || (defined FLT_EVAL_METHOD && FLT_EVAL_METHOD != 0)
#error "needs IEEE 754 arithmetic in double: no -ffast-math, no x87"
#endif
#if defined __clang__
#pragma STDC FP_CONTRACT OFF
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off")
#elif defined _MSC_VER
#pragma fp_contract(off)
#endif
"""
LAYOUT = """\
typedef char doubles_are_aligned_to_8_bytes[sizeof(Block) == {size} ? 1 : -1]; /* else no variable would be found */

const Block START = {start};
"""
ENTRY = """\
int64_t block_{method}(Block *self{parameter}, bool *failed) {{
    {call}
}}
"""


def c_source(block: Any) -> Files:
    """The C of a block: block.h with its memory and its two functions, and block.c.

    Raises:
        UnsupportedError: the block needs something that is not translated.
    """
    program = Program(block)
    source = program.source()
    return {"block.h": program.header().encode(), "block.c": source.encode()}


class UnsupportedError(Exception):
    """Inside the checker's subset, but not of this translator; file and line are told."""


@dataclass(eq=False)
class Function:
    """A function or method that the block needs, and what the analysis of the whole program tells of it."""

    file: str
    node: ast.FunctionDef
    owner: ast.ClassDef | None
    name: str
    body: "Translator" = field(init=False)
    reads: Effect = field(default_factory=set)
    writes: Effect = field(default_factory=set)
    written: set[str] = field(default_factory=set)  # parameters, and locals that stand for an object, that are changed
    fails: bool = False

    @property
    def parameters(self) -> list[str]:
        return [argument.arg for argument in self.node.args.args]


class Program:
    """All that a block needs, and its text. `checked`: what Python would raise is told through `failed`."""

    def __init__(self, block: Any, *, checked: bool = True) -> None:
        self.block, self.checked = block, checked
        module = type(block).__module__
        self.root, inside, _ = module.partition(".")
        if inside:
            self.texts = {name: text.decode() for name, text in sources(module).items()}
        else:  # a module without a package
            self.texts = {f"{module}.py": Path(str(importlib.import_module(module).__file__)).read_text("utf-8")}
        self.package = Package(self.texts)
        for node, file in self.package.homes.items():  # also those whose base stands in another package
            known = isinstance(node, ast.ClassDef) and not self.package.exempt(file)
            if isinstance(node, ast.ClassDef) and known and issubclass(self.running(file, node.name), IntEnum):
                self.package.enumerations.add(node)
        self.comments = {file: dict(comments(text)) for file, text in self.texts.items()}
        self.global_names = self.names_of_file()
        self.functions: dict[ast.FunctionDef, Function] = {}
        self.constants: dict[tuple[str, str], str] = {}  # by file and name: the name in C
        self.tuples: dict[str, tuple[Kind, ...]] = {}
        self.helpers: set[str] = set()
        self.lengths: dict[tuple[Function, str], int] = {}  # of lists that are parameters
        self.main = self.class_of(type(block))
        self.classes = {self.main}
        self.entries = [self.function(*self.method(self.main, name)) for name in ("initialize", "step")]
        before = -1
        while before != (before := sum(map(self.known_of, self.functions.values()))):
            for f in list(self.functions.values()):
                f.body.effects()
        for f in self.functions.values():
            f.body.check_order()

    @staticmethod
    def known_of(f: Function) -> int:
        return len(f.reads) + len(f.writes) + len(f.written) + f.fails

    # --- what is where ---

    def names_of_file(self) -> set[str]:
        """All that may be declared at the file's level: no local hides one of these."""
        found = set(HELPERS) | {"sqrt", "floor", "rint", "fmod", "fabs"}
        for node, file in self.package.homes.items():
            stem = PurePosixPath(file).stem
            match node:
                case ast.FunctionDef(name=name):
                    found.add(f"{stem}_{name}")
                case ast.ClassDef(name=name):
                    found |= {f"{name}_{m.name}" for m in node.body if isinstance(m, ast.FunctionDef)}
                    found |= {self.class_name(node)}
                case _:
                    found |= {target(node)} - {""}
        return found

    def class_of(self, cls: type) -> ast.ClassDef:
        file = cls.__module__.removeprefix(f"{self.root}.").replace(".", "/") + ".py"
        return next(n for n in self.package.trees[file].body if isinstance(n, ast.ClassDef) and n.name == cls.__name__)

    def running(self, file: str, name: str) -> Any:
        """What Python has under that name."""
        parts = PurePosixPath(file).with_suffix("").parts
        package = () if file == f"{self.root}.py" else (self.root,)
        return getattr(importlib.import_module(".".join((*package, *parts))), name)

    def base(self, node: ast.ClassDef) -> ast.ClassDef | None:
        found = self.package.meaning(self.package.homes[node], node.bases[0]) if node.bases else None
        return found if isinstance(found, ast.ClassDef) else None

    def defining(self, node: ast.ClassDef, name: str, sort: type[ast.stmt]) -> tuple[int, ast.ClassDef, Any]:
        """How many bases up a field or method stands, in which class, and its statement."""
        above = self.base(node)
        again = above is not None and self.package.member(above, name, sort) is not None and sort is ast.AnnAssign
        for item in [] if again else node.body:  # a field that is declared anew lies where the base has it
            named = item.target.id if isinstance(item, ast.AnnAssign) else getattr(item, "name", "")  # type: ignore
            if isinstance(item, sort) and named == name:
                return 0, node, item
        assert above, name
        up, place, item = self.defining(above, name, sort)
        return up + 1, place, item

    def method(self, owner: ast.ClassDef, name: str) -> tuple[str, ast.FunctionDef, ast.ClassDef]:
        _, place, node = self.defining(owner, name, ast.FunctionDef)
        return self.package.homes[place], node, place

    def function(self, file: str, node: ast.FunctionDef, owner: ast.ClassDef | None = None) -> Function:
        """The function, and all that it calls."""
        if node not in self.functions:
            before = self.class_name(owner) if owner else PurePosixPath(file).stem
            made = self.functions[node] = Function(file, node, owner, f"{before}_{node.name}")
            made.body = Translator(self, made)
            for call in ast.walk(node):
                made.body.callee(call)
        return self.functions[node]

    def constant(self, statement: ast.stmt) -> str:
        """The name in C of a constant; one that two modules have gets the module's name before it."""
        home, name = self.package.homes[statement], target(statement)
        own = [names for file, names in self.package.names.items() if not self.package.exempt(file)]
        alike = [names for names in own if name in names and target(names[name][0]) == name]
        self.constants[home, name] = f"{PurePosixPath(home).stem.upper()}_{name}" if len(alike) > 1 else name
        return self.constants[home, name]

    def class_name(self, node: ast.ClassDef) -> str:
        """As for constants."""
        alike = [n for n in self.package.homes if isinstance(n, ast.ClassDef) and n.name == node.name]
        module = PurePosixPath(self.package.homes[node]).stem.title().replace("_", "")
        return node.name if len(alike) == 1 else f"{module}{node.name}"

    def type_of(self, kind: Kind) -> str:
        if isinstance(kind, tuple):
            letters = "".join({"float": "d", "bool": "b"}.get(str(k), "i") for k in kind)
            name = f"Real{len(kind)}" if set(letters) == {"d"} else f"Tuple_{letters}"
            self.tuples[name] = kind
            return name
        if isinstance(kind, ast.ClassDef):
            self.classes.add(kind)
            return self.class_name(kind)
        return TYPES[kind]

    def inside(self, kind: Kind) -> Effect:
        """All fields of an object, with those of its parts."""
        found: Effect = set()
        assert isinstance(kind, ast.ClassDef)
        base = self.base(kind)
        found |= self.inside(base) if base else set()
        for item in kind.body:
            if isinstance(item, ast.AnnAssign):
                inner = self.package.kind(self.package.homes[kind], item.annotation)
                found |= {(kind.name, target(item))} | ({ANY_LIST} if inner == "list" else set())
                if isinstance(inner, ast.ClassDef) and inner not in self.package.enumerations:
                    found |= self.inside(inner)
        return found

    # --- text ---

    def header(self) -> str:
        """After `source`, which tells what is needed."""
        types = []
        for file in self.modules():
            nodes = [n for n in self.package.trees[file].body if n in self.structs]
            types += [f"/* ===== {file} ===== */\n", *(self.structs[n] for n in nodes)] if nodes else []
        return HEADER.format(name=self.class_name(self.main), types="\n".join(types))

    def source(self) -> str:
        name = self.class_name(self.main)
        bodies = {f: "\n".join(f.body.emit()) + "\n" for f in self.functions.values()}  # tells what else is needed
        self.structs = {node: self.struct(node) for node in self.in_order(self.main)}
        self.structs |= {node: self.enumeration(node) for node in self.package.enumerations & self.classes}
        modules = [part for file in self.modules() for part in self.module(file, bodies)]
        tuples = []
        for shape, kinds in sorted(self.tuples.items()):
            rows = "".join(f"    {self.type_of(kind)} v{i};\n" for i, kind in enumerate(kinds))
            tuples.append(f"typedef struct {{\n{rows}}} {shape};\n")
        return "\n".join(
            [HEAD.format(name=name), "/* --- as Python does it --- */\n", *self.helper_texts()]
            + (["/* --- what functions return that return several values --- */\n", *tuples] if tuples else [])
            + [*modules, "/* ===== the block ===== */\n", self.layout()]
            + [self.entry(f) for f in self.entries]
        )

    def layout(self) -> str:
        return LAYOUT.format(size=dtype(self.block).itemsize, start=self.start())

    def entry(self, f: Function) -> str:
        h = ", h" if f.node.name == "step" else ""
        call = f"return {f.name}(self{h}{', failed' if f.fails else ''});"
        before = "" if f.fails else "(void)failed;\n    "
        return ENTRY.format(method=f.node.name, parameter=", double h" if h else "", call=before + call)

    def modules(self, file: str = "", found: dict[str, None] | None = None) -> dict[str, None]:
        """Each after those that it imports from."""
        found = {} if found is None else found
        for other in [] if file else self.package.trees:
            self.modules(other, found)
        if file and file not in found:
            for node in self.package.trees[file].body:
                if isinstance(node, ast.ImportFrom) and node.level:
                    other = f"{self.package.origin(file, node)}.py"
                    if other in self.package.trees:
                        self.modules(other, found)
            found[file] = None
        return found

    def module(self, file: str, bodies: dict[Function, str]) -> list[str]:
        tree = self.package.trees[file]
        constants = [self.constant_text(file, n) for n in tree.body if (file, target(n)) in self.constants]
        functions = sorted((f for f in bodies if f.file == file), key=lambda f: f.node.lineno)
        prototypes = [line for f in functions for line in fold(f"{f.body.signature()};")]
        if not (constants or functions):
            return []
        head = [f"/* ===== {file} ===== */\n", *([docstring(tree) + "\n"] if docstring(tree) else [])]
        lists = ["\n".join(some) + "\n" for some in (constants, prototypes) if some]
        return [*head, *lists, *(bodies[f] for f in functions)]

    def helper_texts(self) -> Iterator[str]:
        wanted = self.helpers | set()
        wanted |= {"py_mod_int" for n in self.helpers if n == "py_floordiv_int"}
        for name in sorted(wanted, key=list(HELPERS).index):
            kind, parameters, body = HELPERS[name]
            if not self.checked:
                body = body.replace("if (y == 0.0) *failed = true;\n", "").replace("*failed = true;\n", "")
                body = body.replace(", failed)", ")")
            end = ", bool *failed" if name in FAILING and self.checked else ""
            indented = "".join(f"    {line}\n" for line in body.splitlines())
            yield f"static inline {kind} {name}({parameters}{end}) {{\n{indented}}}\n"

    def constant_text(self, file: str, node: ast.stmt) -> str:
        value, expression = self.running(file, target(node)), node.value  # type: ignore[attr-defined]
        bare = expression.operand if isinstance(expression, ast.UnaryOp) else expression
        said = [] if isinstance(bare, ast.Constant) else [ast.unparse(expression)]
        said += [text for own, text in [self.comments[file].get(node.lineno, (True, ""))] if not own]
        kind = {float: "double", bool: "bool"}.get(type(value), "int64_t")
        return said_at_end(f"static const {kind} {self.constants[file, target(node)]} = {literal(value)};", said)

    def enumeration(self, node: ast.ClassDef) -> str:
        name, members = self.class_name(node), self.running(self.package.homes[node], node.name)
        rows = [said_at_end(f"    {name}_{m.name} = {int(m)},", [m.description]) for m in members]
        return "\n".join([docstring(node), f"typedef int64_t {name};", "enum {", *rows, "};\n"])

    def in_order(self, node: ast.ClassDef) -> dict[ast.ClassDef, None]:
        """A class after its base and the classes of its fields."""
        found: dict[ast.ClassDef, None] = {}
        if base := self.base(node):
            found |= self.in_order(base)
        for item in node.body:
            if isinstance(item, ast.AnnAssign):
                kind = self.package.kind(self.package.homes[node], item.annotation)
                if isinstance(kind, ast.ClassDef):
                    self.classes.add(kind)
                    found |= self.in_order(kind) if kind not in self.package.enumerations else {}
        return found | {node: None}

    def struct(self, node: ast.ClassDef) -> str:
        file, base = self.package.homes[node], self.base(node)
        running = {f.name: f for f in fields(self.running(file, node.name))}
        rows = [f"    {self.class_name(base)} base;"] if base else []
        for item in node.body:
            if isinstance(item, ast.AnnAssign) and self.defining(node, target(item), ast.AnnAssign)[1] is node:
                f, kind = running[target(item)], self.package.kind(file, item.annotation)
                length = f"[{len(f.default_factory())}]" if kind == "list" else ""  # type: ignore
                declared = f.metadata.get("declaration")
                said = [f"{declared.causality}: {declared.description}"] if declared else []
                rows.append(said_at_end(f"    {self.type_of(kind)} {member_name(f.name)}{length};", said))
        tag = "struct Block" if node is self.main else "struct"
        return "\n".join([docstring(node), f"typedef {tag} {{", *rows, f"}} {self.class_name(node)};\n"])

    def start(self, owner: Any = None, cls: type | None = None, indent: str = "    ") -> str:
        """The start values as an initialiser; what is 0 or false is left out."""
        owner, cls = owner or self.block, cls or type(self.block)
        base = next((b for b in cls.__bases__ if is_dataclass(b)), None)
        above = {f.name for f in fields(base)} if base else set()
        parts: list[tuple[str, Any, Any]] = [("base", owner, base)] if base else []
        parts += [(f.name, getattr(owner, f.name), None) for f in fields(cls) if f.name not in above]
        rows = []
        for name, value, as_base in parts:
            if is_dataclass(value):
                if (inner := self.start(value, as_base or type(value), indent + "    ")) != "{0}":
                    rows.append(f"{indent}.{'base' if as_base else member_name(name)} = {inner},\n")
            elif isinstance(value, list):
                assert not any(value), "a list begins with zeros"
            elif value or str(value) == "-0.0":
                rows.append(f"{indent}.{member_name(name)} = {literal(value)},\n")
        return f"{{\n{''.join(rows)}{indent[4:]}}}" if rows else "{0}"

    def place(self, name: str) -> str:
        """The member designator of a variable, for offsetof."""
        node, found = self.main, []
        for part in name.split("."):
            up, node, item = self.defining(node, part, ast.AnnAssign)
            found += ["base"] * up + [member_name(part)]
            kind = self.package.kind(self.package.homes[node], item.annotation)
            node = kind if isinstance(kind, ast.ClassDef) else node
        return ".".join(found)


class Translator(Body):
    """One function. The checker has its kinds; `emit` writes it."""

    def __init__(self, program: Program, function: Function) -> None:
        super().__init__(program.package, function.file, [])
        self.program, self.function = program, function
        self.check(function.node, function.owner)
        assert not self.violations, self.violations
        self.bound = None
        self.known: dict[ast.expr, Kind] = {}
        self.touches: dict[ast.AST, tuple[Effect, list[Function]]] = {}
        self.copied: dict[ast.AST, Effect] = {}
        self.said = program.comments[function.file]
        names = [n for n in ast.walk(function.node) if isinstance(n, ast.Name)]
        self.stored = [n.id for n in names if isinstance(n.ctx, ast.Store)]
        self.used = {n.id for n in names}

    def c_name(self, name: str) -> str:
        """Of a local; one that would hide a name of the file gets an underscore."""
        return f"{name}_" if name in RESERVED or name in self.program.global_names else name

    def kind(self, node: ast.expr) -> Kind:
        if node not in self.known:
            self.known[node] = self.visit(node)
        return self.known[node]

    def plain(self, kind: Kind) -> str | None:
        return kind if isinstance(kind, str) else None

    def stop(self, node: ast.AST, why: str) -> UnsupportedError:
        return UnsupportedError(f"{self.file}:{getattr(node, 'lineno', 0)}: {why}: {ast.unparse(node)}")

    # --- calls and effects ---

    def callee(self, call: ast.AST) -> Function | None:
        meaning = self.meaning(call.func) if isinstance(call, ast.Call) else None
        if isinstance(meaning, ast.FunctionDef):
            return self.program.function(self.package.homes[meaning], meaning)
        if meaning is None and isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute):
            owner = self.kind(call.func.value)
            if isinstance(owner, ast.ClassDef):
                return self.program.function(*self.program.method(owner, call.func.attr))
        return None

    def arguments(self, call: ast.Call, callee: Function) -> list[tuple[str, ast.expr]]:
        own = [call.func.value] if callee.owner else []  # type: ignore[attr-defined]
        return list(zip(callee.parameters, own + call.args, strict=True))

    def touched(self, node: ast.AST) -> tuple[Effect, Effect]:
        """The fields that stand in an expression, with those that its calls read; and those that its calls write."""
        if node not in self.touches:
            own: Effect = set()
            for n in ast.walk(node):
                if isinstance(n, ast.Subscript):
                    own.add(ANY_LIST)
                elif isinstance(n, ast.Attribute) and self.meaning(n) is None:
                    owner = self.kind(n.value)
                    if isinstance(owner, ast.ClassDef) and self.package.member(owner, n.attr, ast.AnnAssign):
                        own.add((self.program.defining(owner, n.attr, ast.AnnAssign)[1].name, n.attr))
            copies = [n for n in ast.walk(node) if isinstance(n, ast.Call) and self.meaning(n.func) == COPY]
            self.copied[node] = set().union(*(self.program.inside(self.kind(n.args[0])) for n in copies))
            self.touches[node] = own, [callee for n in ast.walk(node) if (callee := self.callee(n))]
        own, callees = self.touches[node]
        copied = self.copied[node]
        return own.union(copied, *(c.reads for c in callees)), copied.union(*(c.writes for c in callees))

    def stores(self, node: ast.AST) -> Iterator[ast.expr]:
        """What is assigned to, but for locals."""
        for n in ast.walk(node):
            targets = n.targets if isinstance(n, ast.Assign) else [n.target] if isinstance(n, ast.AugAssign) else []
            yield from (t for t in targets if isinstance(t, ast.Attribute | ast.Subscript))

    def effects(self) -> None:
        f = self.function
        reads, writes = self.touched(f.node)
        f.reads |= reads
        f.writes |= writes
        for place in self.stores(f.node):
            f.writes |= {ANY_LIST} if isinstance(place, ast.Subscript) else self.touched(place)[0]
            f.written |= self.roots(place)
        for n in ast.walk(f.node):
            if isinstance(n, ast.Call) and self.meaning(n.func) == COPY:
                f.written |= self.roots(n.args[0])
            f.fails |= self.program.checked and self.may_raise(n)
            if isinstance(n, ast.Call) and (callee := self.callee(n)):
                f.fails |= callee.fails
                for name, given in self.arguments(n, callee):
                    f.written |= self.roots(given) if name in callee.written else set()
                    if self.kind(given) == "list":
                        length = self.program.lengths.setdefault((callee, name), self.length(given))
                        if length != self.length(given):
                            raise self.stop(n, "lists of one length only")

    def roots(self, node: ast.expr) -> set[str]:
        """The parameter through which a place is reached, and the local that stands for a part of it."""
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        assert isinstance(node, ast.Name)
        assigned = [n for n in ast.walk(self.function.node) if isinstance(n, ast.Assign) and target(n) == node.id]
        return {node.id}.union(*(self.roots(n.value) for n in assigned if node.id not in self.function.parameters))

    def may_raise(self, node: ast.AST) -> bool:
        match node:
            case ast.BinOp(left=left, op=op, right=right) | ast.AugAssign(target=left, op=op, value=right):
                whole = "float" not in (self.kind(left), self.kind(right)) and not isinstance(op, ast.Div)
                return isinstance(op, ast.Div | ast.FloorDiv | ast.Mod) and (not self.number(right) or whole)
            case ast.Subscript(value=values, slice=index) if self.kind(values) == "list":
                at = self.number(index)
                return not (isinstance(at, int) and 0 <= at < self.length(values))
            case ast.Call(func=ast.Name(id="int" | "round" | "floor"), args=[value]) if not self.callee(node):
                return self.kind(value) == "float"
        return False

    def number(self, node: ast.expr) -> Any:
        """The value of a constant, else None."""
        meaning = self.meaning(node)
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(meaning, ast.Assign | ast.AnnAssign):
            return self.program.running(self.package.homes[meaning], target(meaning))
        return None

    def length(self, node: ast.expr) -> int:
        """Of a list."""
        if isinstance(node, ast.Name):
            named = [
                n.value for n in ast.walk(self.function.node) if isinstance(n, ast.Assign) and target(n) == node.id
            ]
            return self.length(named[0]) if named else self.program.lengths.get((self.function, node.id), 0)
        _, owner, _ = self.program.defining(self.kind(node.value), node.attr, ast.AnnAssign)  # type: ignore
        cls = self.program.running(self.package.homes[owner], owner.name)
        return len(next(f for f in fields(cls) if f.name == node.attr).default_factory())  # type: ignore

    def check_order(self) -> None:
        """C leaves open which operand or argument comes first: refused where that might matter."""
        for n in ast.walk(self.function.node):
            match n:
                case ast.BinOp(left=a, right=b):
                    parts = [a, b]
                case ast.Compare(left=a, comparators=rest):
                    parts = [a, *rest]
                case ast.Call(args=parts):
                    pass
                case ast.Assign(targets=[ast.Subscript(slice=a)], value=b) | ast.AugAssign(target=a, value=b):
                    parts = [a, b]
                case _:
                    continue
            effects = [self.touched(part) for part in parts]
            for i, (_, writes) in enumerate(effects):
                if any(writes & (r | w) for k, (r, w) in enumerate(effects) if k != i):
                    raise self.stop(n, "the order of evaluation matters: write two statements")

    # --- expressions: text, and how tight it binds ---

    def code(self, node: ast.expr, least: int = 0, kind: "Kind | None" = None) -> str:
        """In parentheses unless it binds at least as tight; converted to a number's kind, if one is given."""
        if kind == "float" and (whole := self.whole_number(node)):
            text, binds = whole
            return text if binds >= least else f"({text})"
        text, binds = self.expression(node)
        if kind == "float" and self.kind(node) != "float" and isinstance(node, ast.Constant):
            text = repr(float(node.value))  # type: ignore[arg-type]
        elif (kind == "float" and self.kind(node) != "float") or (kind == "int" and self.kind(node) == "bool"):
            text, binds = f"({TYPES[kind]}){text if binds >= UNARY else f'({text})'}", UNARY
        return text if binds >= least else f"({text})"

    def whole_number(self, node: ast.expr) -> Code | None:
        """What floor and round give, where it becomes a float at once: of any size, as in Python."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand) if whole := self.whole_number(operand):
                return f"0.0 - {whole[0]}", SUM  # no -0.0 either
            case ast.Call(func=ast.Name() as name, args=[value]) if self.kind(value) == "float":
                if (isinstance(meaning := self.meaning(name), str) and meaning == "math.floor") or (
                    name.id == "round" and meaning is None
                ):
                    return self.helper(f"py_{name.id}", self.code(value))
        return None

    def condition_code(self, node: ast.expr, least: int = 0) -> str:
        if self.kind(node) == "bool":
            return self.code(node, least)
        text = f"{self.code(node, EQUALITY + 1)} != {'0.0' if self.kind(node) == 'float' else '0'}"
        return text if least <= EQUALITY else f"({text})"

    def helper(self, name: str, *arguments: str) -> Code:
        self.program.helpers.add(name)
        end = ["failed"] if name in FAILING and self.program.checked else []
        return f"{name}({', '.join([*arguments, *end])})", PRIMARY

    def expression(self, node: ast.expr) -> Code:
        match node:
            case ast.Constant(value=value):
                return literal(value), PRIMARY
            case ast.Name() | ast.Attribute():
                return self.named_text(node), PRIMARY
            case ast.Subscript(value=values, slice=index):
                at = self.code(index)
                if self.may_raise(node) and self.program.checked:
                    at, _ = self.helper("py_at", at, str(self.length(values)))
                return f"{self.code(values)}[{at}]", PRIMARY
            case ast.Call():
                return self.call(node)
            case ast.BinOp(left=left, op=op, right=right):
                return self.operation(op, self.kind(node), left, right, node)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return f"!{self.condition_code(operand, UNARY)}", UNARY
            case ast.UnaryOp(op=op, operand=operand):
                sign, text = "-" if isinstance(op, ast.USub) else "+", self.code(operand, UNARY, self.kind(node))
                return f"{sign}({text})" if text.startswith(sign) else f"{sign}{text}", UNARY
            case ast.BoolOp(op=op, values=values):
                if any(self.kind(v) != "bool" for v in values):
                    raise self.stop(node, "and, or of Booleans only")
                sign, binds = (" && ", AND) if isinstance(op, ast.And) else (" || ", OR)
                return sign.join(self.code(v, AND + 1) for v in values), binds
            case ast.IfExp(test=test, body=body, orelse=orelse):
                kind = self.plain(self.kind(node))
                chosen = f"{self.condition_code(test, CHOICE + 1)} ? {self.code(body, CHOICE + 1, kind)}"
                return f"{chosen} : {self.code(orelse, CHOICE, kind)}", CHOICE
            case ast.Compare():
                return self.comparison(node)
        raise self.stop(node, "not translated")

    def named_text(self, node: ast.Name | ast.Attribute) -> str:
        meaning = self.meaning(node)
        if isinstance(meaning, ast.Assign | ast.AnnAssign):
            return self.program.constant(meaning)
        if isinstance(meaning, str):
            return literal(getattr(math, meaning.removeprefix("math.")))
        if isinstance(node, ast.Name):
            return self.c_name(node.id)
        owner = self.meaning(node.value)
        if isinstance(owner, ast.ClassDef) and self.is_enumeration(owner):
            return f"{self.program.type_of(owner)}_{node.attr}"
        up, _, _ = self.program.defining(self.kind(node.value), node.attr, ast.AnnAssign)  # type: ignore[arg-type]
        return f"{self.member(node.value)}{'base.' * up}{member_name(node.attr)}"

    def member(self, node: ast.expr) -> str:
        """An object, up to its member: names are pointers, parts are in place."""
        return f"{self.code(node)}{'->' if isinstance(node, ast.Name) else '.'}"

    def pointer(self, node: ast.expr, wanted: Kind) -> str:
        """To an object as one of the class `wanted`, its own or one that it derives from; to a list's first element."""
        kind, up = self.kind(node), 0
        while kind != wanted:
            kind, up = self.program.base(kind), up + 1  # type: ignore
        if up:
            return f"&{self.member(node)}{'.'.join(['base'] * up)}"
        return self.code(node) if isinstance(node, ast.Name) or kind == "list" else f"&{self.code(node)}"

    def operation(self, op: ast.operator, kind: Kind, left: ast.expr, right: ast.expr, node: ast.AST) -> Code:
        checked = self.may_raise(node) and self.program.checked
        if type(op) in ARITHMETIC and not (isinstance(op, ast.Div) and checked):
            sign, binds = ARITHMETIC[type(op)]
            return f"{self.code(left, binds, kind)} {sign} {self.code(right, binds + 1, kind)}", binds
        parts = self.code(left, 0, kind), self.code(right, 0, kind)
        if isinstance(op, ast.Div):
            return self.helper("py_divided", *parts)
        if kind == "int":
            return self.helper("py_floordiv_int" if isinstance(op, ast.FloorDiv) else "py_mod_int", *parts)
        if isinstance(op, ast.Mod):
            return self.helper("py_mod", *parts)
        raise self.stop(node, "no // of floats")

    def comparison(self, node: ast.Compare) -> Code:
        operands, parts, binds = [node.left, *node.comparators], [], EQUALITY
        if any(self.touched(middle)[1] for middle in operands[1:-1]):
            raise self.stop(node, "what stands in the middle of a chain is evaluated twice: it changes nothing")
        for left, op, right in zip(operands, node.ops, operands[1:], strict=False):
            if isinstance(op, ast.In | ast.NotIn):
                sign, binds, between = ("==", OR, " || ") if isinstance(op, ast.In) else ("!=", AND, " && ")
                text = between.join(self.relation(left, sign, member) for member in right.elts)  # type: ignore
                parts.append(f"({text})" if binds == OR and len(operands) > 2 else text)
            else:
                parts.append(self.relation(left, COMPARISON[type(op)], right))
        return " && ".join(parts), AND if len(parts) > 1 else binds

    def relation(self, left: ast.expr, sign: str, right: ast.expr) -> str:
        kind = "float" if "float" in (self.kind(left), self.kind(right)) else None
        return f"{self.code(left, RELATION + 1, kind)} {sign} {self.code(right, RELATION + 1, kind)}"

    def call(self, node: ast.Call) -> Code:
        if callee := self.callee(node):
            given = []
            for name, argument in self.arguments(node, callee):
                wanted = callee.body.kinds[name]
                whole = self.is_object(wanted)
                given.append(self.pointer(argument, wanted) if whole else self.code(argument, 0, self.plain(wanted)))
            return f"{callee.name}({', '.join([*given, *(['failed'] if callee.fails else [])])})", PRIMARY
        kind, first, meaning = self.kind(node), node.args[0], self.meaning(node.func)
        if meaning == COPY:
            star = ["*" if isinstance(part, ast.Name) else "" for part in node.args]
            into, source = (f"{s}{self.code(part)}" for s, part in zip(star, node.args, strict=True))
            return f"{into} = {source}", 0
        match meaning.removeprefix("math.") if isinstance(meaning, str) else ast.unparse(node.func):
            case "min" | "max" as name:
                text = self.code(first, 0, kind)
                for other in node.args[1:]:
                    end = "" if kind == "float" else "_int"
                    text, _ = self.helper(f"py_{name}{end}", text, self.code(other, 0, kind))
                return text, PRIMARY
            case "abs" if kind == "int":
                return self.helper("py_abs_int", self.code(first))
            case "int" | "round" | "floor" as name if self.kind(first) == "float":
                whole = self.whole_number(node)
                return self.helper("py_int", whole[0] if whole else self.code(first))
            case "int" | "round" | "float":
                return self.code(first, UNARY, kind), UNARY
            case "len":
                return str(self.length(first)), PRIMARY
            case "isfinite":
                return self.helper("py_isfinite", self.code(first, 0, "float"))
            case "sqrt" | "fmod" | "abs" as name:
                arguments = ", ".join(self.code(argument, 0, "float") for argument in node.args)
                return f"{'fabs' if name == 'abs' else name}({arguments})", PRIMARY
        raise self.stop(node, "not translated")

    # --- statements ---

    def signature(self) -> str:
        f = self.function
        found: list[str] = []
        for name in f.parameters:
            whole = self.is_object(self.kinds[name])
            before = "const " if whole and name not in f.written else ""
            found.append(f"{before}{self.program.type_of(self.kinds[name])} {'*' * whole}{self.c_name(name)}")
        found += ["bool *failed"] if f.fails else []
        returns = self.program.type_of(self.package.kind(self.file, f.node.returns))
        return f"static {returns} {f.name}({', '.join(found) or 'void'})"

    def emit(self) -> list[str]:
        node = self.function.node
        self.lines: list[str] = []
        self.indent, self.unpacked = 0, 0
        self.declare_where()
        self.remarks(node.lineno)
        self.lines += [docstring(node)] if docstring(node) else []
        self.put(f"{self.signature()} {{", node.lineno, node.body[0].lineno - 1)
        self.indent += 1
        for name in self.function.parameters:
            if name not in self.used:
                self.put(f"(void){self.c_name(name)};")
        self.statements(without_docstring(node.body), ())
        self.indent -= 1
        self.put("}")
        return self.lines

    def put(self, text: str, first: int = 0, last: int = -1) -> None:
        """A line of text, with what the source says at the end of those lines."""
        said = [self.said[n][1] for n in range(first, last + 1) if n in self.said and not self.said[n][0]]
        for line in said_at_end("    " * self.indent + text, said).splitlines():
            self.lines += fold(line)

    def remarks(self, line: int) -> None:
        """The comments that stand on lines of their own before a statement; a section's heading has a blank line."""
        text = self.program.texts[self.file].splitlines()
        at = line - 2 if line > 2 and not text[line - 2].strip() else line - 1
        found = []
        while at in self.said and self.said[at][0]:
            found.insert(0, f"{'    ' * self.indent}/* {self.said[at][1]} */")
            at -= 1
        self.lines += found

    def declare_where(self) -> None:
        """Each local is declared in the innermost block that holds all of its uses, before the first of them."""
        places: dict[str, list[tuple[Any, ...]]] = {}
        loops = {n.target.id for n in ast.walk(self.function.node) if isinstance(n, ast.For)}  # type: ignore
        own = set(self.stored) - set(self.function.parameters) - loops - {"_"}

        def scan(block: list[ast.stmt], path: tuple[Any, ...]) -> None:
            for i, s in enumerate(block):
                here, inner = (*path, i), []
                for name, value in ast.iter_fields(s):
                    if name in ("body", "orelse") and not isinstance(value, ast.expr):
                        inner.append((value, (*here, name)))
                    elif name == "cases":
                        inner += [(case.body, (*here, k)) for k, case in enumerate(value)]
                nested = {id(n) for body, _ in inner for s in body for n in ast.walk(s)}
                for n in ast.walk(s):
                    if isinstance(n, ast.Name) and n.id in own and id(n) not in nested:
                        places.setdefault(n.id, []).append(here)
                for body, there in inner:
                    scan(body, there)

        scan(without_docstring(self.function.node.body), ())
        self.declarations: dict[tuple[Any, ...], list[str]] = {}
        for name, found in places.items():
            common = min(found, key=len)
            common = common[: next((n for n in range(len(common)) if len({f[n] for f in found}) > 1), len(common))]
            block = common[:-1] if len(common) % 2 else common
            self.declarations.setdefault((*block, min(f[len(block)] for f in found)), []).append(name)

    def statements(self, block: list[ast.stmt], path: tuple[Any, ...]) -> None:
        for i, s in enumerate(block):
            self.remarks(s.lineno)
            self.statement(s, (*path, i))

    def inner(self, body: list[ast.stmt], path: tuple[Any, ...]) -> None:
        self.indent += 1
        self.statements(body, path)
        self.indent -= 1

    def declare(self, names: list[str]) -> None:
        for kind in dict.fromkeys(self.program.type_of(self.kinds[n]) for n in names):
            same = [self.c_name(n) for n in names if self.program.type_of(self.kinds[n]) == kind]
            self.put(f"{kind} {', '.join(same)};")

    def statement(self, s: ast.stmt, here: tuple[Any, ...]) -> None:
        new, lines = self.declarations.get(here, []), (s.lineno, s.end_lineno or 0)
        head = (s.lineno, s.body[0].lineno - 1) if isinstance(s, ast.While | ast.For | ast.If) else (0, -1)
        match s:
            case ast.Assign(targets=[ast.Tuple(elts=parts)], value=ast.Call() as call):
                self.unpack(call, parts, new, lines)  # type: ignore[arg-type]
                return
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if new == [name] and not mentions(value, name):
                self.begin(name, value, lines)
                return
        self.declare(new)
        match s:
            case ast.Assign(targets=[*_, _] as targets, value=value):
                for place in targets:
                    self.put(f"{self.code(place)} = {self.code(value, 0, self.plain(self.kind(place)))};", *lines)
            case ast.AnnAssign(target=place, value=ast.expr() as value):
                self.put(f"{self.code(place)} = {self.code(value, 0, self.plain(self.kind(place)))};", *lines)
            case ast.AugAssign(target=place, op=op, value=value):
                kind = self.kind(place)
                if type(op) in ARITHMETIC and not self.may_raise(s):
                    self.put(f"{self.code(place)} {ARITHMETIC[type(op)][0]}= {self.code(value, 0, kind)};", *lines)
                else:
                    self.put(f"{self.code(place)} = {self.operation(op, kind, place, value, s)[0]};", *lines)
            case ast.Expr(value=ast.Call() as call):
                self.put(f"{self.call(call)[0]};", *lines)
            case ast.Return():
                self.put(self.returned(s.value), *lines)
            case ast.Break() | ast.Continue():
                self.put("break;" if isinstance(s, ast.Break) else "continue;", *lines)
            case ast.Pass():
                pass
            case ast.If():
                self.choice(s, here, "if", head)
            case ast.While(test=test, body=body):
                guard = self.guard(s)
                self.put(f"while ({guard}{self.condition_code(test, AND if guard else 0)}) {{", *head)
                self.inner(body, (*here, "body"))
                self.put("}")
            case ast.For():
                self.count(s, here, head)
            case ast.Match():
                self.match(s, here)
            case _:
                raise self.stop(s, "not translated")

    def guard(self, loop: ast.stmt) -> str:
        """What ends a loop where Python would raise: it might go on for ever."""
        risky = any(self.may_raise(n) or ((c := self.callee(n)) and c.fails) for n in ast.walk(loop))
        return "!*failed && " if risky and self.program.checked else ""

    def begin(self, name: str, value: ast.expr, lines: tuple[int, int]) -> None:
        """A local with its first value."""
        kind = self.kinds[name]
        before, text = "const " if self.stored.count(name) == 1 else "", self.c_name(name)
        if self.is_object(kind):
            before, text = "" if name in self.function.written else "const ", f"*{text}"
        first = self.pointer(value, kind) if self.is_object(kind) else self.code(value, 0, self.plain(kind))
        self.put(f"{before}{self.program.type_of(kind)} {text} = {first};", *lines)

    def unpack(self, call: ast.Call, parts: list[ast.Name], new: list[str], lines: tuple[int, int]) -> None:
        kinds, callee = self.kind(call), self.callee(call)
        assert isinstance(kinds, tuple)
        assert callee
        self.unpacked += 1
        found = f"{callee.node.name}_{self.unpacked}"
        self.put(f"const {self.program.type_of(kinds)} {found} = {self.call(call)[0]};", *lines)
        for i, (part, kind) in enumerate(zip(parts, kinds, strict=True)):
            if part.id != "_":
                own = self.kinds[part.id]
                cast = "(double)" if own == "float" and kind != "float" else ""
                before = "const " if self.stored.count(part.id) == 1 else ""
                begin = f"{before}{self.program.type_of(own)} " if part.id in new else ""
                self.put(f"{begin}{self.c_name(part.id)} = {cast}{found}.v{i};")

    def returned(self, value: ast.expr | None) -> str:
        kinds = self.package.kind(self.file, self.function.node.returns)
        if isinstance(value, ast.Tuple) and isinstance(kinds, tuple):
            parts = [self.code(e, 0, self.plain(k)) for e, k in zip(value.elts, kinds, strict=True)]
            return f"return ({self.program.type_of(kinds)}){{{', '.join(parts)}}};"
        return f"return {self.code(value, 0, self.plain(kinds))};" if value else "return;"

    def choice(self, s: ast.If, here: tuple[Any, ...], word: str, head: tuple[int, int]) -> None:
        self.put(f"{word} ({self.condition_code(s.test)}) {{", *head)
        self.inner(s.body, (*here, "body"))
        match s.orelse:
            case [ast.If() as other] if (*here, "orelse", 0) not in self.declarations:
                self.choice(other, (*here, "orelse", 0), "} else if", (other.lineno, other.body[0].lineno - 1))
                return
            case [_, *_]:
                self.put("} else {")
                self.inner(s.orelse, (*here, "orelse"))
        self.put("}")

    def count(self, s: ast.For, here: tuple[Any, ...], head: tuple[int, int]) -> None:
        limits, name = s.iter.args, s.target.id  # type: ignore[attr-defined]
        first, end = limits[:2] if len(limits) > 1 else (ast.Constant(0), limits[0])
        step = ast.literal_eval(limits[2]) if len(limits) > 2 else 1
        name = "count" if name == "_" else self.c_name(name)
        sign, on = "<" if step > 0 else ">", {1: "++", -1: "--"}.get(step, f" += {step}")
        begin, limit = f"int64_t {name} = {self.code(first)}", self.code(end, RELATION + 1)
        if not self.stable(end, s.body):
            begin, limit = f"{begin}, {name}_end = {self.code(end)}", f"{name}_end"
        self.put(f"for ({begin}; {self.guard(s)}{name} {sign} {limit}; {name}{on}) {{", *head)
        self.inner(s.body, (*here, "body"))
        self.put("}")

    def stable(self, limit: ast.expr, body: list[ast.stmt]) -> bool:
        """Whether the body leaves the limit as it is: range takes it once."""
        if any(isinstance(n, ast.Call) or self.may_raise(n) for n in ast.walk(limit)):
            return False
        stored = {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        places = [place for s in body for place in self.stores(s)]
        writes = set().union(*(self.touched(s)[1] for s in body), *(self.touched(place)[0] for place in places))
        return not (writes & self.touched(limit)[0] or any(mentions(limit, name) for name in stored))

    def match(self, s: ast.Match, here: tuple[Any, ...]) -> None:
        """A switch; where a guard stands, or a break that in C would end the switch, a chain of ifs."""
        if any(c.guard or leaves_loop(c.body) for c in s.cases):
            if any(isinstance(n, ast.Call) for n in ast.walk(s.subject)):
                raise self.stop(s, "a call is matched where there is a guard, or a break of a loop around")
            word = "if"
            for k, case in enumerate(s.cases):
                tests = [self.relation(s.subject, "==", value) for value in values_of(case.pattern)]
                text = " || ".join(tests)
                guard = [self.condition_code(case.guard, AND)] if case.guard else []
                text = " && ".join([f"({text})" if len(tests) > 1 and guard else text, *guard] if text else guard)
                self.put(f"{word} ({text}) {{" if text else "} else {")
                self.inner(case.body, (*here, k))
                word = "} else if"
            self.put("}")
            return
        self.put(f"switch ({self.code(s.subject)}) {{", s.lineno, s.lineno)
        for k, case in enumerate(s.cases):
            labels = [f"case {self.code(value)}:" for value in values_of(case.pattern)] or ["default:"]
            declares = any(isinstance(b, ast.Assign) and isinstance(b.targets[0], ast.Tuple) for b in case.body)
            block = declares or any(place[:-1] == (*here, k) for place in self.declarations)
            for label in labels[:-1]:
                self.put(label)
            self.put(f"{labels[-1]}{' {' if block else ''}")
            self.inner(case.body, (*here, k))
            if not isinstance(case.body[-1], ast.Return | ast.Continue):
                self.put("    break;")
            if block:
                self.put("}")
        self.put("}")


def target(node: ast.AST | None) -> str:
    """The one name that a statement assigns to."""
    match node:
        case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
            return name
    return ""


def mentions(node: ast.AST, name: str) -> bool:
    return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(node))


def values_of(pattern: ast.pattern) -> list[ast.expr]:
    """None of the wildcard."""
    if isinstance(pattern, ast.MatchOr):
        return [value for part in pattern.patterns for value in values_of(part)]
    return [pattern.value] if isinstance(pattern, ast.MatchValue) else []


def leaves_loop(body: list[ast.stmt]) -> bool:
    """Whether there is a break of a loop around it."""
    inner = [part for s in body if isinstance(s, ast.If) for part in (s.body, s.orelse)]
    inner += [case.body for s in body if isinstance(s, ast.Match) for case in s.cases]
    return any(isinstance(s, ast.Break) for s in body) or any(map(leaves_loop, inner))


def member_name(name: str) -> str:
    """Of a field; `base` is what a derived struct holds of its base."""
    return f"{name}_" if name in RESERVED or name == "base" else name


def literal(value: Any) -> str:
    if isinstance(value, bool | int):
        return str(value).lower() if isinstance(value, bool) else str(int(value))
    return f"{'-' if value < 0 else ''}INFINITY" if math.isinf(value) else repr(float(value))


def comments(text: str) -> Iterator[tuple[int, tuple[bool, str]]]:
    """By line: whether a comment has it for itself, and its words."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith(("# noqa", "# type:")):
            yield token.start[0], (not token.line[: token.start[1]].strip(), token.string[1:].strip())


def commented(text: str) -> str:
    return f"/* {text.replace('/*', '/ *').replace('*/', '* /')} */"


def docstring(node: ast.Module | ast.ClassDef | ast.FunctionDef) -> str:
    lines = (ast.get_docstring(node) or "").splitlines()
    return commented("\n".join([*lines[:1], *(f" * {line}".rstrip() for line in lines[1:])])) if lines else ""


def said_at_end(line: str, said: list[str]) -> str:
    """A line with a comment at its end, or before it where that is too long."""
    if not said:
        return line
    end = commented("; ".join(said))
    space = line[: len(line) - len(line.lstrip())]
    above = textwrap.fill(end, WIDTH, initial_indent=space, subsequent_indent=f"{space} * ")
    return f"{line} {end}" if len(f"{line} {end}") <= WIDTH else f"{above}\n{line}"


def fold(line: str, more: int = 4) -> list[str]:
    """A long line in several, broken where the fewest parentheses are open."""
    if len(line) <= WIDTH or line.lstrip().startswith("/*"):
        return [line]
    indent, depth, best = len(line) - len(line.lstrip()), 0, (99, 0, 0)
    for i, character in enumerate(line[: WIDTH + 1]):
        depth += (character in "([{") - (character in ")]}")
        loose = BREAKS.get("," if line[i - 1] == "," else line[i + 1 : i + 3].strip()) if character == " " else None
        if loose is not None and i > indent + 8 and (depth, loose) <= best[:2]:
            best = depth, loose, i
    at = best[2]
    return [line[:at], *fold(" " * (indent + more) + line[at + 1 :], 0)] if at else [line]
