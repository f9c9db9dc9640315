"""Which way a rotary knife takes to a cut that it can reach, or to another one in its place.

Readings of the specification that it leaves open:
- Whether a cut is late is checked by the whole cycle, the half of the window that is just over included, as the limits
  of the line's velocity are. Where the knife is out of rest, or a curve is laid anew, what is over does not count.
- LATE finds the earliest place from the one that is late on: turning, and later parking. If no place keeps the limits,
  as a line too fast for the window itself, the cut is left out as by SKIP.
- Where the knife must not park, no way that parks is taken for a cut; without another one it parks all the same.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import Cut, Derivatives, Window
from tests.oracle.rotary_knife.limits import Knife, Way, longest_curve, solve

LATENESS = mp.mpf("1e-9")
STEPS = 64
"""Into which a way is divided to find the first part of it that is long enough."""


@dataclass(frozen=True)
class Departure:
    """From where, and at which line velocity, a knife sets out; `leaving`: the window that is over, if it counts."""

    knife: Knife
    place: Number
    state: Derivatives
    velocity: Number
    leaving: Window | None

    def keeps_limits(self, way: Way, cut: Cut) -> bool:
        return bool(self.velocity <= self.greatest_velocity(way, cut) * (1 + LATENESS))

    def greatest_velocity(self, way: Way | None, cut: Cut) -> Number:
        """The line's, for that way; 0 without one."""
        if way is None:
            return mp.mpf(0)
        return self.knife.velocity_for(self.knife.cycle_extremes(way, self.leaving, cut.window))

    def way_to(self, cut: Cut, *, shortened: bool = True) -> Way | None:
        """Turning, or else parking; within the limits or not."""
        way = self.knife.turning(self.place, self.state, cut)
        if way is None and self.knife.may_park:
            way = self.knife.parking(self.place, self.state, cut, shortened=shortened)
        return way

    def admissible_way(self, cut: Cut, *, shortened: bool = True) -> Way | None:
        """The way to the cut, if it keeps the limits."""
        way = self.way_to(cut, shortened=shortened)
        return way if way and self.keeps_limits(way, cut) else None

    def first_of(self, cuts: Iterator[Cut]) -> tuple[int, Cut, Way] | None:
        """The first of several cuts in order that can be reached, with its number from 1 on.

        Once a way is longer than two ramps, all later cuts are like it.
        """
        for number, cut in enumerate(cuts, start=1):
            if way := self.admissible_way(cut):
                return number, cut, way
            if self._is_longer_than_ramps(cut):
                return None
        return None

    def _is_longer_than_ramps(self, cut: Cut) -> bool:
        if self.knife.turning(self.place, self.state, cut) is not None or cut.begin <= self.place:
            return False
        return not self.knife.may_park or self.knife.parking(self.place, self.state, cut, shortened=False) is not None

    def longest_turning(self, cut_after: Callable[[Number], Cut]) -> Number:
        """The longest way without rest, or 0; `cut_after`: the cut whose window begins so far away."""
        return longest_curve(self.place, self.state, cut_after)

    def earliest(self, cut_after: Callable[[Number], Cut], least: Number, longest: Number) -> tuple[Cut, Way] | None:
        """The first cut from `least` away on, up to `longest`, to which the knife turns within the limits."""

        def margin(z: Number) -> Number:
            cut = cut_after(z)
            return self.greatest_velocity(self.knife.turning(self.place, self.state, cut), cut) - self.velocity

        least = max(least, mp.mpf(0))
        before = least
        for i in range(STEPS + 1):
            z = least + (longest - least) * i / STEPS
            if z > 0 and margin(z) >= 0:
                z = solve(margin, before, z) if i else z
                cut = cut_after(z)
                way = self.knife.turning(self.place, self.state, cut)
                return (cut, way) if way else None
            before = z
        return None

    def earliest_parking(self, cut_after: Callable[[Number], Cut], least: Number) -> tuple[Cut, Way] | None:
        """The first cut from `least` away on that the knife reaches out of rest within the limits."""
        if not self.knife.may_park:
            return None
        down = self.knife.ramp_down(self.place, self.state, cut_after(least).position)
        assert down is not None
        natural = down.width + self.knife.ramp_up(cut_after(least)).width

        def margin(z: Number) -> Number:
            cut = cut_after(z)
            return self.greatest_velocity(self.knife.parking(self.place, self.state, cut), cut) - self.velocity

        z = least
        if margin(least) < 0:
            if least >= natural or margin(natural) < 0:
                return None
            z = solve(margin, least, natural)
        way = self.knife.parking(self.place, self.state, cut_after(z))
        return (cut_after(z), way) if way else None
