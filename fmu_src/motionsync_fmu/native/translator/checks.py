"""Which checks the C can do without: an index is checked once for all places that have it, and so is a divisor.

The statements of a function are read in their order, with what is known at each: the indices and divisors that have
been checked, and whose names and fields nothing has changed since; the divisors that a condition has found not to be 0.
"""

import ast
from dataclasses import dataclass, field
from math import isinf

from ..subset.effects import Effects, Places
from ..subset.functions import without_docstring
from ..subset.package import Reading
from .bounds import EVERYWHERE, Integers
from .conditions import not_zero

DIVISIONS = (ast.Div, ast.FloorDiv, ast.Mod)
PLAIN = (ast.Name, ast.Attribute, ast.Constant, ast.BinOp, ast.UnaryOp, ast.expr_context, ast.operator, ast.unaryop)


@dataclass(eq=False)
class KeptIndex:
    """An index of lists of one length that is checked before a statement, for all places that have it."""

    statement: ast.stmt
    places: list[ast.expr]
    length: int


@dataclass
class Known:
    """What is known at a place of the text. An expression is named by its dump.

    Attributes:
        indices: those that have been checked, for lists of a length.
        divisors: those that are not 0 (True), and those of which `failed` tells if they are (False).
    """

    indices: dict[tuple[str, int], KeptIndex] = field(default_factory=dict)
    divisors: dict[str, bool] = field(default_factory=dict)

    def copy(self) -> "Known":
        return Known(dict(self.indices), dict(self.divisors))

    def meet(self, other: "Known") -> "Known":
        """What is known where two paths join."""
        indices = {key: kept for key, kept in self.indices.items() if other.indices.get(key) is kept}
        both = self.divisors.keys() & other.divisors.keys()
        return Known(indices, {key: self.divisors[key] and other.divisors[key] for key in both})


class Checks:
    """The checks of one function.

    Attributes:
        needless: the elements and divisions that need no check.
        indices: what is checked of the index of any other element, and the length inside which that has to be.
        kept: the indices that are checked once for several places.
        endless: the loops that no constants end; after a failure they might go on for ever.
    """

    def __init__(self, effects: Effects, reading: Reading) -> None:
        self.effects, self.reading = effects, reading
        self.indices: dict[ast.Subscript, tuple[ast.expr, int]] = {}
        self.endless: set[ast.stmt] = set()
        self.needless: set[ast.AST] = set()
        self.operands: dict[str, tuple[set[str], Places]] = {}
        self.integers = Integers(effects, reading)
        self.found: list[KeptIndex] = []
        self.known = Known()
        self.block(without_docstring(reading.node.body))
        self.kept = [kept for kept in self.found if len(kept.places) > 1]

    # --- statements: each leaves what is known after it, and answers whether that is ever reached ---

    def block(self, body: list[ast.stmt]) -> bool:
        reached = True
        for statement in body:
            reached &= self.statement(statement)
        return reached

    def statement(self, s: ast.stmt) -> bool:
        reached = True
        match s:
            case ast.If():
                reached = self.choice(s, s)
            case ast.While() | ast.For():
                self.loop(s)
            case ast.Match():
                reached = self.match(s)
            case ast.Return() | ast.Break() | ast.Continue():
                self.look(s, s)
                reached = False
            case _:
                self.look(s, s)
                self.forget(s)
        return reached

    def choice(self, s: ast.If, at: ast.stmt | None) -> bool:
        """An `if`; before an `elif` no index can be checked."""
        self.look(s.test, at)
        self.forget(s.test)
        before = self.known
        ends = [self.branch(before, s.body, s.test, True)]
        match s.orelse:
            case [ast.If() as other] if other.col_offset == s.col_offset:
                self.known = before.copy()
                self.learn(s.test, False)
                ends.append(self.known if self.choice(other, None) else None)
            case _:
                ends.append(self.branch(before, s.orelse, s.test, False))
        return self.join(before, ends)

    def branch(self, before: Known, body: list[ast.stmt], test: ast.expr | None, truth: bool) -> Known | None:
        """What is known after a branch, whose condition is true or false; None if its end is never reached."""
        self.known = before.copy()
        if test:
            self.learn(test, truth)
        return self.known if self.block(body) else None

    def join(self, before: Known, ends: list[Known | None]) -> bool:
        """Several branches end; an index that one of them keeps is out of sight."""
        reached = [known for known in ends if known]
        self.known = reached[0] if reached else before
        for known in reached[1:]:
            self.known = self.known.meet(known)
        self.known = Known(self.known.meet(before).indices, self.known.divisors)
        return bool(reached)

    def loop(self, s: ast.While | ast.For) -> None:
        """What the loop changes is not known in it, nor after it."""
        name, (low, high) = "", EVERYWHERE
        if isinstance(s, ast.For):
            assert isinstance(s.target, ast.Name)
            self.look(s.iter, s)
            name = s.target.id
            self.integers.loops[name] = low, high = self.integers.of_loop(s)
        self.forget(s)
        before = self.known.copy()
        if isinstance(s, ast.While):
            self.look(s.test, None)
            self.learn(s.test, True)
        self.block(s.body)
        self.known = before
        self.integers.loops.pop(name, None)
        if isinf(high - low):
            self.endless.add(s)

    def match(self, s: ast.Match) -> bool:
        self.look(s.subject, s)
        self.forget(s.subject)
        before, ends, complete = self.known, list[Known | None](), False
        for case in s.cases:
            self.known = before
            if case.guard:
                self.known = before.copy()
                self.look(case.guard, None)
            ends.append(self.branch(self.known, case.body, case.guard, True))
            complete |= case.guard is None and isinstance(case.pattern, ast.MatchAs)
        return self.join(before, ends if complete else [*ends, before])

    # --- expressions ---

    def look(self, node: ast.AST, at: ast.stmt | None) -> None:
        """Find what is checked in an expression, or in a simple statement.

        `at`: the statement that computes it in any case; None if it is computed sometimes only."""
        match node:
            case ast.BoolOp(op=op, values=[first, *others]):
                self.look(first, at)
                self.sometimes(first, others, isinstance(op, ast.And))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                self.look(test, at)
                for part, truth in ((body, True), (orelse, False)):
                    self.sometimes(test, [part], truth)
            case ast.Compare(left=left, comparators=[right, *others]):
                self.look(left, at)
                self.look(right, at)
                for other in others:
                    self.sometimes(right, [other], None)
            case _:
                for inner in ast.iter_child_nodes(node):
                    self.look(inner, at)
                self.check(node, at)

    def sometimes(self, first: ast.expr, others: list[ast.expr], truth: bool | None) -> None:
        """Look at what is computed after another expression, if that has this truth."""
        after = self.known.copy()
        for before, part in zip([first, *others], others, strict=False):
            if truth is None:
                self.forget(before)
            else:
                self.learn(before, truth)
            self.look(part, None)
        self.known = after

    def check(self, node: ast.AST, at: ast.stmt | None) -> None:
        match node:
            case ast.Subscript(value=values, slice=index) if node in self.reading.kinds:
                length = self.effects.length(self.reading, values)
                low, high = self.integers.bounds(index)
                if 0 <= low <= high < length:
                    self.needless.add(node)
                else:
                    part, length = self.indices[node] = self.row(index, length)
                    self.index(part, length, at)
            case ast.BinOp(op=op, right=right) if isinstance(op, DIVISIONS):
                self.divisor(node, right, self.reading.kinds[node] == "float")
            case ast.AugAssign(op=op, target=target, value=right) if isinstance(op, DIVISIONS):
                self.divisor(node, right, self.reading.kinds[target] == "float")

    def index(self, index: ast.expr, length: int, at: ast.stmt | None) -> None:
        key = self.name(index), length
        if kept := self.known.indices.get(key):
            kept.places.append(index)
        elif at and self.plain(index):
            kept = self.known.indices[key] = KeptIndex(at, [index], length)
            self.found.append(kept)

    def row(self, index: ast.expr, length: int) -> tuple[ast.expr, int]:
        """What decides whether an index is inside a list.

        Of `6 * i + n`, 0 <= n < 6, in a list of 48, it is i in a list of 8: so it is for an i below 0, too."""
        first, parts = index, []
        while isinstance(first, ast.BinOp) and isinstance(first.op, ast.Add):
            parts.append(self.integers.bounds(first.right))
            first = first.left
        match first:
            case ast.BinOp(left=left, op=ast.Mult(), right=row):
                size = self.reading.number(left)
                low, high = sum(least for least, _ in parts), sum(greatest for _, greatest in parts)
                if isinstance(size, int) and size > 0 and length % size == 0 and 0 <= low <= high < size:
                    return row, length // size
        return index, length

    def divisor(self, node: ast.AST, divisor: ast.expr, is_float: bool) -> None:
        """An integer that has been checked is checked again: it may be 0, and C must not divide by it."""
        key = self.name(divisor)
        if self.reading.number(divisor) or self.known.divisors.get(key) or (is_float and key in self.known.divisors):
            self.needless.add(node)
        elif is_float and self.plain(divisor):
            self.known.divisors[key] = False

    # --- what is known ---

    def name(self, node: ast.expr) -> str:
        """The dump of an expression; what it reads is kept."""
        key = ast.dump(node)
        if key not in self.operands:
            names = {n.id for n in self.reading.walk(node) if isinstance(n, ast.Name)}
            self.operands[key] = names, self.effects.touched(self.reading, node)[0]
        return key

    def plain(self, node: ast.expr) -> bool:
        """Whether an expression has neither calls nor elements of lists, nor what might raise itself."""
        return all(
            isinstance(n, PLAIN) and not (isinstance(n, ast.BinOp) and isinstance(n.op, DIVISIONS))
            for n in self.reading.walk(node)
        )

    def forget(self, node: ast.AST) -> None:
        """What an expression or statement changes is not known any more."""
        stored = {n.id for n in self.reading.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        written = self.effects.written(self.reading, node)

        def holds(key: str) -> bool:
            names, places = self.operands[key]
            return not (names & stored or places & written)

        self.known.indices = {key: kept for key, kept in self.known.indices.items() if holds(key[0])}
        self.known.divisors = {key: certain for key, certain in self.known.divisors.items() if holds(key)}

    def learn(self, test: ast.expr, truth: bool) -> None:
        """A condition is true or false: what is then not 0, unless a call in the condition changes it."""
        for value in not_zero(self.reading, test, truth):
            if self.plain(value):
                self.known.divisors[self.name(value)] = True
        self.forget(test)
