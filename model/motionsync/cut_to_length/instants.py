"""The instants of events inside a step from which on a condition holds."""

from ..cutting.piece import PieceInProgress
from ..master import Master
from ..master_path import NEVER
from ..numerics.bracket import can_halve, halve, middle
from ..var import Enumeration
from .carriage import Carriage
from .machine_limits import approach_distance, is_admissible


class Condition(Enumeration):
    """What an event waits for"""

    START = 0, "an approach to the next cut has to start"
    ADMISSIBLE = 1, "the line does not go back, and the carriage can follow it"
    SYNC = 2, "the approach is over"
    BACK = 3, "the line has gone back to before the approach, by more than noise"
    COMMAND = 4, "the tool has to be commanded before sync"
    THROUGH = 5, "the cut's distance is travelled"
    GAP_OPEN = 6, "the gap is open"
    STROKE_END = 7, "the carriage has to stop before an end of its stroke"


def first_instant(
    condition: Condition, master: Master, carriage: Carriage, piece: PieceInProgress, until: float
) -> float:
    """The first instant from now on at which a condition holds, in s since the step's beginning.

    It is bisected down to rounding. NEVER: there is none up to `until`."""
    now = master.path.now
    if holds(condition, master, carriage, piece, now):
        return now
    if until <= now or not holds(condition, master, carriage, piece, until):
        return NEVER
    before = now
    after = until
    while can_halve(before, after):
        before, after = halve(before, after, holds(condition, master, carriage, piece, middle(before, after)))
    return after


def holds(condition: Condition, master: Master, carriage: Carriage, piece: PieceInProgress, time: float) -> bool:
    """Whether a condition holds at a time since the step's beginning."""
    velocity = master.velocity_at(time)
    beyond_cut = master.distance_beyond(carriage.cut, time)
    curve = carriage.curve
    cycle = carriage.cycle_machine
    is_met = False
    match condition:
        case Condition.START:
            is_met = is_start_due(master, carriage, piece, velocity, time)
        case Condition.ADMISSIBLE:
            is_met = velocity >= 0.0 and is_admissible(carriage.machine, velocity)
        case Condition.SYNC:
            is_met = beyond_cut >= curve.sync
        case Condition.BACK:
            is_met = velocity < 0.0 and beyond_cut < curve.start - master.uncertain_travel()
        case Condition.COMMAND:
            is_met = beyond_cut + velocity * (cycle.on_delay - cycle.settle_time) >= curve.sync
        case Condition.THROUGH:
            is_met = curve.coupling * (beyond_cut - carriage.cut_begin) >= cycle.cut_distance
        case Condition.GAP_OPEN:
            is_met = beyond_cut >= curve.gap_end
        case Condition.STROKE_END:
            is_met = carriage.has_to_stop(master, time)
    return is_met


def is_start_due(master: Master, carriage: Carriage, piece: PieceInProgress, velocity: float, time: float) -> bool:
    """Whether the line moves on, and the next cut is where the approach to it starts."""
    if velocity < 0.0 or (velocity == 0.0 and master.mean_acceleration() <= 0.0):
        return False
    if not has_reached_start(master, carriage, piece, velocity, time):
        return False
    return not piece.waits_for_line() or is_admissible(carriage.machine, velocity)


def has_reached_start(master: Master, carriage: Carriage, piece: PieceInProgress, velocity: float, time: float) -> bool:
    """Whether the next cut is where an approach to it starts, or beyond that."""
    travel = carriage.machine.coupling * master.distance_beyond(piece.end, time)
    return travel >= carriage.homing.end - approach_distance(carriage.machine, velocity)
