"""The state from which a motion of the slave's own starts, after a motion that its master has made.

A coupled slave follows its master exactly. Where a coarse or noisy input has made that motion, it asks for what no axis
can do, and a motion of the slave's own that went on from there, with limited jerk, would carry it away for kilometres.
So it goes on from what the axis could have had.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import clamp, is_usable
from .exceeded_limit import SETPOINT_TOLERANCE, ExceededLimit, Limit
from .jerk_limited import stopping_distance


@dataclass(slots=True)
class MotionStart:
    """Position, velocity and acceleration, u, u/s and u/s2, as far as the axis could have had them.

    `exceeded` is the limit beyond which the state was.
    """

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    exceeded: ExceededLimit = var.part(ExceededLimit)

    def set(self, position: float, velocity: float, acceleration: float) -> None:
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration
        self.exceeded.clear()

    def limit_position(self, lowest: float, highest: float) -> None:
        """Keep the position within these, u."""
        position = clamp(self.position, lowest, highest)
        if position != self.position:
            self.exceeded.set(Limit.MAX_POSITION if position == highest else Limit.MIN_POSITION, self.position)
            self.position = position

    def limit_acceleration(self, max_velocity: float, max_acceleration: float, max_deceleration: float) -> None:
        """Keep the acceleration within the limits of the axis, in u/s, u/s2 and u/s2."""
        acceleration = self.acceleration
        self.acceleration = attainable_acceleration(
            self.velocity, acceleration, max_velocity, max_acceleration, max_deceleration
        )
        is_beyond = abs(acceleration) > abs(self.acceleration) * (1.0 + SETPOINT_TOLERANCE)
        if is_beyond and self.exceeded.limit == Limit.NONE:
            is_faster = self.velocity * acceleration >= 0.0
            self.exceeded.set(Limit.MAX_ACCELERATION if is_faster else Limit.MAX_DECELERATION, abs(acceleration))

    def limit_way(self, lowest: float, highest: float, max_velocity: float, down: float, jerk: float) -> None:
        """Let a stop, with the limits `down` and `jerk`, end beyond the end positions, or beyond the present position,
        by no more than one from the axis's greatest velocity takes, u/s.

        If it would, the slave is no faster than that, and gets no faster. If it would not, the velocity stays, even a
        greater one, since a step of the velocity is more than an axis can do."""
        if not is_usable(max_velocity):
            return
        way = stopping_distance(max_velocity, 0.0, down, jerk)
        end = self.position + stopping_distance(self.velocity, self.acceleration, down, jerk)
        if not (end < min(lowest, self.position) - way or end > max(highest, self.position) + way):
            return
        if self.exceeded.limit == Limit.NONE:
            self.exceeded.set(Limit.MAX_VELOCITY, abs(self.velocity))
        if self.velocity * self.acceleration > 0.0:
            self.acceleration = 0.0
        self.velocity = clamp(self.velocity, -max_velocity, max_velocity)


def attainable_acceleration(
    velocity: float, acceleration: float, max_velocity: float, max_acceleration: float, max_deceleration: float
) -> float:
    """The acceleration nearest to this one that the axis can have at that velocity, u/s2.

    The limit of the acceleration holds away from standstill, that of the deceleration towards it, the greater one
    nearly at standstill. A limit that is not a number above 0 limits nothing."""
    limit = max_acceleration if velocity * acceleration > 0.0 else max_deceleration
    if abs(velocity) <= SETPOINT_TOLERANCE * max_velocity:
        limit = max(max_acceleration, max_deceleration)
    return clamp(acceleration, -limit, limit) if limit > 0.0 else acceleration
