"""What drives the carriage, and what is shown of it."""

from ..var import Enumeration
from .interface import State


class Stage(Enumeration):
    """What drives the carriage"""

    RESTING = 0, "nothing: it rests, and the machine does not run"
    HOMING = 1, "its motion home after start"
    WAITING = 2, "nothing: it rests at home until the start point"
    APPROACHING = 3, "the curve into sync"
    SYNCHRONOUS = 4, "the line of the cut, before the blade cuts"
    CUTTING = 5, "the line of the cut"
    PULLING = 6, "the curve that gets ahead of the line"
    CLEARING = 7, "the curve or line on which it was, until the blade is clear"
    RETURNING = 8, "its motion home"


def state_of(stage: Stage) -> State:
    """The state that is shown in a stage, without a fault."""
    state = State.OFF
    match stage:
        case Stage.RESTING:
            pass
        case Stage.HOMING:
            state = State.HOMING
        case Stage.WAITING:
            state = State.WAITING
        case Stage.APPROACHING:
            state = State.APPROACHING
        case Stage.SYNCHRONOUS:
            state = State.SYNCHRONOUS
        case Stage.CUTTING:
            state = State.CUTTING
        case Stage.PULLING:
            state = State.PULLING
        case Stage.CLEARING:
            state = State.CLEARING
        case Stage.RETURNING:
            state = State.RETURNING
    return state
