"""The orders that wait, one after the other."""

from dataclasses import dataclass

from .. import var
from .piece import UNLIMITED

CAPACITY = 64


@dataclass(slots=True)
class Orders:
    """A queue of at most 64 orders. Each has a number, one after the other, and lies at the number modulo 64.

    Attributes:
        first: the number of the active order, which is at the front.
        waiting: how many orders there are.
        lengths, quantities, remaining: of each, its pieces' length, u, how many were ordered, and how many it lacks.
    """

    first: int = 0
    waiting: int = var.count(CAPACITY)
    lengths: list[float] = var.ring(64)
    quantities: list[float] = var.ring(64)
    remaining: list[float] = var.ring(64)

    def is_full(self) -> bool:
        return self.waiting == CAPACITY

    def has(self, number: int) -> bool:
        """Whether the order of that number still waits."""
        return self.first <= number < self.first + self.waiting

    def length(self, place: int) -> float:
        """The length of the order at a place in the queue, 0 the active one, u."""
        return self.lengths[(self.first + place) % CAPACITY]

    def lacking(self) -> float:
        """How many good pieces the active order lacks; 0 without one."""
        return self.remaining[self.first % CAPACITY] if self.waiting > 0 else 0.0

    def append(self, length: float, quantity: float) -> None:
        """The queue is not full."""
        place = (self.first + self.waiting) % CAPACITY
        self.lengths[place] = length
        self.quantities[place] = quantity
        self.remaining[place] = quantity
        self.waiting += 1

    def drop(self) -> None:
        """Take the active order, of which there is one, out of the queue."""
        self.first += 1
        self.waiting -= 1

    def clear(self) -> None:
        self.first += self.waiting
        self.waiting = 0

    def try_fulfil(self, number: int, repeat: bool) -> bool:
        """Count a good piece for an order that waits; whether it is complete with it. `repeat`: it is appended anew."""
        place = number % CAPACITY
        self.remaining[place] -= 1.0
        if self.remaining[place] > 0.0:
            return False
        length = self.lengths[place]
        quantity = self.quantities[place]
        self.drop()
        if repeat:
            self.append(length, quantity)
        return True

    def place_after(self, number: int, repeat: bool) -> int:
        """The place in the queue of the order that is active once the piece in progress counts for `number`.

        -1: there will be none. An order that is complete then is appended anew if `repeat`."""
        if self.waiting == 0:
            return -1
        if number != self.first or self.lacking() > 1.0:
            return 0
        if self.waiting > 1:
            return 1
        return 0 if repeat else -1

    def shortest(self) -> float:
        """The least length of all orders, u; UNLIMITED without any."""
        least = UNLIMITED
        for place in range(self.waiting):
            least = min(least, self.length(place))
        return least
