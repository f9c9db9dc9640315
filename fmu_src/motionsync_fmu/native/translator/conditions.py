"""What is not 0 where a condition is true, or where it is false."""

import ast
from collections.abc import Iterator

from ..subset.package import Reading

MIRRORED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.Gt,
    ast.Gt: ast.Lt,
    ast.LtE: ast.GtE,
    ast.GtE: ast.LtE,
    ast.Eq: ast.Eq,
    ast.NotEq: ast.NotEq,
}
OPPOSITE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}


def not_zero(reading: Reading, test: ast.expr, truth: bool) -> Iterator[ast.expr]:
    """The expressions that are not 0 where a condition has this truth; what is not a number is not 0 either."""
    match test:
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield from not_zero(reading, operand, not truth)
        case ast.BoolOp(op=op, values=values) if isinstance(op, ast.And) == truth:
            for value in values:
                yield from not_zero(reading, value, truth)
        case ast.Compare(left=left, ops=[op], comparators=[right]) if not truth:
            yield from compared(reading, left, OPPOSITE.get(type(op)), right)
        case ast.Compare(left=left, ops=ops, comparators=rights) if truth:
            for a, op, b in zip([left, *rights], ops, rights, strict=False):
                yield from compared(reading, a, type(op), b)


def compared(reading: Reading, a: ast.expr, sign: type[ast.cmpop] | None, b: ast.expr) -> Iterator[ast.expr]:
    """Of `a < b` and the like, the one that is compared with a number, if it is not 0 then."""
    for value, relation, limit in ((a, sign, reading.number(b)), (b, sign and MIRRORED.get(sign), reading.number(a))):
        if relation and limit is not None and excludes_zero(relation, limit):
            yield value


def excludes_zero(sign: type[ast.cmpop], limit: float) -> bool:
    return (
        (sign is ast.Gt and limit >= 0)
        or (sign is ast.GtE and limit > 0)
        or (sign is ast.Lt and limit <= 0)
        or (sign is ast.LtE and limit < 0)
        or (sign is ast.Eq and limit != 0)
        or (sign is ast.NotEq and limit == 0)
    )
