"""The carriage's curves over the material: into sync, in sync, and ahead of the material through a gap.

They count from the line of the cut: mu is how far the master is beyond the place at which that line passes carriage
position 0. So a cut keeps its last bits however far the material has run.
"""

from dataclasses import dataclass
from math import sqrt

from ..axis_limits import AxisLimits
from ..laws import half_ramp, polynomial_3_4_5
from ..limits import clamp

GAP_VELOCITY = 1.875  # g / T: greatest velocity of the gap's curve
GAP_ACCELERATION = 10.0 / sqrt(3.0)  # g / T^2: its greatest acceleration
GAP_JERK = 60.0  # g / T^3: its greatest jerk


@dataclass(slots=True)
class Carriage:
    """The curve of one cycle.

    Attributes:
        coupling: k, carriage travel per master travel in sync.
        home: where the carriage rests before the approach, u.
        start, sync: mu at the beginning and at the end of the approach.
        joined: the carriage is in sync, or has been in this cycle: a master that turns back takes it along.
        pulls: the gap is being opened, or is open.
        gap_begin, gap_end: mu between which it is opened.
        gap: by how much the carriage gets ahead of the material, u.
    """

    coupling: float = 1.0
    home: float = 0.0
    start: float = 0.0
    sync: float = 0.0
    joined: bool = False
    pulls: bool = False
    gap_begin: float = 0.0
    gap_end: float = 0.0
    gap: float = 0.0

    def lay_approach(self, coupling: float, home: float, distance: float) -> None:
        """From rest at `home` the carriage meets the line of the cut after its own travel `distance`, u."""
        self.coupling = coupling
        self.home = home
        self.start = (home - distance) / coupling
        self.sync = (home + distance) / coupling
        self.joined = False
        self.pulls = False

    def lay_gap(self, mu: float, distance: float, travel: float) -> None:
        """From here the carriage gets ahead by `distance` while the line's share of its travel is `travel`, u."""
        self.pulls = True
        self.gap_begin = mu
        self.gap_end = mu + travel / self.coupling
        self.gap = distance

    def progress(self, mu: float) -> float:
        """Share of the approach that is done, 0 to 1."""
        travel = self.sync - self.start
        return clamp((mu - self.start) / travel, 0.0, 1.0) if travel > 0.0 else 1.0

    def at(self, mu: float) -> tuple[float, float, float, float]:
        """The carriage's position and its derivatives by the master's position."""
        if mu <= self.start and not self.joined:
            return self.home, 0.0, 0.0, 0.0
        if mu >= self.sync or self.joined:
            return self.in_sync_at(mu)
        travel = self.sync - self.start
        q, q1, q2, q3 = half_ramp((mu - self.start) / travel)
        k = self.coupling
        return self.home + k * travel * q, k * q1, k / travel * q2, k / travel / travel * q3

    def in_sync_at(self, mu: float) -> tuple[float, float, float, float]:
        """On the line, or ahead of it: k mu + g (10 w^3 - 15 w^4 + 6 w^5), w the share of the gap's travel."""
        k = self.coupling
        if not self.pulls or mu <= self.gap_begin:
            return k * mu, k, 0.0, 0.0
        if mu >= self.gap_end:
            return k * mu + self.gap, k, 0.0, 0.0
        rate = 1.0 / (self.gap_end - self.gap_begin)
        law, law1, law2, law3 = polynomial_3_4_5((mu - self.gap_begin) * rate)
        g1 = self.gap * rate
        g2 = g1 * rate
        return k * mu + self.gap * law, k + g1 * law1, g2 * law2, g2 * rate * law3


def gap_extremes(speed: float, acceleration: float, distance: float, travel: float) -> tuple[float, float]:
    """Bounds of the carriage's speed and acceleration while the gap is opened, u/s and u/s2; the line's, in its travel,
    are at most these."""
    rate = distance / travel * speed
    slope = 1.0 + GAP_VELOCITY * distance / travel
    return slope * speed, slope * acceleration + GAP_ACCELERATION * rate * (speed / travel)


def gap_keeps_limits(velocity: float, distance: float, travel: float, axis: AxisLimits) -> bool:
    """Whether the gap can be opened at a constant velocity of the carriage in sync, u/s, which is above 0."""
    time = travel / velocity
    speed, acceleration = gap_extremes(velocity, 0.0, distance, travel)
    return (
        speed <= axis.max_velocity
        and acceleration <= min(axis.max_acceleration, axis.deceleration())
        and GAP_JERK * distance / time / time / time <= axis.max_jerk
    )
