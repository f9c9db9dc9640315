"""The types of a block's memory: a struct for each dataclass, an enum for each enumeration; and its start image."""

import ast
from array import array
from dataclasses import fields, is_dataclass
from typing import Any

from .context import Context
from .names import BASE
from .text import append_comment, docstring, literal

INDENT = "    "


class StructWriter:
    """Writes the types that a block needs."""

    def __init__(self, context: Context) -> None:
        self.context, self.package, self.names = context, context.package, context.names

    def text(self, node: ast.ClassDef) -> str:
        return self.enumeration(node) if node in self.package.enumerations else self.struct(node)

    def enumeration(self, node: ast.ClassDef) -> str:
        """Its members as constants; a field of it has 64 bits, as all integers."""
        name, rows = self.names.name_of(node), []
        for member in self.context.python_class(node):
            rows += append_comment(
                f"{INDENT}{self.context.enumerator(node, member.name)} = {int(member)},", [member.description]
            )
        return "\n".join([*docstring(node), f"typedef int64_t {name};", "enum {", *rows, "};", ""])

    def struct(self, node: ast.ClassDef) -> str:
        base = self.package.base_class(node)
        python_fields = {f.name: f for f in fields(self.context.python_class(node))}
        rows = [f"{INDENT}{self.names.name_of(base)} {BASE};"] if base else []
        for name, kind in self.package.own_fields(node).items():
            length = f"[{self.package.list_length(node, name)}]" if kind == "list" else ""
            declared = python_fields[name].metadata.get("declaration")
            comment = [f"{declared.causality}: {declared.description}"] if declared else []
            rows += append_comment(
                f"{INDENT}{self.context.type_of(kind)} {self.names.field_name(name)}{length};", comment
            )
        tag = "struct Block" if node is self.context.block_class else "struct"
        return "\n".join([*docstring(node), f"typedef {tag} {{", *rows, f"}} {self.names.name_of(node)};", ""])

    def start(self, owner: Any, cls: type | None = None, indent: str = "") -> str:
        """An object's present values as an initialiser; what is 0 or false is left out."""
        cls, inner = cls or type(owner), indent + INDENT
        base = next((base for base in cls.__bases__ if is_dataclass(base)), None)
        inherited = {f.name for f in fields(base)} if base else set()
        texts = {BASE: self.start(owner, base, inner)} if base else {}
        for f in fields(cls):
            if f.name not in inherited:
                value = getattr(owner, f.name)
                is_part = is_dataclass(value) and not isinstance(value, type)
                texts[self.names.field_name(f.name)] = (
                    self.start(value, None, inner) if is_part else self.initial(value)
                )
        rows = [f"{inner}.{name} = {text},\n" for name, text in texts.items() if text not in ("", "{0}")]
        return f"{{\n{''.join(rows)}{indent}}}" if rows else "{0}"

    @staticmethod
    def initial(value: Any) -> str:
        """The value of a field; empty if all of its bits are 0."""
        if isinstance(value, array):  # a series: none are given at first
            return ""
        if isinstance(value, list):
            return f"{{{', '.join(map(literal, value))}}}" if any(map(StructWriter.initial, value)) else ""
        number = value if isinstance(value, bool | float) else int(value)
        return literal(number) if value or str(value) == "-0.0" else ""
