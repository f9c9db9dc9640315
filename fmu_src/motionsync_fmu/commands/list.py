"""motionsync list"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from motionsync.blocks import BLOCKS

from ..errors import resolve_name
from ..interface.block_folder import block_summary
from ..pages.console import out, print_table
from ..scenario.files.shipped import LINE_FILES, SCENARIO_FILE, scenario_name, shipped_folder
from ..scenario.files.toml_tables import TomlTable, read_toml


def command(
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
    from ..api.scenarios import scenarios as shipped_scenarios

    if block:
        block = resolve_name(BLOCKS, block, "block")
    folder = scenarios or shipped_folder()
    if not folder.is_dir():
        out.print(f"No scenarios: there is no folder {escape(str(folder))}")
        return
    if scenarios:
        tables = [read_toml(file) for file in sorted(folder.rglob(SCENARIO_FILE))]
        _print_files("Scenarios", [t for t in tables if block in ("", t.string("fmu"))])
    elif block:
        _print_files("Scenarios", [read_toml(folder / name / SCENARIO_FILE) for name in shipped_scenarios(block)])
    else:
        _print_blocks({name: len(shipped_scenarios(name)) for name in BLOCKS})
    if not block:
        _print_files("Lines", [read_toml(file) for file in sorted(folder.rglob(LINE_FILES))])
    if not (block or scenarios):
        out.print(
            "\nmotionsync list FlyingSaw lists the scenarios of a block; motionsync run and motionsync line run them."
        )


def _print_blocks(counts: Mapping[str, int]) -> None:
    table = Table("block", "scenarios", "what it does", box=None)
    for name, count in counts.items():
        table.add_row(name, str(count), block_summary(name))
    print_table(table)


def _print_files(title: str, files: list[TomlTable]) -> None:
    """Print the names by which files are run, and their titles; without files nothing is printed."""
    if not files:
        return
    table = Table("name", "title", title=f"\n{title}", title_justify="left", box=None)
    table.columns[0].overflow = "fold"
    for each in files:
        table.add_row(scenario_name(each.file), each.string("title"))
    print_table(table)
