"""A Follower along a scripted master, for tests of the block alone."""

from typing import Self

from motionsync.follower.block import Follower
from motionsync.follower.faults import Fault
from tests.support.harness import Driven

COMMANDS = ("position_to_park", "position_to_cycle", "end_synchronism", "reset")


class FollowerHarness(Driven):
    """Its commands fall again after the step for which they were given."""

    TYPE = Follower

    def stepped(self) -> None:
        self.put(dict.fromkeys(COMMANDS, False))

    def give(self, *names: str) -> Self:
        """Rising edges of these commands with the next run."""
        return self.put(dict.fromkeys(names, True))

    @property
    def position(self) -> float:
        position: float = self.block.slave.position
        return position

    @property
    def fault(self) -> Fault:
        return Fault(self.block.error_id)

    @property
    def missing(self) -> tuple[float, float, float]:
        """The master's travel missing to start, meeting and end."""
        return self.block.master_to_start, self.block.master_to_sync, self.block.master_to_out
