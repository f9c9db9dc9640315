"""The charts of a plan: over length, over line velocity, and one cycle of the carriage over time."""

from collections.abc import Callable, Sequence
from itertools import groupby

import numpy as np

from motionsync.cut_to_length.interface import State
from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.numbers import evenly_spaced
from ..pages.report.chart import BAD, INK, OK, RECEIVED, REFERENCE, SLAVE, Chart, Style
from ..pages.style import with_unit
from ..scenario.evaluate.axis_figures import force_unit
from ..scenario.recording import Reals
from .line_plan import LinePlan
from .machine_data import MachineData
from .motor import predict_motor_use
from .prediction import (
    CYCLE,
    NEEDS,
    SHARE,
    STROKE,
    VELOCITY,
    Prediction,
    predict_greatest_velocity,
    predict_shortest_length,
)
from .simulation import simulate_cycle

CURVE_POINTS = 120  # points of a curve
CYCLE_STEPS = 1500  # of the run of one cycle
MARGIN = 0.05  # of the range of the plan, below and above it
ROWS = (300, 190, 190)
MOTOR_POINTS, MOTOR_ROW = 30, 150  # of a motor's curve; px
BOUND_COLOURS = {CYCLE: "--band-0", STROKE: "--band-3", VELOCITY: "--band-1"}  # of what limits
# colours of the parts of a cycle, and of the gains by limits and by needs, in their sequence
PART_COLOURS = ("--tone-0", "--band-1", "--cut", "--band-3", "--band-5", "--tone-1", "--band-0")
LIMIT_COLOURS = ("--reference", "--slave", "--third", "--limit")
NEED_COLOURS = ("--muted", "--received", "--ink", "--slave", "--third", "--reference")
STATE_COLOURS = {  # the block's states in a cycle, with a name and a colour each
    State.APPROACHING: ("approach", PART_COLOURS[0]),
    State.SYNCHRONOUS: ("settling", PART_COLOURS[1]),
    State.CUTTING: ("cut", PART_COLOURS[2]),
    State.PULLING: ("gap", PART_COLOURS[3]),
    State.CLEARING: ("clearing", PART_COLOURS[4]),
    State.RETURNING: ("way home", PART_COLOURS[5]),
}


def chart_over_length(plan: LinePlan) -> Chart:
    """Draw the greatest line velocity, the parts of the cycle at it, and the gains, over the length."""
    data = plan.data
    low, high = _span([point.length or 0.0 for point in plan.over_length])
    points = [
        point for x in np.linspace(low, high, CURVE_POINTS) if (point := predict_greatest_velocity(data, x)).cycle
    ]
    what = "greatest line velocity"
    chart = _chart(plan, f"The {what} over the length", "length of the pieces", Unit.POSITION, (low, high))
    unit = unit_name(Unit.VELOCITY, data.unit)
    _draw_result(chart, what, unit, points, plan.over_length, _length, _velocity)
    _draw_parts(chart, points, _length)
    _draw_gains(chart, points, _length)
    _draw_motor(chart, data, points, _length)
    return chart


def chart_over_velocity(plan: LinePlan) -> Chart:
    """Draw the shortest length, the parts of the cycle, and the gains, over the line velocity."""
    data = plan.data
    velocities = [point.velocity for point in plan.over_velocity]
    top = data.greatest_velocity
    low, high = _span([*velocities, top] if max(velocities) > top else velocities)
    points = [predict_shortest_length(data, x) for x in np.linspace(low, min(high, top), CURVE_POINTS)]
    what = "shortest length"
    chart = _chart(plan, f"The {what} over the line velocity", "line velocity", Unit.VELOCITY, (low, high))
    _draw_result(chart, what, unit_name(Unit.POSITION, data.unit), points, plan.over_velocity, _velocity, _length)
    _draw_parts(chart, points, _velocity)
    _draw_gains(chart, points, _velocity)
    _draw_motor(chart, data, points, _velocity)
    chart.draw_vertical_line(top, "greatest line velocity")
    return chart


def chart_cycle(data: MachineData, velocity: float) -> Chart:
    """Draw position, velocity and acceleration of the carriage in one cycle, from a run of the block."""
    run = simulate_cycle(data, velocity, CYCLE_STEPS)
    time, state = run[:, 0], run[:, 4]
    chart = Chart("One cycle of the carriage over time", [220, 150, 150], "time in s", (0.0, float(time[-1])))
    behind = chart.add_background_axis(1)
    for value, (name, colour) in STATE_COLOURS.items():
        inside = time[state == value]
        if len(inside):
            chart.shade_stretches(behind, name, [(float(inside[0]), float(inside[-1]))], colour)
    m = data.machine
    slowing = -max(m.homing_acceleration, m.homing_deceleration)
    accelerations = [m.approach_acceleration, slowing, m.homing_deceleration]
    ends = ([m.home_position, m.max_position], [m.max_velocity, -m.homing_velocity], accelerations)
    kinds = (Unit.POSITION, Unit.VELOCITY, Unit.ACCELERATION)
    for row, (kind, limits) in enumerate(zip(kinds, ends, strict=True), 1):
        name, unit, values = kind.name.lower(), unit_name(kind, data.unit), run[:, row]
        chart.write_title(row, with_unit(f"carriage's {name}", unit))
        chart.draw_curve(row, "carriage", time, values, Style(SLAVE, 2.2), f"carriage's {name}", unit)
        reach = 1.5 * float(np.abs(values).max())
        for limit in limits:
            if abs(limit) <= reach:
                chart.draw_horizontal_line(row, "limit", limit)
    return chart


def _length(point: Prediction) -> float:
    return point.length or 0.0


def _velocity(point: Prediction) -> float:
    return point.velocity


def _span(values: Sequence[float]) -> tuple[float, float]:
    """The range of an axis for these values, all > 0."""
    low, high = min(values), max(values)
    margin = MARGIN * (high - low) or MARGIN * high
    return max(low - margin, 0.1 * low), high + margin


def _chart(plan: LinePlan, name: str, title: str, kind: Unit, span: tuple[float, float]) -> Chart:
    heights = [*ROWS, *([MOTOR_ROW] if plan.data.load else [])]
    return Chart(name, heights, with_unit(title, unit_name(kind, plan.data.unit)), span, timed=False)


Value = Callable[[Prediction], float]


def _values(points: Sequence[Prediction], value: Value) -> Reals:
    return np.array([value(point) for point in points])


def _draw_result(
    chart: Chart, what: str, unit: str, points: list[Prediction], planned: list[Prediction], x: Value, result: Value
) -> None:
    """Draw the result, where cuts are lost, what limits it, and the planned points, at which the block was run."""
    chart.write_title(1, with_unit(what, unit))
    behind = chart.add_background_axis(1)
    along, values = _values(points, x), _values(points, result)
    first = 0
    for bound, group in groupby(point.bound for point in points):
        end = first + len(list(group))
        chart.shade_stretches(
            behind, bound, [(float(along[first]), float(along[min(end, len(along) - 1)]))], BOUND_COLOURS[bound]
        )
        first = end
    lost = _values(points, lambda point: point.lost or 0.0)
    if np.any(np.abs(lost - values) > 1e-6 * values):
        chart.draw_curve(1, "cuts are lost from here on", along, lost, Style(REFERENCE, 1.5, "dash"), unit=unit)
    chart.draw_curve(1, what, along, values, Style(SLAVE, 2.5), unit=unit)
    for passed, name, colour in ((True, "confirmed by runs", OK), (False, "not as predicted", BAD)):
        selected = [p for p in planned if p.checks and p.cycle and p.is_confirmed == passed]
        if selected:
            symbol = "circle" if passed else "x"
            chart.draw_markers(1, name, _values(selected, x), _values(selected, result), colour, name, unit, symbol)


def _draw_parts(chart: Chart, points: list[Prediction], x: Value) -> None:
    """Draw the parts of the cycle, stacked."""
    chart.write_title(2, "parts of the cycle in s")
    along = _values(points, x)
    for i, name in enumerate(points[0].cycle.parts if points and points[0].cycle else ()):
        values = _values(points, lambda point, name=name: point.cycle.parts[name])  # type: ignore[misc]
        if values.any():
            chart.draw_curve(2, name, along, values, Style(PART_COLOURS[i], 0.5), unit="s")
            chart.traces[-1] |= {"stackgroup": "parts", "fillcolor": PART_COLOURS[i]}


def _draw_gains(chart: Chart, points: list[Prediction], x: Value) -> None:
    """Draw the gain by each limit and each need."""
    chart.write_title(3, f"what {100.0 * SHARE:g} % brings, in %")
    along = _values(points, x)
    names = list(points[0].gains if points else ())
    styles = [
        *(Style(colour, 1.8) for colour in LIMIT_COLOURS),
        *(Style(colour, 1.8, "dash") for colour in NEED_COLOURS),
    ]
    for name, style in zip(names, styles[: len(names)], strict=True):
        values = 100.0 * _values(points, lambda point, name=name: point.gains[name])  # type: ignore[misc]
        if values.any():
            chart.draw_curve(3, f"{'less' if name in NEEDS else 'more'} {name}", along, values, style, unit="%")


def _draw_motor(chart: Chart, data: MachineData, points: list[Prediction], x: Value) -> None:
    """Draw how much of the motor is used, or its forces where it is not known what it can give."""
    if data.load is None:
        return
    row = len(ROWS) + 1
    cycles = [p for p in points if p.cycle and p.length]
    selected = [cycles[i] for i in evenly_spaced(len(cycles), MOTOR_POINTS).tolist()]
    used = [predict_motor_use(data, data.load, p.length or 0.0, p.velocity) for p in selected]
    along = _values(selected, x)
    curves = (
        ("rms of the motor", "rms", data.load.continuous_force, Style(RECEIVED, 2.0)),
        ("peak of the motor", "peak", data.load.peak_force, Style(INK, 2.0)),
    )
    shares = data.load.continuous_force is not None or data.load.peak_force is not None
    unit = "%" if shares else force_unit(data.load)
    quantity = "torque" if data.load.turns else "force"
    chart.write_title(row, f"use of the motor's {quantity} in %" if shares else with_unit(f"motor's {quantity}", unit))
    for name, key, can_give, style in curves:
        if can_give is not None or not shares:
            scale = 100.0 / can_give if can_give else 1.0
            chart.draw_curve(row, name, along, scale * np.array([getattr(m, key) for m in used]), style, unit=unit)
    if shares:
        chart.draw_horizontal_line(row, "all that the motor can give", 100.0)
    chart.include(row, 0.0)
