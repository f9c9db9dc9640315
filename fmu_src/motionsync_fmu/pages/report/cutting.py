"""The cuts of a saw over time: the saw among the marks that pass it, and how far each cut is from its mark."""

from typing import Any

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.amounts import ROUNDING, engineering
from ...scenario.cuts import CutSpec, Passage, passages, reach
from ...scenario.figures import Figures
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, rounded
from ..style import typeset
from .chart import BAD, LIMIT, MASTER, OK, SLAVE, Chart, Style
from .motion import NEAR, bounds, draw_bound

MOST_MARKS = 1000  # lines of marks; more could not be told apart
FAR = 100.0  # the tolerance is drawn unless it is so many times the greatest error


def cut_chart(spec: CutSpec, scenario: Scenario, recording: Recording, found: Figures, kept: Indices = NONE) -> Chart:
    """The saw among the marks that pass it, seen from the machine; below, the error of each cut."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    chart = Chart(
        "The saw among the passing marks, and the error of each cut", [330, 130], "time in s", (0.0, scenario.stop_time)
    )
    chart.head(1, f"saw and marks{f' in {typeset(unit)}' if unit else ''}")
    chart.shade(chart.behind(1), "cut", [(c.begin, c.end) for c in found.cuts], "--cut")
    _draw_marks(chart, spec, recording, found, unit)
    saw = recording.values["slave.position"]
    chart.curve(1, "saw", recording.time, saw, Style(SLAVE, 2.5), unit=unit, kept=kept)
    chart.rescale(1)
    low, high = float(saw.min()), float(saw.max())
    middle, room = 0.5 * (low + high), NEAR * (high - low)
    for bound in bounds(scenario, found):
        if bound.row == 1 and abs(bound.value - middle) <= room:
            draw_bound(chart, bound, unit)
    _draw_errors(chart, found, unit)
    return chart


def _draw_errors(chart: Chart, found: Figures, unit: str) -> None:
    """Draw the error of each cut, and how great it may be; errors that are rounding are not drawn large."""
    chart.head(2, f"error of the cut{f' in {typeset(unit)}' if unit else ''}")
    if not found.cuts:
        chart.note("no cut", yref="y2 domain", x=0.5, y=0.5)
        chart.axis(2)["range"] = [-1.0, 1.0]
        return
    numbers = [
        [i, engineering(c.mark, unit), engineering(c.error, unit, scale=found.scale)]
        for i, c in enumerate(found.cuts, 1)
    ]
    tolerance = found.tolerance or 0.0
    trace = {
        "type": "scatter",
        "mode": "markers",
        "x": rounded((c.end for c in found.cuts), TIME_DIGITS),
        "y": rounded(c.error for c in found.cuts),
        "customdata": numbers,
        "marker": {"size": 8, "color": [BAD if abs(c.error) > tolerance else OK for c in found.cuts]},
        "hovertemplate": "%{customdata[2]}<extra>cut %{customdata[0]}, mark %{customdata[1]}</extra>",
    }
    chart.add(2, "error of a cut", trace, legend=False)
    worst = max(abs(c.error) for c in found.cuts)
    rounding = worst <= ROUNDING * found.scale
    if rounding or tolerance < FAR * worst:
        for limit in (-tolerance, tolerance):
            line = {"x": list(chart.span), "y": [limit] * 2, "line": {"color": LIMIT, "width": 1.2, "dash": "dot"}}
            chart.add(2, "tolerance", {"type": "scatter", "mode": "lines", "hoverinfo": "skip"} | line)
        chart.note(
            f"tolerance {engineering(tolerance, unit)}",
            x=1,
            xanchor="right",
            y=tolerance,
            yref="y2",
            yanchor="top",
            font={"size": 10, "color": LIMIT},
        )
    if rounding:
        chart.axis(2)["range"] = [-1.3 * tolerance, 1.3 * tolerance]
        chart.note(f"0 to rounding: at most {engineering(worst, unit)}", yref="y2 domain", x=0.5, y=0.8)
    else:
        chart.axis(2)["rangemode"] = "tozero"


def _draw_marks(chart: Chart, spec: CutSpec, recording: Recording, found: Figures, unit: str) -> None:
    """Draw where each mark is while it passes the range of the saw; those that nobody cut stand out."""
    passing = list(passages(spec, recording, *reach(spec, recording)))
    if len(passing) > MOST_MARKS:
        chart.note(f"{len(passing)} marks pass: too many to draw", yref="y domain", x=0.5, y=0.97, yanchor="top")
        return
    uncut = {round((place - spec.offset) / spec.length) for place in found.uncut}
    looks = (("marks on the material", MASTER, 1.0, "solid"), ("marks that passed uncut", BAD, 1.6, "dot"))
    for missed, (name, colour, width, dash) in enumerate(looks):
        chosen = [p for p in passing if (p.number in uncut) == bool(missed)]
        if chosen:
            line = {"color": colour, "width": width, "dash": dash}
            said = f"%{{y:.6~g}} {unit}<extra>mark %{{customdata:.10~g}} {unit}</extra>"
            chart.add(1, name, _together(chosen, len(passing)) | {"line": line, "hovertemplate": said})


def _together(chosen: list[Passage], number: int) -> dict[str, Any]:
    """Passages as one line with gaps; the more passages there are, the fewer points each has."""
    most = max(2, 2 * BUCKETS // number)
    parts = [np.unique(np.linspace(0, len(p.time) - 1, min(len(p.time), most)).round().astype(int)) for p in chosen]
    gap = [np.nan]
    x = np.concatenate([part for p, at in zip(chosen, parts, strict=True) for part in (p.time[at], gap)])
    y = np.concatenate([part for p, at in zip(chosen, parts, strict=True) for part in (p.position[at], gap)])
    places = [place for p, at in zip(chosen, parts, strict=True) for place in rounded([p.place], 10) * (len(at) + 1)]
    xs, ys = rounded(x, TIME_DIGITS), rounded(y)
    return {"type": "scatter", "mode": "lines", "x": xs, "y": ys, "customdata": places}
