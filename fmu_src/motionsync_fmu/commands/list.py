"""motionsync list"""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from motionsync.blocks import BLOCKS

from ..interface.variables import summary
from ..pages.console import out, wide


def list_all(
    scenarios: Annotated[Path, typer.Option(help="Where scenarios lie.")] = Path("scenarios"),
) -> None:
    """List the blocks that can be built, and the scenarios and lines that can be run.

    Example: motionsync list --scenarios scenarios/Synchronizer
    """
    from ..line.reader import PATTERN, load_line
    from ..scenario.reader import FILE, load

    blocks = Table("block", "what it does", title="Blocks", title_justify="left", box=None)
    for name, block_type in BLOCKS.items():
        blocks.add_row(name, summary(block_type))
    wide.print(blocks)
    if not scenarios.is_dir():
        out.print(f"\nNo scenarios: there is no folder {escape(str(scenarios))}")
        return
    table = Table("path", "title", "source", title="\nScenarios", title_justify="left", box=None)
    for file in sorted(scenarios.rglob(FILE)):
        s = load(file)
        table.add_row(str(file.parent), s.title, s.source)
    wide.print(table)
    lines = Table("path", "title", "source", title="\nLines", title_justify="left", box=None)
    for file in sorted(scenarios.rglob(PATTERN)):
        s = load_line(file).follower
        lines.add_row(str(file), s.title, s.source)
    if lines.rows:
        wide.print(lines)
