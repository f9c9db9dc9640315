"""Why the remote synchronisation falls back. Source: TwinCAT TS5066, error codes; 0x4B56 covers all bad tunables."""

from ..declare import Choice


class Fault(Choice):
    """Why the values are not synchronised"""

    NONE = 0, "no fault"
    INDEX_STEP = (
        0x4B51,
        "the cycle index has stepped by more than max_cycle_index_difference",
        *("cycle_index_difference", "max_cycle_index_difference", "remote.cycle_index"),
    )
    AGE_OF_DATA = (
        0x4B52,
        "the cycle index has stood still for more than age_of_data_limit cycles",
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
