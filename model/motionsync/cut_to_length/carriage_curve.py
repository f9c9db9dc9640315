"""The carriage's curves over the material: into sync, in sync, and ahead of the material through a gap.

Their argument `beyond_cut` is how far the master is beyond the position at which the cut passes carriage position 0, so
that a cut keeps its last bits however far the material has run.
"""

from dataclasses import dataclass

from ..motion.axis_limits import AxisLimits
from ..motion.laws import (
    POLYNOMIAL_3_4_5_D1,
    POLYNOMIAL_3_4_5_D2,
    POLYNOMIAL_3_4_5_D3,
    half_ramp,
    polynomial_3_4_5,
)
from ..numerics.computable_range import clamp


@dataclass(slots=True)
class CarriageCurve:
    """The curve of one cycle.

    Attributes:
        coupling: k, carriage travel per master travel in sync.
        home: where the carriage rests before the approach, u.
        start, sync: `beyond_cut` at the beginning and at the end of the approach.
        has_joined: the carriage is in sync, or has been in this cycle: a master that turns back takes it along.
        has_gap: the gap is being opened, or is open.
        gap_begin, gap_end: `beyond_cut` between which it is opened.
        gap_distance: by how much the carriage gets ahead of the material, u.
    """

    coupling: float = 1.0
    home: float = 0.0
    start: float = 0.0
    sync: float = 0.0
    has_joined: bool = False
    has_gap: bool = False
    gap_begin: float = 0.0
    gap_end: float = 0.0
    gap_distance: float = 0.0

    def plan_approach(self, coupling: float, home: float, distance: float) -> None:
        """From rest at `home` the carriage is in sync with the cut after its own travel `distance`, u."""
        self.coupling = coupling
        self.home = home
        self.start = (home - distance) / coupling
        self.sync = (home + distance) / coupling
        self.has_joined = False
        self.has_gap = False

    def plan_gap(self, beyond_cut: float, distance: float, travel: float) -> None:
        """From now on the carriage gets ahead by `distance` while it travels `travel` with the material, u."""
        self.has_gap = True
        self.gap_begin = beyond_cut
        self.gap_end = beyond_cut + travel / self.coupling
        self.gap_distance = distance

    def progress(self, beyond_cut: float) -> float:
        """Share of the approach that is done, 0 to 1."""
        travel = self.sync - self.start
        return clamp((beyond_cut - self.start) / travel, 0.0, 1.0) if travel > 0.0 else 1.0

    def at(self, beyond_cut: float) -> tuple[float, float, float, float]:
        """The carriage's position and its derivatives by the master's position."""
        if beyond_cut <= self.start and not self.has_joined:
            return self.home, 0.0, 0.0, 0.0
        if beyond_cut >= self.sync or self.has_joined:
            return self.in_sync_at(beyond_cut)
        travel = self.sync - self.start
        q, q1, q2, q3 = half_ramp((beyond_cut - self.start) / travel)
        k = self.coupling
        return self.home + k * travel * q, k * q1, k / travel * q2, k / travel / travel * q3

    def in_sync_at(self, beyond_cut: float) -> tuple[float, float, float, float]:
        """In sync, or ahead of it by the share 10 w^3 - 15 w^4 + 6 w^5 of the gap, at the share w of its travel."""
        k = self.coupling
        if not self.has_gap or beyond_cut <= self.gap_begin:
            return k * beyond_cut, k, 0.0, 0.0
        if beyond_cut >= self.gap_end:
            return k * beyond_cut + self.gap_distance, k, 0.0, 0.0
        rate = 1.0 / (self.gap_end - self.gap_begin)
        law, law1, law2, law3 = polynomial_3_4_5((beyond_cut - self.gap_begin) * rate)
        g1 = self.gap_distance * rate
        g2 = g1 * rate
        return k * beyond_cut + self.gap_distance * law, k + g1 * law1, g2 * law2, g2 * rate * law3


def gap_extremes(speed: float, acceleration: float, distance: float, travel: float) -> tuple[float, float]:
    """Bounds of the carriage's speed and acceleration while the gap is opened, u/s and u/s2; the line's, in its travel,
    are at most these."""
    rate = distance / travel * speed
    slope = 1.0 + POLYNOMIAL_3_4_5_D1 * distance / travel
    return slope * speed, slope * acceleration + POLYNOMIAL_3_4_5_D2 * rate * (speed / travel)


def can_open_gap(velocity: float, distance: float, travel: float, axis: AxisLimits) -> bool:
    """Whether the gap can be opened at a constant velocity of the carriage in sync, u/s, which is above 0."""
    time = travel / velocity
    speed, acceleration = gap_extremes(velocity, 0.0, distance, travel)
    return (
        speed <= axis.max_velocity
        and acceleration <= min(axis.max_acceleration, axis.deceleration())
        and POLYNOMIAL_3_4_5_D3 * distance / time / time / time <= axis.max_jerk
    )
