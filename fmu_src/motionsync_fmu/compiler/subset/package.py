"""The modules of the model, with the meaning of each name in them.

Beside a module may be a header of C with its name, which has its functions by hand: of the module itself only their
signatures count."""

import ast
import math
import operator
from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field
from functools import cache
from pathlib import PurePosixPath
from typing import TypeAlias

EXEMPT = ("__init__.py", "blocks.py", "var.py")  # public names, registry, declarations: they are never compiled
MATH_CONSTANTS = ("math.e", "math.inf", "math.nan", "math.pi", "math.tau")
MODEL = "motionsync"  # the package with the declarations; a block may be in another one
ENUMERATIONS = ("var.Enumeration",)  # what enumerations derive from
SERIES = {"var.Reals": "reals", "var.Wholes": "wholes"}  # kinds of numbers that are given from outside

# The kind of a value: "float", "int", "bool", "list", "reals", "wholes", the class of an enumeration member or object,
# the kinds in a returned tuple, or "?" (unknown: its expression has violated a rule).
Kind: TypeAlias = "str | ast.ClassDef | tuple[Kind, ...]"
Meaning: TypeAlias = ast.stmt | str | None  # of a module-level name: its statement, or such as "math.sqrt"
Number: TypeAlias = float | int | bool

ARITHMETIC: dict[type[ast.operator], Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}


@dataclass(eq=False)
class CheckedFunction:
    """A function or method with what the checker has determined of it.

    Attributes:
        locals: the kind of each local, parameters included.
        kinds: the kind of each expression's value.
        walks: the nodes in each node that was walked.
    """

    package: "Package"
    file: str
    node: ast.FunctionDef
    owner: ast.ClassDef | None
    locals: "dict[str, Kind]" = field(default_factory=dict)
    kinds: "dict[ast.expr, Kind]" = field(default_factory=dict)
    walks: dict[ast.AST, list[ast.AST]] = field(default_factory=dict)

    def walk(self, node: ast.AST) -> list[ast.AST]:
        """A node and all nodes in it, in the order of `ast.walk`, which is determined once."""
        if node not in self.walks:
            self.walks[node] = nodes = [node]
            for inner in nodes:  # it grows meanwhile
                nodes += child_nodes(inner)
        return self.walks[node]

    def stored_names(self, node: ast.AST) -> list[str]:
        """The locals that a node assigns to, one for each assignment."""
        return [n.id for n in self.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]

    def range_of(self, loop: ast.For) -> tuple[ast.expr, ast.expr, int]:
        """Start, end and step of the range that a loop runs over; the step is 0 if it is no whole constant."""
        assert isinstance(loop.iter, ast.Call)
        limits = loop.iter.args
        first, end = limits[:2] if len(limits) > 1 else (ast.Constant(0), limits[0])
        step = self.package.constant_value(self.file, limits[2]) if len(limits) > 2 else 1
        return first, end, step if isinstance(step, int) else 0

    @property
    def parameters(self) -> list[str]:
        return [argument.arg for argument in self.node.args.args]

    def meaning(self, node: ast.expr | None) -> Meaning:
        """The meaning of a name that is not a local's."""
        root = node.value if isinstance(node, ast.Attribute) else node
        return None if isinstance(root, ast.Name) and root.id in self.locals else self.package.meaning(self.file, node)

    def callee(self, node: ast.AST) -> "CheckedFunction | None":
        """The function or method of the package that a call calls; None for any other call or node."""
        if not isinstance(node, ast.Call):
            return None
        meaning = self.meaning(node.func)
        if meaning is None and isinstance(node.func, ast.Attribute):
            owner = self.kinds[node.func.value]
            assert isinstance(owner, ast.ClassDef)
            meaning = self.package.find_method(owner, node.func.attr)
        return self.package.functions[meaning] if isinstance(meaning, ast.FunctionDef) else None

    def arguments(self, call: ast.Call, callee: "CheckedFunction") -> list[tuple[str, ast.expr]]:
        """The parameters of the called function with their arguments; a method's object comes first."""
        own = [call.func.value] if callee.owner and isinstance(call.func, ast.Attribute) else []
        return list(zip(callee.parameters, own + call.args, strict=True))

    def constant_value(self, node: ast.expr) -> Number | None:
        """The value of a constant; None for anything else."""
        if isinstance(node, ast.Constant) or isinstance(self.meaning(node), ast.Assign | ast.AnnAssign):
            return self.package.constant_value(self.file, node)
        return None


@cache
def parse_module(file: str, text: str) -> ast.Module:
    """The tree of a module, which is not to be changed: blocks share modules, and the translator reads it again."""
    return ast.parse(text, file)


def signatures(tree: ast.Module) -> ast.Module:
    """The functions of a module, each with its docstring alone."""
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    copies = {node: copy(node) for node in functions}
    for function in copies.values():
        function.body = function.body[:1]
    return ast.Module([*copies.values()], [])


@cache
def child_nodes(node: ast.AST) -> list[ast.AST]:
    """The nodes directly in a node."""
    return list(ast.iter_child_nodes(node))


class Package:
    """The modules of the model (path inside the package to text), with the meaning of each name in them."""

    def __init__(self, sources: Mapping[str, str]) -> None:
        self.headers = {file: text for file, text in sources.items() if file.endswith(".h")}
        modules = sorted((file, text) for file, text in sources.items() if file not in self.headers)
        self.trees = {file: parse_module(file, text) for file, text in modules}
        self.trees |= {file: signatures(tree) for file, tree in self.trees.items() if self.header(file)}
        self.names = {file: dict(self.module_names(tree)) for file, tree in self.trees.items()}
        self.meanings: dict[tuple[str, str], Meaning] = {}
        self.file_of = {node: file for file, tree in self.trees.items() for node in tree.body}
        classes = [(node, file) for node, file in self.file_of.items() if isinstance(node, ast.ClassDef)]
        self.constants: dict[ast.stmt, Kind] = {}  # kinds of the constants that have been visited
        self.layouts: dict[ast.ClassDef, dict[str, tuple[int, ast.ClassDef, ast.AnnAssign]]] = {}
        self.functions: dict[ast.FunctionDef, CheckedFunction] = {}
        self.enumerations = {
            node for node, file in classes if any(self.meaning(file, base) in ENUMERATIONS for base in node.bases)
        }

    def header(self, file: str) -> str:
        """The C of a module that is written by hand; empty: the module is translated."""
        return self.headers.get(str(PurePosixPath(file).with_suffix(".h")), "")

    @staticmethod
    def is_exempt(file: str) -> bool:
        return file in EXEMPT or PurePosixPath(file).name == "__init__.py"

    @staticmethod
    def import_path(file: str, node: ast.ImportFrom) -> PurePosixPath | None:
        """The module (without suffix) or folder of an import from the package, or from the model by its full name,
        as another package's block has it; None if it is outside both, or is that of the declarations."""
        path = (node.module or "").split(".")
        if not node.level and path[0] == MODEL and path[1:] not in ([], ["var"]):
            return PurePosixPath(*path[1:])
        parents = PurePosixPath(file).parents
        inside = 0 < node.level <= len(parents)
        return parents[node.level - 1].joinpath(*path) if inside else None

    @staticmethod
    def module_names(tree: ast.Module) -> Iterator[tuple[str, tuple[ast.stmt, str]]]:
        """Each module-level name with its statement and, since `import … as` may change it, its original name."""
        for node in tree.body:
            match node:
                case ast.Import() | ast.ImportFrom():
                    yield from ((alias.asname or alias.name, (node, alias.name)) for alias in node.names)
                case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                    yield name, (node, name)
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                    yield name, (node, name)

    def resolve(self, file: str, name: str) -> Meaning:
        """The meaning of a name in a module, through imports inside the package."""
        if (file, name) not in self.meanings:
            self.meanings[file, name] = self.resolve_import(file, name)
        return self.meanings[file, name]

    def resolve_import(self, file: str, name: str) -> Meaning:
        node, original = self.names.get(file, {}).get(name, (None, name))
        if isinstance(node, ast.Import):
            return original
        if not isinstance(node, ast.ImportFrom):
            return node
        origin = self.import_path(file, node)
        if origin is None:
            return f"{node.module}.{original}".removeprefix(f"{MODEL}.")
        if node.module is None:
            return str(origin / original)
        module = next((m for m in (f"{origin}.py", f"{origin}/__init__.py") if m in self.trees), "")
        meaning = self.resolve(module, original)
        if f"{origin}.py" in EXEMPT and not isinstance(meaning, ast.Assign | ast.AnnAssign):
            return f"{origin}.{original}"
        return meaning

    def meaning(self, file: str, node: ast.expr | None) -> Meaning:
        """The meaning of a name, or of a name of math or of the declarations (`math.sqrt`), in a module."""
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = self.resolve(file, node.value.id)
            return f"{owner}.{node.attr}" if isinstance(owner, str) else None
        return self.resolve(file, node.id) if isinstance(node, ast.Name) else None

    def kind(self, file: str, annotation: ast.expr | None) -> Kind:
        """The kind an annotation names; "?" if it is outside the subset."""
        match annotation:
            case ast.Constant(value=None):
                return "None"
            case ast.Constant(value=str(name)):  # a class inside its own body
                return self.kind(file, ast.Name(name))
            case ast.Name(id="float" | "int" | "bool" as name):
                return name
            case ast.Subscript(value=ast.Name(id="list"), slice=ast.Name(id="float")):
                return "list"
            case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=parts)):
                return tuple(self.kind(file, part) for part in parts)
        meaning = self.meaning(file, annotation)
        return meaning if isinstance(meaning, ast.ClassDef) else SERIES.get(str(meaning), "?")

    def is_enumeration(self, kind: Kind) -> bool:
        return kind in self.enumerations

    def is_object(self, kind: Kind) -> bool:
        """Whether values of a kind are lists, series, or objects of a dataclass."""
        is_list = kind == "list" or kind in SERIES.values()
        return is_list or (isinstance(kind, ast.ClassDef) and kind not in self.enumerations)

    def has_series(self, kind: Kind) -> bool:
        """Whether an object of a kind has numbers that are given from outside, in itself or in its parts."""
        if kind in SERIES.values():
            return True
        fields = self.all_fields(kind) if isinstance(kind, ast.ClassDef) and kind not in self.enumerations else {}
        return any(self.has_series(self.field_kind(kind, name) or "?") for name in fields)  # type: ignore[arg-type]

    def field_kind(self, owner: ast.ClassDef, name: str) -> "Kind | None":
        """The kind of a field, inherited ones included; None if there is none."""
        if name not in self.all_fields(owner):
            return None
        _, declaring, item = self.all_fields(owner)[name]
        return self.kind(self.file_of[declaring], item.annotation)

    def file_of_method(self, method: ast.FunctionDef) -> str:
        """The module of the class that has a method."""
        return next(
            file for node, file in self.file_of.items() if isinstance(node, ast.ClassDef) and method in node.body
        )

    def base_class(self, owner: ast.ClassDef) -> ast.ClassDef | None:
        """The kernel dataclass from which a class derives."""
        base = self.meaning(self.file_of[owner], owner.bases[0]) if owner.bases else None
        return base if isinstance(base, ast.ClassDef) and base != owner else None

    def is_derived(self, kind: Kind, base: Kind) -> bool:
        """Whether a kind is a class that derives from another one, directly or not."""
        above = self.base_class(kind) if isinstance(kind, ast.ClassDef) else None
        return above is not None and (above == base or self.is_derived(above, base))

    def own_fields(self, owner: ast.ClassDef) -> "dict[str, Kind]":
        """The kinds of the fields that a class adds to its base, without those that it only declares anew."""
        own = {name: item for name, (up, _, item) in self.all_fields(owner).items() if up == 0}
        return {name: self.kind(self.file_of[owner], item.annotation) for name, item in own.items()}

    def all_fields(self, owner: ast.ClassDef) -> dict[str, tuple[int, ast.ClassDef, ast.AnnAssign]]:
        """All fields of a class by their names: how many bases up each is, in which class, and its statement."""
        if owner not in self.layouts:
            base = self.base_class(owner)
            inherited = self.all_fields(base) if base else {}
            layout = {name: (up + 1, declaring, item) for name, (up, declaring, item) in inherited.items()}
            for item in owner.body:
                if isinstance(item, ast.AnnAssign) and assigned_name(item) not in layout:
                    layout[assigned_name(item)] = 0, owner, item
            self.layouts[owner] = layout
        return self.layouts[owner]

    def find_method(self, owner: ast.ClassDef, name: str) -> ast.FunctionDef | None:
        """The method that objects of a class have, inherited ones included; None if there is none."""
        own = (item for item in owner.body if isinstance(item, ast.FunctionDef) and item.name == name)
        base = self.base_class(owner)
        return next(own, self.find_method(base, name) if base else None)

    def list_length(self, owner: ast.ClassDef, name: str) -> int:
        """The length of a list that is a field, made by `var.array(length)`."""
        _, declaring, item = self.all_fields(owner)[name]
        call = item.value
        argument = call.args[0] if isinstance(call, ast.Call) and call.args else None
        length = self.constant_value(self.file_of[declaring], argument)
        return length if isinstance(length, int) else 0

    def constant_value(self, file: str, node: ast.expr | None) -> Number | None:
        """The value of a constant expression, as Python computes it; None for any other."""
        result: Number | None = None
        meaning = self.meaning(file, node)
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                result = value
            case ast.UnaryOp(op=ast.USub(), operand=operand) if (x := self.constant_value(file, operand)) is not None:
                result = -x
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC:
                a, b = self.constant_value(file, left), self.constant_value(file, right)
                result = None if a is None or b is None else ARITHMETIC[type(op)](a, b)
            case ast.Call(func=func, args=[operand]) if self.meaning(file, func) == "math.sqrt":
                x = self.constant_value(file, operand)
                result = None if x is None else math.sqrt(x)
            case _ if isinstance(meaning, str) and meaning in MATH_CONSTANTS:
                result = float(getattr(math, meaning.removeprefix("math.")))
            case _ if isinstance(meaning, ast.Assign | ast.AnnAssign):
                result = self.constant_value(self.file_of[meaning], meaning.value)
        return result


def assigned_name(node: ast.AST | None) -> str:
    """The one name that a statement assigns to; empty if there is none."""
    match node:
        case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
            return name
    return ""
