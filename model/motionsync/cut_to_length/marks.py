"""The marks on the material that a sensor has seen, and whose cuts are still to come."""

from dataclasses import dataclass

from .. import var
from .piece import UNLIMITED

CAPACITY = 64
MOST_MISSING = 2147483647  # the largest that an Integer holds


@dataclass(slots=True)
class Marks:
    """A queue of at most 64 places of cuts, unwrapped positions of the master, u; and the last mark.

    Attributes:
        first, waiting: where the queue begins in the ring, and how long it is.
        places: where the line of each cut passes carriage position 0.
        known: there has been a mark since the start, at `last`.
        last: the master's position at the last mark, or at the place where it was expected.
        missing: marks missing in a row.
        until_cut: marks that pass before the next one that is cut; 0: the next one is.
    """

    first: int = var.count(CAPACITY - 1)
    waiting: int = var.count(CAPACITY)
    places: list[float] = var.ring(64)
    known: bool = False
    last: float = 0.0
    missing: int = var.count(MOST_MISSING)
    until_cut: int = 0

    def forget(self) -> None:
        self.first = 0
        self.waiting = 0
        self.known = False
        self.missing = 0
        self.until_cut = 0

    def is_full(self) -> bool:
        return self.waiting == CAPACITY

    def place(self, index: int) -> float:
        """The place of a cut; 0 is the next one."""
        return self.places[(self.first + index) % CAPACITY]

    def append(self, place: float) -> None:
        """The queue is not full."""
        self.places[(self.first + self.waiting) % CAPACITY] = place
        self.waiting += 1

    def drop(self) -> None:
        """Take the next cut, of which there is one, out of the queue."""
        self.first = (self.first + 1) % CAPACITY
        self.waiting -= 1

    def try_take(self, every: int) -> bool:
        """Count a mark; whether it is one of those that are cut, the first one and each `every`-th after it."""
        if self.until_cut > 0:
            self.until_cut -= 1
            return False
        self.until_cut = every - 1
        return True

    def shortest(self) -> float:
        """The least distance above 0 of two cuts that follow one another, u; UNLIMITED without two."""
        least = UNLIMITED
        for index in range(1, self.waiting):
            distance = self.place(index) - self.place(index - 1)
            if 0.0 < distance < least:
                least = distance
        return least

    def shift(self, distance: float) -> None:
        """All positions get smaller by a distance, u: whole turns are dropped."""
        self.last -= distance
        for index in range(self.waiting):
            self.places[(self.first + index) % CAPACITY] -= distance
