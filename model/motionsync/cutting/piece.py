"""The piece in progress, with all that it was fixed with, and what the queues of later pieces have in common."""

from dataclasses import dataclass

from ..numerics.grid import rounding_tolerance
from .interface import PieceKind

NO_ORDER = -1
UNLIMITED = 1e300  # u: a pitch that limits nothing
LEAST_LENGTH = 1e-6  # u: a piece that is no longer than this, or no longer with its kerf, is none
ROUNDED = 4.0  # rounding tolerances that cover the rounding of a piece's length
CAPACITY = 64  # of the queue of orders, and of that of marks
MOST = 2147483647  # the largest number that FMI's Integer has


@dataclass(slots=True)
class PieceInProgress:
    """A piece from the cut at `begin` to the cut at `end`; a cut's position, u, is the unwrapped one of the master at
    which the cut passes slave position 0.

    Attributes:
        is_fixed: the position of its end is determined.
        kind: what it is to become; NONE: this is not determined yet.
        ordered: the length it is to have, u of material.
        has_ordered_length: there is a length it should have; marks without a spacing give none.
        pitch: the master's travel from cut to cut as it was fixed, u; UNLIMITED where that is no limit.
        order: the number of the order that it counts for, or NO_ORDER.
        factor, kerf, correction: what the material's travel per master's, the kerf and the length correction were.
    """

    begin: float = 0.0
    end: float = 0.0
    is_fixed: bool = False
    kind: PieceKind = PieceKind.NONE
    ordered: float = 0.0
    has_ordered_length: bool = True
    pitch: float = UNLIMITED
    order: int = NO_ORDER
    factor: float = 1.0
    kerf: float = 0.0
    correction: float = 0.0

    def length(self, end: float) -> float:
        """The length of the piece if it is cut at this position, u."""
        return self.factor * (end - self.begin) - self.kerf - self.correction

    def leaves_length(self, end: float) -> bool:
        """Whether a cut at this position leaves a piece of some length."""
        return min(self.length(end), self.factor * (end - self.begin)) > LEAST_LENGTH

    def can_have(self, length: float) -> bool:
        """Whether it can have a length, u: one that rounding of the cuts' positions does not hide."""
        material = self.material_of(length)
        least = ROUNDED * self.factor * rounding_tolerance(self.begin, material / self.factor)
        return min(length, material) > max(LEAST_LENGTH, least)

    def least_end(self) -> float:
        """The first position, but for rounding, at which a cut leaves a piece of some length."""
        least = (max(self.kerf + self.correction, 0.0) + LEAST_LENGTH) / self.factor
        return self.begin + (least + ROUNDED * rounding_tolerance(self.begin, least))

    def material_of(self, length: float) -> float:
        """The material that a piece of a length takes, its kerf included, u."""
        return length + self.correction + self.kerf

    def waits_for_line(self) -> bool:
        """Whether its cut is made wherever it can be: it is never skipped, but waits for a slower line."""
        return self.kind in (PieceKind.TRIM, PieceKind.SHORT)

    def reset(self) -> None:
        """Nothing but its beginning is determined."""
        self.is_fixed = False
        self.kind = PieceKind.NONE
        self.ordered = 0.0
        self.has_ordered_length = True
        self.pitch = UNLIMITED
        self.order = NO_ORDER

    def fix(self, kind: PieceKind, length: float, order: int) -> None:
        """Give it a length, and so the position of its end."""
        self.is_fixed = True
        self.kind = kind
        self.ordered = length
        self.has_ordered_length = True
        self.pitch = self.material_of(length) / self.factor
        self.order = order
        self.end = max(self.begin + self.pitch, self.least_end())
