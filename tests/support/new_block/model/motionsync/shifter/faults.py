"""Why the Shifter refuses a command, and why a call fails."""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration


class Fault(Enumeration):
    """Why a command was refused"""

    NONE = 0, "no fault"
    OFFSET = (
        1,
        "command refused: offset must be least_offset to greatest_offset",
        "offset",
        "least_offset",
        "greatest_offset",
    )


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
    RANGE = 2, "least_offset must not be greater than greatest_offset", "least_offset", "greatest_offset"
