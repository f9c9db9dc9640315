"""The books of the machine: what the pieces that were cut are, and what they sum up to."""

from dataclasses import dataclass
from math import sqrt

from .interface import PieceKind, Statistics

MOST = 2147483647  # FMI's Integer goes no further


@dataclass(slots=True)
class Books:
    """What the statistics are computed from: products so far, mean and sum of squares of their errors (Welford)."""

    products: float = 0.0
    mean: float = 0.0
    squares: float = 0.0

    def clear(self, statistics: Statistics) -> None:
        """Begin anew."""
        self.products = 0.0
        self.mean = 0.0
        self.squares = 0.0
        statistics.cuts = 0
        statistics.pieces_good = 0
        statistics.pieces_bad = 0
        statistics.pieces_sample = 0
        statistics.pieces_waste = 0
        statistics.skipped = 0
        statistics.late = 0
        statistics.marks = 0
        statistics.marks_missing = 0
        statistics.marks_outside = 0
        statistics.unsynchronised = 0
        statistics.length_good = 0.0
        statistics.length_waste = 0.0
        statistics.error_worst = 0.0
        statistics.error_mean = 0.0
        statistics.error_deviation = 0.0
        statistics.reserve_worst = 1.0

    def enter(
        self, statistics: Statistics, kind: PieceKind, good: bool, length: float, error: float, reserve: float
    ) -> None:
        """A piece has been cut: its length, its error, u, and the reserve of its cycle."""
        statistics.cuts += 1
        statistics.reserve_worst = min(statistics.reserve_worst, reserve)
        if good:
            statistics.pieces_good += 1
            statistics.length_good += length
        elif kind == PieceKind.SAMPLE:
            statistics.pieces_sample += 1
        else:
            statistics.length_waste += length
            if kind in (PieceKind.WASTE, PieceKind.TRIM):
                statistics.pieces_waste += 1
            else:
                statistics.pieces_bad += 1
        if kind == PieceKind.PRODUCT:
            self.enter_error(statistics, error)

    def enter_error(self, statistics: Statistics, error: float) -> None:
        """The length error of a product, u."""
        self.products += 1.0
        before = error - self.mean
        self.mean += before / self.products
        self.squares += before * (error - self.mean)
        statistics.error_mean = self.mean
        statistics.error_worst = max(statistics.error_worst, abs(error))
        if self.products > 1.0:
            statistics.error_deviation = sqrt(max(self.squares / (self.products - 1.0), 0.0))


def more(count: int, by: float) -> int:
    """A counter that has grown by a whole number; it stays at the largest number that FMI's Integer has."""
    return int(min(float(count) + by, float(MOST)))
