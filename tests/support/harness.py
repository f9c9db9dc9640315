"""Runs a block along a scripted master whose motion is exact, for tests of the block alone."""

from collections.abc import Iterable, Mapping
from copy import copy
from itertools import pairwise
from typing import Any, ClassVar, Self

from motionsync.master import MasterInput
from motionsync_fmu.interface.stepper import Stepper

MOTION = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")
Row = dict[str, float]


class BlockHarness:
    """A block and its master, which is now at `place` with the velocity `speed`.

    The master's acceleration is constant during each `run`. Values that are set between two runs act at the beginning
    of the second one. A subclass for each block gives the class of the block, `TYPE`, and what `rows` shows, `SHOWN`.
    """

    TYPE: ClassVar[type[Any]]
    SHOWN: ClassVar[tuple[str, ...]] = MOTION

    def __init__(
        self,
        values: Mapping[str, Any] | None = None,
        *,
        place: float = 0.0,
        speed: float = 0.0,
        mode: MasterInput = MasterInput.START_OF_STEP,
    ) -> None:
        self.stepper = Stepper(self.TYPE())
        self.place, self.speed, self.time = place, speed, 0.0
        self.put({"master.input_mode": mode, **(values or {})})
        self._show_master(place, speed, 0.0)
        self.stepper.initialize()
        self.stepped()

    @property
    def block(self) -> Any:
        return self.stepper.block

    def stepped(self) -> None:
        """Called after each step, for subclasses."""

    def twin(self) -> Self:
        """Another harness whose block is in the same state."""
        other = copy(self)
        other.stepper = self.stepper.twin()
        return other

    def saved(self) -> tuple[Any, ...]:
        """The present state, for `restore`: quicker than a twin."""
        values = [cell.get() for cell in self.stepper.cells.values()]
        return self.place, self.speed, self.time, [copy(v) if isinstance(v, list) else v for v in values]

    def restore(self, saved: tuple[Any, ...]) -> Self:
        self.place, self.speed, self.time, values = saved
        for cell, value in zip(self.stepper.cells.values(), values, strict=True):
            setattr(cell.owner, cell.attribute, copy(value) if isinstance(value, list) else value)
        return self

    def put(self, values: Mapping[str, Any]) -> Self:
        self.stepper.set(values)
        return self

    def run(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> Self:
        """Run for a time with this acceleration of the master, in steps that end at these times since its beginning."""
        self.rows(duration, acceleration=acceleration, cuts=cuts)
        return self

    def to(self, place: float, steps: int = 1) -> Self:
        """Run with constant velocity until the master is at `place`."""
        duration = (place - self.place) / self.speed
        self.run(duration, cuts=[i * duration / steps for i in range(1, steps)])
        self.place = place
        return self

    def rows(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> dict[float, Row]:
        """As `run`; the answer is what is shown at the end of each step, by time."""
        place, speed, begin = self.place, self.speed, self.time
        found = {}
        for first, last in pairwise(sorted({0.0, duration, *(cut for cut in cuts if 0.0 < cut < duration)})):
            seen = last if self.block.master.input_mode == MasterInput.END_OF_STEP else first
            self._show_master(*moved(place, speed, acceleration, seen), acceleration)
            self.stepper.step(last - first)
            self.stepped()
            self.time = begin + last
            self.place, self.speed = moved(place, speed, acceleration, last)
            found[self.time] = self.read(self.SHOWN)
        return found

    def read(self, names: Iterable[str]) -> Row:
        return self.stepper.get(names)

    def __getitem__(self, name: str) -> Any:
        return self.stepper[name]

    @property
    def slave(self) -> tuple[float, float, float]:
        """Position, velocity and acceleration."""
        slave = self.block.slave
        return slave.position, slave.velocity, slave.acceleration

    @property
    def state(self) -> Any:
        return self.block.state

    def _show_master(self, place: float, speed: float, acceleration: float) -> None:
        master = self.block.master
        master.position = place % master.period if master.period > 0.0 else place
        if master.input_mode != MasterInput.POSITION_ONLY:
            master.velocity, master.acceleration = speed, acceleration


def moved(place: float, speed: float, acceleration: float, time: float) -> tuple[float, float]:
    """Place and velocity after a time; after a stop the velocity is 0, without a rounding error."""
    after = speed + acceleration * time
    stopped = abs(after) < 1e-14 * abs(speed)
    return place + (speed + 0.5 * acceleration * time) * time, 0.0 if stopped else after


def grid(duration: float, h: float) -> list[float]:
    """The times that cut a run into steps of h."""
    return [i * h for i in range(1, int(duration / h) + 1)]
