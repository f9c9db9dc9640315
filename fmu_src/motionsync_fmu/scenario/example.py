"""A block's example: the scenario `example.toml` in the folder of the block."""

import sys
from pathlib import Path

from motionsync.blocks import BLOCKS

from ..errors import choose
from .reader import load
from .scenario import Scenario

FILE = "example.toml"


def example_of(name: str) -> Scenario:
    """The example of the block with this name.

    Raises:
        UserError: no block has this name, or the first mistake in the example.
    """
    block_type = choose(BLOCKS, name, "block").type
    module = str(sys.modules[block_type.__module__].__file__)
    return load(Path(module).with_name(FILE))
