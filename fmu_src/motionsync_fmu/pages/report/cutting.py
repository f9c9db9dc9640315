"""The cuts of a saw over time: the saw and the marks that pass it, and how far each cut is from its mark."""

from typing import Any

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.cutting import CutSpec
from ...scenario.engineering import ROUNDING, engineering
from ...scenario.evaluate.cuts import Passage, passages, reach
from ...scenario.evaluate.key_figures import KeyFigures
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, evenly_spaced, rounded
from ..style import with_unit
from .chart import BAD, MASTER, OK, SLAVE, Chart, Style
from .motion import NEAR, bounds, draw_bound

MOST_MARKS = 150  # lines of marks, and large markers; more could not be distinguished
FAR = 100.0  # the tolerance is drawn unless it is so many times the greatest error


def chart_cuts(
    spec: CutSpec, scenario: Scenario, recording: Recording, figures: KeyFigures, required: Indices = NONE
) -> Chart:
    """Draw the saw and the marks that pass it, seen from the machine; below, the error of each cut."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    chart = Chart(
        "The saw and the passing marks, and the error of each cut", [330, 130], "time in s", (0.0, scenario.stop_time)
    )
    chart.write_title(1, with_unit("saw and marks", unit))
    if figures.cuts:  # over an axis without a trace nothing is drawn
        chart.shade_stretches(chart.add_background_axis(1), "cut", [(c.begin, c.end) for c in figures.cuts], "--cut")
    _draw_marks(chart, spec, recording, figures, unit)
    saw = recording.values["slave.position"]
    chart.draw_curve(1, "saw", recording.time, saw, Style(SLAVE, 2.5), unit=unit, required=required)
    chart.fit_to_view(1)
    low, high = float(saw.min()), float(saw.max())
    middle, reach_of_limits = 0.5 * (low + high), NEAR * (high - low)
    for bound in bounds(scenario, figures):
        if bound.row == 1 and abs(bound.value - middle) <= reach_of_limits:
            draw_bound(chart, bound, unit, high - low)
    _draw_errors(chart, figures, unit)
    return chart


def _draw_errors(chart: Chart, figures: KeyFigures, unit: str) -> None:
    """Draw the error of each cut, and how great it may be; errors that are rounding are not drawn large."""
    chart.write_title(2, with_unit("error of the cut", unit))
    if not figures.cuts:
        chart.annotate("no cut", yref="y2 domain", x=0.5, y=0.5)
        chart.axis(2)["range"] = [-1.0, 1.0]
        return
    numbers = [
        [i, engineering(c.mark, unit), engineering(c.error, unit, scale=figures.scale)]
        for i, c in enumerate(figures.cuts, 1)
    ]
    tolerance = figures.tolerance or 0.0
    trace = {
        "type": "scatter",
        "mode": "markers",
        "x": rounded((c.end for c in figures.cuts), TIME_DIGITS),
        "y": rounded(c.error for c in figures.cuts),
        "customdata": numbers,
        "marker": {
            "size": 8 if len(figures.cuts) <= MOST_MARKS else 4,
            "color": [BAD if abs(c.error) > tolerance else OK for c in figures.cuts],
        },
        "hovertemplate": "%{customdata[2]}<extra>cut %{customdata[0]}, mark %{customdata[1]}</extra>",
        "meta": with_unit("error of the cut", unit),
    }
    chart.add_trace(2, "error of a cut", trace, legend=False)
    worst = max(abs(c.error) for c in figures.cuts)
    rounding = worst <= ROUNDING * figures.scale
    if rounding or tolerance < FAR * worst:
        for limit in (-tolerance, tolerance):
            chart.draw_horizontal_line(2, "tolerance", limit)
        chart.write_limit(2, tolerance, f"tolerance {engineering(tolerance, unit)}")
    if rounding:
        chart.axis(2)["range"] = [-1.3 * tolerance, 1.3 * tolerance]
        chart.annotate(f"0 to rounding: at most {engineering(worst, unit)}", yref="y2 domain", x=0.5, y=0.8)
    else:
        chart.axis(2)["rangemode"] = "tozero"


def _draw_marks(chart: Chart, spec: CutSpec, recording: Recording, figures: KeyFigures, unit: str) -> None:
    """Draw where each mark is while it passes the range of the saw, marks without a cut in another colour; of very many
    marks only these."""
    passing = list(passages(spec, recording, *reach(spec, recording)))
    uncut = {round((mark - spec.offset) / spec.length) for mark in figures.uncut}
    if len(passing) > MOST_MARKS:
        number, passing = len(passing), [p for p in passing if p.number in uncut]
        drawn = (
            f"those without a cut, {len(passing)}, are drawn" if 0 < len(passing) <= MOST_MARKS else "too many to draw"
        )
        chart.annotate(f"{number} marks pass: {drawn}", yref="y domain", x=0.5, y=0.97, yanchor="top")
        if len(passing) > MOST_MARKS:
            return
    styles = (("marks on the material", MASTER, 1.0, "solid"), ("marks that passed uncut", BAD, 1.6, "dot"))
    for missed, (name, colour, width, dash) in enumerate(styles):
        selected = [p for p in passing if (p.number in uncut) == bool(missed)]
        if selected:
            line = {"color": colour, "width": width, "dash": dash}
            template = f"%{{y:.6~g}} {unit}<extra>mark %{{customdata:.10~g}} {unit}</extra>"
            trace = _join_with_gaps(selected, len(passing))
            chart.add_trace(1, name, trace | {"line": line, "hovertemplate": template})


def _join_with_gaps(selected: list[Passage], number: int) -> dict[str, Any]:
    """Passages as one line with gaps; the more passages there are, the fewer points each has."""
    most = max(2, 2 * BUCKETS // number)
    parts = [evenly_spaced(len(p.time), most) for p in selected]
    gap = [np.nan]
    x = np.concatenate([part for p, at in zip(selected, parts, strict=True) for part in (p.time[at], gap)])
    y = np.concatenate([part for p, at in zip(selected, parts, strict=True) for part in (p.position[at], gap)])
    marks = [mark for p, at in zip(selected, parts, strict=True) for mark in rounded([p.place], 10) * (len(at) + 1)]
    xs, ys = rounded(x, TIME_DIGITS), rounded(y)
    return {"type": "scatter", "mode": "lines", "x": xs, "y": ys, "customdata": marks}
