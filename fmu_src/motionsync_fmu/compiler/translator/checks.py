"""Which checks the C can omit: an index is checked once for all elements that have it, and so is a divisor.

The statements of a function are visited in their order, with the facts that hold at each: the indices and divisors that
have been checked, and whose names and fields nothing has changed since; the divisors that are not 0 by a condition.
"""

import ast
from dataclasses import dataclass, field
from math import isinf

from ..subset.effects import Effects, FieldSet
from ..subset.function_rules import without_docstring
from ..subset.package import CheckedFunction
from .bounds import UNBOUNDED, IntegerBounds
from .conditions import nonzero_values

DIVISIONS = (ast.Div, ast.FloorDiv, ast.Mod)
SIMPLE = (ast.Name, ast.Attribute, ast.Constant, ast.BinOp, ast.UnaryOp, ast.expr_context, ast.operator, ast.unaryop)


@dataclass(eq=False)
class SharedIndexCheck:
    """An index of lists of one length that is checked before a statement, for all its uses."""

    statement: ast.stmt
    uses: list[ast.expr]
    length: int


@dataclass
class Facts:
    """What is certain at a point of the text. An expression is named by its dump.

    Attributes:
        indices: those that have been checked, for lists of a length.
        divisors: those that are not 0 (True), and those for which `failed` is set if they are (False).
    """

    indices: dict[tuple[str, int], SharedIndexCheck] = field(default_factory=dict)
    divisors: dict[str, bool] = field(default_factory=dict)

    def copy(self) -> "Facts":
        return Facts(dict(self.indices), dict(self.divisors))

    def meet(self, other: "Facts") -> "Facts":
        """The facts where two paths join."""
        indices = {key: check for key, check in self.indices.items() if other.indices.get(key) is check}
        both = self.divisors.keys() & other.divisors.keys()
        return Facts(indices, {key: self.divisors[key] and other.divisors[key] for key in both})


class Checks:
    """The checks of one function.

    Attributes:
        unneeded: the elements and divisions that need no check.
        indices: the part of any other element's index that is checked, and the length that it has to be below.
        shared: the indices that are checked once for several uses.
        unbounded: the loops that no constants end; after a failure they might not end.
    """

    def __init__(self, effects: Effects, function: CheckedFunction) -> None:
        self.effects, self.function = effects, function
        self.indices: dict[ast.Subscript, tuple[ast.expr, int]] = {}
        self.unbounded: set[ast.stmt] = set()
        self.unneeded: set[ast.AST] = set()
        self.operands: dict[str, tuple[set[str], FieldSet]] = {}
        self.integers = IntegerBounds(effects, function)
        self.index_checks: list[SharedIndexCheck] = []
        self.facts = Facts()
        self.visit_block(without_docstring(function.node.body))
        self.shared = [check for check in self.index_checks if len(check.uses) > 1]

    # --- statements: each updates the facts, and returns whether the point after it is ever reached ---

    def visit_block(self, body: list[ast.stmt]) -> bool:
        reached = True
        for statement in body:
            reached &= self.visit_statement(statement)
        return reached

    def visit_statement(self, s: ast.stmt) -> bool:
        reached = True
        match s:
            case ast.If():
                reached = self.visit_if(s, s)
            case ast.While() | ast.For():
                self.visit_loop(s)
            case ast.Match():
                reached = self.visit_match(s)
            case ast.Return() | ast.Break() | ast.Continue():
                self.visit(s, s)
                reached = False
            case _:
                self.visit(s, s)
                self.invalidate(s)
        return reached

    def visit_if(self, s: ast.If, at: ast.stmt | None) -> bool:
        """Visit an `if`; before an `elif` no index can be checked."""
        self.visit(s.test, at)
        self.invalidate(s.test)
        before = self.facts
        ends = [self.visit_branch(before, s.body, s.test, True)]
        match s.orelse:
            case [ast.If() as other] if other.col_offset == s.col_offset:
                self.facts = before.copy()
                self.assume(s.test, False)
                ends.append(self.facts if self.visit_if(other, None) else None)
            case _:
                ends.append(self.visit_branch(before, s.orelse, s.test, False))
        return self.join_branches(before, ends)

    def visit_branch(self, before: Facts, body: list[ast.stmt], test: ast.expr | None, truth: bool) -> Facts | None:
        """Visit a branch, whose condition is true or false: the facts at its end; None if that is never reached."""
        self.facts = before.copy()
        if test:
            self.assume(test, truth)
        return self.facts if self.visit_block(body) else None

    def join_branches(self, before: Facts, ends: list[Facts | None]) -> bool:
        """Join branches that end; an index that was checked in one of them is out of scope."""
        reached = [facts for facts in ends if facts]
        self.facts = reached[0] if reached else before
        for facts in reached[1:]:
            self.facts = self.facts.meet(facts)
        self.facts = Facts(self.facts.meet(before).indices, self.facts.divisors)
        return bool(reached)

    def visit_loop(self, s: ast.While | ast.For) -> None:
        """Visit a loop: nothing is certain of what it changes, neither in it nor after it."""
        name, (low, high) = "", UNBOUNDED
        if isinstance(s, ast.For):
            assert isinstance(s.target, ast.Name)
            self.visit(s.iter, s)
            name = s.target.id
            self.integers.loops[name] = low, high = self.integers.loop_bounds(s)
        self.invalidate(s)
        before = self.facts.copy()
        if isinstance(s, ast.While):
            self.visit(s.test, None)
            self.assume(s.test, True)
        self.visit_block(s.body)
        self.facts = before
        self.integers.loops.pop(name, None)
        if isinf(high - low):
            self.unbounded.add(s)

    def visit_match(self, s: ast.Match) -> bool:
        self.visit(s.subject, s)
        self.invalidate(s.subject)
        before, ends, complete = self.facts, list[Facts | None](), False
        for case in s.cases:
            self.facts = before
            if case.guard:
                self.facts = before.copy()
                self.visit(case.guard, None)
            ends.append(self.visit_branch(self.facts, case.body, case.guard, True))
            complete |= case.guard is None and isinstance(case.pattern, ast.MatchAs)
        return self.join_branches(before, ends if complete else [*ends, before])

    # --- expressions ---

    def visit(self, node: ast.AST, at: ast.stmt | None) -> None:
        """Visit an expression or a simple statement, and determine its checks.

        `at`: the statement that computes it in any case; None if that depends on a condition."""
        match node:
            case ast.BoolOp(op=op, values=[first, *others]):
                self.visit(first, at)
                self.visit_conditional(first, others, isinstance(op, ast.And))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                self.visit(test, at)
                for part, truth in ((body, True), (orelse, False)):
                    self.visit_conditional(test, [part], truth)
            case ast.Compare(left=left, comparators=[right, *others]):
                self.visit(left, at)
                self.visit(right, at)
                for other in others:
                    self.visit_conditional(right, [other], None)
            case _:
                for inner in ast.iter_child_nodes(node):
                    self.visit(inner, at)
                self.add_check(node, at)

    def visit_conditional(self, first: ast.expr, others: list[ast.expr], truth: bool | None) -> None:
        """Visit what is computed after another expression, if that has this truth."""
        after = self.facts.copy()
        for before, part in zip([first, *others], others, strict=False):
            if truth is None:
                self.invalidate(before)
            else:
                self.assume(before, truth)
            self.visit(part, None)
        self.facts = after

    def add_check(self, node: ast.AST, at: ast.stmt | None) -> None:
        match node:
            case ast.Subscript(value=values, slice=index) if node in self.function.kinds:
                length = self.effects.list_length(self.function, values)
                low, high = self.integers.bounds(index)
                if 0 <= low <= high < length:
                    self.unneeded.add(node)
                else:
                    part, length = self.indices[node] = self.decisive_part(index, length)
                    self.add_index(part, length, at)
            case ast.BinOp(op=op, right=right) if isinstance(op, DIVISIONS):
                self.add_divisor(node, right, self.function.kinds[node] == "float")
            case ast.AugAssign(op=op, target=target, value=right) if isinstance(op, DIVISIONS):
                self.add_divisor(node, right, self.function.kinds[target] == "float")

    def add_index(self, index: ast.expr, length: int, at: ast.stmt | None) -> None:
        key = self.key_of(index), length
        if check := self.facts.indices.get(key):
            check.uses.append(index)
        elif at and self.is_simple(index):
            check = self.facts.indices[key] = SharedIndexCheck(at, [index], length)
            self.index_checks.append(check)

    def decisive_part(self, index: ast.expr, length: int) -> tuple[ast.expr, int]:
        """The part of an index that decides whether it is inside a list, and the length that this part is to be below.

        Of `6 * i + n`, 0 <= n < 6, in a list of 48, it is i in a list of 8: so it is for an i below 0, too."""
        first, parts = index, []
        while isinstance(first, ast.BinOp) and isinstance(first.op, ast.Add):
            parts.append(self.integers.bounds(first.right))
            first = first.left
        match first:
            case ast.BinOp(left=left, op=ast.Mult(), right=row):
                size = self.function.constant_value(left)
                lowest, highest = sum(low for low, _ in parts), sum(high for _, high in parts)
                if isinstance(size, int) and size > 0 and length % size == 0 and 0 <= lowest <= highest < size:
                    return row, length // size
        return index, length

    def add_divisor(self, node: ast.AST, divisor: ast.expr, is_float: bool) -> None:
        """Note a divisor. An integer is checked again: C must not divide by it if the first check has failed."""
        key = self.key_of(divisor)
        if (
            self.function.constant_value(divisor)
            or self.facts.divisors.get(key)
            or (is_float and key in self.facts.divisors)
        ):
            self.unneeded.add(node)
        elif is_float and self.is_simple(divisor):
            self.facts.divisors[key] = False

    # --- facts ---

    def key_of(self, node: ast.expr) -> str:
        """The dump of an expression; the names and fields that it reads are stored."""
        key = ast.dump(node)
        if key not in self.operands:
            names = {n.id for n in self.function.walk(node) if isinstance(n, ast.Name)}
            self.operands[key] = names, self.effects.accessed_fields(self.function, node)[0]
        return key

    def is_simple(self, node: ast.expr) -> bool:
        """Whether an expression has neither calls nor elements of lists, nor what might raise itself."""
        return all(
            isinstance(n, SIMPLE) and not (isinstance(n, ast.BinOp) and isinstance(n.op, DIVISIONS))
            for n in self.function.walk(node)
        )

    def invalidate(self, node: ast.AST) -> None:
        """Drop the facts about what an expression or statement changes."""
        assigned = self.function.stored_names(node)
        written = self.effects.written_fields(self.function, node)

        def is_unchanged(key: str) -> bool:
            names, fields = self.operands[key]
            return names.isdisjoint(assigned) and fields.isdisjoint(written)

        self.facts.indices = {key: check for key, check in self.facts.indices.items() if is_unchanged(key[0])}
        self.facts.divisors = {key: certain for key, certain in self.facts.divisors.items() if is_unchanged(key)}

    def assume(self, test: ast.expr, truth: bool) -> None:
        """Add what is not 0 where a condition is true, or false, unless a call in the condition changes it."""
        for value in nonzero_values(self.function, test, truth):
            if self.is_simple(value):
                self.facts.divisors[self.key_of(value)] = True
        self.invalidate(test)
