"""Which tunable parameter is out of its range: the text of each.

A parameter may be tuned at any time, and to any value. A bad one changes nothing by itself: no piece is fixed and no
approach begins with it, a cycle under way ends with the values it began with, and a command that reads it is refused.
"""

from ..var import Enumeration


class Tunable(Enumeration):
    """Which tuned parameter is out of its range"""

    NONE = 0, "none"
    HOME_POSITION = (
        1,
        "home_position must lie between the software end positions",
        "home_position",
        "axis.min_position",
        "axis.max_position",
    )
    MATERIAL_FACTOR = (
        2,
        "material_factor times calibration.factor must be 1e-12 to 1e12",
        "material_factor",
        "calibration.factor",
    )
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
    KERF = 26, "kerf must be 0 to 1e12", "kerf"
    LENGTH_TOLERANCE = 27, "length_tolerance must be 0 to 1e12", "length_tolerance"
    FRONT_POSITION = 28, "front_position must be within 1e12", "front_position"
    TRIM_LENGTH = 29, "trim_length must be 0 to 1e12", "trim_length"
    SAMPLE_LENGTH = 30, "sample_length must be 1e-12 to 1e12", "sample_length"
    WASTE_LENGTH = 31, "waste_length must be 1e-12 to 1e12", "waste_length"
    BATCH_SIZE = 32, "batch_size must be at least 0", "batch_size"
    SENSOR_DISTANCE = 33, "mark.sensor_distance must be within 1e12", "mark.sensor_distance"
    CUT_OFFSET = 34, "mark.cut_offset must be within 1e12", "mark.cut_offset"
    SPACING = 35, "mark.spacing must be 0 to 1e12", "mark.spacing"
    WINDOW = (
        36,
        "mark.window must be 0 or more, and less than half of mark.spacing if that is not 0",
        "mark.window",
        "mark.spacing",
    )
    EVERY = 37, "mark.every must be at least 1", "mark.every"
    MAX_MISSING = 38, "mark.max_missing must be at least 0", "mark.max_missing"
    MARK_DELAY = 39, "mark.delay must be 0 to 1e6 s", "mark.delay"
    MARGIN = 40, "line.margin must be at least 0 and below 1", "line.margin"
    START_MODE = 41, "start_mode must be 1, 2 or 3", "start_mode"
    CHANGE_MODE = 42, "change_mode must be 1 or 2", "change_mode"
    LATE_MODE = 43, "late_mode must be 1, 2 or 3", "late_mode"
