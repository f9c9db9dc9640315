"""Why the remote synchronisation falls back. Source: TwinCAT TS5066, error codes; 0x4B56 is for all tunables."""

from ..var import Enumeration

CYCLE_TIMES = ("data_cycle_time", "task_cycle_time")


class Fault(Enumeration):
    """Why the values are not synchronised"""

    NONE = 0, "no fault"
    INDEX_STEP = (
        0x4B51,
        "the cycle index has stepped by more than max_cycle_index_difference",
        *("cycle_index_difference", "max_cycle_index_difference", "remote.cycle_index"),
    )
    AGE_OF_DATA = (
        0x4B52,
        "the cycle index has not changed for more than age_of_data_limit cycles",
        *("equal_data_consecutive", "age_of_data_limit", "remote.cycle_index"),
    )
    INDEX_CORRECTION = (
        0x4B53,
        "the corrected cycle index is more than max_cycle_index_difference + 2 away from the received one",
        *("max_cycle_index_difference", "remote.cycle_index"),
    )
    TUNABLE = (
        0x4B56,
        "delay_time_offset must be within 1e6 s, max_position_difference 0 to 1e12",
        *("delay_time_offset", "max_position_difference"),
    )
    POSITION_DIFFERENCE = (
        0x4B59,
        "the correction would shift the position by more than max_position_difference",
        *("max_position_difference", "remote.position", "remote.velocity", "remote.acceleration"),
    )


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    RATIO = (
        1,
        "data_cycle_time must be a whole multiple or a whole part of task_cycle_time, at most 10000",
        *CYCLE_TIMES,
    )
    PHASE = (
        2,
        "the PHASE estimator is for equal cycle times: data_cycle_time must be 0 or task_cycle_time",
        *("estimator", *CYCLE_TIMES),
    )
    AGE = (
        3,
        "age_of_data_limit must be 0 or at least data_cycle_time / task_cycle_time: new data come no sooner",
        *("age_of_data_limit", *CYCLE_TIMES),
    )
    STEP = (
        4,
        "max_cycle_index_difference must be 0 or at least task_cycle_time / data_cycle_time: so "
        "far the index steps in each cycle",
        *("max_cycle_index_difference", *CYCLE_TIMES),
    )
    CYCLES = 5, "a step must have at most 1e6 cycles", "task_cycle_time"
