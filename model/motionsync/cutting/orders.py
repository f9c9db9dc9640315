"""The queue of production orders."""

from dataclasses import dataclass

from .. import var
from .piece import CAPACITY, UNLIMITED


@dataclass(slots=True)
class OrderQueue:
    """The orders, numbered one after the other; the lists have each at its number modulo their length.

    Attributes:
        first: the number of the active order, which is at the front.
        waiting: how many orders there are, the active one included.
        lengths, quantities, remaining: of each, the length of a piece, u; the pieces ordered; those still missing.
        has_changed: since the shortest one was last determined.
    """

    first: int = 0
    waiting: int = var.count(CAPACITY)
    lengths: list[float] = var.array(CAPACITY)
    quantities: list[float] = var.array(CAPACITY)
    remaining: list[float] = var.array(CAPACITY)
    has_changed: bool = True

    def is_full(self) -> bool:
        return self.waiting == CAPACITY

    def length(self, index: int) -> float:
        """The length of the order with this index in the queue, u; the active one has index 0."""
        return self.lengths[(self.first + index) % CAPACITY]

    def remaining_pieces(self) -> float:
        """How many good pieces the active order lacks; 0 without one."""
        return self.remaining[self.first % CAPACITY] if self.waiting > 0 else 0.0

    def append(self, length: float, quantity: float) -> None:
        """Append an order to the queue, which is not full: `Operation` refuses one too many."""
        slot = (self.first + self.waiting) % CAPACITY
        self.lengths[slot] = length
        self.quantities[slot] = quantity
        self.remaining[slot] = quantity
        self.waiting += 1
        self.has_changed = True

    def drop(self) -> None:
        """Take the active order, of which there is one, out of the queue."""
        self.first += 1
        self.waiting -= 1
        self.has_changed = True

    def clear(self) -> None:
        self.first += self.waiting
        self.waiting = 0
        self.has_changed = True

    def try_complete(self, number: int, repeat: bool) -> bool:
        """Count a good piece for the order of that number, if it still waits; whether it was the order's last one.

        `repeat`: a completed order is appended anew."""
        if not self.first <= number < self.first + self.waiting:
            return False
        slot = number % CAPACITY
        self.remaining[slot] -= 1.0
        if self.remaining[slot] > 0.0:
            return False
        length = self.lengths[slot]
        quantity = self.quantities[slot]
        self.drop()
        if repeat:
            self.append(length, quantity)
        return True

    def next_index(self, number: int, repeat: bool) -> int:
        """The index of the order that is active after the piece in progress, which counts for the order `number`.

        -1: there will be none. An order that is completed by this piece is appended anew if `repeat`."""
        if self.waiting == 0:
            return -1
        if number != self.first or self.remaining_pieces() > 1.0:
            return 0
        if self.waiting > 1:
            return 1
        return 0 if repeat else -1

    def shortest_length(self) -> float:
        """The least length of all orders, u; UNLIMITED without any."""
        shortest = UNLIMITED
        for index in range(self.waiting):
            shortest = min(shortest, self.length(index))
        return shortest
