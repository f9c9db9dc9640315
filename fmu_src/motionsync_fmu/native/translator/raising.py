"""Where Python might raise: there the C sets `failed`, and each function that may come there has that parameter; so has
each function with a loop that a failure has to end."""

import ast
from collections.abc import Iterator

from ..subset.effects import Effects
from ..subset.package import Reading
from .checks import DIVISIONS, Checks, KeptIndex


class Raising:
    """What might raise, of all functions that a package has."""

    def __init__(self, effects: Effects) -> None:
        self.effects = effects
        self.checks = {reading: Checks(effects, reading) for reading in effects.of}
        self.failing = {
            reading
            for reading, checks in self.checks.items()
            if checks.endless or any(self.may(reading, n) for n in reading.walk(reading.node))
        }
        before = -1
        while before != len(self.failing):
            before = len(self.failing)
            calling = (r for r in effects.of if any(callee in self.failing for callee in effects.callees(r)))
            self.failing |= {*calling}

    def may(self, reading: Reading, node: ast.AST) -> bool:
        """Whether an operation itself might raise, whatever its operands do."""
        match node:
            case ast.BinOp(op=op) | ast.AugAssign(op=op):
                return isinstance(op, DIVISIONS) and node not in self.checks[reading].needless
            case ast.Subscript():
                return node in reading.kinds and node not in self.checks[reading].needless
            case ast.Call(func=func, args=[value, *_]) if reading.callee(node) is None:
                name = name_in_python(reading, func)
                if name == "sqrt":
                    return not never_negative(reading, value)
                return name == "fmod" or (name in ("int", "round", "floor") and reading.kinds[value] == "float")
        return False

    def kept(self, reading: Reading, statement: ast.stmt) -> Iterator[KeptIndex]:
        """The indices that are checked before a statement."""
        return (kept for kept in self.checks[reading].kept if kept.statement is statement)


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
