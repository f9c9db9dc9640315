"""Expressions in C: the text of each, with the precedence of its operator."""

import ast
from typing import NamedTuple

from ..subset.expression_rules import COPY, PART_FUNCTIONS
from ..subset.package import SERIES, CheckedFunction, Kind
from .context import Context
from .helpers import HELPERS
from .names import BASE
from .raising import library_name
from .text import literal

# The precedence of operators.
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


class Code(NamedTuple):
    """A piece of C."""

    text: str
    precedence: int = PRIMARY

    def as_operand(self, precedence: int) -> str:
        """The text, in parentheses if it has a lower precedence."""
        return self.text if self.precedence >= precedence else f"({self.text})"


class ExpressionWriter:
    """The expressions of one function."""

    def __init__(self, context: Context, function: CheckedFunction) -> None:
        self.context, self.function = context, function
        self.package, self.names = context.package, context.names

    def kind(self, node: ast.expr) -> Kind:
        return self.function.kinds[node]

    # --- values ---

    def code(self, node: ast.expr, precedence: int = 0, as_kind: "Kind | None" = None) -> str:
        """An expression's text as that kind of number, in parentheses if it has a lower precedence."""
        return self.convert(node, as_kind).as_operand(precedence)

    def convert(self, node: ast.expr, as_kind: "Kind | None") -> Code:
        kind = self.kind(node)
        if as_kind == "float" and kind != "float":
            if isinstance(node, ast.Constant) and isinstance(node.value, int):
                return Code(literal(float(node.value)))
            return self.whole_number(node) or Code(f"(double){self.code(node, UNARY)}", UNARY)
        if as_kind == "int" and kind == "bool":
            return Code(f"(int64_t){self.code(node, UNARY)}", UNARY)
        return self.expression(node)

    def whole_number(self, node: ast.expr) -> Code | None:
        """The result of floor or round that becomes a float at once: of any size, as in Python."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand) if whole := self.whole_number(operand):
                return Code(f"0.0 - {whole.text}", SUM)  # no -0.0 either
            case ast.Call(func=func, args=[value]) if self.function.callee(node) is None:
                name = library_name(self.function, func)
                if name in ("floor", "round") and self.kind(value) == "float":
                    return self.helper(f"py_{name}", self.code(value))
        return None

    def condition(self, node: ast.expr, precedence: int = 0) -> str:
        """An expression as a truth value."""
        if self.kind(node) == "bool":
            return self.code(node, precedence)
        zero = "0.0" if self.kind(node) == "float" else "0"
        return Code(f"{self.code(node, EQUALITY + 1)} != {zero}", EQUALITY).as_operand(precedence)

    def helper(self, name: str, *arguments: str) -> Code:
        self.context.helpers.add(name)
        failed = ["failed"] if HELPERS[name].fails else []
        return Code(f"{name}({', '.join([*arguments, *failed])})")

    def expression(self, node: ast.expr) -> Code:
        match node:
            case ast.Call():
                result = self.own_call(node) or self.library_call(node)
            case ast.Name() | ast.Attribute():
                result = Code(self.name_text(node))
            case ast.Subscript(value=values, slice=index):
                result = Code(f"{self.elements(values)}[{self.index(node, index)}]")
            case ast.Constant(value=bool() | int() | float() as value):
                result = Code(literal(value))
            case ast.BinOp(left=left, op=op, right=right):
                result = self.operation(op, self.kind(node), left, right, node)
            case ast.UnaryOp(op=sign, operand=operand):
                result = self.signed(sign, operand, self.kind(node))
            case ast.BoolOp(op=ast.And(), values=values):
                result = Code(" && ".join(self.code(value, AND + 1) for value in values), AND)
            case ast.BoolOp(values=values):
                result = Code(" || ".join(self.code(value, AND + 1) for value in values), OR)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                kind = self.kind(node)
                first, second = self.code(body, CHOICE + 1, kind), self.code(orelse, CHOICE, kind)
                result = Code(f"{self.condition(test, CHOICE + 1)} ? {first} : {second}", CHOICE)
            case ast.Compare():
                result = self.comparison(node)
            case _:
                raise AssertionError(ast.unparse(node))
        return result

    def signed(self, op: ast.unaryop, operand: ast.expr, kind: Kind) -> Code:
        if isinstance(op, ast.Not):
            return Code(f"!{self.condition(operand, UNARY)}", UNARY)
        sign, text = "-" if isinstance(op, ast.USub) else "+", self.code(operand, UNARY, kind)
        return Code(f"{sign}({text})" if text.startswith(sign) else f"{sign}{text}", UNARY)

    def elements(self, values: ast.expr) -> str:
        """A list, or the numbers of a series, by their address."""
        kind = self.kind(values)
        return f"{kind.upper()}({self.code(values)})" if kind in SERIES.values() else self.code(values)  # type: ignore[union-attr]

    def index(self, node: ast.Subscript, index: ast.expr) -> str:
        """An element's index, checked unless that is not needed."""
        if not self.context.raising.may_raise(self.function, node):
            return self.code(index)
        return self.helper("index_in", self.code(index, 0, "int"), self.length(node.value)).text

    def length(self, values: ast.expr) -> str:
        length = self.context.effects.list_length(self.function, values)
        return str(length) if length else f"{self.code(values)}.count"

    # --- names ---

    def name_text(self, node: ast.Name | ast.Attribute) -> str:
        meaning = self.function.meaning(node)
        if isinstance(meaning, ast.Assign | ast.AnnAssign):
            return self.context.constant(meaning)
        if isinstance(meaning, str):
            return literal(self.package.constant_value(self.function.file, node) or 0.0)
        if isinstance(node, ast.Name):
            return self.names.local_name(node.id)
        owner = self.function.meaning(node.value)
        if isinstance(owner, ast.ClassDef) and self.package.is_enumeration(owner):
            return self.context.enumerator(owner, node.attr)
        kind = self.kind(node.value)
        assert isinstance(kind, ast.ClassDef)
        up = self.package.all_fields(kind)[node.attr][0]
        return f"{self.owner(node.value)}{f'{BASE}.' * up}{self.names.field_name(node.attr)}"

    def owner(self, node: ast.expr) -> str:
        """The text before an object's member: names are pointers, parts are in their owner."""
        return f"{self.code(node)}{'->' if isinstance(node, ast.Name) else '.'}"

    def pointer(self, node: ast.expr, as_class: Kind) -> str:
        """The pointer to an object as one of its class, or of a base class; or to a list's first element."""
        kind, up = self.kind(node), 0
        while kind != as_class and isinstance(kind, ast.ClassDef):
            kind, up = self.package.base_class(kind) or as_class, up + 1
        if up:
            return f"&{self.owner(node)}{'.'.join([BASE] * up)}"
        return self.code(node) if isinstance(node, ast.Name) or kind == "list" else f"&{self.code(node)}"

    def object_text(self, node: ast.expr) -> str:
        """An object itself."""
        return f"*{self.code(node)}" if isinstance(node, ast.Name) else self.code(node)

    # --- operators ---

    def operation(self, op: ast.operator, kind: Kind, left: ast.expr, right: ast.expr, node: ast.AST) -> Code:
        """`node`: the operation itself, or the statement that is one."""
        if type(op) in ARITHMETIC:
            sign, precedence = ARITHMETIC[type(op)]
            text = f"{self.code(left, precedence, kind)} {sign} "
            return Code(text + self.right_operand(kind, right, node, precedence + 1), precedence)
        name = "py_mod" if kind == "float" else "py_mod_int" if isinstance(op, ast.Mod) else "py_floordiv_int"
        return self.helper(name, self.code(left, 0, kind), self.right_operand(kind, right, node, 0))

    def right_operand(self, kind: Kind, right: ast.expr, node: ast.AST, precedence: int) -> str:
        """The right operand; a divisor is checked."""
        if not self.context.raising.may_raise(self.function, node):
            return self.code(right, precedence, kind)
        return self.helper("nonzero" if kind == "float" else "nonzero_int", self.code(right, 0, kind)).text

    def comparison(self, node: ast.Compare) -> Code:
        operands, parts, precedence = [node.left, *node.comparators], [], EQUALITY
        for left, op, right in zip(operands, node.ops, operands[1:], strict=False):
            if isinstance(op, ast.In | ast.NotIn):
                search = self.search(left, op, right)
                precedence = search.precedence
                parts.append(search.as_operand(AND + 1 if len(operands) > 2 else 0))
            else:
                parts.append(self.relation(left, COMPARISON[type(op)], right))
                precedence = RELATION if isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE) else EQUALITY
        return Code(" && ".join(parts), AND if len(parts) > 1 else precedence)

    def search(self, left: ast.expr, op: ast.cmpop, right: ast.expr) -> Code:
        sign, precedence, between = ("==", OR, " || ") if isinstance(op, ast.In) else ("!=", AND, " && ")
        assert isinstance(right, ast.Tuple)
        relations = [self.relation(left, sign, member) for member in right.elts]
        return Code(between.join(relations), precedence if len(relations) > 1 else EQUALITY)

    def relation(self, left: ast.expr, sign: str, right: ast.expr) -> str:
        kind = "float" if "float" in (self.kind(left), self.kind(right)) else None
        return f"{self.code(left, RELATION + 1, kind)} {sign} {self.code(right, RELATION + 1, kind)}"

    # --- calls ---

    def own_call(self, node: ast.Call) -> Code | None:
        """The call of a function or method of the package."""
        callee = self.function.callee(node)
        if callee is None:
            return None
        arguments = []
        for name, argument in self.function.arguments(node, callee):
            kind = callee.locals[name]
            is_object = self.package.is_object(kind)
            arguments.append(self.pointer(argument, kind) if is_object else self.code(argument, 0, kind))
        arguments += ["failed"] if callee in self.context.raising.failing else []
        return Code(f"{self.names.name_of(callee.node)}({', '.join(arguments)})")

    def library_call(self, node: ast.Call) -> Code:
        """The call of a function from outside the package."""
        kind, first, name = self.kind(node), node.args[0], library_name(self.function, node.func)
        meaning = self.function.meaning(node.func)
        if meaning == COPY:
            result = Code(f"{self.object_text(first)} = {self.object_text(node.args[1])}", ASSIGNMENT)
        elif isinstance(meaning, str) and meaning in PART_FUNCTIONS:
            parts = ", ".join(self.pointer(part, self.kind(first)) for part in node.args)
            result = Code(f"{self.context.part_function(meaning, self.kind(first))}({parts})")
        elif name in ("min", "max"):
            result = self.least_or_greatest(name, kind, node.args)
        elif name == "len":
            result = Code(self.length(first))
        elif name in ("int", "round", "floor"):
            result = self.to_int(node, first)
        elif name == "float":
            result = self.convert(first, "float")
        elif name == "abs" and kind == "int":
            result = self.helper("py_abs_int", self.code(first, 0, kind))
        else:
            result = self.mathematical(name, node)
        return result

    def least_or_greatest(self, name: str, kind: Kind, values: list[ast.expr]) -> Code:
        """The least or greatest of several values: the first with the second, the result with the third, and so on."""
        text = self.code(values[0], 0, kind)
        for other in values[1:]:
            text = self.helper(f"py_{name}{'' if kind == 'float' else '_int'}", text, self.code(other, 0, kind)).text
        return Code(text)

    def to_int(self, node: ast.Call, value: ast.expr) -> Code:
        if self.kind(value) != "float":
            return self.convert(value, "int")
        whole = self.whole_number(node)
        return self.helper("py_int", whole.text if whole else self.code(value))

    def mathematical(self, name: str, node: ast.Call) -> Code:
        arguments = [self.code(argument, 0, "float") for argument in node.args]
        if name == "isfinite" or (name in ("sqrt", "fmod") and self.context.raising.may_raise(self.function, node)):
            return self.helper(f"py_{name}", *arguments)
        return Code(f"{'fabs' if name == 'abs' else name}({', '.join(arguments)})")
