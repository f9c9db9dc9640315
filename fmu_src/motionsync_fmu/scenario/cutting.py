"""What a scenario expects of the cuts of a saw, or of the pieces that a block itself reports."""

from dataclasses import dataclass

import numpy as np

from ..interface.units import BASES
from .recording import Reals

USUAL_TOLERANCE = 1e-4  # m: how far a cut may be from its mark where the scenario gives no tolerance


def usual_tolerance(unit: str, length: float) -> float:
    """The tolerance of a scenario that gives none: 0.1 mm, or a ten-thousandth of `length`, the distance of the marks,
    where positions are angles or pure numbers."""
    base, size = BASES[unit]
    return USUAL_TOLERANCE / size if base == "m" else 1e-4 * length


@dataclass(frozen=True)
class CutSpec:
    """How cuts are detected and checked: the slave is a saw that cuts the master's material while a Boolean is true.

    Attributes:
        name: the name of the Boolean.
        length: distance of the marks on the material, in u; one of them is at `offset`.
        ratio: the slave's travel over the master's.
        tolerance: the greatest allowed distance of a cut from its mark, in u.
        count: how many cuts there have to be; None: any number.
        skipped: how many marks have to pass uncut after the first cut.
        movement: how far the tool may move against the material while it cuts, in u; None: as far as `tolerance` says.
    """

    name: str
    length: float
    offset: float
    ratio: float
    tolerance: float
    count: int | None
    skipped: int = 0
    movement: float | None = None

    def nearest_marks(self, positions: Reals) -> Reals:
        """The position of the mark that is nearest to each of these positions on the material."""
        return np.asarray(self.offset + np.rint((positions - self.offset) / self.length) * self.length)


@dataclass(frozen=True)
class PieceSpec:
    """How the pieces are checked that a block itself reports.

    Attributes:
        tolerance: how far a length may be off, and a cut from where the block reports it, in u.
        count: how many pieces there have to be; None: any number.
        skipped, late: how many cuts have to be skipped, or made late.
        lengths: the lengths that they have to have, in u; None: a product has to have its ordered length.
        kinds: the names of the kinds that they have to be of; None: any.
        movement: how far the tool may move against the material while it cuts, in u; None: as far as `tolerance` says.
        orders_left: how many orders have to be left at the end; None: any number.
    """

    tolerance: float
    count: int | None = None
    skipped: int = 0
    late: int = 0
    lengths: tuple[float, ...] | None = None
    kinds: tuple[str, ...] | None = None
    movement: float | None = None
    orders_left: int | None = None
