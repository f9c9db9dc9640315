"""The pieces of a machine: whether one in progress has to be changed, and its record when it has been cut."""

from .interface import ChangeMode, LastPiece, Order, Source, Statistics
from .material import Material
from .records import PieceRecords, increased


def can_change_pieces(material: Material) -> bool:
    """Whether a product in progress takes a new length."""
    return material.demand.source == Source.LENGTH and material.settings.change_mode == ChangeMode.THIS_PIECE


def record_piece(
    cut: float,
    time: float,
    reserve: float,
    material: Material,
    records: PieceRecords,
    last: LastPiece,
    statistics: Statistics,
    order: Order,
) -> None:
    """Record the piece that ends with a cut at this position, u, which was made at this time of the block, s."""
    records.record(material.piece, material.settings, cut, reserve, last, statistics)
    last.time = time
    if last.good and material.orders.try_complete(material.piece.order, material.demand.repeat):
        order.completed = increased(order.completed, 1.0)
    material.end_piece(cut)
