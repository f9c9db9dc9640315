"""The pieces of a run: what the block reports of each that it has cut off, and what the positions show.

The material moves with the master. A tool that is in sync with a place on it stays there: slave = factor (master -
place), counted from where it cuts if it turns. So the places of two cuts follow from the positions alone, and from them
the length of the piece in between.
"""

from dataclasses import dataclass

import numpy as np

from ...interface.roles import PieceVariables
from ..recording import Reals, Recording
from ..scenario import Scenario
from .time_series import time_series

PRODUCT = "PRODUCT"  # the kind of a piece as it was ordered
MERGED = "MERGED"  # the kind of a piece in which a cut was skipped


@dataclass(frozen=True)
class Piece:
    """A piece, seen at the communication points. Places are positions of the master, in u, without wrapping.

    Attributes:
        number: 1 for the first piece of the run.
        kind: its kind, a member of the block's enumeration.
        name: the kind's name.
        length: as the block reports it, in u.
        error: as the block reports it: the length less what was ordered, in u.
        good: whether it is a product within the tolerance, as the block reports it.
        sync: when the tool came in sync for the cut that ended it, in s.
        reported_at: the point at which the block reported it, in s.
        reserve: the share of its cycle that was left.
        begin: the place of the cut before it, of the tool's middle.
        end: the place of the cut after it.
        cut: the first and the last point of the cut that ended it, in s; None: it was shorter than a step.
        wander: how far the tool went from its place on the material during this cut, in u; 0 where the line is
            recorded, so that its true place is not known.
        measured: its length by the positions of slave and master, in u; None: one of its cuts cannot be seen, or it is
            the first one after a start, or the line is recorded.
    """

    number: int
    kind: int
    name: str
    length: float
    error: float
    good: bool
    sync: float
    reported_at: float
    reserve: float
    begin: float
    end: float
    cut: tuple[float, float] | None
    wander: float
    measured: float | None

    @property
    def ordered(self) -> float:
        """The length that it should have, in u."""
        return self.length - self.error

    @property
    def product(self) -> bool:
        """Whether its length was ordered."""
        return self.name == PRODUCT

    @property
    def merged(self) -> bool:
        """Whether a cut was skipped in it."""
        return self.name == MERGED

    @property
    def bad(self) -> bool:
        """Whether it is a product out of tolerance, or a merged piece."""
        return self.merged or (self.product and not self.good)

    @property
    def gap(self) -> float | None:
        """How far its cut is from where the block reports it, in u; None: the cut was shorter than a step."""
        if self.cut is None:
            return None
        return max(self.wander, abs(self.measured - self.length) if self.measured is not None else 0.0)


def find_pieces(scenario: Scenario, recording: Recording) -> list[Piece]:
    """The pieces of a run in the order in which they were cut off; none for a block that does not report them.

    Of several pieces that were cut off within one step the block reports the last one."""
    names = scenario.recipe.piece_variables
    return _Finder(scenario, recording, names).pieces() if names else []


def coupling_factor(scenario: Scenario, recording: Recording) -> float:
    """The slave's travel over the master's at the first cut of a run; without one, at its end.

    Raises:
        KeyError: the block does not report its pieces.
    """
    names = scenario.recipe.piece_variables
    if names is None:
        raise KeyError(scenario.recipe.name)
    factors = recording.values[names.coupling_factor]
    at = np.flatnonzero(recording.values[names.cutting])
    return float(factors[at[0] if len(at) else -1]) or 1.0


def tool_travel(names: PieceVariables, recording: Recording, slave: Reals) -> Reals:
    """How far the tool is beyond the place where it cuts, along the material and in the slave's unit."""
    if not names.turns:
        return slave
    spacing, radius = recording.values[names.cut_spacing], recording.values[names.edge_radius]
    travel = slave - spacing * np.round(slave / spacing)
    return np.where(radius > 0.0, radius * np.sin(travel / np.where(radius > 0.0, radius, 1.0)), travel)


def rises(counter: Reals) -> Reals:
    """By how much a counter went up at each point, shape (points,); where it falls it has started again from 0."""
    steps = np.diff(counter, prepend=counter[0])
    return np.where(steps < 0.0, counter, steps)


class _Finder:
    """Finds the pieces of a run."""

    def __init__(self, scenario: Scenario, recording: Recording, names: PieceVariables) -> None:
        self._names = names
        self._is_recorded = scenario.is_recorded
        self._recording = recording
        self._kinds = {int(m): str(m.name) for m in scenario.recipe.variables[names.kind].choices}
        self._rises = rises(recording.values[names.pieces])
        first, second = (time_series(scenario, recording, name) for name in names.factors)
        removed = (time_series(scenario, recording, name) for name in (names.kerf, names.correction))
        self._readings = np.column_stack([first * second, sum(removed)])  # the factor f; what a cut takes away
        self._steady = bool((self._readings == self._readings[0]).all())  # in nearly all runs, which saves time
        factor = recording.values[names.coupling_factor]
        self._places = recording.master[:, 0] - tool_travel(
            names, recording, recording.values["slave.position"]
        ) / np.where(factor, factor, 1.0)

    def pieces(self) -> list[Piece]:
        pieces: list[Piece] = []
        before, total = 0, 0
        for at in np.flatnonzero(self._rises).tolist():
            alone = self._rises[at] == 1.0
            total += int(self._rises[at])
            ran = self._recording.values[self._names.running][before : at + 1].all()  # the block did not stop
            last = pieces[-1] if pieces and alone and ran else None
            pieces.append(self._piece(total, last, before, at))
            before = at
        return pieces

    def _piece(self, number: int, last: Piece | None, before: int, at: int) -> Piece:
        """The piece that is reported at a point; `last`: the piece before it, if it starts with the cut that ended that
        one, which was reported at the point `before`."""
        names, values = self._names, self._recording.values
        kind, length = int(values[names.kind][at]), float(values[names.length][at])
        inside = self._cut(before, at)
        seen = inside.stop > inside.start
        places = self._places[inside] if seen else self._places[at : at + 1]
        end = float(places.mean())
        factor, removed = self._readings[at].tolist()
        measured = None
        if seen and last and last.cut and not self._is_recorded:
            measured = self._measured(end - last.end, length, before, at)
        time = self._recording.time
        return Piece(
            number=number,
            kind=kind,
            name=self._kinds[kind],
            length=length,
            error=float(values[names.error][at]),
            good=bool(values[names.in_tolerance][at]),
            sync=float(values[names.time][at]),
            reported_at=float(time[at]),
            reserve=float(values[names.reserve][at]),
            begin=last.end if last else end - (length + removed) / factor,
            end=end,
            cut=(float(time[inside.start]), float(time[inside.stop - 1])) if seen else None,
            wander=0.0 if self._is_recorded else float(np.abs(places - end).max()),
            measured=measured,
        )

    def _cut(self, before: int, at: int) -> slice:
        """The points of the cut that ended before the point `at`; empty if it is between two points."""
        cutting = self._recording.values[self._names.cutting][before:at] != 0.0
        still = np.flatnonzero(~cutting)
        return slice(before + (int(still[-1]) + 1 if len(still) else 0), at)

    def _measured(self, pitch: float, length: float, before: int, at: int) -> float:
        """The length of a piece by the master's travel between its cuts.

        If factor, kerf or correction changed while the piece was made, the block took one of the values: that which
        gives the length nearest to the reported one."""
        readings = self._readings[:1] if self._steady else np.unique(self._readings[before : at + 1], axis=0)
        lengths = readings[:, 0] * pitch - readings[:, 1]
        return float(lengths[np.argmin(np.abs(lengths - length))])
