"""A run of a machine that cuts to length, made by hand: what the block would put out, without the block.

The line runs as the scenario says; the carriage goes with it from D after a cut's position to the end of the cut. The
curves in between are simple ones: the approach is that of the specification at constant velocity, the way home a
polynomial of order 5 in time.
"""

from dataclasses import dataclass, field

import numpy as np

from motionsync.cut_to_length.interface import State
from motionsync.cutting.interface import PieceKind
from motionsync_fmu.scenario.recording import Reals, Recording
from motionsync_fmu.scenario.scenario import Scenario

APPROACH = 86.60254037844386  # u: D at 1000 u/s, of a machine with 10000 u/s2 and 200000 u/s3
CUT, HOMING = 0.25, 0.6  # s


@dataclass
class HandMadeRun:
    """What is cut: the position of the material's front end, kerf, and for each piece what it is and how it comes out.

    Attributes:
        front: the centre of a cut at the front end, as a position of the master.
        pieces: kind, length and error of each piece.
        reserves: share of the cycle that was left before each cut.
        request, limit: what the block asks of the line, and the fastest that it can follow, each from a time on.
    """

    front: float
    kerf: float
    pieces: list[tuple[PieceKind, float, float]]
    reserves: list[float]
    request: list[tuple[float, float]]
    limit: list[tuple[float, float]]
    skipped_with: list[int] = field(default_factory=list)

    def cut_positions(self) -> list[float]:
        """The centres of the cuts, as positions of the master."""
        return [float(c) for c in self.front + np.cumsum([length + self.kerf for _, length, _ in self.pieces])]


def record(scenario: Scenario, run: HandMadeRun, start: float, step: float) -> Recording:
    """The recording of a run that starts at `start`, in s."""
    time = np.arange(round(scenario.stop_time / step) + 1) * step
    motions = [scenario.master.until(t) if t else scenario.master.at(t) for t in time.tolist()]
    master = np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in motions])
    by_name = scenario.recipe.variables
    values = {n: np.full(len(time), float(v.start)) for n, v in by_name.items() if not v.settable}
    values["local.coupling_factor"][:] = 1.0
    running = time > start
    values["running"] = running.astype(float)
    values["state"] = np.where(running, State.WAITING, State.OFF).astype(float)
    for name, requested_values in (("line.velocity_request", run.request), ("limits.max_line_velocity", run.limit)):
        for at, value in requested_values:
            values[name][(time >= at) & running] = value
    values["limits.reserve"] = np.clip(1.0 - master[:, 1] / np.maximum(values["limits.max_line_velocity"], 1.0), 0, 1)
    for number, cut_position in enumerate(run.cut_positions()):
        _cut(values, time, master, cut_position)
        _record_piece(values, time, master, run, number, cut_position)
    for name, source in (("velocity", "position"), ("acceleration", "velocity"), ("jerk", "acceleration")):
        values[f"slave.{name}"] = np.gradient(values[f"slave.{source}"], time)
    values["state_code"] = values["state"]
    return Recording(time, values, master, [], scenario.settings)


def _cut_end(time: Reals, master: Reals, cut_position: float) -> float:
    """When a cut ends, in s."""
    return float(np.interp(cut_position + APPROACH, master[:, 0], time)) + CUT


def _cut(values: dict[str, Reals], time: Reals, master: Reals, cut_position: float) -> None:
    """One cycle of the carriage."""
    behind = master[:, 0] - cut_position
    end = _cut_end(time, master, cut_position)
    u = (behind + APPROACH) / (2.0 * APPROACH)
    approach = (u >= 0.0) & (u < 1.0)
    sync = (u >= 1.0) & (time < end)
    back = (time >= end) & (time < end + HOMING)
    saw = values["slave.position"]
    saw[approach] = 2.0 * APPROACH * (u[approach] ** 3 - u[approach] ** 4 / 2.0)
    saw[sync] = behind[sync]
    begin, velocity = float(np.interp(end, time, behind)), float(np.interp(end, time, master[:, 1]))
    w = (time[back] - end) / HOMING
    ahead = velocity * HOMING
    saw[back] = begin + ahead * w + (-10 * begin - 6 * ahead) * w**3
    saw[back] += (15 * begin + 8 * ahead) * w**4 + (-6 * begin - 3 * ahead) * w**5
    for state, where in ((State.APPROACHING, approach), (State.CUTTING, sync), (State.RETURNING, back)):
        values["state"][where] = state
    for name in ("in_sync", "tool.command", "tool.blade_down", "tool.cutting"):
        values[name][sync] = 1.0


def _record_piece(
    values: dict[str, Reals], time: Reals, master: Reals, run: HandMadeRun, number: int, cut_position: float
) -> None:
    """What is reported from the end of a cut on, and of the piece before."""
    kind, length, error = run.pieces[number]
    end = _cut_end(time, master, cut_position)
    after = time >= end
    values["statistics.cuts"][after] += 1
    values["statistics.pieces_good"][after] += kind == PieceKind.PRODUCT and abs(error) <= 0.5
    values["statistics.skipped"][after] += number in run.skipped_with
    reported = {"length": length, "error": error, "kind": kind, "good": kind == PieceKind.PRODUCT and abs(error) <= 0.5}
    reported |= {"reserve": run.reserves[number], "time": end - CUT}
    for name, value in reported.items():
        values[f"last.{name}"][after] = value
    before = (time < end) & (values["running"] != 0.0) & (values["piece.kind"] == 0.0)
    values["piece.kind"][before], values["piece.ordered"][before] = kind, length - error
    values["next_cut.known"][before], values["next_cut.position"][before] = 1.0, cut_position
