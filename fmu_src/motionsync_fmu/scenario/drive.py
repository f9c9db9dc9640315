"""The drive of a master that follows a velocity which the block requests.

The drive belongs to the controller whose cycle is the scan. Its acceleration is constant within a scan; therefore the
master's motion is exact at every step size of the run.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Drive:
    """A lag of first order (PT1) behind a velocity that the block requests.

    Attributes:
        follows: the output or local variable that holds this velocity, in u/s.
        time_constant: the time constant of the lag, in s.
        max_acceleration: the greatest magnitude of the acceleration, in u/s2; infinite: any.
    """

    follows: str
    time_constant: float
    max_acceleration: float

    @property
    def has_acceleration_limit(self) -> bool:
        """Whether the acceleration has a limit."""
        return math.isfinite(self.max_acceleration)

    def gain(self, scan: float) -> float:
        """The share of the distance to the requested velocity by which the lag comes nearer in a scan, in s."""
        return -math.expm1(-scan / self.time_constant)
