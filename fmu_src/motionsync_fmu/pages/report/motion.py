"""The motions of slave and master over time: a row each for position, velocity, acceleration and jerk."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from motionsync.var import Role, Unit

from ...interface.roles import find_by_role
from ...interface.units import unit_name
from ...scenario.engineering import ROUNDING, engineering
from ...scenario.evaluate.key_figures import KeyFigures
from ...scenario.evaluate.reference_comparison import read_reference
from ...scenario.evaluate.remote_errors import remote_errors
from ...scenario.recording import Reals, Recording
from ...scenario.remote_view import RemoteView
from ...scenario.scenario import Scenario
from ..numbers import NONE, Indices, jumps
from ..style import typeset, with_unit
from .chart import MASTER, RECEIVED, REFERENCE, SLAVE, Chart, Style, axis_id
from .lanes import Lane, is_shaded, state_stretches

ROWS = (
    ("position", Unit.POSITION, 260),
    ("velocity", Unit.VELOCITY, 170),
    ("acceleration", Unit.ACCELERATION, 170),
    ("jerk", Unit.JERK, 130),
)
ERRORS = (("index error", 190), ("axis error", 190))  # the rows of a remote axis
MOST_INDEX_ERROR = 10.0  # cycles, shown at first; it grows without end after a fault
APART = 5.0  # one axis for two positions shows little of one whose span is so many times less
LABEL = 22  # px, the space for the name of a limit
NEAR = 2.0  # a limit is drawn up to this multiple of what a row shows
MOST_MARKERS = 250  # of a reference; of more points only every n-th is drawn
MOST_LINES = 40  # lines at the times of settings; more could not be distinguished


def motion_units(unit: str) -> list[str]:
    """The units of position, velocity, acceleration and jerk, as they are printed; `unit`: that of positions."""
    return [typeset(unit_name(kind, unit)) for _, kind, _ in ROWS]


@dataclass(frozen=True)
class Bound:
    """A limit of the slave's axis: the name of its variable, its value, the row that it belongs to, and whether it is
    the upper one of the two there."""

    name: str
    value: float
    row: int
    is_upper: bool


def chart_motion(
    scenario: Scenario,
    recording: Recording,
    figures: KeyFigures,
    lanes: list[Lane],
    times: list[float],
    required: Indices,
) -> Chart:
    """Draw slave and master over time, the reference as markers, and the axis' limits.

    `lanes`: the first may be the state, by which the position is shaded; `times`: when something was set; `required`:
    points that are drawn in any case."""
    chart = Chart(
        "Motion of the slave over time", [height for *_, height in ROWS], "time in s", (0.0, scenario.stop_time)
    )
    if any(is_shaded(lane) for lane in lanes):  # over an axis without a trace nothing is drawn
        behind = chart.add_background_axis(1)
        for colour, stretches in state_stretches(lanes):
            chart.shade_stretches(behind, "state", stretches, colour)
    if scenario.remote:
        remote = remote_errors(scenario.remote, recording)
        for i, values in enumerate(remote.received.T, 1):
            chart.draw_curve(i, "received", remote.time, values, Style(RECEIVED, 1.0), f"received {ROWS[i - 1][0]}")
    _draw_motion(chart, scenario, recording, "remote axis" if scenario.remote else "master", required)
    _draw_reference(chart, scenario)
    _draw_bounds(chart, scenario, figures)
    if len(times) <= MOST_LINES:
        for t in times:
            chart.draw_vertical_line(t)
    return chart


def _draw_motion(chart: Chart, scenario: Scenario, recording: Recording, followed: str, required: Indices) -> None:
    """Draw the slave and what it follows, on one axis of the row unless one of them would be a flat line there."""
    positions = recording.values["slave.position"], recording.master[:, 0]
    scale = max(1.0, *(float(np.abs(values).max()) for values in positions))
    for i, (name, kind, _) in enumerate(ROWS, 1):
        master, slave, gaps = recording.master[:, i - 1], recording.values[f"slave.{name}"], (NONE, NONE)
        if name == "position":
            master = master % scenario.period if scenario.period else master
            velocities = recording.master[:, 1], recording.values["slave.velocity"]
            gaps = jumps(recording.time, master, velocities[0]), jumps(recording.time, slave, velocities[1])
        units = unit_name(kind, scenario.unit), unit_name(kind, scenario.slave_unit or scenario.unit)
        separate = bool(master.any()) and (
            units[0] != units[1] or (name == "position" and _differ_in_span(master, slave))
        )
        axis = chart.add_right_axis(i, with_unit(followed, units[0]), MASTER) if separate else i
        chart.write_title(i, with_unit(f"slave {name}" if separate else name, units[1]))
        followers = (axis, followed, master, Style(MASTER, 1.5)), (i, "slave", slave, Style(SLAVE, 2.2))
        for (row, who, values, style), unit, gap in zip(followers, units, gaps, strict=True):
            chart.draw_curve(
                row, who, recording.time, values, style, f"{who} {name}", unit, required=required, gaps=gap
            )
        fit(chart, i, [slave] if separate else [slave, master], scale)
        if separate:
            fit(chart, axis, [master], scale)
            chart.axis(axis)["rangemode"] = "normal" if name == "position" else "tozero"


def fit(chart: Chart, row: int, shown: list[Reals], scale: float) -> None:
    """Fit an axis to its values; where they are rounding in comparison with the scale, a note states so instead."""
    greatest = max(float(np.abs(values).max(initial=0.0)) for values in shown)
    if greatest > ROUNDING * scale:
        chart.fit_to_view(row)
        return
    chart.axis(row)["range"] = [-1.0, 1.0]
    if greatest > 0.0:
        where = {"x": 0.5, "y": 0.8, "xanchor": "center"}
        chart.annotate(f"0 to rounding: at most {engineering(greatest)}", yref=f"{axis_id(row)} domain", **where)


def _differ_in_span(a: Reals, b: Reals) -> bool:
    """Whether one of these positions would be a flat line next to the other."""
    spans = sorted((float(np.ptp(a)), float(np.ptp(b))))
    return spans[0] > 0.0 and spans[1] > APART * spans[0]


def _draw_reference(chart: Chart, scenario: Scenario) -> None:
    """Draw the samples of the reference."""
    reference = read_reference(scenario)
    if reference is None:
        return
    names, table = reference
    table = table[:: 1 + len(table) // MOST_MARKERS]
    for i, (name, kind, _) in enumerate(ROWS, 1):
        if (full := f"slave.{name}") in names:
            values, unit = table[:, 1 + names.index(full)], unit_name(kind, scenario.slave_unit or scenario.unit)
            chart.draw_markers(i, "reference", table[:, 0], values, REFERENCE, f"reference {name}", unit, "circle-open")


def chart_remote_errors(remote: RemoteView, scenario: Scenario, recording: Recording, required: Indices) -> Chart:
    """Draw how far telegram and slave are from the true axis, over time."""
    errors = remote_errors(remote, recording)
    heights = [height for _, height in ERRORS]
    chart = Chart("Errors of the remote axis over time", heights, "time in s", (0.0, scenario.stop_time))
    units = "cycles", unit_name(Unit.POSITION, scenario.unit)
    pairs = (errors.index, errors.corrected_index), (errors.position, errors.corrected_position)
    inner = required[required > 0] - 1
    for i, ((name, _), unit, (received, slave)) in enumerate(zip(ERRORS, units, pairs, strict=True), 1):
        names = f"{name}, received", f"{name}, slave"
        chart.draw_curve(i, "received", errors.time, received, Style(RECEIVED, 1.2), names[0], unit, required=inner)
        chart.draw_curve(i, "slave", errors.time, slave, Style(SLAVE, 2.2), names[1], unit, required=inner)
        chart.write_title(i, with_unit(name, unit))
        fit(chart, i, [received, slave], 1.0)
    chart.axis(1)["autorangeoptions"] = {"clipmin": -MOST_INDEX_ERROR, "clipmax": MOST_INDEX_ERROR}
    return chart


# --- limits ---


def bounds(scenario: Scenario, figures: KeyFigures) -> Iterator[Bound]:
    """The limits of the slave's axis, of the speed and its derivatives to both sides of 0."""
    names = {role: v.name for role in Role if (v := find_by_role(scenario.recipe.variables.values(), role))}
    peaks = {peak.name: peak for peak in figures.peaks}
    position = peaks["position"]
    for role, value in ((Role.MIN_POSITION, position.lower), (Role.MAX_POSITION, position.limit)):
        if value is not None:
            yield Bound(names[role], value, 1, role is Role.MAX_POSITION)
    slowing = Role.MAX_DECELERATION if Role.MAX_DECELERATION in names else Role.MAX_ACCELERATION
    rows = (
        ("velocity", Role.MAX_VELOCITY, 2),
        ("acceleration", Role.MAX_ACCELERATION, 3),
        ("deceleration", slowing, 3),
        ("jerk", Role.MAX_JERK, 4),
    )
    yielded: set[tuple[int, float]] = set()
    for name, role, row in rows:
        limit = peaks[name].limit if name in peaks else None
        if limit is not None and (row, limit) not in yielded:
            yielded.add((row, limit))
            yield from (Bound(names[role], value, row, value > 0.0) for value in (limit, -limit))


def _draw_bounds(chart: Chart, scenario: Scenario, figures: KeyFigures) -> None:
    """Draw the limits that are near what a row shows."""
    peaks = {peak.name: peak for peak in figures.peaks}
    for bound in bounds(scenario, figures):
        name, kind, _ = ROWS[bound.row - 1]
        peak = peaks[name]
        reach = NEAR * (peak.greatest - peak.least) if name == "position" else NEAR * peak.value
        middle = 0.5 * (peak.greatest + peak.least) if name == "position" else 0.0
        if abs(bound.value - middle) <= reach:
            span = peak.greatest - peak.least if name == "position" else 2.0 * bound.value
            draw_bound(chart, bound, unit_name(kind, scenario.slave_unit or scenario.unit), abs(span))


def draw_bound(chart: Chart, bound: Bound, unit: str, span: float) -> None:
    """Draw a limit as a dashed line with its name and value, these beyond it: all curves are on the other side.

    `span`: about the height of the row, in its own unit."""
    text = f"{bound.name.rpartition('.')[2]} {typeset(engineering(bound.value, unit))}"
    chart.draw_horizontal_line(bound.row, "limit of the axis", bound.value, "dash")
    chart.write_limit(bound.row, bound.value, text, "bottom" if bound.is_upper else "top")
    label = LABEL / chart.heights[bound.row - 1] * span
    chart.include(bound.row, bound.value + (label if bound.is_upper else -label))
