"""The page on which a block is explored: one file that holds the block as WebAssembly, its scenarios and all else."""

import base64
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ..archive import quick
from ..interface.recipe import Recipe
from ..pages.machine.fragment import live_machine
from ..pages.style import TEMPLATES
from ..scenario.scenario import Scenario
from .data import page_data
from .module import webassembly

HERE = Path(__file__).parent
VENDOR = HERE.parent / "pages" / "vendor"
SCRIPTS = ("run.js", "scenes.js", "written.js", "programs.js", "controls.js", "plots.js", "explore.js")


def write_page(name: str, scenarios: Sequence[Scenario], fmu: Path, target: Path) -> None:
    """Write the page of a block with these scenarios, the first one shown; `fmu`: the block's native FMU.

    Raises:
        UserError: no block has this name, or zig failed.
    """
    recipe = Recipe(name)
    data = page_data(name, scenarios, fmu)
    code = webassembly(recipe.block(), recipe.guid())
    text = TEMPLATES.from_string((HERE / "explore.html.j2").read_text("utf-8")).render(
        data=data,
        packed={
            "data": _packed(json.dumps(data, separators=(",", ":"), allow_nan=False).encode()),
            "code": _packed(code),
        },
        machine=live_machine(),
        style=Markup(_text(HERE / "explore.css") + _text(VENDOR / "uPlot.min.css")),
        bundle=Markup(_text(VENDOR / "uPlot.iife.min.js")),
        scripts=Markup("\n".join(_text(HERE / script) for script in SCRIPTS)),
    )
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(text.encode())


def _packed(data: bytes) -> str:
    return base64.b64encode(quick(data)).decode()


@cache
def _text(file: Path) -> str:
    return file.read_text("utf-8")
