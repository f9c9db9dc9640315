"""The window of sync: the slave over the master from some material before a cut to some after it.

d1, d2, d3 are the derivatives of the slave's position by the master's. In a `Window` the positions of both count from
the cut.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..numerics.arcsine import arcsine
from ..numerics.computable_range import clamp
from ..numerics.cosine import cosine
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
        master; the blade is faster by the share `overspeed` (TANGENTIAL only). The window has to be narrow enough."""
        self.is_horizontal = knife.is_horizontal
        self.before = before / factor
        self.after = after / factor
        self.radian = knife.turn / TWO_PI
        self.slope = knife.turn / knife.circumference * factor
        self.rate = 0.0
        if knife.is_horizontal:
            self.rate = TWO_PI / knife.circumference * factor
        else:
            self.slope *= 1.0 + overspeed
        self.set_point(self.begin, -self.before)
        self.set_point(self.end, self.after)

    def set_point(self, point: CurvePoint, travel: float) -> None:
        """Set a point to the slave where the master is `travel` beyond the cut."""
        position, d1, d2, d3 = self.at(travel)
        point.set(position, d1, d2, d3)

    def at(self, travel: float) -> tuple[float, float, float, float]:
        """The slave's position and d1, d2, d3 where the master is `travel` beyond the cut.

        HORIZONTAL, with y = rate x: d1 = slope (1 - y2)^(-1/2), d2 = slope rate y (1 - y2)^(-3/2),
        d3 = slope rate2 (1 + 2 y2) (1 - y2)^(-5/2)."""
        if not self.is_horizontal:
            return self.slope * travel, self.slope, 0.0, 0.0
        y = self.rate * travel
        square = (1.0 - y) * (1.0 + y)
        d1 = self.slope / sqrt(square)
        d2 = d1 * self.rate / square
        return self.radian * arcsine(y), d1, d2 * y, d2 * self.rate * (1.0 + 2.0 * y * y) / square

    def way_to(self, following: "Window", spacing: float) -> float:
        """S: the slave's travel from the end of this window to the beginning of the following blade's."""
        return spacing - self.end.position + following.begin.position


@dataclass(slots=True)
class Cut:
    """A cut with its window: the master's position at it is `place`, the slave's is `position`."""

    place: float = 0.0
    position: float = 0.0
    window: Window = var.part(Window)

    def begin(self) -> float:
        """The master's position at the beginning of the window."""
        return self.place - self.window.before

    def end(self) -> float:
        """The master's position at the end of the window."""
        return self.place + self.window.after

    def at(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position and d1, d2, d3 in the window."""
        position, d1, d2, d3 = self.window.at(master - self.place)
        return self.position + position, d1, d2, d3


def widest_half(knife: Knife, overspeed: float, travel: float) -> float:
    """How much material, u, either half of a window may have, where the slave may travel so far in it."""
    if not knife.is_horizontal:
        return max(travel, 0.0) / (knife.turn / knife.circumference * (1.0 + overspeed))
    degrees = clamp(360.0 / knife.turn * travel, 0.0, 90.0)
    return min(WIDEST_HALF, cosine(90.0 - degrees) / TWO_PI) * knife.circumference


def leaves_way(knife: Knife, window: Window) -> bool:
    """Whether the knife has a way from one such window to the next, and the park angle is on it."""
    leaves = window.end.position
    arrives = knife.spacing + window.begin.position
    margin = PARK_MARGIN * knife.turn
    return leaves + margin <= knife.park_angle <= arrives - margin


def is_narrow(knife: Knife, half: float) -> bool:
    """Whether half a window of so much material, u, can be had; a TANGENTIAL one always."""
    return not knife.is_horizontal or half <= WIDEST_HALF * knife.circumference
