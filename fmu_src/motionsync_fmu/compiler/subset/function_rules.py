"""The rules for functions: the signature, the statements, and that every local has a value where it is read."""

import ast
from typing import TypeAlias

from .expression_rules import OBJECT, TUPLE, ExpressionRules, Violation
from .package import SERIES, CheckedFunction, Kind, Meaning, Package

RETURNED = "a float, int, bool or an enumeration"
NOT_PASSED = ("?", "None", *SERIES.values())  # no parameter and no local has these kinds
KINDS = "a float, int, bool, an enumeration, list[float] or a kernel dataclass"
PATTERN = "match and its patterns: an integer or an enumeration member, several joined with `|`, or `_`"

Bound: TypeAlias = frozenset[str] | None  # the locals that have a value; None: this point is never reached


def meet(a: Bound, b: Bound) -> Bound:
    """The locals that have a value where two paths join."""
    if a is None or b is None:
        return b if a is None else a
    return a & b


def without_docstring(body: list[ast.stmt]) -> list[ast.stmt]:
    match body:
        case [ast.Expr(value=ast.Constant(value=str())), *rest]:
            return rest
    return body


class FunctionRules(ExpressionRules):
    """The rules for a function: its signature, its statements, and that every local is bound where it is read.

    `package.functions` then has the function with all kinds that were determined."""

    def __init__(
        self,
        package: Package,
        file: str,
        violations: list[Violation],
        node: ast.FunctionDef,
        owner: ast.ClassDef | None,
    ) -> None:
        super().__init__(package, file, violations)
        self.node, self.owner = node, owner
        self.function = package.functions[node] = CheckedFunction(package, file, node, owner)
        self.kinds = self.function.locals
        self.returns = package.kind(file, node.returns)
        self.loops: list[str] = []  # the loop variables of the enclosing loops
        self.ended: set[str] = set()  # the loop variables of earlier loops
        self.breaks: list[list[Bound]] = []  # for each enclosing loop, what was bound at its breaks

    def check(self) -> None:
        self.check_signature()
        if self.package.header(self.file):
            return
        self.bound: Bound = frozenset(self.kinds)
        self.locals = self.bound.union(self.function.stored_names(self.node))
        self.block(without_docstring(self.node.body))
        if self.bound is not None and self.returns not in ("?", "None"):
            self.flag(self.node, "every path returns a value (a match without `case _` may fall through)")

    def check_signature(self) -> None:
        node, returns = self.node, self.returns
        if node.decorator_list:
            self.flag(node, "no decorators on functions and methods")
        parameters = [argument for argument in ast.walk(node.args) if isinstance(argument, ast.arg)]
        if ast.unparse(node.args) != ", ".join(ast.unparse(argument) for argument in parameters):
            self.flag(node, "parameters are positional: no defaults, *args, **kwargs, `*` or `/`")
        for at, argument in enumerate(parameters):
            kind = self.package.kind(self.file, argument.annotation)
            is_self = at == 0 and argument.arg == "self" and self.owner is not None
            self.kinds[argument.arg] = self.owner if is_self and self.owner else kind
            if not is_self and (kind in NOT_PASSED or isinstance(kind, tuple)):
                self.flag(argument, f"a parameter is {KINDS}")
        parts = returns if isinstance(returns, tuple) else (returns,)
        if "?" in parts:
            self.flag(node, f"a function declares what it returns: {RETURNED}, a tuple of these, or None")
        if any(self.package.is_object(part) for part in parts):
            self.flag(node, OBJECT)

    def visit(self, node: ast.AST) -> Kind:
        kind: Kind = super().visit(node)
        if isinstance(node, ast.expr):
            self.function.kinds[node] = kind
        return kind

    def block(self, body: list[ast.stmt]) -> None:
        for statement in body:
            self.visit(statement)

    def meaning(self, node: ast.expr) -> Meaning:
        root = node.value if isinstance(node, ast.Attribute) else node
        return None if isinstance(root, ast.Name) and root.id in self.locals else super().meaning(node)

    def visit_Name(self, node: ast.Name) -> Kind:
        if node.id not in self.locals:
            return super().visit_Name(node)
        if self.bound is not None and node.id not in self.bound:
            message = f"the loop variable {node.id} is not used after its loop"
            self.flag(node, message if node.id in self.ended else f"{node.id} may be unbound here")
        return self.kinds.get(node.id, "?")

    def bind(self, node: ast.AST, name: str, kind: Kind) -> None:
        if name in self.loops:
            self.flag(node, f"the loop variable {name} is not reassigned")
        before = self.kinds.get(name, kind)
        if self.package.is_object(before) and name in self.kinds:
            self.flag(node, f"{name} names an object, and is assigned once")
        elif before != kind and name != "_" and "?" not in (before, kind):
            self.flag(node, f"{name} has one kind: {self.kind_name(before)} or {self.kind_name(kind)}")
        self.kinds[name] = kind if before == "?" else before
        if isinstance(node, ast.Name):
            self.function.kinds[node] = self.kinds[name]
        self.bound = None if self.bound is None else self.bound | {name}

    @staticmethod
    def kind_name(kind: Kind) -> str:
        return kind.name if isinstance(kind, ast.ClassDef) else str(kind)

    def assign(self, target: ast.expr, kind: Kind) -> None:
        if isinstance(target, ast.Name):
            self.bind(target, target.id, kind)
            return
        target_kind = self.visit(target)
        self.check_conversion(target, kind, target_kind)
        if self.package.is_object(target_kind):
            self.flag(target, "an object or list is never rebound: assign its fields or elements")

    def visit_Assign(self, node: ast.Assign) -> None:
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=parts)], value=ast.Call() as call):
                kinds = self.visit(call)
                for at, part in enumerate(parts):
                    if isinstance(part, ast.Name):
                        self.bind(part, part.id, kinds[at] if isinstance(kinds, tuple) and at < len(kinds) else "?")
                    else:
                        self.flag(part, TUPLE)
            case _:
                kind = self.value_kind(node.value)
                for target in node.targets:
                    self.assign(target, kind)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        kind = self.package.kind(self.file, node.annotation)
        if kind in NOT_PASSED or isinstance(kind, tuple):
            self.flag(node, f"a local is {KINDS}")
        if node.value is not None:
            self.check_conversion(node.value, self.value_kind(node.value), kind)
            self.assign(node.target, kind)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        kind = self.value_kind(node.target)
        if isinstance(node.op, ast.Mod) and kind != "float":
            self.flag(node, "no `%=` but on floats: write x = x % n")
        result = self.operation_kind(node, node.op, kind, self.value_kind(node.value))
        if isinstance(node.target, ast.Name):
            self.bind(node, node.target.id, result)

    def visit_Expr(self, node: ast.Expr) -> None:
        self.value_kind(node.value)

    def visit_Pass(self, node: ast.Pass) -> None:
        pass

    def visit_Return(self, node: ast.Return) -> None:
        if isinstance(node.value, ast.Tuple):
            kinds = self.returns if isinstance(self.returns, tuple) else ("?",) * len(node.value.elts)
            for part, kind in zip(node.value.elts, kinds, strict=False):
                self.check_conversion(part, self.value_kind(part), kind)
        elif node.value is not None:
            self.check_conversion(node.value, self.visit(node.value), self.returns)
        self.bound = None

    def visit_Break(self, node: ast.Break) -> None:
        if self.breaks:
            self.breaks[-1].append(self.bound)
        self.bound = None

    def visit_Continue(self, node: ast.Continue) -> None:
        self.bound = None

    def visit_If(self, node: ast.If) -> None:
        self.condition_kind(node.test)
        before = self.bound
        self.block(node.body)
        after, self.bound = self.bound, before
        self.block(node.orelse)
        self.bound = meet(after, self.bound)

    def visit_Match(self, node: ast.Match) -> None:
        self.check_matched_value(node.subject)
        before, after, complete = self.bound, None, False
        for case in node.cases:
            self.bound = before
            self.check_pattern(case.pattern)
            if case.guard is not None:
                self.condition_kind(case.guard)
            self.block(case.body)
            after = meet(after, self.bound)
            complete |= case.guard is None and isinstance(case.pattern, ast.MatchAs)
        self.bound = after if complete else meet(after, before)

    def check_matched_value(self, node: ast.expr) -> None:
        kind = self.value_kind(node)
        if kind not in ("int", "?") and not self.package.is_enumeration(kind):
            self.flag(node, PATTERN)

    def check_pattern(self, pattern: ast.pattern) -> None:
        match pattern:
            case ast.MatchOr(patterns=parts):
                for part in parts:
                    self.check_pattern(part)
            case ast.MatchValue(value=value):
                self.check_matched_value(value)
            case ast.MatchAs(pattern=None, name=None):
                pass
            case _:
                self.flag(pattern, PATTERN)

    def visit_While(self, node: ast.While) -> None:
        self.forget_loop_variables(node)
        self.condition_kind(node.test)
        endless = isinstance(node.test, ast.Constant) and bool(node.test.value)
        self.visit_loop(node, None if endless else self.bound)

    def visit_For(self, node: ast.For) -> None:
        match node:
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="range"), args=limits, keywords=[])):
                for limit in limits:
                    self.value_kind(limit)
                if limits and not self.function.range_of(node)[2]:
                    self.flag(node, "the step of a range is a whole number, not 0")
                self.forget_loop_variables(node)
                skipped = self.bound
                self.bind(node, name, "int")
                self.loops.append(name)
                self.visit_loop(node, skipped)
                self.loops.pop()
            case _:
                self.flag(node, "for runs one variable over range")

    def forget_loop_variables(self, loop: ast.While | ast.For) -> None:
        """Forget the variables of inner `for` loops: a later round may not use them before the inner loop sets them."""
        targets = [inner.target for inner in ast.walk(loop) if isinstance(inner, ast.For)]
        names = {target.id for target in targets if isinstance(target, ast.Name)} - set(self.loops)
        self.ended |= names
        self.bound = None if self.bound is None else self.bound - names

    def visit_loop(self, node: ast.While | ast.For, skipped: Bound) -> None:
        if node.orelse:
            self.flag(node.orelse[0], "a loop has no else")
        self.breaks.append([])
        self.block(node.body)
        self.bound = skipped
        for bound in self.breaks.pop():
            self.bound = meet(self.bound, bound)
