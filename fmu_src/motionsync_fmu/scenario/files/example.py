"""A block's example: the scenario `example.toml` in the folder of the block."""

from motionsync.blocks import BLOCKS

from ...errors import choose
from ...interface.block_folder import block_file
from ..scenario import Scenario
from .reader import load_scenario

FILE = "example.toml"


def load_example(name: str) -> Scenario:
    """The example of the block with this name.

    Raises:
        UserError: no block has this name, or the first mistake in the example.
    """
    return load_scenario(block_file(choose(BLOCKS, name, "block"), FILE))
