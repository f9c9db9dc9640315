"""Prints a block's variables, enumerations and fault codes for `motionsync describe` and `motionsync error`."""

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from rich.markup import escape

from motionsync.blocks import BLOCKS

from ..interface.table import Row, groups
from ..interface.variables import members, summary, variables
from .console import out

ENDLESS = 10_000  # the width where there is no terminal


@dataclass(frozen=True)
class CodeMeaning:
    """A fault code of a block.

    Attributes:
        member: the member of the block's enumeration, with its value, name and description.
        carriers: the variables that have it as a value.
    """

    block: str
    member: Any
    carriers: tuple[str, ...]

    @property
    def number(self) -> str:
        """The code as the source writes it: `17118 = 0x42DE`, or `3` where it has no hexadecimal numbers."""
        value = self.member.value
        return f"{value} = 0x{value:04X}" if f"0x{value:X}" in self.member.description else f"{value}"

    @property
    def shows(self) -> list[str]:
        """The names of the variables whose values a message shows; `.velocity` is in the group of the error_id."""
        return [f"<command>{name}" if name.startswith(".") else name for name in self.member.names]


def codes_of(name: str, block: Any) -> list[CodeMeaning]:
    """The fault codes of a block, in the order of its enumerations; 0, which is no fault, is none of them."""
    carriers: dict[Any, list[str]] = {}
    for v in variables(block):
        if v.declaration.codes:
            carriers.setdefault(v.declaration.codes, []).append(v.name)
    return [CodeMeaning(name, m, tuple(of)) for kind, of in carriers.items() for m in members(kind) if m.value != 0]


def all_codes() -> list[CodeMeaning]:
    """The fault codes of all blocks."""
    return [code for name, kind in BLOCKS.items() for code in codes_of(name, kind())]


def print_variables(
    block: Any, unit: str, slave_unit: str, starts: Mapping[str, str], overrides: Mapping[str, str]
) -> None:
    """Print a block's variables by groups, each with its meaning below it, as wide as the terminal.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`);
    `starts`: start values in place of the block's, as texts by name; `overrides`: as for `interface.variables`.
    """
    for group in groups(block, unit, slave_unit, overrides):
        out.print(f"\n[bold]{escape(group.name or 'without a group')}[/]: {escape(group.summary)}")
        for row in group.rows:
            _print_wrapped(f"  {row.name}  {_facts(row, starts.get(row.name, row.start))}", 6)
            _print_wrapped(f"      {row.description}", 6)


def print_enumerations(block: Any) -> None:
    """Print the enumerations that the variables of a block have, with their members."""
    for enumeration in dict.fromkeys(v.cell.type for v in variables(block) if v.choices):
        out.print(f"\n[bold]{enumeration.__name__}[/]: {escape(summary(enumeration))}")
        for member in members(enumeration):
            _print_wrapped(f"  {member.value:3d} {member.name}: {member.description}", 8)


def print_codes(codes: list[CodeMeaning]) -> None:
    """Print the fault codes of a block, a sentence each, below the variables that carry them."""
    for carriers, group in groupby(codes, lambda code: code.carriers):
        out.print()
        _print_wrapped(f"Fault codes in {', '.join(carriers)}", 4)
        for code in group:
            _print_wrapped(f"  {code.number} {code.member.name}: {code.member.description}", 8)


def print_code(code: CodeMeaning) -> None:
    """Explain one fault code."""
    out.print(f"[bold]{escape(code.block)}, {code.number}[/] ({code.member.name})")
    _print_wrapped(f"  {code.member.description}", 2)
    for title, names in (("in", list(code.carriers)), ("its message shows", code.shows)):
        if names:
            _print_wrapped(f"  {title}: {', '.join(names)}", 4)


def _facts(row: Row, start: str) -> str:
    """Causality, type, unit, start value and range of a variable, in one line."""
    variability = "tunable " if row.variability == "tunable" else ""
    kind = " ".join(filter(None, [f"{variability}{row.causality},", row.type, row.unit]))
    value = f"= {start}" if start else ""
    return " ".join(filter(None, [kind, value, f"({row.allowed_range})" if row.allowed_range else ""]))


def _print_wrapped(text: str, indent: int) -> None:
    """Print a text in lines that fit the terminal; in one line where there is none."""
    width = out.width if out.is_terminal else ENDLESS
    for line in textwrap.wrap(
        text, width, subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False
    ):
        out.print(escape(line))
