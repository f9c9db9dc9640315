"""The knife between two windows: it turns on, or it stops at its park angle and starts again.

All sections are quintics through six values (VDI 2143, general polynomial of order 5). Positions of master and slave may
count from anywhere, as long as all of a call count from the same; d1, d2, d3 are the derivatives of the slave's position
by the master's.
"""

from dataclasses import dataclass

from .. import var
from ..laws import Quintic
from ..quintic_peaks import QuinticPeaks
from .knife import Knife
from .window import CurvePoint, Window

TURNING_BACK = 1e-12  # of the slope at the cut: a least slope that is below 0 by no more is rounding


@dataclass(slots=True)
class Section:
    """One quintic: the slave over the master from `begin` to `end`; outside it the slave is as at the nearer end."""

    begin: float = 0.0
    end: float = 0.0
    quintic: Quintic = var.part(Quintic)

    def at(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position and d1, d2, d3. In time, the slave moves by `laws.chain_rule` of these."""
        return 0.0, 0.0, 0.0, 0.0


@dataclass(slots=True)
class Peaks:
    """The greatest magnitudes of d1, d2, d3 over one or more curves. On a line of velocity v the slave's are d1 v,
    d2 v2, d3 v3."""

    d1: float = 0.0
    d2: float = 0.0
    d3: float = 0.0

    def clear(self) -> None:
        """No curve."""

    def include_point(self, point: CurvePoint) -> None:
        """A half of a window counts, too, whose end this is: all three are greatest there."""

    def include(self, other: "Peaks") -> None:
        """Other curves count, too."""


@dataclass(slots=True)
class Way:
    """What leads to the window of a cut: one section, or a ramp down to rest and one up from it.

    Attributes:
        is_found: there is such a way; else the rest means nothing.
        parks: the knife comes to rest on it.
        first: the section that turns on, or the ramp down; it begins where the way does.
        ramp_up: of a way that parks; the knife rests from the end of `first` to its beginning.
        peaks: of the sections, and of the half of a window into which they lead.
    """

    is_found: bool = False
    parks: bool = False
    first: Section = var.part(Section)
    ramp_up: Section = var.part(Section)
    peaks: Peaks = var.part(Peaks)
    quintic_peaks: QuinticPeaks = var.part(QuinticPeaks)

    def plan(
        self, knife: Knife, begin: float, point: CurvePoint, window: Window, cut: float, position: float, shorten: bool
    ) -> None:
        """Turning on if that never turns back; else, if the knife may park, by a ramp down and one up.

        The way begins with the master at `begin` and the slave at `point`, and leads to the window about the master's
        position `cut`, where the slave's is `position`. With `shorten`, ramps that do not fit are shortened."""

    def plan_turning(self, begin: float, point: CurvePoint, window: Window, cut: float, position: float) -> None:
        """Turning on: the section from `point` to the window's beginning; not found if it turns back."""

    def plan_parking(
        self, knife: Knife, begin: float, point: CurvePoint, window: Window, cut: float, position: float, shorten: bool
    ) -> None:
        """A ramp down at once, and one up as late as possible, to and from the park angle before the cut.

        Where both do not fit, `shorten` shortens both in the same ratio; else no way is found."""

    def plan_ramp_up(self, knife: Knife, window: Window, cut: float, position: float) -> None:
        """Out of rest alone: `ramp_up` begins where it has to; it always exists."""

    def plan_ramp_down(self, begin: float, point: CurvePoint, rest: float) -> None:
        """To rest alone, where the slave's position is `rest`: `first`; not found if `rest` is not ahead."""


def ramp_travel(distance: float, d1: float, d2: float) -> float:
    """W: the master's travel over a ramp between rest and a state with d1 and d2 that is `distance` of the slave away.

    d2 counts positive where the slope grows with the distance from rest. 0 where there is no such ramp."""
    return 0.0
