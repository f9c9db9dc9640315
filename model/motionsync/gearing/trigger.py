"""Triggers: positions base + n spacing of the master at which a waiting manoeuvre starts; with spacing 0 only one."""

from ..master import Master
from ..numerics.grid import first_on_grid_ahead, grid_tolerance
from .line import direction_of
from .master_motion import MasterMotion, goes_on
from .request import ManoeuvreRequest


def next_trigger(motion: MasterMotion, base: float, spacing: float, direction: float, position: float) -> float:
    """The first trigger ahead of a position of the master, or at it, if the master has not come from beyond it."""
    return first_on_grid_ahead(base, spacing, direction, position, not motion.has_reversed(direction))


def is_trigger_crossed(motion: MasterMotion, master: Master, base: float, spacing: float, direction: float) -> bool:
    """Whether there is a trigger on what is left of the section, which leads in this direction. The master may start on
    it, unless it has come there from beyond, and may end on it, if it goes on."""
    position = master.path.reached
    end = master.path.end
    trigger = next_trigger(motion, base, spacing, direction, position)
    margin = grid_tolerance(base, spacing, position)
    missing = direction * (trigger - position)
    if missing < -margin or (motion.has_reversed(direction) and missing <= margin):
        return False
    margin = grid_tolerance(base, spacing, end)
    missing = direction * (trigger - end)
    return missing < -margin or (missing <= margin and goes_on(master, direction))


def expected_direction(motion: MasterMotion, master: Master, request: ManoeuvreRequest) -> float:
    """In which direction the master will cross a trigger: that of its motion, if the request allows that."""
    direction = direction_of(master.end_velocity, master.end_acceleration)
    if direction == 0.0:
        direction = motion.last_direction
    if request.allows(direction):
        return direction
    return 1.0 if request.clockwise else -1.0
