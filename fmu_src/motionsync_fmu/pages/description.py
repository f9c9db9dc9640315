"""Prints a block's variables, enumerations and fault codes for `motionsync describe` and `motionsync error`."""

import textwrap
from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any

from rich.markup import escape

from ..interface.codes import FaultCode
from ..interface.table import Group, Row
from ..interface.variables import members, summary
from .console import out

ENDLESS = 10_000  # the width where there is no terminal


def print_variables(groups: Iterable[Group]) -> None:
    """Print a block's variables by groups, each with its meaning below it, as wide as the terminal."""
    for group in groups:
        out.print(f"\n[bold]{escape(group.name or 'without a group')}[/]: {escape(group.summary)}")
        for row in group.rows:
            _print_wrapped(f"  {row.name}  {facts(row)}", 6)
            _print_wrapped(f"      {row.description}", 6)


def print_enumerations(enumerations: Iterable[Any]) -> None:
    """Print enumerations with their members."""
    for enumeration in enumerations:
        out.print(f"\n[bold]{enumeration.__name__}[/]: {escape(summary(enumeration))}")
        for member in members(enumeration):
            _print_wrapped(f"  {member.value:3d} {member.name}: {member.description}", 8)


def print_codes(codes: Sequence[FaultCode]) -> None:
    """Print the fault codes of a block, a sentence each, below the variables that carry them."""
    for carriers, group in groupby(codes, lambda code: code.carriers):
        out.print()
        _print_wrapped(f"Fault codes in {', '.join(carriers)}", 4)
        for code in group:
            _print_wrapped(f"  {code.number_text} {code.name}: {code.description}", 8)


def print_explanations(codes: Sequence[FaultCode], asked: str) -> None:
    """Explain fault codes, those of a block together.

    `asked`: the number or the words that all of them have; empty: they are all codes of a block."""
    blocks = {code.block: None for code in codes}
    if len(codes) > 1 and asked:
        where = f"in {len(blocks)} blocks" if len(blocks) > 1 else f"in {codes[0].block}"
        _print_wrapped(f"{asked}: {len(codes)} meanings {where}. The variable that shows the code decides.", 0)
    if len(blocks) > 1:
        _print_wrapped(f"Of one block alone: motionsync error {codes[0].block} {asked}", 0)
    for i, (block, group) in enumerate(groupby(codes, lambda code: code.block)):
        if i or (len(codes) > 1 and asked):
            out.print()
        out.print(f"[bold]{escape(block)}[/]")
        for code in group:
            _print_wrapped(f"  {code.number_text} ({code.name}) in {', '.join(code.carriers)}", 4)
            _print_wrapped(f"    {code.description}", 4)
            if code.shows:
                _print_wrapped(f"    its message shows: {', '.join(code.shows)}", 6)


def facts(row: Row) -> str:
    """Causality, type, unit, start value and range of a variable, in one line."""
    variability = "tunable " if row.variability == "tunable" else ""
    kind = " ".join(filter(None, [f"{variability}{row.causality},", row.type, row.unit]))
    value = f"= {row.start}" if row.start else ""
    return " ".join(filter(None, [kind, value, f"({row.allowed_range})" if row.allowed_range else ""]))


def _print_wrapped(text: str, indent: int) -> None:
    """Print a text in lines that fit the terminal; in one line where there is none."""
    width = out.width if out.is_terminal else ENDLESS
    for line in textwrap.wrap(
        text, width, subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False
    ):
        out.print(escape(line))
