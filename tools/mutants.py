"""Finds the small changes of a source file that its tests should notice: one changed operator, number, or statement.

| operator | what it changes |
| --- | --- |
| arithmetic | `+` and `-`, `*` and `/` become each other; `//` and `%` become `*` |
| comparison | the limit of an order moves between in and out; equality, identity and membership become their opposite |
| constant | a number grows by 1, `True` and `False` become each other |
| logic | `and` and `or` become each other; a `not` goes |
| removed statement | a call, an augmented assignment or an assignment to an attribute or an item goes |
| swapped branch | the two branches of an `if` change places |

Comments and layout stay as they are, since the translator reads comments.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import Any

ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "//": "*", "%": "*"}
COMPARISON = {
    **{"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    **{"is": "is not", "is not": "is", "in": "not in", "not in": "in"},
}
LOGIC = {"and": "or", "or": "and", "&&": "||", "||": "&&"}
GAP = re.compile(r"(?:\s|\\|\(|\)|#[^\n]*)+")  # what may be between an operand and its operator
C_TOKEN = re.compile(
    r"(?P<skipped>/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|^[ \t]*\#(?:\\\n|[^\n])*)"
    r"|(?P<number>\b\d+\.?\d*(?:[eE][+-]?\d+)?\b)"
    r"|(?P<call>^[ \t]+[A-Za-z_]\w*\([^;{}]*\);[ \t]*$)|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<operator>->|\+\+|--|<<|>>|&&|\|\||[-+*/%<>=!]=|[-+*/%<>])",
    re.S | re.M,
)


@dataclass(frozen=True)
class Mutant:
    """One change: the text from `start` to `end` (characters) of the file becomes `replacement`."""

    path: str  # in the repository
    line: int
    lines: tuple[int, int]  # the first and the last line of its statement, without the statements in it
    operator: str
    start: int
    end: int
    original: str
    replacement: str
    name: str = ""  # the same in a later state of the file, unless its line has changed

    def apply(self, source: str) -> str:
        """The source with the change."""
        if source[self.start : self.end] != self.original:
            raise ValueError(f"{self.path}, line {self.line}: the source is not the one that the mutant was made from")
        return source[: self.start] + self.replacement + source[self.end :]


def find_mutants(root: Path, path: str) -> list[Mutant]:
    """All mutants of a file, Python or C; each of the Python ones can be compiled."""
    source = (root / path).read_text("utf-8")
    finder = PythonFinder(path, source).find() if path.endswith(".py") else find_in_c(path, source)
    mutants = sorted(finder, key=lambda mutant: (mutant.start, mutant.end, mutant.replacement))
    return list(name_mutants(mutants, source.split("\n")))


def name_mutants(mutants: list[Mutant], lines: list[str]) -> Iterator[Mutant]:
    """The mutants with names of file, change and text of the line; those that are alike are numbered."""
    alike: Counter[str] = Counter()
    for mutant in mutants:
        change = f"{mutant.operator}: {mutant.original!r} -> {mutant.replacement!r}"
        name = f"{mutant.path}: {change} in {lines[mutant.line - 1].strip()}"
        alike[name] += 1
        yield replace(mutant, name=f"{name} (no. {alike[name]})")


class PythonFinder:
    """Finds the mutants of a Python file by its syntax tree."""

    def __init__(self, path: str, source: str) -> None:
        self.path, self.source = path, source
        self.lines = 1, 1  # of the statement that is visited
        self.texts = source.splitlines(keepends=True)
        self.starts = list(accumulate(map(len, self.texts), initial=0))

    def find(self) -> Iterator[Mutant]:
        yield from self.visit(ast.parse(self.source))

    def visit(self, node: ast.AST) -> Iterator[Mutant]:
        """The mutants of a node and of what is in it, but for annotations and docstrings, which nothing runs."""
        if isinstance(node, ast.stmt):
            first_inner = next((value[0].lineno - 1 for name, value in ast.iter_fields(node) if name == "body"), None)
            self.lines = node.lineno, max(first_inner or node.end_lineno or 0, node.lineno)
        yield from self.mutate(node)
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_params") or is_type_checking(node):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from self.visit(child)

    def mutate(self, node: ast.AST) -> Iterator[Mutant]:
        match node:
            case ast.BinOp(left=ast.Constant(value=str())) | ast.BinOp(right=ast.Constant(value=str())):
                pass
            case ast.BinOp(left, _, right):
                yield from self.between(left, right, "arithmetic", ARITHMETIC)
            case ast.Compare(left, _, comparators):
                for before, after in zip([left, *comparators], comparators, strict=False):
                    yield from self.between(before, after, "comparison", COMPARISON)
            case ast.BoolOp(_, values):
                yield from self.between(values[0], values[1], "logic", LOGIC)
            case ast.UnaryOp(ast.Not(), operand):
                yield self.mutant(node, "logic", f"({self.text(operand)})")
            case ast.Constant(bool() as value):
                yield self.mutant(node, "constant", str(not value))
            case ast.Constant(int() | float()):
                yield self.mutant(node, "constant", f"({self.text(node)} + 1)")
            case ast.AugAssign() | ast.Assign(targets=[ast.Attribute() | ast.Subscript()]) | ast.Expr(value=ast.Call()):
                yield self.mutant(node, "removed statement", "pass")
            case ast.If(test, _, [_, *_]) | ast.IfExp(test):
                yield self.mutant(test, "swapped branch", f"(not ({self.text(test)}))")

    def between(self, left: ast.AST, right: ast.AST, operator: str, changes: dict[str, str]) -> Iterator[Mutant]:
        """The mutant of the operator between two operands."""
        start, stop = self.span(left)[1], self.span(right)[0]
        gap = GAP.match(self.source, start, stop)
        start = gap.end() if gap else start
        original = " ".join(GAP.sub(" ", self.source[start:stop]).split())
        token = next((t for t in sorted(changes, key=len, reverse=True) if original == t), "")
        if token and self.source.startswith(token, start):
            line = self.source.count("\n", 0, start) + 1
            yield Mutant(self.path, line, self.lines, operator, start, start + len(token), token, changes[token])

    def mutant(self, node: ast.AST, operator: str, replacement: str) -> Mutant:
        start, end = self.span(node)
        line = self.source.count("\n", 0, start) + 1
        return Mutant(self.path, line, self.lines, operator, start, end, self.source[start:end], replacement)

    def text(self, node: ast.AST) -> str:
        start, end = self.span(node)
        return self.source[start:end]

    def span(self, node: Any) -> tuple[int, int]:
        """The characters of a node; a syntax tree counts the bytes of a line."""
        return self.offset(node.lineno, node.col_offset), self.offset(node.end_lineno, node.end_col_offset)

    def offset(self, line: int, column: int) -> int:
        return self.starts[line - 1] + len(self.texts[line - 1].encode()[:column].decode())


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def find_in_c(path: str, source: str) -> Iterator[Mutant]:
    """The mutants of a C file by its tokens: operators with a space on either side are binary ones."""
    for match in C_TOKEN.finditer(source):
        text, start = match[0], match.start()
        line = source.count("\n", 0, start) + 1
        changed = None
        match match.lastgroup:
            case "operator" if source[start - 1 : start] == " " and source[match.end() : match.end() + 1] in (
                " ",
                "\n",
            ):
                for operator, changes in (("arithmetic", ARITHMETIC), ("comparison", COMPARISON), ("logic", LOGIC)):
                    if text in changes:
                        changed = operator, changes[text]
            case "number":
                changed = "constant", f"({text} + 1)"
            case "call":
                start += len(text) - len(text.lstrip())
                text = text.strip()
                changed = "removed statement", ";"
        if changed:
            yield Mutant(path, line, (line, line), changed[0], start, start + len(text), text, changed[1])
