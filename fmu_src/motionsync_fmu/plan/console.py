"""Prints a plan for `motionsync plan-line`."""

from collections.abc import Iterable, Sequence

from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.units import metres_per_minute
from ..pages.console import out, print_checks, print_table
from ..scenario.engineering import engineering, line_speed
from .comparison import Comparison
from .line_plan import LinePlan, MachinePlan
from .machine import Machine
from .prediction import LENGTH, SHARE, Gap, MotorUse, Prediction

MOST_GAINS = 2  # in a row of a table
LEAST_GAIN = 0.02  # of SHARE: a lesser gain is not shown
DIGITS = 6
SAME = 1e-9  # relative: where cuts are lost is the result itself


def print_plan(plan: LinePlan, *, verbose: bool) -> None:
    """Print which machine is better, the two tables of each, notes, and the checks that failed; if `verbose`, all."""
    if plan.comparison:
        out.print(f"[bold]{escape(plan.comparison.sentence)}[/]")
        _print_table("The greatest line velocity for the orders", comparison_columns(plan.comparison))
        out.print()
    for machine_plan in plan.machines:
        _print_machine(machine_plan)
    print_checks(c for prediction in plan.predictions for c in prediction.checks if verbose or not c.passed)


def _print_machine(plan: MachinePlan) -> None:
    """Print the two tables of a machine, and the notes."""
    mark = "[green]confirmed[/]" if plan.is_confirmed else "[red]NOT confirmed[/]"
    source = f" ({escape(plan.machine.origin)})" if plan.machine.origin else ""
    runs = f"{plan.runs} run{'s' * (plan.runs != 1)} of the block"
    out.print(f"[bold]{escape(plan.machine.title)}[/]{source}: {mark} by {runs}")
    out.print(f"  {escape(top_text(plan))}")
    if plan.working_points:
        _print_table("The given lengths at the given line velocities", working_point_columns(plan))
    _print_table(
        "The greatest line velocity, over the length of the pieces", table_columns(plan.machine, plan.over_length)
    )
    _print_table("The shortest length, over the line velocity", table_columns(plan.machine, plan.over_velocity))
    for note in dict.fromkeys(prediction.note for prediction in plan.predictions if prediction.note):
        where = [describe_given(plan.machine, p) for p in plan.predictions if p.note == note]
        out.print(f"[yellow]![/] {escape(note)}: {escape(', '.join(where))}")


def top_text(plan: MachinePlan) -> str:
    """The greatest line velocity at which all given lengths can be cut, and what limits it, in words; without given
    lengths that of the machine."""
    machine = plan.machine
    if not plan.has_given_lengths:
        velocity = line_speed(machine.greatest_velocity, machine.unit, digits=DIGITS)
        return f"greatest line velocity: {velocity}, {machine.greatest_velocity_bound}"
    least = min(plan.over_length, key=lambda prediction: prediction.velocity)
    velocity = line_speed(least.velocity, machine.unit, digits=DIGITS) if least.velocity else "none"
    pieces = f"pieces of {engineering(least.length or 0.0, machine.unit_of(Unit.POSITION), digits=DIGITS)}"
    which = f"for all given lengths, limited by {pieces}:" if plan.over_length[1:] else f"for {pieces}, limited by"
    return f"greatest line velocity: {velocity}, {which} {least.limited_by}"


def describe_given(machine: Machine, prediction: Prediction) -> str:
    """The length or line velocity that is given, in words."""
    if prediction.given == LENGTH:
        return f"length {engineering(prediction.length or 0.0, machine.unit_of(Unit.POSITION))}"
    return f"line at {line_speed(prediction.velocity, machine.unit)}"


def _print_table(title: str, columns: dict[str, list[str]]) -> None:
    """Print a table; a column that would be empty is left out."""
    columns = {name: texts for name, texts in columns.items() if any(texts)}
    table = Table(*columns, title=f"\n{title}", title_justify="left", box=None)
    for texts in zip(*columns.values(), strict=True):
        table.add_row(*texts)
    print_table(table)


def comparison_columns(comparison: Comparison) -> dict[str, list[str]]:
    """The columns of the table of all machines, with a text for each order."""
    machine = comparison.machines[0].machine
    columns = _column("length", machine.unit_of(Unit.POSITION), comparison.orders)
    for compared in comparison.machines:
        speeds = [line_speed(v, machine.unit, digits=DIGITS) if v > 0.0 else "none" for v in compared.velocities]
        columns |= {compared.label: speeds}
        if comparison.line_velocity:
            columns |= {
                f"margin of {compared.label}": [_margin(v, comparison.line_velocity) for v in compared.velocities]
            }
    return columns


def _margin(velocity: float, line_velocity: float) -> str:
    share = velocity / line_velocity - 1.0
    return f"{100.0 * share:.3g} %{'!' * (share < 0.0)}"


def working_point_columns(plan: MachinePlan) -> dict[str, list[str]]:
    """The columns of the table of given lengths at given line velocities, with a text for each."""
    machine, points = plan.machine, plan.working_points
    columns = _column("length", machine.unit_of(Unit.POSITION), [p.length for p in points])
    columns |= _column("line velocity", machine.unit_of(Unit.VELOCITY), [p.velocity for p in points])
    columns |= {"m/min": [_per_minute(p.velocity, machine.unit) for p in points]}
    columns |= {"margin": [_margin(p.greatest_velocity, p.velocity) for p in points]}
    return columns | _motor_columns([p.motor for p in points])


def table_columns(machine: Machine, predictions: Sequence[Prediction]) -> dict[str, list[str]]:
    """The columns of a table of predictions, each with its heading and a text for each prediction."""
    u, v = machine.unit_of(Unit.POSITION), machine.unit_of(Unit.VELOCITY)
    over_length = predictions[0].given == LENGTH
    length = _column("length", u, [p.length for p in predictions])
    velocity = _column("line velocity", v, [p.velocity or None for p in predictions])
    velocity |= {"m/min": [_per_minute(p.velocity, machine.unit) for p in predictions]}
    columns = length | velocity if over_length else velocity | length
    columns |= _lost_column(machine, predictions)
    columns |= {f"lost between {u}".strip(): [_gap(p.gap) if p.gap else "" for p in predictions]}
    columns |= {"limited by": [p.limited_by for p in predictions]}
    columns |= {f"{100.0 * SHARE:g} % brings": [gains_text(p) for p in predictions]}
    columns |= {"cycle s": [_time(p.cycle_time) for p in predictions]}
    for name in machine.part_colours:
        columns |= {name: [_time((p.cycle or {}).get(name)) for p in predictions]}
    for name, unit in dict.fromkeys((n, figure.unit) for p in predictions for n, figure in p.figures.items()):
        columns |= {f"{name} {unit}".strip(): [_figure(p, name) for p in predictions]}
    columns |= _motor_columns([p.motor for p in predictions])
    columns |= {"confirmed": [_confirmed(p) for p in predictions]}
    return columns


def _lost_column(machine: Machine, predictions: Sequence[Prediction]) -> dict[str, list[str]]:
    """Where cuts are lost, if that is not at the result itself."""
    over_length = predictions[0].given == LENGTH
    results = [p.velocity if over_length else p.length or 0.0 for p in predictions]
    if all(p.lost is None or abs(p.lost - x) <= SAME * x for p, x in zip(predictions, results, strict=True)):
        return {}
    side, kind = ("above", Unit.VELOCITY) if over_length else ("below", Unit.POSITION)
    return _column(f"cuts lost {side}", machine.unit_of(kind), [p.lost for p in predictions])


def _column(name: str, unit: str, values: Iterable[float | None]) -> dict[str, list[str]]:
    texts = ["none" if value is None else engineering(value, digits=DIGITS) for value in values]
    return {f"{name} {unit}".strip(): texts}


def _per_minute(velocity: float, unit: str) -> str:
    value = metres_per_minute(velocity, unit) if velocity else None
    return "" if value is None else engineering(value)


def _gap(gap: Gap) -> str:
    begin = engineering(gap.begin)
    return f"{begin} and more" if gap.end is None else f"{begin} and {engineering(gap.end)}"


def _figure(prediction: Prediction, name: str) -> str:
    return engineering(prediction.figures[name].value, digits=DIGITS) if name in prediction.figures else ""


def _motor_columns(used: Sequence[MotorUse | None]) -> dict[str, list[str]]:
    """The forces of the motor, with the share of what it can give: `450.4, 50 %`; none if the load is not known."""
    unit = next((motor.unit for motor in used if motor), "")
    quantity = "torque" if unit == "N m" else "force"
    return {
        f"{quantity} {name} {unit}": [_force(getattr(m, name), getattr(m, f"{name}_share")) if m else "" for m in used]
        for name in ("rms", "peak")
    }


def _force(force: float, share: float | None) -> str:
    return engineering(force) + ("" if share is None else f", {100.0 * share:.3g} %{'!' * (share > 1.0)}")


def _time(value: float | None) -> str:
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
