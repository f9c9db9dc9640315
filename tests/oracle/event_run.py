"""What oracles have in common that go through a run from event to event, and note what holds after each of them."""

import math
from abc import ABC, abstractmethod
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from tests.oracle.latest_runs import run_of
from tests.oracle.master import Motion, Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a change makes two rows."""
MOST_EVENTS = 100_000

Event: TypeAlias = tuple[Number, Callable[[], None]]
"""When something happens, and what it does."""
Rows: TypeAlias = list[dict[str, float]]


class Run(Protocol):
    """A run up to its horizon; `log`: what has happened, and when."""

    log: list[tuple[Number, str]]

    def rows(self, time: float) -> Rows:
        """The outputs at a time: one row, or those just before and just after it."""


Make: TypeAlias = Callable[[Mapping[str, Any], Number], Run]
"""Makes a run from a script and its horizon."""


def rows_of(make: Make, script: Mapping[str, Any], times: Sequence[float]) -> Rows:
    """The rows of a run at each of `times`, s."""
    requested = sorted(set(times))
    run = run_of(make, script, mp.mpf(max([script["stop_time"], *requested])) + WINDOW)
    return [row for time in requested for row in run.rows(time)]


def events_of(make: Make, script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens in a run until `stop_time`: (time, name), in order."""
    return [(float(time), name) for time, name in run_of(make, script, mp.mpf(script["stop_time"])).log]


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What holds from a time on; `given`: because of something set at that time."""

    time: Number
    given: bool


S = TypeVar("S", bound=Snapshot)


class SnapshotRows(ABC, Generic[S]):
    """What holds when, from -inf on, and the master's stretches, which start at `begin_times` (s)."""

    snapshots: list[S]
    master: Sequence[Stretch]
    begin_times: Sequence[Number]

    def rows(self, time: float) -> Rows:
        """One row for `time`, or two if something but a set changes a column within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.snapshots, t - WINDOW, key=lambda s: s.time) - 1
        last = bisect_right(self.snapshots, t + WINDOW, key=lambda s: s.time)
        latest = first
        while latest + 1 < last and not self.snapshots[latest + 1].given:
            latest += 1
        early = self._row(t, self.snapshots[first], -1)
        late = self._row(t, self.snapshots[latest], +1) if time > 0 else early
        return [early] if early == late else [early, late]

    def master_at(self, t: Number, side: int) -> Motion:
        """The master at `t`, with velocity and acceleration on one side (-1 or 1) of it."""
        stretch = self.master[bisect_right(self.begin_times, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begin_times, t) - 1].at(t).position
        return replace(stretch.at(t), position=position)

    @abstractmethod
    def _row(self, t: Number, snapshot: S, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with what is different on one side (-1 or 1) of it."""


class EventRun(ABC):
    """A run at its present time; `outputs`: what it has noted."""

    time: Number
    log: list[tuple[Number, str]]
    outputs: SnapshotRows[Any]

    def rows(self, time: float) -> Rows:
        return self.outputs.rows(time)

    @abstractmethod
    def _next(self, until: Number) -> Event | None:
        """The first thing that happens by itself until then."""

    def _until(self, until: Number) -> None:
        """Everything that happens by itself until then."""
        for _ in range(MOST_EVENTS):
            event = self._next(until)
            if event is None:
                self.time = until
                return
            self.time, act = event
            act()
        raise ArithmeticError(f"no progress at {self.time}")


def wrapped_position(position: Number, velocity: Number, side: int, period: Number) -> float:
    """`position` modulo the period, with the turns counted on one side of this time, or just at it (0)."""
    if period == 0:
        return float(position) + 0.0
    turns = mp.floor((position + side * velocity * WINDOW) / period)
    wrapped = float(position - turns * period)
    if wrapped >= period:
        beyond = position - turns * period >= period
        return math.nextafter(float(period), 0.0) if beyond else 0.0
    return max(wrapped, 0.0) + 0.0
