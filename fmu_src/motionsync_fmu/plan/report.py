"""One self-contained HTML page of a plan: its charts, its tables, the machine's data and the runs that confirm it."""

from pathlib import Path

from .. import __version__
from ..interface.units import unit_name
from ..pages.report.origin import here, now
from ..pages.report.page import bundle
from ..pages.style import TEMPLATES
from .charts import BANDS, PHASES, cycle_chart, over_length, over_velocity
from .console import DIGITS, table_columns, top_text
from .machine_data import BLOCK
from .plan import Plan
from .prediction import SHARE, Point


def write_plan(plan: Plan, folder: Path) -> Path:
    """Write the page into the folder, as report.html; it loads nothing from elsewhere."""
    data = plan.data
    shown = example(plan)
    variables = data.recipe.variables
    text = TEMPLATES.get_template("plan.html.j2").render(
        plan=plan,
        data=data,
        block=BLOCK,
        top=top_text(plan),
        share=100.0 * SHARE,
        charts=[over_length(plan).html(), over_velocity(plan).html()],
        tables=[table_columns(plan, points) for points in (plan.over_length, plan.over_velocity)],
        bands=BANDS,
        phases=list(PHASES.values()),
        shown=shown,
        cycle=cycle_chart(data, shown.velocity * (1.0 - 1e-6)).html() if shown else "",
        start=[
            (name, variables[name].text(value), unit_name(variables[name].declaration.unit, data.unit))
            for name, value in data.start.items()
        ],
        checks=[check for point in plan.points for check in point.checks],
        remarks=[point for point in plan.points if point.remark],
        version=__version__,
        date=now(),
        platform=here(),
        digits=DIGITS,
        bundle=bundle(),
    )
    folder.mkdir(parents=True, exist_ok=True)
    page = folder / "report.html"
    page.write_text(text, "utf-8")
    return page


def example(plan: Plan) -> Point | None:
    """The point whose cycle is drawn: the middle one of those over the length; None: none has a cycle."""
    points = [point for point in plan.over_length if point.cycle] or [p for p in plan.over_velocity if p.cycle]
    return points[len(points) // 2] if points else None
