"""The fault codes of blocks, with the variables that carry them."""

from dataclasses import dataclass
from typing import Any

from motionsync.blocks import BLOCKS

from .variables import members, variables


@dataclass(frozen=True, repr=False)
class FaultCode:
    """A fault code of a block.

    Attributes:
        member: the member of the block's enumeration, with its value, name and description.
        carriers: the variables that have it as a value.
    """

    block: str
    member: Any
    carriers: tuple[str, ...]

    def __repr__(self) -> str:
        return f"{self.block}, {self.number_text} ({self.name}) in {', '.join(self.carriers)}: {self.description}"

    @property
    def number(self) -> int:
        return int(self.member.value)

    @property
    def name(self) -> str:
        return str(self.member.name)

    @property
    def description(self) -> str:
        """What it means, in a sentence."""
        return str(self.member.description)

    @property
    def number_text(self) -> str:
        """The code as the source writes it: `17118 = 0x42DE`, or `3` where it has no hexadecimal numbers."""
        return f"{self.number} = 0x{self.number:04X}" if f"0x{self.number:X}" in self.description else f"{self.number}"

    @property
    def shows(self) -> list[str]:
        """The names of the variables whose values a message shows; `.velocity` is in the group of the error_id."""
        return [f"<command>{name}" if name.startswith(".") else name for name in self.member.names]


def codes_of(name: str, block: Any) -> list[FaultCode]:
    """The fault codes of a block, in the order of its enumerations; 0, which is no fault, is none of them."""
    carriers: dict[Any, list[str]] = {}
    for v in variables(block):
        if v.declaration.codes:
            carriers.setdefault(v.declaration.codes, []).append(v.name)
    return [FaultCode(name, m, tuple(of)) for kind, of in carriers.items() for m in members(kind) if m.value != 0]


def all_codes() -> list[FaultCode]:
    """The fault codes of all blocks."""
    return [code for name, kind in BLOCKS.items() for code in codes_of(name, kind())]
