"""Ways of one kind from where the knife is to a cut whose place is searched.

The greatest line velocity of a way depends on the master's travel on it, Z. For ways that turn on it rises up to some
Z, and falls from there on; where the jerk limits it, it may rise again before a longer way would turn back (the jerk of
a TANGENTIAL one is 0 at S/k' and, beyond, greatest at 3/2 S/k'). For ways that park it rises.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.bracket import ITERATIONS, Bracket
from .curves import TURNING_BACK, Peaks, Way, admissible_velocity
from .knife import Knife
from .window import CurvePoint, Cut

GOLDEN = 0.6180339887498949  # (sqrt(5) - 1) / 2
SCANNED = 32  # the parts of a range of travels at whose ends the velocity is computed first
SAME_TRAVEL = 1e-10  # relative: how narrow the interval is in which the greatest velocity lies at last
DOUBLINGS = 200  # a bound that only numbers beyond all machines come near


@dataclass(slots=True)
class WaySearch:
    """The ways that begin with the master at `begin` and the slave at `point`, and lead to a cut.

    Attributes:
        parks: they park; else they turn on.
        counted: the peaks of what counts in addition.
        cut: the cut; its place follows from the travel.
        travel: Z of the way that was planned last.
        velocity: its greatest line velocity, u/s of the master; 0 if there is no such way.
        way: the way itself.
    """

    parks: bool = False
    begin: float = 0.0
    point: CurvePoint = var.part(CurvePoint)
    counted: Peaks = var.part(Peaks)
    cut: Cut = var.part(Cut)
    travel: float = 0.0
    velocity: float = 0.0
    way: Way = var.part(Way)
    bracket: Bracket = var.part(Bracket)

    def start(self, begin: float, point: CurvePoint, cut: Cut) -> None:
        """Set where the ways, which turn on, begin and where they lead to; nothing else counts yet."""
        self.parks = False
        self.begin = begin
        var.copy(self.point, point)
        var.copy(self.cut, cut)
        self.counted.clear()

    def plan(self, knife: Knife, travel: float) -> None:
        """Plan the way over so much travel."""
        self.travel = travel
        self.cut.place = self.begin + travel + self.cut.window.before
        if self.parks:
            self.way.plan_parking(knife, self.begin, self.point, self.cut, True)
        else:
            self.way.plan_turning(self.begin, self.point, self.cut)
        self.velocity = 0.0
        if self.way.exists:
            self.way.peaks.include(self.counted.d1, self.counted.d2, self.counted.d3)
            self.velocity = admissible_velocity(knife, self.way.peaks)

    def travel_to(self, place: float) -> float:
        """Z of the way to a cut at this position of the master, u."""
        return place - self.cut.window.before - self.begin

    def slope_margin(self) -> float:
        """How far the least slope of the way planned last is above the one at which it turns back."""
        return self.way.quintic_peaks.least_d1 + TURNING_BACK * self.cut.window.slope

    def natural_travel(self) -> float:
        """The travel in which the slave gets there with the slope that it has at the cut; it may be negative."""
        end = self.cut.position + self.cut.window.begin.position
        return (end - self.point.position) / self.cut.window.slope

    def find_longest(self, knife: Knife) -> None:
        """Plan the longest way that turns on; there is one where the cut is ahead."""
        low = self.natural_travel()
        self.plan(knife, low)
        for _ in range(DOUBLINGS):
            if self.slope_margin() >= 0.0:
                break
            low *= 0.5
            self.plan(knife, low)
        at_low = self.slope_margin()
        high = 2.0 * low
        self.plan(knife, high)
        for _ in range(DOUBLINGS):
            if self.slope_margin() < 0.0:
                break
            low = high
            at_low = self.slope_margin()
            high *= 2.0
            self.plan(knife, high)
        self.bracket.set(low, at_low, high, self.slope_margin())
        while self.bracket.try_narrow():
            self.plan(knife, self.bracket.place)
            self.bracket.replace(self.slope_margin(), self.slope_margin() < 0.0)
        self.plan(knife, self.bracket.low)

    def find_fastest(self, knife: Knife, least: float, most: float, enough: float) -> None:
        """Plan the way with the greatest velocity, for a travel from `least` to `most`, or the first one of a scan
        whose velocity is `enough`."""
        part = (most - least) / SCANNED
        fastest = most
        greatest = 0.0
        for n in range(SCANNED + 1):
            travel = least + n * part
            if travel <= 0.0:
                continue
            self.plan(knife, travel)
            if self.velocity >= enough:
                return
            if self.velocity > greatest:
                fastest = travel
                greatest = self.velocity
        self.narrow_to_fastest(knife, max(fastest - part, least), min(fastest + part, most), enough)

    def narrow_to_fastest(self, knife: Knife, least: float, most: float, enough: float) -> None:
        """As `find_fastest`, in a range in which the velocity rises and then falls; by golden sections."""
        low = least
        high = most
        left = high - GOLDEN * (high - low)
        right = low + GOLDEN * (high - low)
        self.plan(knife, left)
        at_left = self.velocity
        self.plan(knife, right)
        at_right = self.velocity
        for _ in range(ITERATIONS):
            if max(at_left, at_right) >= enough or high - low <= SAME_TRAVEL * high:
                break
            if at_left >= at_right:
                high = right
                right = left
                at_right = at_left
                left = high - GOLDEN * (high - low)
                self.plan(knife, left)
                at_left = self.velocity
            else:
                low = left
                left = right
                at_left = at_right
                right = low + GOLDEN * (high - low)
                self.plan(knife, right)
                at_right = self.velocity
        self.plan(knife, left if at_left >= at_right else right)

    def find_shortest(self, knife: Knife, least: float, velocity: float) -> None:
        """Plan the shortest way, of at least that travel, which keeps the limits at the line velocity v > 0; the way
        planned last keeps them."""
        high = self.travel
        at_high = self.velocity - velocity
        low = high
        for _ in range(DOUBLINGS):
            if low <= least or self.velocity < velocity:
                break
            high = low
            at_high = self.velocity - velocity
            low = max(0.5 * low, least)
            self.plan(knife, low)
        if self.velocity < velocity:
            self.bracket.set(low, self.velocity - velocity, high, at_high)
            while self.bracket.try_narrow():
                self.plan(knife, self.bracket.place)
                self.bracket.replace(self.velocity - velocity, self.velocity >= velocity)
            self.plan(knife, self.bracket.high)
