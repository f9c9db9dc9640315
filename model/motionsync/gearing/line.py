"""The line on which master and slave are in gear, and the places on a grid that an axis comes to.

Source: MOVIKIT gearing: a ratio of whole numbers, and the point through which the line runs.
"""

from dataclasses import dataclass

from ..grid import floor

ROUNDING = 1e-15  # of a position
SAME_TURN = 1e-12  # of the distance between two places on a grid


@dataclass(slots=True)
class Line:
    """slave = s_a + numerator (m - m_a) / denominator, through (m_a, s_a) = (`master`, `slave`), both in u.

    Neither number of the ratio is 0."""

    numerator: int = 1
    denominator: int = 1
    master: float = 0.0
    slave: float = 0.0

    def at(self, master: float) -> float:
        """Where the slave is in gear with a master there."""
        return self.slave + self.scaled(master - self.master)

    def scaled(self, way: float) -> float:
        """What the slave makes of a way, velocity or acceleration of the master."""
        return self.numerator * way / self.denominator

    def unscaled(self, way: float) -> float:
        """What the master makes while the slave makes this."""
        return self.denominator * way / self.numerator

    def take(self, master: float, slave: float) -> None:
        """Run through this point from now on."""
        self.master = master
        self.slave = slave


def direction_of(velocity: float, acceleration: float) -> float:
    """Which way an axis moves at an instant: 1 (clockwise), -1, or 0 at rest."""
    leading = velocity if velocity != 0.0 else acceleration
    return 1.0 if leading > 0.0 else -1.0 if leading < 0.0 else 0.0


def rounding(a: float, b: float) -> float:
    """Within it two positions are the same."""
    return ROUNDING * (abs(a) + abs(b))


def tolerance(base: float, spacing: float, here: float) -> float:
    """Within it `here` is at one of the places base + n spacing."""
    return rounding(here, base) + SAME_TURN * spacing


def ahead(base: float, spacing: float, way: float, here: float, on_it: bool) -> float:
    """Of the places base + n spacing the first one ahead of `here` in the direction `way`; `on_it`: or at it.

    With a spacing of 0 there is only `base`, ahead or not."""
    if spacing == 0.0:
        return base
    margin = tolerance(base, spacing, here)
    missing = way * (here - base) + (-margin if on_it else margin)
    return base - way * floor(-missing / spacing) * spacing
