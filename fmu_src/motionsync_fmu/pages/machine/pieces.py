"""The pieces of a run and its next cut, for the scenes of machines that cut material."""

from typing import Any

import numpy as np

from ...interface.roles import PieceVariables
from ...scenario.evaluate.find_pieces import Piece
from .run import Run
from .signals import Signal, held

DRAWN = ("number", "begin", "end", "kind", "name", "length")  # what is drawn of a piece


def pieces_drawn(run: Run, names: PieceVariables, pieces: list[Piece]) -> dict[str, Any]:
    """The pieces, and the velocity that the block asks the line for."""
    return {
        "pieces": [{name: getattr(piece, name) for name in DRAWN} for piece in pieces],
        "request": run.held(names.request),
    }


def next_cut(run: Run, picture: dict[str, Any], pieces: list[Piece]) -> Signal:
    """Where on the material the next cut is due: in the turn in which it is made, or else in that of the master."""
    time, places = run.recording.time, run.values(picture["next_cut"])
    if period := run.scenario.period:
        ends = np.array([piece.end for piece in pieces] + [np.nan])
        near = ends[np.searchsorted([piece.reported_at for piece in pieces], time, side="right")]
        near = np.where(np.isnan(near), run.recording.master[:, 0], near)
        places = places + period * np.round((near - places) / period)
    return held(time, np.where(run.values(picture["next_cut_shown"]) != 0.0, places, 0.0))
