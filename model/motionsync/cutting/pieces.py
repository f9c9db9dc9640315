"""The pieces of a machine: whether one in progress has to be changed, and its record when it has been cut."""

from ..master import Master
from .faults import PieceFault
from .interface import ChangeMode, CuttingInterface, Source
from .material import Material
from .operation import Operation
from .records import PieceRecords, increased


def can_change_pieces(material: Material) -> bool:
    """Whether a product in progress takes a new length."""
    return material.demand.source == Source.LENGTH and material.settings.piece.change_mode == ChangeMode.THIS_PIECE


def fix_piece(operation: Operation, material: Material, can_fix: bool, is_open: bool) -> None:
    """Fix the piece that starts at the last cut, if there is a length; `is_open`: there was none so far.

    `can_fix`: all is valid that a piece is fixed with."""
    if not can_fix:
        operation.refusal = PieceFault.TUNABLE
    elif is_open:
        material.fix_open_piece()
    else:
        material.fix_piece()


def record_piece(
    block: CuttingInterface, material: Material, records: PieceRecords, cut: float, time: float, reserve: float
) -> None:
    """Record the piece that ends with a cut at this position, u, which was made at this time of the block, s."""
    records.record(material.piece, material.settings.piece, cut, reserve, block.last, block.statistics)
    block.last.time = time
    block.batch_count = records.batch_count
    block.batches = records.batches
    block.batch_done = records.is_batch_done
    if block.last.good and material.orders.try_complete(material.piece.order, material.demand.repeat):
        block.order.completed = increased(block.order.completed, 1.0)
    material.end_piece(cut)


def try_drop_turns(master: Master, material: Material) -> float:
    """Drop the master's whole turns from its positions and those of the material; by how much these were reduced, u."""
    before = master.end
    if master.period > 0.0:
        master.rebase()
    turns = before - master.end
    if turns != 0.0:
        material.rebase(turns)
    return turns
