"""What is read from a block's declarations once in a process: it takes as long as many steps."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from numpy.typing import NDArray

from ..compiler.memory_layout import image
from ..interface.variables import refusals


@cache
def start_memory(block_type: type) -> NDArray[Any]:
    """The memory of a new block: a NumPy record, which cannot be written."""
    memory = image(block_type())
    memory.flags.writeable = False
    return memory


@cache
def refusals_by_number(block_type: type) -> Mapping[int, Any]:
    """The refusals that the block's calls may return."""
    return {member.value: member for member in refusals(block_type)}
