"""Synchronisation along a profile in time: the slave goes to the velocity factor v_m, whatever the master does.

Source: TS5055, section 5 (GEARINSYNCMODE_TIMEBASED).
"""

from dataclasses import dataclass

from ..motion.jerk_limited import Motion, acceleration_limit
from ..slave import Slave
from .gear_in_request import GearInRequest

SAME_ACCELERATION = 1e-9  # of the acceleration limit: a smaller difference is rounding
SAME_TARGET = 1e-12  # of the velocity limit: a smaller difference is rounding
AT_LIMIT = 1e-12  # of the velocity limit: a target that is nearer to it is at it


@dataclass(slots=True)
class TimeBasedSync:
    """The velocity that the slave's motion is planned to reach: target + acceleration t, where t is the motion's clock.

    The motion is time-optimal with |a| within `acceleration_limit`. For the velocity that is still lacking,
    w = v - factor v_m, these limits are shifted by factor a_m. The motion is planned anew only when the master does not
    do what was expected.

    Attributes:
        target: factor v_m when the motion was planned, or the velocity limit, u/s.
        acceleration: factor a_m then, u/s2.
        at_limit: the master is too fast, so the target is the velocity limit; the slave cannot be in sync there.
        reachable: the motion ends at the target. It does not where the target's acceleration is beyond the limits.
    """

    target: float = 0.0
    acceleration: float = 0.0
    at_limit: bool = False
    reachable: bool = True

    def set_target(self, request: GearInRequest, master_velocity: float, master_acceleration: float) -> None:
        """Take the target from the master's present velocity (u/s) and acceleration (u/s2)."""
        self.target = request.factor * master_velocity
        self.acceleration = request.factor * master_acceleration
        limit = request.velocity
        outward = self.acceleration if self.target > 0.0 else -self.acceleration
        over = abs(self.target) - limit
        self.at_limit = over > AT_LIMIT * limit or (over >= -AT_LIMIT * limit and outward > 0.0)
        if self.at_limit:
            self.target = limit if self.target > 0.0 else -limit
            self.acceleration = 0.0

    def plan(self, request: GearInRequest, motion: Motion, slave: Slave) -> None:
        """Plan the slave's motion to the target from its present state."""
        motion.start(slave.position, slave.velocity, slave.acceleration)
        limit = acceleration_limit(slave.velocity, self.target, request.acceleration, request.deceleration)
        self.reachable = motion.try_change(self.target, self.acceleration, -limit, limit, request.jerk)

    def continues(self, request: GearInRequest, former: "TimeBasedSync", clock: float) -> bool:
        """Whether this target is the one that the former target has become at that time of its motion's clock, s."""
        limit = min(request.acceleration, request.deceleration)
        target = former.target + former.acceleration * clock
        return (
            self.at_limit == former.at_limit
            and abs(self.acceleration - former.acceleration) <= SAME_ACCELERATION * limit
            and abs(self.target - target) <= SAME_TARGET * request.velocity
        )

    def time_to_limit(self, request: GearInRequest, master_velocity: float, master_acceleration: float) -> float:
        """How long until factor v_m reaches the velocity limit, from inside or from outside, s; -1 if it does not."""
        acceleration = request.factor * master_acceleration
        toward = request.velocity if acceleration > 0.0 else -request.velocity
        limit = -toward if self.at_limit and self.target * acceleration < 0.0 else toward
        if acceleration == 0.0 or (self.at_limit and self.target * acceleration >= 0.0):
            return -1.0
        return max((limit - request.factor * master_velocity) / acceleration, 0.0)
