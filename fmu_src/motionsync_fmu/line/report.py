"""One self-contained HTML page of a line: the errors of each variant, and the outputs of the wired one."""

from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from motionsync.var import Unit

from .. import __version__
from ..interface.units import unit_name
from ..pages.report import GREY, RECEIVED, REFERENCE, curve, cut_plots, html, plots
from ..pages.style import SLAVE, TEMPLATES
from ..scenario.cuts import Cut
from .judge import Result
from .line import REMOTE, Line
from .variants import Switch, Variant

HUES = (SLAVE, RECEIVED, REFERENCE, "#17713a")  # the colours of the variants
ROWS = (("all variants", 260), ("as wired", 185), ("index error", 185))
ROOM = 1.3  # height of the wired variant's own row, as a multiple of its greatest error once in sync


def write_line_report(file: Path, line: Line, result: Result) -> None:
    """Write the page; it loads nothing from elsewhere."""
    s = line.follower
    blocks = {name: recipe.variables for name, recipe in line.recipes.items()}
    by_name = blocks[s.recipe.name]
    clocks, wired = line.remote.clocks, result.wired
    starts = {REMOTE: line.start, s.recipe.name: s.start}
    values: dict[str, Any] = {
        "line": line,
        "s": s,
        "result": result,
        "version": __version__,
        "clocks": clocks,
        "drift": 1e6 * (line.remote.data_cycle / clocks.rates[0].cycle - 1.0),
        "synced": result.after[0].away is not None,
        "unit": unit_name(Unit.POSITION, line.unit),
        "error_plots": html(_error_plots(line, result), plotly=True),
        "event_plots": html(_event_plots(line, result)) if wired.cuts or wired.switches else "",
        "plots": html(plots(s, wired.recording, by_name)),
        "cut_plots": html(cut_plots(s.cuts, wired.cuts, s, wired.recording)) if s.cuts and wired.cuts else "",
        "starts": [(c, n, blocks[c][n].text(value)) for c, given in starts.items() for n, value in given.items()],
        "settings": [(x.at, n, by_name[n].text(value)) for x in s.settings for n, value in x.values.items()],
    }
    file.write_text(TEMPLATES.get_template("line.html.j2").render(values), "utf-8")


def _hues(result: Result) -> list[tuple[Variant, str]]:
    return [(variant, HUES[i % len(HUES)]) for i, variant in enumerate(result.variants)]


def _error_plots(line: Line, result: Result) -> Any:
    """Over time: the slave's error in all variants, the same in the wired variant alone, and the index errors."""
    heights = [height for _, height in ROWS]
    figure = make_subplots(rows=len(ROWS), cols=1, shared_xaxes=True, vertical_spacing=0.04, row_heights=heights)
    for variant, hue in reversed(_hues(result)):
        width = 2.0 if variant is result.wired else 1.0
        curve(figure, 1, variant.name, line.times, variant.away, hue, width)
        curve(figure, 3, variant.name, line.times, variant.index, hue, width)
    curve(figure, 2, result.wired.name, line.times, result.wired.away, SLAVE, 2.0)
    if greatest := result.after[0].away:
        figure.update_yaxes(range=[-ROOM * greatest, ROOM * greatest], row=2, col=1)
    unit = unit_name(Unit.POSITION, line.unit)
    for i, ((name, _), of) in enumerate(zip(ROWS, (unit, unit, "cycles"), strict=True), 1):
        title = name if i == len(ROWS) else f"slave's error,<br>{name}"
        figure.update_yaxes(title_text=f"{title}<br>{of}", row=i, col=1)
    if result.synced <= line.times[-1]:
        figure.add_vline(x=result.synced, line={"color": GREY, "width": 1, "dash": "dash"})
        figure.add_annotation(
            x=result.synced, y=1.0, yref="paper", yanchor="bottom", xanchor="left", text="synced", showarrow=False
        )
    figure.update_xaxes(title_text="time in s", row=len(ROWS), col=1)
    figure.update_layout(height=sum(heights) + 150, margin={"t": 40, "r": 20, "l": 80, "b": 60}, hovermode="x unified")
    figure.update_layout(template="plotly_white", legend={"orientation": "h", "yref": "container", "y": 0.0})
    return figure


def _event_plots(line: Line, result: Result) -> Any:
    """The magnitude of each cut's error, or of each switch's, in each variant, on a logarithmic scale."""
    unit, what = unit_name(Unit.POSITION, line.unit), "cut" if result.wired.cuts else "switch"
    figure = go.Figure()
    for variant, hue in _hues(result):
        events: list[Cut] | list[Switch] = variant.cuts or variant.switches
        figure.add_trace(
            go.Bar(
                x=list(range(1, len(events) + 1)),
                y=[abs(e.error) for e in events],
                name=variant.name,
                marker={"color": hue},
                customdata=[e.error for e in events],
                hovertemplate=f"{what} %{{x}}: %{{customdata:.3g}} {unit}<extra>{variant.name}</extra>",
            )
        )
    figure.update_xaxes(title_text=what, dtick=1)
    figure.update_yaxes(title_text=f"|error| of the {what}<br>{unit}", type="log", exponentformat="power")
    figure.update_layout(height=360, margin={"t": 20, "r": 20, "l": 80, "b": 50}, template="plotly_white")
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom"}, barmode="group")
    return figure
