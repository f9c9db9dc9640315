"""What the commands print alike: the consoles, a block's variables, and judged expectations."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from ..interface.table import groups
from ..interface.variables import members, summary, variables

if TYPE_CHECKING:  # they load NumPy, which `motionsync list` does not need
    from ..scenario.judge import Check

out = Console(highlight=False, soft_wrap=True)
wide = Console(highlight=False, markup=False, width=1000)  # for tables: the terminal wraps long lines
err = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)


def print_variables(
    block: Any, unit: str, slave_unit: str, starts: Mapping[str, str], turned: Mapping[str, str]
) -> None:
    """Print a block's variables, and its enumerations with their members.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`);
    `starts`: start values in place of the block's, as texts by name; `turned`: as for `interface.variables.variables`.
    """
    columns = ("name", "causality", "type", "unit", "start", "allowed_range", "description")
    table = Table(*(column.removeprefix("allowed_") for column in columns), box=None)
    table.columns[0].no_wrap = True
    for i, group in enumerate(groups(block, unit, slave_unit, turned)):
        if i:
            table.add_row()
        for row in group.rows:
            shown = replace(row, start=starts.get(row.name, row.start))
            table.add_row(*(getattr(shown, column) for column in columns))
    wide.print(table)
    for enumeration in dict.fromkeys(v.cell.type for v in variables(block) if v.choices):
        out.print(f"\n{enumeration.__name__}: {summary(enumeration)}")
        for member in members(enumeration):
            out.print(f"  {member.value:3d} {member.name}: {member.description}")


def print_headline(title: str, source: str, passed: bool, remarks: int = 0) -> None:
    """Print what was run, from which file or folder, whether all of it is as expected, and with how many remarks."""
    mark = "[green]as expected[/]" if passed else "[red]NOT as expected[/]"
    if remarks:
        mark += f", [yellow]with {remarks} remark{'s' * (remarks > 1)}[/]"
    out.print(f"[bold]{escape(title)}[/] ({escape(source)}): {mark}")


def print_checks(checks: "Iterable[Check]") -> None:
    """Print a line for each expectation."""
    for c in checks:
        out.print(f"  {verdict(c.passed)}  {escape(c.text)}")


def verdict(passed: bool) -> str:
    """What became of an expectation, as markup."""
    return "kept  " if passed else "[red]broken[/]"
