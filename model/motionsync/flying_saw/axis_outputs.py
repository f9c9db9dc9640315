"""Outputs of the axis that follow from its stage and its setpoint: both states, and the limit that is exceeded."""

from ..motion.exceeded_limit import ExceededLimit, Limit
from .interface import FlyingSawInterface, PlcopenState, State
from .stage import Stage


def show_state(block: FlyingSawInterface, stage: Stage, waiting: bool) -> None:
    """Derive nAxisState; `waiting`: a gear_in_pos waits for its start."""
    if waiting or stage == Stage.PARKED:
        block.state = State.PREPHASE
    elif stage == Stage.IN_SYNC:
        block.state = State.SYNCHRON
    elif block.coupled:
        block.state = State.SYNCHRONIZING
    elif not block.slave.is_moving():
        block.state = State.INACTIVE
    elif block.slave.acceleration == 0.0:
        block.state = State.CONSTANT_VELOCITY
    elif block.slave.velocity * block.slave.acceleration < 0.0:
        block.state = State.DECELERATING
    else:
        block.state = State.ACCELERATING
    block.state_code = block.state


def show_plcopen_state(block: FlyingSawInterface, stage: Stage, locked: bool) -> None:
    """Derive the state in PLCopen's diagram; `locked`: stop locks the axis."""
    if block.coupled:
        block.plcopen_state = PlcopenState.SYNCHRONIZED_MOTION
    elif locked:
        block.plcopen_state = PlcopenState.STOPPING
    elif not block.slave.is_moving():
        block.plcopen_state = PlcopenState.STANDSTILL
    elif stage == Stage.CONTINUOUS_MOTION:
        block.plcopen_state = PlcopenState.CONTINUOUS_MOTION
    else:
        block.plcopen_state = PlcopenState.DISCRETE_MOTION


def show_limits(block: FlyingSawInterface, planned: ExceededLimit, present: ExceededLimit) -> None:
    """Show the limit that comes first in `Limit`, of the one that the plan and the one that the setpoint exceeds.

    Where they are the same, the plan's value is shown."""
    if planned.limit == Limit.NONE or (present.limit != Limit.NONE and present.limit < planned.limit):
        block.local.show_exceeded(present)
    else:
        block.local.show_exceeded(planned)
    block.limit_exceeded = block.local.exceeded_limit != Limit.NONE
