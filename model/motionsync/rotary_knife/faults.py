"""Which tuned parameter is out of its range, why a cut is skipped, and why a call fails.

Why a command is refused and why the machine stops is the same for all machines that cut to length: `PieceFault`
(`cutting/faults.py`). An invalid parameter changes nothing by itself: no piece is fixed with it, a command that reads
it is refused, a cycle under way ends with the values it began with.
"""

from ..cutting.faults import LONG_TRAVEL
from ..master import TOO_MANY_TURNS
from ..var import Enumeration

SKIPPED_CUT = ("local.skipped_cut", "statistics.skipped", "local.line_velocity", "limits.max_line_velocity")
FACTORS = ("material_factor", "calibration.factor")
WAY_BETWEEN_WINDOWS = (
    "between the windows of two blades there must be a way, with knife.park_angle on it; with sync.mode HORIZONTAL "
    "sync.before and sync.after must be at most 0.15 of knife.circumference",
    "sync.before",
    "sync.after",
    "sync.overspeed",
    "knife.park_angle",
    "knife.circumference",
    "knife.blades",
)


class SkipReason(Enumeration):
    """Why a cut was skipped"""

    NONE = 0, "no cut was skipped"
    LATE = 1, "cut skipped: the knife cannot be in sync with it within the limits of its axis", *SKIPPED_CUT
    PARKING = 2, "cut skipped: on its way to park the blade passes its place out of sync", "statistics.unsynchronised"


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    KNIFE_WINDOW = 2, *WAY_BETWEEN_WINDOWS
    MARK_WINDOW = 3, "mark.window must be less than half of mark.spacing", "mark.spacing", "mark.window"
    TRAVEL = 4, *LONG_TRAVEL


class KnifeParameter(Enumeration):
    """Which tuned parameter is out of its range"""

    # The other numbers are those of `PieceParameter`.
    NONE = 0, "none"
    MATERIAL_FACTOR = 2, "material_factor times calibration.factor must be 1e-12 to 1e12", *FACTORS
    SYNC_BEFORE = 3, "sync.before must be 0 to 1e12", "sync.before"
    SYNC_AFTER = 4, "sync.after must be 0 to 1e12", "sync.after"
    OVERSPEED = 5, "sync.overspeed must be -0.2 to 0.5", "sync.overspeed"
    KNIFE_WINDOW = 6, *WAY_BETWEEN_WINDOWS
    MARGIN = 40, "line.margin must be at least 0 and below 1", "line.margin"
    LATE_MODE = 43, "late_mode must be 1, 2 or 3", "late_mode"
