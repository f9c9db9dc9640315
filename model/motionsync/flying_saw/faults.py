"""Why a command of the flying saw is refused: TwinCAT's error codes.

Source: TS5055, section 13, and TwinCAT's NC errors.
"""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration

RATIO = (".ratio_numerator", ".ratio_denominator")
LIMITS = (".velocity", ".acceleration", ".deceleration", ".jerk")
AXIS_LIMITS = ("axis.max_velocity", "axis.max_acceleration", "axis.max_deceleration", "axis.max_jerk")
END_POSITIONS = ("axis.min_position", "axis.max_position")
MASTER = ("master.position", "master.velocity")
SLAVE = ("slave.position", "slave.velocity")
LOWEST = ("local.plan_position_min",)
TOO_LOW = (".position", "local.plan_position_min", "axis.min_position")
HIGHEST = ("local.plan_position_max",)
TOO_HIGH = (".position", "local.plan_position_max", "axis.max_position")
SLOWEST = ("local.plan_velocity_min", ".velocity", "axis.max_velocity")
FASTEST = ("local.plan_velocity_max", ".velocity", "axis.max_velocity")
PLAN_ACCELERATION = ("local.plan_acceleration", ".acceleration", "axis.max_acceleration")
PLAN_DECELERATION = ("local.plan_deceleration", ".deceleration", "axis.max_deceleration")
SPEEDS = ("local.plan_velocity_min", "local.plan_velocity_max")
SYNC_POSITIONS = (".master_sync_position", ".slave_sync_position", ".master_start_distance")


class Fault(Enumeration):
    """Why a command was refused; the numbers are TwinCAT's"""

    NONE = 0, "no fault"
    SLAVE_MOVING = (
        0x424A,
        "refused (0x424A): the master is at rest while the slave moves, so their velocities can only meet at "
        "standstill: stop the slave or start the master first",
        *MASTER,
        *SLAVE,
    )
    FACTOR = (
        0x425B,
        "refused (0x425B): the ratio's numerator must be 1e-12 to 1e12 or -1e12 to -1e-12, its denominator at least 1; "
        "an unwired input gives 0",
        *RATIO,
    )
    MASTER_STANDING = 0x426E, "refused (0x426E): the master is at rest and never reaches a sync position", *MASTER
    TIME_BASED = 0x4289, "refused (0x4289): sync_mode.time_based is for gear_in_velo only", "sync_mode.time_based"
    LIMIT = (
        0x42DD,
        "refused (0x42DD): limits must be 1e-12 to 1e12 (0 takes the axis's limit), end positions finite, and the "
        "velocity to be reached within its limit",
        *LIMITS,
        *AXIS_LIMITS,
        *END_POSITIONS,
        *MASTER,
    )
    NOT_AHEAD = (
        0x42DE,
        "refused (0x42DE): both sync positions must be ahead in the direction of travel, the start distance be >= 0",
        *SYNC_POSITIONS,
        *MASTER,
        *SLAVE,
    )
    CHECK = (
        0x42DF,
        "refused (0x42DF): an active check of sync_mode is broken (sync_mode.detailed_error_codes shows which)",
    )
    LOCKED = (
        0x42EF,
        "refused (0x42EF): stop locks the axis until it is at rest and stop.execute is false",
        "stop.execute",
        *SLAVE,
    )
    MIN_POSITION = 0x4372, "refused (0x4372): below the software end position", *TOO_LOW
    MAX_POSITION = 0x4373, "refused (0x4373): above the software end position", *TOO_HIGH
    UNDERSHOOT_POSITION_FALLING = 0x4376, "refused (0x4376): below the sync position (sync below start)", *LOWEST
    UNDERSHOOT_POSITION_RISING = 0x4377, "refused (0x4377): below the start (sync above start)", *LOWEST
    OVERSHOOT_POSITION_FALLING = 0x4378, "refused (0x4378): beyond the start (sync below start)", *HIGHEST
    OVERSHOOT_POSITION_RISING = 0x4379, "refused (0x4379): beyond the sync position (sync above start)", *HIGHEST
    VELOCITY_ABOVE = 0x437A, "refused (0x437A): velocity above its limit", *FASTEST
    VELOCITY_BELOW = 0x437B, "refused (0x437B): velocity below minus its limit", *SLOWEST
    OVERSHOOT_VELOCITY_RISING = 0x437C, "refused (0x437C): velocity beyond both ends (positive, rising)", *SPEEDS
    OVERSHOOT_VELOCITY_FALLING = 0x437D, "refused (0x437D): velocity beyond both ends (positive, falling)", *SPEEDS
    OVERSHOOT_VELOCITY_RISING_BACK = 0x437E, "refused (0x437E): speed beyond both ends (negative, rising)", *SPEEDS
    OVERSHOOT_VELOCITY_FALLING_BACK = 0x437F, "refused (0x437F): speed beyond both ends (negative, falling)", *SPEEDS
    UNDERSHOOT_VELOCITY_FALLING = 0x4380, "refused (0x4380): velocity short of both ends (positive, falling)", *SPEEDS
    UNDERSHOOT_VELOCITY_RISING = 0x4381, "refused (0x4381): velocity short of both ends (positive, rising)", *SPEEDS
    UNDERSHOOT_VELOCITY_FALLING_BACK = 0x4382, "refused (0x4382): speed short of both ends (negative, falling)", *SPEEDS
    UNDERSHOOT_VELOCITY_RISING_BACK = 0x4383, "refused (0x4383): speed short of both ends (negative, rising)", *SPEEDS
    ABOVE_ZERO = 0x4384, "refused (0x4384): velocity above zero (rising master)", *SPEEDS
    ABOVE_ZERO_BACK = 0x4385, "refused (0x4385): velocity above zero (falling master)", *SPEEDS
    BELOW_ZERO = 0x4386, "refused (0x4386): velocity against the synchronous one (rising master)", *SPEEDS
    BELOW_ZERO_BACK = 0x4387, "refused (0x4387): velocity against the synchronous one (falling master)", *SPEEDS
    ACCELERATION = 0x4388, "refused (0x4388): acceleration beyond its limit", *PLAN_ACCELERATION
    DECELERATION = 0x4389, "refused (0x4389): deceleration beyond its limit", *PLAN_DECELERATION
    JERK_ABOVE = 0x438A, "refused (0x438A): jerk above its limit", "local.plan_jerk_max", ".jerk", "axis.max_jerk"
    JERK_BELOW = 0x438B, "refused (0x438B): jerk below minus its limit", "local.plan_jerk_min", ".jerk", "axis.max_jerk"


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    END_POSITIONS = 2, "the lower software end position must not be above the upper one", *END_POSITIONS
