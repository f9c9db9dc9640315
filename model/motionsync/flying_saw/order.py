"""What a gear-in command asks for, as it was at its edge: a synchronisation planned anew later goes by it too."""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..limits import usable
from .commands import GearInVelo
from .faults import Fault
from .machine import Axis, chosen, ends_known
from .sync_mode import SyncMode


@dataclass(slots=True)
class Order:
    """`factor` is the slave's velocity per master's; limits in u/s, u/s2, u/s3; positions in u, the master's unwrapped.

    `to_position`: of gear_in_pos; the sync positions and the start distance are its own.
    """

    to_position: bool = False
    factor: float = 1.0
    velocity: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0
    jerk: float = 0.0
    min_position: float = 0.0
    max_position: float = 0.0
    master_sync: float = 0.0
    slave_sync: float = 0.0
    start_distance: float = 0.0
    mode: SyncMode = var.part(SyncMode, hidden=True)

    def checked_jerk(self) -> float:
        """The jerk limit that a profile is to keep; 0 if it is not checked."""
        return self.jerk if self.mode.check_max_jerk else 0.0

    def sample(self, command: GearInVelo, axis: Axis, mode: SyncMode, cosine: float) -> None:
        """What is common to both commands; `cosine`: of the angle between both axes' travels."""
        self.to_position = False
        self.start_distance = 0.0
        denominator = max(command.ratio_denominator, 0)
        self.factor = command.ratio_numerator / denominator / cosine if denominator > 0 else 0.0
        self.velocity = chosen(command.velocity, axis.max_velocity)
        self.acceleration = chosen(command.acceleration, axis.max_acceleration)
        self.deceleration = chosen(command.deceleration, axis.max_deceleration)
        self.jerk = chosen(command.jerk, axis.max_jerk)
        self.min_position = axis.min_position
        self.max_position = axis.max_position
        self.mode.take(mode)

    def aim(self, master_sync: float, slave_sync: float, start_distance: float) -> None:
        """What only gear_in_pos has."""
        self.to_position = True
        self.master_sync = master_sync
        self.slave_sync = slave_sync
        self.start_distance = start_distance

    def take(self, other: "Order") -> None:
        self.to_position = other.to_position
        self.factor = other.factor
        self.velocity = other.velocity
        self.acceleration = other.acceleration
        self.deceleration = other.deceleration
        self.jerk = other.jerk
        self.min_position = other.min_position
        self.max_position = other.max_position
        self.master_sync = other.master_sync
        self.slave_sync = other.slave_sync
        self.start_distance = other.start_distance
        self.mode.take(other.mode)

    def fault(self) -> Fault:
        """What is wrong with the values whatever the axes do."""
        if self.factor == 0.0 or not isfinite(self.factor):
            return Fault.FACTOR
        dynamics = usable(self.acceleration) and usable(self.deceleration) and usable(self.jerk)
        positions = ends_known(self.min_position, self.max_position)
        return Fault.NONE if usable(self.velocity) and dynamics and positions else Fault.LIMIT
