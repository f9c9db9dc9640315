"""Why a command of the gearing is refused, or a change of its ratio. The numbers are our own."""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration


class Fault(Enumeration):
    """Why a command was refused"""

    NONE = 0, "no fault"
    DENOMINATOR = 1, "refused: gearing.denominator = 0 is not allowed: an unwired input gives 0"
    NUMERATOR = 2, "refused: gearing.numerator = 0 is not allowed: an unwired input gives 0"
    TIME = (
        3,
        "refused: the time of a time-based transition must be 1e-9 to 1e12",
        *("gear_in.transition", "gear_in.time", "gear_out.transition", "gear_out.time"),
    )
    DISTANCE = (
        4,
        "refused: a transition's distance must be 0, or 1e-9 to 1e12",
        *("gear_in.distance", "gear_out.distance"),
    )
    CHOICE = (
        5,
        "refused: a mode or a transition is none of the listed ones",
        *("gear_in.start_mode", "gear_in.transition", "gear_out.stop_mode", "gear_out.transition"),
    )


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    DENOMINATOR = 2, "gearing.denominator = 0 is not allowed: an unwired input gives 0"
    NUMERATOR = 3, "gearing.numerator = 0 is not allowed: an unwired input gives 0"
    GEAR_IN_TIME = 4, "a time-based transition must last 1e-9 s to 1e12 s", "gear_in.time"
    GEAR_OUT_TIME = 5, "a time-based transition must last 1e-9 s to 1e12 s", "gear_out.time"
