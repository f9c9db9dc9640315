"""The bounds of integers, as far as constants and the enclosing loops determine them."""

import ast
from math import inf
from typing import TypeAlias

from ..subset.effects import Effects
from ..subset.package import CheckedFunction

Bounds: TypeAlias = tuple[float, float]  # the lowest and the highest value
UNBOUNDED = -inf, inf


class IntegerBounds:
    """The integers of one function; `loops` has the bounds of the enclosing loops' variables."""

    def __init__(self, effects: Effects, function: CheckedFunction) -> None:
        self.effects, self.function = effects, function
        self.loops: dict[str, Bounds] = {}

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
