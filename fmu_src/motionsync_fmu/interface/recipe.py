"""What an FMU is built from, and what follows from that alone: its block and its variables."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any

from motionsync.blocks import BLOCKS
from motionsync.var import Role

from ..errors import UserError, choose
from .causality import Interface
from .quantities import read_number
from .roles import PieceVariables, find_by_role, piece_variables
from .units import BASES, DEGREE, unit_name
from .variables import Variable, variables


class Fmi(StrEnum):
    """The version of the standard."""

    TWO = "2"
    THREE = "3"


@dataclass(frozen=True)
class Recipe:
    """What an FMU is built from.

    Attributes:
        name: the block's name.
        unit: the unit of positions, a key of BASES.
        starts: start values to bake in, as texts by the variables' names; a number may have a unit.
        slave_unit: the unit of the slave's positions, for a block whose axes may have different units; where none is
            given that of `default_slave_unit`; empty: the same as `unit`.
        interface: the variables with another causality than the block declares.
        fmi: the version of the FMU.
    """

    name: str
    unit: str = "mm"
    starts: Mapping[str, str] = field(default_factory=dict)
    slave_unit: str = ""
    interface: Interface = field(default_factory=Interface)
    fmi: Fmi = Fmi.TWO

    def __post_init__(self) -> None:
        if not self.slave_unit and self.name in BLOCKS:
            object.__setattr__(self, "slave_unit", default_slave_unit(BLOCKS[self.name]))

    def block(self) -> Any:
        """A new block with the baked start values.

        Raises:
            UserError: an unknown block, unit or variable, a value that the variable does not allow, a slave unit for a
                block whose slave is in the master's unit, or a causality override that is refused.
        """
        block = choose(BLOCKS, self.name, "block")()
        self.interface.causalities(block)
        choose(BASES, self.unit, "unit")
        check_slave_unit(block, self.slave_unit)
        if self.starts:
            settable = {v.name: v for v in variables(block) if v.settable}
            for name, text in self.starts.items():
                v = choose(settable, name, f"parameter or input of {self.name}")
                v.cell.set(parse(v, text, self.unit, self.slave_unit))
        return block

    @cached_property
    def variables(self) -> Mapping[str, Variable]:
        """The declared variables by name, in the order of their value references, with the baked start values.

        Use them for declarations and start values only. Their cells belong to a separate block that is never stepped;
        to run a block, take the cells from `variables(block)`.
        """
        block, overrides = self.block(), self.causality_overrides
        return variables_by_name(block, overrides) if self.starts or overrides else declared_variables(block.__class__)

    @cached_property
    def piece_variables(self) -> PieceVariables | None:
        """The variables by which the block reports its pieces; None for a block that does not.

        Raises:
            KeyError: as the function of that name.
        """
        return piece_variables(self.variables.values())

    @cached_property
    def causality_overrides(self) -> Mapping[str, str]:
        """The causality of each variable that has another one than the block declares, by name.

        Raises:
            UserError: an unknown block, or a causality override that is refused.
        """
        return MappingProxyType(self.interface.causalities(choose(BLOCKS, self.name, "block")()))


@cache
def declared_variables(block_type: type) -> Mapping[str, Variable]:
    """The variables of a block without baked start values: the same for all its recipes, so that a hundred scenarios
    share them."""
    return variables_by_name(block_type(), {})


def variables_by_name(block: Any, overrides: Mapping[str, str]) -> Mapping[str, Variable]:
    """The variables of a block; `overrides`: as for `variables`."""
    return MappingProxyType({v.name: v for v in variables(block, overrides)})


def default_slave_unit(block_type: type) -> str:
    """The unit of the slave's positions where none is given: deg for a block whose tool turns (it has CUT_SPACING); for
    the others empty, which is the master's."""
    return DEGREE if find_by_role(declared_variables(block_type).values(), Role.CUT_SPACING) else ""


def check_slave_unit(block: Any, unit: str) -> None:
    """Refuse an unknown slave unit, and any slave unit for a block whose axes have the same unit.

    Raises:
        UserError: the slave unit is refused; the message says for which of the two reasons.
    """
    if unit:
        choose(BASES, unit, "slave unit")
        if not any(v.declaration.unit.slave for v in variables(block)):
            raise UserError(f"slave unit {unit!r}: the slave of {type(block).__name__} is in its master's unit")


def parse(v: Variable, text: str, unit: str, slave_unit: str = "") -> Any:
    """The start value for a text: a number, also one with a unit, true or false, or the name or number of an
    enumeration's member. `unit`, `slave_unit`: of positions, as in a recipe.

    Raises:
        UserError: the text is none of these, or the value is outside the variable's limits.
    """
    value: Any = None
    if v.kind == "Boolean":
        value = {"true": True, "false": False, "1": True, "0": False}.get(text.lower())
    elif v.choices and text.upper() in (names := {member.name.upper(): member.value for member in v.choices}):
        value = names[text.upper()]
    elif v.kind == "Real":
        try:
            value = read_number(text, unit_name(v.declaration.unit, unit, slave_unit))
        except UserError as e:
            raise UserError(f"{v.name}={text}: {e}") from None
    else:
        with suppress(ValueError):
            value = int(text)
    if value is None:
        raise UserError(f"{v.name}={text}: {text!r} is not allowed: it must be {v.allowed_values}")
    if refusal := v.refusal(value):
        raise UserError(refusal)
    return value
