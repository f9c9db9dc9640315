"""A recording in few bytes, for the picture of its machine; and what this picture has to know of a block.

All that is drawn is made of it in the browser, by machine_data.js, as on a page that runs the block itself.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.var import Role

from ...interface.roles import find_by_role
from ...scenario.evaluate.remote_errors import remote_errors
from ...scenario.evaluate.time_series import time_series
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from .block_json import block_json, plain_values, units_of, variable_json
from .description import named_in

MOST_POINTS = 50_000  # of a recording; of more of them only every n-th remains, and those at which something switches
DIGITS = 12  # of the greatest value of a column
LEAST = 1e-9  # the greatest value that has so many digits at least
TICKS = 1e9  # of a second, to which times are rounded
ALWAYS = ("state", "slave.position", "slave.velocity", "master.smoothed_position")  # of those that the block has
PIECES = (
    *("pieces", "length", "kind", "time", "running", "cutting", "coupling_factor", "cut_spacing", "edge_radius"),
    *("kerf", "correction", "request"),
)
"""The variables by which pieces are found and drawn, as PieceVariables has them, beside the factors."""

ERRORS = ("index", "corrected_index", "position", "corrected_position")  # of a remote axis


def recorded_machine(scenario: Scenario, recording: Recording) -> dict[str, Any] | None:
    """What machine_data.js makes the picture of a run from, as JSON has it; None for a block without a picture."""
    block, cuts = block_json(scenario.recipe, [scenario]), scenario.cuts
    if not (block["pictures"] or scenario.remote):
        return None
    names = _needed(scenario, block["pictures"])
    marks = {"while": cuts.name, "length": cuts.length, "offset": cuts.offset, "ratio": cuts.ratio} if cuts else {}
    return {
        "block": block | {"variables": [variable_json(scenario.recipe.variables[name]) for name in names]},
        "scenario": {
            "units": units_of(scenario),
            "start": plain_values(scenario.start),
            "remote": bool(scenario.remote),
            "cuts": marks,
        },
        "columns": _columns(scenario, recording, names),
    }


def _needed(scenario: Scenario, pictures: list[dict[str, Any]]) -> list[str]:
    """The names of the variables from which the picture is made."""
    by_name, pieces = scenario.recipe.variables, scenario.recipe.piece_variables
    ends = (find_by_role(by_name.values(), role) for role in (Role.MIN_POSITION, Role.MAX_POSITION))
    names = {*ALWAYS, *(v.name for v in ends if v), *(name for picture in pictures for name in named_in(picture))}
    if pieces:
        names |= {*pieces.factors, *(getattr(pieces, role) for role in PIECES)} - {""}
    if scenario.cuts:
        names.add(scenario.cuts.name)
    return sorted(name for name in names if name in by_name)


def _columns(scenario: Scenario, recording: Recording, names: list[str]) -> dict[str, Any]:
    """The columns of a recording at the points that remain: `time`; `axes`, the position and the velocity of the
    master; `values`, the variables by name; of a remote axis also its `errors`, at all points but the first."""
    values = {name: time_series(scenario, recording, name) for name in names}
    switches = [x for name, x in values.items() if scenario.recipe.variables[name].kind != "Real"]
    points = _retained(len(recording.time), switches)
    errors = remote_errors(scenario.remote, recording) if scenario.remote else None
    return {
        "time": _steps(np.rint(recording.time[points] * TICKS), TICKS),
        "axes": [_packed(recording.master[points, order]) for order in (0, 1)],
        "values": {name: _packed(column[points]) for name, column in values.items()},
        "errors": {name: _packed(getattr(errors, name)[points[1:] - 1]) for name in ERRORS} if errors else None,
    }


def _retained(count: int, switches: list[Reals]) -> NDArray[np.intp]:
    """The indices of the points that remain: see MOST_POINTS."""
    retained = np.arange(count) % (1 + count // MOST_POINTS) == 0
    retained[-1] = True
    for values in switches:
        changes = np.flatnonzero(np.diff(values))
        retained[changes] = retained[changes + 1] = True
    return np.flatnonzero(retained)


def _packed(values: Reals) -> dict[str, Any]:
    """A column, rounded to DIGITS."""
    greatest = max(float(np.abs(values).max(initial=0.0)), LEAST)
    scale = 10.0 ** (DIGITS - 1 - math.floor(math.log10(greatest)))
    return _steps(np.rint(values * scale), scale)


def _steps(whole: Reals, scale: float) -> dict[str, Any]:
    """Whole numbers, each as the step from the one before, which deflate makes small; `scale` of them are a unit."""
    return {"scale": scale, "steps": np.diff(whole.astype(np.int64), prepend=0).tolist()}
