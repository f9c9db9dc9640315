"""What a machine that cuts to length puts out besides its setpoint."""

from ..input_watch import InputWarning
from ..master import Master
from ..motion.exceeded_limit import ExceededLimit, Limit
from ..numerics.grid import wrap
from .faults import MarkRefusal, NoLength, PieceFault
from .interface import CuttingInterface, CuttingLimits, CuttingLocal, CuttingWarnings, PieceKind, Source
from .material import Material
from .operation import Operation


def show_error(block: CuttingInterface, operation: Operation) -> None:
    """A fault comes before a refusal."""
    block.error_id = operation.fault if operation.fault != PieceFault.NONE else operation.refusal
    block.error = block.error_id != PieceFault.NONE


def show_piece(block: CuttingInterface, material: Material, tool: float) -> None:
    """The piece in progress and its cut; the tool is where the master is at `tool`, u."""
    piece = material.piece
    block.piece.length = max(piece.length(tool), 0.0) if block.running else 0.0
    block.next_cut.known = block.running and piece.is_fixed
    block.piece.kind = piece.kind if block.next_cut.known else PieceKind.NONE
    block.piece.ordered = piece.ordered if block.next_cut.known else 0.0
    block.next_cut.position = wrap(piece.end, block.master.period) if block.next_cut.known else 0.0
    block.next_cut.distance = 0.0


def show_line_request(block: CuttingInterface, limits: CuttingLimits, operation: Operation, margin: float) -> None:
    """What the machine asks of the line."""
    block.line.stop_request = operation.fault != PieceFault.NONE
    block.line.velocity_request = 0.0
    if operation.fault == PieceFault.NONE:
        block.line.velocity_request = min(block.line.wanted_velocity, (1.0 - margin) * limits.max_line_velocity)


def show_queues(block: CuttingInterface, local: CuttingLocal, material: Material, missing: NoLength) -> None:
    """The orders and marks that wait; `missing`: why the next piece has no length."""
    orders = material.orders
    block.order.waiting = orders.waiting
    block.order.remaining = int(orders.remaining_pieces())
    block.order.length_active = orders.length(0) if orders.waiting > 0 else 0.0
    local.marks_waiting = material.marks.waiting
    local.no_length = missing


def show_marks(block: CuttingInterface, warning: CuttingWarnings, local: CuttingLocal, material: Material) -> None:
    """What the sensor of marks has seen, where marks decide."""
    if not (block.running and block.source == Source.MARK):
        return
    warning.mark_missing = material.is_mark_missing
    warning.mark_outside = material.is_mark_outside
    warning.mark_refused = material.is_mark_refused
    local.mark_refusal = material.mark_refusal
    if material.mark_refusal != MarkRefusal.NONE:
        local.refused_mark = wrap(material.refused_mark, block.master.period)


def show_skipped_cut(local: CuttingLocal, reason: int, master: Master, cut: float, missing_distance: float) -> None:
    """The next cut, at this position of the master, is skipped now."""
    local.skip_reason = reason
    local.skipped_cut = wrap(cut, master.period)
    local.missing_distance = missing_distance
    local.line_velocity = master.present_velocity()


def show_warnings(
    block: CuttingInterface,
    limits: CuttingLimits,
    warning: CuttingWarnings,
    local: CuttingLocal,
    exceeded: ExceededLimit,
) -> None:
    """What all machines warn of; those of the velocity, of marks and of changes are set before."""
    velocity = block.master.end_velocity
    warning.line_too_fast = velocity > limits.max_line_velocity
    warning.orders_too_fast = velocity > limits.max_line_velocity_orders
    warning.no_length = block.running and block.source == Source.LENGTH and not block.next_cut.known
    warning.limit_exceeded = exceeded.limit != Limit.NONE
    warning.master_input = block.master.input_warning > InputWarning.COUNTS
    local.exceeded_limit = exceeded.limit
    local.exceeded_value = exceeded.value
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
