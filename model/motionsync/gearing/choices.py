"""What can be chosen of the gearing, and what it tells: its enumerations. Source: MOVIKIT gearing."""

from ..var import Enumeration


class State(Enumeration):
    """What the slave does (eGearingState)"""

    STOPPED = 0, "it rests"
    WAITING_FOR_STARTPOSITION = 1, "it rests until the condition of the engagement is met"
    GEAR_IN = 2, "it is on its way to the line"
    ACTIVE = 3, "it is on the line: in gear"
    WAITING_FOR_STOPPOSITION = 4, "it is on the line until the condition of the disengagement is met"
    GEAR_OUT = 5, "it is on its way to rest"


class StartMode(Enumeration):
    """Through which point the line runs, and in which direction the master has to travel; the numbers are our own"""

    CW_DIRECT = 1, "through both axes' positions as soon as the master travels clockwise (upwards)"
    CCW_DIRECT = 2, "through both axes' positions as soon as the master travels counter-clockwise (downwards)"
    CW_CCW_DIRECT = 3, "through both axes' positions at once"
    WITH_CW_REFERENCE_POSITION = 4, "through the reference position, passed clockwise"
    WITH_CCW_REFERENCE_POSITION = 5, "through the reference position, passed counter-clockwise"
    WITH_CW_CCW_REFERENCE_POSITION = 6, "through the reference position, passed either way"
    CONTINUE_SYNCHRONIZED = 7, "through the last synchronous point, either way"


class StopMode(Enumeration):
    """Where the slave comes to rest, and in which direction the master has to travel; the numbers are our own"""

    CW_DIRECT = 1, "anywhere, as soon as the master travels clockwise (upwards)"
    CCW_DIRECT = 2, "anywhere, as soon as the master travels counter-clockwise (downwards)"
    CW_CCW_DIRECT = 3, "anywhere, at once"
    WITH_CW_STOP_POSITION = 4, "at the stop position, the master travelling clockwise"
    WITH_CCW_STOP_POSITION = 5, "at the stop position, the master travelling counter-clockwise"
    WITH_CW_CCW_STOP_POSITION = 6, "at the stop position, either way"


class Transition(Enumeration):
    """How the slave changes between rest and the line"""

    NONE = 1, "at once: its velocity jumps"
    MASTER_BASED = 2, "along a curve over the master's position"
    TIME_BASED = 3, "along a curve in time"


class Aim(Enumeration):
    """What a manoeuvre goes by"""

    DIRECT = 1, "where both axes are when its condition is met"
    POSITION = 2, "a position that was given with the command"
    SYNCHRONOUS_POINT = 3, "the last synchronous point"
