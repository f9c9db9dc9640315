"""A chart: rows of plots above one another over one axis, as plotly.js takes it.

Colours are names of CSS properties (`--slave`); the page's script puts their values in, those of a light or a dark
page.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup, escape

from ...scenario.recording import Reals
from ..numbers import NONE, TIME_DIGITS, Indices, points, rounded
from ..style import typeset

INK, PAPER, GRID, AXIS, MUTED = "--ink", "--paper", "--grid", "--axis", "--muted"
MASTER, SLAVE, REFERENCE, RECEIVED, LIMIT, OK, BAD = (
    "--master",
    "--slave",
    "--reference",
    "--received",
    "--limit",
    "--ok",
    "--bad",
)
TOP, GAP, BOTTOM, LEFT, RIGHT = 58, 34, 44, 62, 16  # px; the heights of rows are in px, too
CLEAR = "rgba(0,0,0,0)"
KINDS = 7  # colours of kinds of pieces


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
        name: what the chart shows, for those who cannot see it.
        heights: the height of each row, in px.
        title: what the horizontal axis shows.
        span: the least and the greatest value of the horizontal axis.
        hover: plotly.js' hovermode.
        timed: the horizontal axis is the time: all such charts of a page show the same stretch of it.
    """

    name: str
    heights: Sequence[int]
    title: str
    span: tuple[float, float]
    hover: str = "x unified"
    timed: bool = True
    traces: list[dict[str, Any]] = field(default_factory=list)
    layout: dict[str, Any] = field(default_factory=dict)
    shown: set[str] = field(default_factory=set)  # names in the legend

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
            "hoverlabel": {"bgcolor": PAPER, "bordercolor": AXIS, "font": {"color": INK}},
            "modebar": {"color": MUTED, "activecolor": INK, "bgcolor": CLEAR},
            "legend": {"orientation": "h", "x": 0, "y": 1 + 20 / inner, "yanchor": "bottom", "bgcolor": CLEAR},
            "annotations": [],
            "shapes": [],
            "meta": {"timed": self.timed, "rescaled": [], "span": list(self.span)},
            "xaxis": self._axis() | {"title": {"text": self.title}, "range": list(self.span)},
        }
        top = 1.0
        for row, height in enumerate(self.heights, 1):
            bottom = max(0.0, top - height / inner)
            self.layout[key(row)] = self._axis() | {"domain": [bottom, top], "anchor": "x"}
            top = bottom - GAP / inner
        if self.timed:
            self.layout["xaxis"]["unifiedhovertitle"] = {"text": "%{x:.6~f} s"}
        self.layout["xaxis"]["anchor"] = ref(len(self.heights))
        self.axes = len(self.heights)

    def _axis(self) -> dict[str, Any]:
        colours = {"gridcolor": GRID, "zerolinecolor": AXIS, "linecolor": AXIS, "tickcolor": AXIS}
        return colours | {"tickformat": ".6~g"}

    def axis(self, row: int) -> dict[str, Any]:
        """The vertical axis with this number."""
        found: dict[str, Any] = self.layout[key(row)]
        return found

    def head(self, row: int, text: str) -> None:
        """Write what a row shows above it."""
        self.note(text, yref=f"{ref(row)} domain", x=0, y=1, xanchor="left", yanchor="bottom", font={"size": 13})

    def note(self, text: str, **where: Any) -> None:
        """Write a text; `where` as plotly.js has it for annotations."""
        given = {"text": text, "showarrow": False, "xref": "paper", "bgcolor": PAPER, "borderpad": 0, "opacity": 0.85}
        self.layout["annotations"].append(given | where)

    def behind(self, row: int) -> int:
        """A further axis from 0 to 1 behind a row, for what is shaded; the answer is its number."""
        number = self._further(row, {"range": [0, 1], "fixedrange": True, "visible": False})
        self.axis(row).update({"overlaying": ref(number), "tickmode": "auto"})
        return number

    def beside(self, row: int, text: str, colour: str) -> int:
        """A further axis on the right of a row, over the same plot; the answer is its number."""
        ticks = {
            "side": "right",
            "showgrid": False,
            "zeroline": False,
            "tickfont": {"color": colour},
            "tickmode": "auto",
        }
        base = self.axis(row).get("overlaying", ref(row))
        number = self._further(row, ticks | {"overlaying": base})
        where = {"x": 1, "y": 1, "xanchor": "right", "yanchor": "bottom", "font": {"size": 13, "color": colour}}
        self.note(text, yref=f"{ref(row)} domain", **where)
        return number

    def _further(self, row: int, given: dict[str, Any]) -> int:
        self.axes += 1
        self.layout[key(self.axes)] = self._axis() | {"domain": self.axis(row)["domain"], "anchor": "x"} | given
        return self.axes

    def mark(self, time: float, text: str = "") -> None:
        """Draw a line through all rows at a place of the horizontal axis."""
        line = {
            "type": "line",
            "xref": "x",
            "yref": "paper",
            "x0": time,
            "x1": time,
            "y0": 0,
            "y1": 1,
            "layer": "below",
        }
        self.layout["shapes"].append(line | {"line": {"color": MUTED, "width": 1, "dash": "dot"}, "opacity": 0.5})
        if text:
            self.note(text, xref="x", yref="paper", x=time, y=1, xanchor="left", yanchor="top", font={"size": 11})

    def rescale(self, row: int) -> None:
        """Fit the axis with this number to what is to be seen whenever the horizontal axis changes."""
        self.layout["meta"]["rescaled"].append(key(row))

    def add(self, row: int, name: str, trace: dict[str, Any], *, legend: bool = True) -> None:
        """Add a trace; the legend has each name once, and switches all traces of that name."""
        first = legend and name not in self.shown
        self.shown |= {name} if legend else set()
        where = {"xaxis": "x", "yaxis": ref(row), "name": name, "showlegend": first}
        self.traces.append(where | ({"legendgroup": name} if legend else {}) | trace)

    def curve(
        self,
        row: int,
        name: str,
        time: Reals,
        values: Reals,
        style: Style,
        said: str = "",
        unit: str = "",
        *,
        kept: Indices = NONE,
        gaps: Indices = NONE,
        rank: int = 0,
    ) -> None:
        """Draw a line. `said`: what the pointer is told that the line shows, if not its name; `kept`: indices of
        points that must not be left out; `gaps`: those before which the line has a gap; `rank`: its place in the
        legend, 0: that of the order in which lines are drawn."""
        x, y = points(time, values, kept, gaps)
        self.add(
            row,
            name,
            {
                "type": "scatter",
                "mode": "lines",
                "x": x,
                "y": y,
                "line": {"color": style.colour, "width": style.width, "dash": style.dash},
                "hovertemplate": pointed(unit, said or name),
            }
            | ({"legendrank": rank} if rank else {}),
        )

    def markers(
        self, row: int, name: str, time: Reals, values: Reals, colour: str, said: str, unit: str, symbol: str
    ) -> None:
        """Draw a marker at each point."""
        self.add(
            row,
            name,
            {
                "type": "scatter",
                "mode": "markers",
                "x": rounded(time, TIME_DIGITS),
                "y": rounded(values),
                "marker": {"color": colour, "size": 5, "symbol": symbol},
                "hovertemplate": pointed(unit, said),
            },
        )

    def shade(self, row: int, name: str, stretches: Sequence[tuple[float, float]], colour: str) -> None:
        """Shade stretches over the whole height of the axis with this number, which goes from 0 to 1."""
        x = [e for begin, end in stretches for e in (begin, begin, end, end, None)]
        y = [e for _ in stretches for e in (0, 1, 1, 0, None)]
        area = {"type": "scatter", "mode": "lines", "x": x, "y": y, "fill": "toself", "fillcolor": colour}
        self.add(row, name, area | {"line": {"width": 0}, "opacity": 0.6, "hoverinfo": "skip"}, legend=False)

    def as_json(self) -> dict[str, Any]:
        """The chart as plotly.js takes it."""
        return {"data": self.traces, "layout": self.layout}

    def html(self) -> Markup:
        """The chart's place in the page, and its data."""
        data = htmlsafe_json_dumps(self.as_json(), dumps=_dumped)
        frame = Markup('<div class="plot" role="img" aria-label="{}" style="height:{}px"></div>\n')
        return frame.format(self.name, self.layout["height"]) + Markup(
            '<script type="application/json" class="plot-data">{}</script>\n'
        ).format(data)


def kind_colour(kind: int) -> str:
    """The CSS property with the colour of a kind of pieces."""
    return f"--kind-{kind % KINDS}"


def align(charts: Iterable[Chart]) -> None:
    """Give charts the same room on the right, so that the same times stand above one another."""
    together = list(charts)
    if any("side" in axis for chart in together for axis in chart.layout.values() if isinstance(axis, dict)):
        for chart in together:
            chart.layout["margin"]["r"] = LEFT


def key(row: int) -> str:
    """The name of a vertical axis in the layout."""
    return f"yaxis{row if row > 1 else ''}"


def ref(row: int) -> str:
    """The name by which traces mean a vertical axis."""
    return f"y{row if row > 1 else ''}"


def pointed(unit: str, name: str) -> str:
    """What the pointer is told at a point: its value, and the name of what it belongs to."""
    return f"%{{y:.6~g}} {escape(typeset(unit))}".rstrip() + f"<extra>{escape(name)}</extra>"


def _dumped(values: Any, **options: Any) -> str:
    return json.dumps(values, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
