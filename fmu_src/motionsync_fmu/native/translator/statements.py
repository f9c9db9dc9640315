"""Statements in C, each with the comments that stand before it and at the ends of its lines."""

import ast
from collections.abc import Iterator

from ..subset.order import is_chain
from ..subset.package import name_of
from .declarations import Path, declarations
from .expressions import AND, ARITHMETIC, RELATION, Expressions
from .text import with_comment

SPOKEN: dict[type[ast.operator], str] = {ast.Add: "plus", ast.Sub: "minus", ast.Mult: "times"}
Lines = tuple[int, int]  # of the source: the first and the last


class Statements(Expressions):
    """The statements of one function; `lines` is what has been written."""

    def begin(self) -> None:
        self.lines: list[str] = []
        self.indent = 0
        self.used = {*self.reading.locals}
        self.declared = declarations(self.reading)
        self.said = self.program.comments[self.reading.file]
        names = (
            n for n in self.reading.walk(self.reading.node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        )
        self.stored = [name.id for name in names]

    # --- lines ---

    def put(self, text: str, source: Lines | None = None) -> None:
        """A line of text, with what the source says at the ends of those lines."""
        first, last = source or (1, 0)
        said = [self.said[n][1] for n in range(first, last + 1) if n in self.said and not self.said[n][0]]
        self.lines += with_comment("    " * self.indent + text, said)

    def remarks(self, line: int) -> None:
        """The comments that stand on lines of their own before a statement; a section's heading has a blank line."""
        text = self.program.texts[self.reading.file]
        at = line - 2 if line > 2 and not text[line - 2].strip() else line - 1
        found: list[str] = []
        while at in self.said and self.said[at][0]:
            found.insert(0, self.said[at][1])
            at -= 1
        for words in found:
            self.lines += with_comment("    " * self.indent + f"/* {words} */", [])

    def inside(self, line: int) -> None:
        """The comments before a branch, as its first lines."""
        self.indent += 1
        self.remarks(line)
        self.indent -= 1

    def fresh(self, name: str) -> str:
        """A name for what the source has no name for."""
        while name in self.used or name != self.names.local(name):
            name += "_"
        self.used.add(name)
        return name

    # --- blocks ---

    def block(self, statements: list[ast.stmt], path: Path) -> None:
        for i, statement in enumerate(statements):
            self.remarks(statement.lineno)
            self.statement(statement, (*path, i))

    def inner(self, statements: list[ast.stmt], path: Path) -> None:
        outside = {*self.used}
        self.indent += 1
        self.block(statements, path)
        self.indent -= 1
        self.used = outside

    def statement(self, s: ast.stmt, here: Path) -> None:
        new = self.declared.get(here, [])
        source = s.lineno, s.end_lineno or s.lineno
        self.keep_indices(s)
        match s:
            case ast.Assign(targets=[ast.Tuple(elts=parts)], value=ast.Call() as call):
                self.unpack(call, parts, new, source)
                return
            case ast.Assign(value=value) | ast.AnnAssign(value=ast.expr() as value) if new == [name_of(s)]:
                if not self.mentions(value, new[0]):
                    self.first_value(new[0], value, source)
                    return
        self.declare(new)
        if isinstance(s, ast.If | ast.While | ast.For | ast.Match):
            self.compound_statement(s, here)
        else:
            self.simple_statement(s, source)

    def keep_indices(self, s: ast.stmt) -> None:
        """The indices that are checked here for this and later statements."""
        for kept in self.program.raising.kept(self.reading, s):
            name = self.fresh(f"at_{spoken(kept.places[0])}")
            self.put(f"const int64_t {name} = {self.in_range(kept.places[0], kept.length)};")
            self.checked |= dict.fromkeys(kept.places, name)

    def compound_statement(self, s: ast.If | ast.While | ast.For | ast.Match, here: Path) -> None:
        match s:
            case ast.If():
                self.choice(s, here, "if")
            case ast.While():
                self.repeat(s, here)
            case ast.For():
                self.count(s, here)
            case ast.Match() if is_chain(s.cases):
                self.chain(s, here)
            case ast.Match():
                self.switch(s, here)

    def simple_statement(self, s: ast.stmt, source: Lines) -> None:
        match s:
            case ast.Assign(targets=targets, value=value):
                places = " = ".join(self.code(place) for place in targets)
                self.put(f"{places} = {self.code(value, 0, self.kind(targets[0]))};", source)
            case ast.AnnAssign(target=place, value=ast.expr() as value):
                self.put(f"{self.code(place)} = {self.code(value, 0, self.kind(place))};", source)
            case ast.AugAssign():
                self.changed(s, source)
            case ast.Expr(value=ast.Call() as call):
                self.put(f"{self.code(call)};", source)
            case ast.Return():
                self.put(self.returned(s.value), source)
            case ast.Break():
                self.put("break;", source)
            case ast.Continue():
                self.put("continue;", source)

    # --- assignments ---

    def changed(self, s: ast.AugAssign, source: Lines) -> None:
        kind = self.kind(s.target)
        if type(s.op) in ARITHMETIC:
            sign, _ = ARITHMETIC[type(s.op)]
            self.put(f"{self.code(s.target)} {sign}= {self.right(kind, s.value, s, 0)};", source)
        else:
            self.put(f"{self.code(s.target)} = {self.operation(s.op, kind, s.target, s.value, s).text};", source)

    def declare(self, names: list[str]) -> None:
        """Locals that get their values later, those of a type together."""
        types = [self.program.type_of(self.reading.locals[name]) for name in names]
        for kind in dict.fromkeys(types):
            same = [self.names.local(n) for n, other in zip(names, types, strict=True) if other == kind]
            self.put(f"{kind} {', '.join(same)};")

    def constant_if(self, stays: bool) -> str:
        return "const " if stays else ""

    def mentions(self, node: ast.AST, name: str) -> bool:
        return any(isinstance(n, ast.Name) and n.id == name for n in self.reading.walk(node))

    def first_value(self, name: str, value: ast.expr, source: Lines) -> None:
        """A local with its first value; one that stands for an object is a pointer."""
        kind, text = self.reading.locals[name], self.names.local(name)
        if self.is_object(kind):
            before = self.constant_if(name not in self.program.effects.of[self.reading].changed)
            self.put(f"{before}{self.program.type_of(kind)} *{text} = {self.pointer(value, kind)};", source)
        else:
            before = self.constant_if(self.stored.count(name) == 1)
            self.put(f"{before}{self.program.type_of(kind)} {text} = {self.code(value, 0, kind)};", source)

    def unpack(self, call: ast.Call, parts: list[ast.expr], new: list[str], source: Lines) -> None:
        """The parts of a tuple that a call returns."""
        kinds, callee = self.kind(call), self.reading.callee(call)
        assert isinstance(kinds, tuple)
        assert callee is not None
        found = self.fresh(callee.node.name)
        self.declare([name for name in new if name not in {p.id for p in parts if isinstance(p, ast.Name)}])
        self.put(f"const {self.program.type_of(kinds)} {found} = {self.code(call)};", source)
        for i, part in enumerate(parts):
            assert isinstance(part, ast.Name)
            if part.id != "_":
                kind = self.program.type_of(self.reading.locals[part.id])
                before = f"{self.constant_if(self.stored.count(part.id) == 1)}{kind} " if part.id in new else ""
                self.put(f"{before}{self.names.local(part.id)} = {found}.v{i};")

    def returned(self, value: ast.expr | None) -> str:
        kinds = self.package.kind(self.reading.file, self.reading.node.returns)
        if isinstance(value, ast.Tuple) and isinstance(kinds, tuple):
            parts = [self.code(part, 0, kind) for part, kind in zip(value.elts, kinds, strict=True)]
            return f"return ({self.program.type_of(kinds)}){{{', '.join(parts)}}};"
        return f"return {self.code(value, 0, kinds)};" if value else "return;"

    # --- choices and loops ---

    def choice(self, s: ast.If, here: Path, word: str) -> None:
        self.put(f"{word} ({self.condition(s.test)}) {{", (s.lineno, s.body[0].lineno - 1))
        if word != "if":
            self.inside(s.lineno)
        self.inner(s.body, (*here, "body"))
        match s.orelse:
            case [ast.If() as other] if (*here, "orelse", 0) not in self.declared and other.col_offset == s.col_offset:
                self.choice(other, (*here, "orelse", 0), "} else if")
                return
            case [first, *_]:
                self.put("} else {", ((s.body[-1].end_lineno or 0) + 1, first.lineno - 1))
                self.inner(s.orelse, (*here, "orelse"))
        self.put("}")

    def repeat(self, s: ast.While, here: Path) -> None:
        guard = self.guard(s)
        test = self.condition(s.test, AND if guard else 0)
        self.put(f"while ({guard}{test}) {{", (s.lineno, s.body[0].lineno - 1))
        self.inner(s.body, (*here, "body"))
        self.put("}")

    def guard(self, loop: ast.stmt) -> str:
        """What ends a loop at a failure, after which it might go on for ever."""
        return "!*failed && " if loop in self.program.raising.checks[self.reading].endless else ""

    def count(self, s: ast.For, here: Path) -> None:
        assert isinstance(s.iter, ast.Call)
        assert isinstance(s.target, ast.Name)
        limits = s.iter.args
        first, end = limits[:2] if len(limits) > 1 else (ast.Constant(0), limits[0])
        self.reading.kinds.setdefault(first, "int")
        step = self.package.number(self.reading.file, limits[2]) if len(limits) > 2 else 1
        assert isinstance(step, int)
        name = self.fresh("count") if s.target.id == "_" else self.names.local(s.target.id)
        sign, on = "<" if step > 0 else ">", {1: "++", -1: "--"}.get(step, f" += {step}")
        begin, limit = f"int64_t {name} = {self.code(first, 0, 'int')}", self.code(end, RELATION + 1, "int")
        if not self.stable(end, s.body):
            kept = self.fresh(f"{name}_end")
            begin, limit = f"{begin}, {kept} = {self.code(end, 0, 'int')}", kept
        test = f"{self.guard(s)}{name} {sign} {limit}"
        self.put(f"for ({begin}; {test}; {name}{on}) {{", (s.lineno, s.body[0].lineno - 1))
        self.inner(s.body, (*here, "body"))
        self.put("}")

    def stable(self, limit: ast.expr, body: list[ast.stmt]) -> bool:
        """Whether the body leaves a loop's limit as it is: range takes it once."""
        if any(isinstance(n, ast.Call) or self.program.raising.may(self.reading, n) for n in self.reading.walk(limit)):
            return isinstance(limit, ast.Call) and ast.unparse(limit.func) == "len"
        names = {
            n.id for s in body for n in self.reading.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        }
        effects = self.program.effects
        reads, _ = effects.touched(self.reading, limit)
        writes = frozenset().union(*(effects.written(self.reading, s) for s in body))
        return not (writes & reads or any(self.mentions(limit, name) for name in names))

    # --- match ---

    def chain(self, s: ast.Match, here: Path) -> None:
        """A chain of ifs: a case has a guard, or a break that in C would end the switch."""
        word = "if"
        for k, case in enumerate(s.cases):
            tests = [self.relation(s.subject, "==", value) for value in values_of(case.pattern)]
            text = " || ".join(tests)
            guard = [self.condition(case.guard, AND)] if case.guard else []
            if text:
                guard.insert(0, f"({text})" if len(tests) > 1 and guard else text)
            condition = " && ".join(guard)
            head = f"{word} ({condition}) {{" if condition else "} else {" if k else "{"
            self.put(head, (case.pattern.lineno, case.body[0].lineno - 1))
            self.inside(case.pattern.lineno)
            self.inner(case.body, (*here, k))
            word = "} else if"
            if not condition:
                break
        self.put("}")

    def switch(self, s: ast.Match, here: Path) -> None:
        self.put(f"switch ({self.code(s.subject)}) {{", (s.lineno, s.lineno))
        for k, case in enumerate(s.cases):
            self.remarks(case.pattern.lineno)
            labels = [f"case {self.code(value)}:" for value in values_of(case.pattern)] or ["default:"]
            for label in labels[:-1]:
                self.put(label)
            begin = len(self.lines)
            self.inner(case.body, (*here, k))
            body, self.lines = self.lines[begin:], self.lines[:begin]
            declares = any(place[:-1] == (*here, k) for place in self.declared) or unpacks(case.body)
            declares |= any(True for s in case.body for _ in self.program.raising.kept(self.reading, s))
            self.put(f"{labels[-1]}{' {' if declares else ''}", (case.pattern.lineno, case.body[0].lineno - 1))
            self.lines += body
            if not isinstance(case.body[-1], ast.Return | ast.Continue):
                self.put("    break;")
            if declares:
                self.put("}")
        self.put("}")


def spoken(index: ast.expr) -> str:
    """An index in words, such as `piece_plus_1`."""
    match index:
        case ast.BinOp(left=left, op=op, right=right):
            return f"{spoken(left)}_{SPOKEN[type(op)]}_{spoken(right)}"
        case ast.UnaryOp(operand=operand):
            return f"minus_{spoken(operand)}"
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name.lower()
    return ast.unparse(index)


def unpacks(body: list[ast.stmt]) -> bool:
    """Whether a temporary is declared directly in this block."""
    return any(isinstance(s, ast.Assign) and isinstance(s.targets[0], ast.Tuple) for s in body)


def values_of(pattern: ast.pattern) -> Iterator[ast.expr]:
    """The values of a pattern; none of the wildcard."""
    if isinstance(pattern, ast.MatchOr):
        for part in pattern.patterns:
            yield from values_of(part)
    elif isinstance(pattern, ast.MatchValue):
        yield pattern.value
