"""What is true on a real machine: the lengths of the pieces by the tape measure, the axis behind its setpoint, and what
its motor has to give."""

from math import erf, sqrt

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.computed_columns import ACTUAL_POSITION, ACTUAL_VELOCITY, FOLLOWING_ERROR, FORCE, POWER
from ...scenario.engineering import engineering
from ...scenario.evaluate.axis_figures import LoadFigures, force_unit
from ...scenario.evaluate.true_pieces import TruePieces
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from ..numbers import DIGITS, TIME_DIGITS, Indices, evenly_spaced, rounded
from ..style import with_unit
from .chart import BAD, INK, LIMIT, MASTER, OK, RECEIVED, REFERENCE, SLAVE, Chart, Style, hover_template

MOST_BARS, LEAST_BARS = 40, 5
BEYOND = 0.25  # of the tolerance: so far behind it the histogram goes on where no error is
MOST_POINTS = 4000  # of the force over the velocity
CURVE = 200  # points of the normal curve


def chart_histogram(true: TruePieces) -> Chart:
    """How many pieces have which true error, within the tolerance, with the normal curve of the same mean and sigma."""
    errors = np.array([piece.error for piece in true.pieces])
    reach = max(float(np.abs(errors).max()), true.tolerance * (1.0 + BEYOND))
    borders = _borders(errors, reach)
    counts, _ = np.histogram(errors, borders)
    span = (min(-reach, float(borders[0])), max(reach, float(borders[-1])))
    chart = Chart(
        "Histogram of the true length errors",
        [220],
        with_unit("true length error", true.unit),
        span,
        hover="closest",
        timed=False,
    )
    chart.write_title(1, "pieces")
    width, middles = borders[1] - borders[0], 0.5 * (borders[1:] + borders[:-1])
    texts = [
        f"{engineering(low, true.unit)} to {engineering(high, true.unit)}"
        for low, high in zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True)
    ]
    bars = {"type": "bar", "x": rounded(middles), "y": counts.tolist(), "width": float(width), "customdata": texts}
    colours = [BAD if abs(middle) > true.tolerance else OK for middle in middles.tolist()]
    template = "%{y} pieces: %{customdata}<extra></extra>"
    chart.add_trace(1, "pieces", bars | {"marker": {"color": colours}, "hovertemplate": template}, legend=False)
    if true.deviation > 0.0:
        x = np.linspace(*span, CURVE)
        expected = _normal(x, true, float(errors.mean()), float(width), len(errors))
        line = {"type": "scatter", "mode": "lines", "hoverinfo": "skip", "line": {"color": INK, "width": 1.4}}
        chart.add_trace(1, "normal distribution", line | {"x": rounded(x), "y": rounded(expected, 4)})
    for limit in (-true.tolerance, true.tolerance):
        chart.draw_vertical_line(limit, f"tolerance {engineering(limit, true.unit)}")
    chart.axis(1)["rangemode"] = "tozero"
    return chart


def _borders(errors: Reals, reach: float) -> Reals:
    """Those of bars of equal width, one of which has its middle at 0; about as many bars as the root of the pieces."""
    spread = float(np.ptp(errors)) or 0.02 * reach
    bars = min(max(LEAST_BARS, round(sqrt(len(errors)))), MOST_BARS)
    width = spread / bars
    first, last = (int(np.floor(x / width + 0.5)) for x in (errors.min(), errors.max()))
    return np.asarray((np.arange(first, last + 2) - 0.5) * width, np.float64)


def _normal(x: Reals, true: TruePieces, mean: float, width: float, count: int) -> Reals:
    """How many pieces a bar of this width around x would have on average."""
    scaled = (np.stack([x - 0.5 * width, x + 0.5 * width]) - mean) / (sqrt(2.0) * true.deviation)
    below, until = ([0.5 * (1.0 + erf(value)) for value in row] for row in scaled.tolist())
    return np.asarray(count * (np.array(until) - np.array(below)), np.float64)


def chart_true_errors(scenario: Scenario, true: TruePieces) -> Chart:
    """The error of each piece over time: as the tape measure finds it, and as the block believes."""
    chart = Chart("True length errors over time", [200], "time in s", (0.0, scenario.stop_time))
    chart.write_title(1, with_unit("length error", true.unit))
    time = np.array([piece.at for piece in true.pieces])
    actual = np.array([piece.error for piece in true.pieces])
    chart.draw_markers(1, "true", time, actual, SLAVE, "true error", true.unit, "circle")
    if all(piece.believed is not None for piece in true.pieces):
        believed = np.array([(piece.believed or 0.0) - piece.ordered for piece in true.pieces])
        chart.draw_markers(1, "as the block believes", time, believed, REFERENCE, "believed error", true.unit, "x-thin")
        chart.traces[-1]["marker"] |= {"line": {"color": REFERENCE, "width": 1.5}, "size": 7}
    for limit in (-true.tolerance, true.tolerance):
        chart.draw_horizontal_line(1, "tolerance", limit)
    chart.write_limit(1, true.tolerance, f"tolerance {engineering(true.tolerance, true.unit)}")
    chart.include(1, 0.0)
    return chart


def chart_axis(scenario: Scenario, recording: Recording, load: LoadFigures | None, required: Indices) -> Chart:
    """The axis over time: the setpoint and where it is, its following error, force and power of its motor, as far as
    the scenario knows them."""
    columns, time = recording.computed, recording.time
    rows = (["position", "error"] if FOLLOWING_ERROR in columns else []) + (["force", "power"] if load else [])
    heights = [{"position": 200, "error": 130, "force": 170, "power": 130}[row] for row in rows]
    chart = Chart("The axis and its motor over time", heights, "time in s", (0.0, scenario.stop_time))
    row = {name: i for i, name in enumerate(rows, 1)}
    length = unit_name(Unit.POSITION, scenario.slave_unit or scenario.unit)
    if FOLLOWING_ERROR in columns:
        setpoint = columns[ACTUAL_POSITION] + columns[FOLLOWING_ERROR]
        chart.write_title(row["position"], with_unit("position", length))
        styles = (
            ("setpoint", setpoint, Style(MASTER, 1.5)),
            ("actual", columns[ACTUAL_POSITION], Style(SLAVE, 1.8)),
        )
        for name, values, style in styles:
            chart.draw_curve(row["position"], name, time, values, style, f"{name} position", length, required=required)
        chart.write_title(row["error"], with_unit("following error", length))
        error = Style(SLAVE, 1.4)
        chart.draw_curve(row["error"], "following error", time, columns[FOLLOWING_ERROR], error, unit=length)
    if load and scenario.load:
        unit = force_unit(scenario.load)
        chart.write_title(row["force"], with_unit("torque" if scenario.load.turns else "force", unit))
        chart.draw_curve(row["force"], "motor", time, columns[FORCE], Style(RECEIVED, 1.6), "force", unit)
        _draw_motor_limits(chart, row["force"], scenario, load)
        chart.write_title(row["power"], "power in W")
        chart.draw_curve(row["power"], "power", time, columns[POWER], Style(RECEIVED, 1.2), unit="W")
    return chart


def chart_force_over_velocity(scenario: Scenario, recording: Recording, load: LoadFigures) -> Chart:
    """The working points of the motor, with what it can give for moments and for ever."""
    columns = recording.computed
    velocity = columns.get(ACTUAL_VELOCITY, recording.values["slave.velocity"])
    unit = unit_name(Unit.VELOCITY, scenario.slave_unit or scenario.unit)
    reach = 1.05 * float(np.abs(velocity).max()) or 1.0
    title = with_unit("velocity of the axis", unit)
    chart = Chart("Force over velocity", [260], title, (-reach, reach), hover="closest", timed=False)
    chart.write_title(1, with_unit("torque" if scenario.load and scenario.load.turns else "force", load.unit))
    at = evenly_spaced(len(velocity), MOST_POINTS)
    line = {"type": "scatter", "mode": "lines", "line": {"color": RECEIVED, "width": 1.0}}
    values = {"x": rounded(velocity[at], DIGITS), "y": rounded(columns[FORCE][at], DIGITS)}
    values |= {"customdata": rounded(recording.time[at], TIME_DIGITS)}
    template = f"%{{x:.6~g}} {unit}, {hover_template(load.unit, '')}".replace("<extra>", " at %{customdata} s<extra>")
    chart.add_trace(1, "working points", line | values | {"hovertemplate": template})
    _draw_motor_limits(chart, 1, scenario, load)
    return chart


def _draw_motor_limits(chart: Chart, row: int, scenario: Scenario, load: LoadFigures) -> None:
    """Draw what the motor can give for moments and for ever, and the rms that it has to give."""
    if not scenario.load:
        return
    limits = (("peak", scenario.load.peak_force, "dash"), ("continuous", scenario.load.continuous_force, "dot"))
    for name, force, dash in limits:
        if force is None:
            continue
        for limit in (-force, force):
            chart.draw_horizontal_line(row, f"{name} limit of the motor", limit, dash)
        chart.write_limit(row, force, f"{name} {engineering(force, load.unit)}")
    rms = {"type": "scatter", "mode": "lines", "x": list(chart.span), "y": [load.rms] * 2, "hoverinfo": "skip"}
    chart.add_trace(row, "rms over the cycles", rms | {"line": {"color": LIMIT, "width": 1.6}})
