"""What the block puts out besides the setpoint."""

from ..cutting.faults import PieceFault
from ..cutting.interface import PieceKind, Source
from ..cutting.piece import PieceInProgress
from ..input_watch import InputWarning
from ..motion.exceeded_limit import ExceededLimit, Limit
from ..numerics.grid import wrap
from .curves import Peaks
from .cycle import Stage
from .interface import RotaryKnifeInterface, State


def show_state(block: RotaryKnifeInterface, stage: Stage, fault: int, refusal: int) -> None:
    """A fault comes before a refusal."""
    block.error_id = fault if fault != PieceFault.NONE else refusal
    block.error = block.error_id != PieceFault.NONE
    block.state = State.FAULT if fault != PieceFault.NONE else state_of(stage)
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


def show_piece(block: RotaryKnifeInterface, piece: PieceInProgress, before: float, is_entering: bool) -> None:
    """The piece in progress and its cut, whose window begins `before` it, u of the master.

    `is_entering`: the knife is in the first half of that window."""
    master = block.master.end
    block.piece.kind = PieceKind.NONE
    block.piece.ordered = 0.0
    block.piece.length = 0.0
    if block.running:
        block.piece.length = max(piece.length(master), 0.0)
    block.next_cut.known = block.running and piece.is_fixed
    block.next_cut.position = 0.0
    block.next_cut.distance = 0.0
    if block.next_cut.known:
        block.piece.kind = piece.kind
        block.piece.ordered = piece.ordered
        block.next_cut.position = wrap(piece.end, block.master.period)
        if not is_entering:
            block.next_cut.distance = (piece.end - master) - before


def show_peaks(block: RotaryKnifeInterface, peaks: Peaks) -> None:
    """The greatest magnitudes of the present cycle at the present line velocity."""
    speed = abs(block.master.end_velocity)
    block.peaks.velocity = peaks.d1 * speed
    block.peaks.acceleration = peaks.d2 * speed * speed
    block.peaks.jerk = peaks.d3 * speed * speed * speed


def show_warnings(
    block: RotaryKnifeInterface,
    exceeded: ExceededLimit,
    greatest_slope: float,
    is_ramp_too_fast: bool,
    is_change_pending: bool,
) -> None:
    """All warnings but those of marks; `greatest_slope` is that of the window."""
    velocity = block.master.end_velocity
    warning = block.warning
    warning.line_too_fast = velocity > block.limits.max_line_velocity
    warning.orders_too_fast = velocity > block.limits.max_line_velocity_orders
    warning.velocity = greatest_slope * velocity > block.axis.max_velocity
    warning.no_length = block.running and block.source == Source.LENGTH and not block.next_cut.known
    warning.change_pending = is_change_pending
    warning.limit_exceeded = is_ramp_too_fast or exceeded.limit != Limit.NONE
    warning.master_input = block.master.input_warning > InputWarning.COUNTS
    block.local.exceeded_limit = exceeded.limit
    block.local.exceeded_value = exceeded.value
    warning.any = (
        warning.line_too_fast
        or warning.limit_exceeded
        or warning.orders_too_fast
        or warning.velocity
        or warning.mark_missing
        or warning.mark_outside
        or warning.mark_refused
        or warning.no_length
        or warning.change_pending
        or warning.master_input
    )
