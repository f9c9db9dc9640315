"""What drives the slave."""

from ..var import Enumeration


class Stage(Enumeration):
    """What drives the slave"""

    CONTINUOUS_MOTION = 0, "a motion of its own that goes on for ever"
    DISCRETE_MOTION = 1, "a motion of its own that ends at rest"
    UNCOUPLED_HALT = 2, "the halt of PARKED, which goes on although the coupling has ended"
    PROFILE = 3, "a profile over the master's position"
    TIME_BASED = 4, "a motion in time towards the master's velocity"
    IN_SYNC = 5, "the synchronous line over the master's position"
    PARKED = 6, "a halt in time, then rest, until the master passes the coupling position forwards"
