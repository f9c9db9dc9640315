"""The knife between two windows: it turns on, or it stops at its park angle and starts again.

All sections are quintics through six values (VDI 2143, general polynomial of order 5). Positions of master and slave
may count from anywhere, as long as all of a call count from the same; d1, d2, d3 are the derivatives of the slave's
position by the master's. On a line of velocity v, curves with the greatest d1, d2, d3 take the velocity d1 v, the
acceleration d2 v2 and the jerk d3 v3; the axis's limits of these give the greatest v.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..motion.laws import Quintic
from ..motion.quintic_peaks import QuinticPeaks
from ..numerics.computable_range import clamp
from ..numerics.cube_root import cube_root
from .knife import Knife
from .window import CurvePoint, Cut, Window

FAR_BACK = -1e300  # before every position of the master
SHORTEST_WAY = 1e-60  # u of the master: of a shorter one, powers of the inverse may leave the range of a double
TURNING_BACK = 1e-12  # of the slope at the cut: a least slope that is below 0 by no more is rounding
FASTEST = 1e300  # u/s: the velocity of a line that nothing limits
PUNCTUAL = 1.0 + 1e-9  # of a greatest line velocity: a cut is late above this


@dataclass(slots=True)
class Section:
    """One quintic: the slave over the master from `begin` to `end`; outside it the slave is as at the nearer end."""

    begin: float = 0.0
    end: float = 0.0
    quintic: Quintic = var.part(Quintic)

    def fit_ramp_down(self, begin: float, length: float, point: CurvePoint, rest: float) -> None:
        """From `point` to rest at the slave's position `rest`, over so much travel of the master."""
        self.begin = begin
        self.end = begin + length
        self.quintic.fit(length, point.position, point.d1, point.d2, rest, 0.0, 0.0)

    def fit_into_window(self, length: float, point: CurvePoint, cut: Cut) -> None:
        """From `point` to the beginning of the cut's window, over so much travel of the master."""
        self.end = cut.begin()
        self.begin = self.end - length
        target = cut.window.begin
        end = cut.position + target.position
        self.quintic.fit(length, point.position, point.d1, point.d2, end, target.d1, target.d2)

    def at(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position and d1, d2, d3. In time, the slave moves by `laws.chain_rule` of these."""
        return self.quintic.at(clamp(master - self.begin, 0.0, self.quintic.length))


@dataclass(slots=True)
class Peaks:
    """The greatest magnitudes of d1, d2, d3 over one or more curves. On a line of velocity v the slave's are d1 v,
    d2 v2, d3 v3."""

    d1: float = 0.0
    d2: float = 0.0
    d3: float = 0.0

    def include(self, d1: float, d2: float, d3: float) -> None:
        """The greatest values of another curve count, too, each with any sign."""
        self.d1 = max(self.d1, abs(d1))
        self.d2 = max(self.d2, abs(d2))
        self.d3 = max(self.d3, abs(d3))

    def include_window_end(self, point: CurvePoint) -> None:
        """The half of a window that ends or begins there counts, too: all three are greatest there."""
        self.include(point.d1, point.d2, point.d3)

    def clear(self) -> None:
        """No curve counts."""
        self.d1 = 0.0
        self.d2 = 0.0
        self.d3 = 0.0


def admissible_velocity(knife: Knife, peaks: Peaks) -> float:
    """The greatest line velocity, u/s of the master, at which curves with these peaks keep the axis's limits."""
    velocity = FASTEST
    if peaks.d1 > 0.0:
        velocity = knife.max_velocity / peaks.d1
    if peaks.d2 > 0.0:
        velocity = min(velocity, sqrt(knife.max_acceleration / peaks.d2))
    if peaks.d3 > 0.0:
        velocity = min(velocity, cube_root(knife.max_jerk / peaks.d3))
    return velocity


def keeps_limits(knife: Knife, peaks: Peaks, velocity: float) -> bool:
    """Whether curves with these peaks keep the axis's limits at a line velocity, but for rounding."""
    return velocity <= PUNCTUAL * admissible_velocity(knife, peaks)


@dataclass(slots=True)
class Way:
    """What leads to the window of a cut: one section, or a ramp down to rest and one up from it.

    Attributes:
        exists: there is such a way; else the rest means nothing.
        parks: the knife comes to rest on it.
        first: the section that turns on, or the ramp down; it begins where the way does.
        ramp_up: of a way that parks; the knife rests from the end of `first` to its beginning.
        peaks: of the sections, and of the half of a window into which they lead.
    """

    exists: bool = False
    parks: bool = False
    first: Section = var.part(Section)
    ramp_up: Section = var.part(Section)
    peaks: Peaks = var.part(Peaks)
    resting_point: CurvePoint = var.part(CurvePoint)
    quintic_peaks: QuinticPeaks = var.part(QuinticPeaks)

    def plan(self, knife: Knife, begin: float, point: CurvePoint, cut: Cut, shorten: bool) -> None:
        """Turning on if that never turns back; else, if the knife may park, by a ramp down and one up.

        The way begins with the master at `begin` and the slave at `point`. With `shorten`, ramps that do not fit are
        shortened."""
        self.plan_turning(begin, point, cut)
        if not self.exists and knife.may_park:
            self.plan_parking(knife, begin, point, cut, shorten)

    def plan_turning(self, begin: float, point: CurvePoint, cut: Cut) -> None:
        """Turning on: the section from `point` to the window's beginning; there is none if it turns back."""
        self.parks = False
        self.peaks.clear()
        length = cut.begin() - begin
        self.exists = length > SHORTEST_WAY
        if self.exists:
            self.first.fit_into_window(length, point, cut)
            self.include_section(self.first)
            self.peaks.include_window_end(cut.window.begin)
            self.exists = self.quintic_peaks.least_d1 >= -TURNING_BACK * cut.window.slope

    def plan_parking(self, knife: Knife, begin: float, point: CurvePoint, cut: Cut, shorten: bool) -> None:
        """A ramp down at once, and one up as late as possible, to and from the park angle before the cut.

        Where both do not fit, `shorten` shortens both in the same ratio; else there is no way."""
        self.parks = True
        self.peaks.clear()
        down = ramp_down_travel(knife, point, cut.position)
        up = ramp_up_travel(knife, cut.window)
        length = cut.begin() - begin
        has_to_shorten = down + up > length
        self.exists = down > 0.0 and length > SHORTEST_WAY and (shorten or not has_to_shorten)
        if self.exists:
            if has_to_shorten:
                share = length / (down + up)
                down *= share
                up *= share
            self.first.fit_ramp_down(begin, down, point, rest_before(knife, cut.position))
            self.include_section(self.first)
            self.fit_ramp_up(knife, up, cut)
            self.ramp_up.begin = max(self.ramp_up.begin, self.first.end)

    def plan_ramp_up(self, knife: Knife, begin: float, cut: Cut) -> None:
        """Out of rest alone, as late as possible but not before the master is at `begin`; FAR_BACK sets no bound."""
        self.exists = True
        self.parks = True
        self.peaks.clear()
        self.fit_ramp_up(knife, min(ramp_up_travel(knife, cut.window), cut.begin() - begin), cut)

    def plan_ramp_down(self, knife: Knife, begin: float, point: CurvePoint, position: float) -> None:
        """To rest alone, before the cut at which the slave's position is `position`: `first`. There is none if the
        knife cannot stop there without turning back."""
        self.parks = True
        self.peaks.clear()
        length = ramp_down_travel(knife, point, position)
        self.exists = length > 0.0
        if self.exists:
            self.first.fit_ramp_down(begin, length, point, rest_before(knife, position))
            self.include_section(self.first)

    def fit_ramp_up(self, knife: Knife, length: float, cut: Cut) -> None:
        """Set `ramp_up` to the ramp over so much travel; it counts, and so does the half of the window after it."""
        self.resting_point.set(rest_before(knife, cut.position), 0.0, 0.0, 0.0)
        self.ramp_up.fit_into_window(length, self.resting_point, cut)
        self.include_section(self.ramp_up)
        self.peaks.include_window_end(cut.window.begin)

    def include_section(self, section: Section) -> None:
        """A section counts."""
        self.quintic_peaks.measure(section.quintic)
        self.peaks.include(self.quintic_peaks.d1, self.quintic_peaks.d2, self.quintic_peaks.d3)


def rest_before(knife: Knife, position: float) -> float:
    """The slave's position where the knife parks before the cut at which it is `position`."""
    return position - knife.spacing + knife.park_angle


def ramp_down_travel(knife: Knife, point: CurvePoint, position: float) -> float:
    """W of the ramp from `point` to rest before the cut at which the slave's position is `position`; 0 if there is
    none."""
    return ramp_travel(rest_before(knife, position) - point.position, point.d1, point.d2)


def ramp_up_travel(knife: Knife, window: Window) -> float:
    """W of the ramp from rest to the beginning of a window."""
    target = window.begin
    return ramp_travel(knife.spacing - knife.park_angle + target.position, target.d1, -target.d2)


def ramp_travel(distance: float, d1: float, d2: float) -> float:
    """W: the master's travel over a ramp between rest and a state with d1 and d2 that is `distance` of the slave away.

    d2 counts positive where the slope grows with the distance from rest. With w from 0 to 1 and V = d1 W the slave is
    (4 D - V) w3 + (V - 3 D) w4 from rest; that this has d2 at its end gives W = 12 D / (3 d1 + sqrt(9 d1^2 + 12 d2 D)).
    0 where there is no such ramp: the state is not ahead, or its slope cannot be had."""
    square = 9.0 * d1 * d1 + 12.0 * d2 * distance
    if distance <= 0.0 or d1 <= 0.0 or square < 0.0:
        return 0.0
    return 12.0 * distance / (3.0 * d1 + sqrt(square))
