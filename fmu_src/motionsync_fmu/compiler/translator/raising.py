"""Where Python might raise, the C sets `failed`. The functions that may reach such a point have that parameter, and so
have those with a loop that a failure has to end."""

import ast

from ..subset.effects import Effects
from ..subset.package import CheckedFunction
from .bounds import IntegerBounds

DIVISIONS = (ast.Div, ast.FloorDiv, ast.Mod)


class Raising:
    """What might raise in the functions of a package.

    Attributes:
        failing: the functions that have the parameter `failed`.
    """

    def __init__(self, effects: Effects) -> None:
        self.effects = effects
        self.integers = {function: IntegerBounds(effects, function) for function in effects.by_function}
        self.failing = {
            function
            for function, integers in self.integers.items()
            if integers.unbounded or any(self.may_raise(function, n) for n in function.walk(function.node))
        }
        before = -1
        while before != len(self.failing):
            before = len(self.failing)
            calling = (r for r in effects.by_function if any(callee in self.failing for callee in effects.callees(r)))
            self.failing |= {*calling}

    def may_raise(self, function: CheckedFunction, node: ast.AST) -> bool:
        """Whether an operation itself might raise, whatever its operands do."""
        match node:
            case ast.BinOp(op=op, right=right) | ast.AugAssign(op=op, value=right):
                return isinstance(op, DIVISIONS) and not function.constant_value(right)
            case ast.Subscript():
                return node in function.kinds and node not in self.integers[function].inside
            case ast.Call(func=func, args=[value, *_]) if function.callee(node) is None:
                name = library_name(function, func)
                if name == "sqrt":
                    return not never_negative(function, value)
                return name == "fmod" or (name in ("int", "round", "floor") and function.kinds[value] == "float")
        return False


def library_name(function: CheckedFunction, func: ast.expr) -> str:
    """The name of a function from outside the package: `sqrt` for math.sqrt, however it was imported."""
    meaning = function.meaning(func)
    return meaning.rpartition(".")[2] if isinstance(meaning, str) else ast.unparse(func)


def never_negative(function: CheckedFunction, node: ast.expr) -> bool:
    """Whether a value is evidently not below 0, so that its root exists; it may be NaN."""
    match node:
        case ast.Call(func=func, args=parts) if function.callee(node) is None:
            numbers = [number for part in parts if (number := function.constant_value(part)) is not None]
            name = library_name(function, func)
            return name == "abs" or (name == "max" and any(number >= 0 for number in numbers))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return ast.dump(left) == ast.dump(right) and not any(isinstance(n, ast.Call) for n in function.walk(left))
    number = function.constant_value(node)
    return number is not None and number >= 0
