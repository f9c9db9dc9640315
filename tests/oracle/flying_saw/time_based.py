"""The time-based ramp of the flying saw: a slave that is synchronised over time aims at a multiple of the master's
velocity.

Readings of the specification that it leaves open:
- The time-based limits are those of the own motion from v to the (clamped) target. Where the master's acceleration
  leaves no margin (|k·a_m| not below the limit), the slave accelerates at its limit until that changes. A jump of the
  master's velocity and the begin and end of clamping are planned anew as well; the characteristics stay those of the
  edge. The two ignore bits do not concern it.
"""

from dataclasses import dataclass

from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.flying_saw.laws import Law
from tests.oracle.flying_saw.motion import Phases, limit_towards, ramp_between
from tests.oracle.flying_saw.request import Limits
from tests.oracle.master import CLOSE, Motion, Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


@dataclass(frozen=True, slots=True)
class TimeBasedRamp:
    """The ratio of the coupling, and the limits of the command."""

    factor: Number
    limits: Limits

    def is_clamped(self, master: Motion) -> bool:
        """The target velocity is beyond the limit, or at it and going beyond."""
        velocity, change = self.factor * master.velocity, self.factor * master.acceleration
        excess = abs(velocity) - self.limits.velocity
        if abs(excess) <= CLOSE * self.limits.velocity:
            return bool(velocity * change > 0)
        return bool(excess > 0)

    def target(self, master: Motion) -> tuple[Number, Number]:
        """The velocity and acceleration at which the ramp aims."""
        if self.is_clamped(master):
            return mp.sign(self.factor * master.velocity) * self.limits.velocity, ZERO
        return self.factor * master.velocity, self.factor * master.acceleration

    def clamp_changes(self, stretch: Stretch, time: Number, until: Number) -> list[Number]:
        """When |k·v_m| next reaches the velocity limit, if it does so until then."""
        if stretch.jerk != 0:
            raise ValueError("time-based synchronisation needs a master whose acceleration is constant in each segment")
        master = stretch.at(time)
        if master.acceleration == 0:
            return []
        limit = self.limits.velocity / abs(self.factor)
        delays = ((mp.sign(side) * limit - master.velocity) / master.acceleration for side in (1, -1))
        return [time + d for d in delays if d > CLOSE and time + d <= until]

    def phases(self, slave: Motion, master: Motion) -> Phases:
        """The ramp in w = v - target, with the limits of the own motion shifted by the target's acceleration."""
        velocity, acceleration = self.target(master)
        limit = limit_towards(slave.velocity, velocity, self.limits.acceleration, self.limits.deceleration)
        return ramp_between(
            slave.velocity - velocity,
            slave.acceleration - acceleration,
            -limit - acceleration,
            limit - acceleration,
            self.limits.jerk,
        )

    def law(self, time: Number, slave: Motion, master: Motion, jerk: Number) -> Law:
        """Constant jerk relative to the target."""
        if self.is_clamped(master):
            return Law(time, [slave.position, slave.velocity, slave.acceleration / 2, jerk / 6])
        velocity, acceleration = self.target(master)
        relative = [slave.position, slave.velocity - velocity, (slave.acceleration - acceleration) / 2, jerk / 6]
        return Law(time, relative, self.factor, master.position)
