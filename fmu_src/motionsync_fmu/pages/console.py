"""What the commands print alike: the consoles, and judged expectations."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

if TYPE_CHECKING:  # they load NumPy, which `motionsync list` does not need
    from ..scenario.judge import Check

out = Console(highlight=False, soft_wrap=True, emoji=False)
wide = Console(highlight=False, markup=False, emoji=False, width=1000)  # for tables: the terminal wraps long lines
err = Console(stderr=True, highlight=False, soft_wrap=True, markup=False, emoji=False)


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
