"""The outputs of a Gearing's run at given times, from the snapshots that its oracle has taken."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.oracle.event_run import WINDOW, Snapshot, SnapshotRows, wrapped_position
from tests.oracle.gearing.inputs import ACTIVE, Triggers
from tests.oracle.gearing.laws import ZERO, Law, Timed, TransitionCurve, series
from tests.oracle.master import Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


@dataclass(frozen=True, slots=True)
class GearingSnapshot(Snapshot):
    """`slope`: by which the line moves with the occurrence that it waits for."""

    code: int
    law: Law
    line_offset: Number
    slope: Number
    trigger: Number | Triggers
    error_id: int
    held_progress: Number | None


@dataclass(frozen=True)
class GearingRows(SnapshotRows[GearingSnapshot]):
    """What holds when, and the master's stretches, which start at `begin_times` (s)."""

    master: Sequence[Stretch]
    begin_times: Sequence[Number]
    period: Number
    slave_period: Number
    snapshots: list[GearingSnapshot] = field(default_factory=list)

    def latest_direction(self, time: Number) -> int:
        """In which the master moves or last moved; 0 before it did."""
        passed = self.master[: bisect_right(self.begin_times, time)]
        return next((s.direction for s in reversed(passed) if s.direction), 0)

    def _row(self, t: Number, snapshot: GearingSnapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        master = self.master_at(t, side)
        s, v, half_a, sixth_j = snapshot.law.at(t, series(master))
        progress, trigger, offset = snapshot.held_progress, snapshot.trigger, snapshot.line_offset
        if isinstance(trigger, Triggers):
            trigger, shifted = trigger.shown(master.position, self.latest_direction(t + side * WINDOW))
            offset -= snapshot.slope * shifted
        if progress is None:
            progress = progress_of(snapshot.code, snapshot.law, t, master.position)
        turns_side = side if t >= WINDOW else max(side, 0)  # nothing was before 0
        return {
            "time": float(t),
            "slave.position": wrapped_position(s, v, turns_side, self.slave_period),
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(2 * half_a) + 0.0,
            "slave.jerk": float(6 * sixth_j) + 0.0,
            "state": float(snapshot.code),
            "state_code": float(snapshot.code),
            "in_gear": float(snapshot.code == ACTIVE),
            "error": float(snapshot.error_id != 0),
            "error_id": float(snapshot.error_id),
            "local.trigger_position": wrapped_position(trigger, ZERO, 0, self.period),
            "local.line_offset": float(offset) + 0.0,
            "local.progress": float(progress) + 0.0,
        }


def progress_of(code: int, law: Law, time: Number, master: Number) -> Number:
    """u or t/T in a transition, 1 in gear, else 0."""
    match law:
        case TransitionCurve():
            part = law.progress(master)
        case Timed():
            part = law.progress(time)
        case _:
            part = mp.mpf(code == ACTIVE)
    return min(max(part, ZERO), mp.mpf(1))
