"""The outputs of a Follower's run at given times, from the snapshots that its oracle has taken."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.oracle.event_run import WINDOW, Snapshot, SnapshotRows
from tests.oracle.follower.cycle import Law
from tests.oracle.master import Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


@dataclass(frozen=True, slots=True)
class FollowerSnapshot(Snapshot):
    """`given`: also after the end of that step."""

    law: Law
    state: int
    cycle: int
    error_id: int
    points: tuple[Number, Number, Number] | None


@dataclass(frozen=True)
class FollowerRows(SnapshotRows[FollowerSnapshot]):
    """What holds when, and the master's stretches, which start at `begin_times` (s)."""

    master: Sequence[Stretch]
    begin_times: Sequence[Number]
    slave_cycle: Number
    snapshots: list[FollowerSnapshot] = field(default_factory=list)

    def _row(self, t: Number, snapshot: FollowerSnapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        master = self.master_at(t, side)
        s, v, a, j = snapshot.law.at(t, master, side, WINDOW)
        points = snapshot.points or (master.position, master.position, master.position)
        to_start, to_sync, to_out = (max(float(point - master.position), 0.0) for point in points)
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
