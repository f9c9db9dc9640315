"""What the block puts out besides the setpoint."""

from ..cutting.material import Material
from ..cutting.operation import Operation
from ..cutting.outputs import show_error, show_piece, show_warnings
from ..motion.exceeded_limit import ExceededLimit
from ..numerics.grid import wrap
from .carriage import Carriage, Stage
from .faults import Fault
from .interface import CutToLengthInterface, State


def show_state(block: CutToLengthInterface, carriage: Carriage, operation: Operation) -> None:
    """A fault comes before a stage."""
    show_error(block, operation)
    block.state = State.FAULT if operation.fault != Fault.NONE else state_of(carriage.stage)
    block.state_code = block.state
    block.in_sync = block.state in (State.SYNCHRONOUS, State.CUTTING) or (
        block.state == State.CLEARING and carriage.curve.has_joined and not carriage.curve.has_gap
    )
    block.tool.cutting = carriage.stage == Stage.CUTTING and operation.fault == Fault.NONE


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


def show_cut(block: CutToLengthInterface, carriage: Carriage, material: Material) -> None:
    """The piece in progress and its cut."""
    is_on_curve = Stage.APPROACHING <= carriage.stage <= Stage.CLEARING
    k = carriage.curve.coupling if is_on_curve else carriage.machine.coupling
    block.local.coupling_factor = k
    show_piece(block, material, block.master.end - block.slave.position / k)
    block.local.start_position = 0.0
    block.local.progress = 0.0
    if block.next_cut.known:
        show_approach(block, carriage, material.piece.end)


def show_approach(block: CutToLengthInterface, carriage: Carriage, cut: float) -> None:
    """How far the approach to the next cut is ahead, or which share of it is done."""
    beyond_cut = block.master.end - cut
    k = carriage.machine.coupling
    home = carriage.machine.home_position
    distance = block.local.approach_distance
    block.local.start_position = wrap(cut + (home - distance) / k, block.master.period)
    match carriage.stage:
        case Stage.APPROACHING:
            block.next_cut.distance = max(carriage.curve.sync - beyond_cut, 0.0)
            block.local.progress = carriage.curve.progress(beyond_cut)
        case Stage.SYNCHRONOUS | Stage.CUTTING:
            block.local.progress = 1.0
        case _:
            block.next_cut.distance = (home + distance) / k - beyond_cut


def show_saw_warnings(
    block: CutToLengthInterface, carriage: Carriage, exceeded: ExceededLimit, before: float, h: float
) -> None:
    """All warnings but those that their events set; the step took h seconds, from the setpoint `before`."""
    machine = carriage.machine
    warning = block.warning
    if carriage.stage in (Stage.RESTING, Stage.WAITING):
        exceeded.clear()
    else:
        exceeded.check_setpoint(block.axis, block.slave)
        if carriage.stage in (Stage.HOMING, Stage.RETURNING):
            exceeded.include(carriage.homing_start.exceeded)
    exceeded.check_way(block.axis, block.slave, before, 0.0, h, block.master)
    warning.stroke = machine.home_position + block.limits.stroke > machine.max_position
    warning.velocity = machine.coupling * block.master.end_velocity > machine.max_velocity
    show_warnings(block, block.limits, warning, block.local, exceeded)
    warning.any = warning.any or warning.stroke or warning.blade_early or warning.gap_skipped
