"""The window of sync: the slave over the master from some material before a cut to some after it.

Positions of the master count from the cut, in its own travel; those of the slave from where the blade cuts. d1, d2, d3
are the derivatives of the slave's position by the master's.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..arcsine import arcsine
from .knife import Knife

WIDEST_HALF = 0.15  # of the circumference, for either half of a HORIZONTAL window; at 1 / (2 pi) the edge moves upright
PARK_MARGIN = 1e-9  # of a turn: how far the park angle is from both windows at least
TWO_PI = 6.283185307179586


@dataclass(slots=True)
class CurvePoint:
    """The slave where the master is at some position: its position and the derivatives by the master's."""

    position: float = 0.0
    d1: float = 0.0
    d2: float = 0.0
    d3: float = 0.0

    def set(self, position: float, d1: float, d2: float, d3: float) -> None:
        self.position = position
        self.d1 = d1
        self.d2 = d2
        self.d3 = d3


@dataclass(slots=True)
class Window:
    """The law of a window. TANGENTIAL: s = slope x. HORIZONTAL: s = radian arcsin(rate x), so that the edge's place
    along the material is that of the material.

    Attributes:
        is_horizontal: which of the two it is.
        before, after: the master's travel before and after the cut.
        slope: d1 at the cut; k' = k (1 + overspeed) where it is TANGENTIAL, else k.
        rate: HORIZONTAL: the cylinder's angle at the cut, in rad per travel of the master; else 0.
        radian: the slave's travel per rad of the cylinder.
        begin, end: the slave at -before and at after.
    """

    is_horizontal: bool = False
    before: float = 20.0
    after: float = 20.0
    slope: float = 0.6
    rate: float = 0.0
    radian: float = 57.29577951308232
    begin: CurvePoint = var.part(CurvePoint)
    end: CurvePoint = var.part(CurvePoint)

    def set(self, knife: Knife, factor: float, before: float, after: float, overspeed: float) -> None:
        """The window of so much material before and after the cut, u, of which `factor` passes per travel of the
        master; the blade is faster by the share `overspeed` (TANGENTIAL only)."""

    def at(self, travel: float) -> tuple[float, float, float, float]:
        """The slave's position and d1, d2, d3 where the master is `travel` beyond the cut."""
        return 0.0, 0.0, 0.0, 0.0

    def way_to_next(self, next: "Window", spacing: float) -> float:
        """S: the slave's travel from the end of this window to the beginning of the next blade's."""
        return 0.0


def has_way(knife: Knife, before: float, after: float, overspeed: float) -> bool:
    """Whether windows of so much material, u, are narrow enough, and leave the knife a way from one to the next on which
    the park angle is."""
    return False
