"""The machines of two axes that may be coupled: a disc for each rotary axis, a rail for each linear one."""

from typing import Any

import numpy as np

from ...scenario.recording import Reals
from .run import Run
from .signals import held, unwrapped

FREE, CHANGING, COUPLED = 0.0, 1.0, 2.0
ROOM = 0.06  # of a linear axis' range, beside it at both ends


def synchronizer(run: Run) -> dict[str, Any]:
    """Master and slave, the ramp on the master, the rest position on the slave."""
    period = run.start("master.period")
    moving = run.values("syn_ramp_on") != 0.0
    coupling = np.where(run.values("syn_synchronized") != 0.0, COUPLED, np.where(moving, CHANGING, FREE))
    waiting = run.is_member("state", "EXECUTING", "STACKED")
    shown = held(run.recording.time, (waiting | moving).astype(float))
    ramp = {"label": "ramp", "from": run.held("local.ramp_begin"), "to": run.held("local.ramp_end"), "shown": shown}
    rest = {"label": "rest", "at": run.setting("rest_value")}
    return _axes(run, (period, period), coupling, ([ramp], [rest]))


def gearing(run: Run) -> dict[str, Any]:
    """Master and slave, and on the master the place that triggers the transition."""
    changing = run.is_member("state", "GEAR_IN", "GEAR_OUT")
    on_line = run.is_member("state", "ACTIVE", "WAITING_FOR_STOPPOSITION")
    waiting = run.is_member("state", "WAITING_FOR_STARTPOSITION", "WAITING_FOR_STOPPOSITION")
    shown = held(run.recording.time, (waiting | changing).astype(float))
    trigger = {"label": "trigger", "at": run.held("local.trigger_position"), "shown": shown}
    coupling = np.where(on_line, COUPLED, np.where(changing, CHANGING, FREE))
    return _axes(run, (run.start("master.period"), run.start("slave.period")), coupling, ([trigger], []))


def follower(run: Run) -> dict[str, Any]:
    """A Follower whose slave is cyclic: its park, and the arc in which it runs with the master."""
    changing = run.is_member("state", "M_FOLLOWING", "M_HOMING")
    coupling = np.where(run.is_member("state", "M_SYNCHRONIZED"), COUPLED, np.where(changing, CHANGING, FREE))
    meeting = {"label": "meeting", "at": run.held("local.meeting_position"), "shown": run.held("local.meeting_known")}
    arc = {"label": "in sync", "from": run.setting("sync_slave"), "to": run.setting("sync_out")}
    park = {"label": "park", "at": run.setting("park_slave")}
    cycle = run.start("master.period") or (0.0 if run.start("variable_cycle") else run.start("master_cycle"))
    return _axes(run, (cycle, run.start("slave_cycle")), coupling, ([meeting], [arc, park]))


def _axes(
    run: Run, periods: tuple[float, float], coupling: Reals, marks: tuple[list[dict[str, Any]], list[dict[str, Any]]]
) -> dict[str, Any]:
    positions = unwrapped(run.values("slave.position"), periods[1])
    ranges = _range(run.recording.master[:, 0]), _range(positions)
    if not any(periods) and _alike(*ranges):
        ranges = ((min(r[0] for r in ranges), max(r[1] for r in ranges)),) * 2
    named = zip(("master", "slave"), (run.unit, run.slave_unit), periods, ranges, marks, strict=True)
    span = periods[1] or ranges[1][1] - ranges[1][0]
    return run.axes(positions, span) | {
        "scene": "axes",
        "axes": [{"name": n, "unit": u, "period": p, "range": r, "marks": m} for n, u, p, r, m in named],
        "coupling": held(run.recording.time, coupling),
    }


def _range(positions: Reals) -> tuple[float, float]:
    low, high = float(positions.min()), float(positions.max())
    room = max(ROOM * (high - low), 1e-6 * max(abs(low), abs(high), 1.0))
    return low - room, high + room


def _alike(first: tuple[float, float], second: tuple[float, float]) -> bool:
    """Whether two ranges can be drawn in one scale."""
    lengths = [high - low for low, high in (first, second)]
    together = max(first[1], second[1]) - min(first[0], second[0])
    return together < 3.0 * min(lengths)
