"""The telegrams by which a block sees a remote axis: one for each of its own cycles."""

from dataclasses import dataclass
from math import floor

from motionsync import var

CLOSE = 1e-6  # of a cycle: a time that follows an instant by less is taken for that instant
WIDTH = 3  # numbers of a telegram's motion: position, velocity, acceleration


@dataclass(slots=True)
class Telegrams:
    """What is seen in each cycle.

    Attributes:
        cycle: the length of the block's cycles, s; its cycle i acts at i times its length.
        cycle_index: the index of the telegram that is seen in each cycle, as the telegram contains it.
        motion: that of the axis in these telegrams, WIDTH numbers each: u, u/s, u/s2.
    """

    cycle: float = 0.0
    cycle_index: var.Wholes = var.series()
    motion: var.Reals = var.series()

    def shown(self, begin: float, end: float) -> int:
        """The cycle whose telegram the block sees in a step: the first one in it, or else the latest one before it."""
        return max(min(count_cycles(begin, self.cycle), count_cycles(end, self.cycle) - 1), 0)


def count_cycles(t: float, cycle: float) -> int:
    """How many cycles have acted before t, which is the number of the next one."""
    return max(-floor(CLOSE - t / cycle), 0)
