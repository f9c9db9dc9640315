"""What blocks are measured in: steps that are all alike, and the longest ones, in which commands are planned.

The module with the name of a block's folder has the cases of the block; the measuring is the same for all blocks.
"""

from importlib import import_module
from importlib.util import find_spec

from cases.measured import Cases
from motionsync.blocks import BLOCKS


def _module(name: str) -> str:
    return f"cases.{BLOCKS.modules[name].split('.')[1]}"


MEASURED = tuple(name for name in BLOCKS if find_spec(_module(name)))
"""The blocks that have cases."""


def cases_of(name: str) -> Cases:
    """The cases of a block of MEASURED."""
    result: Cases = import_module(_module(name)).CASES
    return result
