"""The slave's motion over time beside what it follows: a row each for position, velocity, acceleration and jerk."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from motionsync.var import Role, Unit

from ...interface.roles import with_role
from ...interface.units import unit_name
from ...scenario.amounts import ROUNDING, engineering
from ...scenario.figures import Figures
from ...scenario.judge import read_reference
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from ...scenario.telegrams import Remote, errors
from ..numbers import NONE, Indices, jumps
from ..style import typeset
from .chart import LIMIT, MASTER, RECEIVED, REFERENCE, SLAVE, Chart, Style, ref
from .lanes import Lane, shades

ROWS = (
    ("position", Unit.POSITION, 260),
    ("velocity", Unit.VELOCITY, 170),
    ("acceleration", Unit.ACCELERATION, 170),
    ("jerk", Unit.JERK, 130),
)
ERRORS = (("index error", 190), ("axis error", 190))  # the rows of a remote axis
FARTHEST = 10.0  # cycles; the index error shows no more at first, since it grows without end after a fault
APART = 5.0  # one axis for two positions shows little of one whose span is so many times less
NEAR = 2.0  # a limit is drawn up to this multiple of what a row shows
MOST_MARKERS = 250  # of a reference; of more points only every n-th is drawn
MOST_LINES = 40  # lines at what was set; of more nothing could be read


@dataclass(frozen=True)
class Bound:
    """A limit of the slave's axis: the name of its variable, its value, and the row that it belongs to."""

    name: str
    value: float
    row: int


def motion_chart(
    scenario: Scenario, recording: Recording, found: Figures, lanes: list[Lane], times: list[float], kept: Indices
) -> Chart:
    """Slave and master over time, the reference as markers, and the axis' limits.

    `lanes`: the first may be the state, by which the position is shaded; `times`: when something was set; `kept`:
    points that are drawn in any case."""
    chart = Chart(
        "Motion of the slave over time", [height for *_, height in ROWS], "time in s", (0.0, scenario.stop_time)
    )
    behind = chart.behind(1)
    for colour, stretches in shades(lanes):
        chart.shade(behind, "state", stretches, colour)
    if scenario.remote:
        remote = errors(scenario.remote, recording)
        for i, values in enumerate(remote.received.T, 1):
            chart.curve(i, "received", remote.time, values, Style(RECEIVED, 1.0), f"received {ROWS[i - 1][0]}")
    _draw_motion(chart, scenario, recording, "remote axis" if scenario.remote else "master", kept)
    _draw_reference(chart, scenario)
    _draw_bounds(chart, scenario, found)
    if len(times) <= MOST_LINES:
        for t in times:
            chart.mark(t)
    return chart


def _draw_motion(chart: Chart, scenario: Scenario, recording: Recording, followed: str, kept: Indices) -> None:
    """Draw the slave and what it follows. Both have the axis of the row, unless one could not be seen there."""
    positions = recording.values["slave.position"], recording.master[:, 0]
    scale = max(1.0, *(float(np.abs(values).max()) for values in positions))
    for i, (name, kind, _) in enumerate(ROWS, 1):
        master, slave, gaps = recording.master[:, i - 1], recording.values[f"slave.{name}"], (NONE, NONE)
        if name == "position":
            master = master % scenario.period if scenario.period else master
            velocities = recording.master[:, 1], recording.values["slave.velocity"]
            gaps = jumps(recording.time, master, velocities[0]), jumps(recording.time, slave, velocities[1])
        units = unit_name(kind, scenario.unit), unit_name(kind, scenario.slave_unit or scenario.unit)
        own = bool(master.any()) and (units[0] != units[1] or (name == "position" and _apart(master, slave)))
        axis = chart.beside(i, f"{followed}{_in(units[0])}", MASTER) if own else i
        chart.head(i, f"{'slave ' * own}{name}{_in(units[1])}")
        followers = (axis, followed, master, Style(MASTER, 1.5)), (i, "slave", slave, Style(SLAVE, 2.2))
        for (row, who, values, style), unit, gap in zip(followers, units, gaps, strict=True):
            chart.curve(row, who, recording.time, values, style, f"{who} {name}", unit, kept=kept, gaps=gap)
        fit(chart, i, [slave] if own else [slave, master], scale)
        if own:
            fit(chart, axis, [master], scale)
            chart.axis(axis)["rangemode"] = "normal" if name == "position" else "tozero"


def fit(chart: Chart, row: int, shown: list[Reals], scale: float) -> None:
    """Fit an axis to what it shows; where that is rounding beside the scale, say so instead of drawing it large."""
    greatest = max(float(np.abs(values).max(initial=0.0)) for values in shown)
    if greatest > ROUNDING * scale:
        chart.rescale(row)
        return
    chart.axis(row)["range"] = [-1.0, 1.0]
    if greatest > 0.0:
        where = {"x": 0.5, "y": 0.8, "xanchor": "center"}
        chart.note(f"0 to rounding: at most {engineering(greatest)}", yref=f"{ref(row)} domain", **where)


def _apart(a: Reals, b: Reals) -> bool:
    """Whether one of these positions would be a flat line beside the other."""
    spans = sorted((float(np.ptp(a)), float(np.ptp(b))))
    return spans[0] > 0.0 and spans[1] > APART * spans[0]


def _in(unit: str) -> str:
    return f" in {typeset(unit)}" if unit else ""


def _draw_reference(chart: Chart, scenario: Scenario) -> None:
    """Draw the reference as it is: samples."""
    reference = read_reference(scenario)
    if reference is None:
        return
    names, table, _ = reference
    table = table[:: 1 + len(table) // MOST_MARKERS]
    for i, (name, kind, _) in enumerate(ROWS, 1):
        if (full := f"slave.{name}") in names:
            values, unit = table[:, 1 + names.index(full)], unit_name(kind, scenario.slave_unit or scenario.unit)
            chart.markers(i, "reference", table[:, 0], values, REFERENCE, f"reference {name}", unit, "circle-open")


def error_chart(remote: Remote, scenario: Scenario, recording: Recording, kept: Indices) -> Chart:
    """How far telegram and slave are from the truth, over time."""
    found = errors(remote, recording)
    heights = [height for _, height in ERRORS]
    chart = Chart("Errors of the remote axis over time", heights, "time in s", (0.0, scenario.stop_time))
    units = "cycles", unit_name(Unit.POSITION, scenario.unit)
    pairs = (found.index, found.corrected_index), (found.position, found.corrected_position)
    inner = kept[kept > 0] - 1
    for i, ((name, _), unit, (received, slave)) in enumerate(zip(ERRORS, units, pairs, strict=True), 1):
        said = f"{name}, received", f"{name}, slave"
        chart.curve(i, "received", found.time, received, Style(RECEIVED, 1.2), said[0], unit, kept=inner)
        chart.curve(i, "slave", found.time, slave, Style(SLAVE, 2.2), said[1], unit, kept=inner)
        chart.head(i, f"{name}{_in(unit)}")
        fit(chart, i, [received, slave], 1.0)
    chart.axis(1)["autorangeoptions"] = {"clipmin": -FARTHEST, "clipmax": FARTHEST}
    return chart


# --- limits ---


def bounds(scenario: Scenario, found: Figures) -> Iterator[Bound]:
    """The limits of the slave's axis, of the speed and its derivatives to both sides of 0."""
    names = {role: v.name for role in Role if (v := with_role(scenario.recipe.variables.values(), role))}
    peaks = {peak.name: peak for peak in found.peaks}
    position = peaks["position"]
    for role, value in ((Role.MIN_POSITION, position.lower), (Role.MAX_POSITION, position.limit)):
        if value is not None:
            yield Bound(names[role], value, 1)
    slowing = Role.MAX_DECELERATION if Role.MAX_DECELERATION in names else Role.MAX_ACCELERATION
    rows = (
        ("velocity", Role.MAX_VELOCITY, 2),
        ("acceleration", Role.MAX_ACCELERATION, 3),
        ("deceleration", slowing, 3),
        ("jerk", Role.MAX_JERK, 4),
    )
    drawn: set[tuple[int, float]] = set()
    for name, role, row in rows:
        limit = peaks[name].limit if name in peaks else None
        if limit is not None and (row, limit) not in drawn:
            drawn.add((row, limit))
            yield from (Bound(names[role], value, row) for value in (limit, -limit))


def _draw_bounds(chart: Chart, scenario: Scenario, found: Figures) -> None:
    """Draw the limits that lie near what a row shows."""
    shown = {peak.name: peak for peak in found.peaks}
    for bound in bounds(scenario, found):
        name, kind, _ = ROWS[bound.row - 1]
        peak = shown[name]
        room = NEAR * (peak.greatest - peak.least) if name == "position" else NEAR * peak.value
        middle = 0.5 * (peak.greatest + peak.least) if name == "position" else 0.0
        if abs(bound.value - middle) <= room:
            draw_bound(chart, bound, unit_name(kind, scenario.slave_unit or scenario.unit))


def draw_bound(chart: Chart, bound: Bound, unit: str) -> None:
    """Draw a limit as a dashed line with its name and value."""
    text = f"{bound.name.rpartition('.')[2]} {typeset(engineering(bound.value, unit))}"
    line = {"color": LIMIT, "width": 1.2, "dash": "dash"}
    trace = {"type": "scatter", "mode": "lines", "x": list(chart.span), "y": [bound.value] * 2, "line": line}
    chart.add(bound.row, "limit of the axis", trace | {"hoverinfo": "skip"})
    where = {"x": 1, "xanchor": "right", "y": bound.value, "yanchor": "bottom" if bound.value < 0.0 else "top"}
    chart.note(text, yref=ref(bound.row), font={"size": 10, "color": LIMIT}, **where)
