"""Expressions in C: each as its text, and how tight it binds."""

import ast
from typing import TYPE_CHECKING, NamedTuple

from ..subset.expressions import COPY
from ..subset.package import Kind, Reading
from .helpers import HELPERS
from .names import BASE
from .raising import name_in_python
from .text import literal

if TYPE_CHECKING:
    from .program import Program

# How tight operators bind.
PRIMARY, UNARY, PRODUCT, SUM, RELATION, EQUALITY, AND, OR, CHOICE, ASSIGNMENT = 15, 14, 13, 12, 10, 9, 5, 4, 3, 2
ARITHMETIC: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", SUM),
    ast.Sub: ("-", SUM),
    ast.Mult: ("*", PRODUCT),
    ast.Div: ("/", PRODUCT),
}
COMPARISON: dict[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}
TYPES = {"float": "double", "list": "double", "int": "int64_t", "bool": "bool", "None": "void"}


class Code(NamedTuple):
    """A piece of C."""

    text: str
    binds: int = PRIMARY

    def at_least(self, least: int) -> str:
        """The text, in parentheses unless it binds so tight."""
        return self.text if self.binds >= least else f"({self.text})"


class Expressions:
    """The expressions of one function."""

    def __init__(self, program: "Program", reading: Reading) -> None:
        self.program, self.reading = program, reading
        self.package, self.names = program.package, program.names
        self.checked: dict[ast.expr, str] = {}  # indices or parts of them, as they are once they have been checked

    def kind(self, node: ast.expr) -> Kind:
        return self.reading.kinds[node]

    def is_enumeration(self, kind: Kind) -> bool:
        return kind in self.package.enumerations

    def is_object(self, kind: Kind) -> bool:
        return kind == "list" or (isinstance(kind, ast.ClassDef) and not self.is_enumeration(kind))

    # --- values ---

    def code(self, node: ast.expr, least: int = 0, wanted: "Kind | None" = None) -> str:
        """An expression's text, in parentheses unless it binds so tight, as the kind of number that is wanted."""
        return self.converted(node, wanted).at_least(least)

    def converted(self, node: ast.expr, wanted: "Kind | None") -> Code:
        kind = self.kind(node)
        if wanted == "float" and kind != "float":
            if isinstance(node, ast.Constant) and isinstance(node.value, int):
                return Code(literal(float(node.value)))
            return self.whole_number(node) or Code(f"(double){self.code(node, UNARY)}", UNARY)
        if wanted == "int" and kind == "bool":
            return Code(f"(int64_t){self.code(node, UNARY)}", UNARY)
        return self.expression(node)

    def whole_number(self, node: ast.expr) -> Code | None:
        """What floor and round give, where it becomes a float at once: of any size, as in Python."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand) if whole := self.whole_number(operand):
                return Code(f"0.0 - {whole.text}", SUM)  # no -0.0 either
            case ast.Call(func=func, args=[value]) if self.reading.callee(node) is None:
                name = name_in_python(self.reading, func)
                if name in ("floor", "round") and self.kind(value) == "float":
                    return self.helper(f"py_{name}", self.code(value))
        return None

    def condition(self, node: ast.expr, least: int = 0) -> str:
        """An expression as a truth value."""
        if self.kind(node) == "bool":
            return self.code(node, least)
        zero = "0.0" if self.kind(node) == "float" else "0"
        return Code(f"{self.code(node, EQUALITY + 1)} != {zero}", EQUALITY).at_least(least)

    def helper(self, name: str, *arguments: str) -> Code:
        self.program.helpers.add(name)
        failed = ["failed"] if HELPERS[name].fails else []
        return Code(f"{name}({', '.join([*arguments, *failed])})")

    def expression(self, node: ast.expr) -> Code:
        if node in self.checked:
            found = Code(self.checked[node])
        elif isinstance(node, ast.Call):
            found = self.own_call(node) or self.outside(node)
        elif isinstance(node, ast.Constant | ast.Name | ast.Attribute | ast.Subscript):
            found = self.simple(node)
        else:
            found = self.compound(node)
        return found

    def simple(self, node: ast.Constant | ast.Name | ast.Attribute | ast.Subscript) -> Code:
        match node:
            case ast.Name() | ast.Attribute():
                return Code(self.named(node))
            case ast.Subscript(value=values, slice=index):
                return Code(f"{self.code(values)}[{self.index(node, index)}]")
            case ast.Constant(value=bool() | int() | float() as value):
                return Code(literal(value))
        raise AssertionError(ast.unparse(node))

    def compound(self, node: ast.expr) -> Code:
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                return self.operation(op, self.kind(node), left, right, node)
            case ast.UnaryOp(op=op, operand=operand):
                return self.signed(op, operand, self.kind(node))
            case ast.BoolOp(op=op, values=values):
                sign, binds = (" && ", AND) if isinstance(op, ast.And) else (" || ", OR)
                return Code(sign.join(self.code(value, AND + 1) for value in values), binds)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                kind = self.kind(node)
                first, second = self.code(body, CHOICE + 1, kind), self.code(orelse, CHOICE, kind)
                return Code(f"{self.condition(test, CHOICE + 1)} ? {first} : {second}", CHOICE)
            case ast.Compare():
                return self.comparison(node)
        raise AssertionError(ast.unparse(node))

    def signed(self, op: ast.unaryop, operand: ast.expr, kind: Kind) -> Code:
        if isinstance(op, ast.Not):
            return Code(f"!{self.condition(operand, UNARY)}", UNARY)
        sign, text = "-" if isinstance(op, ast.USub) else "+", self.code(operand, UNARY, kind)
        return Code(f"{sign}({text})" if text.startswith(sign) else f"{sign}{text}", UNARY)

    def index(self, node: ast.Subscript, index: ast.expr) -> str:
        """An element's index; what is to be checked of it is, unless that was done before."""
        if self.program.raising.may(self.reading, node):
            part, length = self.program.raising.checks[self.reading].indices[node]
            if part not in self.checked:
                self.checked[part] = self.in_range(part, length)
        return self.code(index)

    def in_range(self, index: ast.expr, length: int) -> str:
        return self.helper("index_in", self.code(index, 0, "int"), str(length)).text

    def length(self, values: ast.expr) -> int:
        return self.program.effects.length(self.reading, values)

    # --- names ---

    def named(self, node: ast.Name | ast.Attribute) -> str:
        meaning = self.reading.meaning(node)
        if isinstance(meaning, ast.Assign | ast.AnnAssign):
            return self.program.constant(meaning)
        if isinstance(meaning, str):
            return literal(self.package.number(self.reading.file, node) or 0.0)
        if isinstance(node, ast.Name):
            return self.names.local(node.id)
        owner = self.reading.meaning(node.value)
        if isinstance(owner, ast.ClassDef) and self.is_enumeration(owner):
            return self.program.enumerator(owner, node.attr)
        kind = self.kind(node.value)
        assert isinstance(kind, ast.ClassDef)
        up = self.package.members(kind)[node.attr][0]
        return f"{self.owner(node.value)}{f'{BASE}.' * up}{self.names.member(node.attr)}"

    def owner(self, node: ast.expr) -> str:
        """An object, up to its member: names are pointers, parts are in place."""
        return f"{self.code(node)}{'->' if isinstance(node, ast.Name) else '.'}"

    def pointer(self, node: ast.expr, wanted: Kind) -> str:
        """To an object as one of the class `wanted`, its own or one that it derives from; to a list's first element."""
        kind, up = self.kind(node), 0
        while kind != wanted and isinstance(kind, ast.ClassDef):
            kind, up = self.package.base(kind) or wanted, up + 1
        if up:
            return f"&{self.owner(node)}{'.'.join([BASE] * up)}"
        return self.code(node) if isinstance(node, ast.Name) or kind == "list" else f"&{self.code(node)}"

    def whole(self, node: ast.expr) -> str:
        """An object itself."""
        return f"*{self.code(node)}" if isinstance(node, ast.Name) else self.code(node)

    # --- operators ---

    def operation(self, op: ast.operator, kind: Kind, left: ast.expr, right: ast.expr, node: ast.AST) -> Code:
        """`node`: the operation itself, or the statement that is one."""
        if type(op) in ARITHMETIC:
            sign, binds = ARITHMETIC[type(op)]
            return Code(f"{self.code(left, binds, kind)} {sign} {self.right(kind, right, node, binds + 1)}", binds)
        name = "py_mod" if kind == "float" else "py_mod_int" if isinstance(op, ast.Mod) else "py_floordiv_int"
        return self.helper(name, self.code(left, 0, kind), self.right(kind, right, node, 0))

    def right(self, kind: Kind, right: ast.expr, node: ast.AST, least: int) -> str:
        """The right operand; a divisor is watched."""
        if not self.program.raising.may(self.reading, node):
            return self.code(right, least, kind)
        return self.helper("nonzero" if kind == "float" else "nonzero_int", self.code(right, 0, kind)).text

    def comparison(self, node: ast.Compare) -> Code:
        operands, parts, binds = [node.left, *node.comparators], [], EQUALITY
        for left, op, right in zip(operands, node.ops, operands[1:], strict=False):
            if isinstance(op, ast.In | ast.NotIn):
                found = self.search(left, op, right)
                binds = found.binds
                parts.append(found.at_least(AND + 1 if len(operands) > 2 else 0))
            else:
                parts.append(self.relation(left, COMPARISON[type(op)], right))
                binds = RELATION if isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE) else EQUALITY
        return Code(" && ".join(parts), AND if len(parts) > 1 else binds)

    def search(self, left: ast.expr, op: ast.cmpop, right: ast.expr) -> Code:
        sign, binds, between = ("==", OR, " || ") if isinstance(op, ast.In) else ("!=", AND, " && ")
        assert isinstance(right, ast.Tuple)
        relations = [self.relation(left, sign, member) for member in right.elts]
        return Code(between.join(relations), binds if len(relations) > 1 else EQUALITY)

    def relation(self, left: ast.expr, sign: str, right: ast.expr) -> str:
        kind = "float" if "float" in (self.kind(left), self.kind(right)) else None
        return f"{self.code(left, RELATION + 1, kind)} {sign} {self.code(right, RELATION + 1, kind)}"

    # --- calls ---

    def own_call(self, node: ast.Call) -> Code | None:
        """The call of a function or method of the package."""
        callee = self.reading.callee(node)
        if callee is None:
            return None
        given = []
        for name, argument in self.reading.arguments(node, callee):
            wanted = callee.locals[name]
            given.append(self.pointer(argument, wanted) if self.is_object(wanted) else self.code(argument, 0, wanted))
        given += ["failed"] if callee in self.program.raising.failing else []
        return Code(f"{self.names.function(callee)}({', '.join(given)})")

    def outside(self, node: ast.Call) -> Code:
        """The call of a function of Python."""
        kind, first, name = self.kind(node), node.args[0], name_in_python(self.reading, node.func)
        if self.reading.meaning(node.func) == COPY:
            found = Code(f"{self.whole(first)} = {self.whole(node.args[1])}", ASSIGNMENT)
        elif name in ("min", "max"):
            found = self.least_or_greatest(name, kind, node.args)
        elif name == "len":
            found = Code(str(self.length(first)))
        elif name in ("int", "round", "floor"):
            found = self.to_int(node, first)
        elif name == "float":
            found = self.converted(first, "float")
        elif name == "abs" and kind == "int":
            found = self.helper("py_abs_int", self.code(first, 0, kind))
        else:
            found = self.mathematical(name, node)
        return found

    def least_or_greatest(self, name: str, kind: Kind, values: list[ast.expr]) -> Code:
        """Of several values: the first one, then one with the next."""
        text = self.code(values[0], 0, kind)
        for other in values[1:]:
            text = self.helper(f"py_{name}{'' if kind == 'float' else '_int'}", text, self.code(other, 0, kind)).text
        return Code(text)

    def to_int(self, node: ast.Call, value: ast.expr) -> Code:
        if self.kind(value) != "float":
            return self.converted(value, "int")
        whole = self.whole_number(node)
        return self.helper("py_int", whole.text if whole else self.code(value))

    def mathematical(self, name: str, node: ast.Call) -> Code:
        arguments = [self.code(argument, 0, "float") for argument in node.args]
        if name == "isfinite" or (name in ("sqrt", "fmod") and self.program.raising.may(self.reading, node)):
            return self.helper(f"py_{name}", *arguments)
        return Code(f"{'fabs' if name == 'abs' else name}({', '.join(arguments)})")
