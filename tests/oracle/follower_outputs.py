"""The outputs of a Follower's run at given times, from the snapshots that its oracle has taken."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from tests.oracle import mp
from tests.oracle.follower_cycle import Law
from tests.oracle.master import Stretch
from tests.oracle.mp import Number

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a jump makes two rows."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What holds from a time on; `given`: because of something set at that time, or after the end of that step."""

    time: Number
    given: bool
    law: Law
    state: int
    cycle: int
    error_id: int
    points: tuple[Number, Number, Number] | None


@dataclass(frozen=True)
class FollowerRows:
    """What holds when, and the master's stretches, which start at `begin_times` (s)."""

    master: Sequence[Stretch]
    begin_times: Sequence[Number]
    slave_cycle: Number
    snapshots: list[Snapshot] = field(default_factory=list)

    def rows(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if the motion changes a column within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.snapshots, t - WINDOW, key=lambda s: s.time) - 1
        last = bisect_right(self.snapshots, t + WINDOW, key=lambda s: s.time)
        latest = max(first, 0)
        while latest + 1 < last and not self.snapshots[latest + 1].given:
            latest += 1
        early = self._row(t, self.snapshots[max(first, 0)], -1)
        late = self._row(t, self.snapshots[latest], +1) if time > 0 else early
        return [early] if early == late else [early, late]

    def _row(self, t: Number, snapshot: Snapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        stretch = self.master[bisect_right(self.begin_times, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begin_times, t) - 1].at(t).position
        s, v, a, j = snapshot.law.at(t, replace(stretch.at(t), position=position), side, WINDOW)
        points = snapshot.points or (position, position, position)
        to_start, to_sync, to_out = (max(float(point - position), 0.0) for point in points)
        return {
            "time": float(t),
            "slave.position": self._wrapped(s, v, side),
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(a) + 0.0,
            "slave.jerk": float(j) + 0.0,
            "state": float(snapshot.state),
            "state_code": float(snapshot.state),
            "cycle": float(snapshot.cycle),
            "master_to_start": to_start,
            "master_to_sync": to_sync,
            "master_to_out": to_out,
            "error": float(snapshot.error_id != 0),
            "error_id": float(snapshot.error_id),
        }

    def _wrapped(self, s: Number, v: Number, side: int) -> float:
        """The position in the slave's cycle; a slave that just passes its end is at both ends, one on each side."""
        cycle = self.slave_cycle
        if cycle == 0:
            return float(s) + 0.0
        turn = mp.nint(s / cycle)
        if abs(s - turn * cycle) <= WINDOW * abs(v):
            return float(cycle) if side * v < 0 else 0.0
        result = float(s - mp.floor(s / cycle) * cycle)
        return 0.0 if result >= float(cycle) else result
