"""One self-contained HTML page a run: interactive plots over time, the cuts, and a table of what was expected."""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from motionsync.var import Unit

from .. import __version__
from ..interface.units import axis_label, unit_name
from ..interface.variables import Variable
from ..scenario.cuts import Cut, CutSpec, find_cuts
from ..scenario.judge import Check, Deviation, read_reference
from ..scenario.recording import Reals, Recording
from ..scenario.scenario import Scenario
from ..scenario.telegrams import Errors, errors
from .style import MASTER, SLAVE, TEMPLATES

REFERENCE = "#1f6fb2"
GREY = "#53616e"
RECEIVED = "#9a8fb5"
BANDS = ("#e8edf2", "#fbe3c8", "#d5ead8", "#e6dcf2", "#f7d9dc", "#d6ecef", "#efe9c9", "#dcd3cc")
TRUE, SYNCHRONOUS = "#aab9c6", "#d5ead8"
ROWS = (
    ("position", Unit.POSITION, 330),
    ("velocity", Unit.VELOCITY, 185),
    ("acceleration", Unit.ACCELERATION, 185),
    ("jerk", Unit.JERK, 150),
)
ERRORS = (("index error", 185), ("axis error", 185))  # the further rows of a remote axis
FARTHEST = 10.0  # cycles; the index error shows no more at first, since it grows without end after a fault
LANE = 24  # the height of a lane, in px; the heights of rows are in px, too
MOST_POINTS = 20_000  # of a line; a line of more points is thinned out
MOST_TEXTS = 8  # commands that are written beside their marks; more would cover one another
MOST_SHADES = 500  # stretches that are shaded behind the positions


def write_report(
    file: Path,
    scenario: Scenario,
    recording: Recording,
    checks: list[Check],
    deviations: list[Deviation],
    step_size: float,
) -> None:
    """Write the page; it loads nothing from elsewhere."""
    by_name = scenario.recipe.variables
    cuts = find_cuts(scenario.cuts, recording) if scenario.cuts else []
    text = TEMPLATES.get_template("report.html.j2").render(
        scenario=scenario,
        version=__version__,
        step_size=step_size,
        points=len(recording.time),
        checks=checks,
        deviations=deviations,
        messages=recording.messages,
        passed=all(c.passed for c in checks) and all(d.passed for d in deviations),
        plots=html(plots(scenario, recording, by_name), plotly=True),
        cuts=cuts,
        cut_plots=html(cut_plots(scenario.cuts, cuts, scenario, recording)) if scenario.cuts and cuts else "",
        unit=unit_name(Unit.POSITION, scenario.unit),
        by_name=by_name,
    )
    file.write_text(text, "utf-8")


def html(figure: Any, *, plotly: bool = False) -> Markup:
    """A figure as HTML. The first figure of a page contains plotly's code, too (`plotly`)."""
    return Markup(figure.to_html(full_html=False, include_plotlyjs=plotly, config={"displaylogo": False}))


# --- plots over time ---


def plots(scenario: Scenario, recording: Recording, by_name: Mapping[str, Variable]) -> Any:
    """Master and slave over time, the reference over them, a remote axis' errors, lanes of what is discrete, marks of
    the commands."""
    lanes = list(_lanes(recording, by_name))
    rows = [height for *_, height in ROWS] + [height for _, height in ERRORS if scenario.remote]
    heights = [*rows, LANE * (len(lanes) + 1)]
    figure = make_subplots(
        rows=len(heights), cols=1, shared_xaxes=True, vertical_spacing=20.0 / sum(heights), row_heights=heights
    )
    if scenario.remote:
        found = errors(scenario.remote, recording)
        _received(figure, found)
        _motion(figure, scenario, recording, "remote axis")
        _errors(figure, found, scenario)
    else:
        _motion(figure, scenario, recording, "master")
    _draw_lanes(figure, len(heights), lanes)
    _commands(figure, len(heights), scenario, by_name)
    figure.update_layout(
        height=sum(heights) + 20 * len(heights) + 170,
        margin={"t": 110 if 0 < len(scenario.settings) <= MOST_TEXTS else 30, "r": 20, "l": 70, "b": 60},
        template="plotly_white",
        hovermode="x unified",
        barmode="overlay",
        uniformtext={"mode": "hide", "minsize": 9},
        legend={"orientation": "h", "yref": "container", "y": 0.0, "yanchor": "bottom"},
    )
    figure.update_xaxes(title_text="time in s", row=len(heights), col=1)
    return figure


def _motion(figure: Any, scenario: Scenario, recording: Recording, followed: str) -> None:
    """Draw the slave, what it follows, and the reference: a row each for position and its derivatives."""
    master = dict(zip((name for name, *_ in ROWS), recording.master.T, strict=True))
    reference = read_reference(scenario)
    for i, (name, kind, _) in enumerate(ROWS, 1):
        values = master[name] % scenario.period if name == "position" and scenario.period else master[name]
        curve(figure, i, followed, recording.time, _broken(values, scenario, name), MASTER, 1.5)
        slave = _broken(recording.values[f"slave.{name}"], scenario, name)
        curve(figure, i, "slave", recording.time, slave, SLAVE, 2.5)
        if reference and f"slave.{name}" in reference[0]:
            column = reference[1][:, 1 + reference[0].index(f"slave.{name}")]
            curve(figure, i, "reference", reference[1][:, 0], _broken(column, scenario, name), REFERENCE, 1.5, "dot")
        _title(figure, i, name, axis_label(kind, scenario.unit, scenario.slave_unit))


def _received(figure: Any, found: Errors) -> None:
    """Draw the axis as the telegrams describe it, in the rows of the motion."""
    for i, values in enumerate(found.received.T, 1):
        curve(figure, i, "received", found.time, values, RECEIVED, 1.0)


def _errors(figure: Any, found: Errors, scenario: Scenario) -> None:
    """Draw, in rows below those of the motion, how far telegram and slave are from the truth."""
    units = "cycles", unit_name(Unit.POSITION, scenario.unit)
    pairs = (found.index, found.corrected_index), (found.position, found.corrected_position)
    rows = zip(ERRORS, units, pairs, strict=True)
    for i, ((name, _), unit, (received, slave)) in enumerate(rows, len(ROWS) + 1):
        curve(figure, i, "received", found.time, received, RECEIVED, 1.0)
        curve(figure, i, "slave", found.time, slave, SLAVE, 2.0)
        _title(figure, i, name, unit)
    figure.update_yaxes(autorangeoptions={"clipmin": -FARTHEST, "clipmax": FARTHEST}, row=len(ROWS) + 1, col=1)


def _title(figure: Any, row: int, name: str, unit: str) -> None:
    figure.update_yaxes(title_text=name + (f"<br>{unit}" if unit else ""), row=row, col=1)


def curve(
    figure: Any, row: int, name: str, time: Reals, values: Reals, colour: str, width: float, dash: str = "solid"
) -> None:
    """Draw a line in a row. The legend has only the line of the first row, which switches all lines of its name."""
    chosen = _places_to_draw(values)
    figure.add_trace(
        go.Scatter(
            x=time[chosen],
            y=values[chosen],
            name=name,
            legendgroup=name,
            showlegend=row == 1,
            line={"color": colour, "width": width, "dash": dash},
            mode="lines",
        ),
        row=row,
        col=1,
    )


def _places_to_draw(values: Reals) -> NDArray[np.int64]:
    """The indices of the points to draw: all, or of many points the least and the greatest of each stretch."""
    if len(values) <= MOST_POINTS:
        return np.arange(len(values))
    size = -(-len(values) // (MOST_POINTS // 2))
    whole = len(values) // size * size
    stretches, begins = values[:whole].reshape(-1, size), np.arange(0, whole, size)
    extremes = (begins + stretches.argmin(axis=1), begins + stretches.argmax(axis=1))
    return np.unique(np.concatenate([[0], *extremes, np.arange(whole, len(values))]))


def _broken(values: Reals, scenario: Scenario, name: str) -> Reals:
    """A wrapped position with gaps where it jumps by a period."""
    if name != "position" or not scenario.period:
        return values
    jumps = np.abs(np.diff(values, prepend=values[0])) > 0.5 * scenario.period
    return np.where(jumps, np.nan, values)


# --- what is discrete ---


Stretch = tuple[float, float, int]
"""The begin and end of a stretch of time, in s, and the value that a variable has in it."""
Lane = tuple[Variable, list[Stretch]]
"""A variable and its values, one after the other."""


def _lanes(recording: Recording, by_name: Mapping[str, Variable]) -> Iterator[Lane]:
    """The state, then whatever else changes in the run: enumerations, then Booleans."""
    for kind in ("Enumeration", "Boolean"):
        for v in (by_name[name] for name in recording.values if by_name[name].kind == kind):
            stretches = list(_stretches(recording, v.name))
            if len(stretches) > 1 or v.name == "state":
                yield v, stretches


def _stretches(recording: Recording, name: str) -> Iterator[Stretch]:
    values = recording.values[name].astype(int)
    borders = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values) - 1]
    for first, last in pairwise(borders):
        if last > first:
            yield float(recording.time[first]), float(recording.time[last]), int(values[first])


def _draw_lanes(figure: Any, row: int, lanes: list[Lane]) -> None:
    """Draw a lane for each variable, the first at the top; below them is a lane for the marks of the commands."""
    for v, stretches in lanes:
        for bar in _bars(v, stretches):
            figure.add_trace(bar, row=row, col=1)
        if v.name == "state" and len(stretches) <= MOST_SHADES:
            _shade(figure, [(begin, end, _band(v, value)) for begin, end, value in stretches if value in v.choices])
    names = [v.name for v, _ in lanes]
    figure.update_yaxes(
        type="category",
        categoryarray=["set", *reversed(names)],
        range=[-0.5, len(names) + 0.5],
        showgrid=False,
        automargin=True,
        row=row,
        col=1,
    )


def _bars(v: Variable, stretches: list[Stretch]) -> Iterator[Any]:
    """Bars with the names of an enumeration's members, plain ones where a Boolean is true."""
    for member in v.choices or [True]:
        chosen = [(begin, end) for begin, end, value in stretches if value == member]
        if chosen:
            yield go.Bar(
                orientation="h",
                base=[begin for begin, _ in chosen],
                x=[end - begin for begin, end in chosen],
                y=[v.name] * len(chosen),
                text=[member.name] * len(chosen) if v.choices else None,
                textposition="inside",
                insidetextanchor="middle",
                textangle=0,
                textfont={"color": "#1d2730"},
                marker={"color": _band(v, member) if v.choices else TRUE, "line": {"width": 0}},
                width=0.8,
                name=member.name if v.choices else v.name,
                showlegend=False,
                hoverinfo="skip",
            )


def _band(v: Variable, value: int) -> str:
    """The colour of an enumeration's member."""
    return BANDS[v.choices.index(value) % len(BANDS)]


def _shade(figure: Any, stretches: list[tuple[float, float, str]]) -> None:
    """Shade stretches of time behind the topmost row."""
    for begin, end, colour in stretches:
        rectangle = {"type": "rect", "xref": "x", "yref": "y domain", "x0": begin, "x1": end, "y0": 0, "y1": 1}
        figure.add_shape(rectangle | {"fillcolor": colour, "opacity": 0.45, "line": {"width": 0}, "layer": "below"})


def _commands(figure: Any, row: int, scenario: Scenario, by_name: Mapping[str, Variable]) -> None:
    """Draw what was set, and when: a dashed line through all rows, and a mark with a text under the pointer."""
    texts = [", ".join(f"{n} = {by_name[n].text(value)}" for n, value in s.values.items()) for s in scenario.settings]
    times = [s.at for s in scenario.settings]
    for t, text in zip(times, texts, strict=True):
        line = {"type": "line", "xref": "x", "yref": "paper", "x0": t, "x1": t, "y0": 0, "y1": 1, "layer": "below"}
        figure.add_shape(line | {"line": {"color": GREY, "width": 1, "dash": "dash"}, "opacity": 0.6})
        if len(times) <= MOST_TEXTS:
            figure.add_annotation(
                x=t, y=1.0, yref="paper", yanchor="bottom", text=text, textangle=-20, xanchor="left", showarrow=False
            )
    marks = {"color": GREY, "size": 9, "symbol": "triangle-up"}
    under_pointer = "%{text}<extra></extra>"
    figure.add_trace(
        go.Scatter(
            x=times,
            y=["set"] * len(times),
            text=texts,
            mode="markers",
            marker=marks,
            hovertemplate=under_pointer,
            showlegend=False,
        ),
        row=row,
        col=1,
    )


# --- cuts ---


def cut_plots(spec: CutSpec, cuts: list[Cut], scenario: Scenario, recording: Recording) -> Any:
    """The saw among the marks that pass it, and the error of each cut over its place on the material."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    figure = make_subplots(rows=2, cols=1, vertical_spacing=0.16, row_heights=[0.62, 0.38])
    saw = recording.values["slave.position"]
    curve(figure, 1, "marks on the material", *_passing(spec, recording, saw), MASTER, 1.0)
    curve(figure, 1, "saw", recording.time, saw, SLAVE, 2.5)
    if len(cuts) <= MOST_SHADES:
        _shade(figure, [(c.begin, c.end, SYNCHRONOUS) for c in cuts])
    numbers = list(range(1, len(cuts) + 1))
    errors = go.Bar(
        x=[c.mark for c in cuts],
        y=[c.error for c in cuts],
        width=0.3 * spec.length,
        marker={"color": SLAVE},
        customdata=numbers,
        hovertemplate=f"cut %{{customdata}} at %{{x}} {unit}: %{{y:.3g}} {unit}<extra></extra>",
        showlegend=False,
    )
    figure.add_trace(errors, row=2, col=1)
    if spec.tolerance is not None and spec.tolerance < 100.0 * max(abs(c.error) for c in cuts):
        for limit in (-spec.tolerance, spec.tolerance):
            figure.add_hline(y=limit, line={"color": GREY, "width": 1, "dash": "dot"}, row=2, col=1)
    figure.update_xaxes(title_text="time in s", row=1, col=1)
    figure.update_xaxes(title_text=f"mark on the material{f' in {unit}' if unit else ''}", row=2, col=1)
    figure.update_yaxes(title_text=f"saw and marks<br>{unit}", row=1, col=1)
    figure.update_yaxes(title_text=f"error of the cut<br>{unit}", exponentformat="e", row=2, col=1)
    figure.update_layout(height=700, margin={"t": 40, "r": 20, "l": 70, "b": 50}, template="plotly_white")
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom"})
    return figure


def _passing(spec: CutSpec, recording: Recording, saw: Reals) -> tuple[Reals, Reals]:
    """Where the marks are while they pass the range of the saw, as one line with gaps: times and positions."""
    room = 0.05 * float(np.ptp(saw)) + 1e-3 * spec.length
    low, high = float(saw.min()) - room, float(saw.max()) + room
    chosen = _places_to_draw(recording.master[:, 0])
    travel = spec.ratio * (recording.master[chosen, 0] - spec.offset)
    distance = abs(spec.ratio) * spec.length
    first, last = (int(np.floor((x - edge) / distance)) for x, edge in ((travel.min(), high), (travel.max(), low)))
    times, positions = [], []
    gap = np.array([np.nan])
    for n in range(first, min(last, first + MOST_SHADES) + 1):
        inside = np.flatnonzero((low <= travel - n * distance) & (travel - n * distance <= high))
        for part in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
            times += [recording.time[chosen[part]], gap]
            positions += [travel[part] - n * distance, gap]
    return np.concatenate([gap, *times]), np.concatenate([gap, *positions])
