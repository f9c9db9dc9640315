"""What is true on a real machine: the lengths of the pieces by the tape measure, the axis behind its setpoint, and what
its motor has to give."""

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.computed_columns import ACTUAL_POSITION, ACTUAL_VELOCITY, FOLLOWING_ERROR, FORCE, POWER
from ...scenario.engineering import engineering
from ...scenario.evaluate.axis_figures import LoadFigures
from ...scenario.evaluate.true_pieces import TruePieces
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..numbers import DIGITS, TIME_DIGITS, Indices, evenly_spaced, jumps, rounded
from ..style import with_unit
from .chart import LIMIT, MASTER, RECEIVED, REFERENCE, SLAVE, Chart, Style, hover_template
from .histogram import Histogram, bar_borders
from .motion import fit

MOST_POINTS = 4000  # of the force over the velocity
CLOSE = 0.4  # of the greatest force: nearer limits of the motor have one text


def chart_histogram(true: TruePieces) -> Chart:
    """How many pieces have which true error, within the tolerance, with the normal curve of the same mean and sigma."""
    errors = np.array([piece.error for piece in true.pieces])
    least, greatest = float(errors.min()), float(errors.max())
    borders = bar_borders(least, greatest, len(errors), max(-least, greatest, true.tolerance))
    counts = np.histogram(errors, borders)[0].tolist()
    mean = float(errors.mean())
    shown = Histogram("true length error", true.unit, "pieces", borders, counts, mean, true.deviation, true.tolerance)
    return shown.chart("Histogram of the true length errors", 220)


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
            gaps = jumps(time, values, columns[ACTUAL_VELOCITY])
            hover = f"{name} position"
            chart.draw_curve(row["position"], name, time, values, style, hover, length, required=required, gaps=gaps)
        chart.write_title(row["error"], with_unit("following error", length))
        error = Style(SLAVE, 1.4)
        chart.draw_curve(row["error"], "following error", time, columns[FOLLOWING_ERROR], error, unit=length)
        fit(chart, row["error"], [columns[FOLLOWING_ERROR]], max(1.0, float(np.abs(setpoint).max())))
    if load and scenario.load:
        chart.write_title(row["force"], with_unit(load.what, load.unit))
        chart.draw_curve(row["force"], "motor", time, columns[FORCE], Style(RECEIVED, 1.6), load.what, load.unit)
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
    name = f"{load.what.capitalize()} over velocity"
    chart = Chart(name, [260], title, (-reach, reach), hover="closest", timed=False)
    chart.write_title(1, with_unit(load.what, load.unit))
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
    peak, continuous = scenario.load.peak_force, scenario.load.continuous_force
    texts = []
    for name, force, dash in (("peak", peak, "dash"), ("continuous", continuous, "dot")):
        if force is not None:
            for limit in (-force, force):
                chart.draw_horizontal_line(row, f"{name} limit of the motor", limit, dash)
            texts.append((force, f"{name} {engineering(force, load.unit)}", "top" if name == "peak" else "bottom"))
    if peak and continuous and peak - continuous < CLOSE * max(peak, load.peak):
        texts = [(peak, ", ".join(text for _, text, _ in texts), "bottom")]
    for force, text, anchor in texts:  # between the two limits: below the continuous one is the rms
        chart.write_limit(row, force, text, anchor)
    rms = {"type": "scatter", "mode": "lines", "x": list(chart.span), "y": [load.rms] * 2, "hoverinfo": "skip"}
    chart.add_trace(row, "rms over the cycles", rms | {"line": {"color": LIMIT, "width": 1.6}})
