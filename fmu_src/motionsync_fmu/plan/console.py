"""Prints a plan for `motionsync plan-line`."""

from collections.abc import Sequence

from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.console import out, print_checks, print_table
from ..scenario.engineering import engineering
from .line_plan import LinePlan
from .prediction import LENGTH, SHARE, Prediction, find_bound

MOST_GAINS = 2  # in a row of a table
LEAST_GAIN = 0.02  # of SHARE: a lesser gain is not shown
DIGITS = 6


def print_plan(plan: LinePlan, *, verbose: bool) -> None:
    """Print the two tables of a plan, the notes, and the checks that failed; if `verbose`, all checks."""
    mark = "[green]confirmed[/]" if plan.is_confirmed else "[red]NOT confirmed[/]"
    source = f" ({escape(plan.data.origin)})" if plan.data.origin else ""
    runs = f"{plan.runs} run{'s' * (plan.runs != 1)} of the block"
    out.print(f"[bold]{escape(plan.data.title)}[/]{source}: {mark} by {runs}")
    out.print(f"  {escape(top_text(plan))}")
    _print_table("The greatest line velocity, over the length of the pieces", plan, plan.over_length)
    _print_table("The shortest length, over the line velocity", plan, plan.over_velocity)
    for note in dict.fromkeys(prediction.note for prediction in plan.predictions if prediction.note):
        where = [_describe_given(plan, prediction) for prediction in plan.predictions if prediction.note == note]
        out.print(f"[yellow]![/] {escape(note)}: {escape(', '.join(where))}")
    print_checks(c for prediction in plan.predictions for c in prediction.checks if verbose or not c.passed)


def top_text(plan: LinePlan) -> str:
    """What limits the line velocity however long the pieces are, in words."""
    data = plan.data
    top = data.greatest_velocity
    velocity = engineering(top, unit_name(Unit.VELOCITY, data.unit), digits=DIGITS)
    return f"greatest line velocity, for any length: {velocity}, limited by the carriage's {find_bound(data, top)}"


def _describe_given(plan: LinePlan, prediction: Prediction) -> str:
    """The length or line velocity that is given, in words."""
    length = prediction.given == LENGTH
    kind, value = (Unit.POSITION, prediction.length) if length else (Unit.VELOCITY, prediction.velocity)
    return f"{'length' if length else 'line at'} {engineering(value or 0.0, unit_name(kind, plan.data.unit))}"


def _print_table(title: str, plan: LinePlan, predictions: Sequence[Prediction]) -> None:
    """Print a row for each prediction; a column that would be empty is left out."""
    columns = {name: texts for name, texts in table_columns(plan, predictions).items() if any(texts)}
    table = Table(*columns, title=f"\n{title}", title_justify="left", box=None)
    for texts in zip(*columns.values(), strict=True):
        table.add_row(*texts)
    print_table(table)


def table_columns(plan: LinePlan, predictions: Sequence[Prediction]) -> dict[str, list[str]]:
    """The columns of a table of predictions, each with its heading and a text for each prediction."""
    u, v = unit_name(Unit.POSITION, plan.data.unit), unit_name(Unit.VELOCITY, plan.data.unit)
    over_length = predictions[0].given == LENGTH
    length = _column("length", u, [p.length for p in predictions])
    velocity = _column("line velocity", v, [p.velocity or None for p in predictions])
    side, unit = ("above", v) if over_length else ("below", u)
    lost = _column(f"cuts lost {side}", unit, [p.lost for p in predictions])
    parts = [list(p.cycle.parts) for p in predictions if p.cycle]
    times = {name: [_time(p.cycle.parts[name]) if p.cycle else "" for p in predictions] for name in (parts or [[]])[0]}
    columns = (length | velocity if over_length else velocity | length) | lost
    columns |= {"limited by": [p.limited_by for p in predictions]}
    columns |= {f"{100.0 * SHARE:g} % brings": [gains_text(p) for p in predictions]}
    columns |= {"cycle s": [_time(p.cycle.time) if p.cycle else "" for p in predictions]} | times
    columns |= _column("stroke", u, [p.stroke for p in predictions])
    columns |= _motor_columns(predictions)
    columns |= {"confirmed": [_confirmed(p) for p in predictions]}
    return columns


def _column(name: str, unit: str, values: Sequence[float | None]) -> dict[str, list[str]]:
    texts = ["none" if value is None else engineering(value, digits=DIGITS) for value in values]
    return {f"{name} {unit}".strip(): texts}


def _motor_columns(predictions: Sequence[Prediction]) -> dict[str, list[str]]:
    """The forces of the motor, with the share of what it can give: `450.4, 50 %`; none if the load is not known."""
    used = [p.motor for p in predictions]
    unit = next((motor.unit for motor in used if motor), "")
    return {
        f"force {name} {unit}": [_force(getattr(m, name), getattr(m, f"{name}_share")) if m else "" for m in used]
        for name in ("rms", "peak")
    }


def _force(force: float, share: float | None) -> str:
    return engineering(force) + ("" if share is None else f", {100.0 * share:.3g} %{'!' * (share > 1.0)}")


def _time(value: float) -> str:
    return engineering(value, digits=4) if value else ""


def _confirmed(prediction: Prediction) -> str:
    if not prediction.checks:
        return "not run"
    return f"{'yes' if prediction.is_confirmed else 'NO'}{'!' * bool(prediction.note)}"


def gains_text(prediction: Prediction) -> str:
    """The greatest gains of a prediction, in words: `cut 0.25 %, acceleration 0.14 %`."""
    gains = {name: gain for name, gain in prediction.gains.items() if gain > LEAST_GAIN * SHARE}
    greatest = sorted(gains, key=gains.__getitem__, reverse=True)[:MOST_GAINS]
    return ", ".join(f"{name} {100.0 * gains[name]:.2f} %" for name in greatest)
