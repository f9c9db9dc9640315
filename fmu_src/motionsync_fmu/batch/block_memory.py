"""What is the same in all runs of a recipe: the block's memory, and where its variables are in it."""

from array import array
from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

from ..compiler import memory_layout
from ..errors import choose
from ..interface.recipe import Recipe
from ..interface.variables import Variable
from ..runner.host import Stored
from ..scenario.run.tables import RunTables
from .block_description import refusals_by_number, start_memory
from .simulation import limits

STORED = {"Real": Stored.REAL, "Integer": Stored.WORD, "Enumeration": Stored.WORD, "Boolean": Stored.FLAG}


class Field(NamedTuple):
    """Where a variable is in the block's memory, how it is stored, and whether each step checks it."""

    offset: int
    stored: Stored
    checked: bool


class BlockMemory:
    """What is the same in all runs of a recipe.

    Attributes:
        type: the block's class.
        variables: its variables by name.
        image: its memory with the start values of the recipe.
        fields: where each variable is in the memory.
        refusals: the members of its `Refusal` by their numbers.
        unset: the settable variables whose own start values are not allowed.
    """

    def __init__(self, recipe: Recipe) -> None:
        block = recipe.block()
        self.type = block.__class__
        self.variables = recipe.variables
        self.image = memory_layout.image(block) if recipe.starts else start_memory(self.type)
        layout = self.image.dtype
        self.fields = {
            v.name: Field(memory_layout.offset(layout, v.name), STORED[v.kind], v.checked)
            for v in self.variables.values()
        }
        self.unset = {v.name for v in self.variables.values() if v.settable and not v.allows(v.start)}
        self.refusals = refusals_by_number(self.type)

    def set_host(self, tables: RunTables, address: int, outputs: Iterable[str], checked: Iterable[Variable]) -> None:
        """State where the memory of a run's block is, and the variables of the run in it: the outputs that are
        recorded, and the Reals that each step checks.

        Raises:
            UserError: the block has no output of a name.
        """
        host, checked = tables.run.host, list(checked)
        host.block = address
        offsets = [self.fields[name].offset for name in tables.inputs]
        host.position, host.velocity, host.acceleration, host.cycle_index = (*offsets, 0)[:4]
        host.sets, host.sees, host.records = map(self.places, (tables.sets, tables.sees, outputs))
        host.checks = array("q", [self.fields[v.name].offset for v in checked])
        host.limits = array("d", [limit for v in checked for limit in limits(v)])

    def places(self, names: Iterable[str]) -> "array[int]":
        """Where variables are, as `runner.host` has it: offset and kind of each.

        Raises:
            UserError: the block has no variable of a name.
        """
        fields = (choose(self.fields, name, f"variable of {self.type.__name__}") for name in names)
        return array("q", [number for field in fields for number in (field.offset, field.stored)])


def block_memory(recipe: Recipe) -> BlockMemory:
    """What is the same in all runs of a recipe; of a block as it is declared it is made once, in milliseconds."""
    return BlockMemory(recipe) if recipe.starts or recipe.causality_overrides else _declared(recipe.name)


@cache
def _declared(name: str) -> BlockMemory:
    return BlockMemory(Recipe(name))
