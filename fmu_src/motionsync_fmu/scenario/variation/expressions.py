"""Values that follow from others by an expression: `2*axis.max_velocity`, `min(cuts.length/2, 100)`.

An expression has numbers, names with dots, + - * /, parentheses, and min, max, abs, sqrt. Python's parser reads it,
and nothing of it is executed: each part becomes a function of arrays, or is refused. The numbers have the bits that
Python's own arithmetic gives.
"""

import ast
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from graphlib import CycleError, TopologicalSorter
from typing import Any

import numpy as np

from ...errors import UserError

Array = np.ndarray[Any, np.dtype[Any]]
"""Values of one factor for several runs, shape (runs,): numbers, Booleans or texts."""

Rule = Callable[[Mapping[str, Array]], Array]
"""What a part of an expression is worth, from the values of the names in it."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*(?:\.\w+)*)|(?P<sign>.))"
)
FORM = "an expression has numbers, names, + - * / ( ), min, max, abs and sqrt"
DEEPEST = 200  # parts within parts
OPERATORS: dict[type[ast.AST], Callable[[Array, Array], Array]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
FUNCTIONS: dict[str, tuple[int, Callable[[list[Array]], Array]]] = {  # with the least number of arguments
    "min": (2, lambda values: reduce(lambda a, b: np.where(b < a, b, a), values)),
    "max": (2, lambda values: reduce(lambda a, b: np.where(b > a, b, a), values)),
    "abs": (1, lambda values: np.abs(values[0])),
    "sqrt": (1, lambda values: np.sqrt(values[0])),
}


@dataclass(frozen=True)
class Expression:
    """An expression, read from its text.

    Attributes:
        names: the names in it, each once, in the order of the text.
    """

    text: str
    names: tuple[str, ...]
    _rule: Rule = field(repr=False, compare=False)

    def values(self, given: Mapping[str, Array]) -> Array:
        """What the expression is worth in each run, shape (runs,); `given`: the values of all its names.

        Where a number is divided by 0 or has no square root, the value is infinite or NaN. A name alone has its values
        as they are; in arithmetic they must be numbers.

        Raises:
            UserError: a value in arithmetic is no number.
        """
        with np.errstate(all="ignore"):
            return self._rule(given)


def parse(text: str) -> Expression:
    """The expression in a text.

    Raises:
        UserError: it is none.
    """
    names: list[str] = []
    words: list[str] = []
    for token in TOKEN.finditer(text.strip()):
        name = token["name"]
        called = text.strip()[token.end() :].lstrip().startswith("(")
        if not name or (called and name in FUNCTIONS):
            words.append(token["number"] or name or token["sign"])
            continue
        if called:
            raise UserError(f"{text}: there is no function {name}; there is {', '.join(FUNCTIONS)}")
        names += [name] if name not in names else []
        words.append(f"_{names.index(name)}")  # names with dots, or which are words of Python
    try:
        tree = ast.parse(" ".join(words), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise UserError(f"{text!r} is no expression: {FORM}") from None
    return Expression(text, tuple(names), _Parser(text, names).rule(tree, 0))


@dataclass(frozen=True)
class _Parser:
    """Makes the rules of an expression's parts, or refuses them."""

    text: str
    names: list[str]

    def rule(self, node: ast.expr, depth: int) -> Rule:
        if depth > DEEPEST:
            raise UserError(f"{self.text[:40]}...: is nested too deeply")
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return self._constant(value)
            case ast.Name(id=word) if word.startswith("_"):
                name = self.names[int(word[1:])]
                return lambda given: given[name]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self._number(operand, depth)
                return lambda given: -inner(given)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self._number(operand, depth)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                act, a, b = OPERATORS[type(op)], self._number(left, depth), self._number(right, depth)
                return lambda given: act(a(given), b(given))
            case ast.Call(func=ast.Name(id=word), args=arguments, keywords=[]) if word in FUNCTIONS:
                return self._call(word, arguments, depth)
        raise UserError(f"{self.text!r} is no expression: {FORM}")

    def _constant(self, value: float) -> Rule:
        number = np.float64(value) if abs(value) < 1e308 else np.float64(np.inf)
        if not np.isfinite(number):
            raise UserError(f"{self.text}: {str(value)[:20]} is too great")
        return lambda given: np.asarray(number)

    def _call(self, name: str, arguments: list[ast.expr], depth: int) -> Rule:
        fewest, act = FUNCTIONS[name]
        if len(arguments) < fewest or (fewest == 1 and len(arguments) > 1):
            expected = "one value" if fewest == 1 else "two values or more"
            raise UserError(f"{self.text}: {name} needs {expected}, not {len(arguments)}")
        inner = [self._number(argument, depth) for argument in arguments]
        return lambda given: act([part(given) for part in inner])

    def _number(self, node: ast.expr, depth: int) -> Rule:
        """The rule of a part that must be a number."""
        part, text = self.rule(node, depth + 1), self.text

        def numbers(given: Mapping[str, Array]) -> Array:
            values = part(given)
            if values.dtype.kind not in "fiu":
                raise UserError(f"{text}: {values.flat[0]} is no number, and so cannot be calculated with")
            return values.astype(np.float64)

        return numbers


def sort_by_need(needed: Mapping[str, Iterable[str]]) -> list[str]:
    """The names in such an order that each comes after those that it needs.

    Raises:
        UserError: names need each other in a circle.
    """
    try:
        return list(TopologicalSorter(needed).static_order())
    except CycleError as e:
        raise UserError(f"a value cannot follow from itself: {' from '.join(reversed(e.args[1]))}") from None
