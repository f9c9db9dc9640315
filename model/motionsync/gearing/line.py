"""The line on which master and slave are in gear. Source: MOVIKIT gearing."""

from dataclasses import dataclass


@dataclass(slots=True)
class SynchronousLine:
    """slave = s_a + numerator (m - m_a) / denominator, through (m_a, s_a) = (`master`, `slave`), both in u.

    Neither number of the ratio is 0."""

    numerator: int = 1
    denominator: int = 1
    master: float = 0.0
    slave: float = 0.0

    def at(self, master: float) -> float:
        """The slave's position, u, in gear with a master at this position, u."""
        return self.slave + self.to_slave(master - self.master)

    def to_slave(self, of_master: float) -> float:
        """A distance, velocity, acceleration or jerk of the master, converted to that of the slave in gear."""
        return self.numerator * of_master / self.denominator

    def to_master(self, of_slave: float) -> float:
        """The distance that the master travels while the slave in gear travels this one."""
        return self.denominator * of_slave / self.numerator

    def set_point(self, master: float, slave: float) -> None:
        """Make the line run through this point of both axes; the ratio stays."""
        self.master = master
        self.slave = slave


def direction_of(velocity: float, acceleration: float) -> float:
    """In which direction an axis moves, or from standstill starts to move: 1 (clockwise), -1, or 0 at rest."""
    leading = velocity if velocity != 0.0 else acceleration
    return 1.0 if leading > 0.0 else -1.0 if leading < 0.0 else 0.0
