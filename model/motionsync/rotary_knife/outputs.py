"""What the block puts out besides the setpoint."""

from ..cutting.faults import PieceFault
from ..cutting.operation import Operation
from ..cutting.outputs import show_error
from .curves import Peaks
from .cycle import Stage
from .interface import RotaryKnifeInterface, State


def show_state(block: RotaryKnifeInterface, stage: Stage, operation: Operation) -> None:
    """A fault comes before a stage."""
    show_error(block, operation)
    block.state = State.FAULT if operation.fault != PieceFault.NONE else state_of(stage)
    block.state_code = block.state
    block.in_sync = block.state == State.SYNCHRONOUS
    block.knife.in_window = block.in_sync


def state_of(stage: Stage) -> State:
    """The state that is shown in a stage, without a fault."""
    state = State.OFF
    match stage:
        case Stage.RESTING:
            pass
        case Stage.PARKING:
            state = State.PARKING
        case Stage.WAITING:
            state = State.WAITING
        case Stage.ENGAGING:
            state = State.ENGAGING
        case Stage.SYNCHRONOUS:
            state = State.SYNCHRONOUS
        case Stage.TURNING:
            state = State.TURNING
        case Stage.DISENGAGING:
            state = State.DISENGAGING
    return state


def show_peaks(block: RotaryKnifeInterface, peaks: Peaks) -> None:
    """The greatest magnitudes of the present cycle at the present line velocity."""
    speed = abs(block.master.end_velocity)
    block.peaks.velocity = peaks.d1 * speed
    block.peaks.acceleration = peaks.d2 * speed * speed
    block.peaks.jerk = peaks.d3 * speed * speed * speed
