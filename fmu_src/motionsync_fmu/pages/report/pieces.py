"""The pieces of a machine that cuts to length: where they lie on the material, and how each came to be over time."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import escape

from motionsync.var import Unit

from ...interface.roles import Books, books
from ...interface.units import unit_name
from ...scenario.amounts import ROUNDING, engineering
from ...scenario.figures import Figures
from ...scenario.pieces import Piece, coupling_factor
from ...scenario.production import Production
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from ..numbers import BUCKETS, NONE, TIME_DIGITS, Indices, rounded
from ..style import typeset
from .chart import BAD, CLEAR, INK, LIMIT, MASTER, MUTED, OK, REFERENCE, SLAVE, Chart, Style, kind_colour
from .motion import NEAR, bounds, draw_bound

OUTFEED = 0.35  # of the saw's range, above it, in which the pieces are shown that have been cut off
MOST_DRAWN = 400  # pieces on the time plot; more could not be told apart
APART = 0.018  # of the time axis, the least distance of two numbers of pieces
FAR = 100.0  # the tolerance is drawn unless it is so many times the greatest error
OFF = 1.5  # an error is drawn up to this multiple of tolerance and products' errors; of greater ones only the direction
SMALL = 1e-3  # errors below it are written with powers of ten
FASTEST = 2.0  # the limit of the line is drawn up to this multiple of its velocity


def kinds_of(scenario: Scenario, made: Production) -> list[tuple[str, str, str]]:
    """The key of the kinds that were made: of each the CSS property, name and description."""
    names = books(scenario.recipe.variables.values())
    choices = scenario.recipe.variables[names.kind].choices if names else []
    found = {piece.kind for piece in made.pieces}
    return [(kind_colour(int(m)), m.name, m.description) for m in choices if m in found]


def list_chart(scenario: Scenario, made: Production) -> Chart:
    """All pieces side by side, as they lay on the material."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    begin, end = min(p.begin for p in made.pieces), max(p.end for p in made.pieces)
    title = f"place on the material{_in(unit)}"
    chart = Chart("The pieces on the material", [64], title, (begin, end), hover="closest", timed=False)
    chart.axis(1).update({"visible": False, "range": [-0.5, 0.5], "fixedrange": True})
    for name in dict.fromkeys(piece.name for piece in made.pieces):
        chosen = [piece for piece in made.pieces if piece.name == name]
        trace = {
            "type": "bar",
            "orientation": "h",
            "base": rounded((p.begin for p in chosen), 10),
            "x": rounded(p.end - p.begin for p in chosen),
            "y": [0] * len(chosen),
            "width": 0.8,
            "marker": {
                "color": kind_colour(chosen[0].kind),
                "line": {"width": 1.5, "color": [BAD if p.product and not p.good else INK for p in chosen]},
            },
            "text": [f"{p.number}<br>{engineering(p.length, digits=7)}" for p in chosen],
            "textposition": "inside",
            "insidetextanchor": "middle",
            "textangle": 0,
            "textfont": {"color": INK},
            "customdata": [_told(p, made) for p in chosen],
            "hovertemplate": "%{customdata}<extra></extra>",
        }
        chart.add(1, name, trace, legend=False)
    chart.layout |= {"barmode": "overlay", "uniformtext": {"mode": "hide", "minsize": 9}}
    chart.layout["margin"]["t"] = 12
    chart.layout["height"] -= 46
    return chart


def piece_chart(
    scenario: Scenario, recording: Recording, found: Figures, made: Production, kept: Indices = NONE
) -> Chart:
    """The pieces passing the saw; the line's velocity beside what is asked of it and its limit; errors; reserve."""
    names = books(scenario.recipe.variables.values())
    assert names
    chart = Chart(
        "Pieces passing the saw, velocity of the line, length errors and reserve",
        [310, 190, 130, 120],
        "time in s",
        (0.0, scenario.stop_time),
    )
    _draw_material(chart, scenario, recording, found, made, names, kept)
    _draw_line(chart, scenario, recording, names, kept)
    _draw_errors(chart, made)
    _draw_reserve(chart, recording, made, names, kept)
    return chart


def _in(unit: str) -> str:
    return f" in {typeset(unit)}" if unit else ""


def _told(piece: Piece, made: Production) -> str:
    """A piece in words, for the pointer."""
    error = engineering(piece.error, made.unit, scale=made.scale)
    return (
        f"piece {piece.number}, {escape(piece.name)}: {engineering(piece.length, made.unit, digits=7)}, error {error}"
    )


# --- the material ---


def _draw_material(
    chart: Chart,
    scenario: Scenario,
    recording: Recording,
    found: Figures,
    made: Production,
    names: Books,
    kept: Indices,
) -> None:
    """Draw the pieces as bands that pass the saw, in the colours of their kinds, and the saw among them."""
    unit = unit_name(Unit.POSITION, scenario.unit)
    chart.head(1, f"saw and material{_in(unit)}")
    saw = recording.values["slave.position"]
    low, high = float(saw.min()), float(saw.max())
    room = max(high - low, 1e-9 * max(abs(low), abs(high), 1.0))
    low, high = low - 0.08 * room, high + OUTFEED * room
    factor = coupling_factor(scenario, recording)
    travel = recording.master[:, 0]
    if 0 < len(made.pieces) <= MOST_DRAWN:
        for name in dict.fromkeys(piece.name for piece in made.pieces):
            chosen = [piece for piece in made.pieces if piece.name == name]
            _draw_bands(chart, recording.time, travel, factor, chosen, (low, high))
        _draw_rest(chart, recording.time, factor * (travel - made.pieces[-1].end), (low, high))
        _draw_numbers(chart, recording.time, travel, factor, made, high - 0.06 * room)
    elif made.pieces:
        chart.note(f"{len(made.pieces)} pieces: too many to draw", yref="y domain", x=0.5, y=0.97, yanchor="top")
    chart.curve(1, "saw", recording.time, saw, Style(SLAVE, 2.2), unit=unit, kept=kept)
    if (cutting := recording.values[names.cutting] != 0.0).any():
        _draw_cutting(chart, recording.time, saw, cutting)
    chart.axis(1)["range"] = [low, high]
    for bound in bounds(scenario, found):
        if bound.row == 1 and abs(bound.value - 0.5 * (low + high)) <= 0.5 * NEAR * room:
            draw_bound(chart, bound, unit)


def _draw_bands(
    chart: Chart,
    time: Reals,
    travel: Reals,
    factor: float,
    chosen: Sequence[Piece],
    window: tuple[float, float],
) -> None:
    """Draw pieces of one kind while they are in the window of the saw's positions."""
    low, high = window
    most = max(8, BUCKETS // max(len(chosen), 1))
    x: list[Any] = []
    y: list[Any] = []
    for piece in chosen:
        lower, upper = factor * (travel - piece.end), factor * (travel - piece.begin)
        lower, upper = np.minimum(lower, upper), np.maximum(lower, upper)
        inside = np.flatnonzero((upper > low) & (lower < high))
        if len(inside) < 2:
            continue
        at = _corners(inside, lower, upper, window, most)
        bottom, top = np.clip(lower[at], low, high), np.clip(upper[at], low, high)
        x += [*rounded(time[at], TIME_DIGITS), *rounded(time[at][::-1], TIME_DIGITS), None]
        y += [*rounded(bottom, 6), *rounded(top[::-1], 6), None]
    colour = kind_colour(chosen[0].kind)
    area = {"type": "scatter", "mode": "lines", "x": x, "y": y, "fill": "toself", "fillcolor": colour}
    chart.add(1, chosen[0].name, area | {"line": {"width": 0.8, "color": MUTED}, "hoverinfo": "skip"}, legend=False)


def _draw_rest(chart: Chart, time: Reals, edge: Reals, window: tuple[float, float]) -> None:
    """Draw the material behind the last cut, whose front edge is at these positions of the saw."""
    low, high = window
    inside = np.flatnonzero(edge > low)
    if len(inside) < 2:
        return
    at = _corners(inside, edge, edge, window, BUCKETS)
    x = rounded([*time[at], time[at[-1]], time[at[0]]], TIME_DIGITS)
    y = rounded([*np.clip(edge[at], low, high), low, low], 6)
    area = {"type": "scatter", "mode": "lines", "x": x, "y": y, "fill": "toself", "fillcolor": kind_colour(0)}
    chart.add(1, "not cut", area | {"line": {"width": 0.8, "color": MUTED}, "hoverinfo": "skip"})


def _corners(inside: Indices, lower: Reals, upper: Reals, window: tuple[float, float], most: int) -> Indices:
    """So many points of those inside the window, and those at which an edge of the piece enters or leaves it."""
    low, high = window
    spread = inside[np.unique(np.linspace(0, len(inside) - 1, min(len(inside), most)).round().astype(int))]
    crossings = [np.flatnonzero(np.diff(edge > level)) for edge in (lower, upper) for level in (low, high)]
    both = np.concatenate([c + i for c in crossings for i in (0, 1)])
    return np.union1d(spread, np.intersect1d(both, inside))


def _draw_numbers(chart: Chart, time: Reals, travel: Reals, factor: float, made: Production, position: float) -> None:
    """Write the pieces' numbers where their middles pass a position of the saw, but none over another one."""
    passing = np.maximum.accumulate(travel - position / factor)
    after, room = chart.span[0], APART * (chart.span[1] - chart.span[0])
    for piece in made.pieces:
        middle = 0.5 * (piece.begin + piece.end)
        if passing[0] < middle < passing[-1] and (at := float(np.interp(middle, passing, time))) >= after:
            chart.note(str(piece.number), xref="x", x=at, yref="y", y=position, bgcolor=CLEAR, font={"size": 11})
            after = at + room


def _draw_cutting(chart: Chart, time: Reals, saw: Reals, cutting: Any) -> None:
    """Draw the saw once more, thick, while it cuts."""
    x: list[Any] = []
    y: list[Any] = []
    borders = np.flatnonzero(np.diff(cutting, prepend=False, append=False))
    for first, after in zip(borders[::2].tolist(), borders[1::2].tolist(), strict=True):
        at = np.unique(np.linspace(first, after - 1, min(after - first, 6)).round().astype(int))
        x += [*rounded(time[at], TIME_DIGITS), None]
        y += [*rounded(saw[at]), None]
    line = {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": INK, "width": 5}}
    chart.add(1, "cutting", line | {"hoverinfo": "skip"})


# --- the line, the errors, the reserve ---


def _draw_line(chart: Chart, scenario: Scenario, recording: Recording, names: Books, kept: Indices) -> None:
    """Draw the master's velocity, the one that the block asks for, and the greatest that it can follow."""
    unit = unit_name(Unit.VELOCITY, scenario.unit)
    chart.head(2, f"velocity of the line{_in(unit)}")
    velocity, limit = recording.master[:, 1], recording.values[names.max_velocity]
    request = recording.values[names.request]
    fastest = max(float(np.abs(velocity).max()), 1e-9)
    top = max(fastest, *(float(v.max(initial=0.0, where=v <= FASTEST * fastest)) for v in (limit, request)))
    time = recording.time
    chart.curve(2, "limit of the line", time, limit, Style(LIMIT, 1.5, "dash"), names.max_velocity, unit, kept=kept)
    chart.curve(2, "asked of the line", time, request, Style(REFERENCE, 2.0), names.request, unit, kept=kept)
    chart.curve(2, "line", time, velocity, Style(MASTER, 2.0), "velocity of the line", unit, kept=kept)
    chart.axis(2)["range"] = [min(0.0, 1.1 * float(velocity.min())), 1.12 * top]


def _draw_errors(chart: Chart, made: Production) -> None:
    """Draw the length error of each piece as a stem, and how great it may be."""
    chart.head(3, f"length error{_in(made.unit)}")
    if not made.pieces:
        chart.note("no piece", yref="y3 domain", x=0.5, y=0.5)
        chart.axis(3)["range"] = [-1.0, 1.0]
        return
    worst = max((abs(p.error) for p in made.products), default=0.0)
    rounding = worst <= ROUNDING * made.scale
    shown = rounding or made.tolerance < FAR * worst
    most = OFF * max(made.tolerance if shown else 0.0, 0.0 if rounding else worst) or 1.0
    if shown:
        _draw_tolerance(chart, made)
    _draw_stems(chart, made, most)
    if rounding and made.products:
        text = f"0 to rounding: at most {engineering(worst, made.unit)}" if worst else "0 for each product"
        chart.note(text, yref="y3 domain", x=0.5, y=0.85)
    chart.axis(3)["range"] = [-1.12 * most, 1.12 * most]
    if most < SMALL:
        chart.axis(3)["tickformat"] = ".2~e"


def _draw_stems(chart: Chart, made: Production, most: float) -> None:
    beyond = [abs(p.error) > most for p in made.pieces]
    x = rounded((p.told for p in made.pieces), TIME_DIGITS)
    y = rounded(float(np.clip(p.error, -most, most)) for p in made.pieces)
    line = {"type": "scatter", "mode": "lines", "line": {"color": INK, "width": 1}, "hoverinfo": "skip"}
    stems = {"x": [e for t in x for e in (t, t, None)], "y": [e for v in y for e in (0, v, None)]}
    chart.add(3, "stems", line | stems, legend=False)
    up = ["triangle-up" if p.error > 0.0 else "triangle-down" for p in made.pieces]
    trace = {
        "type": "scatter",
        "mode": "markers",
        "x": x,
        "y": y,
        "customdata": [_told(p, made) for p in made.pieces],
        "marker": {
            "size": 8,
            "symbol": [s if far else "circle" for s, far in zip(up, beyond, strict=True)],
            "color": [(OK if p.good else BAD) if p.product else MUTED for p in made.pieces],
        },
        "hovertemplate": "%{customdata}<extra></extra>",
    }
    chart.add(3, "length error", trace, legend=False)


def _draw_tolerance(chart: Chart, made: Production) -> None:
    (begin, end), most = chart.span, made.tolerance
    band = {"x": [begin, end, end, begin, begin], "y": [-most, -most, most, most, -most], "fill": "toself"}
    line = {
        "type": "scatter",
        "mode": "lines",
        "fillcolor": "--cut",
        "line": {"color": LIMIT, "width": 1, "dash": "dot"},
    }
    chart.add(3, "tolerance", band | line | {"opacity": 0.7, "hoverinfo": "skip"})
    text, font = f"tolerance {engineering(made.tolerance, made.unit)}", {"size": 10, "color": LIMIT}
    chart.note(text, x=1, xanchor="right", y=made.tolerance, yref="y3", yanchor="top", font=font)


def _draw_reserve(chart: Chart, recording: Recording, made: Production, names: Books, kept: Indices) -> None:
    """Draw what is left of the cycle: of each piece as a bar, and what it would be at the present velocity."""
    chart.head(4, "reserve in % of the cycle")
    spare = 100.0 * recording.values[names.spare]
    style = Style(MASTER, 1.2)
    chart.curve(4, "reserve at this velocity", recording.time, spare, style, names.spare, "%", kept=kept)
    x = rounded((p.sync for p in made.pieces), TIME_DIGITS)
    y = rounded(100.0 * p.reserve for p in made.pieces)
    line = {"type": "scatter", "mode": "lines", "line": {"color": OK, "width": 3}, "hoverinfo": "skip"}
    stems = {"x": [e for t in x for e in (t, t, None)], "y": [e for v in y for e in (0, v, None)]}
    chart.add(4, "reserve of a piece", line | stems)
    said = [f"{engineering(100.0 * p.reserve, digits=3)} %, piece {p.number}" for p in made.pieces]
    colours = [BAD if p.product and p.reserve <= 0.0 else OK for p in made.pieces]
    dots = {"x": x, "y": y, "customdata": said, "marker": {"color": colours, "size": 7}}
    dots |= {"type": "scatter", "mode": "markers", "hovertemplate": "%{customdata}<extra>reserve</extra>"}
    chart.add(4, "reserve", dots, legend=False)
    chart.axis(4)["range"] = [min(0.0, 1.1 * float(spare.min(initial=0.0, where=spare > -50.0))), 106.0]
