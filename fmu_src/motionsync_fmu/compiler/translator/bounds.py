"""The bounds of integers, as far as constants and the enclosing loops determine them: an index that is certainly inside
its list needs no check."""

import ast
from math import inf, isinf
from typing import TypeAlias

from ..subset.effects import Effects
from ..subset.package import CheckedFunction

Bounds: TypeAlias = tuple[float, float]  # the lowest and the highest value
UNBOUNDED = -inf, inf


class IntegerBounds:
    """The integers of one function.

    Attributes:
        inside: the elements whose index is certainly inside their list.
        unbounded: the loops that no constants end; after a failure they might not end.
    """

    def __init__(self, effects: Effects, function: CheckedFunction) -> None:
        self.effects, self.function = effects, function
        self.inside: set[ast.AST] = set()
        self.unbounded: set[ast.AST] = set()
        self.loops: dict[str, Bounds] = {}  # of the variables of the enclosing loops
        self.visit(function.node)

    def visit(self, node: ast.AST) -> None:
        name = ""
        match node:
            case ast.For(target=ast.Name(id=name)):
                low, high = self.loop_bounds(node)
                self.loops[name] = low, high
                if isinf(high - low):
                    self.unbounded.add(node)
            case ast.While():
                self.unbounded.add(node)
            case ast.Subscript(value=values, slice=index) if node in self.function.kinds:
                low, high = self.bounds(index)
                if 0 <= low <= high < self.effects.list_length(self.function, values):
                    self.inside.add(node)
        for inner in ast.iter_child_nodes(node):
            self.visit(inner)
        self.loops.pop(name, None)

    def bounds(self, node: ast.expr) -> Bounds:
        number = self.function.constant_value(node)
        if number is not None:
            return number, number
        match node:
            case ast.Name(id=name):
                return self.loops.get(name, UNBOUNDED)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                low, high = self.bounds(operand)
                return -high, -low
            case ast.BinOp(left=left, op=op, right=right):
                return bounds_of_operation(op, self.bounds(left), self.bounds(right))
            case ast.Call(func=ast.Name(id="len"), args=[values]):
                length = self.effects.list_length(self.function, values)
                return (length, length) if length else UNBOUNDED
        return UNBOUNDED

    def loop_bounds(self, loop: ast.For) -> Bounds:
        """The bounds of a loop's variable."""
        first, end, step = self.function.range_of(loop)
        (low, high), (other_low, other_high) = self.bounds(first), self.bounds(end)
        return (low, other_high - 1) if step > 0 else (other_low + 1, high)


def bounds_of_operation(op: ast.operator, left: Bounds, right: Bounds) -> Bounds:
    """The bounds of a sum, a difference, or a remainder by a divisor above 0."""
    (low, high), (other_low, other_high) = left, right
    match op:
        case ast.Add():
            return low + other_low, high + other_high
        case ast.Sub():
            return low - other_high, high - other_low
        case ast.Mod() if other_low > 0:
            return 0, other_high - 1
    return UNBOUNDED
