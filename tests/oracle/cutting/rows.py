"""The rows of a machine that cuts to length: two of a time at which something jumps, and where the steps end."""

from abc import ABC, abstractmethod
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from typing import Any, Generic, Protocol, TypeVar

from tests.oracle.numerics import mp

WINDOW = 1e-9
"""Time (s) around a requested one within which a jump makes two rows."""

MEMBERS = {
    "start_mode": ("FRONT", "TRIM", "CONTINUE"),
    "change_mode": ("NEXT_PIECE", "THIS_PIECE"),
    "late_mode": ("SKIP", "LATE", "STOP_LINE"),
}


class Snapshot(Protocol):
    """What holds from `time` on; `at_step_begin`: because of something that is noticed at a step's beginning."""

    @property
    def time(self) -> float: ...

    @property
    def at_step_begin(self) -> bool: ...


S = TypeVar("S", bound=Snapshot)


class Rows(ABC, Generic[S]):
    """The outputs at any time of a run with these snapshots, which are in order."""

    def __init__(self, snapshots: Sequence[S]) -> None:
        self.snapshots = snapshots
        self.times = [snapshot.time for snapshot in snapshots]

    def at(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if something changes within the window around it."""
        first = max(bisect_left(self.times, time - WINDOW) - 1, 0)
        last = bisect_right(self.times, time + WINDOW)
        latest = first
        while latest + 1 < last and not self.snapshots[latest + 1].at_step_begin:
            latest += 1
        early = self._row(time, self.snapshots[first], -WINDOW)
        late = self._row(time, self.snapshots[latest], WINDOW) if time > 0 else early
        return [early] if early == late else [early, late]

    @abstractmethod
    def _row(self, time: float, snapshot: S, offset: float) -> dict[str, float]:
        """The outputs at `time` with the master's velocity just before or after it, `offset` away."""


def step_ends(script: Mapping[str, Any]) -> list[float]:
    """The ends of the steps: multiples of the step size, and where something is set, expected, or the script breaks."""
    stop, step = float(script["stop_time"]), float(script["step_size"])
    points = [i * step for i in range(int(stop / step * (1 + 1e-12)) + 1)]
    points += [float(table["at"]) for table in script.get("set", ())]
    points += [float(table[key]) for table in script.get("expect", ()) for key in ("at", "from", "to") if key in table]
    end = mp.mpf(0)
    for segment in script["master"].get("segments", ()):
        end += mp.mpf(segment["duration"])
        points.append(float(end))
    return [p for p in sorted({*points, stop}) if p <= stop]


def as_number(name: str, value: Any) -> Any:
    """A value that is set, an enumeration's member as its number."""
    return MEMBERS[name].index(value) + 1 if isinstance(value, str) else value
