"""What the block puts out besides the setpoint."""

from ..cutting.interface import PieceKind, Source
from ..cutting.piece import PieceInProgress
from ..input_watch import InputWarning
from ..motion.exceeded_limit import ExceededLimit, Limit
from ..numerics.grid import wrap
from .carriage import Carriage, Stage
from .faults import Fault
from .interface import CutToLengthInterface, State


def show_state(block: CutToLengthInterface, carriage: Carriage, fault: int, refusal: int) -> None:
    """A fault comes before a refusal."""
    block.error_id = fault if fault != Fault.NONE else refusal
    block.error = block.error_id != Fault.NONE
    block.state = State.FAULT if fault != Fault.NONE else state_of(carriage.stage)
    block.state_code = block.state
    block.in_sync = block.state in (State.SYNCHRONOUS, State.CUTTING) or (
        block.state == State.CLEARING and carriage.curve.has_joined and not carriage.curve.has_gap
    )
    block.tool.cutting = carriage.stage == Stage.CUTTING and fault == Fault.NONE


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


def show_piece(block: CutToLengthInterface, carriage: Carriage, piece: PieceInProgress) -> None:
    """The piece in progress and its cut."""
    is_on_curve = Stage.APPROACHING <= carriage.stage <= Stage.CLEARING
    k = carriage.curve.coupling if is_on_curve else carriage.machine.coupling
    block.local.coupling_factor = k
    block.piece.kind = PieceKind.NONE
    block.piece.ordered = 0.0
    block.piece.length = 0.0
    if block.running:
        block.piece.length = max(piece.length(block.master.end - block.slave.position / k), 0.0)
    block.next_cut.known = block.running and piece.is_fixed
    block.next_cut.position = 0.0
    block.next_cut.distance = 0.0
    block.local.start_position = 0.0
    block.local.progress = 0.0
    if block.next_cut.known:
        block.piece.kind = piece.kind
        block.piece.ordered = piece.ordered
        block.next_cut.position = wrap(piece.end, block.master.period)
        show_approach(block, carriage, piece.end)


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


def show_warnings(
    block: CutToLengthInterface, carriage: Carriage, exceeded: ExceededLimit, before: float, h: float
) -> None:
    """All warnings but those that their events set; the step took h seconds, from the setpoint `before`."""
    velocity = block.master.end_velocity
    machine = carriage.machine
    warning = block.warning
    warning.line_too_fast = velocity > block.limits.max_line_velocity
    warning.orders_too_fast = velocity > block.limits.max_line_velocity_orders
    warning.stroke = machine.home_position + block.limits.stroke > machine.max_position
    warning.velocity = machine.coupling * velocity > machine.max_velocity
    warning.no_length = block.running and block.source == Source.LENGTH and not block.next_cut.known
    if carriage.stage in (Stage.RESTING, Stage.WAITING):
        exceeded.clear()
    else:
        exceeded.check_setpoint(block.axis, block.slave)
        if carriage.stage in (Stage.HOMING, Stage.RETURNING):
            exceeded.include(carriage.homing_start.exceeded)
    exceeded.check_way(block.axis, block.slave, before, 0.0, h, block.master)
    warning.master_input = block.master.input_warning > InputWarning.COUNTS
    warning.limit_exceeded = exceeded.limit != Limit.NONE
    block.local.exceeded_limit = exceeded.limit
    block.local.exceeded_value = exceeded.value
    warning.any = (
        warning.line_too_fast
        or warning.limit_exceeded
        or warning.orders_too_fast
        or warning.stroke
        or warning.velocity
        or warning.blade_early
        or warning.gap_skipped
        or warning.mark_missing
        or warning.mark_outside
        or warning.mark_refused
        or warning.no_length
        or warning.change_pending
        or warning.master_input
    )
