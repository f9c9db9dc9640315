"""The stages of the slave: what drives it, which state is shown meanwhile, and which fault a limit's excess is."""

from ..var import Enumeration
from .faults import Fault
from .interface import State


class Stage(Enumeration):
    """What drives the slave; several stages share one shown state"""

    IDLE = 0, "rest, before any positioning"
    TO_PARK = 1, "a motion in time to the park"
    TO_CYCLE = 2, "a motion in time to where the undisturbed cycle has the slave"
    WAITING = 3, "rest at the park"
    WAITING_NEXT_CYCLE = 4, "rest at the park, after a start that was missed or not carried out"
    FOLLOWING = 5, "a cam section that ends at the meeting"
    SLOWING = 6, "cyclic slave that does not park: the ramp down to an intermediate stop"
    PAUSING = 7, "cyclic slave that does not park: the intermediate stop"
    SYNCHRONIZED = 8, "the line with the ratio k over the master"
    DECEL = 9, "linear slave: the ramp down after the synchronized phase"
    HOLDING = 10, "linear slave: rest at the end of the forward stroke"
    HOMING = 11, "a cam section that ends at the park"
    BRAKING = 12, "an alarm's stop ramp in time, then rest"


def shown_state(stage: Stage) -> State:
    """The state that is shown in a stage."""
    state = State.M_IN_ALARM
    match stage:
        case Stage.IDLE:
            state = State.M_IDLE
        case Stage.TO_PARK | Stage.TO_CYCLE:
            state = State.M_POSITIONING
        case Stage.WAITING:
            state = State.M_WAITING
        case Stage.WAITING_NEXT_CYCLE:
            state = State.M_WAITING_NEXT_CYCLE
        case Stage.FOLLOWING | Stage.SLOWING | Stage.PAUSING:
            state = State.M_FOLLOWING
        case Stage.SYNCHRONIZED:
            state = State.M_SYNCHRONIZED
        case Stage.DECEL | Stage.HOLDING:
            state = State.M_DECEL
        case Stage.HOMING:
            state = State.M_HOMING
        case _:  # BRAKING
            pass
    return state


def limit_faults(stage: Stage) -> tuple[Fault, Fault]:
    """The faults of a slave that exceeds max_speed and max_acceleration in a stage; NONE where it is at rest, and in an
    alarm."""
    match stage:
        case Stage.TO_PARK | Stage.TO_CYCLE:
            return Fault.SPEED_POSITIONING, Fault.ACCELERATION_POSITIONING
        case Stage.FOLLOWING | Stage.SLOWING | Stage.PAUSING:
            return Fault.SPEED_FOLLOWING, Fault.ACCELERATION_FOLLOWING
        case Stage.SYNCHRONIZED:
            return Fault.SPEED_SYNCHRONIZED, Fault.ACCELERATION_SYNCHRONIZED
        case Stage.DECEL | Stage.HOLDING:
            return Fault.SPEED_DECEL, Fault.ACCELERATION_DECEL
        case Stage.HOMING:
            return Fault.SPEED_HOMING, Fault.ACCELERATION_HOMING
        case _:
            return Fault.NONE, Fault.NONE
