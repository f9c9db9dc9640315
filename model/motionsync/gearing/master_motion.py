"""How the master of a Gearing moves, and in which direction it moved before."""

from dataclasses import dataclass

from ..master import Master
from ..master_path import MasterPath
from ..numerics.grid import ROUNDING, rounding_tolerance
from ..var import LARGEST_INPUT
from .line import direction_of

SAME_TIME = 1e-13  # of a step: a time that is shorter is taken for a rounding error
REST_TOLERANCE = 1e-13  # of the speed in a step: what rounding leaves of a velocity that reaches 0
GREATEST_PERIOD = 1e25  # u: the master never travels so far; a period beyond it is none


@dataclass(slots=True)
class MasterMotion:
    """In which direction the master moved before.

    - direction_since_request: of the last motion since a request began to wait; 0: none yet.
    - last_direction: of the last motion of all; 0: none yet.
    """

    direction_since_request: float = 0.0
    last_direction: float = 0.0

    def record_section(self, master: Master) -> None:
        """The motion on the section, if there was one, is the last one from now on."""
        path = master.path
        if not is_same_position(master, path.positions[path.section], path.end):
            self.direction_since_request = direction_in(path)
            self.last_direction = direction_in(path)

    def has_reversed(self, direction: float) -> bool:
        """Whether the master moved the other way before, since the request waits."""
        return self.direction_since_request == -direction


def present_direction(master: Master) -> float:
    """In which direction the master moves at this instant: 1, -1, or 0 at rest."""
    return direction_of(master.present_velocity(), master.mean_acceleration())


def is_motion(master: Master) -> bool:
    """Whether the master moves on what is left of the section, by more than the input correction and rounding."""
    path = master.path
    if path.is_correction() or path.until - path.now <= SAME_TIME * master.step:
        return False
    if master.begin_velocity != 0.0 or master.end_velocity != 0.0:
        return True
    return not is_same_position(master, path.positions[path.section], path.end)


def direction_in(path: MasterPath) -> float:
    """In which direction the section of the path leads: 1, -1, or 0 if it leads nowhere."""
    return direction_of(path.end - path.positions[path.section], 0.0)


def is_same_position(master: Master, a: float, b: float) -> bool:
    """Whether two positions of the master differ by rounding only, that of the input in its turn included."""
    return abs(a - b) <= rounding_tolerance(a, b) + ROUNDING * min(master.period, LARGEST_INPUT)


def goes_on(master: Master, direction: float) -> bool:
    """Whether the master, at the end of the section, which leads in this direction, goes on; else it turns or rests."""
    velocity = 0.0
    section = master.path.section
    if section == 0:
        velocity = master.begin_velocity
    elif section == master.path.sections - 1:
        velocity = master.end_velocity
    highest = max(abs(master.begin_velocity), abs(master.end_velocity))
    return direction * velocity > REST_TOLERANCE * highest


def occurrence_spacing(master: Master) -> float:
    """The distance between the occurrences of a position of the master; 0: there is but one."""
    return master.period if master.period <= GREATEST_PERIOD else 0.0
