"""Whether the slave can have exceeded a limit of its axis, by the extremes of its values in a run.

Only the whole course shows it for certain (`scenario/evaluate/key_figures.py`): a limit may change during a run, and
acceleration and deceleration are distinguished point by point. But values that stayed within the tightest limit have
exceeded none."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from motionsync.motion.exceeded_limit import SETPOINT_TOLERANCE
from motionsync.var import Role

from ..interface.variables import Variable
from ..scenario.engineering import ROUNDING
from ..scenario.scenario import Scenario

ENDS = (Role.MIN_POSITION, Role.MAX_POSITION)  # all other limits are magnitudes, and 0 where there is none
MAGNITUDES = {
    "slave.velocity": (Role.MAX_VELOCITY,),
    "slave.acceleration": (Role.MAX_ACCELERATION, Role.MAX_DECELERATION),
    "slave.jerk": (Role.MAX_JERK,),
}


class Extent(NamedTuple):
    """The least and the greatest of a variable's values at all points of a run."""

    least: float
    greatest: float

    @property
    def magnitude(self) -> float:
        return max(abs(self.least), abs(self.greatest))


class AxisLimitCheck:
    """The limits of the slave's axis of a block with these variables; false: it has none."""

    def __init__(self, variables: Iterable[Variable]) -> None:
        roles = (*ENDS, *(role for roles in MAGNITUDES.values() for role in roles))
        self._by_role = {v.declaration.role: v for v in variables if v.declaration.role in roles}

    def __bool__(self) -> bool:
        return bool(self._by_role)

    def may_be_exceeded(self, scenario: Scenario, extents: Mapping[str, Extent]) -> bool:
        """Whether the whole course has to be looked at; if not, no limit was exceeded.

        `extents`: those of the slave's position, velocity, acceleration and jerk."""
        if any(v.name in r.add for r in scenario.reactions for v in self._by_role.values()):
            return True
        if self._is_outside(scenario, extents["slave.position"]):
            return True
        return any(
            extents[name].magnitude > self._tightest(scenario, roles) * (1.0 + SETPOINT_TOLERANCE)
            for name, roles in MAGNITUDES.items()
        )

    def _is_outside(self, scenario: Scenario, position: Extent) -> bool:
        """Whether the slave was beyond an end position, by more than rounding."""
        lower, upper = (self._values(scenario, role) for role in ENDS)
        allowed = ROUNDING * max(1.0, position.greatest - position.least, position.magnitude)
        below = max(lower, default=-math.inf) - position.least
        return below > allowed or position.greatest - min(upper, default=math.inf) > allowed

    def _tightest(self, scenario: Scenario, roles: Iterable[Role]) -> float:
        """The least of these limits at any time of a run; infinite: there is none."""
        values = (value for role in roles for value in self._values(scenario, role))
        return min((value for value in values if value != 0.0), default=math.inf)

    def _values(self, scenario: Scenario, role: Role) -> list[float]:
        """All values that a limit has in a run; empty: the block has no such limit."""
        v = self._by_role.get(role)
        if v is None:
            return []
        changes = (*(s.values for s in scenario.settings), *(r.set for r in scenario.reactions))
        return [scenario.start.get(v.name, v.start), *(values[v.name] for values in changes if v.name in values)]
