"""Synchronisation along a profile in time: the slave chases factor * v_m while the master goes its own way.

Source: TS5055, section 5 (GEARINSYNCMODE_TIMEBASED).
"""

from dataclasses import dataclass

from ..motion import Motion, acceleration_limit
from .order import Order

SAME_SLOPE = 1e-9  # of the acceleration limit: a difference of rounding
SAME_TARGET = 1e-12  # of the velocity limit, likewise
AT_LIMIT = 1e-12  # of the velocity limit, likewise


@dataclass(slots=True)
class Chase:
    """What the slave's motion, planned with it, runs after: the velocity target + slope t, t the motion's clock.

    Time-optimal with |a| <= the limit of `acceleration_limit`; for the velocity that is lacking, w = v - factor v_m,
    this shifts the limits by factor a_m. Planned anew only when the master does not do what was expected. A target
    beyond the velocity limit is `held` there, and not in sync.
    """

    target: float = 0.0
    slope: float = 0.0
    held: bool = False
    reachable: bool = True

    def aim(self, order: Order, master_velocity: float, master_acceleration: float) -> None:
        """What to chase from now on."""
        self.target = order.factor * master_velocity
        self.slope = order.factor * master_acceleration
        limit = order.velocity
        outward = self.slope if self.target > 0.0 else -self.slope
        over = abs(self.target) - limit
        self.held = over > AT_LIMIT * limit or (over >= -AT_LIMIT * limit and outward > 0.0)
        if self.held:
            self.target = limit if self.target > 0.0 else -limit
            self.slope = 0.0

    def plan(self, order: Order, motion: Motion, position: float, velocity: float, acceleration: float) -> None:
        """The slave's motion from its present state."""
        limit = acceleration_limit(velocity, self.target, order.acceleration, order.deceleration)
        self.reachable = motion.change(
            position, velocity, acceleration, self.target, self.slope, -limit, limit, order.jerk
        )

    def continues(self, order: Order, former: "Chase", clock: float) -> bool:
        """Whether this is what the former one has come to at that clock."""
        limit = min(order.acceleration, order.deceleration)
        target = former.target + former.slope * clock
        return (
            self.held == former.held
            and abs(self.slope - former.slope) <= SAME_SLOPE * limit
            and abs(self.target - target) <= SAME_TARGET * order.velocity
        )

    def take(self, other: "Chase") -> None:
        self.target = other.target
        self.slope = other.slope
        self.held = other.held

    def turn(self, order: Order, velocity: float, acceleration: float) -> float:
        """How long until factor v_m comes to the velocity limit, from inside or outside, s; -1: it does not.

        `velocity`, `acceleration`: the master's now.
        """
        slope = order.factor * acceleration
        toward = order.velocity if slope > 0.0 else -order.velocity
        edge = -toward if self.held and self.target * slope < 0.0 else toward
        if slope == 0.0 or (self.held and self.target * slope >= 0.0):
            return -1.0
        return max((edge - order.factor * velocity) / slope, 0.0)
