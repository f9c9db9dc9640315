"""motionsync new"""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..pages.console import out
from ..paths import replace_file
from ..scenario.files.shipped import SCENARIO_FILE


def command(
    block: Annotated[str, typer.Argument(help="The block that the scenario runs.")],
    folder: Annotated[Path, typer.Argument(help="Where to write scenario.toml; the folder is made if it is missing.")],
) -> None:
    """Write a scenario that runs, as the start of one of your own.

    Example:

        motionsync new FlyingSaw my_saw
    """
    from ..scenario.files.template import make_template

    name, file = resolve_name(BLOCKS, block, "block"), folder / SCENARIO_FILE
    if file.exists():
        raise UserError(f"{file} exists: name another folder")
    text = make_template(name)
    with replace_file(file) as part:
        part.write_text(text, "utf-8")
    out.print(f"written: {escape(str(file))}")
    out.print(f"run it:  motionsync run {escape(str(folder))} --open")
    out.print(f"names:   motionsync describe {name}")
