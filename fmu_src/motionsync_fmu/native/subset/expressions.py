"""The rules for expressions, and the record of a violation."""

import ast
from dataclasses import dataclass

from .package import MATH_CONSTANTS, Kind, Meaning, Package

MATH = {"math.sqrt": "float", "math.floor": "int", "math.isfinite": "bool", "math.fmod": "float"}
COPY = "var.copy"  # copies one part into another of the same class
BUILTINS = {"abs": 1, "min": 2, "max": 2, "round": 1, "int": 1, "float": 1, "len": 1}  # least number of arguments
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)

STRING = "no strings in kernel code"
TUPLE = "a tuple is only returned, unpacked into locals at once, or searched with `in`"
POWER = "no `**` and no pow, which machines round differently: write a product"
MEMBER = "an enumeration member is compared, never converted or asked for its name, value or description"
BOOLEANS = "and, or join Booleans only: write a comparison"
INT_AS_FLOAT = "an integer stands for a float in arithmetic and comparisons only: write 1.0, or float(n)"
OBJECT = "an object or list is chosen by its name alone, and is never returned: choose between its values"
CALL = "only kernel functions, methods of objects, abs, min, max, round, int, float, len and math's are called"

FORBIDDEN: dict[type[ast.AST], str] = {
    node: rule
    for rule, nodes in {
        STRING: (ast.JoinedStr,),
        TUPLE: (ast.Tuple,),
        "no lists, dicts or sets are made in kernel code": (ast.List, ast.Dict, ast.Set),
        "no comprehension and no generator: write a loop": (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
        "no function or class inside a function": (ast.Lambda, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef),
        "no exceptions in kernel code: return a fault": (ast.Try, ast.TryStar, ast.Raise, ast.Assert),
        "no with, yield or await in kernel code": (ast.With, ast.AsyncWith, ast.Yield, ast.YieldFrom, ast.Await),
        "no global, nonlocal or del in kernel code": (ast.Global, ast.Nonlocal, ast.Delete),
        "imports stand at module level": (ast.Import, ast.ImportFrom),
        "no assignment inside an expression (`:=`)": (ast.NamedExpr,),
        "no star expressions": (ast.Starred,),
        "no slices: index one element": (ast.Slice,),
    }.items()
    for node in nodes
}


@dataclass(frozen=True)
class Violation:
    """What is outside the subset, and where."""

    file: str
    line: int
    rule: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.rule}"


def names_of_variables(node: ast.expr | None) -> bool:
    """Whether a constant is a tuple of names, for members of enumerations."""
    return isinstance(node, ast.Tuple) and all(isinstance(n, ast.Constant) and type(n.value) is str for n in node.elts)


class Expressions(ast.NodeVisitor):
    """The rules for expressions; each visit returns the kind of the value."""

    def __init__(self, package: Package, file: str, violations: list[Violation]) -> None:
        self.package = package
        self.file = file
        self.violations = violations

    def flag(self, node: ast.AST, rule: str) -> str:
        self.violations.append(Violation(self.file, getattr(node, "lineno", 1), rule))
        return "?"

    def generic_visit(self, node: ast.AST) -> Kind:
        return self.flag(node, FORBIDDEN.get(type(node), f"{type(node).__name__} is outside the kernel subset"))

    def is_enumeration(self, kind: Kind) -> bool:
        return kind in self.package.enumerations

    def is_object(self, kind: Kind) -> bool:
        return kind == "list" or (isinstance(kind, ast.ClassDef) and not self.is_enumeration(kind))

    def arithmetic(self, a: Kind, b: Kind) -> Kind:
        if "float" in (a, b):
            return "float"
        return "int" if all(kind in ("int", "bool") or self.is_enumeration(kind) for kind in (a, b)) else "?"

    def either(self, a: Kind, b: Kind) -> Kind:
        return a if a == b else self.arithmetic(a, b)

    def value(self, node: ast.expr) -> Kind:
        kind: Kind = self.visit(node)
        return self.flag(node, TUPLE) if isinstance(kind, tuple) else kind

    def given(self, node: ast.AST, kind: Kind, wanted: Kind) -> None:
        """A value of one kind where one of another kind is wanted: an integer does not become a float by itself."""
        if wanted == "float" and (kind in ("int", "bool") or self.is_enumeration(kind)):
            self.flag(node, INT_AS_FLOAT)

    def condition(self, node: ast.expr) -> Kind:
        kind = self.value(node)
        if self.is_enumeration(kind) or self.is_object(kind):
            return self.flag(node, "an enumeration member or object has no truth value in kernel code: compare it")
        return kind

    def meaning(self, node: ast.expr) -> Meaning:
        return self.package.meaning(self.file, node)

    def named(self, node: ast.Name | ast.Attribute, meaning: Meaning) -> Kind:
        """A module-level name used as a value."""
        if isinstance(meaning, ast.Assign) and names_of_variables(meaning.value):
            return self.flag(node, STRING)
        if isinstance(meaning, ast.Assign | ast.AnnAssign) and meaning.value is not None:
            known = self.package.constants
            if meaning not in known:
                known[meaning] = "?"  # in case the constant is computed from itself
                known[meaning] = Expressions(self.package, self.package.homes[meaning], []).value(meaning.value)
            return known[meaning]
        if meaning in MATH_CONSTANTS:
            return "float"
        return self.flag(node, f"`{ast.unparse(node)}` is neither a local nor a constant of the package")

    def visit_Constant(self, node: ast.Constant) -> Kind:
        if isinstance(node.value, bool | int | float):
            return type(node.value).__name__
        return self.flag(node, "no `None` in kernel code" if node.value is None else STRING)

    def visit_Name(self, node: ast.Name) -> Kind:
        return self.named(node, self.meaning(node))

    def visit_Attribute(self, node: ast.Attribute) -> Kind:
        meaning, owner = self.meaning(node), self.meaning(node.value)
        if meaning is not None:
            return self.named(node, meaning)
        if isinstance(owner, ast.ClassDef) and self.is_enumeration(owner):
            return owner
        kind = self.value(node.value)
        if self.is_enumeration(kind):
            return self.flag(node, MEMBER)
        return self.package.member(kind, node.attr, ast.AnnAssign) or "?" if isinstance(kind, ast.ClassDef) else "?"

    def visit_Subscript(self, node: ast.Subscript) -> Kind:
        self.value(node.slice)
        self.value(node.value)
        return "float"

    def visit_Call(self, node: ast.Call) -> Kind:
        for keyword in node.keywords:
            self.flag(keyword.value, "arguments are positional")
        kinds = [self.value(argument) for argument in node.args]
        meaning = self.meaning(node.func)
        match node.func:
            case _ if isinstance(meaning, ast.FunctionDef):
                self.passed(node, kinds, self.package.homes[meaning], meaning.args.args)
                return self.package.kind(self.package.homes[meaning], meaning.returns)
            case _ if isinstance(meaning, ast.ClassDef):
                made = "an object is made once, with its owner: no allocation in a function"
                return self.flag(node, MEMBER if self.is_enumeration(meaning) else made)
            case _ if isinstance(meaning, str):
                return self.outside(node, meaning, kinds)
            case ast.Attribute(value=value, attr=name) if isinstance(owner := self.value(value), ast.ClassDef):
                return self.method(node, owner, name, kinds)
            case ast.Name(id=name) if name in BUILTINS and len(kinds) >= BUILTINS[name]:
                return self.builtin(node, name, kinds)
        return self.flag(node, POWER if ast.unparse(node.func) == "pow" else CALL)

    def method(self, node: ast.Call, owner: ast.ClassDef, name: str, kinds: list[Kind]) -> Kind:
        result = self.package.member(owner, name, ast.FunctionDef)
        if result is None:
            return self.flag(node, CALL)
        method = self.package.method(owner, name)
        self.passed(node, kinds, self.package.home(method), method.args.args[1:])
        return result

    def passed(self, node: ast.Call, kinds: list[Kind], home: str, parameters: list[ast.arg]) -> None:
        """The arguments of a call of the package's own function."""
        for argument, kind, parameter in zip(node.args, kinds, parameters, strict=False):
            self.given(argument, kind, self.package.kind(home, parameter.annotation))

    def outside(self, node: ast.Call, meaning: str, kinds: list[Kind]) -> Kind:
        """A call into math, or into the declarations, of which `copy` alone is compiled."""
        if meaning == COPY:
            alike = len(kinds) == 2 and kinds[0] == kinds[1] and kinds[0] != "list" and self.is_object(kinds[0])
            return "None" if alike else self.flag(node, "var.copy takes two parts of the same class")
        other = POWER if meaning == "math.pow" else f"{meaning} is not called: only {', '.join(MATH)}"
        return MATH.get(meaning) or self.flag(node, other)

    def builtin(self, node: ast.Call, name: str, kinds: list[Kind]) -> Kind:
        if len(kinds) > 1 and name not in ("min", "max"):
            return self.flag(node, f"{name} takes one argument here")
        if name in ("min", "max"):
            for argument, kind in zip(node.args, kinds, strict=True):
                self.given(argument, kind, "float" if "float" in kinds else kind)
            return kinds[0] if len(set(kinds)) == 1 else "float" if "float" in kinds else "?"
        return self.arithmetic(kinds[0], kinds[0]) if name == "abs" else "float" if name == "float" else "int"

    def operate(self, node: ast.AST, op: ast.operator, left: Kind, right: Kind) -> Kind:
        if not isinstance(op, OPERATORS):
            return self.flag(node, POWER if isinstance(op, ast.Pow) else "the operators are + - * / // %")
        if "list" in (left, right):
            return self.flag(node, "no arithmetic with whole lists")
        if isinstance(op, ast.FloorDiv) and "float" in (left, right):
            return self.flag(node, "no `//` of floats: write floor(x / y)")
        return "float" if isinstance(op, ast.Div) else self.arithmetic(left, right)

    def visit_BinOp(self, node: ast.BinOp) -> Kind:
        return self.operate(node, node.op, self.value(node.left), self.value(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Kind:
        kind = self.condition(node.operand) if isinstance(node.op, ast.Not) else self.value(node.operand)
        if isinstance(node.op, ast.Invert):
            return self.flag(node, "no bit operators")
        return "bool" if isinstance(node.op, ast.Not) else self.arithmetic(kind, kind)

    def visit_BoolOp(self, node: ast.BoolOp) -> Kind:
        kinds = {self.condition(operand) for operand in node.values}
        return "bool" if kinds <= {"bool", "?"} else self.flag(node, BOOLEANS)

    def visit_IfExp(self, node: ast.IfExp) -> Kind:
        self.condition(node.test)
        kinds = self.value(node.body), self.value(node.orelse)
        if any(self.is_object(kind) for kind in kinds):
            return self.flag(node, OBJECT)
        for branch, kind in zip((node.body, node.orelse), kinds, strict=True):
            self.given(branch, kind, "float" if "float" in kinds else kind)
        return self.either(*kinds)

    def visit_Compare(self, node: ast.Compare) -> Kind:
        self.value(node.left)
        for op, right in zip(node.ops, node.comparators, strict=True):
            match op, right:
                case ((ast.Is() | ast.IsNot()), _):
                    self.flag(node, "no `is`: compare with ==")
                case ((ast.In() | ast.NotIn()), ast.Tuple(elts=members)):
                    for member in members:
                        self.value(member)
                case ((ast.In() | ast.NotIn()), _):
                    self.flag(node, "`in` searches a tuple of members written there")
                case _:
                    self.value(right)
        return "bool"
