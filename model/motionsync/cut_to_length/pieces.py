"""The pieces of the machine: fixed, changed while they are in progress, and recorded."""

from ..cutting.interface import ChangeMode, PieceKind, Source
from ..cutting.material import Material
from ..cutting.piece import UNLIMITED
from ..cutting.records import PieceRecords, increased
from ..master import Master
from .carriage import Carriage, Stage, distance_beyond
from .faults import Fault
from .interface import CutToLengthInterface
from .machine_limits import lead
from .operation import Operation
from .settings import MachineSettings


def fix_piece(operation: Operation, settings: MachineSettings, material: Material) -> None:
    """Fix the piece that starts at the last cut, if the settings are valid."""
    if settings.can_fix(material.settings):
        material.fix_piece()
    else:
        operation.pieces.fault = Fault.TUNABLE


def update_piece(
    block: CutToLengthInterface, operation: Operation, settings: MachineSettings, material: Material, carriage: Carriage
) -> None:
    """Fix a piece that had no length, and one whose length has changed."""
    piece = material.piece
    if not block.running:
        block.warning.change_pending = False
    elif not piece.is_fixed:
        if settings.can_fix(material.settings):
            material.fix_open_piece()
        else:
            operation.pieces.fault = Fault.TUNABLE
    elif block.source == Source.MARK or material.settings.change_mode != ChangeMode.THIS_PIECE:
        block.warning.change_pending = False
    elif piece.kind == PieceKind.PRODUCT:
        has_changed = material.has_changed()
        can_fix = has_changed and settings.can_fix(material.settings)
        can_change = can_fix and can_reach_changed_cut(block.master, material, carriage)
        block.warning.change_pending = has_changed and not can_change
        if can_change:
            material.change_product()


def can_reach_changed_cut(master: Master, material: Material, carriage: Carriage) -> bool:
    """Whether the cut of the product in progress can still be reached if it is fixed anew."""
    length, _ = material.next_product()
    pitch = material.pitch_of(length)
    if pitch == UNLIMITED or carriage.stage in (Stage.APPROACHING, Stage.SYNCHRONOUS, Stage.CUTTING):
        return False
    machine = carriage.machine
    beyond_cut = distance_beyond(master, material.piece.begin + pitch, 0.0)
    return machine.home_position - machine.coupling * beyond_cut >= lead(machine, master.begin_velocity)


def record_piece(
    block: CutToLengthInterface, cut: float, time: float, reserve: float, material: Material, records: PieceRecords
) -> None:
    """Record the piece that ends with a cut at this position, which was in sync at this time of the block, s."""
    records.record(material.piece, material.settings, cut, reserve, block.last, block.statistics)
    block.last.time = time
    block.batch_count = records.batch_count
    block.batches = records.batches
    block.batch_done = records.is_batch_done
    block.warning.change_pending = False
    if block.last.good and material.orders.try_complete(material.piece.order, material.demand.repeat):
        block.order.completed = increased(block.order.completed, 1.0)
    material.end_piece(cut)
