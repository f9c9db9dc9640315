"""Functions and methods in C: the docstring, the signature, and each statement with its comments."""

import ast
from collections.abc import Iterator

from ..subset.evaluation_order import is_chain
from ..subset.function_rules import without_docstring
from ..subset.package import CheckedFunction, assigned_name
from .context import Context
from .declarations import Path, find_declarations
from .expression_writer import AND, ARITHMETIC, RELATION, ExpressionWriter
from .text import append_comment, docstring, fold

Lines = tuple[int, int]  # of the source: the first and the last


class FunctionWriter(ExpressionWriter):
    """One function or method; `lines` has those that are written."""

    def __init__(self, context: Context, function: CheckedFunction) -> None:
        super().__init__(context, function)
        self.lines: list[str] = []
        self.indent = 0
        self.used_names = {*function.locals}
        self.declared = find_declarations(function)
        self.comments = context.comments[function.file]
        self.stored = function.stored_names(function.node)

    def signature(self) -> str:
        effect, failing = self.context.effects.by_function[self.function], self.function in self.context.raising.failing
        parameters: list[str] = []
        for name in self.function.parameters:
            kind = self.function.locals[name]
            is_object = self.package.is_object(kind)
            before = "const " if is_object and name not in effect.changed else ""
            parameters.append(f"{before}{self.context.type_of(kind)} {'*' * is_object}{self.names.local_name(name)}")
        parameters += ["bool *failed"] if failing else []
        returns = self.context.type_of(self.package.kind(self.function.file, self.function.node.returns))
        linkage = "static inline" if self.context.is_inline else "static"
        return f"{linkage} {returns} {self.names.name_of(self.function.node)}({', '.join(parameters) or 'void'})"

    def prototype(self) -> list[str]:
        return fold(f"{self.signature()};")

    def text(self) -> str:
        node = self.function.node
        self.write_comments(node.lineno)
        self.lines += docstring(node)
        self.write(f"{self.signature()} {{", (node.lineno, node.body[0].lineno - 1))
        self.indent += 1
        for name in self.function.parameters:
            if not self.mentions(node, name):
                self.write(f"(void){self.names.local_name(name)};")
        self.block(without_docstring(node.body), ())
        self.indent -= 1
        self.write("}")
        return "\n".join([*self.lines, ""])

    # --- lines ---

    def write(self, text: str, source: Lines | None = None) -> None:
        """Write a line, with the comments at the ends of those lines of the source."""
        first, last = source or (1, 0)
        comments = [
            self.comments[n][1] for n in range(first, last + 1) if n in self.comments and not self.comments[n][0]
        ]
        self.lines += append_comment("    " * self.indent + text, comments)

    def write_comments(self, line: int) -> None:
        """Write the comments on lines of their own before a statement; a blank line may follow a section's heading."""
        text = self.context.lines[self.function.file]
        at = line - 2 if line > 2 and not text[line - 2].strip() else line - 1
        comments: list[str] = []
        while at in self.comments and self.comments[at][0]:
            comments.insert(0, self.comments[at][1])
            at -= 1
        for words in comments:
            self.lines += append_comment("    " * self.indent + f"/* {words} */", [])

    def write_branch_comments(self, line: int) -> None:
        """Write the comments before a branch as its first lines."""
        self.indent += 1
        self.write_comments(line)
        self.indent -= 1

    def new_name(self, name: str) -> str:
        """A name that the source does not have."""
        while name in self.used_names or name != self.names.local_name(name):
            name += "_"
        self.used_names.add(name)
        return name

    # --- blocks ---

    def block(self, statements: list[ast.stmt], path: Path) -> None:
        for i, statement in enumerate(statements):
            self.write_comments(statement.lineno)
            self.statement(statement, (*path, i))

    def inner(self, statements: list[ast.stmt], path: Path) -> None:
        names_outside = {*self.used_names}
        self.indent += 1
        self.block(statements, path)
        self.indent -= 1
        self.used_names = names_outside

    def statement(self, s: ast.stmt, path: Path) -> None:
        new = self.declared.get(path, [])
        source = s.lineno, s.end_lineno or s.lineno
        match s:
            case ast.Assign(targets=[ast.Tuple(elts=parts)], value=ast.Call() as call):
                self.unpack(call, parts, new, source)
                return
            case ast.Assign(value=value) | ast.AnnAssign(value=ast.expr() as value) if new == [assigned_name(s)]:
                if not self.mentions(value, new[0]):
                    self.write_first_value(new[0], value, source)
                    return
        self.declare(new)
        self.plain_statement(s, path, source)

    def plain_statement(self, s: ast.stmt, path: Path, source: Lines) -> None:
        """Write a statement that declares nothing itself."""
        match s:
            case ast.If():
                self.write_if(s, path, "if")
            case ast.While():
                self.write_while(s, path)
            case ast.For():
                self.write_for(s, path)
            case ast.Match() if is_chain(s.cases):
                self.write_match_as_ifs(s, path)
            case ast.Match():
                self.write_switch(s, path)
            case ast.Assign(targets=targets, value=value):
                texts = " = ".join(self.code(target) for target in targets)
                self.write(f"{texts} = {self.code(value, 0, self.kind(targets[0]))};", source)
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                self.write(f"{self.code(target)} = {self.code(value, 0, self.kind(target))};", source)
            case ast.AugAssign():
                self.write_augmented(s, source)
            case ast.Expr(value=ast.Call() as call):
                self.write(f"{self.code(call)};", source)
            case ast.Return():
                self.write(self.return_text(s.value), source)
            case ast.Break() | ast.Continue():
                self.write(f"{type(s).__name__.lower()};", source)

    # --- assignments ---

    def write_augmented(self, s: ast.AugAssign, source: Lines) -> None:
        kind = self.kind(s.target)
        if type(s.op) in ARITHMETIC:
            sign, _ = ARITHMETIC[type(s.op)]
            self.write(f"{self.code(s.target)} {sign}= {self.right_operand(kind, s.value, s, 0)};", source)
        else:
            self.write(f"{self.code(s.target)} = {self.operation(s.op, kind, s.target, s.value, s).text};", source)

    def declare(self, names: list[str]) -> None:
        """Declare locals that get their values later, those of a type together."""
        types = [self.context.type_of(self.function.locals[name]) for name in names]
        for kind in dict.fromkeys(types):
            same = [self.names.local_name(n) for n, other in zip(names, types, strict=True) if other == kind]
            self.write(f"{kind} {', '.join(same)};")

    def const_if_stored_once(self, name: str) -> str:
        return "const " if self.stored.count(name) == 1 else ""

    def mentions(self, node: ast.AST, name: str) -> bool:
        return any(isinstance(n, ast.Name) and n.id == name for n in self.function.walk(node))

    def write_first_value(self, name: str, value: ast.expr, source: Lines) -> None:
        """Declare a local with its first value; one that names an object is a pointer."""
        kind, text = self.function.locals[name], self.names.local_name(name)
        if self.package.is_object(kind):
            before = "" if name in self.context.effects.by_function[self.function].changed else "const "
            self.write(f"{before}{self.context.type_of(kind)} *{text} = {self.pointer(value, kind)};", source)
        else:
            before = self.const_if_stored_once(name)
            self.write(f"{before}{self.context.type_of(kind)} {text} = {self.code(value, 0, kind)};", source)

    def unpack(self, call: ast.Call, parts: list[ast.expr], new: list[str], source: Lines) -> None:
        """Write the assignment of a returned tuple's parts."""
        kinds, callee = self.kind(call), self.function.callee(call)
        assert isinstance(kinds, tuple)
        assert callee is not None
        result = self.new_name(callee.node.name)
        self.declare([name for name in new if name not in {p.id for p in parts if isinstance(p, ast.Name)}])
        self.write(f"const {self.context.type_of(kinds)} {result} = {self.code(call)};", source)
        for i, part in enumerate(parts):
            assert isinstance(part, ast.Name)
            if part.id != "_":
                kind = self.context.type_of(self.function.locals[part.id])
                before = f"{self.const_if_stored_once(part.id)}{kind} " if part.id in new else ""
                self.write(f"{before}{self.names.local_name(part.id)} = {result}.v{i};")

    def return_text(self, value: ast.expr | None) -> str:
        kinds = self.package.kind(self.function.file, self.function.node.returns)
        if isinstance(value, ast.Tuple) and isinstance(kinds, tuple):
            parts = [self.code(part, 0, kind) for part, kind in zip(value.elts, kinds, strict=True)]
            return f"return ({self.context.type_of(kinds)}){{{', '.join(parts)}}};"
        return f"return {self.code(value, 0, kinds)};" if value else "return;"

    # --- choices and loops ---

    def write_if(self, s: ast.If, path: Path, word: str) -> None:
        self.write(f"{word} ({self.condition(s.test)}) {{", (s.lineno, s.body[0].lineno - 1))
        if word != "if":
            self.write_branch_comments(s.lineno)
        self.inner(s.body, (*path, "body"))
        match s.orelse:
            case [ast.If() as other] if (*path, "orelse", 0) not in self.declared and other.col_offset == s.col_offset:
                self.write_if(other, (*path, "orelse", 0), "} else if")
                return
            case [first, *_]:
                self.write("} else {", ((s.body[-1].end_lineno or 0) + 1, first.lineno - 1))
                self.inner(s.orelse, (*path, "orelse"))
        self.write("}")

    def write_while(self, s: ast.While, path: Path) -> None:
        guard = self.guard(s)
        test = self.condition(s.test, AND if guard else 0)
        self.write(f"while ({guard}{test}) {{", (s.lineno, s.body[0].lineno - 1))
        self.inner(s.body, (*path, "body"))
        self.write("}")

    def guard(self, loop: ast.stmt) -> str:
        """The condition that ends a loop at a failure, after which it might not end."""
        return "!*failed && " if loop in self.context.raising.integers[self.function].unbounded else ""

    def write_for(self, s: ast.For, path: Path) -> None:
        assert isinstance(s.target, ast.Name)
        first, end, step = self.function.range_of(s)
        self.function.kinds.setdefault(first, "int")
        name = self.new_name("count") if s.target.id == "_" else self.names.local_name(s.target.id)
        sign, on = "<" if step > 0 else ">", {1: "++", -1: "--"}.get(step, f" += {step}")
        start, limit = f"int64_t {name} = {self.code(first, 0, 'int')}", self.code(end, RELATION + 1, "int")
        if not self.is_constant_in(end, s.body):
            end_name = self.new_name(f"{name}_end")
            start, limit = f"{start}, {end_name} = {self.code(end, 0, 'int')}", end_name
        test = f"{self.guard(s)}{name} {sign} {limit}"
        self.write(f"for ({start}; {test}; {name}{on}) {{", (s.lineno, s.body[0].lineno - 1))
        self.inner(s.body, (*path, "body"))
        self.write("}")

    def is_constant_in(self, limit: ast.expr, body: list[ast.stmt]) -> bool:
        """Whether a loop's limit does not change in its body: range takes it once."""
        if any(
            isinstance(n, ast.Call) or self.context.raising.may_raise(self.function, n)
            for n in self.function.walk(limit)
        ):
            return isinstance(limit, ast.Call) and ast.unparse(limit.func) == "len"
        names = {name for s in body for name in self.function.stored_names(s)}
        effects = self.context.effects
        reads, _ = effects.accessed_fields(self.function, limit)
        writes = frozenset().union(*(effects.written_fields(self.function, s) for s in body))
        return not (writes & reads or any(self.mentions(limit, name) for name in names))

    # --- match ---

    def write_match_as_ifs(self, s: ast.Match, path: Path) -> None:
        """Write a chain of ifs: a case has a guard, or a break that in C would end the switch."""
        word = "if"
        for k, case in enumerate(s.cases):
            tests = [self.relation(s.subject, "==", value) for value in values_of(case.pattern)]
            text = " || ".join(tests)
            guard = [self.condition(case.guard, AND)] if case.guard else []
            if text:
                guard.insert(0, f"({text})" if len(tests) > 1 and guard else text)
            condition = " && ".join(guard)
            head = f"{word} ({condition}) {{" if condition else "} else {" if k else "{"
            self.write(head, (case.pattern.lineno, case.body[0].lineno - 1))
            self.write_branch_comments(case.pattern.lineno)
            self.inner(case.body, (*path, k))
            word = "} else if"
            if not condition:
                break
        self.write("}")

    def write_switch(self, s: ast.Match, path: Path) -> None:
        self.write(f"switch ({self.code(s.subject)}) {{", (s.lineno, s.lineno))
        for k, case in enumerate(s.cases):
            self.write_comments(case.pattern.lineno)
            labels = [f"case {self.code(value)}:" for value in values_of(case.pattern)] or ["default:"]
            for label in labels[:-1]:
                self.write(label)
            start = len(self.lines)
            self.inner(case.body, (*path, k))
            body, self.lines = self.lines[start:], self.lines[:start]
            declares = any(declared[:-1] == (*path, k) for declared in self.declared) or unpacks(case.body)
            self.write(f"{labels[-1]}{' {' if declares else ''}", (case.pattern.lineno, case.body[0].lineno - 1))
            self.lines += body
            if not isinstance(case.body[-1], ast.Return | ast.Continue):
                self.write("    break;")
            if declares:
                self.write("}")
        self.write("}")


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
