"""The machines with moving material and a carriage beside it: a FlyingSaw, a CutToLength, and a Follower whose slave is
linear.

What lies on the material at m passes the slave's position ratio (master - m). The slave that keeps this position works
on the material there.
"""

from typing import Any

import numpy as np

from motionsync.var import Role

from ...interface.roles import with_role
from ...scenario.cuts import find_cuts
from ...scenario.pieces import Piece, coupling_factor, find_pieces
from ...scenario.recording import Reals
from ..numbers import rounded
from .run import Run
from .signals import DIGITS, Signal, held

ROOM = 0.14  # of the carriage's range, beside it at both ends
OUTFEED = 0.7  # of the carriage's range, the most that is shown of the pieces that have been cut off
REACH = 1.0  # of the carriage's range, in which an end position is worth showing
LEAST = 1e-3  # of the master's travel: the least range, for a carriage that stands


def flying_saw(run: Run) -> dict[str, Any]:
    """A saw, down while the Boolean of the table [cuts] is true, or while it is in sync."""
    spec = run.scenario.cuts
    down = run.values(spec.name if spec else "in_sync") != 0.0
    factors = run.values("coupling_factor")
    coupled = factors[factors != 0.0]
    cuts = find_cuts(spec, run.recording) if spec else []
    homed = bool(np.any(run.values("move_absolute.busy")))
    home = run.start("move_absolute.position") if homed else float(run.values("slave.position")[0])
    ratio = spec.ratio if spec else float(coupled[0]) if len(coupled) else 1.0
    return _belt(run, down, ratio, spec.length if spec else 0.0) | {
        "tool": "saw",
        "marks": {"offset": spec.offset, "length": spec.length} if spec else None,
        "cuts": [{"begin": c.begin, "end": c.end, "place": c.mark + c.error, "mark": c.mark} for c in cuts],
        "home": {"at": home, "label": "home" if homed else "start"},
        "zone": _zone(run.values("slave.position"), down),
    }


def cut_to_length(run: Run) -> dict[str, Any]:
    """A saw that knows its next cut alone; each piece that it has cut off has the colour of its kind."""
    pieces = find_pieces(run.scenario, run.recording)
    ratio = coupling_factor(run.scenario, run.recording)
    pitches = [piece.end - piece.begin for piece in pieces]
    drawn = ("number", "begin", "end", "kind", "name", "length")
    cuts = [(*(piece.cut or (piece.told, piece.told)), piece.end) for piece in pieces]
    belt = _belt(run, run.values("tool.blade_down") != 0.0, ratio, float(np.median(pitches)) if pitches else 0.0)
    return belt | {
        "tool": "saw",
        "marks": {"next": _next_cut(run, pieces), "known": run.held("next_cut.known")},
        "cuts": [{"begin": begin, "end": end, "place": place, "mark": place} for begin, end, place in cuts],
        "pieces": [{name: getattr(piece, name) for name in drawn} for piece in pieces],
        "request": run.held("line.velocity_request"),
        "home": {"at": run.start("home_position"), "label": "home"},
        "zone": _zone(run.values("slave.position"), run.values("in_sync") != 0.0),
    }


def _next_cut(run: Run, pieces: list[Piece]) -> Signal:
    """Where on the material the next cut is due: in the turn in which it is made, or else in that of the master."""
    time, places = run.recording.time, run.values("next_cut.position")
    if period := run.scenario.period:
        ends = np.array([piece.end for piece in pieces] + [np.nan])
        near = ends[np.searchsorted([piece.told for piece in pieces], time, side="right")]
        near = np.where(np.isnan(near), run.recording.master[:, 0], near)
        places = places + period * np.round((near - places) / period)
    return held(time, np.where(run.values("next_cut.known") != 0.0, places, 0.0))


def follower(run: Run) -> dict[str, Any]:
    """A slave that leaves its park, and runs beside the meeting from sync_slave to sync_out."""
    ratio, sync, out = (run.start(name) for name in ("k_slave_master", "sync_slave", "sync_out"))
    missing = run.values("master_to_sync")
    ahead = missing > 0.0
    meetings = run.recording.master[ahead, 0] + missing[ahead]
    places = np.unique(np.round(meetings, 6)) - sync / ratio
    belt = _belt(run, run.is_member("state", "M_SYNCHRONIZED"), ratio)
    return belt | {
        "tool": "gripper",
        "marks": {"places": rounded(places[np.diff(places, prepend=-np.inf) > 1e-6 * belt["span"]], DIGITS)},
        "cuts": [],
        "home": {"at": run.start("park_slave"), "label": "park"},
        "zone": [sync, out],
    }


def _belt(run: Run, down: Any, ratio: float, length: float = 0.0) -> dict[str, Any]:
    """The carriage and its window, `length` being that of the pieces that are cut, in units of the master."""
    positions, master = run.values("slave.position"), run.recording.master[:, 0]
    low, high = float(positions.min()), float(positions.max())
    reach = max(high - low, LEAST * float(np.ptp(master)), 1e-6 * max(abs(low), abs(high), 1.0))
    ends = [_end(run, Role.MIN_POSITION, low, reach), _end(run, Role.MAX_POSITION, high, reach)]
    low = min(low, *(e for e in ends if e is not None), high - reach)
    high = max(high, *(e for e in ends if e is not None), low + reach)
    room = ROOM * (high - low)
    outfeed = min(abs(ratio) * length, OUTFEED * (high - low))
    flows_down = ratio * (master[-1] - master[0]) < 0.0
    window = [low - room - outfeed * flows_down, high + room + outfeed * (not flows_down)]
    return run.axes(positions, window[1] - window[0]) | {
        "scene": "belt",
        "ratio": ratio,
        "window": window,
        "ends": ends,
        "down": held(run.recording.time, down.astype(float)),
        "fastest": float(np.abs(run.values("slave.velocity")).max()),
    }


def _end(run: Run, role: Role, nearest: float, reach: float) -> float | None:
    """An end position, if there is one and the carriage comes near it."""
    variable = with_role(run.scenario.recipe.variables.values(), role)
    position = run.start(variable.name) if variable else np.inf
    return position if abs(position - nearest) <= REACH * reach else None


def _zone(positions: Reals, down: Any) -> list[float] | None:
    """Where the carriage is while the tool is down."""
    return [float(positions[down].min()), float(positions[down].max())] if np.any(down) else None
