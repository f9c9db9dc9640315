"""A FlyingSaw along a scripted master that is exact at constant acceleration, for tests of the block alone."""

from collections.abc import Iterable, Mapping
from copy import copy, deepcopy
from dataclasses import replace
from itertools import pairwise
from typing import Any

from motionsync.flying_saw.block import FlyingSaw, State
from motionsync.master import MasterInput
from motionsync.refusal import Refusal
from motionsync_fmu.variables import variables

OUTPUTS = tuple(v.name for v in variables(FlyingSaw()) if v.causality in ("output", "local"))
RESULTS = (
    *("start_sync", "in_sync", "in_velocity", "done", "busy", "active"),
    *("command_aborted", "error"),
)
GROUPS = (
    *("gear_in_velo", "gear_in_pos", "gear_out", "halt", "stop"),
    *("move_velocity", "move_absolute", "reset"),
)
MOTION = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")
Row = dict[str, float]


class Saw:
    """A block and its master, which is at `place` with `speed` now; each `run` has one acceleration of the master.

    Values are set between the runs: they act at the next one's beginning.
    """

    def __init__(
        self,
        values: Mapping[str, Any] | None = None,
        *,
        place: float = 0.0,
        speed: float = 0.0,
        mode: MasterInput = MasterInput.START_OF_STEP,
    ) -> None:
        self.block = FlyingSaw()
        self.cells = {v.name: v.cell for v in variables(self.block)}
        self.place, self.speed, self.time = place, speed, 0.0
        self.put({"master.input_mode": mode, **(values or {})})
        self._show_master(place, speed, 0.0)
        assert self.block.initialize() == Refusal.NONE
        self.held = {group for group in GROUPS if self[f"{group}.execute"]}

    def twin(self) -> "Saw":
        """Another one in the same state."""
        other = copy(self)
        other.block = deepcopy(self.block)
        other.cells = {name: replace(cell, owner=owner(other.block, name)) for name, cell in self.cells.items()}
        return other

    def put(self, values: Mapping[str, Any]) -> "Saw":
        for name, value in values.items():
            self.cells[name].set(value)
        return self

    def modes(self, *names: str) -> "Saw":
        """These bits of sync_mode, and no other."""
        for name, cell in self.cells.items():
            if name.startswith("sync_mode."):
                cell.set(name.removeprefix("sync_mode.") in names)
        return self

    def order(self, group: str, **values: Any) -> "Saw":
        """The group's inputs, and a rising edge of its `execute` with the next run."""
        assert group not in self.held, "no edge: execute has not been false"
        return self.put({f"{group}.{name}": value for name, value in values.items()} | {f"{group}.execute": True})

    def release(self, *groups: str) -> "Saw":
        """A falling edge of these groups' `execute`, of all of them if none is named."""
        return self.put({f"{group}.execute": False for group in groups or GROUPS})

    def run(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> "Saw":
        """The master's acceleration for a time, cut into steps at these times since the run's beginning."""
        self.rows(duration, acceleration=acceleration, cuts=cuts)
        return self

    def rows(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> dict[float, Row]:
        """As `run`; the slave's motion at the steps' ends."""
        place, speed, begin = self.place, self.speed, self.time
        found = {}
        for first, last in pairwise(sorted({0.0, duration, *(cut for cut in cuts if 0.0 < cut < duration)})):
            seen = last if self.block.master.input_mode == MasterInput.END_OF_STEP else first
            self._show_master(
                place + (speed + 0.5 * acceleration * seen) * seen, speed + acceleration * seen, acceleration
            )
            assert self.block.step(last - first) == Refusal.NONE
            self.held = {group for group in GROUPS if self[f"{group}.execute"]}
            self.time = begin + last
            self.place, self.speed = place + (speed + 0.5 * acceleration * last) * last, speed + acceleration * last
            found[self.time] = self.read(MOTION)
        return found

    def read(self, names: Iterable[str] = OUTPUTS) -> Row:
        return {name: self.cells[name].get() for name in names}

    def __getitem__(self, name: str) -> Any:
        return self.cells[name].get()

    @property
    def slave(self) -> tuple[float, float, float]:
        """Position, velocity and acceleration."""
        slave = self.block.slave
        return slave.position, slave.velocity, slave.acceleration

    @property
    def state(self) -> State:
        return self.block.state

    def results(self, group: str) -> set[str]:
        """The names of the group's outputs that are true."""
        return {name for name in RESULTS if f"{group}.{name}" in self.cells and self[f"{group}.{name}"]}

    def _show_master(self, place: float, speed: float, acceleration: float) -> None:
        master = self.block.master
        master.position = place % master.period if master.period > 0.0 else place
        if master.input_mode != MasterInput.POSITION_ONLY:
            master.velocity, master.acceleration = speed, acceleration


def grid(duration: float, h: float) -> list[float]:
    """Cuts of a run into steps of h."""
    return [i * h for i in range(1, int(duration / h) + 1)]


def owner(block: FlyingSaw, name: str) -> Any:
    """The part of the block in which the variable of that name lies."""
    part: Any = block
    for step in name.split(".")[:-1]:
        part = getattr(part, step)
    return part
