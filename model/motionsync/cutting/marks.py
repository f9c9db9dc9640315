"""The queue of marks on the material: those that a sensor has seen, and whose cuts are still to come."""

from dataclasses import dataclass

from .. import var
from .piece import CAPACITY, MOST, UNLIMITED


@dataclass(slots=True)
class MarkQueue:
    """The positions of cuts, unwrapped positions of the master, u; and the last mark.

    Attributes:
        first, waiting: where the queue starts in the array, and how long it is.
        positions: where each cut passes slave position 0.
        has_last: there has been a mark since the start, at `last`.
        last: the master's position at the last mark, or the position where it was expected.
        missing: marks missing in a row.
        until_cut: marks that pass before the next one that is cut; 0: the next one is.
        has_changed: since the shortest one was last determined.
    """

    first: int = var.count(CAPACITY - 1)
    waiting: int = var.count(CAPACITY)
    positions: list[float] = var.array(CAPACITY)
    has_last: bool = False
    last: float = 0.0
    missing: int = var.count(MOST)
    until_cut: int = 0
    has_changed: bool = True

    def clear(self) -> None:
        self.first = 0
        self.waiting = 0
        self.has_changed = True
        self.has_last = False
        self.missing = 0
        self.until_cut = 0

    def is_full(self) -> bool:
        return self.waiting == CAPACITY

    def position(self, index: int) -> float:
        """The position of the cut with this index in the queue; the next one has index 0."""
        return self.positions[(self.first + index) % CAPACITY]

    def append(self, position: float) -> None:
        """Append a cut to the queue, which is not full."""
        self.positions[(self.first + self.waiting) % CAPACITY] = position
        self.waiting += 1
        self.has_changed = True

    def drop(self) -> None:
        """Take the next cut, of which there is one, out of the queue."""
        self.first = (self.first + 1) % CAPACITY
        self.waiting -= 1
        self.has_changed = True

    def try_select(self, every: int) -> bool:
        """Count a mark, and answer whether it is cut: the first one is, and each `every`-th after it."""
        if self.until_cut > 0:
            self.until_cut -= 1
            return False
        self.until_cut = every - 1
        return True

    def shortest_pitch(self) -> float:
        """The least distance above 0 of two consecutive cuts, u; UNLIMITED without two."""
        shortest = UNLIMITED
        for index in range(1, self.waiting):
            distance = self.position(index) - self.position(index - 1)
            if 0.0 < distance < shortest:
                shortest = distance
        return shortest

    def rebase(self, distance: float) -> None:
        """Reduce all positions by a distance, u: whole turns are dropped."""
        self.last -= distance
        for index in range(self.waiting):
            self.positions[(self.first + index) % CAPACITY] -= distance
