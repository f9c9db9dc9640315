"""How fast the line may be for curves over the master.

On a line of velocity v, curves with the greatest d1, d2, d3 take the velocity d1 v, the acceleration d2 v2 and the
jerk d3 v3; the axis's limits of these give the greatest v.
"""

from math import sqrt

from ..numerics.cube_root import cube_root
from .curves import Peaks
from .knife import Knife

FASTEST = 1e300  # u/s: the velocity of a line that nothing limits
PUNCTUAL = 1.0 + 1e-9  # of a greatest line velocity: a cut is late above this


def admissible_velocity(knife: Knife, peaks: Peaks) -> float:
    """The greatest line velocity, u/s of the master, at which curves with these peaks keep the axis's limits."""
    velocity = FASTEST
    if peaks.d1 > 0.0:
        velocity = knife.max_velocity / peaks.d1
    if peaks.d2 > 0.0:
        velocity = min(velocity, sqrt(knife.max_acceleration / peaks.d2))
    if peaks.d3 > 0.0:
        velocity = min(velocity, cube_root(knife.max_jerk / peaks.d3))
    return velocity


def keeps_limits(knife: Knife, peaks: Peaks, velocity: float) -> bool:
    """Whether curves with these peaks keep the axis's limits at a line velocity, but for rounding."""
    return velocity <= PUNCTUAL * admissible_velocity(knife, peaks)
