"""The point on the master's path up to which a Gearing has carried out the step."""

from dataclasses import dataclass

from ..master import Master
from ..master_path import MasterPath
from ..numerics.grid import ROUNDING, rounding_tolerance
from ..var import LARGEST_INPUT
from .curves import SAME_TIME
from .line import direction_of

REST_TOLERANCE = 1e-13  # of the speed in a step: what rounding leaves of a velocity that reaches 0
GREATEST_PERIOD = 1e25  # u: the master never travels so far; a period beyond it is none


@dataclass(slots=True)
class MasterPoint:
    """The master's `position`, u, at a `time`, s, since the step's beginning, and in which direction it moved before.

    - direction_since_request: of the last motion since a request began to wait; 0: none yet.
    - last_direction: of the last motion of all; 0: none yet.
    """

    position: float = 0.0
    time: float = 0.0
    direction_since_request: float = 0.0
    last_direction: float = 0.0

    def enter_section(self, path: MasterPath, section: int) -> None:
        """Go to the beginning of a section of the path."""
        self.position = path.positions[section]
        self.time = path.times[section]

    def leave_section(self, master: Master, section: int) -> None:
        """Go to the end of a section; its motion, if there was one, is the last one from now on."""
        path = master.path
        self.position = path.positions[section + 1]
        self.time = path.times[section + 1]
        if not is_same_position(master, path.positions[section], path.positions[section + 1]):
            self.direction_since_request = direction_in(path, section)
            self.last_direction = direction_in(path, section)

    def go_to(self, path: MasterPath, section: int, position: float) -> None:
        """Go further along the section, to a position on it; the input correction takes no time."""
        if section > 0:
            self.time = max(self.time, path.crossing_time(section, position))
        self.position = position

    def direction(self, master: Master) -> float:
        """In which direction the master moves at this instant: 1, -1, or 0 at rest."""
        return direction_of(master.velocity_at(self.time), master.mean_acceleration())

    def has_reversed(self, direction: float) -> bool:
        """Whether the master moved the other way before, since the request waits."""
        return self.direction_since_request == -direction

    def is_motion(self, master: Master, section: int) -> bool:
        """Whether the master moves in the rest of a section, by more than the input correction and rounding."""
        if section == 0 or master.path.times[section + 1] - self.time <= SAME_TIME * master.step:
            return False
        if master.begin_velocity != 0.0 or master.end_velocity != 0.0:
            return True
        return not is_same_position(master, master.path.positions[section], master.path.positions[section + 1])


def direction_in(path: MasterPath, section: int) -> float:
    """In which direction a section of the path leads: 1, -1, or 0 if it leads nowhere."""
    return direction_of(path.positions[section + 1] - path.positions[section], 0.0)


def is_same_position(master: Master, a: float, b: float) -> bool:
    """Whether two positions of the master differ by rounding only, that of the input in its turn included."""
    return abs(a - b) <= rounding_tolerance(a, b) + ROUNDING * min(master.period, LARGEST_INPUT)


def goes_on(master: Master, section: int, direction: float) -> bool:
    """Whether the master, at the end of a section that leads in this direction, goes on; else it turns or rests."""
    velocity = 0.0
    if section == 0:
        velocity = master.begin_velocity
    elif section == master.path.sections - 1:
        velocity = master.end_velocity
    highest = max(abs(master.begin_velocity), abs(master.end_velocity))
    return direction * velocity > REST_TOLERANCE * highest


def occurrence_spacing(master: Master) -> float:
    """The distance between the occurrences of a position of the master; 0: there is but one."""
    return master.period if master.period <= GREATEST_PERIOD else 0.0
