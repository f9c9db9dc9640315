"""The page on which a block is explored: one file that holds the block as WebAssembly, its scenarios and all else."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from markupsafe import Markup

from ..batch.library import BATCH_FOLDER, run_source
from ..fmus.guid import compute_guid
from ..interface.recipe import Recipe
from ..native.instance_sources import c_names, c_sources
from ..native.wasm.component import core_module
from ..pages.machine.fragment import live_machine
from ..pages.packed import packed, packed_json
from ..pages.style import load_template
from ..paths import replace_file
from ..scenario.files.example import load_example
from ..scenario.files.reader import load_scenario
from ..scenario.files.shipped import find_files
from ..scenario.scenario import Scenario
from .data import page_data
from .opening import opening_of

FOLDER = Path(__file__).parent
VENDOR = FOLDER.parent / "pages" / "vendor"
HOST = ("block_memory.h", "limits.h", "run_host.h")  # of runs, in the folder of batches
UNUSED = ("fmi", "memory")  # how the names of C files start that a page does not need
SCRIPTS = (
    "../pages/packed.js",
    "../pages/machine/machine_data.js",
    "remote_errors.js",
    "tables.js",
    "run.js",
    "measured_line.js",
    "scenario_file.js",
    "programs.js",
    "controls.js",
    "plots.js",
    "messages.js",
    "address.js",
    "explore.js",
)


def scenarios_of(name: str) -> list[Scenario]:
    """The scenarios of a block that come with motionsync: that with which its page opens, its example, all others."""
    opening = opening_of(name).scenario
    scenarios = [load_example(name), *(load_scenario(file) for file in find_files(Path(name)))]
    return sorted(scenarios, key=lambda s: s.name != opening)


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
    code = _compile(recipe)
    page = load_template(FOLDER, "explore.html.j2").render(
        data=data,
        packed={"data": packed_json(data), "code": packed(code)},
        machine=live_machine(),
        style=Markup(_text(FOLDER / "explore.css") + _text(VENDOR / "uPlot.min.css")),
        bundle=Markup(_text(VENDOR / "uPlot.iife.min.js")),
        scripts=Markup("\n".join(_text(FOLDER / script) for script in SCRIPTS)),
    )
    with replace_file(target) as part:
        part.write_bytes(page.encode())


def _compile(recipe: Recipe) -> bytes:
    """The block and the runner of scenarios as one WebAssembly module; web.c shows what it exports."""
    sources = c_sources(recipe.block(), compute_guid(recipe))
    unit = {name: text for name, text in sources.items() if not name.startswith(UNUSED)}
    host = {file.name: file.read_bytes() for file in (FOLDER / "web.c", *(BATCH_FOLDER / name for name in HOST))}
    files = unit | host | {"run.h": run_source()}
    return core_module(files, c_names(files))


@cache
def _text(file: Path) -> str:
    return file.read_text("utf-8")
