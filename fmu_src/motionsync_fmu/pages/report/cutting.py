"""The cuts of a saw over time: the saw among the marks that pass it, and how far each cut is from its mark."""

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.cuts import CutSpec
from ...scenario.figures import Figures, engineering
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..style import typeset
from .chart import BAD, LIMIT, MASTER, OK, SLAVE, Chart, Style
from .motion import NEAR, bounds, draw_bound
from .numbers import NONE, ROUNDING, TIME_DIGITS, Indices, points, rounded, thinned

MOST_MARKS = 500  # lines of marks that are drawn
FAR = 100.0  # the tolerance is drawn unless it is so many times the greatest error


def cut_chart(spec: CutSpec, scenario: Scenario, recording: Recording, found: Figures, kept: Indices = NONE) -> Chart:
    """The saw among the marks that pass it, seen from the machine; below, the error of each cut."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    chart = Chart(
        "The saw among the passing marks, and the error of each cut", [330, 130], "time in s", (0.0, scenario.stop_time)
    )
    chart.layout["xaxis"]["unifiedhovertitle"] = {"text": "%{x:.6~f} s"}
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
    saw = recording.values["slave.position"]
    room = 0.05 * float(np.ptp(saw)) + 1e-3 * spec.length
    low, high = float(saw.min()) - room, float(saw.max()) + room
    chosen = thinned(recording.master[:, 0])
    travel = spec.ratio * (recording.master[chosen, 0] - spec.offset)
    distance = spec.ratio * spec.length
    edges = sorted((x - edge) / distance for x, edge in ((travel.min(), high), (travel.max(), low)))
    first, last = int(np.floor(edges[0])), int(np.ceil(edges[1]))
    uncut = {round((place - spec.offset) / spec.length) for place in found.uncut}
    gathered: dict[bool, tuple[list[float | None], list[float | None], list[str]]] = {}
    for n in range(first, min(last, first + MOST_MARKS) + 1):
        seen = travel - n * distance
        inside = np.flatnonzero((low <= seen) & (seen <= high))
        for part in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
            if len(part):
                x, y = points(recording.time[chosen[part]], seen[part])
                xs, ys, names = gathered.setdefault(n in uncut, ([], [], []))
                xs += [*x, None]
                ys += [*y, None]
                names += [engineering(spec.offset + n * spec.length, unit)] * (len(x) + 1)
    for missed, (xs, ys, names) in sorted(gathered.items()):
        line = {"color": BAD if missed else MASTER, "width": 1.6 if missed else 1.0}
        said = "%{y:.6~g} " + unit + "<extra>mark %{customdata}</extra>"
        trace = {
            "type": "scatter",
            "mode": "lines",
            "x": xs,
            "y": ys,
            "line": line,
            "customdata": names,
            "hovertemplate": said,
        }
        chart.add(1, "marks that passed uncut" if missed else "marks on the material", trace)
