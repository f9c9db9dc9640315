"""What `motionsync plan-line` prints of a plan."""

from collections.abc import Sequence

from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.console import out, print_checks, wide
from ..scenario.amounts import engineering
from .plan import Plan
from .prediction import LENGTH, SHARE, Point, bound_at

TOLD = 2  # gains that a row names
LEAST = 0.02  # of SHARE: a gain below it is not named
DIGITS = 6


def print_plan(plan: Plan, *, verbose: bool) -> None:
    """Print the two tables of a plan, what has to be known beside, and what is not as predicted.

    `verbose`: everything that was judged.
    """
    mark = "[green]confirmed[/]" if plan.confirmed else "[red]NOT confirmed[/]"
    source = f" ({escape(plan.data.origin)})" if plan.data.origin else ""
    runs = f"{plan.runs} run{'s' * (plan.runs != 1)} of the block"
    out.print(f"[bold]{escape(plan.data.title)}[/]{source}: {mark} by {runs}")
    out.print(f"  {escape(top_text(plan))}")
    _print_table("The greatest line velocity, over the length of the pieces", plan, plan.over_length)
    _print_table("The shortest length, over the line velocity", plan, plan.over_velocity)
    for remark in dict.fromkeys(point.remark for point in plan.points if point.remark):
        where = [_place(plan, point) for point in plan.points if point.remark == remark]
        out.print(f"[yellow]![/] {escape(remark)}: {escape(', '.join(where))}")
    print_checks(c for point in plan.points for c in point.checks if verbose or not c.passed)


def top_text(plan: Plan) -> str:
    """What limits the line velocity however long the pieces are, in words."""
    data = plan.data
    top = data.greatest_velocity
    velocity = engineering(top, unit_name(Unit.VELOCITY, data.unit), digits=DIGITS)
    return f"greatest line velocity, for any length: {velocity}, limited by the carriage's {bound_at(data, top)}"


def _place(plan: Plan, point: Point) -> str:
    """The length or line velocity for which a point was asked."""
    length = point.asked == LENGTH
    kind, value = (Unit.POSITION, point.length) if length else (Unit.VELOCITY, point.velocity)
    return f"{'length' if length else 'line at'} {engineering(value or 0.0, unit_name(kind, plan.data.unit))}"


def _print_table(title: str, plan: Plan, points: Sequence[Point]) -> None:
    """Print a row for each point; a column that would be empty is left out."""
    columns = {name: texts for name, texts in table_columns(plan, points).items() if any(texts)}
    table = Table(*columns, title=f"\n{title}", title_justify="left", box=None)
    for texts in zip(*columns.values(), strict=True):
        table.add_row(*texts)
    if out.is_terminal:
        out.print(table, soft_wrap=False)
    else:
        wide.print(table)


def table_columns(plan: Plan, points: Sequence[Point]) -> dict[str, list[str]]:
    """The columns of a table of points, each with its heading and a text for each point."""
    u, v = unit_name(Unit.POSITION, plan.data.unit), unit_name(Unit.VELOCITY, plan.data.unit)
    over_length = points[0].asked == LENGTH
    length = _column("length", u, [point.length for point in points])
    velocity = _column("line velocity", v, [point.velocity or None for point in points])
    side, unit = ("above", v) if over_length else ("below", u)
    lost = _column(f"cuts lost {side}", unit, [point.lost for point in points])
    parts = [list(point.cycle.parts) for point in points if point.cycle]
    times = {
        name: [_time(point.cycle.parts[name]) if point.cycle else "" for point in points] for name in (parts or [[]])[0]
    }
    columns = (length | velocity if over_length else velocity | length) | lost
    columns |= {"limited by": [point.limited_by for point in points]}
    columns |= {f"{100.0 * SHARE:g} % brings": [gains_text(point) for point in points]}
    columns |= {"cycle s": [_time(point.cycle.time) if point.cycle else "" for point in points]} | times
    columns |= _column("stroke", u, [point.stroke for point in points])
    columns |= {"confirmed": [_confirmed(point) for point in points]}
    return columns


def _column(name: str, unit: str, values: Sequence[float | None]) -> dict[str, list[str]]:
    texts = ["none" if value is None else engineering(value, digits=DIGITS) for value in values]
    return {f"{name} {unit}".strip(): texts}


def _time(value: float) -> str:
    return engineering(value, digits=4) if value else ""


def _confirmed(point: Point) -> str:
    if not point.checks:
        return "not run"
    return f"{'yes' if point.confirmed else 'NO'}{'!' * bool(point.remark)}"


def gains_text(point: Point) -> str:
    """The greatest gains of a point, in words: `cut 0.25 %, acceleration 0.14 %`."""
    named = sorted((name for name, gain in point.gains.items() if gain > LEAST * SHARE), key=lambda n: -point.gains[n])
    return ", ".join(f"{name} {100.0 * point.gains[name]:.2f} %" for name in named[:TOLD])
