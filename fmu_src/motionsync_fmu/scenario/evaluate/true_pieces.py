"""The pieces of a run as a tape measure finds them: by the master's true position and the tool's actual one.

A place is a position on the material: what passed position 0 of the tool's axis when the master was there.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ..computed_columns import ACTUAL_POSITION
from ..engineering import ROUNDING, engineering
from ..recording import Reals, Recording, greatest_position
from ..scenario import Scenario
from .cuts import Cut
from .find_pieces import coupling_factor, tool_travel
from .production import Production
from .time_series import in_nearest_turn, slave_positions, time_series, true_stretches

UNSEEN = "unknown: each cut is over before the next communication point"


@dataclass(frozen=True)
class TrueCuts:
    """The cuts that are over at the end of a run, each of shape (cuts,).

    Attributes:
        begin: the first point of each, in s.
        place: the mean over its time of where on the material the tool is, in u.
        movement: how far the tool moves against the material, in u; NaN for a cut with one point alone.
    """

    begin: Reals
    place: Reals
    movement: Reals


@dataclass(frozen=True)
class TruePiece:
    """A piece between two cuts. Lengths are in u.

    Attributes:
        number: that of the block, or counted from 1.
        at: when the cut at its end began, in s.
        ordered: the length that it should have.
        believed: the length that the block reports; None: it reports none.
    """

    number: int
    at: float
    length: float
    ordered: float
    believed: float | None

    @property
    def error(self) -> float:
        """By how much it is too long, in u."""
        return self.length - self.ordered


@dataclass(frozen=True)
class TruePieces:
    """What the tape measure finds. Lengths are in u; NaN where there are too few pieces.

    Attributes:
        pieces: those with an ordered length, between two cuts that are over.
        mean: the mean length.
        deviation: one sigma of the errors, from two pieces on; where all are ordered alike, that of the lengths.
        worst: the error of the greatest magnitude.
        c_pk: the process capability: how many times 3 sigma the mean error is away from the tolerance; infinite where
            sigma is rounding.
        movement: how far the tool moves against the material while it cuts, in the worst of all cuts; NaN where each
            cut is over before the next communication point.
        allowed_movement: how far it may move so.
        tolerance: how far a length may be off.
        unit: the unit of lengths.
        scale: the greatest magnitude of the positions from which the lengths come, in u.
    """

    pieces: tuple[TruePiece, ...]
    mean: float
    deviation: float
    worst: float
    c_pk: float
    movement: float
    allowed_movement: float
    tolerance: float
    unit: str
    scale: float

    @property
    def c_pk_text(self) -> str:
        """The process capability; empty where there is none, or where it is infinite."""
        return c_pk_text(self.c_pk)

    @property
    def movement_text(self) -> str:
        """How far the tool moves in the worst of all cuts."""
        return UNSEEN if math.isnan(self.movement) else engineering(self.movement, self.unit)

    @property
    def mean_error(self) -> float:
        """By how much the pieces are too long in the mean, in u."""
        return float(np.mean([piece.error for piece in self.pieces])) if self.pieces else math.nan

    @property
    def lengths(self) -> list["OneLength"]:
        """The figures of each ordered length, in the sequence in which they were first cut."""
        groups: dict[str, list[TruePiece]] = {}
        for piece in self.pieces:
            groups.setdefault(engineering(piece.ordered, digits=9), []).append(piece)
        return [
            OneLength(pieces[0].ordered, len(pieces), *_spread(pieces, self.tolerance, self.scale))
            for pieces in groups.values()
        ]


@dataclass(frozen=True)
class OneLength:
    """What the tape measure finds of the pieces with one ordered length. Lengths are in u, as in `TruePieces`."""

    ordered: float
    count: int
    mean: float
    deviation: float
    worst: float
    c_pk: float

    @property
    def c_pk_text(self) -> str:
        """As that of `TruePieces`."""
        return c_pk_text(self.c_pk)


def c_pk_text(c_pk: float) -> str:
    """A process capability; empty where there is none, or where it is infinite."""
    return engineering(c_pk) if math.isfinite(c_pk) else ""


def _spread(pieces: Sequence[TruePiece], tolerance: float, scale: float) -> tuple[float, float, float, float]:
    """The mean length of pieces, one sigma and the worst of their errors, and the process capability."""
    errors = [piece.error for piece in pieces]
    return (
        float(np.mean([piece.length for piece in pieces])) if pieces else math.nan,
        _deviation(errors) if len(errors) > 1 else math.nan,
        max(errors, key=abs, default=math.nan),
        capability(errors, tolerance, scale),
    )


def cutting_flag(scenario: Scenario) -> str:
    """The Boolean that is true while the tool cuts; empty: there is none."""
    names = scenario.recipe.piece_variables
    return names.cutting if names else scenario.cuts.name if scenario.cuts else ""


def allowed_movement(scenario: Scenario, tolerance: float) -> float:
    """How far the tool may move against the material while it cuts, in u; `tolerance`: that of the lengths, in u."""
    spec = scenario.pieces or scenario.cuts
    return tolerance if spec is None or spec.movement is None else spec.movement


def find_true_pieces(
    scenario: Scenario, recording: Recording, production: Production | None, marked: Sequence[Cut]
) -> TruePieces | None:
    """The true pieces of a run; None where nothing is cut, or where the block knows the true places.

    As the block sees them: `production`: what was made, if it reports its pieces; `marked`: else the cuts at marks."""
    if not scenario.has_true_places or not cutting_flag(scenario):
        return None
    cuts = find_true_cuts(scenario, recording)
    pieces = tuple(_reported(scenario, recording, cuts, production) if production else _marked(cuts, marked))
    tolerance = production.tolerance if production else scenario.cuts.tolerance if scenario.cuts else 0.0
    scale = greatest_position(recording)
    return TruePieces(
        pieces,
        *_spread(pieces, tolerance, scale),
        float(np.fmax.reduce(cuts.movement)) if len(cuts.movement) else 0.0,
        allowed_movement(scenario, tolerance),
        tolerance,
        unit_name(Unit.POSITION, scenario.unit),
        scale,
    )


def find_true_cuts(scenario: Scenario, recording: Recording) -> TrueCuts:
    """The cuts of a run by the true positions."""
    stretches = true_stretches(recording.values[cutting_flag(scenario)])
    over = [(first, after) for first, after in stretches if after < len(recording.time)]
    if not over:
        return TrueCuts(*np.zeros((3, 0)))
    first, after = np.array(over).T
    points = after - first
    begins = np.cumsum(points) - points  # of the cuts, among the points of all
    at = np.arange(points.sum()) + np.repeat(first - begins, points)
    actual = recording.computed.get(ACTUAL_POSITION)
    tool = slave_positions(scenario, recording) if actual is None else actual
    if names := scenario.recipe.piece_variables:
        tool = tool_travel(names, recording, tool)[at]
    else:
        tool = in_nearest_turn(tool[at], begins, scenario.slave_period)
    places = recording.master[at, 0] - tool / _ratio(scenario, recording)
    spans = np.diff(recording.time[at], prepend=0.0)
    spans[begins] = 0.0
    weights = spans + np.append(spans[1:], 0.0)  # twice those of trapezoids
    weights[begins[points == 1]] = 1.0
    means = np.add.reduceat(weights * places, begins) / np.add.reduceat(weights, begins)
    movement = np.maximum.reduceat(places, begins) - np.minimum.reduceat(places, begins)
    movement[points == 1] = math.nan
    return TrueCuts(recording.time[first], means, movement)


def capability(errors: Sequence[float], tolerance: float, scale: float = 0.0) -> float:
    """The process capability C_pk of errors that may be up to `tolerance` on both sides; NaN for fewer than two.

    Where all are the same but for rounding it is infinite: positive within the tolerance, negative beyond.

    `scale`: the greatest magnitude of the positions from which the errors come."""
    if len(errors) < 2:
        return math.nan
    margin, sigma = tolerance - abs(float(np.mean(errors))), _deviation(errors)
    return margin / (3.0 * sigma) if sigma > ROUNDING * scale else math.copysign(math.inf, margin)


def _deviation(errors: Sequence[float]) -> float:
    """One sigma, estimated from two errors or more; 0, without rounding, where all are the same."""
    return float(np.std(errors, ddof=1)) if min(errors) < max(errors) else 0.0


def _ratio(scenario: Scenario, recording: Recording) -> float:
    """The tool's travel over the material's true travel in sync, which is that of the true master."""
    names = scenario.recipe.piece_variables
    if names is None:
        return scenario.cuts.ratio if scenario.cuts else 1.0
    first, second = (time_series(scenario, recording, name)[0] for name in names.factors)
    return coupling_factor(scenario, recording) / float(first * second)


def _reported(scenario: Scenario, recording: Recording, cuts: TrueCuts, production: Production) -> Iterator[TruePiece]:
    """The products of a block that reports its pieces, between two cuts that follow one another."""
    names = scenario.recipe.piece_variables
    assert names
    kerfs = time_series(scenario, recording, names.kerf)
    number_at = {time: i for i, time in enumerate(cuts.begin.tolist())}
    before = None
    for piece in production.pieces:
        cut = number_at.get(piece.cut[0]) if piece.cut else None
        if piece.product and piece.measured is not None and cut is not None and cut - 1 == before:
            kerf = kerfs[np.searchsorted(recording.time, piece.reported_at)]
            length = float(cuts.place[cut] - cuts.place[cut - 1] - kerf)
            yield TruePiece(piece.number, float(cuts.begin[cut]), length, piece.ordered, piece.length)
        before = cut


def _marked(cuts: TrueCuts, marked: Sequence[Cut]) -> Iterator[TruePiece]:
    """The pieces of a saw that cuts at marks: they should be as long as the marks are apart."""
    marks = np.diff([cut.mark for cut in marked[: len(cuts.place)]])
    pieces = zip(cuts.begin[1:].tolist(), np.diff(cuts.place).tolist(), marks.tolist(), strict=True)
    for number, (at, length, ordered) in enumerate(pieces, 1):
        if ordered:
            sign = math.copysign(1.0, ordered)
            yield TruePiece(number, at, sign * length, sign * ordered, None)
