"""What drives the slave of a Gearing, and the state by which that is shown to the outside."""

from ..var import Enumeration
from .interface import State


class Stage(Enumeration):
    """What drives the slave"""

    STOPPED = 0, "nothing: the slave rests"
    FROZEN = 1, "nothing: the slave rests where it was when the block was deactivated"
    WAITING_FOR_START = 2, "nothing: the slave rests until the condition of the engagement is met"
    GEAR_IN_MASTER_BASED = 3, "a curve over the master's position, from rest on to the line"
    GEAR_IN_TIME_BASED = 4, "the line, and a curve in time that takes what the slave lacks to the line to 0"
    ACTIVE = 5, "the line"
    WAITING_FOR_STOP = 6, "the line, until the condition of the disengagement is met"
    GEAR_OUT_MASTER_BASED = 7, "a curve over the master's position, from the line to rest"
    GEAR_OUT_TIME_BASED = 8, "a curve in time, from the slave's motion to rest"


def state_of(stage: Stage, state_when_frozen: State) -> State:
    """The state that is shown in a stage. A FROZEN block goes on showing the state that it had."""
    state = State.STOPPED
    match stage:
        case Stage.STOPPED:
            pass
        case Stage.FROZEN:
            state = state_when_frozen
        case Stage.WAITING_FOR_START:
            state = State.WAITING_FOR_STARTPOSITION
        case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_IN_TIME_BASED:
            state = State.GEAR_IN
        case Stage.ACTIVE:
            state = State.ACTIVE
        case Stage.WAITING_FOR_STOP:
            state = State.WAITING_FOR_STOPPOSITION
        case Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
            state = State.GEAR_OUT
    return state
