"""Runs a block along a scripted master whose motion is exact, for tests of the block alone."""

from collections.abc import Iterable, Mapping
from copy import copy
from dataclasses import fields, is_dataclass
from functools import cache
from itertools import pairwise
from typing import Any, ClassVar, Self, get_origin, get_type_hints

from motionsync.master import MasterInput
from motionsync_fmu.interface.stepper import Stepper

MOTION = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")
Row = dict[str, float]


def copy_block(block: Any) -> Any:
    """Another block in the same state, in a quarter of the time of `deepcopy`: a block contains nothing twice."""
    other = copy(block)
    parts, lists = _mutable_fields(type(block))
    for name in parts:
        setattr(other, name, copy_block(getattr(block, name)))
    for name in lists:
        setattr(other, name, getattr(block, name)[:])
    return other


@cache
def _mutable_fields(part: type[Any]) -> tuple[list[str], list[str]]:
    """The fields of a block or of a part that are parts, and those that are lists."""
    types = {name: get_origin(hint) or hint for name, hint in get_type_hints(part).items()}
    names = [f.name for f in fields(part)]
    return [n for n in names if is_dataclass(types[n])], [n for n in names if types[n] is list]


def copy_stepper(stepper: Stepper) -> Stepper:
    """Another stepper, with a copy of the block in the same state."""
    return Stepper(copy_block(stepper.block))


class BlockHarness:
    """A block and its master, which is at `master_position` with the velocity `speed`.

    The master's acceleration is constant during each `run`. Values that are set between two runs act at the start of
    the second one. A subclass for each block gives the block's class, `TYPE`, and the variables that `rows` returns,
    `SHOWN`.
    """

    TYPE: ClassVar[type[Any]]
    SHOWN: ClassVar[tuple[str, ...]] = MOTION

    def __init__(
        self,
        values: Mapping[str, Any] | None = None,
        *,
        master_position: float = 0.0,
        speed: float = 0.0,
        mode: MasterInput = MasterInput.START_OF_STEP,
    ) -> None:
        self.stepper = Stepper(self.TYPE())
        self.master_position, self.speed, self.time = master_position, speed, 0.0
        self.set({"master.input_mode": mode, **(values or {})})
        self._show_master(master_position, speed, 0.0)
        self.stepper.initialize()
        self.after_step()

    @property
    def block(self) -> Any:
        return self.stepper.block

    def after_step(self) -> None:
        """A hook for subclasses, called after each step."""

    def twin(self) -> Self:
        """Another harness whose block is in the same state."""
        other = copy(self)
        other.stepper = copy_stepper(self.stepper)
        return other

    def save(self) -> Self:
        """The present state, for `restore`."""
        return self.twin()

    def restore(self, saved: Self) -> Self:
        vars(self).update(vars(saved.twin()))
        return self

    def set(self, values: Mapping[str, Any]) -> Self:
        self.stepper.set(values)
        return self

    def run(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> Self:
        """Run for a time with this acceleration of the master, in steps that end at these times since its start."""
        self.rows(duration, acceleration=acceleration, cuts=cuts)
        return self

    def to(self, master_position: float, steps: int = 1) -> Self:
        """Run with constant velocity until the master is at `master_position`."""
        duration = (master_position - self.master_position) / self.speed
        self.run(duration, cuts=[i * duration / steps for i in range(1, steps)])
        self.master_position = master_position
        return self

    def rows(self, duration: float, *, acceleration: float = 0.0, cuts: Iterable[float] = ()) -> dict[float, Row]:
        """As `run`; returns the values in `SHOWN` at the end of each step, by time."""
        master_position, speed, begin = self.master_position, self.speed, self.time
        rows = {}
        for first, last in pairwise(sorted({0.0, duration, *(cut for cut in cuts if 0.0 < cut < duration)})):
            input_time = last if self.block.master.input_mode == MasterInput.END_OF_STEP else first
            self._show_master(*advance(master_position, speed, acceleration, input_time), acceleration)
            self.stepper.step(last - first)
            self.after_step()
            self.time = begin + last
            self.master_position, self.speed = advance(master_position, speed, acceleration, last)
            rows[self.time] = self.read(self.SHOWN)
        return rows

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

    def _show_master(self, master_position: float, speed: float, acceleration: float) -> None:
        master = self.block.master
        master.position = master_position % master.period if master.period > 0.0 else master_position
        if master.input_mode != MasterInput.POSITION_ONLY:
            master.velocity, master.acceleration = speed, acceleration


def advance(position: float, velocity: float, acceleration: float, time: float) -> tuple[float, float]:
    """Position and velocity after a time; after a stop the velocity is 0, without a rounding error."""
    after = velocity + acceleration * time
    stopped = abs(after) < 1e-14 * abs(velocity)
    return position + (velocity + 0.5 * acceleration * time) * time, 0.0 if stopped else after


def grid(duration: float, h: float) -> list[float]:
    """The times that cut a run into steps of h."""
    return [i * h for i in range(1, int(duration / h) + 1)]
