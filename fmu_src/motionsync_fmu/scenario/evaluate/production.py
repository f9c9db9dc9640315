"""The production of a block that records its pieces: how many of which kind, how exact, with how much reserve."""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ..engineering import ROUNDING, engineering, line_speed
from ..recording import Recording, greatest_position
from ..scenario import Scenario
from .find_pieces import Piece, find_pieces, rises
from .time_series import time_series


@dataclass(frozen=True)
class LineVelocity:
    """The master's velocity next to the greatest one that the block can follow, while pieces are cut.

    Attributes:
        greatest: the greatest velocity, in u/s.
        at: where the velocity was nearest to the limit, or farthest beyond it, in s.
        velocity, limit: both at that time, in u/s.
        beyond: how long it was beyond the limit, by more than rounding, in s. The limit falls as soon as a short
            piece is expected: a line that then slows down is beyond it for a while, and nothing is missed.
        unit: the unit of velocities.
    """

    greatest: float
    at: float
    velocity: float
    limit: float
    beyond: float
    unit: str

    @property
    def where(self) -> str:
        """Where it was nearest to its limit, or farthest beyond it: `at 3.2 s: 1200 of 1293 mm/s`."""
        return f"at {engineering(self.at, 's')}: {engineering(self.velocity)} of {engineering(self.limit, self.unit)}"

    @property
    def limit_text(self) -> str:
        """The same in words: `nearest to its limit at 3.2 s: 1200 of 1293 mm/s`."""
        if self.beyond:
            return f"above its limit for {engineering(self.beyond, 's', digits=3)}, most {self.where}"
        return f"nearest to its limit {self.where}"


@dataclass(frozen=True)
class Production:
    """The pieces and cuts of a run, as the block reports them.

    Attributes:
        pieces: those that it reported, in the sequence of their cuts.
        cuts: how many cuts it counted; of several within one step it reports the last piece only.
        skipped, late: how many cuts were skipped, or made late.
        line: the master's velocity next to its limit; None: the block never ran.
        tolerance: how far a length may be off, in u: that of the scenario, or else the block's own.
        unit: the unit of lengths.
        scale: the greatest magnitude of the positions of material and slave, in u: errors are compared with it.
        turns: whether what cuts turns from cut to cut, without a pause.
    """

    pieces: tuple[Piece, ...]
    cuts: int
    skipped: int
    late: int
    line: LineVelocity | None
    tolerance: float
    unit: str
    scale: float
    turns: bool

    @property
    def tool(self) -> str:
        """What cuts."""
        return "knife" if self.turns else "saw"

    @property
    def products(self) -> list[Piece]:
        """The pieces whose lengths were ordered."""
        return [piece for piece in self.pieces if piece.product]

    @property
    def gaps(self) -> list[float]:
        """How far each cut is from where the block reports it, in u; without cuts that were shorter than a step."""
        return [piece.gap for piece in self.pieces if piece.gap is not None]

    @property
    def accepted_count(self) -> int:
        """How many products are within the block's tolerance."""
        return sum(piece.good for piece in self.pieces)

    @property
    def worst(self) -> Piece | None:
        """The product whose length is off most; None without one."""
        return max(self.products, key=lambda piece: abs(piece.error), default=None)

    @property
    def tightest(self) -> Piece | None:
        """The piece with the least reserve; None without one."""
        return min(self.pieces, key=lambda piece: piece.reserve, default=None)

    @property
    def kinds_text(self) -> str:
        """How many pieces of which kind: `11 PRODUCT, 1 MERGED`."""
        return ", ".join(f"{n} {name}" for name, n in Counter(piece.name for piece in self.pieces).items())

    @property
    def made_text(self) -> str:
        """What was made, in words: `17 products, all good`, `3 products, 2 good; also 1 trim, 1 merged`."""
        accepted = "all good" if self.accepted_count == len(self.products) else f"{self.accepted_count} good"
        others = Counter(piece.name for piece in self.pieces if not piece.product)
        also = ", ".join(f"{n} {name.lower().replace('_', ' ')}" for name, n in others.items())
        return f"{_number_of(len(self.products), 'product')}, {accepted}{f'; also {also}' if also else ''}"

    @property
    def pieces_text(self) -> str:
        """The pieces in words: `12 pieces: 11 PRODUCT, 1 MERGED; 11 good`."""
        if not self.cuts:
            return "no piece"
        return f"{_number_of(self.cuts, 'piece')}: {self.kinds_text}; {self.accepted_count} good"

    @property
    def worst_text(self) -> str:
        """How far the worst product's length is off: `0.25 mm (piece 3)`, `0 (to rounding)`; empty without one."""
        if not self.worst:
            return ""
        off = engineering(abs(self.worst.error), self.unit, scale=self.scale)
        exact = abs(self.worst.error) <= ROUNDING * self.scale
        return off if exact or len(self.products) == 1 else f"{off} (piece {self.worst.number})"

    @property
    def merged(self) -> int:
        """How many pieces have a skipped cut in them."""
        return sum(piece.merged for piece in self.pieces)

    @property
    def products_text(self) -> str:
        """How many products there are: `1 product`, or `1 product, 6 merged pieces not included`."""
        merged = f", {_number_of(self.merged, 'merged piece')} not included" if self.merged else ""
        return f"{_number_of(len(self.products), 'product')}{merged}"

    @property
    def missed_text(self) -> str:
        """The cuts that did not come on time: `2 skipped, 1 late`; empty if all did."""
        counts = ((self.skipped, "skipped"), (self.late, "late"))
        return ", ".join(f"{number} {what}" for number, what in counts if number)

    @property
    def line_speed_text(self) -> str:
        """The greatest velocity of the line: `1200 mm/s (72 m/min)`; empty if the block never ran."""
        return line_speed(self.line.greatest, self.unit) if self.line else ""

    @property
    def line_text(self) -> str:
        """How near the line came to its limit, and what followed from it; empty if the block never ran."""
        if not self.line or not self.line.beyond or self.missed_text:
            return self.line.limit_text if self.line else ""
        duration = engineering(self.line.beyond, "s", digits=3)
        return (
            f"for {duration} faster than the next pieces allow (most {self.line.where}), but slow enough in time: "
            "no cut was late"
        )

    @property
    def is_exact(self) -> bool:
        """Whether each product is as long as ordered, to rounding."""
        return all(abs(piece.error) <= ROUNDING * self.scale for piece in self.products)

    @property
    def reserve_text(self) -> str:
        """The least reserve: `at least 12.4 % (piece 4) of a cycle`. Of a knife, which turns without a pause, how far
        the line was below its limit: `the line at least 7.9 % below its limit`. Empty without a piece."""
        if not self.tightest:
            return ""
        if not self.turns:
            return f"at least {100.0 * self.tightest.reserve:.3g} % (piece {self.tightest.number}) of a cycle"
        margin = 1.0 - self.line.velocity / self.line.limit if self.line and self.line.limit > 0.0 else -math.inf
        how = f"at least {100.0 * margin:.3g} % below" if margin >= 0.0 else f"up to {-100.0 * margin:.3g} % above"
        return f"the line {how} its limit" if math.isfinite(margin) else "the line above its limit, which is 0"

    @property
    def short_text(self) -> str:
        """All of it in a few words."""
        parts = [_number_of(self.cuts, "piece") if self.cuts else "no piece"]
        if self.worst:
            of_products = f" ({self.products_text})" if self.merged else ""
            parts.append(f"worst error {self.worst_text}{of_products}")
        return ", ".join([*parts, *([self.missed_text] if self.missed_text else [])])


def evaluate_production(scenario: Scenario, recording: Recording) -> Production | None:
    """What was made in a run of a scenario; None for a block that does not report its pieces."""
    names = scenario.recipe.piece_variables
    if names is None:
        return None
    cuts, skipped, late = (
        int(rises(recording.values[name]).sum()) for name in (names.pieces, names.skipped, names.late)
    )
    spec = scenario.pieces
    return Production(
        tuple(find_pieces(scenario, recording)),
        cuts,
        skipped,
        late,
        _compare_line_velocity(recording, names.max_velocity, names.running, unit_name(Unit.VELOCITY, scenario.unit)),
        spec.tolerance if spec else float(time_series(scenario, recording, names.tolerance)[0]),
        unit_name(Unit.POSITION, scenario.unit),
        greatest_position(recording),
        names.turns,
    )


def _compare_line_velocity(recording: Recording, limit: str, running: str, unit: str) -> LineVelocity | None:
    at = np.flatnonzero(recording.values[running])
    if not len(at):
        return None
    velocity, allowed = recording.master[at, 1], recording.values[limit][at]
    i = int(np.argmax(velocity / np.maximum(allowed, 1e-300)))
    beyond = velocity > allowed * (1.0 + ROUNDING)
    duration = float(np.diff(recording.time, prepend=recording.time[0])[at][beyond].sum())
    values = (float(velocity.max()), float(recording.time[at[i]]), float(velocity[i]), float(allowed[i]))
    return LineVelocity(*values, duration, unit)


def _number_of(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"
