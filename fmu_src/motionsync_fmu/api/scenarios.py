"""The scenarios that come with motionsync, by name."""

from motionsync.blocks import BLOCKS

from ..errors import resolve_name
from ..scenario.files.shipped import SCENARIO_FILE, scenario_name, shipped_folder


def scenarios(block: str = "") -> list[str]:
    """The short names of the scenarios that come with motionsync, of one block or of all.

    Raises:
        UserError: no block has this name.
    """
    folder = shipped_folder() / (resolve_name(BLOCKS, block, "block") if block else "")
    return [scenario_name(file) for file in sorted(folder.rglob(SCENARIO_FILE))]
