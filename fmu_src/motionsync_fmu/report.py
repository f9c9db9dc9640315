"""One self-contained HTML page per run: interactive courses over time, and a table of what was expected."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup
from plotly.subplots import make_subplots

from motionsync.blocks import BLOCKS
from motionsync.declare import Unit

from . import __version__
from .description import unit_name
from .documentation import MASTER, SLAVE, TEMPLATES
from .scenario import Scenario
from .simulation import Check, Course, Deviation, read_reference
from .variables import variables

REFERENCE = "#1f6fb2"
BANDS = ("#e8edf2", "#fbe3c8", "#d5ead8", "#e6dcf2", "#f7d9dc", "#d6ecef")
ROWS = (
    ("position", Unit.POSITION),
    ("velocity", Unit.VELOCITY),
    ("acceleration", Unit.ACCELERATION),
    ("jerk", Unit.JERK),
)
HEIGHTS = (0.36, 0.2, 0.2, 0.16, 0.08)


def write_report(
    file: Path, scenario: Scenario, course: Course, checks: list[Check], deviations: list[Deviation], step_size: float
) -> None:
    """The page; nothing in it is loaded from elsewhere."""
    figure = plots(scenario, course)
    text = TEMPLATES.get_template("report.html.j2").render(
        scenario=scenario,
        version=__version__,
        step_size=step_size,
        points=len(course.time),
        checks=checks,
        deviations=deviations,
        messages=course.messages,
        passed=all(c.passed for c in checks) and all(d.passed for d in deviations),
        plots=Markup(figure.to_html(full_html=False, include_plotlyjs=True, config={"displaylogo": False})),
    )
    file.write_text(text, "utf-8")


def plots(scenario: Scenario, course: Course) -> Any:
    """Master and slave over time, the reference over them, bands of the block's states, marks of the commands."""
    unit = scenario.unit
    figure = make_subplots(rows=5, cols=1, shared_xaxes=True, vertical_spacing=0.025, row_heights=HEIGHTS)
    master = dict(zip(("position", "velocity", "acceleration"), course.master.T, strict=True))
    reference = read_reference(scenario)
    for i, (name, kind) in enumerate(ROWS, 1):
        if name in master:
            values = master[name] % scenario.period if name == "position" and scenario.period else master[name]
            _line(figure, i, "master", course.time, _broken(values, scenario, name), MASTER, 1.5)
        slave = _broken(course.values[f"slave.{name}"], scenario, name)
        _line(figure, i, "slave", course.time, slave, SLAVE, 2.5)
        if reference and f"slave.{name}" in reference[0]:
            column = reference[1][:, 1 + reference[0].index(f"slave.{name}")]
            _line(figure, i, "reference", reference[1][:, 0], _broken(column, scenario, name), REFERENCE, 1.5, "dot")
        label = unit_name(kind, unit)
        figure.update_yaxes(title_text=name + (f"<br>{label}" if label else ""), row=i, col=1)
    _states(figure, scenario, course)
    for s in scenario.settings:
        text = ", ".join(f"{name} = {value:g}" for name, value in s.values.items())
        figure.add_vline(x=s.at, line={"color": "#53616e", "width": 1, "dash": "dash"}, layer="below")
        figure.add_annotation(
            x=s.at, y=1.0, yref="paper", yanchor="bottom", text=text, textangle=-20, xanchor="left", showarrow=False
        )
    figure.update_layout(
        height=980,
        margin={"t": 110, "r": 20, "l": 70, "b": 50},
        template="plotly_white",
        hovermode="x unified",
        legend={"orientation": "h", "y": -0.05},
    )
    figure.update_xaxes(title_text="time in s", row=5, col=1)
    return figure


def _line(
    figure: Any, row: int, name: str, time: Any, values: Any, colour: str, width: float, dash: str = "solid"
) -> None:
    line = {"color": colour, "width": width, "dash": dash}
    figure.add_trace(
        go.Scatter(x=time, y=values, name=name, legendgroup=name, showlegend=row == 1, line=line, mode="lines"),
        row=row,
        col=1,
    )


def _broken(values: Any, scenario: Scenario, name: str) -> Any:
    """A wrapped position with gaps where it jumps by a period."""
    if name != "position" or not scenario.period:
        return values
    jumps = np.abs(np.diff(values, prepend=values[0])) > 0.5 * scenario.period
    return np.where(jumps, np.nan, values)


def _states(figure: Any, scenario: Scenario, course: Course) -> None:
    """A strip that names the block's state, with the hues of its members."""
    block = BLOCKS[scenario.recipe.name].type()
    choices = next(v.choices for v in variables(block) if v.name == "state")
    hues = {member.value: BANDS[i % len(BANDS)] for i, member in enumerate(choices)}
    names = {member.value: member.name for member in choices}
    for begin, end, code in _stretches(course):
        figure.add_vrect(
            x0=begin, x1=end, fillcolor=hues[code], line_width=0, layer="below", opacity=0.45, row=1, col=1
        )
        figure.add_trace(
            go.Scatter(
                x=[begin, end, end, begin],
                y=[0, 0, 1, 1],
                fill="toself",
                fillcolor=hues[code],
                line={"width": 0},
                mode="lines",
                showlegend=False,
                name=names[code],
                hoverinfo="name",
            ),
            row=5,
            col=1,
        )
        if end - begin > 0.04 * course.time[-1]:
            middle = (begin + end) / 2.0
            figure.add_annotation(x=middle, y=0.5, text=names[code], showarrow=False, row=5, col=1)
    figure.update_yaxes(title_text="state", showticklabels=False, showgrid=False, range=[0, 1], row=5, col=1)


def _stretches(course: Course) -> Iterator[tuple[float, float, int]]:
    """The block's states, one after the other: from when, until when, which."""
    codes = course.values["state_code"].astype(int)
    borders = [0, *(np.flatnonzero(np.diff(codes)) + 1).tolist(), len(codes) - 1]
    for first, last in pairwise(borders):
        if last > first:
            yield float(course.time[first]), float(course.time[last]), int(codes[first])
