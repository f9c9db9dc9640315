"""The drive of a scenario's master that follows a velocity which the block puts out: a line that does as it is asked.

The drive is a part of the controller whose cycle is the scan. Within a scan its acceleration is constant; therefore the
master is known exactly, whatever the step size of the run is.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Drive:
    """A lag of first order (PT1) behind a velocity that the block asks for.

    Attributes:
        follows: the output or local variable that holds this velocity, in u/s.
        time_constant: the time constant of the lag, in s.
        max_acceleration: the greatest magnitude of the acceleration, in u/s2; infinite: any.
    """

    follows: str
    time_constant: float
    max_acceleration: float

    @property
    def limited(self) -> bool:
        """Whether the acceleration has a limit."""
        return math.isfinite(self.max_acceleration)

    def acceleration(self, velocity: float, asked: float, scan: float) -> float:
        """The master's acceleration during a scan of so many s that begins at `velocity`, in u/s2.

        With it, the velocity at the end of the scan is that of the lag to which the velocity `asked` for was held,
        unless the acceleration is at its limit."""
        needed = (asked - velocity) * -math.expm1(-scan / self.time_constant) / scan
        return min(max(needed, -self.max_acceleration), self.max_acceleration)
