"""The rules for what is evaluated in another order, more often or less often in C than in Python.

They need the effects of all functions of a package; so they are applied to a package that keeps all other rules.
"""

import ast
from collections.abc import Sequence

from .effects import Effects
from .expressions import Violation
from .package import Reading

ORDER = "one part of this changes what another one reads or changes: write two statements"
CHAIN = "what stands in the middle of a chain changes nothing: compute it before"
SEARCH = "`in` searches plain values, for one that is computed without a change: compute them before"
GUARD = "a guard changes nothing"
MATCHED = "where a case has a guard, or ends a loop around the match, no call is matched: compute it before"
LENGTHS = "all calls give a function lists of the same length"
RECURSION = "a function does not call itself, nor by others: write a loop"
TARGETS = (
    "several places are assigned together only if they are different locals and fields, and the value changes none"
)


class Order:
    """The rules for one function."""

    def __init__(self, effects: Effects, reading: Reading, violations: list[Violation]) -> None:
        self.effects, self.reading, self.violations = effects, reading, violations

    def check(self) -> None:
        for node in self.reading.walk(self.reading.node):
            if isinstance(node, ast.expr | ast.stmt):
                self.node(node)

    def flag(self, node: ast.AST, rule: str) -> None:
        self.violations.append(Violation(self.reading.file, getattr(node, "lineno", 1), rule))

    def node(self, node: ast.AST) -> None:
        match node:
            case ast.BinOp(left=a, right=b) | ast.AugAssign(target=a, value=b):
                self.apart(node, [a, b])
            case ast.Call(args=parts) | ast.Return(value=ast.Tuple(elts=parts)):
                self.apart(node, parts)
            case ast.Assign(targets=[ast.Subscript(slice=index)], value=value):
                self.apart(node, [index, value])
            case ast.Assign(targets=[_, _, *_] as targets, value=value):
                again = len({ast.dump(target) for target in targets}) < len(targets)
                if again or any(isinstance(t, ast.Subscript) for t in targets) or self.writes(value):
                    self.flag(node, TARGETS)
            case ast.Compare():
                self.compare(node)
            case ast.Match(subject=subject, cases=cases):
                self.match(subject, cases)

    def writes(self, node: ast.AST) -> bool:
        return self.has_call(node) and bool(self.effects.touched(self.reading, node)[1])

    def has_call(self, node: ast.AST) -> bool:
        return any(isinstance(n, ast.Call) for n in self.reading.walk(node))

    def apart(self, node: ast.AST, parts: Sequence[ast.expr]) -> None:
        """C leaves open which of these comes first."""
        if not any(map(self.has_call, parts)):
            return  # nothing else writes
        found = [self.effects.touched(self.reading, part) for part in parts]
        for i, (_, writes) in enumerate(found):
            if any(writes & (reads | others) for k, (reads, others) in enumerate(found) if k != i):
                self.flag(node, ORDER)
                return

    def compare(self, node: ast.Compare) -> None:
        """In C a chain is several comparisons, and so is a search."""
        operands = [node.left, *node.comparators]
        self.apart(node, operands)
        if any(self.writes(middle) for middle in operands[1:-1]):
            self.flag(node, CHAIN)
        for left, op, right in zip(operands, node.ops, operands[1:], strict=False):
            if isinstance(op, ast.In | ast.NotIn):
                computed = (ast.Call, ast.BinOp, ast.Subscript)
                if self.writes(left) or any(isinstance(n, computed) for n in self.reading.walk(right)):
                    self.flag(node, SEARCH)

    def match(self, subject: ast.expr, cases: list[ast.match_case]) -> None:
        for case in cases:
            if case.guard is not None and self.writes(case.guard):
                self.flag(case.guard, GUARD)
        if is_chain(cases) and self.has_call(subject):
            self.flag(subject, MATCHED)


def is_chain(cases: list[ast.match_case]) -> bool:
    """Whether a match cannot be a switch: a case has a guard, or a break of the loop around the match."""
    return any(case.guard is not None or leaves_loop(case.body) for case in cases)


def leaves_loop(body: list[ast.stmt]) -> bool:
    """Whether there is a break of a loop around these statements."""
    inner = [part for s in body if isinstance(s, ast.If) for part in (s.body, s.orelse)]
    inner += [case.body for s in body if isinstance(s, ast.Match) for case in s.cases]
    return any(isinstance(s, ast.Break) for s in body) or any(map(leaves_loop, inner))


def calls_itself(effects: Effects, reading: Reading) -> bool:
    """Whether a function calls itself, directly or by others."""
    found: set[Reading] = set()
    wanted = [reading]
    while wanted:
        wanted = [callee for one in wanted for callee in effects.callees(one) if callee not in found]
        found.update(wanted)
    return reading in found


def violations(effects: Effects) -> list[Violation]:
    """The violations in a package that keeps all other rules."""
    found = [Violation(reading.file, call.lineno, LENGTHS) for reading, call in effects.lists]
    for reading in effects.of:
        if calls_itself(effects, reading):
            found.append(Violation(reading.file, reading.node.lineno, RECURSION))
        Order(effects, reading, found).check()
    return sorted(dict.fromkeys(found), key=lambda violation: (violation.file, violation.line))
