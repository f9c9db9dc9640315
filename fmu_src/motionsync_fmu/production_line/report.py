"""One self-contained HTML page of a line: the errors of each variant, and the outputs of the wired one."""

import math
from pathlib import Path
from typing import Any

from markupsafe import Markup

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.report.chart import MASTER, RECEIVED, REFERENCE, SLAVE, Chart, Style
from ..pages.report.lanes import find_lanes
from ..pages.report.motion import fit, motion_units
from ..pages.report.origin import describe_fmu, origin_rows, shown_path
from ..pages.report.page import colour_keys, list_settings, plotly_script, run_charts
from ..pages.style import load_template
from ..scenario.engineering import engineering
from .evaluation import LineResult
from .line import REMOTE, ProductionLine
from .package import TEMPLATES, LinePackage
from .variants import Variant

HUES = (SLAVE, RECEIVED, REFERENCE, "--third", MASTER)  # the colours of the variants
ROWS = (("slave's error, all variants", 240), ("slave's error, as wired", 170), ("index error", 170))
HEADROOM = 1.3  # height of the wired variant's own row, as a multiple of its greatest error once in sync
FIGURES = 5  # significant digits of the greatest of the errors in a group, which all have as many decimals


def write_line_report(
    file: Path, line: ProductionLine, package: LinePackage, result: LineResult, outputs: Path
) -> None:
    """Write the page; it loads nothing from elsewhere. `outputs`: the file that it links to."""
    s = line.follower
    blocks = {name: recipe.variables for name, recipe in line.recipes.items()}
    clocks, wired = line.remote.clocks, result.wired
    starts = {REMOTE: line.start, s.recipe.name: s.start}
    figures = (*result.before, *result.after)
    charts = run_charts(s, wired.recording)
    values: dict[str, Any] = {
        "line": line,
        "s": s,
        "script": s.file.read_text("utf-8"),
        "result": result,
        "clocks": clocks,
        "drift": 1e6 * (line.remote.data_cycle / clocks.rates[0].cycle - 1.0),
        "synced": result.after[0].deviation is not None,
        "unit": unit_name(Unit.POSITION, line.unit),
        "lengths": decimals([x for f in figures for x in (f.worst, f.mean, f.spread, f.recorded, f.switches)]),
        "deviations": decimals([x for f in figures for x in (f.deviation, f.jump)]),
        "indices": decimals([f.index for f in figures]),
        "error_chart": error_chart(line, result).html(),
        "event_chart": event_chart(line, result).html() if wired.events else "",
        "checked": "length" if s.pieces else "cut",
        "errors_of": {
            kind: [{event.number: event.error for event in getattr(variant, kind)} for variant in result.variants]
            for kind in ("cuts", "products", "switches")
        },
        "charts": {name: chart.html() for name, chart in charts.items()},
        "keys": colour_keys(find_lanes(s, wired.recording)),
        "starts": [(c, n, blocks[c][n].text(value)) for c, given in starts.items() for n, value in given.items()],
        "settings": list_settings(s),
        "axis_units": motion_units(line.unit),
        "axis": list(zip(line.remote.axis.breaks, line.remote.axis.motions, strict=True)),
        "origin": origin_rows(
            {f"FMU of {name}": describe_fmu(fmu) for name, fmu in package.fmus.items()},
            {
                "line": shown_path(s.file),
                "outputs": Markup('<a href="{0}">{0}</a>, with all digits').format(outputs.name),
            },
        ),
        "engineering": engineering,
        "bundle": plotly_script(),
    }
    file.write_text(load_template(TEMPLATES, "line.html.j2").render(values), "utf-8")


def decimals(values: list[float | None]) -> int:
    """The number of decimals for a group of values, so that the greatest has FIGURES digits."""
    greatest = max((abs(x) for x in values if x is not None), default=0.0)
    return min(max(FIGURES - 1 - math.floor(math.log10(greatest)), 0), 9) if greatest > 0.0 else 0


def _colour_variants(result: LineResult) -> list[tuple[Variant, str]]:
    return [(variant, HUES[i % len(HUES)]) for i, variant in enumerate(result.variants)]


def error_chart(line: ProductionLine, result: LineResult) -> Chart:
    """Over time: the slave's error in all variants, the same in the wired variant alone, and the index errors. The
    wired variant is drawn last, over the others, and comes first in the legend."""
    span = (0.0, float(line.times[-1]))
    chart = Chart("Errors of the slave and of the index over time", [height for _, height in ROWS], "time in s", span)
    unit = unit_name(Unit.POSITION, line.unit)
    for i, (variant, hue) in reversed(list(enumerate(_colour_variants(result), 1))):
        style = Style(hue, 2.0 if variant is result.wired else 1.0)
        names = f"{variant.name}: slave's error", f"{variant.name}: index error"
        chart.draw_curve(1, variant.name, line.times, variant.deviation, style, names[0], unit, legend_rank=i)
        chart.draw_curve(3, variant.name, line.times, variant.index, style, names[1], "cycles", legend_rank=i)
    wired = result.wired
    style, title = Style(SLAVE, 2.0), f"{wired.name}: slave's error"
    chart.draw_curve(2, wired.name, line.times, wired.deviation, style, title, unit, legend_rank=1)
    for i, ((title, _), of) in enumerate(zip(ROWS, (unit, unit, "cycles"), strict=True), 1):
        chart.write_title(i, f"{title}{f' in {of}' if of else ''}")
    fit(chart, 1, [variant.deviation for variant in result.variants], 1.0)
    fit(chart, 3, [variant.index for variant in result.variants], 1.0)
    if greatest := result.after[0].deviation:
        chart.axis(2)["range"] = [-HEADROOM * greatest, HEADROOM * greatest]
    if result.synced <= line.times[-1]:
        chart.draw_vertical_line(result.synced, "in sync")
    return chart


def event_chart(line: ProductionLine, result: LineResult) -> Chart:
    """The magnitude of the error of each cut, switch or product in each variant, on a logarithmic scale."""
    unit, wired = unit_name(Unit.POSITION, line.unit), result.wired
    what = "product" if wired.products else "cut" if wired.cuts else "switch"
    most = max(event.number for variant in result.variants for event in variant.events)
    chart = Chart(f"Error of each {what}", [260], what, (0.5, most + 0.5), hover="closest", timed=False)
    chart.write_title(1, f"|error| of the {what}{f' in {unit}' if unit else ''}")
    for variant, hue in _colour_variants(result):
        errors = [event.error for event in variant.events]
        bars = {"type": "bar", "x": [event.number for event in variant.events], "y": [abs(error) for error in errors]}
        template = f"{what} %{{x}}: %{{customdata:.4~g}} {unit}<extra>%{{fullData.name}}</extra>"
        style = {"marker": {"color": hue}, "customdata": errors, "hovertemplate": template}
        chart.add_trace(1, variant.name, bars | style)
    chart.axis(1).update({"type": "log", "dtick": 1})
    chart.layout["xaxis"]["dtick"] = 1 + most // 20
    chart.layout["barmode"] = "group"
    return chart
