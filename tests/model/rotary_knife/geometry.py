"""Knives at random and windows for them, in the block's own objects and in those of the oracle."""

from dataclasses import dataclass
from math import pi

from hypothesis import strategies as st

from motionsync.rotary_knife.knife import Knife
from motionsync.rotary_knife.window import CurvePoint, Window
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import Derivatives
from tests.oracle.rotary_knife.curves import Window as ExactWindow
from tests.oracle.rotary_knife.limits import HORIZONTAL, TANGENTIAL
from tests.oracle.rotary_knife.limits import Knife as ExactKnife
from tests.support.blocks.drawn import drawn

repeatable = drawn(60)


def window_of(knife: Knife, before: float, after: float, factor: float = 1.0, overspeed: float = 0.0) -> Window:
    window = Window()
    window.set(knife, factor, before, after, overspeed)
    return window


@dataclass(frozen=True)
class Case:
    """A knife and a window of it, twice."""

    knife: Knife
    window: Window
    exact_knife: ExactKnife
    exact_window: ExactWindow

    @property
    def around(self) -> float:
        return self.window.before + self.window.after

    @property
    def spacing(self) -> Number:
        return self.exact_knife.spacing


def exact_knife(knife: Knife, blades: int) -> ExactKnife:
    return ExactKnife(
        mp.mpf(knife.turn),
        mp.mpf(knife.circumference),
        blades,
        mp.mpf(knife.park_angle),
        HORIZONTAL if knife.is_horizontal else TANGENTIAL,
        knife.may_park,
        *(mp.mpf(limit) for limit in (knife.max_velocity, knife.max_acceleration, knife.max_jerk)),
    )


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """Either mode, 1 to 6 blades, windows of unequal halves, any park angle between them, limits of any proportion."""
    turn = draw(st.sampled_from([360.0, 1.0, 2 * pi, 4096.0]))
    circumference = draw(st.floats(100.0, 2000.0))
    blades = draw(st.integers(1, 6))
    is_horizontal = draw(st.booleans())
    factor, overspeed = draw(st.floats(0.8, 1.25)), draw(st.sampled_from([0.0, 0.0, -0.2, 0.1, 0.5]))
    widest = (0.15 if is_horizontal else 0.5) / (blades if blades > 2 else 2)
    before, after = (draw(st.floats(0.01, 0.6)) * widest * circumference for _ in range(2))
    speed = turn * draw(st.floats(1.0, 20.0))
    acceleration = speed * draw(st.floats(2.0, 100.0))
    jerk = acceleration * draw(st.floats(2.0, 500.0))
    knife = Knife(turn, circumference, turn / blades, 0.0, is_horizontal, True, speed, acceleration, jerk)
    window = window_of(knife, before, after, factor, overspeed)
    leaves, arrives = window.end.position, knife.spacing + window.begin.position
    knife.park_angle = leaves + draw(st.floats(0.1, 0.9)) * (arrives - leaves)
    exact = exact_knife(knife, blades)
    return Case(knife, window, exact, exact.window(mp.mpf(factor), mp.mpf(before), mp.mpf(after), mp.mpf(overspeed)))


def derivatives(point: CurvePoint) -> Derivatives:
    position, d1, d2, d3 = map(mp.mpf, (point.position, point.d1, point.d2, point.d3))
    return position, d1, d2, d3
