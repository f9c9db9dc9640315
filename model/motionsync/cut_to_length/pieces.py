"""The pieces of the machine: fixed, and changed while they are in progress."""

from ..cutting.interface import PieceKind
from ..cutting.material import Material
from ..cutting.operation import Operation
from ..cutting.piece import UNLIMITED
from ..cutting.pieces import can_change_pieces, fix_piece
from ..master import Master
from .carriage import Carriage, Stage
from .interface import CutToLengthInterface
from .machine_limits import lead


def update_piece(block: CutToLengthInterface, operation: Operation, material: Material, carriage: Carriage) -> None:
    """Fix a piece that had no length, and one whose length has changed."""
    piece = material.piece
    if not block.running:
        block.warning.change_pending = False
    elif not piece.is_fixed:
        fix_piece(operation, material, material.settings.has_piece(block), True)
    elif not can_change_pieces(material):
        block.warning.change_pending = False
    elif piece.kind == PieceKind.PRODUCT:
        has_changed = material.has_changed()
        can_fix = has_changed and material.settings.has_piece(block)
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
    beyond_cut = master.distance_beyond(material.piece.begin + pitch, 0.0)
    return machine.home_position - machine.coupling * beyond_cut >= lead(machine, master.begin_velocity)
