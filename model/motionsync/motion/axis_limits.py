"""The slave axis's machine data, and the limits that a command takes from it."""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..numerics.computable_range import LARGEST
from ..var import Role, Unit


@dataclass(slots=True)
class AxisLimits:
    """The slave axis's machine data: where it starts, and its limits."""

    initial_position: float = var.parameter(0.0, "where the axis is at first", Unit.POSITION, min=-LARGEST, max=LARGEST)
    max_velocity: float = var.limit(2000.0, "velocity limit, not 0", Unit.VELOCITY, zero=False, role=Role.MAX_VELOCITY)
    max_acceleration: float = var.limit(
        10000.0, "acceleration limit, not 0", Unit.ACCELERATION, zero=False, role=Role.MAX_ACCELERATION
    )
    max_deceleration: float = var.limit(
        0.0, "deceleration limit; 0: as the acceleration limit", Unit.ACCELERATION, role=Role.MAX_DECELERATION
    )
    max_jerk: float = var.limit(100000.0, "jerk limit, not 0", Unit.JERK, zero=False, role=Role.MAX_JERK)
    min_position: float = var.position(-1e9, "lower software end position", role=Role.MIN_POSITION)
    max_position: float = var.position(1e9, "upper software end position", role=Role.MAX_POSITION)

    def deceleration(self) -> float:
        """The deceleration limit in use, u/s2."""
        return limit_in_use(self.max_deceleration, self.max_acceleration)


def limit_in_use(limit: float, otherwise: float) -> float:
    """A limit, or `otherwise` where it is 0: for a command's the axis's, for the deceleration's the acceleration's."""
    return otherwise if limit == 0.0 else limit


def are_ends_finite(lowest: float, highest: float) -> bool:
    """Whether both software end positions are finite; the command that reads tunable parameters checks them."""
    return isfinite(lowest) and isfinite(highest)
