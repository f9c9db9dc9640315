"""Why a command is refused, why the machine stops, and which tunable parameters contradict one another.

The numbers are our own. An invalid parameter changes nothing by itself: no piece is fixed and no approach starts with
it, a cycle under way ends with the values it began with, a start is refused.
"""

from ..cutting.faults import LONG_TRAVEL, MARK_WINDOW
from ..master import TOO_MANY_TURNS
from ..var import Enumeration

END_POSITIONS = ("axis.min_position", "axis.max_position")
START_POSITIONS = ("axis.initial_position", "axis.min_position", "axis.max_position")
SKIPPED_CUT = ("local.skipped_cut", "statistics.skipped", "local.line_velocity")
MOST_VELOCITY = ("limits.max_line_velocity",)
HOME_BETWEEN_ENDS = (
    "home_position must be between the software end positions",
    "home_position",
    "axis.min_position",
    "axis.max_position",
)


class Fault(Enumeration):
    """Why a command was refused (1 to 6), or why the machine has stopped (16 to 20)"""

    # The other numbers are those of `PieceFault`.
    NONE = 0, "no fault"
    STROKE = 17, "the carriage has to stop before the end of its stroke", "slave.position", *END_POSITIONS
    TOOL_TIMEOUT = 19, "tool.done has not come within tool.timeout", "tool.timeout"


class SkipReason(Enumeration):
    """Why a cut was skipped"""

    NONE = 0, "no cut was skipped"
    LATE = 1, "cut skipped: the carriage was not ready in time", *SKIPPED_CUT, "local.missing_distance", *MOST_VELOCITY
    VELOCITY = 2, "cut skipped: the carriage cannot be as fast as the line", *SKIPPED_CUT, "axis.max_velocity"
    STROKE = 3, "cut skipped: the stroke is too short at this line velocity", *SKIPPED_CUT, *MOST_VELOCITY


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    HOME = 2, *HOME_BETWEEN_ENDS
    INITIAL_POSITION = 3, "axis.initial_position must be between the software end positions", *START_POSITIONS
    WINDOW = 4, *MARK_WINDOW
    TRAVEL = 5, *LONG_TRAVEL


class SawContradiction(Enumeration):
    """Which tunable parameters contradict one another; 1 to 1000 are parameters out of their own ranges"""

    # The other numbers are those of `Contradiction`.
    NONE = 0, "none"
    HOME = 1003, *HOME_BETWEEN_ENDS
