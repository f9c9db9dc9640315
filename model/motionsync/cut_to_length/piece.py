"""The piece in progress, with all that it was fixed with."""

from dataclasses import dataclass

from .interface import PieceKind

NO_ORDER = -1
UNLIMITED = 1e300  # u: a pitch that limits nothing
LEAST_MATERIAL = 1e-6  # u: a piece, with its kerf, that is no longer than this has no length


@dataclass(slots=True)
class PieceInProgress:
    """A piece from the cut at `begin` to the cut at `end`, unwrapped positions of the master at which the lines of the
    two cuts pass carriage position 0, u.

    Attributes:
        known: the place of its end is known.
        kind: what it is to become; NONE: nothing is known of it.
        ordered: the length it is to have, u of material.
        exact: there is a length it should have; marks without a known spacing have none.
        pitch: the master's travel from cut to cut as it was fixed, u; UNLIMITED where that is no limit.
        order: the number of the order that it counts for, or NO_ORDER.
        factor, kerf, correction: what the material's travel per master's, the kerf and the length correction were.
    """

    begin: float = 0.0
    end: float = 0.0
    known: bool = False
    kind: PieceKind = PieceKind.NONE
    ordered: float = 0.0
    exact: bool = True
    pitch: float = UNLIMITED
    order: int = NO_ORDER
    factor: float = 1.0
    kerf: float = 0.0
    correction: float = 0.0

    def length(self, end: float) -> float:
        """What it measures if it is cut at a place, u."""
        return self.factor * (end - self.begin) - self.kerf - self.correction

    def material(self, length: float) -> float:
        """The material that a piece of a length takes, its kerf included, u."""
        return length + self.correction + self.kerf

    def can_measure(self, length: float) -> bool:
        """Whether that is a length."""
        return length > 0.0 and self.material(length) > LEAST_MATERIAL

    def waits_for_line(self) -> bool:
        """Whether its cut is made wherever it can be: it is not skipped, but waits for a slower line."""
        return self.kind in (PieceKind.TRIM, PieceKind.SHORT)

    def forget(self) -> None:
        """Nothing is known of it but where it begins."""
        self.known = False
        self.kind = PieceKind.NONE
        self.ordered = 0.0
        self.exact = True
        self.pitch = UNLIMITED
        self.order = NO_ORDER

    def fix(self, kind: PieceKind, length: float, order: int) -> None:
        """Its length is known, and so is the place of its end."""
        self.known = True
        self.kind = kind
        self.ordered = length
        self.exact = True
        self.pitch = self.material(length) / self.factor
        self.order = order
        self.end = self.begin + self.pitch
