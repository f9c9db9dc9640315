"""What a process finds out once about a block's class: its declarations take as long to read as many thousand steps."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from numpy.typing import NDArray

from ...interface.recipe import declared
from ...interface.variables import Variable, refusals
from ..memory_layout import image

_described: dict[type[Any], "Described"] = {}


def described(block_type: type[Any]) -> "Described":
    """What is known of a block's class; found out as it is asked for."""
    return _described.setdefault(block_type, Described(block_type))


class Described:
    """A block's class, of which nobody may change what is told here."""

    def __init__(self, block_type: type) -> None:
        self._type = block_type

    @property
    def variables(self) -> Mapping[str, Variable]:
        """The variables of a new block by name, in their order, with the causalities that are declared."""
        return declared(self._type)

    @cached_property
    def memory(self) -> NDArray[Any]:
        """The memory of a new block: a NumPy record."""
        memory = image(self._type())
        memory.flags.writeable = False
        return memory

    @cached_property
    def refusals(self) -> Mapping[int, Any]:
        """What the block's calls may answer beside 0, by number."""
        return {member.value: member for member in refusals(self._type)}
