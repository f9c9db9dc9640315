"""Where Python might raise: there the C sets `failed`, and so has each function that may come there."""

import ast
from collections.abc import Iterator

from ..subset.effects import Effects
from ..subset.package import Reading

DIVISIONS = (ast.Div, ast.FloorDiv, ast.Mod)


class Raising:
    """What might raise, of all functions that a package has."""

    def __init__(self, effects: Effects) -> None:
        self.effects = effects
        self.inside = {node for reading in effects.of for node in certain(effects, reading)}
        self.failing = {
            reading for reading in effects.of if any(self.may(reading, n) for n in reading.walk(reading.node))
        }
        before = -1
        while before != len(self.failing):
            before = len(self.failing)
            calling = (r for r in effects.of if any(callee in self.failing for callee in effects.callees(r)))
            self.failing |= {*calling}

    def may(self, reading: Reading, node: ast.AST) -> bool:
        """Whether an operation itself might raise, whatever its operands do."""
        match node:
            case ast.BinOp(op=op, right=right) | ast.AugAssign(op=op, value=right):
                return isinstance(op, DIVISIONS) and not reading.number(right)
            case ast.Subscript(value=values) if node in reading.kinds and reading.kinds[values] == "list":
                return node not in self.inside
            case ast.Call(func=func, args=[value, *_]) if reading.callee(node) is None:
                name = name_in_python(reading, func)
                if name == "sqrt":
                    return not never_negative(reading, value)
                return name == "fmod" or (name in ("int", "round", "floor") and reading.kinds[value] == "float")
        return False

    def anywhere(self, reading: Reading, node: ast.AST) -> bool:
        """Whether something might raise in an expression or statement."""
        return any(self.may(reading, n) or reading.callee(n) in self.failing for n in reading.walk(node))


def name_in_python(reading: Reading, func: ast.expr) -> str:
    """The name of a function that is none of the package: `sqrt` for math.sqrt, however it was imported."""
    meaning = reading.meaning(func)
    return meaning.rpartition(".")[2] if isinstance(meaning, str) else ast.unparse(func)


def never_negative(reading: Reading, node: ast.expr) -> bool:
    """Whether a value is evidently not below 0, so that its root exists; it may be NaN."""
    match node:
        case ast.Call(func=func, args=parts) if reading.callee(node) is None:
            numbers = [number for part in parts if (number := reading.number(part)) is not None]
            name = name_in_python(reading, func)
            return name == "abs" or (name == "max" and any(number >= 0 for number in numbers))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return ast.dump(left) == ast.dump(right) and not any(isinstance(n, ast.Call) for n in reading.walk(left))
    number = reading.number(node)
    return number is not None and number >= 0


def certain(effects: Effects, reading: Reading) -> Iterator[ast.Subscript]:
    """The elements whose index is inside the list: a constant, or the variable of a loop around it."""
    for node in reading.walk(reading.node):
        match node:
            case ast.Subscript(value=values, slice=index) if node in reading.kinds:
                at = reading.number(index)
                if isinstance(at, int) and 0 <= at < effects.length(reading, values):
                    yield node
            case ast.For(target=ast.Name(id=name), iter=ast.Call(args=limits), body=body):
                first, last = reach(effects, reading, limits)
                for part in (n for s in body for n in reading.walk(s) if isinstance(n, ast.Subscript)):
                    named = isinstance(part.slice, ast.Name) and part.slice.id == name
                    if named and first >= 0 and last < effects.length(reading, part.value):
                        yield part


def reach(effects: Effects, reading: Reading, limits: list[ast.expr]) -> tuple[int, int]:
    """The least and the greatest value of a loop's variable, where constants limit it; else something below 0."""
    numbers = [whole(effects, reading, limit) for limit in limits]
    if None in numbers:
        return -1, -1
    values = range(*(number for number in numbers if number is not None))
    return (min(values), max(values)) if values else (-1, -1)


def whole(effects: Effects, reading: Reading, node: ast.expr) -> int | None:
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "len":
        return effects.length(reading, node.args[0]) or None
    number = reading.number(node)
    if isinstance(node, ast.UnaryOp):
        number = reading.package.number(reading.file, node) if reading.number(node.operand) is not None else None
    return number if isinstance(number, int) else None
