"""What a rotary knife can do: how fast the line may be for a piece, and which pieces it can cut.

Z is the master's travel between two windows. Up to the Z that admits the fastest line, the greatest line velocity rises
with Z.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..cutting.piece import UNLIMITED
from ..motion.laws import POLYNOMIAL_3_4_5_D1, POLYNOMIAL_3_4_5_D2, POLYNOMIAL_3_4_5_D3
from ..numerics.cube_root import cube_root
from .curves import FAR_BACK, Peaks, Way, admissible_velocity, ramp_down_travel, ramp_up_travel
from .knife import Knife
from .way_search import WaySearch
from .window import Cut, Window

NO_LENGTH = 1e12  # u: the shortest pitch where there is none
LEAST = 1e-60  # u/s: a line velocity below it counts as this one, so that no quotient overflows
LONGEST_TURNING = 15.0 / 7.0  # of S / k': the longest Z without parking (TANGENTIAL)


@dataclass(slots=True)
class CycleLimit:
    """The greatest line velocity of a cycle.

    Attributes:
        max_line_velocity: u/s of the master; 0 where no line is slow enough.
        peaks: of the whole cycle, both half-windows included.
        way: between the windows, with the master counted from the cut before it; out of rest, from the cut after it.
    """

    max_line_velocity: float = 0.0
    peaks: Peaks = var.part(Peaks)
    way: Way = var.part(Way)
    cut: Cut = var.part(Cut)

    def solve_piece(self, knife: Knife, leaving: Window, entering: Window, pitch: float) -> None:
        """From one cut to the next one, `pitch` of the master later; UNLIMITED is the pitch of a piece that parks."""
        parks = pitch >= UNLIMITED
        travel = pitch
        if parks:
            ramps = ramp_down_travel(knife, leaving.end, knife.spacing) + ramp_up_travel(knife, entering)
            travel = leaving.after + 2.0 * ramps + entering.before
        self.set_cut(entering, travel, knife.spacing)
        if not parks:
            self.way.plan_turning(leaving.after, leaving.end, self.cut)
        if parks or not self.way.exists:
            self.way.plan_parking(knife, leaving.after, leaving.end, self.cut, True)
        self.peaks.clear()
        self.max_line_velocity = 0.0
        if self.way.exists:
            self.peaks.include_window_end(leaving.end)
            self.include_way(knife)

    def solve_ramp_up(self, knife: Knife, entering: Window) -> None:
        """Out of rest to the cut."""
        self.set_cut(entering, 0.0, 0.0)
        self.way.plan_ramp_up(knife, FAR_BACK, self.cut)
        self.peaks.clear()
        self.include_way(knife)

    def set_cut(self, window: Window, place: float, position: float) -> None:
        """Set the cut at the end of the cycle."""
        var.copy(self.cut.window, window)
        self.cut.place = place
        self.cut.position = position

    def include_way(self, knife: Knife) -> None:
        """The way counts."""
        self.peaks.include(self.way.peaks.d1, self.way.peaks.d2, self.way.peaks.d3)
        self.max_line_velocity = admissible_velocity(knife, self.peaks)


@dataclass(slots=True)
class LengthLimits:
    """Which pitches are possible between two equal windows: prepared for a window, then solved for a line velocity.

    Attributes:
        longest: the longest pitch without parking.
        fastest: the pitch that admits the greatest line velocity among those without parking.
        max_line_velocity: at that pitch, u/s of the master.
        shortest: the shortest pitch at the line velocity for which it was solved; NO_LENGTH if there is none.
    """

    longest: float = 0.0
    fastest: float = 0.0
    max_line_velocity: float = 0.0
    shortest: float = 0.0
    cut: Cut = var.part(Cut)
    search: WaySearch = var.part(WaySearch)

    def prepare(self, knife: Knife, window: Window) -> None:
        """Find what does not depend on the line's velocity, for a window that leaves a way (`leaves_way`)."""
        around = window.before + window.after
        if window.is_horizontal:
            var.copy(self.cut.window, window)
            self.cut.position = knife.spacing
            self.search.start(window.after, window.end, self.cut)
            self.search.counted.include_window_end(window.begin)
            self.search.counted.include_window_end(window.end)
            self.search.find_longest(knife)
            self.longest = around + self.search.travel
            in_window = admissible_velocity(knife, self.search.counted)
            self.search.find_fastest(knife, 0.0, self.search.travel, in_window)
            self.fastest = around + self.search.travel
            self.max_line_velocity = self.search.velocity
        else:
            synchronous = window.way_to(window, knife.spacing) / window.slope
            self.longest = around + LONGEST_TURNING * synchronous
            self.fastest = around + synchronous
            self.max_line_velocity = knife.max_velocity / window.slope

    def solve_shortest(self, knife: Knife, window: Window, velocity: float) -> None:
        """Find the shortest pitch at a line velocity > 0, for the window that was prepared."""
        v = max(velocity, LEAST)
        self.shortest = NO_LENGTH
        if v > self.max_line_velocity:
            return
        around = window.before + window.after
        distance = window.way_to(window, knife.spacing)
        if window.is_horizontal:
            self.search.plan(knife, min(shortest_rest_to_rest(knife, distance, v), self.fastest - around))
            if self.search.velocity < v:
                self.search.plan(knife, self.fastest - around)
            self.search.find_shortest(knife, 0.0, v)
            self.shortest = around + self.search.travel
        else:
            self.shortest = around + shortest_tangential(knife, window.slope, distance, v)


def shortest_rest_to_rest(knife: Knife, distance: float, velocity: float) -> float:
    """The least travel of the master over which the slave can go so far from rest to rest, by the polynomial 3-4-5."""
    by_acceleration = sqrt(POLYNOMIAL_3_4_5_D2 * distance / knife.max_acceleration)
    by_jerk = cube_root(POLYNOMIAL_3_4_5_D3 * distance / knife.max_jerk)
    return velocity * max(POLYNOMIAL_3_4_5_D1 * distance / knife.max_velocity, by_acceleration, by_jerk)


def shortest_tangential(knife: Knife, slope: float, distance: float, velocity: float) -> float:
    """The least Z at a line velocity v with k' v within the axis's limit, for the slave's travel S.

    With D = S - k' Z >= 0 the curve's greatest derivatives are k' + 15/8 D/Z, 10/sqrt(3) D/Z2, 60 D/Z3. The limit of
    the first gives Z at once, those of the others a quadratic and a cubic equation. With y = S/(k' Z) the cubic is
    y3 = y2 + q, which Cardano's formula solves without cancellation."""
    v = velocity
    by_velocity = POLYNOMIAL_3_4_5_D1 * distance / (knife.max_velocity / v + (POLYNOMIAL_3_4_5_D1 - 1.0) * slope)
    square = knife.max_acceleration / (POLYNOMIAL_3_4_5_D2 * v * v)
    by_acceleration = 2.0 * distance / (slope + sqrt(slope * slope + 4.0 * square * distance))
    fast = slope * v
    q = knife.max_jerk / POLYNOMIAL_3_4_5_D3 / fast * (distance / fast) * (distance / fast)
    root = cube_root(0.5 * q + 1.0 / 27.0 + sqrt(q) * sqrt(0.25 * q + 1.0 / 27.0))
    by_jerk = distance / slope / (1.0 / 3.0 + root + 1.0 / 9.0 / root)
    return max(by_velocity, by_acceleration, by_jerk)


@dataclass(slots=True)
class EarliestCut:
    """The earliest cut that is reached within the limits at a line velocity, from where the knife is.

    Attributes:
        exists: there is one.
        search: is started before; then its `cut` is that cut, its `way` the way to it.
    """

    exists: bool = False
    search: WaySearch = var.part(WaySearch)

    def find_turning(self, knife: Knife, velocity: float, least: float, greatest: float) -> None:
        """Turning on, with the master at `least` to `greatest` at the cut; UNLIMITED sets no bound. v > 0."""
        search = self.search
        search.parks = False
        most = search.travel_to(greatest)
        first = max(search.travel_to(least), 0.0)
        self.exists = False
        if search.natural_travel() <= 0.0:
            return
        if greatest >= UNLIMITED:
            search.find_longest(knife)
            most = search.travel
        if most <= first:
            return
        v = max(velocity, LEAST)
        search.find_fastest(knife, first, most, v)
        self.exists = search.velocity >= v
        if self.exists:
            search.find_shortest(knife, first, v)

    def find_parking(self, knife: Knife, velocity: float, least: float) -> None:
        """Out of rest, with the master at `least` or later at the cut. v > 0."""
        search = self.search
        search.parks = True
        v = max(velocity, LEAST)
        down = ramp_down_travel(knife, search.point, search.cut.position)
        self.exists = False
        if down <= 0.0 or not knife.may_park:
            return
        first = max(search.travel_to(least), 0.0)
        search.plan(knife, max(down + ramp_up_travel(knife, search.cut.window), first))
        self.exists = search.velocity >= v
        if self.exists:
            search.find_shortest(knife, first, v)
