"""Why a block cannot be initialized or stepped with the values it was given: shared by all blocks."""

from .declare import Choice


class Refusal(Choice):
    """What `initialize` and `step` answer; anything but `NONE` is a failed call that has changed nothing."""

    NONE = 0, "done"
    MASTER_TURNS = (
        1,
        "the master's position and its prediction must be at most 1e15 periods",
        "master.position",
        "master.velocity",
        "master.acceleration",
        "master.period",
    )
    GEARING_DENOMINATOR = 2, "the ratio's denominator must not be 0", "gearing.denominator"
    GEARING_NUMERATOR = 3, "the ratio's numerator must not be 0", "gearing.numerator"
    GEAR_IN_TIME = 4, "a time-based transition must last 1e-9 s to 1e12 s", "gear_in.time"
    GEAR_OUT_TIME = 5, "a time-based transition must last 1e-9 s to 1e12 s", "gear_out.time"
    FOLLOWER_ORDER = (
        6,
        "park_slave < sync_slave < sync_out is required (at least 1e-9 from park to sync), of a cyclic slave also "
        "sync_out < park_slave + slave_cycle",
        "park_slave",
        "sync_slave",
        "sync_out",
        "slave_cycle",
    )
    FOLLOWER_RATIO = 7, "k_slave_master must be 1e-12 to 1e12", "k_slave_master"
    FOLLOWER_ROOM_LINEAR = (
        8,
        "master_cycle must be greater than 2 (sync_slave - park_slave) / k_slave_master + (sync_out - sync_slave) / "
        "k_slave_master + 2 space_stop_slave / k_slave_master + space_wait_in_park",
        "master_cycle",
        "park_slave",
        "sync_slave",
        "sync_out",
        "k_slave_master",
        "space_stop_slave",
        "space_wait_in_park",
    )
    FOLLOWER_ROOM_CYCLIC = (
        9,
        "master_cycle must be greater than (sync_out - sync_slave) / k_slave_master + space_wait_in_park",
        "master_cycle",
        "sync_slave",
        "sync_out",
        "k_slave_master",
        "space_wait_in_park",
    )
    FOLLOWER_CYCLES = (
        10,
        "the master must travel at most 1e6 times master_cycle in a step",
        "master.position",
        "master.velocity",
        "master.acceleration",
        "master_cycle",
    )
    REMOTE_RATIO = (
        11,
        "data_cycle_time must be a whole multiple or a whole part of task_cycle_time, at most 10000",
        "data_cycle_time",
        "task_cycle_time",
    )
    REMOTE_PHASE = (
        12,
        "the PHASE estimator is for equal cycle times: data_cycle_time must be 0 or task_cycle_time",
        "estimator",
        "data_cycle_time",
        "task_cycle_time",
    )
    REMOTE_AGE = (
        13,
        "age_of_data_limit must be 0 or at least data_cycle_time / task_cycle_time: new data come no sooner",
        "age_of_data_limit",
        "data_cycle_time",
        "task_cycle_time",
    )
    REMOTE_STEP = (
        14,
        "max_cycle_index_difference must be 0 or at least task_cycle_time / data_cycle_time: so "
        "far the index steps in each cycle",
        "max_cycle_index_difference",
        "data_cycle_time",
        "task_cycle_time",
    )
    REMOTE_CYCLES = 15, "a step must have at most 1e6 cycles", "task_cycle_time"
