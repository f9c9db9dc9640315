"""The values that are not 0 where a condition is true, or where it is false."""

import ast
import operator
from collections.abc import Callable, Iterator

from ..subset.package import CheckedFunction

RELATIONS: dict[type[ast.cmpop], Callable[[float, float], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


def nonzero_values(function: CheckedFunction, test: ast.expr, truth: bool) -> Iterator[ast.expr]:
    """The expressions that are not 0 where a condition has this truth; NaN is not 0 either."""
    match test:
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield from nonzero_values(function, operand, not truth)
        case ast.BoolOp(op=op, values=values) if isinstance(op, ast.And) == truth:
            for value in values:
                yield from nonzero_values(function, value, truth)
        case ast.Compare(left=left, ops=ops, comparators=rights) if truth or len(ops) == 1:
            for a, sign, b in zip([left, *rights], ops, rights, strict=False):
                if relation := RELATIONS.get(type(sign)):
                    yield from nonzero_sides(function, a, relation, b, truth)


def nonzero_sides(
    function: CheckedFunction, a: ast.expr, relation: Callable[[float, float], bool], b: ast.expr, truth: bool
) -> Iterator[ast.expr]:
    """Of two values, of which one is a constant, the other: it is not 0 if 0 would give the relation another truth."""
    limit = function.constant_value(b)
    if limit is not None and relation(0, limit) != truth:
        yield a
    limit = function.constant_value(a)
    if limit is not None and relation(limit, 0) != truth:
        yield b
