"""Reference for the RotaryKnife: the machine's true behaviour on the continuous time axis.

The sequence is simulated from event to event (`rotary_knife_sequence`, which names the modules that list the readings
of the specification); a row is computed from what holds at its time. What a row is, and where steps end, is as for
CutToLength (`cut_to_length`).

Further readings:
- `slave.position` is within [0, turn), as an axis with that period has it; `local.unwrapped_position`, which the block
  does not have, is not. It is 0 at the first place at which a blade might have cut.
- `piece.length` is the material that has passed since the last cut, less b and Δ; 0 while the machine does not run.
- `next_cut.distance` is counted to where the next cut's window begins; 0 from there to the cut.
- The shortest pitch is that of limits.min_length: over v it is limits.cycle_time, its share of the pitch is missing
  in limits.reserve. `limits.min_sensor_distance` is f(W + v·mark.delay) + before, W of the ramp up.
- In the limits of the line, a piece whose length is not known is one that parks; the piece in progress counts with the
  pitch with which it was fixed. While nothing is in progress, the expected piece counts alone.
- `warning.velocity`: the greatest slope of the window, times v, is above the axis's velocity.
- `peaks.*` are the extremes of the curves and windows since the latest curve was laid, at the present line velocity.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from tests.oracle.cutting.machine import COMMANDS
from tests.oracle.cutting.ranges import PIECE_DEFAULTS
from tests.oracle.cutting.rows import WINDOW, Rows, as_number, step_ends
from tests.oracle.latest_runs import run_of
from tests.oracle.master import Motion, stretches
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import ZERO, Cut
from tests.oracle.rotary_knife.limits import NO_LENGTH, longest_turning, shortest_way
from tests.oracle.rotary_knife.line import ExactSection
from tests.oracle.rotary_knife.sequence import KnifeRun
from tests.oracle.rotary_knife.state import Snapshot
from tests.oracle.sets import gathered
from tests.oracle.timed_motion import TimedMotion

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "state_code",
    "error_id",
    "running",
    "in_sync",
    "knife.in_window",
    "next_cut.position",
    "next_cut.distance",
    "piece.length",
    "piece.ordered",
    "piece.kind",
    "last.length",
    "last.error",
    "last.good",
    "last.time",
    "order.waiting",
    "order.remaining",
    "limits.max_line_velocity",
    "limits.max_line_velocity_orders",
    "limits.min_length",
    "limits.max_length",
    "line.velocity_request",
    "statistics.cuts",
    "statistics.pieces_good",
    "statistics.pieces_bad",
    "statistics.skipped",
    "statistics.late",
    "statistics.length_good",
    "statistics.length_waste",
    "warning.line_too_fast",
)
"""The columns of a scenario's reference, in addition to the time."""

DEFAULTS: dict[str, Any] = {
    **PIECE_DEFAULTS,
    "sync.before": 20.0,
    "sync.after": 20.0,
    "sync.overspeed": 0.0,
    **dict.fromkeys(COMMANDS, False),
}
"""What may be set while the block runs, with the start values."""

FIXED: dict[str, Any] = {
    "auto_start": False,
    "knife.turn": 360.0,
    "knife.circumference": 600.0,
    "knife.blades": 1,
    "knife.park_angle": 0.0,
    "sync.mode": 1,
    "axis.max_velocity": 3600.0,
    "axis.max_acceleration": 72000.0,
    "axis.max_jerk": 1e6,
    "allow_parking": True,
    "source": 1,
    "mark.latched": True,
    "master.period": 0.0,
}
"""What holds for a whole run."""


OVER = 1e-12
"""Of a turn: how near to its end the position may be for rounding to decide whether it starts again."""


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `step_size`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows,
    just before and just after, where an output jumps within 1e-9 s of a time.
    """
    requested_times = sorted(set(times))
    sections, machine = run_of(_run, script, max([float(script["stop_time"]), *requested_times]) + 2 * WINDOW)
    rows = _Rows(sections, machine)
    return [row for time in requested_times for row in rows.at(time)]


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name) of start (of a ramp up), sync, cut, rest, turned back (at rest),
    unsynchronised, parked, fault, in order.

    Raises ValueError for a set at or before 0 and for a set of something that is neither an input nor tunable, and for
    a window that the knife cannot have.
    """
    return list(run_of(_run, script, float(script["stop_time"]))[1].log)


def _run(script: Mapping[str, Any], horizon: float) -> tuple[list[ExactSection], KnifeRun]:
    start = script.get("start", {})
    inputs = {name: start.get(name, default) for name, default in (DEFAULTS | FIXED).items()}
    period = mp.mpf(inputs["master.period"])
    parts = stretches(script["master"], mp.mpf(horizon))[1:]
    shift = -mp.floor(parts[0].start.position / period) * period if period > 0 else ZERO
    sections = [ExactSection(part, shift) for part in parts]
    sets = gathered(script.get("set", ()), DEFAULTS, as_number)
    return sections, KnifeRun(inputs, sections, step_ends(script), sets, float(period))


class _Rows(Rows[Snapshot]):
    """The outputs of a run at any time."""

    def __init__(self, sections: Sequence[ExactSection], machine: KnifeRun) -> None:
        super().__init__(machine.snapshots)
        self.sections, self.knife = sections, machine.knife
        self.section_begins = [section.begin for section in sections]

    def at(self, time: float) -> list[dict[str, float]]:
        """Two rows, too, where the position starts again from 0: a turn is over."""
        rows = super().at(time)
        position, turn = rows[0]["slave.position"], float(self.knife.turn)
        if min(position, turn - position) > OVER * turn:
            return rows
        return [rows[0] | {"slave.position": turn}, rows[-1] | {"slave.position": 0.0}]

    def _row(self, time: float, snapshot: Snapshot, offset: float) -> dict[str, float]:
        motion = self.sections[max(bisect_right(self.section_begins, time + offset) - 1, 0)].at(time)
        position = self.sections[max(bisect_right(self.section_begins, time) - 1, 0)].at(time).position
        master = Motion(position, motion.velocity, motion.acceleration)
        s, v, a, j = _slave(snapshot, time, master)
        row = {
            "slave.position": self._wrapped(s),
            "local.unwrapped_position": s,
            "slave.velocity": v,
            "slave.acceleration": a,
            "slave.jerk": j,
            "state": snapshot.state,
            "state_code": snapshot.state,
            **_material(snapshot, master),
            **self._limits(snapshot, master.velocity),
            **self._warnings(snapshot, master.velocity, time > 0),
            **_peaks(snapshot, master.velocity),
        }
        return {"time": time, "clock": time, **snapshot.outputs, **{name: float(x) + 0.0 for name, x in row.items()}}

    def _wrapped(self, position: Number) -> float:
        """Within a turn; 0 where rounding gives the turn."""
        wrapped = float(position % self.knife.turn)
        return 0.0 if wrapped == self.knife.turn else wrapped

    def _limits(self, snapshot: Snapshot, v: Number) -> dict[str, Number]:
        """What depends on the line's present velocity."""
        window = snapshot.window
        around = window.before + window.after
        longest = longest_turning(self.knife, window, window) + around
        way = shortest_way(self.knife, window, v) if v > 0 else None
        shortest = way + around if way is not None else mp.mpf(NO_LENGTH)
        pitch = snapshot.piece.pitch if snapshot.piece else inf
        return {
            "limits.max_length": snapshot.f * longest - snapshot.allowance,
            "limits.min_length": _length(snapshot, shortest) if v > 0 else ZERO,
            "limits.cycle_time": shortest / v if v > 0 else ZERO,
            "limits.reserve": 1 - shortest / pitch if v > 0 else mp.mpf(1),
            "limits.min_sensor_distance": self._sensor_distance(snapshot, v),
        }

    def _sensor_distance(self, snapshot: Snapshot, v: Number) -> Number:
        ramp = self.knife.ramp_up(Cut(snapshot.window, ZERO, ZERO))
        travel = ramp.width + snapshot.window.before + max(v, ZERO) * snapshot.mark_delay
        return snapshot.f * travel

    def _warnings(self, snapshot: Snapshot, v: Number, has_stepped: bool) -> dict[str, bool]:
        """What warns of the line's present velocity; before the first step nothing does."""
        window = snapshot.window
        slope = max(window.extremes(travel)[0] for travel in (-window.before, window.after))
        return {
            "warning.line_too_fast": has_stepped and v > snapshot.max_velocity,
            "warning.orders_too_fast": has_stepped and v > snapshot.max_velocity_orders,
            "warning.velocity": has_stepped and slope * v > self.knife.velocity,
        }


def _length(snapshot: Snapshot, pitch: Number) -> Number:
    """Of a piece with that pitch."""
    if pitch >= NO_LENGTH:
        return pitch
    return max(snapshot.f * pitch - snapshot.allowance, ZERO)


def _slave(snapshot: Snapshot, time: float, master: Motion) -> tuple[Number, Number, Number, Number]:
    """Position, velocity, acceleration and jerk; over the master by the chain rule, with the master's jerk as 0."""
    if isinstance(snapshot.law, TimedMotion):
        return snapshot.law.at(time)
    s, slope, curvature, third = snapshot.law.at(master.position)
    v, a = master.velocity, master.acceleration
    return s, slope * v, curvature * v**2 + slope * a, third * v**3 + 3 * curvature * v * a


def _material(snapshot: Snapshot, master: Motion) -> dict[str, Number]:
    """The outputs of the piece in progress and of its cut."""
    distance = length = ZERO
    if snapshot.sync_place is not None and snapshot.sync_place < mp.inf:
        distance = snapshot.sync_place - master.position
    if snapshot.is_running:
        f, kerf, correction = snapshot.material
        length = max(f * (master.position - snapshot.origin) - kerf - correction, ZERO)
    return {"next_cut.distance": distance, "piece.length": length}


def _peaks(snapshot: Snapshot, v: Number) -> dict[str, Number]:
    names = ("velocity", "acceleration", "jerk")
    return {
        f"peaks.{name}": extreme * abs(v) ** order
        for order, (name, extreme) in enumerate(zip(names, snapshot.extremes, strict=True), start=1)
    }
