"""The tunable parameters that a machine computes with, and which of them is out of its range.

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
