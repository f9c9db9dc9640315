"""The consoles on which commands print, and how a headline and expectations are printed."""

from collections.abc import Iterable
from typing import TYPE_CHECKING
from unicodedata import category

from rich.console import Console, ConsoleOptions, RenderableType
from rich.markup import escape
from rich.segment import Segment

if TYPE_CHECKING:  # the second one loads NumPy, which `motionsync list` does not need
    from rich.table import Table

    from ..scenario.evaluate.expectations import Check
    from ..scenario.evaluate.reference_comparison import Deviation


class PlainConsole(Console):
    """A console that shows characters which command a terminal, or turn the direction of a line, as escapes: titles and
    names of files come from anywhere."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        for segment in super().render(renderable, options):
            is_plain = segment.control or segment.text.isprintable()
            yield segment if is_plain else Segment(show_escapes(segment.text), segment.style)


def show_escapes(text: str) -> str:
    """The text with control and format characters, except line feed and tab, as Python writes them: `\\x1b`."""
    return "".join(c.encode("unicode_escape").decode() if _commands(c) else c for c in text)


def _commands(c: str) -> bool:
    return (category(c)[0] == "C" and c not in "\n\t") or category(c) in ("Zl", "Zp")


out = PlainConsole(highlight=False, soft_wrap=True, emoji=False)
wide = PlainConsole(highlight=False, markup=False, emoji=False, width=1000)  # for tables: the terminal wraps long lines
err = PlainConsole(stderr=True, highlight=False, soft_wrap=True, markup=False, emoji=False)


def print_headline(title: str, source: str, passed: bool, notes: int = 0) -> None:
    """Print what was run, from which file or folder, whether all of it is as expected, and with how many notes."""
    mark = "[green]as expected[/]" if passed else "[red]NOT as expected[/]"
    if notes:
        mark += f", [yellow]with {notes} note{'s' * (notes > 1)}[/]"
    out.print(f"[bold]{escape(title)}[/] ({escape(source)}): {mark}")


def print_checks(checks: "Iterable[Check | Deviation]", indent: str = "  ") -> None:
    """Print a line for each expectation and each comparison with a reference."""
    for c in checks:
        verdict = "met    " if c.passed else "[red]not met[/]"
        out.print(f"{indent}{verdict}  {escape(c.text)}")


def print_table(table: "Table") -> None:
    """Print a table: as wide as the terminal, or with all of its columns in full where there is no terminal."""
    if out.is_terminal:
        out.print(table, soft_wrap=False)
    else:
        wide.print(table)
