"""A RemoteSync that is given telegrams, for tests of the block alone."""

from collections.abc import Iterable, Mapping
from copy import copy, deepcopy
from typing import Any, Self

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Refusal
from motionsync_fmu.interface.variables import variables

T = 0.002  # s, the task cycle time unless it is said otherwise
Course = dict[str, list[Any]]  # outputs and locals, a value a cycle


class Receiver:
    """A block that has been initialized; variables are set and read by name."""

    def __init__(self, values: Mapping[str, Any] | None = None) -> None:
        self.block = RemoteSync()
        declared = variables(self.block)
        self.cells = {v.name: v.cell for v in declared}
        self.told = [v.name for v in declared if not v.settable]
        self.put(values or {})
        assert self.block.initialize() == Refusal.NONE

    def twin(self) -> Self:
        """Another one in the same state."""
        other = copy(self)
        other.block, other.cells = deepcopy((self.block, self.cells))  # together: cells belong to the block's parts
        return other

    def put(self, values: Mapping[str, Any]) -> Self:
        for name, value in values.items():
            self.cells[name].set(value)
        return self

    def step(self, h: float, values: Mapping[str, Any] | None = None) -> Self:
        assert self.put(values or {}).block.step(h) == Refusal.NONE
        return self

    def see(self, index: int, values: Mapping[str, Any] | None = None) -> Self:
        """A cycle with the telegram of this index."""
        return self.step(self["task_cycle_time"], {"remote.cycle_index": index, **(values or {})})

    def run(self, indices: Iterable[int], values: Mapping[str, Any] | None = None) -> Course:
        """A cycle an index; the values are set before the first one."""
        found: Course = {name: [] for name in self.told}
        self.put(values or {})
        for index in indices:
            self.see(index)
            for name in self.told:
                found[name].append(self.cells[name].get())
        return found

    def shown(self) -> dict[str, Any]:
        """All outputs and locals."""
        return {name: self.cells[name].get() for name in self.told}

    def __getitem__(self, name: str) -> Any:
        return self.cells[name].get()

    @property
    def slave(self) -> tuple[float, float, float]:
        """Position, velocity and acceleration."""
        slave = self.block.slave
        return slave.position, slave.velocity, slave.acceleration


def beating(cycles: int, *dates: int, sign: int = 1, first: int = 0) -> list[int]:
    """Indices whose difference D to the cycles is `first` and steps by `sign` at each of the dates."""
    return [n + first + sign * sum(n >= date for date in dates) for n in range(cycles)]
