"""Why a command is refused, why the machine stops, and which tuned parameter is out of its range.

The numbers are our own. An invalid parameter changes nothing by itself: no piece is fixed and no approach starts with
it, a cycle under way ends with the values it began with, a command that reads it is refused.
"""

from ..cutting.faults import LONG_TRAVEL
from ..master import TOO_MANY_TURNS
from ..var import Enumeration

END_POSITIONS = ("axis.min_position", "axis.max_position")
START_POSITIONS = ("axis.initial_position", "axis.min_position", "axis.max_position")
SKIPPED_CUT = ("local.skipped_cut", "statistics.skipped", "local.line_velocity")
MOST_VELOCITY = ("limits.max_line_velocity",)
FACTORS = ("material_factor", "calibration.factor")
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
    WINDOW = 4, "mark.window must be less than half of mark.spacing", "mark.spacing", "mark.window"
    TRAVEL = 5, *LONG_TRAVEL


class SawParameter(Enumeration):
    """Which tuned parameter is out of its range"""

    # The other numbers are those of `PieceParameter`.
    NONE = 0, "none"
    HOME_POSITION = 1, *HOME_BETWEEN_ENDS
    MATERIAL_FACTOR = 2, "material_factor times calibration.factor must be 1e-12 to 1e12", *FACTORS
    MAX_VELOCITY = 3, "axis.max_velocity must be 1e-12 to 1e12", "axis.max_velocity"
    MAX_ACCELERATION = 4, "axis.max_acceleration must be 1e-12 to 1e12", "axis.max_acceleration"
    MAX_DECELERATION = 5, "axis.max_deceleration must be 0, or 1e-12 to 1e12", "axis.max_deceleration"
    MAX_JERK = 6, "axis.max_jerk must be 1e-12 to 1e12", "axis.max_jerk"
    APPROACH_DISTANCE = 7, "approach.distance must be 0 to 1e12", "approach.distance"
    APPROACH_RESERVE = 8, "approach.reserve must be 0 to 1e6", "approach.reserve"
    APPROACH_ACCELERATION = 9, "approach.acceleration must be 0, or 1e-12 to 1e12", "approach.acceleration"
    APPROACH_JERK = 10, "approach.jerk must be 0, or 1e-12 to 1e12", "approach.jerk"
    HOMING_VELOCITY = 11, "homing.velocity must be 0, or 1e-12 to 1e12", "homing.velocity"
    HOMING_ACCELERATION = 12, "homing.acceleration must be 0, or 1e-12 to 1e12", "homing.acceleration"
    HOMING_DECELERATION = 13, "homing.deceleration must be 0, or 1e-12 to 1e12", "homing.deceleration"
    HOMING_JERK = 14, "homing.jerk must be 0, or 1e-12 to 1e12", "homing.jerk"
    HOMING_SETTLE_TIME = 15, "homing.settle_time must be 0 to 1e6 s", "homing.settle_time"
    HOMING_SPARE_TIME = 16, "homing.spare_time must be 0 to 1e6 s", "homing.spare_time"
    HOMING_SLOWEST = 17, "homing.slowest must be above 0 and at most 1", "homing.slowest"
    SETTLE_TIME = 18, "tool.settle_time must be 0 to 1e6 s", "tool.settle_time"
    ON_DELAY = 19, "tool.on_delay must be 0 to 1e6 s", "tool.on_delay"
    CUT_TIME = 20, "tool.cut_time must be 0 to 1e6 s", "tool.cut_time"
    CUT_DISTANCE = 21, "tool.cut_distance must be 0 to 1e12", "tool.cut_distance"
    RETRACT_TIME = 22, "tool.retract_time must be 0 to 1e6 s", "tool.retract_time"
    TIMEOUT = 23, "tool.timeout must be 0 to 1e6 s", "tool.timeout"
    GAP_DISTANCE = 24, "gap.distance must be 0 to 1e12", "gap.distance"
    GAP_TRAVEL = 25, "gap.travel must be 1e-12 to 1e12", "gap.travel"
    MARGIN = 40, "line.margin must be at least 0 and below 1", "line.margin"
    LATE_MODE = 43, "late_mode must be 1, 2 or 3", "late_mode"
