"""What is discrete, over time: a lane for the state, each other enumeration and each Boolean, and for what was set."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from markupsafe import escape

from ...interface.roles import books
from ...interface.variables import Variable
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, rounded
from .chart import INK, Chart, kind_colour

LANE = 36  # the height of a lane, in px
BAR = 0.5  # the height of a bar, of its lane
BETWEEN = "from %{base:.6~f} s to %{x:.6~f} s"
HUES, TONES = 8, 4  # colours of states, and of other enumerations
MOST_STRETCHES = 1000  # of a lane; of more, those that lie close together are joined
MOST_SHADES = 500  # stretches that are shaded behind the positions


@dataclass(frozen=True)
class Stretch:
    """A stretch of time, in s, and the value that a variable has in it."""

    begin: float
    end: float
    value: int


@dataclass(frozen=True)
class Lane:
    """A variable and its values, one after the other.

    Attributes:
        names: all variables with these very values.
        joined: whether stretches that lie close together have become one.
        kinds: whether the values are kinds of pieces, which have the same colours everywhere.
    """

    variable: Variable
    names: list[str]
    stretches: list[Stretch]
    joined: bool = False
    kinds: bool = False

    @property
    def state(self) -> bool:
        return self.variable.name == "state"

    @property
    def title(self) -> str:
        """The names, the later ones without the group that they share with the first."""
        group = self.names[0].rpartition(".")[0]
        shared = [n.removeprefix(group) if group and n.startswith(f"{group}.") else n for n in self.names[1:]]
        return " = ".join([self.names[0], *shared]) + (" (many changes, some are joined)" if self.joined else "")

    @property
    def values(self) -> list[int]:
        """What is drawn: the members of an enumeration that occur, or true."""
        found = {s.value for s in self.stretches}
        return [int(m) for m in self.variable.choices if m in found] if self.variable.choices else [1]

    def colour(self, value: int) -> str:
        """The colour of a value; those that occur differ as long as there are colours."""
        if not self.variable.choices:
            return "--true"
        if self.kinds:
            return kind_colour(value)
        i = self.values.index(value)
        return f"--band-{i % HUES}" if self.state else f"--tone-{i % TONES}"

    def key(self) -> list[tuple[str, str, str]]:
        """The colours of an enumeration: of each its CSS property, the member's name and description."""
        by_value = {int(m): m for m in self.variable.choices}
        return [(self.colour(v), by_value[v].name, by_value[v].description) for v in self.values if v in by_value]


def find_lanes(scenario: Scenario, recording: Recording) -> list[Lane]:
    """The state, then whatever else changes in the run: enumerations, then Booleans. Variables that are the same all
    the time share a lane."""
    found: list[Lane] = []
    first: dict[tuple[type, bytes], Lane] = {}
    by_name = scenario.recipe.variables
    told = books(by_name.values())
    kinds = by_name[told.kind].cell.type if told else None
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
            drawn = _joined(stretches, scenario.stop_time) if len(stretches) > MOST_STRETCHES else stretches
            found.append(Lane(v, [v.name], drawn, drawn is not stretches, v.cell.type is kinds))
            first[same] = found[-1]
    return sorted(found, key=lambda lane: not lane.state)


def _stretches(recording: Recording, name: str) -> Iterator[Stretch]:
    values = recording.values[name].astype(int)
    borders = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values) - 1]
    for first, last in pairwise(borders):
        if last > first:
            yield Stretch(float(recording.time[first]), float(recording.time[last]), int(values[first]))


def _joined(stretches: list[Stretch], stop_time: float) -> list[Stretch]:
    """Stretches of a value, those joined that are less than a column of the screen apart."""
    column = stop_time / MOST_STRETCHES
    last: dict[int, Stretch] = {}
    found: list[Stretch] = []
    for s in stretches:
        before = last.get(s.value)
        if before and s.begin - before.end < column:
            last[s.value] = Stretch(before.begin, s.end, s.value)
            continue
        found += [before] if before else []
        last[s.value] = s
    return sorted([*found, *last.values()], key=lambda s: s.begin)


def changes(recording: Recording, lanes: Sequence[Lane], times: Sequence[float]) -> Indices:
    """The points at which something discrete changes or is set, each with the one before it; none where there are more
    than a curve has points on the screen."""
    at = [np.searchsorted(recording.time, times)]
    for lane in lanes:
        at.append(np.flatnonzero(np.diff(recording.values[lane.variable.name])) + 1)
    found = np.concatenate(at)
    both = np.union1d(found, found - 1)
    inside = both[(both >= 0) & (both < len(recording.time))].astype(np.int64)
    return inside if len(inside) <= 2 * BUCKETS else NONE


def shades(lanes: Sequence[Lane]) -> Iterator[tuple[str, list[tuple[float, float]]]]:
    """What is shaded behind the position: the stretches of each state, with its colour."""
    for lane in lanes:
        if lane.state and len(lane.stretches) <= MOST_SHADES:
            for value in lane.values:
                yield lane.colour(value), [(s.begin, s.end) for s in lane.stretches if s.value == value]


def lane_chart(lanes: list[Lane], stop_time: float, times: list[float], texts: list[str]) -> Chart:
    """A lane for each variable, the state at the top; at the bottom, marks of what was set, and when."""
    rows = len(lanes) + (1 if times else 0)
    name = "States, other discrete values, and what was set, over time"
    chart = Chart(name, [LANE * rows], "time in s", (0.0, stop_time), hover="closest")
    chart.axis(1).update(
        {
            "range": [len(lanes) - rows + 0.5, len(lanes) + 0.6],
            "fixedrange": True,
            "showticklabels": False,
            "showgrid": False,
            "zeroline": False,
            "ticks": "",
        }
    )
    for i, lane in enumerate(reversed(lanes), 1):
        _title(chart, i, lane.title)
        for value in lane.values:
            _bars(chart, i, lane, value)
    if times:
        _draw_settings(chart, times, texts)
    chart.layout["margin"]["t"] = 24
    chart.layout["height"] -= 34
    return chart


def _draw_settings(chart: Chart, times: list[float], texts: list[str]) -> None:
    _title(chart, 0, "what was set")
    marks = {"color": INK, "size": 9, "symbol": "triangle-up"}
    trace = {"type": "scatter", "mode": "markers", "x": rounded(times, TIME_DIGITS), "y": [0] * len(times)}
    said = "%{x:.6~f} s: %{customdata}<extra></extra>"
    labels = [f"{escape(text)} ({i})" for i, text in enumerate(texts, 1)]
    chart.add(1, "set", trace | {"marker": marks, "customdata": labels, "hovertemplate": said}, legend=False)


def _title(chart: Chart, lane: int, text: str) -> None:
    where = {"x": 0, "xanchor": "left", "y": lane + 0.5 * BAR, "yref": "y", "yanchor": "bottom"}
    chart.note(str(escape(text)), font={"size": 11}, **where)


def _bars(chart: Chart, i: int, lane: Lane, value: int) -> None:
    """Bars with the name of an enumeration's member, plain ones where a Boolean is true."""
    chosen = [s for s in lane.stretches if s.value == value]
    if not chosen:
        return
    text = next((str(m.name) for m in lane.variable.choices if m == value), "true")
    trace: dict[str, Any] = {
        "type": "bar",
        "orientation": "h",
        "base": rounded((s.begin for s in chosen), TIME_DIGITS),
        "x": rounded((s.end - s.begin for s in chosen), TIME_DIGITS),
        "y": [i] * len(chosen),
        "width": BAR,
        "marker": {"color": lane.colour(value), "line": {"width": 0}},
        "hovertemplate": f"{escape(lane.title)}: <b>{text}</b><br>{BETWEEN}<extra></extra>",
    }
    if lane.variable.choices:
        inside = {"text": text, "textposition": "inside", "insidetextanchor": "middle", "textangle": 0}
        trace |= inside | {"textfont": {"color": INK}}
    chart.add(1, text, trace, legend=False)
    chart.layout |= {"barmode": "overlay", "uniformtext": {"mode": "hide", "minsize": 9}}
