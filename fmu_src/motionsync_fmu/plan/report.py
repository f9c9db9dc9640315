"""One self-contained HTML page of a plan: its charts, its tables, the machines' data and the runs that confirm it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.report.limit_rows import limit_rows
from ..pages.report.origin import origin_rows
from ..pages.report.page import plotly_script
from ..pages.style import load_template
from ..paths import replace_file
from ..scenario.engineering import engineering, line_speed
from .charts import chart_comparison, chart_cycle, chart_over_length, chart_over_velocity
from .console import DIGITS, comparison_columns, describe_given, table_columns, top_text, working_point_columns
from .line_plan import LinePlan, MachinePlan
from .machine import Machine
from .prediction import SHARE

TEMPLATES = Path(__file__).parent / "templates"
BELOW = 1e-6  # relative: how far below a greatest line velocity a cycle is drawn


def write_plan(plan: LinePlan, page: Path) -> Path:
    """Write the page, and return its path; it loads nothing from elsewhere."""
    comparison = plan.comparison
    origins = {m.machine.kind if comparison else "machine": m.machine.origin for m in plan.machines}
    text = load_template(TEMPLATES, "plan.html.j2").render(
        plan=plan,
        share=100.0 * SHARE,
        comparison=comparison,
        comparison_chart=chart_comparison(comparison).html() if comparison else "",
        comparison_table=comparison_columns(comparison) if comparison else {},
        machines=[
            _machine_section(machine_plan, comparison.machines[i].label if comparison else "")
            for i, machine_plan in enumerate(plan.machines)
        ],
        checks=[check for prediction in plan.predictions for check in prediction.checks],
        origin=origin_rows({}, {name: origin for name, origin in origins.items() if origin}),
        bundle=plotly_script(),
    )
    with replace_file(page) as part:
        part.write_text(text, "utf-8")
    return page


def _machine_section(plan: MachinePlan, label: str) -> dict[str, Any]:
    """What the page shows of one machine; `label`: that of a comparison, empty where there is none."""
    machine, variables = plan.machine, plan.machine.recipe.variables
    units = (machine.unit, machine.slave_unit)
    example = select_example(plan)
    top, _, bound = top_text(plan).partition(": ")[2].partition(", ")
    return {
        "machine": machine,
        "of": f" of {label}" if label else "",
        "own": describe_own_line(machine),
        "top": top,
        "bound": bound,
        "charts": [chart_over_length(plan).html(), chart_over_velocity(plan).html()],
        "tables": [table_columns(machine, predictions) for predictions in (plan.over_length, plan.over_velocity)],
        "working_points": working_point_columns(plan) if plan.working_points else {},
        "has_gap": any(p.gap for p in plan.predictions),
        "example": example,
        "cycle": chart_cycle(machine, example.length, example.velocity).html() if example else "",
        "parts": [(name, machine.part_colours[name]) for name in machine.state_names.values()],
        "start": [
            (name, variables[name].text(value), unit_name(variables[name].declaration.unit, *units))
            for name, value in machine.start.items()
        ],
        "limits": limit_rows(variables, machine.start, *units),
        "notes": [f"{describe_given(machine, p)}: {p.note}" for p in plan.predictions if p.note],
    }


def describe_own_line(machine: Machine) -> str:
    """The scenario's lengths and line velocity, in words; empty: there is none."""
    if not (machine.orders and machine.line_velocity):
        return ""
    lengths = ", ".join(engineering(order, digits=DIGITS) for order in machine.orders)
    pieces = f"pieces of {lengths} {machine.unit_of(Unit.POSITION)}".rstrip()
    return f"{pieces} at {line_speed(machine.line_velocity, machine.unit, digits=DIGITS)}"


@dataclass(frozen=True)
class Example:
    """The cycle that is drawn.

    Attributes:
        length: of the pieces, in u.
        velocity: of the line, in u/s.
        text: both in words, and why this cycle is drawn.
    """

    length: float
    velocity: float
    text: str


def select_example(plan: MachinePlan) -> Example | None:
    """Select the cycle that is drawn: that of the shortest own order which the machine cuts at its own line velocity,
    else that at the greatest velocity for the middle one of the lengths; None: none has a cycle."""
    machine = plan.machine
    line_velocity = machine.line_velocity
    for order in machine.orders if line_velocity else ():
        if line_velocity and machine.predict_greatest_velocity(order).velocity > line_velocity:
            return Example(order, line_velocity, f"{_describe(machine, order, line_velocity)}, as in the scenario")
    predictions = [p for p in plan.over_length if p.cycle] or [p for p in plan.over_velocity if p.cycle]
    if not predictions:
        return None
    middle = predictions[len(predictions) // 2]
    length, velocity = middle.length or 0.0, middle.velocity * (1.0 - BELOW)
    text = f"{_describe(machine, length, velocity)}, the greatest line velocity for this length"
    if machine.orders and line_velocity:
        text += f"; the line of the scenario, at {line_speed(line_velocity, machine.unit)}, is too fast for its lengths"
    return Example(length, velocity, text)


def _describe(machine: Machine, length: float, velocity: float) -> str:
    pieces = engineering(length, machine.unit_of(Unit.POSITION), digits=DIGITS)
    return f"pieces of {pieces} at {line_speed(velocity, machine.unit, digits=DIGITS)}"
