"""Late cuts: whether the next cut can still be made where it is due, and what happens if it cannot."""

from ..cutting.interface import LateMode, Source, Statistics
from ..cutting.material import Material
from ..cutting.piece import PieceInProgress
from ..master import Master
from ..numerics.grid import floor
from ..var import Enumeration
from .carriage import Carriage
from .faults import SkipReason
from .machine_limits import Machine, is_admissible, lead

IN_TIME = 1.0 - 1e-9  # of the least way of an approach: with less, a start is late
WHOLE = 1e-12  # of a pitch: what a number of pitches may lack to be whole


class CutDecision(Enumeration):
    """What happens to the next cut where its approach has to start"""

    MAKE = 0, "its approach starts"
    MAKE_LATE = 1, "it is late: it is made as soon as possible"
    SKIP = 2, "it is late: it is left out"
    STOP_LINE = 3, "it is late: a fault asks the line to stop"
    SKIP_UNTIL_ADMISSIBLE = 4, "the line is too fast: all cuts are left out that are due until it is slow enough"
    STOP_FAST_LINE = 5, "the line is too fast: a fault asks it to stop"


def decide_cut(
    late_mode: LateMode, piece: PieceInProgress, machine: Machine, velocity: float, distance: float, earliest: float
) -> CutDecision:
    """Decide about the next cut at a line velocity, u/s, if `distance`, u, is left for the carriage's way into sync and
    the earliest cut is at the position `earliest`, u.

    A trimming or short cut is never skipped, but waits for a line that is slow enough. A cut that leaves no piece, at a
    mark that another cut has overtaken, is late."""
    waits = piece.waits_for_line()
    if not (waits or is_admissible(machine, velocity)):
        return CutDecision.STOP_FAST_LINE if late_mode == LateMode.STOP_LINE else CutDecision.SKIP_UNTIL_ADMISSIBLE
    if distance >= lead(machine, velocity) * IN_TIME and piece.leaves_length(piece.end):
        return CutDecision.MAKE
    if waits or (late_mode == LateMode.LATE and piece.leaves_length(earliest)):
        return CutDecision.MAKE_LATE
    return CutDecision.STOP_LINE if late_mode == LateMode.STOP_LINE else CutDecision.SKIP


def cut_of_start(cut: float, carriage: Carriage, master: Master, distance: float) -> float:
    """The position of the cut to which an approach over a distance starts now; `cut` is any one near it."""
    start = (carriage.homing.end - distance) / carriage.machine.coupling
    return cut + (master.distance_beyond(cut, master.path.now) - start)


def fast_line_reason(machine: Machine, velocity: float) -> SkipReason:
    """Why a line velocity, u/s, is not admissible."""
    return SkipReason.VELOCITY if machine.coupling * velocity > machine.max_velocity else SkipReason.STROKE


def skip_late_cuts(
    material: Material, statistics: Statistics, carriage: Carriage, master: Master, distance: float
) -> None:
    """Leave out the next cut, and all others that are beyond where an approach over a distance starts."""
    k = carriage.machine.coupling
    start = carriage.homing.end - distance
    if material.demand.source == Source.MARK:
        for _ in range(material.marks.waiting):
            material.skip_mark(statistics)
            if material.marks.waiting > 0:
                beyond_cut = master.distance_beyond(material.marks.position(0), master.path.now)
                if k * beyond_cut <= carriage.homing.end - distance * IN_TIME:
                    break
        material.merge_to_next_mark()
    else:
        beyond_cut = master.distance_beyond(material.piece.end, master.path.now)
        number = max(1.0, -floor(WHOLE - (k * beyond_cut - start) / (k * material.piece.pitch)))
        material.skip_pitches(number, statistics)
