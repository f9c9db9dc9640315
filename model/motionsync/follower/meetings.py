"""Where master and slave meet. Source: Robox mv_follow2. All positions are the master's, in M."""

from dataclasses import dataclass

from ..numerics.computable_range import is_usable
from ..numerics.grid import first_on_grid_from, wrap
from .interface import FollowerInterface

JUST_PASSED = 1e-12  # of a period: a value of sync_master that is less ahead than this has just been passed


@dataclass(slots=True)
class Meetings:
    """The values of `sync_master`: the new one and the one in use, each at its unwrapped position.

    - last_value: sync_master, as it was read last.
    - has_new_value: sync_master has a value that no variable cycle has used yet; it means `new_position`.
    - uses_value: the variable cycle under way has its meeting from a value of sync_master, which means `used_position`.
    - turn_origin: the position from which the meetings of a fixed cycle count.
    """

    last_value: float = 0.0
    has_new_value: bool = False
    new_position: float = 0.0
    uses_value: bool = False
    used_position: float = 0.0
    turn_origin: float = 0.0

    def record_new_value(self, parameters: FollowerInterface, master: float) -> None:
        """sync_master has a new value; with a period it means the first occurrence ahead of the master's position."""
        self.last_value = parameters.sync_master
        self.has_new_value = True
        self.new_position = parameters.sync_master
        period = parameters.master.period
        if period > 0.0:
            travel = wrap(parameters.sync_master, period) - wrap(master, period)
            if travel <= JUST_PASSED * period:
                travel += period
            self.new_position = master + travel

    def use_new_value(self) -> None:
        """The new value of a variable cycle becomes that of the cycle which starts."""
        if self.has_new_value:
            self.uses_value = True
            self.used_position = self.new_position
        self.has_new_value = False

    def latest_position(self) -> float:
        """What the last value of a variable cycle means, be it new or that of the cycle under way."""
        return self.new_position if self.has_new_value else self.used_position

    def origin(self, parameters: FollowerInterface) -> float:
        """A position from which the meetings of a fixed cycle are whole cycles away."""
        return self.turn_origin + parameters.sync_master - lead(parameters)

    def first_from(self, parameters: FollowerInterface, lowest: float) -> float:
        """Of the meetings of a fixed cycle the first one that is not before `lowest`."""
        return first_on_grid_from(self.origin(parameters), parameters.master_cycle, lowest)

    def new_meeting(self, parameters: FollowerInterface) -> float:
        """The meeting that the new value of a variable cycle gives."""
        return self.new_position - lead(parameters)

    def shift(self, master_cycle: float, dropped: float) -> None:
        """The master's positions are from now on smaller by `dropped`."""
        self.new_position -= dropped
        self.used_position -= dropped
        origin = self.turn_origin - dropped
        self.turn_origin = wrap(origin, master_cycle) if is_usable(master_cycle) else origin


def lead(parameters: FollowerInterface) -> float:
    """How far the meeting is before sync_master: half the synchronized phase, or 0."""
    if not parameters.align_center:
        return 0.0
    return 0.5 * (parameters.sync_out - parameters.sync_slave) / parameters.k_slave_master
