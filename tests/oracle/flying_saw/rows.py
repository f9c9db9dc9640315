"""The rows of a run of the FlyingSaw's oracle: what the step that ends at a time puts out."""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tests.oracle.event_run import WINDOW, Snapshot, SnapshotRows
from tests.oracle.flying_saw.commands import DONE, Pulse, shown
from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.flying_saw.laws import Follow, Law
from tests.oracle.flying_saw.limits import NONE as WITHIN_LIMITS
from tests.oracle.flying_saw.limits import AxisData, by_instant, by_way
from tests.oracle.master import Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

ROUNDING = mp.mpf("1e-30")
"""Acceleration (u/s2) left at the end of a ramp by rounding."""

INACTIVE, CONSTANT_VELOCITY, ACCELERATING, DECELERATING = 0, 3, 4, 5
PREPHASE, SYNCHRONIZING, SYNCHRON = 11, 12, 13
STANDSTILL, DISCRETE_MOTION, CONTINUOUS_MOTION, SYNCHRONIZED_MOTION, STOPPING = range(1, 6)


@dataclass(frozen=True, slots=True)
class SawSnapshot(Snapshot):
    """`axis`: the machine data then; `exceeded`: which limit the motion under way exceeds, as it was planned."""

    law: Law | Follow
    outputs: Mapping[str, float]
    axis: AxisData
    exceeded: int


@dataclass(frozen=True, slots=True)
class FlyingSawRows(SnapshotRows[SawSnapshot]):
    """A whole run: its snapshots, the master's stretches with their times, the pulses by time, and the steps' ends."""

    snapshots: list[SawSnapshot]
    master: Sequence[Stretch]
    begin_times: Sequence[Number]
    pulses: Sequence[Pulse]
    grid: Sequence[float]

    def _row(self, t: Number, snapshot: SawSnapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity and the pulses of one side (-1 or 1) of it."""
        s, v, a, j = snapshot.law.at(t, self.master_at(t, side), side)
        outputs = dict(snapshot.outputs)
        state = outputs.pop("coupled_state") or _own_state(v, a)
        for pulse in self._pulses(t, side):
            if pulse.shows == DONE and outputs[f"{pulse.group}.busy"]:
                continue  # it was parked in the same step
            synchronizing = outputs["coupled"] != 0 and state != PREPHASE
            outputs |= shown(pulse.group, pulse.shows, pulse.error_id, synchronizing)
        limits = {snapshot.exceeded, by_instant((s, v, a, j), snapshot.axis), self._by_way(t, s, snapshot.axis)}
        limits = limits if t > 0 else set()
        exceeded = min(limits - {WITHIN_LIMITS}, default=WITHIN_LIMITS)
        row = {
            "time": float(t),
            "slave.position": float(s) + 0.0,
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(a) + 0.0,
            "slave.jerk": float(j) + 0.0,
            "state": float(state),
            "state_code": float(state),
            "limit_exceeded": float(exceeded != WITHIN_LIMITS),
            "local.exceeded_limit": float(exceeded),
        }
        return row | outputs

    def _step_begin(self, t: Number) -> Number:
        """Where the step begins that ends at t."""
        return mp.mpf(self.grid[max(bisect_left(self.grid, t - WINDOW) - 1, 0)])

    def _by_way(self, t: Number, position: Number, axis: AxisData) -> int:
        """The code of what the way of the step exceeds that ends at t, at that position."""
        begin = self._step_begin(t)
        snapshot = self.snapshots[bisect_right(self.snapshots, begin, key=lambda s: s.time) - 1]
        before, *_ = snapshot.law.at(begin, self.master_at(begin, 1), 1)
        return by_way(position - before, t - begin, axis)

    def _pulses(self, t: Number, side: int) -> list[Pulse]:
        """The results shown in the step that ends at t: those that arose in it, whether or not just at its ends."""
        begin = self._step_begin(t)
        pulses = []
        for pulse in self.pulses:
            early, late = pulse.time - begin, pulse.time - t
            if pulse.given or side < 0:
                inside = early >= -WINDOW and late < -WINDOW
            else:
                inside = early > WINDOW and late <= WINDOW
            pulses += [pulse] if inside else []
        return pulses


def _own_state(v: Number, a: Number) -> int:
    v, a = (ZERO if abs(x) < ROUNDING else x for x in (v, a))
    if v == 0 and a == 0:
        return INACTIVE
    if a == 0:
        return CONSTANT_VELOCITY
    return DECELERATING if v * a < 0 else ACCELERATING


def step_ends(script: Mapping[str, Any]) -> list[float]:
    """The ends of the steps: multiples of the step size, and where something is set, expected, or the script breaks."""
    stop, step = float(script["stop_time"]), float(script["step_size"])
    points = [i * step for i in range(int(stop / step * (1 + 1e-12)) + 1)]
    points += [float(table["at"]) for table in script.get("set", ())]
    points += [float(table[key]) for table in script.get("expect", ()) for key in ("at", "from", "to") if key in table]
    end = 0.0
    for segment in script["master"].get("segments", ()):
        end += float(segment["duration"])
        points.append(end)
    return [p for p in sorted({*points, stop}) if p <= stop]
