"""What a rotary knife can do: how fast the line may be for a piece, and which pieces it can cut.

On a line of velocity v, a curve with the greatest d1, d2, d3 takes the velocity d1 v, the acceleration d2 v2 and the jerk
d3 v3; the axis's limits of these give the greatest v. Z is the master's travel between two windows.
"""

from dataclasses import dataclass

from .. import var
from .curves import Peaks, Way
from .knife import Knife
from .window import CurvePoint, Window

PUNCTUAL = 1.0 + 1e-9  # of a greatest line velocity: a cut is late above this
NO_LENGTH = 1e12  # u: the shortest piece where there is none


def admissible_velocity(knife: Knife, peaks: Peaks) -> float:
    """The greatest line velocity, u/s of the master, at which curves with these peaks keep the axis's limits."""
    return 0.0


def keeps_limits(knife: Knife, peaks: Peaks, velocity: float) -> bool:
    """Whether curves with these peaks keep the axis's limits at a line velocity, but for rounding: the cut is not
    late."""
    return False


@dataclass(slots=True)
class CycleLimit:
    """The greatest line velocity of a cycle.

    Attributes:
        max_line_velocity: u/s of the master; 0 where no line is slow enough.
        peaks: of the whole cycle, both half-windows included.
        way: between the windows, with the master counted from the cut before it.
    """

    max_line_velocity: float = 0.0
    peaks: Peaks = var.part(Peaks)
    way: Way = var.part(Way)

    def solve_piece(self, knife: Knife, leaving: Window, entering: Window, pitch: float) -> None:
        """From one cut to the next one, `pitch` of the master later; UNLIMITED is the pitch of a piece that parks."""

    def solve_ramp_up(self, knife: Knife, entering: Window) -> None:
        """Out of rest to the cut."""


@dataclass(slots=True)
class LengthLimits:
    """Which pitches are possible between two equal windows: computed once for a window, and for each line velocity.

    Attributes:
        window_travel: the master's travel in a window.
        longest: the longest pitch without parking.
        fastest: the pitch that admits the greatest line velocity among those without parking.
        max_line_velocity: at that pitch, u/s of the master.
        shortest: the shortest pitch at the line velocity for which it was solved; NO_LENGTH if there is none.
    """

    window_travel: float = 0.0
    longest: float = 0.0
    fastest: float = 0.0
    max_line_velocity: float = 0.0
    shortest: float = 0.0
    cycle: CycleLimit = var.part(CycleLimit)

    def prepare(self, knife: Knife, window: Window) -> None:
        """Find what does not depend on the line's velocity."""

    def solve_shortest(self, knife: Knife, window: Window, velocity: float) -> None:
        """Find the shortest pitch at a line velocity > 0, for the window that was prepared."""


@dataclass(slots=True)
class EarliestCut:
    """The earliest cut that can be reached from where the knife is within the limits at a line velocity.

    Attributes:
        is_found: there is one.
        cut: the master's position at it.
        way: the way to it.
    """

    is_found: bool = False
    cut: float = 0.0
    way: Way = var.part(Way)

    def find_turning(
        self,
        knife: Knife,
        begin: float,
        point: CurvePoint,
        window: Window,
        position: float,
        velocity: float,
        least: float,
        greatest: float,
    ) -> None:
        """Turning on, to a cut from `least` up to `greatest`, positions of the master; `position` is the slave's at the
        cut."""

    def find_parking(
        self,
        knife: Knife,
        begin: float,
        point: CurvePoint,
        window: Window,
        position: float,
        velocity: float,
        least: float,
    ) -> None:
        """Out of rest, to a cut from `least` on."""
