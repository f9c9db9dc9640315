"""The rules for expressions, and the record of a violation."""

import ast
from collections.abc import Iterable
from dataclasses import dataclass
from operator import attrgetter

from .package import MATH_CONSTANTS, SERIES, Kind, Meaning, Package

MATH = {"math.sqrt": "float", "math.floor": "int", "math.isfinite": "bool", "math.fmod": "float"}
COPY = "var.copy"  # copies one part into another of the same class
SAME = "var.same"  # compares a part with one of its class, or of a class derived from it
COPY_VALID = "var.copy_valid"  # copies such a one, if its tunable parameters are valid
FIRST_INVALID = "var.first_invalid"  # numbers the first tunable parameter in a part that is not valid
PART_FUNCTIONS = {COPY: "None", SAME: "bool", COPY_VALID: "None", FIRST_INVALID: "int"}  # the kinds of their results
BUILTINS = {"abs": 1, "min": 2, "max": 2, "round": 1, "int": 1, "float": 1, "len": 1}  # least number of arguments
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)

STRING = "no strings in kernel code"
TUPLE = "a tuple is only returned, unpacked into locals at once, or searched with `in`"
POWER = "no `**` and no pow, which machines round differently: write a product"
MEMBER = "an enumeration member is compared, never converted or asked for its name, value or description"
BOOLEANS = "and, or join Booleans only: write a comparison"
INT_AS_FLOAT = "an integer becomes a float in arithmetic and comparisons only: write 1.0, or float(n)"
OBJECT = "an object or list is chosen by its name alone, and is never returned: choose between its values"
GIVEN = (
    "a series is a field, of which only elements and the length are used; no part that has one is copied or compared"
)
PARTS = "parts are compared with var.same, and lists element by element"
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
        "imports are at module level": (ast.Import, ast.ImportFrom),
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


def in_order(violations: Iterable[Violation]) -> list[Violation]:
    """Each violation once, by file and line."""
    return sorted(dict.fromkeys(violations), key=attrgetter("file", "line"))


def is_tuple_of_names(node: ast.expr | None) -> bool:
    """Whether a constant is a tuple of names, for members of enumerations."""
    return isinstance(node, ast.Tuple) and all(isinstance(n, ast.Constant) and type(n.value) is str for n in node.elts)


class ExpressionRules(ast.NodeVisitor):
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

    def arithmetic_kind(self, a: Kind, b: Kind) -> Kind:
        if "float" in (a, b):
            return "float"
        return "int" if all(kind in ("int", "bool") or self.package.is_enumeration(kind) for kind in (a, b)) else "?"

    def value_kind(self, node: ast.expr) -> Kind:
        kind = self.sequence_kind(node)
        return self.flag(node, GIVEN) if kind in SERIES.values() else kind

    def sequence_kind(self, node: ast.expr) -> Kind:
        """The kind of a value, which may be a series."""
        kind: Kind = self.visit(node)
        return self.flag(node, TUPLE) if isinstance(kind, tuple) else kind

    def check_conversion(self, node: ast.AST, kind: Kind, required: Kind) -> None:
        """Flag an integer where a float is required: it does not become one by itself."""
        if required == "float" and (kind in ("int", "bool") or self.package.is_enumeration(kind)):
            self.flag(node, INT_AS_FLOAT)

    def condition_kind(self, node: ast.expr) -> Kind:
        kind = self.value_kind(node)
        if self.package.is_enumeration(kind) or self.package.is_object(kind):
            return self.flag(node, "an enumeration member or object has no truth value in kernel code: compare it")
        return kind

    def meaning(self, node: ast.expr) -> Meaning:
        return self.package.meaning(self.file, node)

    def constant_kind(self, node: ast.Name | ast.Attribute, meaning: Meaning) -> Kind:
        """A module-level name used as a value."""
        if isinstance(meaning, ast.Assign) and is_tuple_of_names(meaning.value):
            return self.flag(node, STRING)
        if isinstance(meaning, ast.Assign | ast.AnnAssign) and meaning.value is not None:
            kinds = self.package.constants
            if meaning not in kinds:
                kinds[meaning] = "?"  # in case the constant is computed from itself
                kinds[meaning] = ExpressionRules(self.package, self.package.file_of[meaning], []).value_kind(
                    meaning.value
                )
            return kinds[meaning]
        if meaning in MATH_CONSTANTS:
            return "float"
        return self.flag(node, f"`{ast.unparse(node)}` is neither a local nor a constant of the package")

    def visit_Constant(self, node: ast.Constant) -> Kind:
        if isinstance(node.value, bool | int | float):
            return type(node.value).__name__
        return self.flag(node, "no `None` in kernel code" if node.value is None else STRING)

    def visit_Name(self, node: ast.Name) -> Kind:
        return self.constant_kind(node, self.meaning(node))

    def visit_Attribute(self, node: ast.Attribute) -> Kind:
        meaning, owner = self.meaning(node), self.meaning(node.value)
        if meaning is not None:
            return self.constant_kind(node, meaning)
        if isinstance(owner, ast.ClassDef) and self.package.is_enumeration(owner):
            return owner
        kind = self.value_kind(node.value)
        if self.package.is_enumeration(kind):
            return self.flag(node, MEMBER)
        return (isinstance(kind, ast.ClassDef) and self.package.field_kind(kind, node.attr)) or "?"

    def visit_Subscript(self, node: ast.Subscript) -> Kind:
        self.value_kind(node.slice)
        return "int" if self.sequence_kind(node.value) == "wholes" else "float"

    def visit_Call(self, node: ast.Call) -> Kind:
        for keyword in node.keywords:
            self.flag(keyword.value, "arguments are positional")
        is_len = isinstance(node.func, ast.Name) and node.func.id == "len"
        kinds = [self.sequence_kind(argument) if is_len else self.value_kind(argument) for argument in node.args]
        meaning = self.meaning(node.func)
        match node.func:
            case _ if isinstance(meaning, ast.FunctionDef):
                self.check_arguments(node, kinds, self.package.file_of[meaning], meaning.args.args)
                return self.package.kind(self.package.file_of[meaning], meaning.returns)
            case _ if isinstance(meaning, ast.ClassDef):
                allocation = "an object is made once, with its owner: no allocation in a function"
                return self.flag(node, MEMBER if self.package.is_enumeration(meaning) else allocation)
            case _ if isinstance(meaning, str):
                return self.library_call_kind(node, meaning, kinds)
            case ast.Attribute(value=value, attr=name) if isinstance(owner := self.value_kind(value), ast.ClassDef):
                return self.method_call_kind(node, owner, name, kinds)
            case ast.Name(id=name) if name in BUILTINS and len(kinds) >= BUILTINS[name]:
                return self.builtin_call_kind(node, name, kinds)
        return self.flag(node, POWER if ast.unparse(node.func) == "pow" else CALL)

    def method_call_kind(self, node: ast.Call, owner: ast.ClassDef, name: str, kinds: list[Kind]) -> Kind:
        method = self.package.find_method(owner, name)
        if method is None:
            return self.flag(node, CALL)
        file = self.package.file_of_method(method)
        self.check_arguments(node, kinds, file, method.args.args[1:])
        return self.package.kind(file, method.returns)

    def check_arguments(self, node: ast.Call, kinds: list[Kind], file: str, parameters: list[ast.arg]) -> None:
        """Check the arguments of a call of the package's own function, which is in that file."""
        for argument, kind, parameter in zip(node.args, kinds, parameters, strict=False):
            self.check_conversion(argument, kind, self.package.kind(file, parameter.annotation))

    def library_call_kind(self, node: ast.Call, meaning: str, kinds: list[Kind]) -> Kind:
        """A call into math, or into the declarations, of which the functions of parts alone are compiled."""
        if meaning in PART_FUNCTIONS:
            number = 1 if meaning == FIRST_INVALID else 2
            are_parts = len(kinds) == number and kinds[0] != "list" and self.package.is_object(kinds[0])
            is_alike = kinds[-1:] == kinds[:1] or (meaning != COPY and self.package.is_derived(kinds[-1], kinds[0]))
            if are_parts and self.package.has_series(kinds[0]):
                return self.flag(node, GIVEN)
            what = "a part" if number == 1 else "two parts of the same class"
            return PART_FUNCTIONS[meaning] if are_parts and is_alike else self.flag(node, f"{meaning} takes {what}")
        other = POWER if meaning == "math.pow" else f"{meaning} is not called: only {', '.join(MATH)}"
        return MATH.get(meaning) or self.flag(node, other)

    def builtin_call_kind(self, node: ast.Call, name: str, kinds: list[Kind]) -> Kind:
        if len(kinds) > 1 and name not in ("min", "max"):
            return self.flag(node, f"{name} takes one argument here")
        if name in ("min", "max"):
            for argument, kind in zip(node.args, kinds, strict=True):
                self.check_conversion(argument, kind, "float" if "float" in kinds else kind)
            return kinds[0] if len(set(kinds)) == 1 else "float" if "float" in kinds else "?"
        return self.arithmetic_kind(kinds[0], kinds[0]) if name == "abs" else "float" if name == "float" else "int"

    def operation_kind(self, node: ast.AST, op: ast.operator, left: Kind, right: Kind) -> Kind:
        if not isinstance(op, OPERATORS):
            return self.flag(node, POWER if isinstance(op, ast.Pow) else "the operators are + - * / // %")
        if "list" in (left, right):
            return self.flag(node, "no arithmetic with whole lists")
        if isinstance(op, ast.FloorDiv) and "float" in (left, right):
            return self.flag(node, "no `//` of floats: write floor(x / y)")
        return "float" if isinstance(op, ast.Div) else self.arithmetic_kind(left, right)

    def visit_BinOp(self, node: ast.BinOp) -> Kind:
        return self.operation_kind(node, node.op, self.value_kind(node.left), self.value_kind(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Kind:
        kind = self.condition_kind(node.operand) if isinstance(node.op, ast.Not) else self.value_kind(node.operand)
        if isinstance(node.op, ast.Invert):
            return self.flag(node, "no bit operators")
        return "bool" if isinstance(node.op, ast.Not) else self.arithmetic_kind(kind, kind)

    def visit_BoolOp(self, node: ast.BoolOp) -> Kind:
        kinds = {self.condition_kind(operand) for operand in node.values}
        return "bool" if kinds <= {"bool", "?"} else self.flag(node, BOOLEANS)

    def visit_IfExp(self, node: ast.IfExp) -> Kind:
        self.condition_kind(node.test)
        kinds = self.value_kind(node.body), self.value_kind(node.orelse)
        if any(self.package.is_object(kind) for kind in kinds):
            return self.flag(node, OBJECT)
        for branch, kind in zip((node.body, node.orelse), kinds, strict=True):
            self.check_conversion(branch, kind, "float" if "float" in kinds else kind)
        return kinds[0] if kinds[0] == kinds[1] else self.arithmetic_kind(*kinds)

    def visit_Compare(self, node: ast.Compare) -> Kind:
        if self.package.is_object(self.value_kind(node.left)):
            self.flag(node, PARTS)
        for op, right in zip(node.ops, node.comparators, strict=True):
            match op, right:
                case ((ast.Is() | ast.IsNot()), _):
                    self.flag(node, "no `is`: compare with ==")
                case ((ast.In() | ast.NotIn()), ast.Tuple(elts=members)):
                    for member in members:
                        self.value_kind(member)
                case ((ast.In() | ast.NotIn()), _):
                    self.flag(node, "`in` searches a tuple of members written there")
                case _:
                    if self.package.is_object(self.value_kind(right)):
                        self.flag(node, PARTS)
        return "bool"
