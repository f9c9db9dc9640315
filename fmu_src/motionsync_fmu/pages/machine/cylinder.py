"""The machine of a cylinder with blades that turns above moving material.

A place on the material at m is ratio (master - m) beyond the lowest point of the blades' circle.
"""

from typing import Any

import numpy as np

from ...scenario.evaluate.find_pieces import find_pieces
from ...scenario.evaluate.time_series import slave_positions
from .pieces import next_cut, pieces_drawn
from .run import Run


def cylinder(run: Run, picture: dict[str, Any]) -> dict[str, Any]:
    """The cylinder and its window of sync, and the material with its pieces."""
    names = run.scenario.recipe.piece_variables
    assert names
    turn, circumference = run.start(picture["turn"]), run.start(picture["circumference"])
    blades = int(run.start(picture["blades"]))
    ratio = run.start(names.factors[0])
    pieces = find_pieces(run.scenario, run.recording)
    edge = np.abs(run.values("slave.velocity")).max() * circumference / turn
    return run.axes(slave_positions(run.scenario, run.recording), turn) | {
        "scene": "cylinder",
        "turn": turn,
        "circumference": circumference,
        "blades": blades,
        "park": run.start(picture["park"]) or 0.5 * turn / blades,
        "ratio": ratio,
        "sync": {name: run.signal(picture[name]) for name in ("before", "after", "overspeed")},
        "along_material": run.starts_as(picture["along_material"]),
        "in_sync": run.shown(picture["in_sync"]),
        "fastest": float(max(edge, np.abs(ratio * run.recording.master[:, 1]).max())),
        "marks": {"next": next_cut(run, picture, pieces), "shown": run.held(picture["next_cut_shown"])},
        "cuts": [{"begin": p.sync, "end": p.sync, "place": p.end, "mark": p.end} for p in pieces],
        **pieces_drawn(run, names, pieces),
    }
