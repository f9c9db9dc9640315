"""The pieces of a machine that cuts to length: where they are on the material, and how they are made over time."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from markupsafe import escape

from motionsync.var import Unit

from ...interface.roles import PieceVariables
from ...interface.units import unit_name
from ...scenario.engineering import ROUNDING, engineering
from ...scenario.evaluate.find_pieces import Piece, coupling_factor
from ...scenario.evaluate.key_figures import KeyFigures
from ...scenario.evaluate.production import Production
from ...scenario.evaluate.time_series import true_stretches
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, evenly_spaced, jumps, rounded
from ..style import with_unit
from .chart import BAD, CLEAR, INK, LIMIT, MASTER, MUTED, OK, REFERENCE, SLAVE, Chart, Style, kind_colour
from .motion import NEAR, bounds, draw_bound

LABEL_SPACE = 0.12  # of the saw's range: the space for the name of a limit, or for numbers
OUTFEED = 0.35  # of the saw's range: how far above it pieces are shown that have been cut off
MOST_DRAWN = 40  # pieces that are drawn one by one; more could not be distinguished on a narrow screen
MOST_LARGE = 100  # pieces with large markers
APART = 0.018  # of the time axis, the least distance of two numbers of pieces
FAR = 100.0  # the tolerance is drawn unless it is so many times the greatest error
SCALE_LIMIT = 1.5  # of tolerance and products' errors; of greater errors only the direction is drawn
SMALL = 1e-3  # errors below it are written with powers of ten
EDGE = {"width": 0.8, "color": MUTED}  # of a piece
FASTEST = 2.0  # the limit of the line is drawn up to this multiple of its velocity


def kind_key(scenario: Scenario, production: Production) -> list[tuple[str, str, str]]:
    """The colours of the kinds that were made: of each the CSS property, name and description."""
    names = scenario.recipe.piece_variables
    choices = scenario.recipe.variables[names.kind].choices if names else []
    kinds = {piece.kind for piece in production.pieces}
    return [(kind_colour(int(m)), m.name, m.description) for m in choices if m in kinds]


def chart_piece_list(scenario: Scenario, production: Production) -> Chart:
    """Draw all pieces side by side, as they are on the material; of many, those in a row that are alike as one."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    begin, end = min(p.begin for p in production.pieces), max(p.end for p in production.pieces)
    title = with_unit("position on the material", unit)
    chart = Chart("The pieces on the material", [64], title, (begin, end), hover="closest", timed=False)
    chart.axis(1).update({"visible": False, "range": [-0.5, 0.5], "fixedrange": True})
    stretches = _stretches(production)
    for name in dict.fromkeys(first.name for first, _ in stretches):
        selected = [(first, last) for first, last in stretches if first.name == name]
        trace = {
            "type": "bar",
            "orientation": "h",
            "base": rounded((first.begin for first, _ in selected), 10),
            "x": rounded(last.end - first.begin for first, last in selected),
            "y": [0] * len(selected),
            "width": 0.8,
            "marker": {
                "color": kind_colour(selected[0][0].kind),
                "line": {
                    "width": 1.5 if len(stretches) <= MOST_DRAWN else 0.0,
                    "color": [BAD if first.bad else INK for first, _ in selected],
                },
            },
            "text": [_label(first, last) for first, last in selected],
            "textposition": "inside",
            "insidetextanchor": "middle",
            "textangle": 0,
            "textfont": {"color": INK},
            "customdata": [_describe_stretch(first, last, production) for first, last in selected],
            "hovertemplate": "%{customdata}<extra></extra>",
        }
        chart.add_trace(1, name, trace, legend=False)
    chart.layout |= {"barmode": "overlay", "uniformtext": {"mode": "hide", "minsize": 9}}
    chart.layout["margin"]["t"] = 12
    chart.layout["height"] -= 46
    return chart


def _stretches(production: Production) -> list[tuple[Piece, Piece]]:
    """The first and the last of each stretch of pieces that are drawn as one: where there are many, those that are
    alike and follow one another; else each piece alone."""
    if len(production.pieces) <= MOST_DRAWN:
        return [(piece, piece) for piece in production.pieces]
    ends = [(p.name, p.bad, engineering(p.ordered, digits=7)) for p in production.pieces]
    groups = [
        list(pieces) for _, pieces in groupby(zip(ends, production.pieces, strict=True), key=lambda pair: pair[0])
    ]
    return [(group[0][1], group[-1][1]) for group in groups]


def _label(first: Piece, last: Piece) -> str:
    """What is written on a piece, or on several: `3<br>600`, `3 to 8<br>600`."""
    if first is last:
        return f"{first.number}<br>{engineering(first.length, digits=7)}"
    return f"{first.number} to {last.number}<br>{engineering(first.ordered, digits=7)}"


def _describe_stretch(first: Piece, last: Piece, production: Production) -> str:
    """A piece, or several that are alike, in words, shown next to the pointer."""
    if first is last:
        return _describe_piece(first, production)
    ordered = engineering(first.ordered, production.unit, digits=7)
    return f"pieces {first.number} to {last.number}, {escape(first.name)}: {ordered} ordered"


def chart_pieces(
    scenario: Scenario, recording: Recording, figures: KeyFigures, production: Production, required: Indices = NONE
) -> Chart:
    """Draw the pieces passing the saw, or of many pieces their lengths; the line's velocity, its request and its limit;
    length errors; reserve."""
    names = scenario.recipe.piece_variables
    assert names
    chart = Chart(
        f"Pieces passing the {production.tool}, velocity of the line, length errors and time to spare",
        [310, 190, 130, 120],
        "time in s",
        (0.0, scenario.stop_time),
    )
    if len(production.pieces) > MOST_DRAWN:
        _draw_lengths(chart, production)
    else:
        _draw_material(chart, scenario, recording, figures, production, names, required)
    _draw_line(chart, scenario, recording, names, required)
    _draw_errors(chart, production)
    _draw_reserve(chart, recording, production, names, required)
    return chart


def _describe_piece(piece: Piece, production: Production) -> str:
    """A piece in words, shown next to the pointer."""
    length = engineering(piece.length, production.unit, digits=7)
    return f"piece {piece.number}, {escape(piece.name)}: {length}, error {error_text(piece, production)}"


def error_text(piece: Piece, production: Production) -> str:
    """The length error: `0.25 mm`; `unknown` of a merged piece between marks, whose length was not ordered."""
    if piece.merged and piece.error == 0.0:
        return "unknown"
    return engineering(piece.error, production.unit, scale=production.scale)


# --- the material ---


def _draw_material(
    chart: Chart,
    scenario: Scenario,
    recording: Recording,
    figures: KeyFigures,
    production: Production,
    names: PieceVariables,
    required: Indices,
) -> None:
    """Draw the pieces as bands that pass the saw, in the colours of their kinds, and the saw between them."""
    unit = unit_name(scenario.recipe.variables["slave.position"].declaration.unit, scenario.unit, scenario.slave_unit)
    saw = recording.values["slave.position"]
    low, high = float(saw.min()), float(saw.max())
    height = max(high - low, 1e-9 * max(abs(low), abs(high), 1.0))
    low, high = low - 0.08 * height, high + OUTFEED * height
    middle, reach = 0.5 * (low + high), 0.5 * NEAR * height
    limits = [b for b in bounds(scenario, figures) if b.row == 1 and abs(b.value - middle) <= reach]
    low = min([low, *(b.value - LABEL_SPACE * height for b in limits if not b.is_upper)])
    high = max([high, *(b.value + 2.0 * LABEL_SPACE * height for b in limits if b.is_upper)])  # and numbers
    factor = coupling_factor(scenario, recording)
    travel = recording.master[:, 0]
    material = _Window(1, 1.0, low, high)
    if unit == production.unit:
        chart.write_title(1, with_unit(f"{production.tool} and material", unit))
    else:
        chart.write_title(1, with_unit(production.tool, unit))
        right = chart.add_right_axis(1, with_unit("material", production.unit), MASTER, behind=True)
        chart.axis(right)["range"] = [low / factor, high / factor]
        material = _Window(right, 1.0 / factor, low, high)
    if production.pieces:
        for name in dict.fromkeys(piece.name for piece in production.pieces):
            selected = [piece for piece in production.pieces if piece.name == name]
            _draw_bands(chart, recording.time, travel, factor, selected, material)
        _draw_rest(chart, recording.time, factor * (travel - production.pieces[-1].end), material)
        _draw_numbers(chart, recording.time, travel, factor, production.pieces, high - 0.06 * height)
    gaps = jumps(recording.time, saw, recording.values["slave.velocity"])
    style = Style(SLAVE, 2.2)
    chart.draw_curve(1, production.tool, recording.time, saw, style, unit=unit, required=required, gaps=gaps)
    if (cutting := recording.values[names.cutting] != 0.0).any():
        _draw_cutting(chart, recording.time, saw, cutting, gaps)
    chart.axis(1)["range"] = [low, high]
    for bound in limits:
        draw_bound(chart, bound, unit, height)


@dataclass(frozen=True)
class _Window:
    """Where the material is drawn.

    Attributes:
        axis: the number of its axis.
        scale: the unit of the saw's positions, in the unit of this axis.
        low, high: the least and the greatest position of the saw.
    """

    axis: int
    scale: float
    low: float
    high: float

    def values(self, positions: Iterable[float]) -> list[Any]:
        """Positions of the saw, as the axis has them."""
        return rounded((self.scale * position for position in positions), 6)


def _draw_lengths(chart: Chart, production: Production) -> None:
    """Draw the length of each piece at the time of its cut, in the colour of its kind, and the ordered one as steps."""
    chart.write_title(1, with_unit("length", production.unit))
    for name in dict.fromkeys(piece.name for piece in production.pieces):
        selected = [piece for piece in production.pieces if piece.name == name]
        trace = _markers(selected, [p.length for p in selected], production)
        trace["marker"] |= {"color": kind_colour(selected[0].kind), "line": EDGE}
        chart.add_trace(1, f"length, {name}", trace | {"meta": with_unit(f"length, {name}", production.unit)})
    ordered = [p for p in production.pieces if p.product]
    line: dict[str, Any] = {"type": "scatter", "mode": "lines", "hoverinfo": "skip"}
    line |= {"line": {"color": INK, "width": 1.0, "shape": "vh"}}
    line |= {"x": rounded((p.reported_at for p in ordered), TIME_DIGITS), "y": rounded(p.ordered for p in ordered)}
    chart.add_trace(1, "ordered", line)
    chart.axis(1)["rangemode"] = "tozero"


def _markers(pieces: Sequence[Piece], values: Iterable[float], production: Production) -> dict[str, Any]:
    """A marker for each piece, at the time at which it was reported; the more pieces, the smaller."""
    return {
        "type": "scatter",
        "mode": "markers",
        "x": rounded((p.reported_at for p in pieces), TIME_DIGITS),
        "y": rounded(values),
        "customdata": [_describe_piece(p, production) for p in pieces],
        "marker": {"size": 8 if len(production.pieces) <= MOST_LARGE else 4},
        "hovertemplate": "%{customdata}<extra></extra>",
    }


def _draw_bands(
    chart: Chart, time: Reals, travel: Reals, factor: float, selected: Sequence[Piece], window: _Window
) -> None:
    """Draw pieces of one kind while they are in the window of the saw's positions."""
    low, high = window.low, window.high
    most = max(8, BUCKETS // max(len(selected), 1))
    x: list[Any] = []
    y: list[Any] = []
    for piece in selected:
        lower, upper = factor * (travel - piece.end), factor * (travel - piece.begin)
        lower, upper = np.minimum(lower, upper), np.maximum(lower, upper)
        inside = np.flatnonzero((upper > low) & (lower < high))
        if len(inside) < 2:
            continue
        at = _corners(inside, lower, upper, window, most)
        bottom, top = np.clip(lower[at], low, high), np.clip(upper[at], low, high)
        x += [*rounded(time[at], TIME_DIGITS), *rounded(time[at][::-1], TIME_DIGITS), None]
        y += [*window.values(bottom), *window.values(top[::-1]), None]
    chart.draw_area(window.axis, selected[0].name, x, y, kind_colour(selected[0].kind), EDGE, legend=False)


def _draw_rest(chart: Chart, time: Reals, edge: Reals, window: _Window) -> None:
    """Draw the material behind the last cut, whose front edge is at these positions of the saw."""
    low, high = window.low, window.high
    inside = np.flatnonzero(edge > low)
    if len(inside) < 2:
        return
    at = _corners(inside, edge, edge, window, BUCKETS)
    x = rounded([*time[at], time[at[-1]], time[at[0]]], TIME_DIGITS)
    y = window.values([*np.clip(edge[at], low, high), low, low])
    chart.draw_area(window.axis, "not cut", x, y, kind_colour(0), EDGE, legend=True)


def _corners(inside: Indices, lower: Reals, upper: Reals, window: _Window, most: int) -> Indices:
    """So many points of those inside the window, and those at which an edge of the piece enters or leaves it."""
    low, high = window.low, window.high
    spread = inside[evenly_spaced(len(inside), most)]
    crossings = [np.flatnonzero(np.diff(edge > level)) for edge in (lower, upper) for level in (low, high)]
    both = np.concatenate([c + i for c in crossings for i in (0, 1)])
    return np.union1d(spread, np.intersect1d(both, inside))


def _draw_numbers(
    chart: Chart, time: Reals, travel: Reals, factor: float, pieces: Sequence[Piece], position: float
) -> None:
    """Write the pieces' numbers where their middles pass a position of the saw, without overlaps."""
    passing = np.maximum.accumulate(travel - position / factor)
    after, distance = chart.span[0], APART * (chart.span[1] - chart.span[0])
    for piece in pieces:
        middle = 0.5 * (piece.begin + piece.end)
        if passing[0] < middle < passing[-1] and (at := float(np.interp(middle, passing, time))) >= after:
            place = {"xref": "x", "x": at, "yref": "y", "y": position}
            chart.annotate(str(piece.number), **place, name="number", bgcolor=CLEAR, font={"size": 11})
            after = at + distance


def _draw_cutting(chart: Chart, time: Reals, saw: Reals, cutting: Any, gaps: Indices) -> None:
    """Draw the saw as a thick line while it cuts. `gaps`: the points to which it jumps, as a knife does at a turn."""
    x: list[Any] = []
    y: list[Any] = []
    for first, after in true_stretches(cutting):
        borders = [first, *gaps[(gaps > first) & (gaps < after)].tolist(), after]
        for begin, end in pairwise(borders):
            at = begin + evenly_spaced(end - begin, 6)
            x += [*rounded(time[at], TIME_DIGITS), None]
            y += [*rounded(saw[at]), None]
    line = {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": INK, "width": 5}}
    chart.add_trace(1, "cutting", line | {"hoverinfo": "skip"})


# --- the line, the errors, the reserve ---


def _draw_line(
    chart: Chart, scenario: Scenario, recording: Recording, names: PieceVariables, required: Indices
) -> None:
    """Draw the master's velocity, the requested one, and the greatest that the block can follow."""
    unit = unit_name(Unit.VELOCITY, scenario.unit)
    chart.write_title(2, with_unit("velocity of the line", unit))
    velocity, limit = recording.master[:, 1], recording.values[names.max_velocity]
    request = recording.values[names.request]
    fastest = max(float(np.abs(velocity).max()), 1e-9)
    top = max(fastest, *(float(v.max(initial=0.0, where=v <= FASTEST * fastest)) for v in (limit, request)))
    time = recording.time
    chart.draw_curve(
        2, "limit of the line", time, limit, Style(LIMIT, 1.5, "dash"), names.max_velocity, unit, required=required
    )
    chart.draw_curve(
        2, "requested velocity", time, request, Style(REFERENCE, 2.0), names.request, unit, required=required
    )
    chart.draw_curve(2, "line", time, velocity, Style(MASTER, 2.0), "velocity of the line", unit, required=required)
    chart.axis(2)["range"] = [min(0.0, 1.1 * float(velocity.min())), 1.12 * top]


def _draw_errors(chart: Chart, production: Production) -> None:
    """Draw the length error of each piece as a stem, and the tolerance."""
    chart.write_title(3, with_unit("length error", production.unit))
    if not production.pieces:
        chart.annotate("no piece", yref="y3 domain", x=0.5, y=0.5)
        chart.axis(3)["range"] = [-1.0, 1.0]
        return
    worst = max((abs(p.error) for p in production.products), default=0.0)
    rounding = worst <= ROUNDING * production.scale
    shown = rounding or production.tolerance < FAR * worst
    most = SCALE_LIMIT * max(production.tolerance if shown else 0.0, 0.0 if rounding else worst) or 1.0
    if shown:
        _draw_tolerance(chart, production)
    _draw_stems(chart, production, most)
    if rounding and production.products:
        text = f"0 to rounding: at most {engineering(worst, production.unit)}" if worst else "0 for each product"
        chart.annotate(text, yref="y3 domain", x=0.5, y=0.3)  # between the errors, all at 0, and the lower tolerance
    chart.axis(3)["range"] = [-1.12 * most, 1.12 * most]
    if rounding and most < SMALL:
        chart.axis(3)["tickvals"] = [0]  # the tolerance has its text
    elif most < SMALL:
        del chart.axis(3)["tickformat"]
        chart.axis(3)["exponentformat"] = "power"


def _draw_stems(chart: Chart, production: Production, most: float) -> None:
    beyond = [abs(p.error) > most for p in production.pieces]
    errors = [float(np.clip(p.error, -most, most)) for p in production.pieces]
    trace = _markers(production.pieces, errors, production)
    up = ["triangle-up" if p.error > 0.0 else "triangle-down" for p in production.pieces]
    trace["marker"] |= {
        "symbol": [s if far else "circle" for s, far in zip(up, beyond, strict=True)],
        "color": [OK if p.good else BAD if p.bad else MUTED for p in production.pieces],
    }
    line = {"type": "scatter", "mode": "lines", "line": {"color": INK, "width": 1}, "hoverinfo": "skip"}
    stems = {
        "x": [e for t in trace["x"] for e in (t, t, None)],
        "y": [e for v in trace["y"] for e in (0, v, None)],
    }
    chart.add_trace(3, "stems", line | stems, legend=False)
    heading = with_unit("length error", production.unit)
    chart.add_trace(3, "length error", trace | {"meta": heading}, legend=False)


def _draw_tolerance(chart: Chart, production: Production) -> None:
    (begin, end), most = chart.span, production.tolerance
    x, y = [begin, end, end, begin, begin], [-most, -most, most, most, -most]
    line = {"color": LIMIT, "width": 1, "dash": "dot"}
    chart.draw_area(3, "tolerance", x, y, "--cut", line, legend=True, opacity=0.7)
    chart.write_limit(3, production.tolerance, f"tolerance {engineering(production.tolerance, production.unit)}")


def _draw_reserve(
    chart: Chart, recording: Recording, production: Production, names: PieceVariables, required: Indices
) -> None:
    """Draw the reserve of each piece as a bar, and the one that a cycle would have at the present velocity."""
    chart.write_title(4, "time to spare in % of the cycle")
    spare = 100.0 * recording.values[names.spare]
    style = Style(MASTER, 1.2)
    chart.draw_curve(4, "to spare at this velocity", recording.time, spare, style, names.spare, "%", required=required)
    x = rounded((p.sync for p in production.pieces), TIME_DIGITS)
    y = rounded(100.0 * p.reserve for p in production.pieces)
    line = {"type": "scatter", "mode": "lines", "line": {"color": OK, "width": 3}, "hoverinfo": "skip"}
    stems = {"x": [e for t in x for e in (t, t, None)], "y": [e for v in y for e in (0, v, None)]}
    turns = production.turns  # it is at rest before long pieces alone
    chart.add_trace(4, "at rest before each piece" if turns else "to spare at each piece", line | stems)
    labels = [f"{engineering(100.0 * p.reserve, digits=3)} %, piece {p.number}" for p in production.pieces]
    colours = [BAD if p.product and p.reserve <= 0.0 and not turns else OK for p in production.pieces]
    size = 7 if len(production.pieces) <= MOST_LARGE else 4
    dots = {"x": x, "y": y, "customdata": labels, "marker": {"color": colours, "size": size}}
    dots |= {"type": "scatter", "mode": "markers", "hovertemplate": "%{customdata}<extra></extra>"}
    chart.add_trace(
        4, "to spare", dots | {"meta": f"time {'at rest' if turns else 'to spare'} at each piece in %"}, legend=False
    )
    chart.axis(4)["range"] = [min(0.0, 1.1 * float(spare.min(initial=0.0, where=spare > -50.0))), 106.0]
