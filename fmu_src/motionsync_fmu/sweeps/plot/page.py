"""The HTML page of a sweep, and the data that its script needs."""

import shlex
from pathlib import Path
from typing import Any

import numpy as np
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup

from ...errors import UserError
from ...pages.numbers import evenly_spaced
from ...pages.report.chart import Chart, to_compact_json
from ...pages.report.page import plotly_script
from ...pages.style import load_template, typeset
from ...paths import replace_file
from ...scenario.files.shipped import scenario_name
from ..database import Database
from ..sweep_plan import SCENARIO, SweepPlan
from ..table import Rows
from . import texts
from .cells import Axis
from .charts import boundary_chart, boundary_line, comparison_lines, curves_chart, front_line, map_chart
from .distribution_view import (
    HEIGHT,
    DistributionView,
    build_distribution,
    distribution_figures,
    distribution_text,
)
from .packing import bytes_packed, texts_packed
from .units import units
from .view import Question, View, build_view

TEMPLATES = Path(__file__).parent / "templates"
LINES = (  # colours of lines, on a light page and on a dark one
    ("440154", "46327e", "365c8d", "277f8e", "1a8a6b", "3f9b3a", "a07c00", "c8451b"),
    ("c792ea", "8f9bff", "5aa9e6", "4fc3c9", "4fd69c", "a3d95a", "f2c14e", "ff7a4a"),
)
ROWS = 25  # of the table of a front


Content = dict[str, Any]
"""What a page has of a question's answer, as its template names it; `script`: what the page's script needs."""
Section = tuple[str, str, Markup, list[tuple[str, str]]]
"""A chart with its heading, what it shows, the chart itself, and names with their colours."""


def make_page(folder: Path, question: Question, file: Path | None = None) -> Path:
    """Write the page of a sweep's folder; the answer is its file. `file`: None: plot.html in the folder.

    Raises:
        UserError: the folder is none of a sweep, a part is damaged, or the question has no answer.
    """
    if not folder.is_dir():
        raise UserError(f"{folder}: there is no such folder")
    rows = Rows(folder)
    plan = rows.plan
    db = Database(folder, rows.files, [factor.name for factor in plan.factors], units(plan))
    page = file or folder / "plot.html"
    if question.y:
        content = _view_content(plan, db, build_view(db, question))
    else:
        content = _distribution_content(plan, db, build_distribution(db, rows, question))
    write_page(page, folder, plan, content)
    return page


def write_page(file: Path, folder: Path, plan: SweepPlan, content: Content) -> None:
    """Write the page; it loads nothing from elsewhere. `folder`: that of the sweep."""
    scenario = plan.variation.scenario
    scenario_file = repeated(folder, plan)
    data = {"command": f"motionsync run {shlex.quote(scenario_file)}"} | content.pop("script")
    text = load_template(TEMPLATES, "sweep.html.j2").render(
        **content,
        lead=f"A sweep of {texts.counted(plan.runs)} of {scenario.recipe.name}: {scenario.title}.",
        varied=[(factor.name, factor.text) for factor in plan.factors],
        origin=texts.origin(plan, scenario_file),
        lines=LINES,
        data=htmlsafe_json_dumps(data, dumps=to_compact_json),
        bundle=plotly_script(),
    )
    with replace_file(file) as part:
        part.write_text(text, "utf-8")


def _view_content(plan: SweepPlan, db: Database, view: View) -> Content:
    sections, paint = _sections(view)
    return {
        "title": texts.title(view),
        "passing": texts.passing(view.condition),
        "figures": texts.figures(view),
        "sections": sections,
        "left_out": texts.left_out(plan, view),
        "script": _data(db, view) | {"paint": paint},
        "front": _front_rows(view),
        "front_columns": [view.x.column.title, view.y.title],
        "tables": [],
    }


def _distribution_content(plan: SweepPlan, db: Database, view: DistributionView) -> Content:
    title = f"Histogram of the {view.name}"
    chart = view.histogram().chart(title, HEIGHT)
    indices = view.examples.indices_of(view.bars["pick"])
    places = dict(zip(view.bars["cx"].tolist(), zip(view.bars["runs"].tolist(), indices, strict=True), strict=True))
    chart.traces[0]["customdata"] = [list(places.get(bar, (0, -1))) for bar in range(len(view.x))]
    chart.layout["meta"] |= {"role": "curves", "groups": "", "shows": {"what": f"{view.counted}: ", "unit": ""}}
    condition_columns = [db.columns[name] for name in view.condition.columns] if view.condition else []
    return {
        "title": f"Distribution of the {view.name}",
        "passing": texts.passing(view.condition),
        "figures": [*texts.run_figures(view.runs), *distribution_figures(view)],
        "sections": [(title, distribution_text(view), chart.html(), [])],
        "left_out": texts.left_out_of_distribution(plan, view.column, view.runs),
        "script": {
            "x": _packed_axis(view.x) | {"name": view.name},
            "runs": view.examples.packed(db, [*condition_columns, *view.shown_columns(db)]),
            "by_expectations": not view.condition,
            "statistic": None,
            "map": None,
        },
        "front": [],
        "tables": [*view.tables()],
    }


def repeated(folder: Path, plan: SweepPlan) -> str:
    """The scenario that repeats a run: the sweep's own file as long as it is the same, else the copy in the folder."""
    try:
        same = plan.file.read_text("utf-8-sig") == plan.text
    except (OSError, UnicodeDecodeError):
        same = False
    return scenario_name(plan.file.resolve()) if same else str(folder.resolve() / SCENARIO)


def _sections(view: View) -> tuple[list[Section], dict[str, Any]]:
    """The charts, and how the script paints the map."""
    sections: list[Section] = []
    paint: dict[str, Any] = {}
    x, y = view.x, view.y
    if view.boundary:
        title, text, what = texts.of_boundary(view)
        chart = boundary_chart(title, x, y, view.boundary, view.groups, view.examples)
        comparison_lines(chart, x, view.lines, view.groups)
        sections.append(_section(chart, title, text, what, y.unit))
    if view.curves and view.curved:
        title, text, what = texts.of_curves(view)
        chart = curves_chart(title, x, view.curved, view.curves, view.curve_groups, view.examples)
        if view.curved == y:
            comparison_lines(chart, x, view.lines, view.groups)
        sections.append(_section(chart, title, text, what, view.curved.unit))
    if view.cells and view.map_y:
        title, text = texts.of_map(view)
        chart, paint = map_chart(title, x, view.map_y, view.cells, view.statistic, texts.scale(view))
        if view.overall:
            boundary_line(chart, x, view.overall)
        if view.front:
            front_line(chart, view.front, view.examples)
        sections.append((title, text, chart.html(), texts.map_key(view, paint)))
    return sections, paint


def _data(db: Database, view: View) -> dict[str, Any]:
    column = view.statistic.column
    return {
        "x": _packed_axis(view.x),
        "runs": view.examples.packed(db, view.columns),
        "by_expectations": not view.condition_columns,
        "statistic": {
            "name": texts.LONG.get(view.statistic.name, view.statistic.name),
            "column": column.name if column else "",
            "unit": typeset(column.unit) if column else "",
        },
        "map": _packed_cells(view),
    }


def _packed_axis(axis: Axis) -> dict[str, Any]:
    numbers = {"edges": axis.edges.tolist(), "low": axis.low.tolist(), "high": axis.high.tolist()}
    return {"name": axis.column.name, "unit": typeset(axis.column.unit), "names": list(axis.names)} | numbers


def _packed_cells(view: View) -> dict[str, Any] | None:
    cells, y = view.cells, view.map_y
    if cells is None or y is None:
        return None
    text = view.statistic.name == "most"
    return {
        "y": _packed_axis(y),
        "cx": bytes_packed(cells["cx"], "<u2"),
        "cy": bytes_packed(cells["cy"], "<u2"),
        "runs": bytes_packed(np.minimum(cells["runs"], 2**32 - 1), "<u4"),
        "pick": bytes_packed(np.array(view.examples.indices_of(cells["pick"])), "<u4"),
        "value": texts_packed(cells["value"]) if text else bytes_packed(cells["value"], "<f4"),
        "least": None if text else bytes_packed(cells["least"], "<f4"),
        "greatest": None if text else bytes_packed(cells["greatest"], "<f4"),
    }


def _front_rows(view: View) -> list[tuple[int, int, str, str]]:
    """Some runs of the front, evenly chosen: the place among the examples, the number, x and y."""
    if view.front is None:
        return []
    size = len(view.front["run"])
    indices = view.examples.indices_of(view.front["run"])
    return [
        (indices[i], int(view.front["run"][i]), f"{view.front['x'][i]:.7g}", f"{view.front['y'][i]:.7g}")
        for i in evenly_spaced(size, ROWS).tolist()
    ]


def _section(chart: Chart, title: str, text: str, what: str, unit: str) -> Section:
    """`what`: what a point of the chart is, as the script shows it before the value."""
    chart.layout["meta"]["shows"] = {"what": what, "unit": typeset(unit)}
    return title, text, chart.html(), []
