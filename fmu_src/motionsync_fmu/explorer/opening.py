"""How the page of a block opens: `explore.toml` in the block's folder, which a block may lack.

- `scenario`: the name of the scenario that the page opens with; without it, the block's example.
- `main`: what is most worth changing, the first thing first: inputs and parameters; `master.velocity`, with which the
  line starts, or to which it ramps up from rest; `cuts.length`, the distance of the scenario's marks. The page has them
  at the top, with sliders.
"""

from dataclasses import dataclass

from motionsync.blocks import BLOCKS

from ..interface.block_folder import block_file
from ..interface.recipe import Recipe
from ..scenario.files.shipped import shipped_folder
from ..scenario.files.toml_tables import read_toml

FILE = "explore.toml"
OF_THE_SCRIPT = ("master.velocity", "cuts.length")  # no start values: the scenario's script has them


@dataclass(frozen=True)
class Opening:
    """The name of the scenario that a page opens with (empty: the example), and the names of its main values."""

    scenario: str = ""
    main: tuple[str, ...] = ()


def opening_of(name: str) -> Opening:
    """How the page of the block with this name opens.

    Raises:
        UserError: the first mistake in its file.
    """
    file = block_file(BLOCKS[name], FILE) if name in BLOCKS else None
    if not (file and file.is_file()):
        return Opening()
    table = read_toml(file)
    table.allow_only("scenario", "main")
    settable = {v.name for v in Recipe(name).variables.values() if v.settable}
    for variable in table.strings("main"):
        if variable not in settable | {*OF_THE_SCRIPT}:
            table.fail("main", f"{variable!r} is no input or parameter of {name}")
    scenario = table.string("scenario", "")
    if not (shipped_folder() / name / scenario).is_dir():
        table.fail("scenario", f"{name} has no scenario {scenario!r}")
    return Opening(scenario, table.strings("main"))
