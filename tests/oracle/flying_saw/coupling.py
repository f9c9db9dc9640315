"""The coupling of a flying saw, and when its master passes a position."""

from dataclasses import dataclass

from tests.oracle.flying_saw.request import Request
from tests.oracle.flying_saw.rows import PREPHASE
from tests.oracle.master import CLOSE, Stretch
from tests.oracle.numerics.mp import Number


@dataclass(slots=True)
class Coupling:
    """A gear-in command that is under way.

    `request`: what the edge gave; `position`: the coupling position; `direction` in which the master passes it forwards
    (0: not known yet); `behind`: the master is behind it; `reached`: sync has been reached; `wait_until`: the master
    position to wait for, with `direction` then that of the edge.
    """

    group: str
    request: Request
    state: int
    position: Number
    direction: int
    behind: bool = False
    reached: bool = False
    wait_until: Number | None = None

    @property
    def parked(self) -> bool:
        return self.state == PREPHASE and self.wait_until is None


def passing_time(
    stretch: Stretch, time: Number, until: Number, position: Number, direction: int, *, touching: bool = False
) -> Number | None:
    """When the master goes beyond (or touches) a position in that direction; now if it is beyond already."""
    present = stretch.at(time).position
    if direction == 0 or stretch.direction != direction:
        return time if touching and direction and (present - position) * direction >= 0 else None
    margin = CLOSE * (1 + abs(position))
    if (stretch.at(until).position - position) * direction <= (-margin if touching else margin):
        return None
    return time if (present - position) * direction >= 0 else stretch.when(position, time, until)
