"""Where the knife leaves for a cut, and which cut it can reach from there."""

from dataclasses import dataclass

from .. import var
from ..cutting.piece import UNLIMITED
from ..master import Master
from .curves import Peaks, Way, keeps_limits
from .cycle import Cycle
from .knife import Knife
from .limits import EarliestCut
from .window import CurvePoint, Cut, Window

MOST_PLACES = 64  # that are tried one by one


@dataclass(slots=True)
class Departure:
    """The knife leaves where the master is at `begin`, u; its position counts from where the blade cuts next.

    Attributes:
        point: the knife where it leaves.
        velocity: the line's, u/s.
        leaving: the peaks of the half of a window that is over, if that belongs to the cycle.
        cut, way: the cut that was tried last, and the way to it.
        is_reached: that way exists, and keeps the limits.
        peaks: those of the way, and of what belongs to the cycle.
        earliest: the search for the earliest cut.
    """

    begin: float = 0.0
    point: CurvePoint = var.part(CurvePoint)
    velocity: float = 0.0
    leaving: Peaks = var.part(Peaks)
    cut: Cut = var.part(Cut)
    way: Way = var.part(Way)
    is_reached: bool = False
    peaks: Peaks = var.part(Peaks)
    earliest: EarliestCut = var.part(EarliestCut)

    def leave_window(self, cut: Cut, spacing: float, velocity: float) -> None:
        """Leave at the end of the window of a cut."""
        self.begin = cut.end()
        end = cut.window.end
        self.point.set(end.position - spacing, end.d1, end.d2, end.d3)
        self.velocity = velocity
        self.leaving.clear()
        self.leaving.include_window_end(end)

    def leave_curve(self, cycle: Cycle, master: Master) -> None:
        """Leave the curve on which the knife is, where the master is now."""
        self.begin = master.path.reached
        position, d1, d2, d3 = cycle.at(self.begin)
        self.point.set(position, d1, d2, d3)
        self.velocity = master.present_velocity()
        self.leaving.clear()

    def include_leaving(self, peaks: Peaks) -> None:
        """The peaks of a way, and of what belongs to the cycle."""
        var.copy(self.peaks, self.leaving)
        self.peaks.include(peaks.d1, peaks.d2, peaks.d3)

    def check(self, knife: Knife) -> None:
        """Whether the way was found, and keeps the limits."""
        self.is_reached = self.way.exists
        if self.is_reached:
            self.include_leaving(self.way.peaks)
            self.is_reached = keeps_limits(knife, self.peaks, self.velocity)

    def aim(self, window: Window, place: float) -> None:
        """The cut is in this window, about a position of the master, u."""
        var.copy(self.cut.window, window)
        self.cut.place = place

    def try_cut(self, knife: Knife, window: Window, cut: float, shorten: bool) -> bool:
        """Find the way to a cut at a position of the master, u, and return whether it keeps the limits."""
        self.aim(window, cut)
        self.way.plan(knife, self.begin, self.point, self.cut, shorten)
        self.check(knife)
        return self.is_reached

    def is_beyond_ramps(self) -> bool:
        """Whether both ramps fit before the cut that was tried last: from there on all cuts are alike."""
        return self.way.exists and self.way.parks and self.way.first.end < self.way.ramp_up.begin

    def try_earliest_turning(self, knife: Knife, window: Window, least: float, greatest: float) -> bool:
        """Find the earliest cut from `least` up to `greatest` to which the knife turns on, positions of the master."""
        if not keeps_limits(knife, self.leaving, self.velocity):
            return False
        self.aim(window, least)
        self.earliest.search.start(self.begin, self.point, self.cut)
        self.earliest.find_turning(knife, self.velocity, least, greatest)
        return self.try_take_earliest()

    def try_earliest(self, knife: Knife, window: Window, least: float) -> bool:
        """Find the earliest cut from `least` on, a position of the master."""
        if self.try_earliest_turning(knife, window, least, UNLIMITED):
            return True
        if not (knife.may_park and keeps_limits(knife, self.leaving, self.velocity)):
            return False
        self.earliest.find_parking(knife, self.velocity, least)
        return self.try_take_earliest()

    def try_take_earliest(self) -> bool:
        """The way to the earliest cut is the one to take, if there is one."""
        self.is_reached = self.earliest.exists
        if self.is_reached:
            self.cut.place = self.earliest.search.cut.place
            var.copy(self.way, self.earliest.search.way)
            self.include_leaving(self.way.peaks)
        return self.is_reached
