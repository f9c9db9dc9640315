"""Functions and methods in C: the docstring, the signature, the statements."""

import ast

from ..subset.functions import without_docstring
from .statements import Statements
from .text import docstring, fold


class Function(Statements):
    """One function or method."""

    def signature(self) -> str:
        effect, failing = self.program.effects.of[self.reading], self.reading in self.program.raising.failing
        found: list[str] = []
        for name in self.reading.parameters:
            kind = self.reading.locals[name]
            whole = self.is_object(kind)
            before = "const " if whole and name not in effect.changed else ""
            found.append(f"{before}{self.program.type_of(kind)} {'*' * whole}{self.names.local(name)}")
        found += ["bool *failed"] if failing else []
        returns = self.program.type_of(self.package.kind(self.reading.file, self.reading.node.returns))
        return f"static {returns} {self.names.function(self.reading)}({', '.join(found) or 'void'})"

    def prototype(self) -> list[str]:
        return fold(f"{self.signature()};")

    def text(self) -> str:
        node = self.reading.node
        self.begin()
        self.remarks(node.lineno)
        self.lines += docstring(node)
        self.put(f"{self.signature()} {{", (node.lineno, node.body[0].lineno - 1))
        self.indent += 1
        used = {n.id for n in self.reading.walk(node) if isinstance(n, ast.Name)}
        for name in (name for name in self.reading.parameters if name not in used):
            self.put(f"(void){self.names.local(name)};")
        self.block(without_docstring(node.body), ())
        self.indent -= 1
        self.put("}")
        return "\n".join([*self.lines, ""])
