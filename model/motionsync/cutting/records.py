"""The production record: what the pieces that were cut are, and their statistics."""

from dataclasses import dataclass
from math import sqrt

from .. import var
from .interface import LastPiece, PieceKind, PieceParameters, Statistics
from .piece import MOST, PieceInProgress


@dataclass(slots=True)
class PieceRecords:
    """What the statistics are computed from, and the batch.

    Attributes:
        products, mean, squares: number of products, mean and sum of squares of their length errors (Welford).
        batch_count: good pieces in the present batch.
        batches: full batches.
        is_batch_done: the last cut has filled a batch.
        cleared: the statistics before the first piece.
    """

    products: float = 0.0
    mean: float = 0.0
    squares: float = 0.0
    batch_count: int = 0
    batches: int = 0
    is_batch_done: bool = False
    cleared: Statistics = var.part(Statistics, hidden=True)

    def clear(self, statistics: Statistics) -> None:
        """Reset the statistics."""
        self.products = 0.0
        self.mean = 0.0
        self.squares = 0.0
        var.copy(statistics, self.cleared)

    def record(
        self,
        piece: PieceInProgress,
        settings: PieceParameters,
        end: float,
        reserve: float,
        last: LastPiece,
        statistics: Statistics,
    ) -> None:
        """Record a piece that was cut at the position `end`, u; `reserve`: the share of its cycle that was left."""
        length = piece.length(end)
        error = length - piece.ordered if piece.has_ordered_length else 0.0
        is_accepted = piece.kind == PieceKind.PRODUCT and abs(error) <= settings.length_tolerance
        last.length = length
        last.error = error
        last.kind = piece.kind
        last.good = is_accepted
        last.reserve = reserve
        self.count(statistics, last)
        self.is_batch_done = False
        if is_accepted and settings.batch_size > 0:
            self.count_for_batch(settings.batch_size)

    def count(self, statistics: Statistics, last: LastPiece) -> None:
        """Add the last piece to the statistics."""
        statistics.cuts = increased(statistics.cuts, 1.0)
        statistics.reserve_worst = min(statistics.reserve_worst, last.reserve)
        if last.good:
            statistics.pieces_good = increased(statistics.pieces_good, 1.0)
            statistics.length_good += last.length
        elif last.kind == PieceKind.SAMPLE:
            statistics.pieces_sample = increased(statistics.pieces_sample, 1.0)
        else:
            statistics.length_waste += last.length
            if last.kind in (PieceKind.WASTE, PieceKind.TRIM):
                statistics.pieces_waste = increased(statistics.pieces_waste, 1.0)
            else:
                statistics.pieces_bad = increased(statistics.pieces_bad, 1.0)
        if last.kind == PieceKind.PRODUCT:
            self.count_error(statistics, last.error)

    def count_error(self, statistics: Statistics, error: float) -> None:
        """Add the length error of a product, u, to the statistics."""
        self.products += 1.0
        before = error - self.mean
        self.mean += before / self.products
        self.squares += before * (error - self.mean)
        statistics.error_mean = self.mean
        statistics.error_worst = max(statistics.error_worst, abs(error))
        if self.products > 1.0:
            statistics.error_deviation = sqrt(max(self.squares / (self.products - 1.0), 0.0))

    def count_for_batch(self, size: int) -> None:
        """Add a good piece to the batch."""
        self.batch_count += 1
        if self.batch_count >= size:
            self.batch_count = 0
            self.batches = increased(self.batches, 1.0)
            self.is_batch_done = True


def increased(count: int, number: float) -> int:
    """A counter increased by a whole number; it stays at the largest number that FMI's Integer has."""
    return int(min(float(count) + number, float(MOST)))
