"""The tunable parameters that all machines have, validated: the last valid ones are the settings.

A parameter may be tuned at any time and to any value. A block computes with its settings, which take over the values of
a group only if all of them are valid, each within its declared range.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import is_usable
from .faults import Contradiction
from .interface import (
    CuttingInterface,
    CycleParameters,
    LineParameters,
    Mark,
    MarkParameters,
    PieceParameters,
    StartParameters,
)


@dataclass(slots=True)
class CuttingSettings:
    """The values of each group of parameters when all in it were valid last.

    Attributes:
        factor: true travel of the material per travel of the master, calibration included.
    """

    factor: float = 1.0
    cycle: CycleParameters = var.part(CycleParameters, hidden=True)
    piece: PieceParameters = var.part(PieceParameters, hidden=True)
    start: StartParameters = var.part(StartParameters, hidden=True)
    mark: MarkParameters = var.part(MarkParameters, hidden=True)
    line: LineParameters = var.part(LineParameters, hidden=True)

    def take_over(self, block: CuttingInterface) -> None:
        """Become the block's parameters, group by group, as far as they are valid."""
        if is_factor_usable(block):
            var.copy_valid(self.cycle, block)
            var.copy_valid(self.piece, block)
            var.copy_valid(self.start, block)
        if has_narrow_window(block.mark):
            var.copy_valid(self.mark, block.mark)
        var.copy_valid(self.line, block.line)

    def are_current(self, block: CuttingInterface) -> bool:
        """Whether they are the block's parameters: none is invalid, and none was tuned since they were taken over."""
        return self.has_cycle(block) and var.same(self.start, block) and var.same(self.mark, block.mark)

    def has_cycle(self, block: CuttingInterface) -> bool:
        """Whether all is valid that a cycle reads."""
        return var.same(self.cycle, block) and var.same(self.line, block.line)

    def has_piece(self, block: CuttingInterface) -> bool:
        """Whether all is valid that a piece is fixed with."""
        return var.same(self.piece, block)


def contradiction(block: CuttingInterface) -> Contradiction:
    """Which parameters contradict one another; each is within its range."""
    if not is_factor_usable(block):
        return Contradiction.FACTOR
    return Contradiction.NONE if has_narrow_window(block.mark) else Contradiction.WINDOWS_MEET


def is_factor_usable(block: CuttingInterface) -> bool:
    """Whether the material's travel can be computed with the present factor of calibration."""
    return is_usable(block.material_factor * block.calibration.factor)


def has_narrow_window(mark: Mark) -> bool:
    """Whether the windows of two consecutive marks do not meet."""
    return mark.spacing == 0.0 or mark.window < 0.5 * mark.spacing
