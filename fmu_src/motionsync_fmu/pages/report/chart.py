"""A chart: rows of plots above one another over one axis, as plotly.js takes it.

Colours are names of CSS properties (`--slave`); the page's script replaces them by their values, those of a light or a
dark page.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup, escape

from ...scenario.recording import Reals
from ..numbers import NONE, TIME_DIGITS, Indices, points, rounded
from ..style import typeset, with_unit

INK, PAPER, GRID, AXIS, MUTED = "--ink", "--paper", "--grid", "--axis", "--muted"
MASTER, SLAVE, REFERENCE, RECEIVED = "--master", "--slave", "--reference", "--received"
LIMIT, OK, BAD = "--limit", "--ok", "--bad"
TOP, GAP, BOTTOM, LEFT, RIGHT = 58, 34, 44, 62, 16  # px; the heights of rows are in px, too
CLEAR = "rgba(0,0,0,0)"
KINDS = 7  # colours of kinds of pieces
TEXT = 0.2  # of the horizontal axis: the space for the text at a vertical line
SWINGS = 150  # of a curve; of one that swings up and down more often the line is thinner, so that it remains a curve
THINNEST = 0.25  # of its width


@dataclass(frozen=True)
class Style:
    """How a curve is drawn: `colour` is a CSS property, `width` in px, `dash` as plotly.js names it."""

    colour: str
    width: float
    dash: str = "solid"


@dataclass
class Chart:
    """Rows of plots over one horizontal axis.

    Attributes:
        name: what the chart shows, for screen readers.
        heights: the height of each row, in px.
        title: what the horizontal axis shows.
        span: the least and the greatest value of the horizontal axis.
        hover: plotly.js' hovermode.
        timed: the horizontal axis is the time: all such charts of a page show the same part of it.
    """

    name: str
    heights: Sequence[int]
    title: str
    span: tuple[float, float]
    hover: str = "x unified"
    timed: bool = True
    traces: list[dict[str, Any]] = field(default_factory=list)
    layout: dict[str, Any] = field(default_factory=dict)
    legend_names: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        inner = sum(self.heights) + GAP * (len(self.heights) - 1)
        self.layout = {
            "height": TOP + inner + BOTTOM,
            "margin": {"t": TOP, "b": BOTTOM, "l": LEFT, "r": RIGHT},
            "paper_bgcolor": PAPER,
            "plot_bgcolor": PAPER,
            "font": {"color": INK, "family": "system-ui, sans-serif", "size": 12},
            "hovermode": self.hover,
            "hoversubplots": "axis",
            "hoverlabel": {"bgcolor": PAPER, "bordercolor": AXIS, "font": {"color": INK}, "namelength": -1},
            "modebar": {"color": MUTED, "activecolor": INK, "bgcolor": CLEAR},
            "legend": {"orientation": "h", "x": 0, "y": 1 + 20 / inner, "yanchor": "bottom", "bgcolor": CLEAR}
            | {"uirevision": "kept"},  # which curves are hidden
            "annotations": [],
            "shapes": [],
            "template": {"data": {"scatter": [{"line": {"simplify": False}}]}},  # else curves have corners
            "meta": {"timed": self.timed, "rescaled": [], "span": list(self.span), "right": RIGHT},
            "xaxis": self._axis() | {"title": {"text": self.title}, "range": list(self.span)},
        }
        top = 1.0
        for row, height in enumerate(self.heights, 1):
            bottom = max(0.0, top - height / inner)
            self.layout[axis_key(row)] = self._axis() | {"domain": [bottom, top], "anchor": "x"}
            top = bottom - GAP / inner
        if self.timed:
            self.layout["xaxis"]["unifiedhovertitle"] = {"text": "%{x:.6~f} s"}
        self.layout["xaxis"]["anchor"] = axis_id(len(self.heights))
        self.axes = len(self.heights)

    def _axis(self) -> dict[str, Any]:
        colours = {"gridcolor": GRID, "zerolinecolor": AXIS, "linecolor": AXIS, "tickcolor": AXIS}
        return colours | {"tickformat": ".6~g"}

    def axis(self, row: int) -> dict[str, Any]:
        """The vertical axis with this number."""
        return cast("dict[str, Any]", self.layout[axis_key(row)])

    def write_title(self, row: int, text: str) -> None:
        """Write above a row what it shows."""
        self.annotate(
            text, yref=f"{axis_id(row)} domain", x=0, y=1, xanchor="left", yanchor="bottom", font={"size": 13}
        )

    def annotate(self, text: str, **position: Any) -> None:
        """Write a text; `position` as plotly.js has it for annotations."""
        note = {"text": text, "showarrow": False, "xref": "paper", "bgcolor": PAPER, "borderpad": 0, "opacity": 0.85}
        self.layout["annotations"].append(note | position)

    def add_background_axis(self, row: int) -> int:
        """Add an axis from 0 to 1 behind a row, for shaded stretches; return its number."""
        number = self._add_axis(row, {"range": [0, 1], "fixedrange": True, "visible": False})
        self.axis(row).update({"overlaying": axis_id(number), "tickmode": "auto"})
        return number

    def add_right_axis(self, row: int, text: str, colour: str, *, behind: bool = False) -> int:
        """Add an axis on the right of a row; return its number. Its curves are over those of the row, or `behind`."""
        base = self.axis(row).get("overlaying", axis_id(row))
        ticks = {"side": "right", "tickmode": "auto", "tickfont": {"color": colour}}
        number = self._add_axis(row, ticks | {"showgrid": False, "zeroline": False})
        if behind:
            self.axis(row).update({"overlaying": axis_id(number), "tickmode": "auto"})
        else:
            self.axis(number)["overlaying"] = base
        self.layout["meta"]["right"] = LEFT
        position = {"x": 1, "y": 1, "xanchor": "right", "yanchor": "bottom", "font": {"size": 13, "color": colour}}
        position["xshift"] = LEFT - RIGHT  # over the numbers of its axis: on a telephone there is no other space
        self.annotate(text, yref=f"{axis_id(row)} domain", **position)
        return number

    def _add_axis(self, row: int, given: dict[str, Any]) -> int:
        self.axes += 1
        self.layout[axis_key(self.axes)] = self._axis() | {"domain": self.axis(row)["domain"], "anchor": "x"} | given
        return self.axes

    def draw_vertical_line(self, value: float, text: str = "", colour: str = MUTED) -> None:
        """Draw a line through all rows at a value of the horizontal axis; if it is not muted, over the grid."""
        line = {"type": "line", "xref": "x", "yref": "paper", "x0": value, "x1": value, "y0": 0, "y1": 1}
        opacity, layer = (0.5, "below") if colour == MUTED else (1.0, "above")
        style = {"line": {"color": colour, "width": 1, "dash": "dot"}, "opacity": opacity, "layer": layer}
        self.layout["shapes"].append(line | style)
        if text:
            low, high = self.span
            is_left, space = 2.0 * value < low + high, TEXT * (high - low)
            outward = min(value - low, high - value) > space  # neither beyond the chart nor on another one
            anchor = "right" if is_left == outward else "left"
            self.annotate(text, xref="x", yref="paper", x=value, y=1, xanchor=anchor, yanchor="top", font={"size": 11})

    def draw_horizontal_line(self, row: int, name: str, value: float, dash: str = "dot") -> None:
        """Draw a limit as a line through a row."""
        line = {"x": list(self.span), "y": [value] * 2, "line": {"color": LIMIT, "width": 1.2, "dash": dash}}
        self.add_trace(row, name, {"type": "scatter", "mode": "lines", "hoverinfo": "skip"} | line)

    def write_limit(self, row: int, value: float, text: str, anchor: str = "top") -> None:
        """Write a limit at the right end of its line."""
        font = {"size": 10, "color": LIMIT}
        self.annotate(text, x=1, xanchor="right", y=value, yref=axis_id(row), yanchor=anchor, font=font)

    def include(self, row: int, value: float) -> None:
        """Let the axis with this number reach a value, unless its range is fixed."""
        axis = self.axis(row)
        if "range" not in axis:
            axis.setdefault("autorangeoptions", {}).setdefault("include", []).append(value)

    def fit_to_view(self, row: int) -> None:
        """Fit the axis with this number to the visible points whenever the horizontal axis changes."""
        self.layout["meta"]["rescaled"].append(axis_key(row))

    def add_trace(self, row: int, name: str, trace: dict[str, Any], *, legend: bool = True) -> None:
        """Add a trace; the legend has each name once, and switches all traces of that name. Traces with
        `meta` are in the chart's file of comma-separated values: it is the heading, or has `heading` and `texts`."""
        first = legend and name not in self.legend_names
        self.legend_names |= {name} if legend else set()
        axes = {"xaxis": "x", "yaxis": axis_id(row), "name": name, "showlegend": first}
        self.traces.append(axes | ({"legendgroup": name} if legend else {}) | trace)

    def draw_curve(
        self,
        row: int,
        name: str,
        time: Reals,
        values: Reals,
        style: Style,
        hover_name: str = "",
        unit: str = "",
        *,
        required: Indices = NONE,
        gaps: Indices = NONE,
        legend_rank: int = 0,
    ) -> None:
        """Draw a line. `hover_name`: its name next to the pointer, if not `name`; `required`: indices of points that
        must not be left out; `gaps`: those before which the line has a gap; `legend_rank`: its position in the
        legend, 0: in the sequence in which lines are drawn."""
        x, y = points(time, values, required, gaps)
        width = style.width * min(1.0, max(THINNEST, SWINGS / max(count_swings(values), 1)))
        line = {"color": style.colour, "width": float(f"{width:.2g}"), "dash": style.dash}
        trace = {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": line}
        trace |= {
            "hovertemplate": hover_template(unit, hover_name or name),
            "meta": with_unit(hover_name or name, unit),
        }
        self.add_trace(row, name, trace | ({"legendrank": legend_rank} if legend_rank else {}))

    def draw_markers(
        self, row: int, name: str, time: Reals, values: Reals, colour: str, hover_name: str, unit: str, symbol: str
    ) -> None:
        """Draw a marker at each point."""
        trace: dict[str, Any] = {"type": "scatter", "mode": "markers"}
        trace |= {"x": rounded(time, TIME_DIGITS), "y": rounded(values)}
        trace |= {"marker": {"color": colour, "size": 5, "symbol": symbol}}
        texts = {"hovertemplate": hover_template(unit, hover_name), "meta": with_unit(hover_name, unit)}
        self.add_trace(row, name, trace | texts)

    def shade_stretches(self, row: int, name: str, stretches: Sequence[tuple[float, float]], colour: str) -> None:
        """Shade stretches over the whole height of the axis with this number, which goes from 0 to 1."""
        x = [e for begin, end in stretches for e in (begin, begin, end, end, None)]
        y = [e for _ in stretches for e in (0, 1, 1, 0, None)]
        self.draw_area(row, name, x, y, colour, {"width": 0}, legend=False, opacity=0.6)

    def draw_area(
        self, row: int, name: str, x: list[Any], y: list[Any], colour: str, line: Any, *, legend: bool, **more: Any
    ) -> None:
        """Fill the area inside a closed line, or inside several with gaps between them."""
        area = {"type": "scatter", "mode": "lines", "x": x, "y": y, "fill": "toself", "fillcolor": colour}
        self.add_trace(row, name, area | {"line": line, "hoverinfo": "skip"} | more, legend=legend)

    def as_json(self) -> dict[str, Any]:
        """The chart as plotly.js takes it."""
        return {"data": self.traces, "layout": self.layout}

    def html(self) -> Markup:
        """The element of the page that holds the chart, and its data."""
        data = htmlsafe_json_dumps(self.as_json(), dumps=to_compact_json)
        frame = Markup('<div class="plot" role="img" aria-label="{}" style="height:{}px"></div>\n')
        return frame.format(self.name, self.layout["height"]) + Markup(
            '<script type="application/json" class="plot-data">{}</script>\n'
        ).format(data)


def kind_colour(kind: int) -> str:
    """The CSS property with the colour of a kind of pieces."""
    return f"--kind-{kind % KINDS}"


def align_charts(charts: Iterable[Chart]) -> None:
    """Give charts the same margin on the right, so that the same times are above one another. On paper, where they are
    seldom on one page, each has its own."""
    aligned = list(charts)
    widest = max(chart.layout["meta"]["right"] for chart in aligned)
    for chart in aligned:
        chart.layout["margin"]["r"] = widest


def count_swings(values: Reals) -> int:
    """How often a curve goes from the lower quarter of its range into the upper one, or back."""
    span = float(np.ptp(values))
    share = (values - values.min()) / (span or 1.0)
    outer = share[np.abs(share - 0.5) > 0.25] > 0.5
    return int(np.count_nonzero(np.diff(outer)))


def axis_key(row: int) -> str:
    """The key of a vertical axis in the layout."""
    return f"yaxis{row if row > 1 else ''}"


def axis_id(row: int) -> str:
    """The name by which traces refer to a vertical axis."""
    return f"y{row if row > 1 else ''}"


def hover_template(unit: str, name: str) -> str:
    """The text next to the pointer at a point: its value, and the name of its curve."""
    return f"%{{y:.6~g}} {escape(typeset(unit))}".rstrip() + f"<extra>{escape(name)}</extra>"


def to_compact_json(values: Any, **options: Any) -> str:
    """The values as JSON without spaces."""
    return json.dumps(values, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
