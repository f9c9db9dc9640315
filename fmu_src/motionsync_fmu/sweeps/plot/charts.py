"""The charts of a sweep: a map of two columns, and curves over the first."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...pages.numbers import rounded
from ...pages.report.chart import INK, PAPER, Chart, Style
from ...pages.style import typeset
from ...scenario.evaluate.time_series import true_stretches
from ...scenario.recording import Reals
from ..database import Answer, Column
from .cells import Axis, CellStatistic
from .curves import Boundary
from .example_runs import ExampleRuns

SHARE = ((0.0, "--share-0"), (0.5, "--share-1"), (1.0, "--share-2"))
HEAT = tuple((i / 8, f"--heat-{i}") for i in range(9))
TEXTS = tuple(f"--band-{i}" for i in (1, 5, 3, 2, 4, 6, 7))  # of the most frequent ones
OTHER, NO_VALUE = "--muted", "--band-0"
MARKED = 40  # points of a line at most that have markers
LINES = 8  # colours of lines
HEIGHT = 430
BELOW = -22  # px from a map to what is written below it
TOP, ABOVE = 100, 64  # px above a map with its scale of colours, and to what is written above that
DECADES = 3.0  # values > 0 over more decades are drawn by their logarithms


def spread(values: Reals) -> bool:
    """Whether values are drawn by their logarithms."""
    finite = values[np.isfinite(values)]
    return bool(len(finite) and finite.min() > 0.0 and np.log10(finite.max() / finite.min()) > DECADES)


def map_chart(
    name: str, x: Axis, y: Axis, cells: Answer, statistic: CellStatistic, scale_title: str
) -> tuple[Chart, dict[str, Any]]:
    """The map without its cells, which the page's script paints, and how it paints them: the least and the greatest
    value, whether by logarithms; of texts, the texts that have colours of their own."""
    chart = Chart(name, [HEIGHT], "", (float(x.edges[0]), float(x.edges[-1])), "closest", timed=False)
    below = {"x": 0.5, "y": 0, "xanchor": "center", "yanchor": "top", "yshift": BELOW, "font": {"size": 14}}
    chart.annotate(x.column.title, yref="paper", **below)  # plotly.js misplaces a title next to a scale of colours
    chart.axis(1).update({"range": [float(y.edges[0]), float(y.edges[-1])]})
    chart.write_title(1, y.column.title)
    chart.layout["showlegend"] = False
    for axis, given in (("xaxis", x), ("yaxis", y)):
        chart.layout[axis].update({"showgrid": False, "zeroline": False, "ticks": "outside"})
        if given.names:
            chart.layout[axis] |= {"tickvals": given.low.tolist(), "ticktext": list(given.names)}
    if statistic.name == "most":
        texts, counts = np.unique([t for t in cells["value"].tolist() if t], return_counts=True)
        listed = [str(t) for t in texts[np.argsort(-counts, kind="stable")]][: len(TEXTS)]
        chart.layout["meta"] |= {"role": "map", "texts": list(TEXTS), "other": OTHER, "none": NO_VALUE}
        return chart, {"texts": listed}
    values = cells["value"].astype(float)
    logarithmic = statistic.name != "share" and spread(values)
    low, high = (0.0, 1.0) if statistic.name == "share" else _ends(values)
    scale = SHARE if statistic.name == "share" else HEAT
    chart.layout["meta"] |= {"role": "map", "scale": [list(stop) for stop in scale], "none": NO_VALUE}
    chart.layout["height"] += TOP - chart.layout["margin"]["t"]
    chart.layout["margin"] |= {"t": TOP, "autoexpand": False}  # the scale would reserve its margin a second time
    chart.add_trace(1, "scale", _scale(low, high, scale, logarithmic=logarithmic, share=statistic.name == "share"))
    chart.annotate(
        scale_title, yref="paper", x=0, y=1, xanchor="left", yanchor="bottom", yshift=ABOVE, font={"size": 13}
    )
    return chart, {"low": low, "high": high, "logarithmic": logarithmic}


def _ends(values: Reals) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    return (low, high) if high > low else (low - 0.5 * abs(low) - 0.5, high + 0.5 * abs(high) + 0.5)


def _scale(
    low: float, high: float, scale: Sequence[tuple[float, str]], *, logarithmic: bool, share: bool
) -> dict[str, Any]:
    """A trace without points that has the scale of colours above the map."""
    ends = [float(np.log10(low)), float(np.log10(high))] if logarithmic else [low, high]
    bar: dict[str, Any] = {
        "orientation": "h", "x": 0, "xanchor": "left", "y": 1, "yanchor": "bottom", "ypad": 28, "xpad": 0,
        "thickness": 12, "len": 0.98, "outlinewidth": 0, "tickformat": ".4~g",
    }  # fmt: skip
    if share:
        bar |= {"tickformat": ".0%", "tickvals": [0, 0.25, 0.5, 0.75, 1], "ticklabeloverflow": "allow"}
    if logarithmic:
        decades = np.arange(np.ceil(ends[0]), np.floor(ends[1]) + 1)
        shown = decades[:: max(1, -(-len(decades) // 8))]
        bar |= {"tickvals": shown.tolist(), "ticktext": [f"{10.0**d:g}" for d in shown.tolist()]}
    marker = {"color": [ends[0]], "cmin": ends[0], "cmax": ends[1], "showscale": True, "size": 0.1, "opacity": 0}
    marker |= {"colorscale": [list(stop) for stop in scale], "colorbar": bar}
    return {"type": "scatter", "mode": "markers", "x": [None], "y": [None], "hoverinfo": "skip", "marker": marker}


def boundary_line(chart: Chart, x: Axis, answer: Boundary) -> None:
    """Draw, on a map, from where on every run passed."""
    middle, surely = x.middle[answer.points["cx"].astype(int)], answer.points["surely"]
    for colour, width in ((PAPER, 6.0), (INK, 2.5)):
        chart.draw_curve(1, "boundary", middle, surely, Style(colour, width))
        chart.traces[-1] |= {"hoverinfo": "skip", "hovertemplate": ""}


def comparison_lines(chart: Chart, x: Axis, lines: Sequence[tuple[Column, Answer]], groups: Axis | None) -> None:
    """Draw the means of further columns over x beside what the chart shows, in the colours of the same groups."""
    for i, (column, answer) in enumerate(lines):
        for line in _lines(x, answer, groups):
            style = Style(f"--line-{line.colour}", 2.0, ("dash", "dot", "dashdot")[i % 3])
            label = f"{line.label}, {column.name}" if line.label else column.name
            chart.draw_curve(1, column.name, line.x, line.of("mean"), style, label, column.unit)


def front_line(chart: Chart, points: Answer, examples: ExampleRuns) -> None:
    """Draw the Pareto front on a map."""
    trace = {"type": "scatter", "mode": "lines+markers", "x": rounded(points["x"], 9), "y": rounded(points["y"], 9)}
    marker = {"color": PAPER, "size": 9, "line": {"color": INK, "width": 2}}
    chart.add_trace(1, "Pareto front", trace | {"line": {"color": INK, "width": 2, "dash": "dot"}, "marker": marker})
    chart.traces[-1] |= {"hoverinfo": "none", "customdata": examples.indices_of(points["run"])}


def boundary_chart(
    name: str, x: Axis, y: Column, answer: Boundary, groups: Axis | None, examples: ExampleRuns
) -> Chart:
    """The boundary over x: a line for each group, from where on every run passed, and the band in which some did."""
    chart = _over(name, x, y, groups)
    for line in _lines(x, answer.points, groups):
        _band(chart, line, line.of("partly"), line.of("surely"))
        at_line = np.where(line.of("pick") >= 0, line.of("pick"), line.of("failed"))
        _draw(chart, line, line.of("surely"), y.unit, examples.indices_of(at_line))
    return chart


def curves_chart(name: str, x: Axis, y: Column, answer: Answer, groups: Axis | None, examples: ExampleRuns) -> Chart:
    """A result over x: a line for the mean of each group, and the band from the least to the greatest of its runs."""
    chart = _over(name, x, y, groups)
    if spread(np.concatenate([answer["least"], answer["greatest"]])):
        chart.axis(1).update({"type": "log", "tickformat": ".3~e"})
    for line in _lines(x, answer, groups):
        _band(chart, line, line.of("least"), line.of("greatest"))
        for key in ("least", "greatest"):
            _draw(chart, line, line.of(key), y.unit, examples.indices_of(line.of(f"pick_{key}")))
            hidden = {"mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", "hovertemplate": ""}
            chart.traces[-1] |= hidden | {"showlegend": False}
        _draw(chart, line, line.of("mean"), y.unit, examples.indices_of(line.of("pick")))
    return chart


def labels(groups: Axis | None) -> list[str]:
    """What the legend calls each group; one empty name if there are none."""
    if groups is None:
        return [""]
    if groups.names:
        return list(groups.names)
    unit = f" {typeset(groups.column.unit)}" if groups.column.unit else ""
    ends = zip(groups.low.tolist(), groups.high.tolist(), strict=True)
    return [f"{low:.5g}{unit}" if low == high else f"{low:.5g} to {high:.5g}{unit}" for low, high in ends]


def _over(name: str, x: Axis, y: Column, groups: Axis | None) -> Chart:
    chart = Chart(name, [HEIGHT], x.column.title, (float(x.edges[0]), float(x.edges[-1])), timed=False)
    chart.layout["meta"] |= {"role": "curves", "groups": groups.column.name if groups else ""}
    if groups:
        chart.layout["legend"]["title"] = {"text": groups.column.name, "side": "top"}
    chart.write_title(1, y.title)
    if x.names:
        chart.layout["xaxis"] |= {"tickvals": x.low.tolist(), "ticktext": list(x.names)}
    return chart


@dataclass(frozen=True)
class _Line:
    """One group's points over x. `colour`: the number of its colour."""

    label: str
    colour: int
    points: Answer
    selected: NDArray[np.bool_]
    x: Reals

    def of(self, key: str) -> NDArray[Any]:
        """A column of the group's points."""
        return np.asarray(self.points[key][self.selected])


def _lines(x: Axis, points: Answer, groups: Axis | None) -> Iterator[_Line]:
    """The groups in their order; their colours are as far apart as they can be."""
    names = labels(groups)
    for group, label in enumerate(names):
        selected = points["group"] == group
        colour = round(group * (LINES - 1) / (len(names) - 1)) if len(names) > 1 else 0
        yield _Line(label, colour, points, selected, x.middle[points["cx"][selected].astype(int)])


def _band(chart: Chart, line: _Line, low: Reals, high: Reals) -> None:
    """Shade between two lines wherever both have a value."""
    is_finite = np.isfinite(low) & np.isfinite(high)
    if not np.any(low[is_finite] != high[is_finite]):
        return
    x: list[Any] = []
    y: list[Any] = []
    for begin, end in true_stretches(is_finite):
        part = slice(begin, end)
        x += [*rounded(line.x[part], 9), *rounded(line.x[part][::-1], 9), None]
        y += [*rounded(low[part]), *rounded(high[part][::-1]), None]
    chart.draw_area(1, line.label, x, y, f"--shade-{line.colour}", {"width": 0}, legend=bool(line.label))
    chart.traces[-1]["showlegend"] = False


def _draw(chart: Chart, line: _Line, values: Reals, unit: str, indices: Sequence[int]) -> None:
    """Draw a line; each point carries its number of runs and the number of an example run."""
    chart.draw_curve(1, line.label, line.x, values, Style(f"--line-{line.colour}", 2.5), unit=unit)
    if len(line.x) <= MARKED:
        chart.traces[-1] |= {"mode": "lines+markers", "marker": {"size": 5, "color": f"--line-{line.colour}"}}
    custom_data = zip(line.of("runs").tolist(), indices, strict=True)
    chart.traces[-1] |= {"customdata": [list(t) for t in custom_data], "showlegend": bool(line.label)}
