"""Between which values an integer evidently lies, found from constants and from the loops around."""

import ast
from math import inf
from typing import TypeAlias

from ..subset.effects import Effects
from ..subset.package import Reading

Bounds: TypeAlias = tuple[float, float]  # the least and the greatest value
EVERYWHERE = -inf, inf


class Integers:
    """The integers of one function; `loops` has the bounds of the variables of the loops around a place."""

    def __init__(self, effects: Effects, reading: Reading) -> None:
        self.effects, self.reading = effects, reading
        self.loops: dict[str, Bounds] = {}

    def bounds(self, node: ast.expr) -> Bounds:
        number = self.reading.number(node)
        if number is not None:
            return number, number
        match node:
            case ast.Name(id=name):
                return self.loops.get(name, EVERYWHERE)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                low, high = self.bounds(operand)
                return -high, -low
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
                (low, high), (least, greatest) = self.bounds(left), self.bounds(right)
                return (low + least, high + greatest) if isinstance(op, ast.Add) else (low - greatest, high - least)
            case ast.Call(func=ast.Name(id="len"), args=[values]):
                length = self.effects.length(self.reading, values)
                return (length, length) if length else EVERYWHERE
        return EVERYWHERE

    def of_loop(self, loop: ast.For) -> Bounds:
        """The bounds of a loop's variable."""
        assert isinstance(loop.iter, ast.Call)
        limits = loop.iter.args
        first, end = limits[:2] if len(limits) > 1 else (ast.Constant(0), limits[0])
        (low, high), (least, greatest) = self.bounds(first), self.bounds(end)
        step = self.reading.package.number(self.reading.file, limits[2]) if len(limits) > 2 else 1
        return (low, greatest - 1) if step and step > 0 else (least + 1, high)
