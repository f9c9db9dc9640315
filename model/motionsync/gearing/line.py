"""The line on which master and slave are in gear, and the direction in which an axis moves.

Source: MOVIKIT gearing: a ratio of whole numbers, and the point through which the line runs.
"""

from dataclasses import dataclass


@dataclass(slots=True)
class Line:
    """slave = s_a + numerator (m - m_a) / denominator, through (m_a, s_a) = (`master`, `slave`), both in u.

    Neither number of the ratio is 0."""

    numerator: int = 1
    denominator: int = 1
    master: float = 0.0
    slave: float = 0.0

    def at(self, master: float) -> float:
        """The slave's position, u, in gear with a master at this position, u."""
        return self.slave + self.scaled(master - self.master)

    def scaled(self, of_master: float) -> float:
        """A distance, velocity, acceleration or jerk of the master as the slave in gear has it."""
        return self.numerator * of_master / self.denominator

    def unscaled(self, of_slave: float) -> float:
        """The distance that the master travels while the slave in gear travels this one."""
        return self.denominator * of_slave / self.numerator

    def lay_through(self, master: float, slave: float) -> None:
        """The line runs through this point of both axes from now on; the ratio stays."""
        self.master = master
        self.slave = slave


def direction_of(velocity: float, acceleration: float) -> float:
    """In which direction an axis moves at an instant: 1 (clockwise), -1, or 0 at rest.

    At standstill the acceleration tells the direction of the motion that begins."""
    leading = velocity if velocity != 0.0 else acceleration
    return 1.0 if leading > 0.0 else -1.0 if leading < 0.0 else 0.0
