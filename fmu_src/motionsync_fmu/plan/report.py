"""One self-contained HTML page of a plan: its charts, its tables, the machine's data and the runs that confirm it."""

from pathlib import Path

from ..interface.units import unit_name
from ..pages.report.limit_rows import limit_rows
from ..pages.report.origin import origin_rows
from ..pages.report.page import plotly_script
from ..pages.style import load_template
from ..paths import replace_file
from .charts import BOUND_COLOURS, STATE_COLOURS, chart_cycle, chart_over_length, chart_over_velocity
from .console import DIGITS, table_columns, top_text
from .line_plan import LinePlan
from .machine_data import BLOCK
from .prediction import SHARE, Prediction

TEMPLATES = Path(__file__).parent / "templates"


def write_plan(plan: LinePlan, folder: Path) -> Path:
    """Write the page into the folder, as report.html; it loads nothing from elsewhere."""
    data = plan.data
    example = select_example(plan)
    variables = data.recipe.variables
    text = load_template(TEMPLATES, "plan.html.j2").render(
        plan=plan,
        data=data,
        block=BLOCK,
        top=top_text(plan),
        share=100.0 * SHARE,
        charts=[chart_over_length(plan).html(), chart_over_velocity(plan).html()],
        tables=[table_columns(plan, predictions) for predictions in (plan.over_length, plan.over_velocity)],
        bound_colours=BOUND_COLOURS,
        states=list(STATE_COLOURS.values()),
        example=example,
        cycle=chart_cycle(data, example.velocity * (1.0 - 1e-6)).html() if example else "",
        start=[
            (name, variables[name].text(value), unit_name(variables[name].declaration.unit, data.unit))
            for name, value in data.start.items()
        ],
        limits=limit_rows(variables, data.start, data.unit),
        checks=[check for prediction in plan.predictions for check in prediction.checks],
        notes=[prediction for prediction in plan.predictions if prediction.note],
        origin=origin_rows({}, {"machine": data.origin} if data.origin else {}),
        digits=DIGITS,
        bundle=plotly_script(),
    )
    page = folder / "report.html"
    with replace_file(page) as part:
        part.write_text(text, "utf-8")
    return page


def select_example(plan: LinePlan) -> Prediction | None:
    """Select the prediction whose cycle is drawn: the middle one over the length; None: none has a cycle."""
    predictions = [p for p in plan.over_length if p.cycle] or [p for p in plan.over_velocity if p.cycle]
    return predictions[len(predictions) // 2] if predictions else None
