"""Discrete values over time: a lane for the state, each other enumeration, each Boolean, and for the settings."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from markupsafe import escape

from ...interface.roles import piece_variables
from ...interface.variables import Variable
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, rounded
from .chart import INK, Chart, kind_colour

LANE = 36  # the height of a lane, in px
BAR = 0.5  # the height of a bar, of its lane
SETTINGS = "what was set"
WIDTH_DIGITS = TIME_DIGITS + 3  # of a bar, so that its end has those of a time
PERIOD = "from %{base:.6~f} s to %{x:.6~f} s"
HUES, TONES = 8, 4  # colours of states, and of other enumerations
MOST_STRETCHES = 1000  # of a lane; of more, those that are close together are joined
MOST_SHADES = 150  # stretches that are shaded behind the positions; more would be a pattern of their own


@dataclass(frozen=True)
class Stretch:
    """A stretch of time, in s, and the value that a variable has in it."""

    begin: float
    end: float
    value: int


@dataclass(frozen=True)
class Lane:
    """A variable, and the stretches of time in which it has a value.

    Attributes:
        names: all variables with these very values.
        joined: whether stretches that are close together are drawn as one.
        kinds: whether the values are kinds of pieces, which have the same colours everywhere.
    """

    variable: Variable
    names: list[str]
    stretches: list[Stretch]
    joined: bool = False
    kinds: bool = False

    @property
    def is_state(self) -> bool:
        return self.variable.name == "state"

    @property
    def title(self) -> str:
        """The names, the later ones without the group that they share with the first."""
        group = self.names[0].rpartition(".")[0]
        shared = [n.removeprefix(group) if group and n.startswith(f"{group}.") else n for n in self.names[1:]]
        return " = ".join([self.names[0], *shared]) + (" (some are joined)" if self.joined else "")

    @property
    def values(self) -> list[int]:
        """The values that are drawn: the members of an enumeration that occur, or true."""
        occurring = {s.value for s in self.stretches}
        return [int(m) for m in self.variable.choices if m in occurring] if self.variable.choices else [1]

    def colour(self, value: int) -> str:
        """The colour of a value; those that occur differ as long as there are colours."""
        if not self.variable.choices:
            return "--true"
        if self.kinds:
            return kind_colour(value)
        i = self.values.index(value)
        return f"--band-{i % HUES}" if self.is_state else f"--tone-{i % TONES}"

    def key(self) -> list[tuple[str, str, str]]:
        """The colours of an enumeration: of each its CSS property, the member's name and description."""
        by_value = {int(m): m for m in self.variable.choices}
        return [(self.colour(v), by_value[v].name, by_value[v].description) for v in self.values if v in by_value]


def find_lanes(scenario: Scenario, recording: Recording) -> list[Lane]:
    """Make a lane for the state, then for each other enumeration and each Boolean that changes in the run. Variables
    with equal values share a lane."""
    lanes: list[Lane] = []
    first: dict[tuple[type, bytes], Lane] = {}
    by_name = scenario.recipe.variables
    pieces = piece_variables(by_name.values())
    kinds = by_name[pieces.kind].cell.type if pieces else None
    for kind in ("Enumeration", "Boolean"):
        for v in (by_name[name] for name in recording.values if by_name[name].kind == kind):
            values = recording.values[v.name].astype(int)
            if v.name != "state" and not np.any(values != values[0]):
                continue
            same = (v.cell.type, values.tobytes())
            if same in first:
                first[same].names.append(v.name)
                continue
            stretches = list(_stretches(recording, v.name))
            joined = len(stretches) > MOST_STRETCHES
            if joined:
                stretches = _join(stretches, scenario.stop_time)
            lanes.append(Lane(v, [v.name], stretches, joined, v.cell.type is kinds))
            first[same] = lanes[-1]
    return sorted(lanes, key=lambda lane: not lane.is_state)


def _stretches(recording: Recording, name: str) -> Iterator[Stretch]:
    values = recording.values[name].astype(int)
    borders = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values) - 1]
    for first, last in pairwise(borders):
        if last > first:
            yield Stretch(float(recording.time[first]), float(recording.time[last]), int(values[first]))


def _join(stretches: list[Stretch], stop_time: float) -> list[Stretch]:
    """Join stretches of the same value that are less than a column of the screen apart."""
    column = stop_time / MOST_STRETCHES
    last: dict[int, Stretch] = {}
    complete: list[Stretch] = []
    for s in stretches:
        before = last.get(s.value)
        if before and s.begin - before.end < column:
            last[s.value] = Stretch(before.begin, s.end, s.value)
            continue
        complete += [before] if before else []
        last[s.value] = s
    return sorted([*complete, *last.values()], key=lambda s: s.begin)


def find_changes(recording: Recording, lanes: Sequence[Lane], times: Sequence[float]) -> Indices:
    """Find the points at which a discrete value changes or an input is set, and the points before; none if there are
    more than a curve has points on the screen."""
    at = [np.searchsorted(recording.time, times)]
    for lane in lanes:
        at.append(np.flatnonzero(np.diff(recording.values[lane.variable.name])) + 1)
    points = np.concatenate(at)
    both = np.union1d(points, points - 1)
    inside = both[(both >= 0) & (both < len(recording.time))].astype(np.int64)
    return inside if len(inside) <= 2 * BUCKETS else NONE


def is_shaded(lane: Lane) -> bool:
    """Whether the stretches of a lane are shaded behind the positions."""
    return lane.is_state and len(lane.stretches) <= MOST_SHADES


def state_stretches(lanes: Sequence[Lane]) -> Iterator[tuple[str, list[tuple[float, float]]]]:
    """The stretches of each state, with its colour, which are shaded behind the position."""
    for lane in lanes:
        if is_shaded(lane):
            for value in lane.values:
                yield lane.colour(value), [(s.begin, s.end) for s in lane.stretches if s.value == value]


def chart_lanes(lanes: list[Lane], stop_time: float, times: list[float], texts: list[str]) -> Chart:
    """Draw a lane for each variable, the state at the top; at the bottom, a marker for each setting."""
    rows = len(lanes) + (1 if times else 0)
    name = "States, other discrete values, and what was set, over time"
    chart = Chart(name, [LANE * rows], "time in s", (0.0, stop_time), hover="closest")
    chart.axis(1).update({"range": [len(lanes) - rows + 0.5, len(lanes) + 0.6], "fixedrange": True, "ticks": ""})
    chart.axis(1).update({"showticklabels": False, "showgrid": False, "zeroline": False})
    for i, lane in enumerate(reversed(lanes), 1):
        _write_title(chart, i, lane.title)
        for value in lane.values:
            _draw_bars(chart, i, lane, value)
    if times:
        _draw_settings(chart, times, texts)
    chart.layout["margin"]["t"] = 24
    chart.layout["height"] -= 34
    return chart


def _draw_settings(chart: Chart, times: list[float], texts: list[str]) -> None:
    _write_title(chart, 0, SETTINGS)
    marks = {"color": INK, "size": 9, "symbol": "triangle-up"}
    trace = {"type": "scatter", "mode": "markers", "x": rounded(times, TIME_DIGITS), "y": [0] * len(times)}
    template = "%{x:.6~f} s: %{customdata}<extra></extra>"
    labels = [f"{escape(text)} ({i})" for i, text in enumerate(texts, 1)]
    more = {"customdata": labels, "hovertemplate": template, "meta": {"heading": SETTINGS, "texts": texts}}
    chart.add_trace(1, "set", trace | {"marker": marks} | more, legend=False)


def _write_title(chart: Chart, lane: int, text: str) -> None:
    where = {"x": 0, "xanchor": "left", "y": lane + 0.5 * BAR, "yref": "y", "yanchor": "bottom"}
    chart.annotate(str(escape(text)), font={"size": 11}, **where)


def _draw_bars(chart: Chart, i: int, lane: Lane, value: int) -> None:
    """Draw bars with the name of an enumeration's member, plain ones where a Boolean is true."""
    selected = [s for s in lane.stretches if s.value == value]
    if not selected:
        return
    text = next((str(m.name) for m in lane.variable.choices if m == value), "true")
    begins, ends = (rounded(times, TIME_DIGITS) for times in zip(*((s.begin, s.end) for s in selected), strict=True))
    trace: dict[str, Any] = {
        "type": "bar",
        "orientation": "h",
        "base": begins,
        "x": rounded((end - begin for begin, end in zip(begins, ends, strict=True)), WIDTH_DIGITS),
        "y": [i] * len(selected),
        "width": BAR,
        "marker": {"color": lane.colour(value), "line": {"width": 0}},
        "meta": lane.title,
        "hovertemplate": f"{escape(lane.title)}: <b>{text}</b><br>{PERIOD}<extra></extra>",
    }
    if lane.variable.choices:
        inside = {"text": text, "textposition": "inside", "insidetextanchor": "middle", "textangle": 0}
        trace |= inside | {"textfont": {"color": INK}}
    chart.add_trace(1, text, trace, legend=False)
    chart.layout |= {"barmode": "overlay", "uniformtext": {"mode": "hide", "minsize": 9}}
