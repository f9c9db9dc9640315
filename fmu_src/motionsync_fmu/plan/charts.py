"""The charts of a plan: over length, over line velocity, and one cycle of the carriage over time."""

from collections.abc import Callable, Sequence
from itertools import groupby

import numpy as np

from motionsync.cut_to_length.interface import State
from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.report.chart import BAD, LIMIT, OK, REFERENCE, SLAVE, Chart, Style
from ..pages.style import typeset
from ..scenario.recording import Reals
from .machine_data import MachineData
from .plan import Plan
from .prediction import CYCLE, NEEDS, SHARE, STROKE, VELOCITY, Point, fastest, shortest
from .simulation import cycle_motion

FINE = 120  # points of a curve
CYCLE_STEPS = 1500  # of the run whose cycle is drawn
MARGIN = 0.05  # beside the chosen points
ROWS = (300, 190, 190)
BANDS = {CYCLE: "--band-0", STROKE: "--band-3", VELOCITY: "--band-1"}  # what limits
PARTS = ("--tone-0", "--band-1", "--cut", "--band-3", "--band-5", "--tone-1", "--band-0")  # of a cycle, in its order
MORE = ("--reference", "--slave", "--third", "--limit")  # of each limit, in their order
LESS = ("--muted", "--received", "--ink", "--slave", "--third", "--reference")  # of each need, in their order
PHASES = {  # of the cycle that is drawn: the block's states, with a name and a colour each
    State.APPROACHING: ("approach", PARTS[0]),
    State.SYNCHRONOUS: ("settling", PARTS[1]),
    State.CUTTING: ("cut", PARTS[2]),
    State.PULLING: ("gap", PARTS[3]),
    State.CLEARING: ("clearing", PARTS[4]),
    State.RETURNING: ("way home", PARTS[5]),
}


def over_length(plan: Plan) -> Chart:
    """The greatest line velocity, the parts of the cycle at it, and what more of each limit brings, over the length."""
    data = plan.data
    low, high = _span([point.length or 0.0 for point in plan.over_length])
    points = [point for x in np.linspace(low, high, FINE) if (point := fastest(data, x)).cycle]
    what = "greatest line velocity"
    chart = _chart(plan, f"The {what} over the length", "length of the pieces", Unit.POSITION, (low, high))
    unit = unit_name(Unit.VELOCITY, data.unit)
    _draw_result(chart, what, unit, points, plan.over_length, _length, _velocity)
    _draw_parts(chart, points, _length)
    _draw_gains(chart, points, _length)
    return chart


def over_velocity(plan: Plan) -> Chart:
    """The shortest length, the parts of the cycle, and what more of each limit brings, over the line velocity."""
    data = plan.data
    asked = [point.velocity for point in plan.over_velocity]
    top = data.greatest_velocity
    low, high = _span([*asked, top] if max(asked) > top else asked)
    points = [shortest(data, x) for x in np.linspace(low, min(high, top), FINE)]
    what = "shortest length"
    chart = _chart(plan, f"The {what} over the line velocity", "line velocity", Unit.VELOCITY, (low, high))
    _draw_result(chart, what, unit_name(Unit.POSITION, data.unit), points, plan.over_velocity, _velocity, _length)
    _draw_parts(chart, points, _velocity)
    _draw_gains(chart, points, _velocity)
    chart.mark(top, "greatest line velocity")
    return chart


def cycle_chart(data: MachineData, velocity: float) -> Chart:
    """Position, velocity and acceleration of the carriage in one cycle at a line velocity, from a run of the block."""
    run = cycle_motion(data, velocity, CYCLE_STEPS)
    time, state = run[:, 0], run[:, 4]
    chart = Chart("One cycle of the carriage over time", [220, 150, 150], "time in s", (0.0, float(time[-1])))
    behind = chart.behind(1)
    for value, (name, colour) in PHASES.items():
        inside = time[state == value]
        if len(inside):
            chart.shade(behind, name, [(float(inside[0]), float(inside[-1]))], colour)
    m = data.machine
    ends = ([m.home_position, m.max_position], [m.max_velocity, -m.homing_velocity], _accelerations(data))
    kinds = (Unit.POSITION, Unit.VELOCITY, Unit.ACCELERATION)
    for row, (kind, limits) in enumerate(zip(kinds, ends, strict=True), 1):
        name, unit, values = kind.name.lower(), unit_name(kind, data.unit), run[:, row]
        chart.head(row, f"carriage's {name}{_in(unit)}")
        chart.curve(row, "carriage", time, values, Style(SLAVE, 2.2), f"carriage's {name}", unit)
        reach = 1.5 * float(np.abs(values).max())
        for limit in limits:
            if abs(limit) <= reach:
                line = {"x": list(chart.span), "y": [limit] * 2, "line": {"color": LIMIT, "width": 1.2, "dash": "dot"}}
                chart.add(row, "limit", {"type": "scatter", "mode": "lines", "hoverinfo": "skip"} | line)
    return chart


def _accelerations(data: MachineData) -> list[float]:
    m = data.machine
    return [m.approach_acceleration, -max(m.homing_acceleration, m.homing_deceleration), m.homing_deceleration]


def _length(point: Point) -> float:
    return point.length or 0.0


def _velocity(point: Point) -> float:
    return point.velocity


def _in(unit: str) -> str:
    return f" in {typeset(unit)}" if unit else ""


def _span(values: Sequence[float]) -> tuple[float, float]:
    """The range that is drawn around these values, all > 0."""
    low, high = min(values), max(values)
    room = MARGIN * (high - low) or MARGIN * high
    return max(low - room, 0.1 * low), high + room


def _chart(plan: Plan, name: str, title: str, kind: Unit, span: tuple[float, float]) -> Chart:
    unit = unit_name(kind, plan.data.unit)
    return Chart(name, ROWS, f"{title}{_in(unit)}", span, timed=False)


Value = Callable[[Point], float]


def _values(points: Sequence[Point], value: Value) -> Reals:
    return np.array([value(point) for point in points])


def _draw_result(
    chart: Chart, what: str, unit: str, points: list[Point], run: list[Point], x: Value, result: Value
) -> None:
    """Draw the result, from where on cuts are lost, what limits, and the points at which the block was run."""
    chart.head(1, f"{what}{_in(unit)}")
    behind = chart.behind(1)
    along, values = _values(points, x), _values(points, result)
    begin = 0
    for bound, group in groupby(point.bound for point in points):
        end = begin + len(list(group))
        chart.shade(behind, bound, [(float(along[begin]), float(along[min(end, len(along) - 1)]))], BANDS[bound])
        begin = end
    lost = _values(points, lambda point: point.lost or 0.0)
    if np.any(np.abs(lost - values) > 1e-6 * values):
        chart.curve(1, "cuts are lost from here on", along, lost, Style(REFERENCE, 1.5, "dash"), unit=unit)
    chart.curve(1, what, along, values, Style(SLAVE, 2.5), unit=unit)
    for passed, name, colour in ((True, "confirmed by runs", OK), (False, "not as predicted", BAD)):
        chosen = [p for p in run if p.checks and p.cycle and p.confirmed == passed]
        if chosen:
            symbol = "circle" if passed else "x"
            chart.markers(1, name, _values(chosen, x), _values(chosen, result), colour, name, unit, symbol)


def _draw_parts(chart: Chart, points: list[Point], x: Value) -> None:
    """Draw the parts of the cycle above one another."""
    chart.head(2, "parts of the cycle in s")
    along = _values(points, x)
    for i, name in enumerate(points[0].cycle.parts if points and points[0].cycle else ()):
        values = _values(points, lambda point, name=name: point.cycle.parts[name])  # type: ignore[misc]
        if values.any():
            chart.curve(2, name, along, values, Style(PARTS[i], 0.5), unit="s")
            chart.traces[-1] |= {"stackgroup": "parts", "fillcolor": PARTS[i]}


def _draw_gains(chart: Chart, points: list[Point], x: Value) -> None:
    """Draw what more of each limit, or less of each need, brings."""
    chart.head(3, f"what {100.0 * SHARE:g} % brings, in %")
    along = _values(points, x)
    names = list(points[0].gains if points else ())
    styles = [*(Style(colour, 1.8) for colour in MORE), *(Style(colour, 1.8, "dash") for colour in LESS)]
    for name, style in zip(names, styles[: len(names)], strict=True):
        values = 100.0 * _values(points, lambda point, name=name: point.gains[name])  # type: ignore[misc]
        if values.any():
            chart.curve(3, f"{'less' if name in NEEDS else 'more'} {name}", along, values, style, unit="%")
