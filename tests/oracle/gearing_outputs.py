"""The outputs of a Gearing's run at given times, from the snapshots that its oracle has taken."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from tests.oracle import mp
from tests.oracle.gearing_inputs import ACTIVE, Triggers
from tests.oracle.gearing_laws import ZERO, Law, Timed, TransitionCurve, series
from tests.oracle.master import Stretch
from tests.oracle.mp import Number

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a change makes two rows."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What holds from a time on; `given`: because of something set at that time.

    `slope`: by which the line moves with the occurrence that it waits for.
    """

    time: Number
    given: bool
    code: int
    law: Law
    line_offset: Number
    slope: Number
    trigger: Number | Triggers
    error_id: int
    held_progress: Number | None


@dataclass(frozen=True)
class GearingRows:
    """What holds when, and the master's stretches, which start at `begin_times` (s)."""

    master: Sequence[Stretch]
    begin_times: Sequence[Number]
    period: Number
    slave_period: Number
    snapshots: list[Snapshot] = field(default_factory=list)

    def rows(self, time: float) -> list[dict[str, float]]:
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

    def latest_direction(self, time: Number) -> int:
        """In which the master moves or last moved; 0 before it did."""
        passed = self.master[: bisect_right(self.begin_times, time)]
        return next((s.direction for s in reversed(passed) if s.direction), 0)

    def _row(self, t: Number, snapshot: Snapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        stretch = self.master[bisect_right(self.begin_times, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begin_times, t) - 1].at(t).position
        master = replace(stretch.at(t), position=position)
        s, v, half_a, sixth_j = snapshot.law.at(t, series(master))
        progress, trigger, offset = snapshot.held_progress, snapshot.trigger, snapshot.line_offset
        if isinstance(trigger, Triggers):
            trigger, shifted = trigger.shown(position, self.latest_direction(t + side * WINDOW))
            offset -= snapshot.slope * shifted
        if progress is None:
            progress = progress_of(snapshot.code, snapshot.law, t, position)
        turns_side = side if t >= WINDOW else max(side, 0)  # nothing was before 0
        return {
            "time": float(t),
            "slave.position": _wrapped(s, v, turns_side, self.slave_period),
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(2 * half_a) + 0.0,
            "slave.jerk": float(6 * sixth_j) + 0.0,
            "state": float(snapshot.code),
            "state_code": float(snapshot.code),
            "in_gear": float(snapshot.code == ACTIVE),
            "error": float(snapshot.error_id != 0),
            "error_id": float(snapshot.error_id),
            "local.trigger_position": _wrapped(trigger, ZERO, 0, self.period),
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


def _wrapped(position: Number, velocity: Number, side: int, period: Number) -> float:
    """`position` modulo the period, with the turns counted on one side of this time, or just at it (0)."""
    if period == 0:
        return float(position) + 0.0
    turns = mp.floor((position + side * velocity * WINDOW) / period)
    wrapped = float(position - turns * period)
    if wrapped >= period:
        beyond = position - turns * period >= period
        return math.nextafter(float(period), 0.0) if beyond else 0.0
    return max(wrapped, 0.0) + 0.0
