"""The functions of parts, as `var` has them, for the classes of a block: field by field, with the declared ranges."""

import ast
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, TypeGuard

from ..subset.expression_rules import COPY_VALID, FIRST_INVALID, SAME
from ..subset.package import Kind
from .context import Context
from .names import BASE
from .text import fold, literal


class PartFunctions:
    """The functions of parts that a block needs."""

    def __init__(self, context: Context) -> None:
        self.context, self.package, self.names = context, context.package, context.names

    def texts(self) -> Iterator[str]:
        """Each function once, after those that it calls."""
        needed: dict[tuple[str, ast.ClassDef], None] = {}
        for function, node in self.context.part_functions:
            inner = FIRST_INVALID if function == COPY_VALID else function
            parts = (part for part in self.context.required_classes(node) if part not in self.package.enumerations)
            needed |= dict.fromkeys((inner, part) for part in parts) | {(function, node): None}
        texts = {self.names.part_functions[key]: self.text(*key) for key in needed}
        called = {self.names.part_functions[key] for key in self.context.part_functions}
        for name in reversed(texts):  # a part without a tunable is not tested
            called |= {callee for callee in texts if f"{callee}(" in texts[name]} if name in called else set()
        yield from (text for name, text in texts.items() if name in called)

    def text(self, function: str, node: ast.ClassDef) -> str:
        """One function of one class."""
        a, b = (f"const {self.names.name_of(node)} *{name}" for name in "ab")
        name = self.names.part_functions[function, node]
        if function == SAME:
            head, rows = f"bool {name}({a}, {b})", [*self.comparison(node), "return true;"]
        elif function == FIRST_INVALID:
            head, rows = f"int64_t {name}({a})", ["int64_t n = 0;", *self.range_tests(node), "return n;"]
        else:
            head = f"void {name}({a.removeprefix('const ')}, {b})"
            rows = [f"if ({self.names.part_functions[FIRST_INVALID, node]}(b) == 0) *a = *b;"]
        body = (f"    {line}" for row in rows for line in fold(row))
        return "\n".join([*fold(f"static inline {head} {{"), *body, "}", ""])

    def comparison(self, node: ast.ClassDef) -> Iterator[str]:
        """Two parts are compared field by field, those inside after the numbers."""
        calls = []
        for member, kind, _ in self.members(node):
            if self.is_part(kind):
                calls.append(f"if (!{self.names.part_functions[SAME, kind]}(&a->{member}, &b->{member})) return false;")
            elif kind == "list":
                yield f"for (int i = 0; i < {self.package.list_length(node, member)}; i++) {{"
                yield f"    if (a->{member}[i] != b->{member}[i]) return false;"
                yield "}"
            else:
                yield f"if (a->{member} != b->{member}) return false;"
        yield from calls

    def range_tests(self, node: ast.ClassDef) -> Iterator[str]:
        """The tunable parameters are tested and numbered in the order of declaration."""
        number = 0
        for member, kind, metadata in self.members(node):
            if self.is_part(kind):
                if count := self.count_tunables(kind, metadata):
                    call = f"{self.names.part_functions[FIRST_INVALID, kind]}(&a->{member})"
                    yield f"if ((n = {call}) != 0) return {number} + n;"
                    number += count
            elif is_numbered(kind, metadata):
                number += 1
                if test := self.range_test(kind, metadata["declaration"], f"a->{member}"):
                    yield f"if (!({test})) return {number};"

    def members(self, node: ast.ClassDef) -> Iterator[tuple[str, Kind, Any]]:
        """The members of a struct, the base first: the name, the kind, and what the field's declaration says."""
        if base := self.package.base_class(node):
            yield BASE, base, {}
        metadata = {f.name: f.metadata for f in fields(self.context.python_class(node))}
        for name, kind in self.package.own_fields(node).items():
            yield self.names.field_name(name), kind, metadata[name]

    def is_part(self, kind: Kind) -> TypeGuard[ast.ClassDef]:
        return kind != "list" and self.package.is_object(kind)

    def count_tunables(self, node: ast.ClassDef, metadata: Any) -> int:
        """How many parameters are numbered in a part."""
        if metadata.get("hidden"):
            return 0
        return sum(
            self.count_tunables(kind, inner) if self.is_part(kind) else is_numbered(kind, inner)
            for _, kind, inner in self.members(node)
        )

    def range_test(self, kind: Kind, declaration: Any, value: str) -> str:
        """The test whether a value is within its declared range; empty if each one is."""
        if isinstance(kind, ast.ClassDef):
            numbers = sorted(map(int, self.context.python_class(kind)))
            if numbers == list(range(numbers[0], numbers[-1] + 1)):
                return f"{numbers[0]} <= {value} && {value} <= {numbers[-1]}"
            return " || ".join(f"{value} == {n}" for n in numbers)
        low, high = declaration.ends
        if kind == "int":
            tests = [(low, f"{low:.0f} <= {value}"), (high, f"{value} <= {high:.0f}")]
            return " && ".join(test for end, test in tests if abs(end) < 2.0**63)
        zero = f"{value} == 0.0 || " if declaration.zero else ""
        magnitude = declaration.least_magnitude
        least = f" && ({zero}fabs({value}) >= {literal(magnitude)})" if magnitude > 0.0 else ""
        return f"{literal(low)} <= {value} && {value} <= {literal(high)}{least}"


def is_numbered(kind: Kind, metadata: Any) -> bool:
    """Whether a field is a tunable parameter that some value is out of the range of."""
    declaration = metadata.get("declaration")
    return kind != "bool" and declaration is not None and declaration.tunable
