"""The rules for what stands at module level and in classes, and the check of all rules."""

import ast
from collections.abc import Iterator, Mapping
from itertools import count

from . import order
from .effects import Effects
from .expressions import Expressions, Violation, names_of_variables
from .functions import KINDS, Body, without_docstring
from .package import MODEL, Kind, Package

DERIVED = (
    "a dataclass derives from one kernel dataclass at most; unless that one has declared fields only, it then adds "
    "nothing but declared fields"
)
IMPORTS = "a kernel module imports only math, dataclass, the declarations and names from modules of its package"
MODULE_LEVEL = (
    "at module level stand only imports, constants (numbers; names of variables), enumerations, dataclasses, functions"
)


class Module(Expressions):
    """The rules for what stands at module level and in classes."""

    def generic_visit(self, node: ast.AST) -> Kind:
        return self.flag(node, MODULE_LEVEL) if isinstance(node, ast.stmt) else super().generic_visit(node)

    def visit_Call(self, node: ast.Call) -> Kind:
        if self.meaning(node.func) == "math.sqrt":
            return super().visit_Call(node)
        return self.flag(node, "a constant is a number or arithmetic on numbers; it calls nothing but math.sqrt")

    def visit_Import(self, node: ast.Import) -> None:
        if [alias.name for alias in node.names] != ["math"]:
            self.flag(node, IMPORTS)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        names = [alias.name for alias in node.names]
        origin = self.package.origin(self.file, node)
        if node.level or origin is not None:
            allowed = origin is not None and (node.module or [str(origin / name) for name in names] == ["var"])
        else:
            declarations = node.module == f"{MODEL}.var" or (node.module == MODEL and names == ["var"])
            dataclass = node.module == "dataclasses" and names == ["dataclass"]
            allowed = declarations or dataclass or node.module == "math"
        if "*" in names or not allowed:
            self.flag(node, IMPORTS)

    def visit_Assign(self, node: ast.Assign) -> None:
        if len(node.targets) != 1 or not isinstance(node.targets[0], ast.Name):
            self.flag(node, MODULE_LEVEL)
        if not names_of_variables(node.value):
            self.value(node.value)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if self.package.kind(self.file, node.annotation) not in ("float", "int", "bool") or node.value is None:
            self.flag(node, MODULE_LEVEL)
        else:
            self.value(node.value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        Body(self.package, self.file, self.violations, node, None).check()

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        rules = self.enumeration if self.is_enumeration(node) else self.dataclass
        rules(node)

    def enumeration(self, node: ast.ClassDef) -> None:
        for item in without_docstring(node.body):
            match item:
                case ast.Assign(
                    targets=[ast.Name()],
                    value=ast.Tuple(elts=[number, ast.Constant(value=str()) | ast.Starred(value=ast.Name()), *_]),
                ):
                    if self.value(number) == "int":
                        continue
            self.flag(item, 'an enumeration holds only members: NAME = integer, "description"')

    def dataclass(self, node: ast.ClassDef) -> None:
        if [ast.unparse(decorator) for decorator in node.decorator_list] != ["dataclass(slots=True)"]:
            self.flag(node, "a class is an enumeration or a @dataclass(slots=True)")
        bases = [self.meaning(base) for base in node.bases]
        extended = any(isinstance(base, ast.ClassDef) and not self.only_declared(base) for base in bases)
        if node.keywords or len(bases) > 1 or not all(isinstance(base, ast.ClassDef) for base in bases):
            self.flag(node, DERIVED)
        for item in without_docstring(node.body):
            match item:
                case ast.AnnAssign(target=ast.Name(), annotation=annotation, value=start):
                    if extended and self.declared(start) is None:
                        self.flag(item, DERIVED)
                    self.field(item, self.package.kind(self.file, annotation), start)
                case ast.FunctionDef(name=name):
                    if extended:
                        self.flag(item, DERIVED)
                    if self.package.member(node, name, ast.AnnAssign) is not None:
                        self.flag(item, f"the method {name} has the name of a field")
                    Body(self.package, self.file, self.violations, item, node).check()
                case _:
                    self.flag(item, "a dataclass holds only typed fields and methods")

    def only_declared(self, node: ast.ClassDef) -> bool:
        """Whether a dataclass is an interface: nothing but declared fields, its own and those it inherits."""
        own = Module(self.package, self.package.homes[node], [])  # names mean what they mean in its own module
        fields = (isinstance(item, ast.AnnAssign) and own.declared(item.value) for item in without_docstring(node.body))
        bases = (own.meaning(base) for base in node.bases)
        return all(fields) and all(isinstance(base, ast.ClassDef) and own.only_declared(base) for base in bases)

    def declared(self, start: ast.expr | None) -> ast.Call | None:
        """The call on the declarations, such as `var.input(0.0, …)`, that gives a field its start value."""
        meaning = self.meaning(start.func) if isinstance(start, ast.Call) else None
        is_declared = isinstance(meaning, str) and meaning.startswith("var.")
        return start if isinstance(start, ast.Call) and is_declared else None

    def field(self, item: ast.AnnAssign, kind: Kind, start: ast.expr | None) -> None:
        call = self.declared(start)
        if kind in ("?", "None") or isinstance(kind, tuple) or isinstance(item.annotation, ast.Constant):
            self.flag(item, f"a field is {KINDS}")
        elif self.is_object(kind):
            if call is None or (kind != "list" and kind not in [self.meaning(made) for made in call.args[:1]]):
                self.flag(item, "an object or list is made with its owner: var.part(Class), var.ring(length)")
        else:
            first = start if call is None else call.args[0] if call.args else None
            given = self.flag(item, "a field has a start value") if first is None else self.value(first)
            if given not in (kind, "?") and not (kind == "int" and self.is_enumeration(given)):
                self.flag(item, "a field starts with a value of its own type: a float with 1.0, not 1")


def violations(package: Package, file: str) -> list[Violation]:
    """The violations in one module of a package, in the order of its lines."""
    module = Module(package, file, [])
    for statement in without_docstring(package.trees[file].body):
        module.visit(statement)
    return sorted(dict.fromkeys(module.violations), key=lambda violation: violation.line)


def check(package_sources: Mapping[str, str]) -> list[Violation]:
    """The violations in the modules of the model; `package_sources`: each module's text by its path in the package.

    The rules that need the whole package (`order`) are applied once it keeps all others.

    Raises SyntaxError, with file and line, if a text is not Python at all.
    """
    package = Package(package_sources)
    return read(package) or order.violations(Effects(package))


def read(package: Package) -> list[Violation]:
    """The violations in each module for itself. All functions have been read then: `package.readings` has them."""
    return [found for file in package.trees if not package.exempt(file) for found in violations(package, file)]


def read_block(package: Package, block: ast.ClassDef) -> list[Violation]:
    """The violations in a block and in all that it needs. Its module may hold other things beside.

    All functions that it needs have been read then, and no others."""
    found: list[Violation] = []
    wanted: dict[ast.stmt, None] = {block: None}
    for statement in wanted_by(package, wanted):
        module = Module(package, package.homes[statement], found)
        module.visit(statement)
    return sorted(dict.fromkeys(found), key=lambda violation: (violation.file, violation.line))


def wanted_by(package: Package, wanted: dict[ast.stmt, None]) -> Iterator[ast.stmt]:
    """These statements at module level, and those that declare what they name."""
    for at in count():
        if at == len(wanted):
            return
        statement = list(wanted)[at]
        yield statement
        for node in ast.walk(statement):
            meaning = package.meaning(package.homes[statement], node) if isinstance(node, ast.Name) else None
            if isinstance(meaning, ast.stmt) and not package.exempt(package.homes[meaning]):
                wanted.setdefault(meaning)
