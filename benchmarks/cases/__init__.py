"""What each block is measured in: steps that are all alike, and the longest ones, in which commands are planned.

The module with the name of a block's folder has the cases of the block; the measuring is the same for all blocks.
"""

from importlib import import_module
from importlib.util import find_spec

from cases.measured import Cases
from motionsync_fmu.interface.recipe import Recipe


def cases_of(name: str) -> Cases:
    """The cases of the block of that name.

    Raises:
        LookupError: the block has none; the text says which file is missing.
    """
    folder = type(Recipe(name).block()).__module__.split(".")[1]
    if not find_spec(f"cases.{folder}"):
        raise LookupError(f"{name} needs benchmarks/cases/{folder}.py")
    result: Cases = import_module(f"cases.{folder}").CASES
    return result
