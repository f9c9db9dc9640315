"""motionsync list"""

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from motionsync.blocks import BLOCKS

from ..errors import spelled
from ..interface.variables import summary
from ..pages.console import out, wide
from ..scenario.shipped import FILE, LINES, called, shipped
from ..scenario.toml_tables import Table as TomlTable
from ..scenario.toml_tables import read_toml


def list_all(
    block: Annotated[str, typer.Argument(help="A block, to see its scenarios.")] = "",
    scenarios: Annotated[
        Path | None, typer.Option(help="A folder of your own; else what comes with motionsync is listed.")
    ] = None,
) -> None:
    """List the blocks, and what can be run by name.

    Examples:

        motionsync list

        motionsync list FlyingSaw

        motionsync list --scenarios my_scenarios
    """
    if block:
        block = spelled(BLOCKS, block, "block")
    place = scenarios or shipped()
    if not place.is_dir():
        out.print(f"No scenarios: there is no folder {escape(str(place))}")
        return
    found = [read_toml(file) for file in sorted(place.rglob(FILE))]
    if block or scenarios:
        _print("Scenarios", [top for top in found if block in ("", top.string("fmu"))])
    else:
        _print_blocks(Counter(top.string("fmu") for top in found))
    if not block:
        _print("Lines", [read_toml(file) for file in sorted(place.rglob(LINES))])
    if not (block or scenarios):
        out.print(
            "\nmotionsync list FlyingSaw lists the scenarios of a block; motionsync run and motionsync line run them."
        )


def _print_blocks(counts: Counter[str]) -> None:
    table = Table("block", "scenarios", "what it does", box=None)
    for name, block_type in BLOCKS.items():
        table.add_row(name, str(counts[name]), summary(block_type))
    _show(table)


def _print(title: str, files: list[TomlTable]) -> None:
    """Print the names by which these files are run, and their titles; nothing if there are none."""
    if not files:
        return
    table = Table("name", "title", title=f"\n{title}", title_justify="left", box=None)
    table.columns[0].overflow = "fold"
    for top in files:
        table.add_row(called(top.file), top.string("title"))
    _show(table)


def _show(table: Table) -> None:
    """Print a table as wide as the terminal; where there is none, a row is one line."""
    if out.is_terminal:
        out.print(table, soft_wrap=False)
    else:
        wide.print(table)
