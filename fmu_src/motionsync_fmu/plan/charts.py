"""The charts of a plan: over length, over line velocity, one cycle over time, and all machines together."""

from collections.abc import Callable, Sequence
from itertools import groupby

import numpy as np

from motionsync.var import Unit

from ..interface.units import metres_per_minute
from ..pages.numbers import TIME_DIGITS, evenly_spaced, rounded
from ..pages.report.chart import BAD, INK, OK, RECEIVED, REFERENCE, SLAVE, Chart, Style
from ..pages.style import with_unit
from ..scenario.evaluate.axis_figures import force_unit
from ..scenario.evaluate.time_series import true_stretches
from ..scenario.recording import Reals
from .comparison import Comparison
from .line_plan import MachinePlan
from .machine import Machine
from .motor import predict_motor_use
from .prediction import SHARE, Prediction

CURVE_POINTS = 120  # points of a curve
CYCLE_STEPS = 1500  # of the run of one cycle
MARGIN = 0.05  # of the range of the plan, below and above it
SLOW = 0.1  # of a machine's greatest line velocity: that of the shortest pieces in a comparison
NEAR = 1.5  # a limit is drawn where it is no more than so many times the greatest value
ROWS = (300, 190, 190)
OWN = "the scenario"
MOTOR_POINTS, MOTOR_ROW = 30, 150  # of a motor's curve; px
# colours of the gains by limits and by needs, in their sequence
LIMIT_COLOURS = ("--reference", "--slave", "--third", "--limit")
NEED_COLOURS = ("--muted", "--received", "--ink", "--slave", "--third", "--reference")
MACHINE_COLOURS = ((SLAVE, "--band-1"), (REFERENCE, "--tone-1"), ("--third", "--cut"))  # of a curve, of what is below


def chart_over_length(plan: MachinePlan) -> Chart:
    """Draw the greatest line velocity, the parts of the cycle at it, and the gains, over the length."""
    machine = plan.machine
    low, high = _span([point.length or 0.0 for point in plan.over_length])
    points = [p for x in _lengths(machine, low, high) if (p := machine.predict_greatest_velocity(x)).cycle]
    what = "greatest line velocity"
    chart = _chart(plan, f"The {what} over the length", "length of the pieces", Unit.POSITION, (low, high))
    _draw_result(chart, machine, what, Unit.VELOCITY, points, plan.over_length, _length, _velocity)
    if machine.orders and machine.line_velocity:
        own = np.array(machine.orders)
        _draw_own_points(chart, machine, own, np.full(len(own), machine.line_velocity), Unit.VELOCITY, OWN)
    _draw_parts(chart, machine, points, _length)
    _draw_gains(chart, machine, points, _length)
    _draw_motor(chart, machine, points, _length)
    return chart


def chart_over_velocity(plan: MachinePlan) -> Chart:
    """Draw the shortest length, the parts of the cycle, and the gains, over the line velocity."""
    machine = plan.machine
    velocities = [point.velocity for point in plan.over_velocity]
    top = machine.greatest_velocity
    low, high = _span([*velocities, top] if max(velocities) > top else velocities)
    spread = np.linspace(low, min(high, top), CURVE_POINTS).tolist()
    points = [p for x in spread if (p := machine.predict_shortest_length(x)).cycle]
    what = "shortest length"
    chart = _chart(plan, f"The {what} over the line velocity", "line velocity", Unit.VELOCITY, (low, high))
    _draw_result(chart, machine, what, Unit.POSITION, points, plan.over_velocity, _velocity, _length)
    _draw_gap(chart, points)
    if machine.orders and machine.line_velocity:
        own = np.array(machine.orders)
        _draw_own_points(chart, machine, np.full(len(own), machine.line_velocity), own, Unit.POSITION, OWN)
    _draw_parts(chart, machine, points, _velocity)
    _draw_gains(chart, machine, points, _velocity)
    _draw_motor(chart, machine, points, _velocity)
    chart.draw_vertical_line(top, "greatest line velocity")
    return chart


def chart_cycle(machine: Machine, length: float, velocity: float) -> Chart:
    """Draw position, velocity and acceleration of the slave in one cycle, from a run of the block."""
    run = machine.simulate_cycle(length, velocity, CYCLE_STEPS)
    time, state = run[:, 0], run[:, 4]
    tool = machine.tool
    chart = Chart(f"One cycle of the {tool} over time", [220, 150, 150], "time in s", (0.0, float(time[-1])))
    behind = chart.add_background_axis(1)
    for value, name in machine.state_names.items():
        inside = true_stretches(state == value)
        stretches = [(float(time[first]), float(time[min(end, len(time) - 1)])) for first, end in inside]
        if stretches:
            chart.shade_stretches(behind, name, stretches, machine.part_colours[name])
    kinds = (Unit.POSITION, Unit.VELOCITY, Unit.ACCELERATION)
    for row, (kind, limits) in enumerate(zip(kinds, machine.cycle_limits, strict=True), 1):
        name, unit, values = kind.name.lower(), machine.slave_unit_of(kind), run[:, row]
        title = with_unit(f"{tool}'s {name}", unit)
        chart.write_title(row, f"{title}, limit {_magnitudes(limits)}" if kind is not Unit.POSITION else title)
        chart.draw_curve(row, tool, time, values, Style(SLAVE, 2.2), f"{tool}'s {name}", unit)
        reach = NEAR * float(np.abs(values).max())
        for limit in limits:
            if abs(limit) <= reach:
                chart.draw_horizontal_line(row, "limit", limit)
    return chart


def _magnitudes(limits: Sequence[float]) -> str:
    """Limits in words, without their sign: `5000 and 10000`."""
    return " and ".join(f"{limit:g}" for limit in sorted({abs(limit) for limit in limits}))


def chart_comparison(comparison: Comparison) -> Chart:
    """Draw where each machine reaches, over length and line velocity, with the orders."""
    machines = [compared.machine for compared in comparison.machines]
    machine = machines[0]
    ranges = [m.length(pitch) for m in machines for pitch in m.pitch_range(SLOW * m.greatest_velocity)]
    low, high = _span([x for x in [*comparison.orders, *ranges] if x > 0.0])
    title = with_unit("length of the pieces", machine.unit_of(Unit.POSITION))
    chart = Chart("Where each machine reaches", [380], title, (low, high), timed=False)
    unit = machine.unit_of(Unit.VELOCITY)
    chart.write_title(1, with_unit("line velocity", unit))
    reaches = []
    for compared, colours in zip(comparison.machines, MACHINE_COLOURS, strict=False):
        lengths = np.array(_lengths(compared.machine, low, high))
        velocities = np.array([compared.machine.predict_greatest_velocity(x).velocity for x in lengths])
        reaches.append((compared.label, colours, lengths, velocities))
    names = {label: f"{label} cuts below this" for label, *_ in reaches}
    # An area hides what was drawn before it: first the greater one, and the lines at last.
    for label, (_, area), lengths, velocities in sorted(reaches, key=lambda reach: -float(reach[3].mean())):
        x, y = [float(lengths[0]), *lengths.tolist(), float(lengths[-1])], [0.0, *velocities.tolist(), 0.0]
        chart.draw_area(1, names[label], x, y, area, {"width": 0}, legend=True)
        chart.traces[-1]["showlegend"] = False
    for i, (label, (colour, _), lengths, velocities) in enumerate(reaches):
        chart.draw_curve(1, names[label], lengths, velocities, Style(colour, 2.5), label, unit)
        chart.traces[-1] |= _per_minute(machine, velocities, label) | {"showlegend": True, "legendrank": i + 1}
    if comparison.line_velocity:
        orders = np.array(comparison.orders)
        _draw_own_points(
            chart, machine, orders, np.full(len(orders), comparison.line_velocity), Unit.VELOCITY, "orders"
        )
    else:
        for order in comparison.orders:
            chart.draw_vertical_line(order)
    chart.include(1, 0.0)
    return chart


def _lengths(machine: Machine, low: float, high: float) -> list[float]:
    """The lengths at which a curve is computed."""
    special = [length for length in machine.special_lengths if low < length < high]
    return sorted([*np.linspace(low, high, CURVE_POINTS).tolist(), *special])


def _length(point: Prediction) -> float:
    return point.length or 0.0


def _velocity(point: Prediction) -> float:
    return point.velocity


def _span(values: Sequence[float]) -> tuple[float, float]:
    """The range of an axis for these values, all > 0."""
    low, high = min(values), max(values)
    margin = MARGIN * (high - low) or MARGIN * high
    return max(low - margin, 0.1 * low), high + margin


def _chart(plan: MachinePlan, name: str, title: str, kind: Unit, span: tuple[float, float]) -> Chart:
    heights = [*ROWS, *([MOTOR_ROW] if plan.machine.load else [])]
    return Chart(name, heights, with_unit(title, plan.machine.unit_of(kind)), span, timed=False)


Value = Callable[[Prediction], float]


def _values(points: Sequence[Prediction], value: Value) -> Reals:
    return np.array([value(point) for point in points])


def _per_minute(machine: Machine, velocities: Reals, name: str) -> dict[str, object]:
    """What the pointer shows of line velocities: each in m/min, too; nothing else for a unit that is no length."""
    if metres_per_minute(1.0, machine.unit) is None:
        return {}
    unit = machine.unit_of(Unit.VELOCITY)
    values = rounded((metres_per_minute(float(v), machine.unit) or 0.0 for v in velocities), 4)
    return {"customdata": values, "hovertemplate": f"%{{y:.6~g}} {unit} (%{{customdata}} m/min)<extra>{name}</extra>"}


def _draw_result(
    chart: Chart,
    machine: Machine,
    what: str,
    kind: Unit,
    points: list[Prediction],
    planned: list[Prediction],
    x: Value,
    result: Value,
) -> None:
    """Draw the result, where cuts are lost, what limits it, and the planned points, at which the block was run."""
    unit = machine.unit_of(kind)
    chart.write_title(1, with_unit(what, unit))
    behind = chart.add_background_axis(1)
    along, values = _values(points, x), _values(points, result)
    first = 0
    for bound, group in groupby(point.bound for point in points):
        end = first + len(list(group))
        stretch = (float(along[first]), float(along[min(end, len(along) - 1)]))
        chart.shade_stretches(behind, bound, [stretch], machine.bound_colours[bound])
        first = end
    lost = _values(points, lambda point: point.lost or 0.0)
    if np.any(np.abs(lost - values) > 1e-6 * values):
        chart.draw_curve(1, "cuts are lost from here on", along, lost, Style(REFERENCE, 1.5, "dash"), unit=unit)
    chart.draw_curve(1, what, along, values, Style(SLAVE, 2.5), unit=unit)
    if kind is Unit.VELOCITY:
        chart.traces[-1] |= _per_minute(machine, values, what)
    for passed, name, colour in ((True, "confirmed by runs", OK), (False, "not as predicted", BAD)):
        selected = [p for p in planned if p.checks and p.cycle and p.is_confirmed == passed]
        if selected:
            symbol = "circle" if passed else "x"
            chart.draw_markers(1, name, _values(selected, x), _values(selected, result), colour, name, unit, symbol)


def _draw_own_points(chart: Chart, machine: Machine, along: Reals, values: Reals, kind: Unit, name: str) -> None:
    """Mark lengths and line velocities of the user's own."""
    unit = machine.unit_of(kind)
    chart.draw_markers(1, name, along, values, INK, name, unit, "diamond")
    chart.traces[-1]["marker"]["size"] = 10
    if kind is Unit.VELOCITY:
        chart.traces[-1] |= _per_minute(machine, values, name)


def _draw_gap(chart: Chart, points: list[Prediction]) -> None:
    """Draw the lengths above the shortest one for which the line is too fast."""
    gaps = [(p.velocity, p.gap) for p in points if p.gap]
    if not gaps:
        return
    highest = max([gap.end or 0.0 for _, gap in gaps] + [_length(p) for p in points])
    x = [v for v, _ in gaps]
    ends = [gap.end or 1.1 * highest for _, gap in gaps]
    outline = rounded([*x, *reversed(x)], TIME_DIGITS), rounded([*(g.begin for _, g in gaps), *reversed(ends)])
    line = {"color": REFERENCE, "width": 1, "dash": "dash"}
    chart.draw_area(1, "too fast for these lengths", *outline, "--band-4", line, legend=True, opacity=0.6)


def _draw_parts(chart: Chart, machine: Machine, points: list[Prediction], x: Value) -> None:
    """Draw the parts of the cycle, stacked."""
    chart.write_title(2, "parts of the cycle in s")
    along = _values(points, x)
    for name, colour in machine.part_colours.items():
        values = np.array([(point.cycle or {})[name] for point in points])
        if values.any():
            chart.draw_curve(2, name, along, values, Style(colour, 0.5), unit="s")
            chart.traces[-1] |= {"stackgroup": "parts", "fillcolor": colour}


def _draw_gains(chart: Chart, machine: Machine, points: list[Prediction], x: Value) -> None:
    """Draw the gain by each limit and each need."""
    chart.write_title(3, f"what {100.0 * SHARE:g} % brings, in %")
    along = _values(points, x)
    limits = list(dict.fromkeys(name for p in points for name in p.gains if name not in machine.needs))
    styles = {name: Style(colour, 1.8) for name, colour in zip(limits, LIMIT_COLOURS, strict=False)}
    styles |= {n: Style(colour, 1.8, "dash") for n, colour in zip(machine.needs, NEED_COLOURS, strict=False)}
    for name, style in styles.items():
        values = 100.0 * np.array([point.gains.get(name, 0.0) for point in points])
        if values.any():
            text = f"{'less' if name in machine.needs else 'more'} {name}"
            chart.draw_curve(3, text, along, values, style, unit="%")


def _draw_motor(chart: Chart, machine: Machine, points: list[Prediction], x: Value) -> None:
    """Draw how much of the motor is used, or its forces where it is not known what it can give."""
    load = machine.load
    if load is None:
        return
    row = len(ROWS) + 1
    cycles = [p for p in points if p.cycle and p.length]
    selected = [cycles[i] for i in evenly_spaced(len(cycles), MOTOR_POINTS).tolist()]
    used = [predict_motor_use(machine, load, p.length or 0.0, p.velocity) for p in selected]
    along = _values(selected, x)
    curves = (
        ("rms of the motor", "rms", load.continuous_force, Style(RECEIVED, 2.0)),
        ("peak of the motor", "peak", load.peak_force, Style(INK, 2.0)),
    )
    shares = load.continuous_force is not None or load.peak_force is not None
    unit = "%" if shares else force_unit(load)
    quantity = "torque" if load.turns else "force"
    chart.write_title(row, f"use of the motor's {quantity} in %" if shares else with_unit(f"motor's {quantity}", unit))
    for name, key, can_give, style in curves:
        if can_give is not None or not shares:
            scale = 100.0 / can_give if can_give else 1.0
            chart.draw_curve(row, name, along, scale * np.array([getattr(m, key) for m in used]), style, unit=unit)
    if shares:
        chart.draw_horizontal_line(row, "all that the motor can give", 100.0)
    chart.include(row, 0.0)
