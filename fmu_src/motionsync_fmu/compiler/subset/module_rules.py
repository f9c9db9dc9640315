"""The rules for statements at module level and in classes, and the check of all rules."""

import ast
from collections.abc import Iterable, Iterator, Mapping

from . import evaluation_order
from .effects import Effects
from .expression_rules import ExpressionRules, Violation, in_order, is_tuple_of_names
from .function_rules import KINDS, FunctionRules, without_docstring
from .package import MODEL, SERIES, Kind, Package

DERIVED = (
    "a dataclass derives from one kernel dataclass at most; unless that one has declared fields only, it then adds "
    "nothing but declared fields"
)
IMPORTS = "a kernel module imports only math, dataclass, the declarations and names from modules of its package"
MODULE_LEVEL = (
    "at module level are only imports, constants (numbers; names of variables), enumerations, dataclasses, functions"
)


class ModuleRules(ExpressionRules):
    """The rules for statements at module level and in classes."""

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
        origin = self.package.import_path(self.file, node)
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
        if not is_tuple_of_names(node.value):
            self.value_kind(node.value)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if self.package.kind(self.file, node.annotation) not in ("float", "int", "bool") or node.value is None:
            self.flag(node, MODULE_LEVEL)
        else:
            self.value_kind(node.value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        FunctionRules(self.package, self.file, self.violations, node, None).check()

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        rules = self.check_enumeration if self.package.is_enumeration(node) else self.check_dataclass
        rules(node)

    def check_enumeration(self, node: ast.ClassDef) -> None:
        for item in without_docstring(node.body):
            match item:
                case ast.Assign(
                    targets=[ast.Name()],
                    value=ast.Tuple(elts=[number, ast.Constant(value=str()) | ast.Starred(value=ast.Name()), *_]),
                ):
                    if self.value_kind(number) == "int":
                        continue
            self.flag(item, 'an enumeration holds only members: NAME = integer, "description"')

    def check_dataclass(self, node: ast.ClassDef) -> None:
        if [ast.unparse(decorator) for decorator in node.decorator_list] != ["dataclass(slots=True)"]:
            self.flag(node, "a class is an enumeration or a @dataclass(slots=True)")
        bases = [self.meaning(base) for base in node.bases]
        extended = any(isinstance(base, ast.ClassDef) and not self.is_interface(base) for base in bases)
        if node.keywords or len(bases) > 1 or not all(isinstance(base, ast.ClassDef) for base in bases):
            self.flag(node, DERIVED)
        for item in without_docstring(node.body):
            match item:
                case ast.AnnAssign(target=ast.Name(), annotation=annotation, value=start):
                    if extended and self.declaration_call(start) is None:
                        self.flag(item, DERIVED)
                    self.check_field(item, self.package.kind(self.file, annotation), start)
                case ast.FunctionDef(name=name):
                    if extended:
                        self.flag(item, DERIVED)
                    if name in self.package.all_fields(node):
                        self.flag(item, f"the method {name} has the name of a field")
                    FunctionRules(self.package, self.file, self.violations, item, node).check()
                case _:
                    self.flag(item, "a dataclass holds only typed fields and methods")

    def is_interface(self, node: ast.ClassDef) -> bool:
        """Whether a dataclass is an interface: nothing but declared fields, its own and those it inherits."""
        own = ModuleRules(self.package, self.package.file_of[node], [])  # names have their meaning in its own module
        fields = (
            isinstance(item, ast.AnnAssign) and own.declaration_call(item.value)
            for item in without_docstring(node.body)
        )
        bases = (own.meaning(base) for base in node.bases)
        return all(fields) and all(isinstance(base, ast.ClassDef) and own.is_interface(base) for base in bases)

    def declaration_call(self, start: ast.expr | None) -> ast.Call | None:
        """The call on the declarations, such as `var.input(0.0, …)`, that gives a field its start value."""
        meaning = self.meaning(start.func) if isinstance(start, ast.Call) else None
        is_declared = isinstance(meaning, str) and meaning.startswith("var.")
        return start if isinstance(start, ast.Call) and is_declared else None

    def check_field(self, item: ast.AnnAssign, kind: Kind, start: ast.expr | None) -> None:
        call = self.declaration_call(start)
        if kind in ("?", "None") or isinstance(kind, tuple) or isinstance(item.annotation, ast.Constant):
            self.flag(item, f"a field is {KINDS}")
        elif kind in SERIES.values():
            if call is None or self.meaning(call.func) != "var.series":
                self.flag(item, "a series is made by var.series()")
        elif self.package.is_object(kind):
            if call is None or (kind != "list" and kind not in [self.meaning(argument) for argument in call.args[:1]]):
                self.flag(item, "an object or list is made with its owner: var.part(Class), var.array(length)")
        else:
            first = start if call is None else call.args[0] if call.args else None
            start_kind = self.flag(item, "a field has a start value") if first is None else self.value_kind(first)
            if start_kind not in (kind, "?") and not (kind == "int" and self.package.is_enumeration(start_kind)):
                self.flag(item, "a field starts with a value of its own type: a float with 1.0, not 1")


def check(package_sources: Mapping[str, str]) -> list[Violation]:
    """The violations in the modules of the model; `package_sources`: each module's text by its path in the package.

    The rules that need the whole package (`order`) are applied once it keeps all others.

    Raises SyntaxError, with file and line, if a text is not Python at all.
    """
    package = Package(package_sources)
    return check_modules(package) or evaluation_order.violations(Effects(package))


def check_modules(package: Package) -> list[Violation]:
    """The violations in each module by itself. `package.functions` then has all functions."""
    trees = (tree for file, tree in package.trees.items() if not package.is_exempt(file))
    return check_statements(package, (statement for tree in trees for statement in without_docstring(tree.body)))


def check_block(package: Package, block: ast.ClassDef) -> list[Violation]:
    """The violations in a block and in all that it needs. Its module may have other statements, too.

    `package.functions` then has the functions that the block needs, and no others."""
    return check_statements(package, required_statements(package, block))


def check_statements(package: Package, statements: Iterable[ast.stmt]) -> list[Violation]:
    """The violations in these statements at module level."""
    violations: list[Violation] = []
    for statement in statements:
        ModuleRules(package, package.file_of[statement], violations).visit(statement)
    return in_order(violations)


def required_statements(package: Package, block: ast.ClassDef) -> Iterator[ast.stmt]:
    """A block's class, and the statements at module level that declare what it needs, directly or indirectly."""
    statements: list[ast.stmt] = [block]
    seen: set[ast.stmt] = {block}
    for statement in statements:  # it grows meanwhile
        yield statement
        for node in ast.walk(statement):
            meaning = package.meaning(package.file_of[statement], node) if isinstance(node, ast.Name) else None
            if (
                isinstance(meaning, ast.stmt)
                and meaning not in seen
                and not package.is_exempt(package.file_of[meaning])
            ):
                seen.add(meaning)
                statements.append(meaning)
