"""A block's example: the scenario `example.toml` in the folder of the block."""

from motionsync.blocks import BLOCKS

from ..archive import beside
from ..errors import choose
from .reader import load
from .scenario import Scenario

FILE = "example.toml"


def example_of(name: str) -> Scenario:
    """The example of the block with this name.

    Raises:
        UserError: no block has this name, or the first mistake in the example.
    """
    return load(beside(choose(BLOCKS, name, "block"), FILE))
