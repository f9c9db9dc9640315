"""Which tunable parameters contradict one another, why a cut is skipped, and why a call fails.

Why a command is refused and why the machine stops is the same for all machines that cut to length: `PieceFault`
(`cutting/faults.py`). An invalid parameter changes nothing by itself: no piece is fixed with it, a start is
refused, a cycle under way ends with the values it began with.
"""

from ..cutting.faults import LONG_TRAVEL, MARK_WINDOW
from ..master import TOO_MANY_TURNS
from ..var import Enumeration

SKIPPED_CUT = ("local.skipped_cut", "statistics.skipped", "local.line_velocity")
MOST_VELOCITY = ("limits.max_line_velocity",)
ALLOWED = ("local.allowed_from", "local.allowed_to")
BEFORE = (
    "sync.before must be local.allowed_from to local.allowed_to, so that there is a way from the park angle to it",
    "sync.before",
    "local.allowed_from",
    "local.allowed_to",
)
AFTER = (
    "sync.after must be local.allowed_from to local.allowed_to, so that there is a way from it to the park angle",
    "sync.after",
    "local.allowed_from",
    "local.allowed_to",
)


class SkipReason(Enumeration):
    """Why a cut was skipped"""

    NONE = 0, "no cut was skipped"
    LATE = (
        1,
        "cut skipped: the knife cannot be in sync with it within the limits of its axis",
        *SKIPPED_CUT,
        *MOST_VELOCITY,
    )
    PARKING = 2, "cut skipped: on its way to park the blade passes its place out of sync", "statistics.unsynchronised"
    RAMP = (
        3,
        "cut skipped: the ramp from rest would have had to begin before start, before the end of hold, or before the "
        "place of the cut was known",
        *SKIPPED_CUT,
        "local.missing_distance",
    )


class KnifeLimit(Enumeration):
    """Which limit of the axis is exceeded, where the knife's axis names another one than `Limit` does"""

    NONE = 0, "none"
    MAX_DECELERATION = (
        5,
        "limit exceeded: the slave's deceleration is beyond its axis's",
        "local.exceeded_value",
        "axis.max_acceleration",
    )


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    BLADES = (
        2,
        "knife.blades must be local.allowed_from to local.allowed_to, so that there is a way between two windows",
        "knife.blades",
        *ALLOWED,
    )
    MARK_WINDOW = 3, *MARK_WINDOW
    TRAVEL = 4, *LONG_TRAVEL
    PARK_ANGLE = (
        5,
        "knife.park_angle must be 0, or local.allowed_from to local.allowed_to, which is between two windows",
        "knife.park_angle",
        *ALLOWED,
    )
    SYNC_BEFORE = 6, *BEFORE
    SYNC_AFTER = 7, *AFTER


class KnifeContradiction(Enumeration):
    """Which tunable parameters contradict one another; 1 to 1000 are parameters out of their own ranges"""

    # The other numbers are those of `Contradiction`.
    NONE = 0, "none"
    BEFORE = 1003, *BEFORE
    AFTER = 1004, *AFTER
