"""A gear-in command, as read at its edge. A synchronisation that is planned anew later uses the same values."""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..motion.axis_limits import AxisLimits, are_ends_finite, limit_in_use
from ..numerics.computable_range import is_usable
from ..numerics.grid import wrap
from .commands import GearInVelo
from .faults import Fault
from .sync_mode import SyncMode

JUST_PASSED = 1e-12  # of a period: a sync position that is less ahead is the one just passed


@dataclass(slots=True)
class GearInRequest:
    """A gear-in command's values; limits in u/s, u/s2 and u/s3, positions in u, the master's unwrapped.

    Attributes:
        to_position: the command is gear_in_pos, which alone has sync positions and a start distance.
        factor: the slave's velocity over the master's in sync; 0: the ratio is out of its range.
        velocity, acceleration, deceleration, jerk: the limits in use, the command's own or the axis's.
        master_sync, slave_sync: where master and slave are when both are in sync.
        start_distance: the slave starts that much before master_sync; 0: at once.
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
        """The jerk limit that a profile has to keep, u/s3; 0 if the jerk is not checked."""
        return self.jerk if self.mode.check_max_jerk else 0.0

    def read(self, command: GearInVelo, axis: AxisLimits, mode: SyncMode, cosine: float) -> None:
        """Read what both gear-in commands have; `cosine` is that of the angle between the travels of both axes."""
        self.to_position = False
        self.start_distance = 0.0
        denominator = max(command.ratio_denominator, 0)
        is_ratio = denominator > 0 and is_usable(abs(command.ratio_numerator))
        self.factor = command.ratio_numerator / denominator / cosine if is_ratio else 0.0
        self.velocity = limit_in_use(command.velocity, axis.max_velocity)
        self.acceleration = limit_in_use(command.acceleration, axis.max_acceleration)
        self.deceleration = limit_in_use(command.deceleration, axis.deceleration())
        self.jerk = limit_in_use(command.jerk, axis.max_jerk)
        self.min_position = axis.min_position
        self.max_position = axis.max_position
        var.copy(self.mode, mode)

    def set_sync_positions(self, master_sync: float, slave_sync: float, start_distance: float) -> None:
        """Add what only gear_in_pos has."""
        self.to_position = True
        self.master_sync = master_sync
        self.slave_sync = slave_sync
        self.start_distance = start_distance

    def find_fault(self) -> Fault:
        """The fault that the values have whatever the axes do."""
        if self.factor == 0.0:
            return Fault.FACTOR
        dynamics = is_usable(self.acceleration) and is_usable(self.deceleration) and is_usable(self.jerk)
        positions = are_ends_finite(self.min_position, self.max_position)
        return Fault.NONE if is_usable(self.velocity) and dynamics and positions else Fault.LIMIT


def unwrap_sync_position(master: Master, position: float) -> float:
    """The unwrapped position that a master's sync position means.

    With a period a position in [0, period) means its next occurrence ahead of the master. Any other position is in the
    same turn as the master's input, whether that is wrapped or not."""
    period = master.period
    if period == 0.0:
        return position
    if not 0.0 <= position < period:
        return master.unwrap_in_current_turn(position)
    missing = position - wrap(master.begin, period)
    if master.begin_velocity >= 0.0 and missing <= JUST_PASSED * period:
        missing += period
    elif master.begin_velocity < 0.0 and missing >= -JUST_PASSED * period:
        missing -= period
    return master.begin + missing
