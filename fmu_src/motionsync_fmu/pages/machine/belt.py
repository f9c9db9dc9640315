"""The machine of a carriage over moving material: a saw, or a gripper that meets products.

What is on the material at m passes the slave's position ratio (master - m). The slave that keeps this position works
on the material there.
"""

from typing import Any

import numpy as np

from motionsync.var import Role

from ...interface.roles import find_by_role
from ...scenario.evaluate.cuts import Cut, find_cuts
from ...scenario.evaluate.find_pieces import Piece, coupling_factor, find_pieces
from ...scenario.recording import Reals
from ..numbers import rounded
from .pieces import next_cut, pieces_drawn
from .run import Run
from .signals import DIGITS, held

MARGIN = 0.14  # of the carriage's range, beside it at both ends
OUTFEED = 0.7  # of the carriage's range, the most that is shown of the pieces that have been cut off
REACH = 1.0  # of the carriage's range, in which an end position is worth showing
LEAST = 1e-3  # of the master's travel: the least range, for a carriage at rest


def belt(run: Run, picture: dict[str, Any]) -> dict[str, Any]:
    """The material with its marks, cuts and pieces, and the carriage over it."""
    spec, positions = run.scenario.cuts, run.values("slave.position")
    names = run.scenario.recipe.piece_variables
    pieces = find_pieces(run.scenario, run.recording)
    pitches = [piece.end - piece.begin for piece in pieces]
    down = run.values(spec.name) != 0.0 if spec else run.where(picture["down"])
    length = spec.length if spec else float(np.median(pitches)) if pitches else 0.0
    ratio = _ratio(run, picture)
    carriage = _carriage(run, down, ratio, length)
    data = carriage | {
        "tool": picture["tool"],
        "marks": _marks(run, picture, pieces, carriage["span"]),
        "cuts": [{"begin": c.begin, "end": c.end, "place": c.mark + c.error, "mark": c.mark} for c in _cuts(run)],
        "home": _home(run, picture),
        "zone": [run.start(name) for name in picture["zone"]]
        if "zone" in picture
        else _zone(positions, run.where(picture["in_sync"]) if "in_sync" in picture else down),
    }
    if not names:
        return data
    cuts = [(*(piece.cut or (piece.reported_at, piece.reported_at)), piece.end) for piece in pieces]
    return data | {
        "cuts": [{"begin": begin, "end": end, "place": place, "mark": place} for begin, end, place in cuts],
        **pieces_drawn(run, names, pieces),
    }


def _cuts(run: Run) -> list[Cut]:
    return find_cuts(run.scenario.cuts, run.recording, run.scenario.slave_period) if run.scenario.cuts else []


def _ratio(run: Run, picture: dict[str, Any]) -> float:
    """The slave's travel over the master's: that of the marks, of the pieces, or of the block's first coupling."""
    if run.scenario.cuts:
        return run.scenario.cuts.ratio
    if "ratio" not in picture:
        return coupling_factor(run.scenario, run.recording)
    if run.scenario.recipe.variables[picture["ratio"]].settable:
        return run.start(picture["ratio"])
    return next((float(x) for x in run.values(picture["ratio"]) if x), 1.0)


def _home(run: Run, picture: dict[str, Any]) -> dict[str, Any]:
    if "home_used" in picture and not run.values(picture["home_used"]).any():
        return {"at": float(run.values("slave.position")[0]), "label": "start"}
    return {"at": run.start(picture["home"]), "label": picture.get("home_label", "home")}


def _marks(run: Run, picture: dict[str, Any], pieces: list[Piece], span: float) -> dict[str, Any] | None:
    """The marks of the scenario, the block's next cut, or where the products are."""
    if run.scenario.cuts:
        return {"offset": run.scenario.cuts.offset, "length": run.scenario.cuts.length}
    if "next_cut" in picture:
        return {"next": next_cut(run, picture, pieces), "shown": run.held(picture["next_cut_shown"])}
    return {"places": _products(run, picture, span)} if "product_distance" in picture else None


def _products(run: Run, picture: dict[str, Any], span: float) -> list[float]:
    """Where the products are: the slave meets each at the beginning of its zone, where the block has the master."""
    missing, true = run.values(picture["product_distance"]), run.recording.master[:, 0]
    off, period = run.values("master.smoothed_position") - true, run.scenario.period
    taken = true + (off - period * np.round(off / period) if period else off)
    meetings = (taken + missing)[missing > 0.0]
    places = np.unique(np.round(meetings, 6)) - run.start(picture["zone"][0]) / run.start(picture["ratio"])
    return rounded(places[np.diff(places, prepend=-np.inf) > 1e-6 * span], DIGITS)


def _carriage(run: Run, down: Any, ratio: float, length: float = 0.0) -> dict[str, Any]:
    """The carriage and its window, `length` being that of the pieces that are cut, in units of the master."""
    positions, master = run.values("slave.position"), run.recording.master[:, 0]
    low, high = float(positions.min()), float(positions.max())
    travel = float(np.ptp(master))
    reach = max(high - low, LEAST * travel, 1e-6 * max(abs(low), abs(high), 1.0))
    places = [_end(run, Role.MIN_POSITION), _end(run, Role.MAX_POSITION)]
    if high - low < LEAST * travel and (stroke := max(abs(end - low) for end in places)) < travel:
        reach = stroke  # the carriage is at rest: there is no other length to show
    ends = [end if abs(end - near) <= REACH * reach else None for end, near in zip(places, (low, high), strict=True)]
    low = min(low, *(e for e in ends if e is not None), high - reach)
    high = max(high, *(e for e in ends if e is not None), low + reach)
    margin = MARGIN * (high - low)
    outfeed = min(abs(ratio) * length, OUTFEED * (high - low))
    flows_down = ratio * (master[-1] - master[0]) < 0.0
    window = [low - margin - outfeed * flows_down, high + margin + outfeed * (not flows_down)]
    return run.axes(positions, window[1] - window[0]) | {
        "scene": "belt",
        "ratio": ratio,
        "window": window,
        "ends": ends,
        "down": held(run.recording.time, down.astype(float)),
        "fastest": float(
            max(np.abs(run.values("slave.velocity")).max(), np.abs(ratio * run.recording.master[:, 1]).max())
        ),
    }


def _end(run: Run, role: Role) -> float:
    """An end position; infinite for a block that has none."""
    variable = find_by_role(run.scenario.recipe.variables.values(), role)
    return run.start(variable.name) if variable else np.inf


def _zone(positions: Reals, down: Any) -> list[float] | None:
    """Where the carriage is while the tool is down."""
    return [float(positions[down].min()), float(positions[down].max())] if np.any(down) else None
