"""The machines of two axes that may be coupled: a disc for each rotary axis, a rail for each linear one."""

from typing import Any

import numpy as np

from ...scenario.evaluate.time_series import slave_positions
from ...scenario.recording import Reals
from .run import Run
from .signals import held

FREE, CHANGING, COUPLED = 0.0, 1.0, 2.0
MARGIN = 0.06  # of a linear axis' range, beside it at both ends


def axes(run: Run, picture: dict[str, Any]) -> dict[str, Any]:
    """Master and slave, whether they are coupled, and the marks on both."""
    changing, coupled = (run.where(picture[name]) for name in ("changing", "coupled"))
    periods = run.period(picture["master_period"]), run.period(picture["slave_period"])
    marks = [[_mark(run, mark) for mark in picture.get(name, [])] for name in ("master_marks", "slave_marks")]
    positions = slave_positions(run.scenario, run.recording)
    ranges = _range(run.recording.master[:, 0]), _range(positions)
    if not any(periods) and _alike(*ranges):
        ranges = ((min(r[0] for r in ranges), max(r[1] for r in ranges)),) * 2
    named = zip(("master", "slave"), (run.unit, run.slave_unit), periods, ranges, marks, strict=True)
    span = periods[1] or ranges[1][1] - ranges[1][0]
    return run.axes(positions, span) | {
        "scene": "axes",
        "axes": [{"name": n, "unit": u, "period": p, "range": r, "marks": m} for n, u, p, r, m in named],
        "coupling": held(run.recording.time, np.where(coupled, COUPLED, np.where(changing, CHANGING, FREE))),
    }


def _mark(run: Run, mark: dict[str, Any]) -> dict[str, Any]:
    drawn = {"label": mark["label"]} | {key: run.signal(mark[key]) for key in ("at", "from", "to") if key in mark}
    return drawn | ({"shown": run.shown(mark["shown"])} if "shown" in mark else {})


def _range(positions: Reals) -> tuple[float, float]:
    low, high = float(positions.min()), float(positions.max())
    margin = max(MARGIN * (high - low), 1e-6 * max(abs(low), abs(high), 1.0))
    return low - margin, high + margin


def _alike(first: tuple[float, float], second: tuple[float, float]) -> bool:
    """Whether two ranges can be drawn in one scale."""
    lengths = [high - low for low, high in (first, second)]
    together = max(first[1], second[1]) - min(first[0], second[0])
    return together < 3.0 * min(lengths)
