"""Reference for the CutToLength: the machine's true behaviour on the continuous time axis.

The sequence is simulated from event to event (`cut_to_length_sequence`, which lists the readings of the specification
that it takes, as `piece_machine` and `piece_records` do); a row is computed from what holds at its time.

A row is what the step that ends at its time puts out: what is set at that time does not show yet. Steps end at the
multiples of the scenario's `step_size` and where something is set, expected, or the master's script breaks; that
matters where the specification notices something at a step's beginning.

Further readings:
- `next_cut.distance` is below 0 where the machine waits although its cut has been passed.
- `piece.length` is 0 while the machine does not run. While no piece is fixed, it takes f, b and Δ as they are set.
- `limits.reserve` is 1 while no pitch is fixed.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from math import floor, inf
from typing import Any

from tests.oracle.cut_to_length.carriage import MasterSection
from tests.oracle.cut_to_length.sequence import MachineRun
from tests.oracle.cut_to_length.state import APPROACHING, CUTTING, SAW_COMMANDS, SYNCHRONOUS, Snapshot
from tests.oracle.cutting.ranges import PIECE_DEFAULTS
from tests.oracle.cutting.rows import WINDOW, Rows, as_number, step_ends
from tests.oracle.latest_runs import run_of
from tests.oracle.master import stretches
from tests.oracle.numerics import mp
from tests.oracle.sets import gathered
from tests.oracle.timed_motion import Motion

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "state_code",
    "error_id",
    "running",
    "in_sync",
    "tool.command",
    "tool.command_time",
    "next_cut.position",
    "next_cut.distance",
    "piece.length",
    "piece.ordered",
    "piece.kind",
    "last.length",
    "last.error",
    "last.good",
    "last.time",
    "last.reserve",
    "order.waiting",
    "order.remaining",
    "limits.max_line_velocity",
    "limits.max_line_velocity_orders",
    "limits.min_length",
    "limits.reserve",
    "limits.cycle_time",
    "limits.stroke",
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
    "axis.max_velocity": 2000.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 0.0,
    "axis.max_jerk": 100000.0,
    "home_position": 0.0,
    "approach.distance": 0.0,
    "approach.reserve": 0.02,
    "approach.acceleration": 0.0,
    "approach.jerk": 0.0,
    "homing.velocity": 0.0,
    "homing.acceleration": 0.0,
    "homing.deceleration": 0.0,
    "homing.jerk": 0.0,
    "homing.settle_time": 0.0,
    "homing.ease": False,
    "homing.spare_time": 0.02,
    "homing.slowest": 0.05,
    "tool.settle_time": 0.0,
    "tool.on_delay": 0.0,
    "tool.cut_time": 0.25,
    "tool.cut_distance": 100.0,
    "tool.retract_time": 0.0,
    "tool.timeout": 0.0,
    "gap.distance": 0.0,
    "gap.travel": 100.0,
    **dict.fromkeys(SAW_COMMANDS, False),
}
"""What may be set while the block runs, with the start values."""

FIXED: dict[str, Any] = {
    "auto_start": False,
    "axis.initial_position": 0.0,
    "axis.min_position": -1e9,
    "axis.max_position": 1e9,
    "diagonal_angle": 0.0,
    "source": 1,
    "tool.mode": 1,
    "mark.latched": True,
    "master.period": 0.0,
}
"""What holds for a whole run."""


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
    """What happens until `stop_time`: (time, name) of start, turned back, sync, cut, home, fault, in order.

    Raises ValueError for a set at or before 0 and for a set of something that is neither an input nor tunable.
    """
    return list(run_of(_run, script, float(script["stop_time"]))[1].log)


def _run(script: Mapping[str, Any], horizon: float) -> tuple[list[MasterSection], MachineRun]:
    start = script.get("start", {})
    inputs = {name: start.get(name, default) for name, default in (DEFAULTS | FIXED).items()}
    period = float(inputs["master.period"])
    parts = stretches(script["master"], mp.mpf(horizon))[1:]
    position = float(parts[0].start.position)
    shift = -floor(position / period) * period if period > 0 else 0.0
    sections = [MasterSection.of(part, shift) for part in parts]
    sets = gathered(script.get("set", ()), DEFAULTS, as_number)
    initial = float(inputs["axis.initial_position"])
    return sections, MachineRun(inputs, sections, step_ends(script), sets, period, initial)


class _Rows(Rows[Snapshot]):
    """The outputs of a run at any time."""

    def __init__(self, sections: Sequence[MasterSection], machine: MachineRun) -> None:
        super().__init__(machine.snapshots)
        self.sections = sections
        self.section_begins = [section.begin for section in sections]

    def _row(self, time: float, snapshot: Snapshot, offset: float) -> dict[str, float]:
        """The outputs at `time` with the master's velocity just before or after it."""
        motion = self.sections[max(bisect_right(self.section_begins, time + offset) - 1, 0)].at(time)
        position = self.sections[max(bisect_right(self.section_begins, time) - 1, 0)].at(time).position
        master = Motion(position, motion.velocity, motion.acceleration)
        s, v, a, j = snapshot.law.at(time, master)
        return {
            "time": time,
            "clock": time,
            "slave.position": s + 0.0,
            "slave.velocity": v + 0.0,
            "slave.acceleration": a + 0.0,
            "slave.jerk": j + 0.0,
            "state": float(snapshot.state),
            "state_code": float(snapshot.state),
            **snapshot.outputs,
            **_material(snapshot, master, s),
            **self._limits(snapshot, master),
            **self._warnings(snapshot, master, time > 0),
        }

    def _limits(self, snapshot: Snapshot, master: Motion) -> dict[str, float]:
        """What depends on the line's present velocity."""
        saw, v, piece = snapshot.saw, master.velocity, snapshot.piece
        cycle = saw.cycle_time(v)
        pitch = piece.pitch if piece else inf
        kerf, correction = snapshot.material
        approach_distance = saw.approach_distance(v)
        sensor = saw.f * ((approach_distance - saw.home) / saw.k + max(v, 0.0) * snapshot.mark_delay)
        return {
            "limits.cycle_time": cycle,
            "limits.min_length": max(saw.f * v * cycle - kerf - correction, 0.0) if v > 0 else 0.0,
            "limits.reserve": 1 - cycle * v / pitch,
            "limits.stroke": saw.stroke(v),
            "limits.min_sensor_distance": max(sensor, 0.0),
            "local.approach_distance": approach_distance,
        }

    def _warnings(self, snapshot: Snapshot, master: Motion, has_stepped: bool) -> dict[str, float]:
        """What warns of the line's present velocity; before the first step nothing does."""
        saw, v = snapshot.saw, master.velocity
        return {
            "warning.line_too_fast": float(has_stepped and v > snapshot.max_velocity),
            "warning.orders_too_fast": float(has_stepped and v > snapshot.max_velocity_orders),
            "warning.stroke": float(has_stepped and saw.home + saw.stroke(v) > saw.high),
            "warning.velocity": float(has_stepped and saw.k * v > saw.axis[0]),
        }


def _material(snapshot: Snapshot, master: Motion, slave: float) -> dict[str, float]:
    """The outputs of the piece in progress and of its cut."""
    piece, distance, length = snapshot.piece, 0.0, 0.0
    if snapshot.is_running and piece is not None and snapshot.state not in (SYNCHRONOUS, CUTTING):
        saw = snapshot.saw
        position = snapshot.sync_position / snapshot.cycle.k
        if snapshot.state != APPROACHING:
            position = (saw.home + saw.approach_distance(master.velocity)) / saw.k
        distance = position - (master.position - piece.cut_position)
    if snapshot.is_running:
        f, (kerf, correction) = snapshot.saw.f, snapshot.material
        if piece is not None:
            f, kerf, correction = piece.f, piece.kerf, piece.correction
        length = max(f * (master.position - slave / snapshot.cycle.k - snapshot.origin) - kerf - correction, 0.0)
    return {"next_cut.distance": distance, "piece.length": length}
