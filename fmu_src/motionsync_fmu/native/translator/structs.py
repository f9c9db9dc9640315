"""The types of a block's memory: a struct for each dataclass, an enum for each enumeration; and its start image."""

import ast
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

from ..subset.package import Kind, name_of
from .names import BASE
from .text import docstring, literal, with_comment

if TYPE_CHECKING:
    from .program import Program

INDENT = "    "


class Structs:
    """The types that a block needs."""

    def __init__(self, program: "Program") -> None:
        self.program, self.package, self.names = program, program.package, program.names

    def in_order(self, node: ast.ClassDef) -> dict[ast.ClassDef, None]:
        """A class after its base and the classes of its fields."""
        base = self.package.base(node)
        found = self.in_order(base) if base else {}
        for item in self.package.fields(node):
            kind = self.kind(node, item)
            if isinstance(kind, ast.ClassDef):
                found |= {kind: None} if kind in self.package.enumerations else self.in_order(kind)
        return found | {node: None}

    def kind(self, owner: ast.ClassDef, item: ast.AnnAssign) -> Kind:
        return self.package.kind(self.package.homes[owner], item.annotation)

    def text(self, node: ast.ClassDef) -> str:
        return self.enumeration(node) if node in self.package.enumerations else self.struct(node)

    def enumeration(self, node: ast.ClassDef) -> str:
        """Its members as constants; a field of it has 64 bits, as all integers."""
        name, rows = self.names.of(node), []
        for member in self.program.running(node):
            rows += with_comment(
                f"{INDENT}{self.program.enumerator(node, member.name)} = {int(member)},", [member.description]
            )
        return "\n".join([*docstring(node), f"typedef int64_t {name};", "enum {", *rows, "};", ""])

    def struct(self, node: ast.ClassDef) -> str:
        base = self.package.base(node)
        running = {f.name: f for f in fields(self.program.running(node))}
        rows = [f"{INDENT}{self.names.of(base)} {BASE};"] if base else []
        for item in self.package.fields(node):
            kind, name = self.kind(node, item), name_of(item)
            length = f"[{self.package.length(node, name)}]" if kind == "list" else ""
            declared = running[name].metadata.get("declaration")
            said = [f"{declared.causality}: {declared.description}"] if declared else []
            rows += with_comment(f"{INDENT}{self.program.type_of(kind)} {self.names.member(name)}{length};", said)
        tag = "struct Block" if node is self.program.main else "struct"
        return "\n".join([*docstring(node), f"typedef {tag} {{", *rows, f"}} {self.names.of(node)};", ""])

    def start(self, owner: Any, cls: type | None = None, indent: str = "") -> str:
        """An object's present values as an initialiser; what is 0 or false is left out."""
        cls, inner = cls or type(owner), indent + INDENT
        base = next((base for base in cls.__bases__ if is_dataclass(base)), None)
        above = {f.name for f in fields(base)} if base else set()
        found = {BASE: self.start(owner, base, inner)} if base else {}
        for f in fields(cls):
            if f.name not in above:
                value = getattr(owner, f.name)
                whole = is_dataclass(value) and not isinstance(value, type)
                found[self.names.member(f.name)] = self.start(value, None, inner) if whole else self.initial(value)
        rows = [f"{inner}.{name} = {text},\n" for name, text in found.items() if text not in ("", "{0}")]
        return f"{{\n{''.join(rows)}{indent}}}" if rows else "{0}"

    @staticmethod
    def initial(value: Any) -> str:
        """The value of a field; empty if all of its bits are 0."""
        if isinstance(value, list):
            return f"{{{', '.join(map(literal, value))}}}" if any(map(Structs.initial, value)) else ""
        plain = value if isinstance(value, bool | float) else int(value)
        return literal(plain) if value or str(value) == "-0.0" else ""
