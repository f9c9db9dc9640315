"""The page on which a block is explored: one file that holds the block as WebAssembly, its scenarios and all else."""

import base64
import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from markupsafe import Markup

from ..archive import packed
from ..interface.recipe import Recipe
from ..pages.machine.fragment import live_machine
from ..pages.style import TEMPLATES
from ..scenario.reader import load
from ..scenario.scenario import Scenario
from ..scenario.shipped import find
from .data import page_data
from .module import webassembly

HERE = Path(__file__).parent
VENDOR = HERE.parent / "pages" / "vendor"
SCRIPTS = ("run.js", "scenes.js", "written.js", "programs.js", "controls.js", "plots.js", "explore.js")


def scenarios_of(name: str) -> list[Scenario]:
    """The scenarios of a block that come with motionsync."""
    return [load(file) for file in find(Path(name))]


def write_page(
    name: str,
    scenarios: Sequence[Scenario],
    fmu: Path,
    target: Path,
    progress: Callable[[str], None] = lambda text: None,
) -> None:
    """Write the page of a block with these scenarios, the first one shown; `fmu`: the block's native FMU.

    `progress` is called with a line of text before each task.

    Raises:
        UserError: no block has this name, or zig failed.
    """
    recipe = Recipe(name)
    progress(f"running {len(scenarios)} scenarios natively")
    data = page_data(name, scenarios, fmu)
    progress("compiling to WebAssembly")
    code = webassembly(recipe.block(), recipe.guid())
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    page = TEMPLATES.from_string((HERE / "explore.html.j2").read_text("utf-8")).render(
        data=data,
        packed={"data": _packed(text.encode()), "code": _packed(code)},
        machine=live_machine(),
        style=Markup(_text(HERE / "explore.css") + _text(VENDOR / "uPlot.min.css")),
        bundle=Markup(_text(VENDOR / "uPlot.iife.min.js")),
        scripts=Markup("\n".join(_text(HERE / script) for script in SCRIPTS)),
    )
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(page.encode())


def _packed(data: bytes) -> str:
    return base64.b64encode(packed(data)).decode()


@cache
def _text(file: Path) -> str:
    return file.read_text("utf-8")
