"""What a rotary knife can do: the curves from one cut to the next, and the greatest line velocity of each.

At the line velocity v a curve over the master is run with its slope times v, its curvature times v² and its third
derivative times v³; the axis's limits on these give the greatest v. `Knife` holds what is fixed for a run.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.numerics.root_search import Bracket
from tests.oracle.rotary_knife.curves import (
    NO_EXTREMES,
    ZERO,
    Cut,
    Derivatives,
    Extremes,
    Quintic,
    Window,
    greatest,
)

TANGENTIAL, HORIZONTAL = 1, 2
BACKWARDS = mp.mpf("1e-12")
"""Of k: a slope below 0 by no more is rounding, and the curve does not turn back."""
SPARE = mp.mpf("1e-9")
"""Of a turn: how far the park angle has to be from both windows, at least."""
WIDEST = mp.mpf("0.15")
"""Of the circumference: the widest half of a HORIZONTAL window."""
NO_LENGTH = 1e12
SAMPLES = 60
MOST_TRIALS = 300
FINE = mp.mpf("1e-30")
GOLDEN = (mp.sqrt(mp.mpf(5)) - 1) / 2


@dataclass(frozen=True)
class Way:
    """What leads from a place to the window of a cut: one curve, or a ramp down to rest and one up from it."""

    curves: tuple[Quintic, ...]

    @property
    def parks(self) -> bool:
        return len(self.curves) == 2

    @cached_property
    def extremes(self) -> Extremes:
        return greatest(*(curve.extremes() for curve in self.curves))


@dataclass(frozen=True)
class Knife:
    """Blades evenly spaced on a cylinder, in one of the modes; the axis's velocity, acceleration and jerk."""

    turn: Number
    circumference: Number
    blades: int
    park_angle: Number
    mode: int
    may_park: bool
    velocity: Number
    acceleration: Number
    jerk: Number

    @staticmethod
    def of(inputs: Mapping[str, Any]) -> "Knife":
        return Knife(
            mp.mpf(inputs["knife.turn"]),
            mp.mpf(inputs["knife.circumference"]),
            int(inputs["knife.blades"]),
            mp.mpf(inputs["knife.park_angle"]) or mp.mpf(inputs["knife.turn"]) / inputs["knife.blades"] / 2,
            int(inputs["sync.mode"]),
            bool(inputs["allow_parking"]),
            *(mp.mpf(inputs[f"axis.max_{name}"]) for name in ("velocity", "acceleration", "jerk")),
        )

    @property
    def spacing(self) -> Number:
        """The slave's travel from one blade to the next."""
        return self.turn / self.blades

    def window(self, f: Number, before: Number, after: Number, overspeed: Number) -> Window:
        """The window with `before` and `after` in travel of the material, f of it per travel of the master."""
        k, f = mp.mpf(f) * self.turn / self.circumference, mp.mpf(f)
        horizontal = self.mode == HORIZONTAL
        slope = k if horizontal else k * (1 + mp.mpf(overspeed))
        return Window(slope, before / f, after / f, self.turn / (2 * mp.pi) if horizontal else ZERO)

    def has_way(self, before: Number, after: Number, overspeed: Number) -> bool:
        """Whether there is a way between two such windows, with the park angle on it; f makes no difference."""
        if self.mode == HORIZONTAL and max(before, after) > WIDEST * self.circumference:
            return False
        window, spare = self.window(1, before, after, overspeed), SPARE * self.turn
        leaves, arrives = window.at(window.after)[0], self.spacing + window.at(-window.before)[0]
        return bool(arrives > leaves and leaves + spare <= self.park_angle <= arrives - spare)

    # --- ways -----------------------------------------------------------------------------------------------------

    def turning(self, place: Number, state: Derivatives, cut: Cut) -> Way | None:
        """On to the cut's window without rest; None if there is no way, or if it would turn back."""
        if cut.begin <= place:
            return None
        curve = _curve_to(place, state, cut)
        return Way((curve,)) if _margin(curve, cut) >= 0 else None

    def parking(self, place: Number, state: Derivatives, cut: Cut, *, shortened: bool = True) -> Way | None:
        """Down to rest before the cut at once, and up from it as late as possible; None if that does not fit.

        `shortened`: ramps that do not fit are made to, both in the same ratio.
        """
        space, down, up = cut.begin - place, self.ramp_down(place, state, cut.position), self.ramp_up(cut)
        if space <= 0 or down is None:
            return None
        share = min(space / (down.width + up.width), mp.mpf(1))
        if share < 1 and not shortened:
            return None
        rest = (down.at(down.end)[0], ZERO, ZERO)
        return Way(
            (
                Quintic.through(place, state, place + share * down.width, rest),
                Quintic.through(cut.begin - share * up.width, rest, cut.begin, cut.at(cut.begin)),
            )
        )

    def ramp_up(self, cut: Cut, begin: Number | None = None) -> Quintic:
        """From rest to the cut's window; beginning there, or else where the ramp's own width has it begin."""
        state = cut.at(cut.begin)
        rest = cut.position - self.spacing + self.park_angle
        width = ramp_width(state[0] - rest, state[1], -state[2])
        assert width is not None
        return Quintic.through(cut.begin - width if begin is None else begin, (rest, ZERO, ZERO), cut.begin, state)

    def ramp_down(self, place: Number, state: Derivatives, next_position: Number) -> Quintic | None:
        """To rest before the blade's next cut, at `next_position` of the slave; None if that is not ahead."""
        rest = next_position - self.spacing + self.park_angle
        width = ramp_width(rest - state[0], state[1], state[2])
        return None if width is None else Quintic.through(place, state, place + width, (rest, ZERO, ZERO))

    # --- line velocities ------------------------------------------------------------------------------------------

    def velocity_for(self, extremes: Extremes) -> Number:
        """The greatest line velocity at which a curve with these extremes keeps the axis's limits."""
        slope, curvature, third = extremes
        return min(
            self.velocity / slope if slope else mp.inf,
            mp.sqrt(self.acceleration / curvature) if curvature else mp.inf,
            mp.cbrt(self.jerk / third) if third else mp.inf,
        )

    def cycle_extremes(self, way: Way | None, leaving: Window | None, entering: Window | None) -> Extremes:
        """Of a way and of the halves of the windows before and after it."""
        return greatest(
            way.extremes if way else NO_EXTREMES,
            leaving.extremes(leaving.after) if leaving else NO_EXTREMES,
            entering.extremes(-entering.before) if entering else NO_EXTREMES,
        )


def _curve_to(place: Number, state: Derivatives, cut: Cut) -> Quintic:
    return Quintic.through(place, state, cut.begin, cut.at(cut.begin))


def turning_margin(place: Number, state: Derivatives, cut: Cut) -> Number:
    """The least slope of the curve to a cut's window, over that at which it turns back."""
    return _margin(_curve_to(place, state, cut), cut)


def _margin(curve: Quintic, cut: Cut) -> Number:
    return curve.least_slope() + BACKWARDS * cut.window.slope


def longest_curve(place: Number, state: Derivatives, cut_after: Callable[[Number], Cut]) -> Number:
    """The longest way on from there without rest, or 0; `cut_after`: the cut whose window begins so far away."""

    def margin(z: Number) -> Number:
        return turning_margin(place, state, cut_after(z))

    low = cut_after(ZERO).window.before + mp.mpf(1) / 1024
    if margin(low) < 0:
        high = low
        while margin(low) < 0:
            low, high = low / 2, low
            if low < SPARE:
                return ZERO
        return solve(margin, low, high)
    while margin(2 * low) >= 0:
        low *= 2
    return solve(margin, low, 2 * low)


def ramp_width(distance: Number, slope: Number, curvature: Number) -> Number | None:
    """W of a ramp over the slave's `distance` between rest and a state; None if there is none.

    `curvature`: of the state, positive where the slope grows with the distance from rest.
    """
    radicand = 9 * slope**2 + 12 * curvature * distance
    if distance <= 0 or slope <= 0 or radicand < 0:
        return None
    return 12 * distance / (3 * slope + mp.sqrt(radicand))


# --- between two cuts, the first at place 0 ---------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def way_between(knife: Knife, leaving: Window, entering: Window, pitch: Number) -> Way | None:
    """From a cut's window to the one of the next cut, `pitch` later: without rest if that does not turn back."""
    cut, state = Cut(entering, mp.mpf(pitch), knife.spacing), leaving.at(leaving.after)
    return knife.turning(leaving.after, state, cut) or knife.parking(leaving.after, state, cut)


@lru_cache(maxsize=4096)
def cycle_velocity(knife: Knife, leaving: Window, entering: Window, pitch: Number) -> Number:
    """The greatest line velocity for a piece; 0 without a way. An infinite pitch is that of a piece that parks."""
    if pitch == mp.inf:
        pitch = 2 * longest_turning(knife, leaving, entering) + 10 * (knife.circumference / knife.blades)
        pitch += leaving.after + entering.before
    way = way_between(knife, leaving, entering, pitch)
    return knife.velocity_for(knife.cycle_extremes(way, leaving, entering)) if way else ZERO


@lru_cache(maxsize=256)
def ramp_velocity(knife: Knife, entering: Window) -> Number:
    """The greatest line velocity for a ramp up out of rest, and the half of the window after it."""
    way = Way((knife.ramp_up(Cut(entering, ZERO, ZERO)),))
    return knife.velocity_for(knife.cycle_extremes(way, None, entering))


@lru_cache(maxsize=256)
def longest_turning(knife: Knife, leaving: Window, entering: Window) -> Number:
    """The longest way Z on which the knife does not come to rest."""

    def cut_after(z: Number) -> Cut:
        return Cut(entering, z + entering.before, knife.spacing)

    return longest_curve(ZERO, leaving.at(leaving.after), cut_after)


@lru_cache(maxsize=256)
def fastest_turning(knife: Knife, window: Window) -> Number:
    """Z*: the way with the greatest line velocity among those on which the knife does not come to rest."""
    if not window.radian:
        return (knife.spacing - window.at(window.after)[0] + window.at(-window.before)[0]) / window.slope
    low, high = ZERO, longest_turning(knife, window, window)
    for _ in range(2 * SAMPLES):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (
            (low, right) if _way_velocity(knife, window, left) > _way_velocity(knife, window, right) else (left, high)
        )
    return (low + high) / 2


def _way_velocity(knife: Knife, window: Window, z: Number) -> Number:
    return cycle_velocity(knife, window, window, z + window.before + window.after)


@lru_cache(maxsize=4096)
def shortest_way(knife: Knife, window: Window, velocity: Number) -> Number | None:
    """The least Z up to Z* that keeps the limits at that line velocity; None if there is none."""
    best = fastest_turning(knife, window)
    return first_admissible(lambda z: _way_velocity(knife, window, z) - velocity, best)


def solve(function: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """The root between two points where the function has different signs, to 1e-30 of the first bracket or its values.

    False position, and every eighth time a bisection.
    """
    bracket = Bracket(low, high, function(low), function(high))
    width, scale = abs(high - low), abs(bracket.at_low) + abs(bracket.at_high)
    for trial in range(MOST_TRIALS):
        point = bracket.false_position if trial % 8 < 7 else bracket.middle
        value = function(point)
        if abs(value) <= FINE * scale or abs(bracket.high - bracket.low) <= FINE * width:
            return point
        bracket.narrow(point, value)
    return bracket.high


def first_admissible(margin: Callable[[Number], Number], best: Number) -> Number | None:
    """Where a margin that rises up to `best` becomes 0; None if it is below 0 there."""
    if margin(best) < 0:
        return None
    low = best / 2
    while margin(low) >= 0:
        low /= 2
    return solve(margin, low, best)
