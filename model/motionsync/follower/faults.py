"""Why a Follower refuses a call or a positioning, and why it stops. The source has no numbers: they are our own."""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration

POSITIONS = ("park_slave", "sync_slave", "sync_out", "slave_cycle")
SPACES = ("master_cycle", "k_slave_master", "space_stop_slave", "space_wait_in_park", "sync_master")
SPEED = ("slave.velocity", "max_speed")
ACCELERATION = ("slave.acceleration", "max_acceleration")
MASTER_TRAVEL = ("master.position", "master_cycle")


class Fault(Enumeration):
    """Why a positioning was refused (1) or the slave has stopped (2 to 16)"""

    NONE = 0, "no fault"
    POSITIONING = (
        1,
        "positioning refused: the slave must be at rest (velocity and acceleration 0), park_slave be within 1e12 and "
        "the limits 1e-12 to 1e12, in a variable cycle sync_master be a value not yet used up",
        *("slave.velocity", "slave.acceleration", "park_slave"),
        *("positioning.velocity", "positioning.acceleration", "positioning.jerk", "sync_master"),
    )
    MASTER_MOVED = (
        2,
        "stopped: the master has moved by more than 1e-9 master_cycle during the positioning to the cycle",
        *MASTER_TRAVEL,
    )
    ORDER = (
        3,
        "stopped: park_slave < sync_slave < sync_out (at least 1e-9 from park to sync) is required, of a cyclic "
        "slave sync_out < park_slave + slave_cycle too; space_stop_slave >= 1e-9, space_wait_in_park >= 0; all at "
        "most 1e12",
        *(*POSITIONS, "space_stop_slave", "space_wait_in_park"),
    )
    RATIO = 4, "stopped: k_slave_master must be 1e-12 to 1e12", "k_slave_master"
    CYCLE_TOO_SHORT = (
        5,
        "stopped: the master's travel up to the next meeting is too short for the slave's cycle",
        *(*POSITIONS, *SPACES),
    )
    SPEED_FOLLOWING = 6, "stopped: max_speed exceeded in M_FOLLOWING", *SPEED
    SPEED_SYNCHRONIZED = 7, "stopped: max_speed exceeded in M_SYNCHRONIZED", *SPEED
    SPEED_DECEL = 8, "stopped: max_speed exceeded in M_DECEL", *SPEED
    SPEED_HOMING = 9, "stopped: max_speed exceeded in M_HOMING", *SPEED
    ACCELERATION_FOLLOWING = 10, "stopped: max_acceleration exceeded in M_FOLLOWING", *ACCELERATION
    ACCELERATION_SYNCHRONIZED = 11, "stopped: max_acceleration exceeded in M_SYNCHRONIZED", *ACCELERATION
    ACCELERATION_DECEL = 12, "stopped: max_acceleration exceeded in M_DECEL", *ACCELERATION
    ACCELERATION_HOMING = 13, "stopped: max_acceleration exceeded in M_HOMING", *ACCELERATION
    MASTER_BACKWARDS = (
        14,
        "stopped: the master has moved backwards by more than 1e-9 master_cycle since the slave left its park",
        *MASTER_TRAVEL,
    )
    SPEED_POSITIONING = 15, "stopped: max_speed exceeded in M_POSITIONING", *SPEED
    ACCELERATION_POSITIONING = 16, "stopped: max_acceleration exceeded in M_POSITIONING", *ACCELERATION


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    ORDER = (
        2,
        "park_slave < sync_slave < sync_out is required (at least 1e-9 from park to sync), of a cyclic slave also "
        "sync_out < park_slave + slave_cycle",
        *POSITIONS,
    )
    RATIO = 3, "k_slave_master must be 1e-12 to 1e12", "k_slave_master"
    CYCLE_TOO_SHORT_LINEAR = (
        4,
        "master_cycle must be greater than 2 (sync_slave - park_slave) / k_slave_master + (sync_out - sync_slave) / "
        "k_slave_master + 2 space_stop_slave / k_slave_master + space_wait_in_park",
        *("master_cycle", "park_slave", "sync_slave", "sync_out"),
        *("k_slave_master", "space_stop_slave", "space_wait_in_park"),
    )
    CYCLE_TOO_SHORT_CYCLIC = (
        5,
        "master_cycle must be greater than (sync_out - sync_slave) / k_slave_master + space_wait_in_park",
        *("master_cycle", "sync_slave", "sync_out", "k_slave_master", "space_wait_in_park"),
    )
    CYCLES = (
        6,
        "the master must travel at most 1e6 times master_cycle in a step",
        *("master.position", "master.velocity", "master.acceleration", "master_cycle"),
    )
