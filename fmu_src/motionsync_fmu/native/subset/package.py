"""The model's modules, and what their names stand for."""

import ast
import math
import operator
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import PurePosixPath
from typing import TypeAlias

EXEMPT = ("__init__.py", "blocks.py", "var.py")  # public names, registry, declarations: they are never compiled
MATH_CONSTANTS = ("math.e", "math.inf", "math.nan", "math.pi", "math.tau")
MODEL = "motionsync"  # the package with the declarations; a block may stand in another one
ENUMERATIONS = ("var.Enumeration",)  # what enumerations derive from

# The kind of a value: "float", "int", "bool", "list", the class of an enumeration member or object, the kinds in a
# returned tuple, or "?" (unknown: its expression has violated a rule).
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
class Reading:
    """What was found out when a function or method was read.

    Attributes:
        locals: the kind of each local, parameters included.
        kinds: the kind of each expression's value.
    """

    package: "Package"
    file: str
    node: ast.FunctionDef
    owner: ast.ClassDef | None
    locals: "dict[str, Kind]" = field(default_factory=dict)
    kinds: "dict[ast.expr, Kind]" = field(default_factory=dict)
    inside: dict[ast.AST, list[ast.AST]] = field(default_factory=dict)

    def walk(self, node: ast.AST) -> list[ast.AST]:
        """A node and all nodes in it, in the order of `ast.walk`, found once."""
        if node not in self.inside:
            self.inside[node] = found = [node]
            for one in found:  # it grows meanwhile
                found += children(one)
        return self.inside[node]

    @property
    def parameters(self) -> list[str]:
        return [argument.arg for argument in self.node.args.args]

    def meaning(self, node: ast.expr | None) -> Meaning:
        """What a name stands for that is no local's."""
        root = node.value if isinstance(node, ast.Attribute) else node
        return None if isinstance(root, ast.Name) and root.id in self.locals else self.package.meaning(self.file, node)

    def callee(self, node: ast.AST) -> "Reading | None":
        """The function or method of the package that a call calls."""
        if not isinstance(node, ast.Call):
            return None
        meaning = self.meaning(node.func)
        if isinstance(meaning, ast.FunctionDef):
            return self.package.readings[meaning]
        if meaning is None and isinstance(node.func, ast.Attribute):
            owner = self.kinds[node.func.value]
            assert isinstance(owner, ast.ClassDef)
            return self.package.readings[self.package.method(owner, node.func.attr)]
        return None

    def arguments(self, call: ast.Call, callee: "Reading") -> list[tuple[str, ast.expr]]:
        """What each parameter of the function that is called gets; a method's object comes first."""
        own = [call.func.value] if callee.owner and isinstance(call.func, ast.Attribute) else []
        return list(zip(callee.parameters, own + call.args, strict=True))

    def number(self, node: ast.expr) -> Number | None:
        """The value of a constant; None of all else."""
        if isinstance(node, ast.Constant) or isinstance(self.meaning(node), ast.Assign | ast.AnnAssign):
            return self.package.number(self.file, node)
        return None


@cache
def parsed(file: str, text: str) -> ast.Module:
    """The tree of a module, which nobody changes. Blocks share modules, and a block is checked, then translated."""
    return ast.parse(text, file)


@cache
def children(node: ast.AST) -> list[ast.AST]:
    """The nodes directly in a node."""
    return list(ast.iter_child_nodes(node))


class Package:
    """The modules of the model (path inside the package to text) and what their names stand for."""

    def __init__(self, sources: Mapping[str, str]) -> None:
        self.trees = {file: parsed(file, text) for file, text in sorted(sources.items())}
        self.names = {file: dict(self.module_names(tree)) for file, tree in self.trees.items()}
        self.found: dict[tuple[str, str], Meaning] = {}
        self.homes = {node: file for file, tree in self.trees.items() for node in tree.body}
        classes = [(node, file) for node, file in self.homes.items() if isinstance(node, ast.ClassDef)]
        self.constants: dict[ast.stmt, Kind] = {}  # kinds of the constants that have been visited
        self.layouts: dict[ast.ClassDef, dict[str, tuple[int, ast.ClassDef, ast.AnnAssign]]] = {}
        self.readings: dict[ast.FunctionDef, Reading] = {}
        self.enumerations = {
            node for node, file in classes if any(self.meaning(file, base) in ENUMERATIONS for base in node.bases)
        }

    @staticmethod
    def exempt(file: str) -> bool:
        return file in EXEMPT or PurePosixPath(file).name == "__init__.py"

    @staticmethod
    def origin(file: str, node: ast.ImportFrom) -> PurePosixPath | None:
        """The module (without suffix) or folder of an import from the package, or from the model by its full name,
        as another package's block has it; None if it lies outside both, or is that of the declarations."""
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

    def find(self, file: str, name: str) -> Meaning:
        """What a name stands for in a module, through imports inside the package."""
        if (file, name) not in self.found:
            self.found[file, name] = self.search(file, name)
        return self.found[file, name]

    def search(self, file: str, name: str) -> Meaning:
        node, original = self.names.get(file, {}).get(name, (None, name))
        if isinstance(node, ast.Import):
            return original
        if not isinstance(node, ast.ImportFrom):
            return node
        origin = self.origin(file, node)
        if origin is None:
            return f"{node.module}.{original}".removeprefix(f"{MODEL}.")
        if node.module is None:
            return str(origin / original)
        module = next((m for m in (f"{origin}.py", f"{origin}/__init__.py") if m in self.trees), "")
        found = self.find(module, original)
        if f"{origin}.py" in EXEMPT and not isinstance(found, ast.Assign | ast.AnnAssign):
            return f"{origin}.{original}"
        return found

    def meaning(self, file: str, node: ast.expr | None) -> Meaning:
        """What a name, or a name of math or of the declarations (`math.sqrt`), stands for in a module."""
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = self.find(file, node.value.id)
            return f"{owner}.{node.attr}" if isinstance(owner, str) else None
        return self.find(file, node.id) if isinstance(node, ast.Name) else None

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
        found = self.meaning(file, annotation)
        return found if isinstance(found, ast.ClassDef) else "?"

    def member(self, owner: ast.ClassDef, name: str, sort: type[ast.stmt]) -> "Kind | None":
        """The kind of a field, or of what a method returns, inherited ones included; None if there is none."""
        for item in owner.body:
            match item:
                case ast.AnnAssign(target=ast.Name(id=found), annotation=annotation) if found == name and sort is type(
                    item
                ):
                    return self.kind(self.homes[owner], annotation)
                case ast.FunctionDef(name=found, returns=returns) if found == name and sort is type(item):
                    return self.kind(self.homes[owner], returns)
        bases = [self.meaning(self.homes[owner], base) for base in owner.bases]
        inherited = [
            self.member(base, name, sort) for base in bases if isinstance(base, ast.ClassDef) and base != owner
        ]
        return inherited[0] if inherited else None

    def home(self, method: ast.FunctionDef) -> str:
        """The module in whose classes a method stands."""
        return next(file for node, file in self.homes.items() if isinstance(node, ast.ClassDef) and method in node.body)

    def base(self, owner: ast.ClassDef) -> ast.ClassDef | None:
        """The kernel dataclass from which a class derives."""
        found = self.meaning(self.homes[owner], owner.bases[0]) if owner.bases else None
        return found if isinstance(found, ast.ClassDef) and found != owner else None

    def fields(self, owner: ast.ClassDef) -> list[ast.AnnAssign]:
        """The fields that a class adds to its base; one that it declares anew lies where the base has it."""
        return [item for up, _, item in self.members(owner).values() if up == 0]

    def members(self, owner: ast.ClassDef) -> dict[str, tuple[int, ast.ClassDef, ast.AnnAssign]]:
        """All fields of a class by their names: how many bases up each lies, in which class, and its statement."""
        if owner not in self.layouts:
            base = self.base(owner)
            above = self.members(base) if base else {}
            found = {name: (up + 1, home, item) for name, (up, home, item) in above.items()}
            for item in owner.body:
                if isinstance(item, ast.AnnAssign) and name_of(item) not in found:
                    found[name_of(item)] = 0, owner, item
            self.layouts[owner] = found
        return self.layouts[owner]

    def method(self, owner: ast.ClassDef, name: str) -> ast.FunctionDef:
        """The method that objects of a class have."""
        own = [item for item in owner.body if isinstance(item, ast.FunctionDef) and item.name == name]
        base = self.base(owner)
        return own[0] if own or base is None else self.method(base, name)

    def length(self, owner: ast.ClassDef, name: str) -> int:
        """The length of a list that is a field, made by `var.ring(length)`."""
        _, home, item = self.members(owner)[name]
        made = item.value
        length = self.number(self.homes[home], made.args[0]) if isinstance(made, ast.Call) and made.args else None
        return length if isinstance(length, int) else 0

    def number(self, file: str, node: ast.expr | None) -> Number | None:
        """The value of a constant expression, as Python computes it; None of what is none."""
        found: Number | None = None
        meaning = self.meaning(file, node)
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                found = value
            case ast.UnaryOp(op=ast.USub(), operand=operand) if (x := self.number(file, operand)) is not None:
                found = -x
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC:
                a, b = self.number(file, left), self.number(file, right)
                found = None if a is None or b is None else ARITHMETIC[type(op)](a, b)
            case ast.Call(func=func, args=[operand]) if self.meaning(file, func) == "math.sqrt":
                x = self.number(file, operand)
                found = None if x is None else math.sqrt(x)
            case _ if isinstance(meaning, str) and meaning in MATH_CONSTANTS:
                found = float(getattr(math, meaning.removeprefix("math.")))
            case _ if isinstance(meaning, ast.Assign | ast.AnnAssign):
                found = self.number(self.homes[meaning], meaning.value)
        return found


def name_of(node: ast.AST | None) -> str:
    """The one name that a statement assigns to; empty if there is none."""
    match node:
        case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
            return name
    return ""
