"""The rules for expressions whose order or number of evaluations differs between C and Python.

They need the effects of all functions of a package; so they are applied to a package that keeps all other rules.
"""

import ast
from collections.abc import Sequence

from .effects import Effects
from .expression_rules import Violation, in_order
from .package import CheckedFunction

ORDER = "one part of this changes what another one reads or changes: write two statements"
CHAIN = "what is in the middle of a chain changes nothing: compute it before"
SEARCH = "`in` searches plain values, for one that is computed without a change: compute them before"
GUARD = "a guard changes nothing"
MATCHED = "where a case has a guard, or ends a loop around the match, no call is matched: compute it before"
LENGTHS = "all calls give a function lists of the same length"
RECURSION = "a function does not call itself, nor through others: write a loop"
TARGETS = (
    "several targets are assigned together only if they are different locals and fields, and the value changes none"
)


class EvaluationOrderRules:
    """The rules for one function."""

    def __init__(self, effects: Effects, function: CheckedFunction, violations: list[Violation]) -> None:
        self.effects, self.function, self.violations = effects, function, violations

    def check(self) -> None:
        for node in self.function.walk(self.function.node):
            if isinstance(node, ast.expr | ast.stmt):
                self.check_node(node)

    def flag(self, node: ast.AST, rule: str) -> None:
        self.violations.append(Violation(self.function.file, getattr(node, "lineno", 1), rule))

    def check_node(self, node: ast.AST) -> None:
        match node:
            case ast.BinOp(left=a, right=b) | ast.AugAssign(target=a, value=b):
                self.check_independence(node, [a, b])
            case ast.Call(args=parts) | ast.Return(value=ast.Tuple(elts=parts)):
                self.check_independence(node, parts)
            case ast.Assign(targets=[ast.Subscript(slice=index)], value=value):
                self.check_independence(node, [index, value])
            case ast.Assign(targets=[_, _, *_] as targets, value=value):
                again = len({ast.dump(target) for target in targets}) < len(targets)
                if again or any(isinstance(t, ast.Subscript) for t in targets) or self.writes(value):
                    self.flag(node, TARGETS)
            case ast.Compare():
                self.check_comparison(node)
            case ast.Match(subject=subject, cases=cases):
                self.check_match(subject, cases)

    def writes(self, node: ast.AST) -> bool:
        return self.has_call(node) and bool(self.effects.accessed_fields(self.function, node)[1])

    def has_call(self, node: ast.AST) -> bool:
        return any(isinstance(n, ast.Call) for n in self.function.walk(node))

    def check_independence(self, node: ast.AST, parts: Sequence[ast.expr]) -> None:
        """C leaves open which of these comes first."""
        if not any(map(self.has_call, parts)):
            return  # nothing else writes
        accesses = [self.effects.accessed_fields(self.function, part) for part in parts]
        for i, (_, writes) in enumerate(accesses):
            if any(writes & (reads | others) for k, (reads, others) in enumerate(accesses) if k != i):
                self.flag(node, ORDER)
                return

    def check_comparison(self, node: ast.Compare) -> None:
        """In C a chain is several comparisons, and so is a search."""
        operands = [node.left, *node.comparators]
        self.check_independence(node, operands)
        if any(self.writes(middle) for middle in operands[1:-1]):
            self.flag(node, CHAIN)
        for left, op, right in zip(operands, node.ops, operands[1:], strict=False):
            if isinstance(op, ast.In | ast.NotIn):
                computed = (ast.Call, ast.BinOp, ast.Subscript)
                if self.writes(left) or any(isinstance(n, computed) for n in self.function.walk(right)):
                    self.flag(node, SEARCH)

    def check_match(self, subject: ast.expr, cases: list[ast.match_case]) -> None:
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


def violations(effects: Effects) -> list[Violation]:
    """The violations in a package that keeps all other rules."""
    violations = [Violation(function.file, call.lineno, LENGTHS) for function, call in effects.length_conflicts]
    for function in effects.by_function:
        if function in effects.reachable_from(effects.callees(function)):
            violations.append(Violation(function.file, function.node.lineno, RECURSION))
        EvaluationOrderRules(effects, function, violations).check()
    return in_order(violations)
