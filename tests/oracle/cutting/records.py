"""What a machine that cuts to length makes: orders, pieces, marks, and their records.

Nothing moves in this module: the machine's sequence states when a piece ends and where its cut is.

Readings of the specification that it leaves open:
- A piece keeps the length that was ordered, whatever it becomes: a SHORT or MERGED piece, too, has a `last.error`.
- `length_waste` holds WASTE, TRIM and bad pieces; a sample's length counts nowhere.
- `clear_statistics` resets `statistics.*`, not the batches, nor `order.completed`.
- THIS_PIECE with a length that is none: the piece stays as it was fixed, and the change waits until it ends.
- TRIM: a crop of no length is one of 1e-6.
- A far mark is refused before missing marks are counted.
- A calibration that would bring the factor out of 0.5 to 2 is refused.
- The order that will be in front after a piece: the next one, if the piece is the last PRODUCT that its order lacks.
- A missing mark without `substitute` does not count among the n of `mark.every`.
- With the source MARK, Δ is 0 wherever it occurs, the piece in progress ends at the front of the queue, and the entry
  leaves the queue when that cut ends. A piece whose marks were all dropped by SKIP is MERGED by the next mark.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import ceil, inf, sqrt
from typing import Any

from tests.oracle.cutting.ranges import Ranges

LENGTH, MARK = 1, 2
NONE, PRODUCT, SAMPLE, WASTE, TRIM, SHORT, MERGED = range(7)
START_REFUSED, ORDER_REFUSED, ORDERS_FULL, CALIBRATION_REFUSED, TUNABLE, CUT_NOW_REFUSED = range(1, 7)
CUT_MISSED, MARKS_MISSING, MARKS_FULL = 16, 18, 20
QUEUE = 64
LEAST_LENGTH = 1e-6
FARTHEST_MARK = 1e4
LEAST_FACTOR = 0.5

COUNTERS = (
    *("cuts", "pieces_good", "pieces_bad", "pieces_sample", "pieces_waste", "skipped", "late", "marks"),
    *(
        "marks_missing",
        "marks_outside",
        "marks_refused",
        "unsynchronised",
        "length_good",
        "length_waste",
        "error_worst",
    ),
)


@dataclass(eq=False)
class Order:
    """So many good pieces of a length, and how many are still lacking."""

    length: float
    quantity: int
    remaining: int


@dataclass(frozen=True)
class Piece:
    """The piece that is made at present, with f, b and Δ of when it was fixed; it is to be cut at `cut_position`.

    `any_length`: it has no error, since the marks' distance is not given.
    `pitch`: from the cut before, in travel of the master; it limits the line's velocity. Infinite for TRIM, where no
    length is given, and for a mark whose cut is before the last one.
    """

    kind: int
    ordered: float
    pitch: float
    f: float
    kerf: float
    correction: float
    cut_position: float
    order: Order | None = None
    late: bool = False
    any_length: bool = False


@dataclass
class Statistics:
    """The statistics; the errors of products as they come."""

    counts: dict[str, float] = field(default_factory=lambda: dict.fromkeys(COUNTERS, 0.0))
    errors: list[float] = field(default_factory=list)
    reserve_worst: float = 1.0

    def add(self, name: str, amount: float = 1) -> None:
        self.counts[name] += amount

    def outputs(self) -> dict[str, float]:
        n = len(self.errors)
        mean = sum(self.errors) / n if n else 0.0
        deviation = sqrt(sum((e - mean) ** 2 for e in self.errors) / (n - 1)) if n > 1 else 0.0
        values = self.counts | {"error_mean": mean, "error_deviation": deviation, "reserve_worst": self.reserve_worst}
        return {f"statistics.{name}": float(value) for name, value in values.items()}


class PieceRecords:
    """Orders, pieces and marks of a run, and what is recorded of them.

    `settings`: of the machine, which others change; `inputs`: the same, with the last valid value of what is out of its
    range (`ranges`). `warnings_of_piece`: the names of what warns of a piece until it ends.
    """

    warnings_of_piece: tuple[str, ...] = ("change_pending",)

    def __init__(self, inputs: Mapping[str, Any], ranges: Ranges) -> None:
        self.settings, self.inputs, self.ranges = inputs, dict(inputs), ranges
        self.calibration = 1.0
        self.is_running, self.has_invalid_settings = False, False
        self.origin = 0.0
        self.piece: Piece | None = None
        self.last_cut: float | None = None
        self.last_piece: Piece | None = None
        self.is_merging = False
        self.sample_requested = False
        self.orders: list[Order] = []
        self.completed = 0
        self.marks: list[float] = []
        self.last_mark: float | None = None
        self.mark_number = 0
        self.missing = 0
        self.statistics = Statistics()
        self.batch_count, self.batches = 0, 0
        self.last = dict.fromkeys(("length", "error", "kind", "good", "time", "reserve"), 0.0)
        warnings = ("mark_missing", "mark_outside", "mark_refused", *self.warnings_of_piece)
        self.warnings = dict.fromkeys(warnings, False)
        self.batch_done = False

    def outputs(self) -> dict[str, float | bool]:
        """What is shown of the pieces and orders."""
        piece, front = self.piece, self.orders[0] if self.orders else None
        return {
            "running": self.is_running,
            "piece.ordered": piece.ordered if piece else 0.0,
            "piece.kind": piece.kind if piece else 0,
            **{f"last.{name}": value for name, value in self.last.items()},
            "order.waiting": len(self.orders),
            "order.length_active": front.length if front else 0.0,
            "order.remaining": front.remaining if front else 0,
            "order.completed": self.completed,
            "calibration.factor": self.calibration,
            **self.statistics.outputs(),
            "batch_count": self.batch_count,
            "batches": self.batches,
            "batch_done": self.batch_done,
            **{f"warning.{name}": value for name, value in self.warnings.items()},
            "warning.no_length": self.is_running and not self.is_by_marks and piece is None,
            "local.marks_waiting": len(self.marks),
        }

    # --- settings -------------------------------------------------------------------------------------------------

    @property
    def is_by_marks(self) -> bool:
        return bool(self.inputs["source"] == MARK)

    @property
    def f(self) -> float:
        return float(self.inputs["material_factor"] * self.calibration)

    @property
    def kerf(self) -> float:
        return float(self.inputs["kerf"])

    @property
    def correction(self) -> float:
        return 0.0 if self.is_by_marks else float(self.inputs["length_correction"])

    def accept_settings(self) -> None:
        """Take what has been set, but for what is out of its range."""
        self.inputs = self.ranges.valid_values(self.settings, self.inputs)

    # --- pieces ---------------------------------------------------------------------------------------------------

    def start(self, master: float, factor: float) -> None:
        """Begin the first piece after `start`; `factor`: travel along which the front is given, per travel of the
        master."""
        mode = self.inputs["start_mode"]
        if mode == 3:
            assert self.last_cut is not None
            self.origin = self.last_cut
        else:
            self.origin = master - self.inputs["front_position"] / factor - self.kerf / (2 * self.f)
            self.marks, self.last_mark, self.mark_number, self.missing = [], None, 0, 0
        self.is_running, self.is_merging = True, False
        self.piece = None
        if mode == 2:
            piece = self._make_piece(TRIM, float(self.inputs["trim_length"]), None)
            self.piece = replace(piece, cut_position=max(piece.cut_position, self.least_end()), pitch=inf)
        else:
            self.fix_piece()

    def stop(self) -> None:
        """The machine does not run any more; the last cut is retained."""
        self.is_running, self.piece, self.is_merging = False, None, False
        self.warnings["change_pending"] = False

    def fix_piece(self) -> None:
        """Fix the piece that starts at the last cut, if it has a length and everything that it reads is valid."""
        self.piece = None
        kind, length, order = self._requested(self.orders)
        read = {WASTE: "waste_length", SAMPLE: "sample_length"}.get(kind, "kerf")
        self.has_invalid_settings = not self.ranges.are_valid(
            self.settings, ("kerf", "material_factor", "mark.spacing" if self.is_by_marks else read)
        )
        if self.has_invalid_settings:
            return
        if not self.is_by_marks:
            pitch = (length + self.correction + self.kerf) / self.f
            if min(length, pitch * self.f) > LEAST_LENGTH:
                self.piece = self._make_piece(kind, length, order)
                self.sample_requested = self.sample_requested and kind != SAMPLE
        elif self.marks:
            inputs = self.inputs
            ordered = inputs["mark.spacing"] * inputs["mark.every"] - self.kerf if inputs["mark.spacing"] > 0 else 0.0
            kind = MERGED if self.is_merging else PRODUCT
            cut_position = self.marks[0]
            pitch = cut_position - self.origin if cut_position > self.origin else inf
            free = inputs["mark.spacing"] <= 0
            self.piece = Piece(kind, ordered, pitch, self.f, self.kerf, 0.0, cut_position, any_length=free)

    def _make_piece(self, kind: int, length: float, order: Order | None) -> Piece:
        pitch = (length + self.correction + self.kerf) / self.f
        return Piece(kind, length, pitch, self.f, self.kerf, self.correction, self.origin + pitch, order)

    def leaves_length(self, cut_position: float) -> bool:
        """Whether a cut there leaves a piece of some length."""
        return cut_position >= self.least_end()

    def least_end(self) -> float:
        """Where a cut begins to leave a piece of some length."""
        f, kerf, correction = self.f, self.kerf, self.correction
        if self.piece is not None:
            f, kerf, correction = self.piece.f, self.piece.kerf, self.piece.correction
        return self.origin + (max(kerf + correction, 0) + LEAST_LENGTH) / f

    def _requested(self, orders: list[Order]) -> tuple[int, float, Order | None]:
        """Kind, length and order of a piece that starts now; a length of 0 or less is none."""
        if self.inputs["waste"]:
            return WASTE, float(self.inputs["waste_length"]), None
        if self.sample_requested:
            return SAMPLE, float(self.inputs["sample_length"]), None
        if orders:
            return PRODUCT, orders[0].length, orders[0]
        return PRODUCT, float(self.inputs["length"]), None

    def change_piece(self, is_reachable: Callable[[float], bool]) -> None:
        """THIS_PIECE at a step's beginning; `is_reachable(position)`: the start for a cut there is still to come."""
        piece = self.piece
        if piece is None:
            self.warnings["change_pending"] = False
        if piece is None or piece.kind != PRODUCT:
            return
        length, order = (self.orders[0].length, self.orders[0]) if self.orders else (float(self.inputs["length"]), None)
        requested = (length, order, self.f, self.kerf, self.correction)
        same = requested == (piece.ordered, piece.order, piece.f, piece.kerf, piece.correction)
        self.warnings["change_pending"] = not (self.inputs["change_mode"] != 2 or self.is_by_marks or same)
        if self.warnings["change_pending"] and self._pitch(length) < inf:
            changed = self._make_piece(PRODUCT, length, order)
            if is_reachable(changed.cut_position):
                self.piece, self.warnings["change_pending"] = changed, False

    def move_cut(self, cut_position: float, kind: int | None = None, *, late: bool = False) -> None:
        """The piece in progress, or one of no given length, is to end at another position."""
        free = self.is_by_marks and self.inputs["mark.spacing"] <= 0
        piece = self.piece or replace(self._make_piece(SHORT, 0.0, None), pitch=inf, any_length=free)
        self.piece = replace(piece, cut_position=cut_position, kind=piece.kind if kind is None else kind, late=late)

    def skip_cut(self, from_position: float) -> None:
        """The cut is left out; the next one is at `least` or beyond."""
        piece = self.piece
        assert piece is not None
        if not self.is_by_marks:
            n = max(1, ceil((from_position - piece.cut_position) / piece.pitch))
            self.piece = replace(piece, cut_position=piece.cut_position + n * piece.pitch, kind=MERGED)
        else:
            before = len(self.marks)
            self.marks.pop(0)
            while self.marks and self.marks[0] < from_position:
                self.marks.pop(0)
            n, self.is_merging = before - len(self.marks), True
            self.piece = replace(piece, cut_position=self.marks[0], kind=MERGED) if self.marks else None
        self.statistics.add("skipped", n)

    def record_cut(self, cut_position: float, time: float, reserve: float) -> None:
        """A cut has been made: the piece ends, and the next one is fixed."""
        piece = self.piece
        assert piece is not None
        length = piece.f * (cut_position - self.origin) - piece.kerf - piece.correction
        error = 0.0 if piece.any_length else length - piece.ordered
        is_accepted = piece.kind == PRODUCT and abs(error) <= self.inputs["length_tolerance"]
        values = (length, error, float(piece.kind), float(is_accepted), time, reserve)
        self.last = dict(zip(self.last, values, strict=True))
        self.statistics.add("cuts")
        self.statistics.reserve_worst = min(self.statistics.reserve_worst, reserve)
        self.batch_done = False
        if piece.kind == PRODUCT:
            self.statistics.errors.append(error)
            self.statistics.counts["error_worst"] = max(self.statistics.counts["error_worst"], abs(error))
        if is_accepted:
            self._count_accepted(piece, length)
        elif piece.kind == SAMPLE:
            self.statistics.add("pieces_sample")
        else:
            self.statistics.add("pieces_waste" if piece.kind in (WASTE, TRIM) else "pieces_bad")
            self.statistics.add("length_waste", length)
        if self.is_by_marks and piece.kind in (PRODUCT, MERGED):
            self.marks.pop(0)
        self.warnings |= dict.fromkeys(self.warnings_of_piece, False)
        self.is_merging = False
        self.last_piece, self.last_cut, self.origin = piece, cut_position, cut_position
        self.fix_piece()

    def _count_accepted(self, piece: Piece, length: float) -> None:
        self.statistics.add("pieces_good")
        self.statistics.add("length_good", length)
        if self.inputs["batch_size"] > 0:
            self.batch_count += 1
            if self.batch_count >= self.inputs["batch_size"]:
                self.batch_count, self.batches, self.batch_done = 0, self.batches + 1, True
        order = piece.order
        if order is not None and order in self.orders:
            order.remaining -= 1
            if order.remaining == 0:
                self.completed += 1
                self.orders = self._without(order)

    def _without(self, order: Order) -> list[Order]:
        """The queue once that order is completed."""
        rest = [other for other in self.orders if other is not order]
        again = [Order(order.length, order.quantity, order.quantity)] if self.inputs["order.repeat"] else []
        return rest + again

    # --- commands -------------------------------------------------------------------------------------------------

    def add_order(self) -> int:
        """The refusal, or 0."""
        length, quantity = float(self.inputs["order.length"]), int(self.inputs["order.quantity"])
        if length <= 0 or quantity < 1:
            return ORDER_REFUSED
        if len(self.orders) >= QUEUE:
            return ORDERS_FULL
        self.orders.append(Order(length, quantity, quantity))
        return 0

    def calibrate(self) -> int:
        """The refusal, or 0."""
        measured, piece = float(self.inputs["calibration.measured_length"]), self.last_piece
        if piece is None or measured <= 0:
            return CALIBRATION_REFUSED
        travel = self.last["length"] + piece.kerf + piece.correction
        factor = self.calibration * (measured + piece.kerf) / travel if travel > 0 else inf
        if not LEAST_FACTOR <= factor <= 1 / LEAST_FACTOR:
            return CALIBRATION_REFUSED
        self.calibration = factor
        return 0

    # --- marks ----------------------------------------------------------------------------------------------------

    def _expected_mark(self) -> tuple[float, float] | None:
        """The position at which the next mark is expected, and how far from it the mark may be."""
        spacing, window = self.inputs["mark.spacing"], self.inputs["mark.window"]
        if spacing > 0 and window > 0 and self.last_mark is not None:
            return self.last_mark + spacing / self.f, window / self.f
        return None

    @property
    def are_marks_expected(self) -> bool:
        return self.is_running and self.is_by_marks and self._expected_mark() is not None

    def count_missing_marks(self, position: float) -> int:
        """Count the marks missing before `position`, each by more than its window: the fault, or 0."""
        while (expected := self._expected_mark()) is not None and position > expected[0] + expected[1]:
            self.statistics.add("marks_missing")
            self.warnings["mark_missing"] = True
            self.missing += 1
            if self.missing > self.inputs["mark.max_missing"]:
                return MARKS_MISSING
            self.last_mark = expected[0]
            if self.inputs["mark.substitute"] and (fault := self._queue_mark(expected[0])):
                return fault
        return 0

    def detect_mark(self, position: float, master: float) -> int:
        """An edge of the sensor, while the master was at `position`; it is at `master` now: the fault, or 0."""
        if not (self.is_running and self.is_by_marks):
            return 0
        spacing = self.inputs["mark.spacing"] / self.f
        if 0 < FARTHEST_MARK * spacing < self._cut_of_mark(position) - master:
            return self._refuse_mark()
        if fault := self.count_missing_marks(position):
            return fault
        expected = self._expected_mark()
        if expected is not None and position < expected[0] - expected[1]:
            self.statistics.add("marks_outside")
            self.warnings["mark_outside"] = True
            return 0
        before = self.marks[-1] if self.marks else self.origin
        if self.f * (self._cut_of_mark(position) - before) - self.kerf <= LEAST_LENGTH:
            return self._refuse_mark()
        self.statistics.add("marks")
        self.warnings |= dict.fromkeys(("mark_missing", "mark_outside", "mark_refused"), False)
        self.missing, self.last_mark = 0, position
        return self._queue_mark(position)

    def _refuse_mark(self) -> int:
        self.statistics.add("marks_refused")
        self.warnings["mark_refused"] = True
        return 0

    def _cut_of_mark(self, position: float) -> float:
        return float(position + (self.inputs["mark.sensor_distance"] + self.inputs["mark.cut_offset"]) / self.f)

    def _queue_mark(self, position: float) -> int:
        number, self.mark_number = self.mark_number, self.mark_number + 1
        if number % self.inputs["mark.every"] != 0:
            return 0
        if len(self.marks) >= QUEUE:
            return MARKS_FULL
        self.marks.append(self._cut_of_mark(position))
        return 0

    # --- what the line may run ------------------------------------------------------------------------------------

    def pitches(self) -> tuple[float, float, list[float]]:
        """Of the piece in progress, of the one expected after it, and of all that waits; infinite where unknown."""
        present = self.piece.pitch if self.piece else inf
        if self.is_by_marks:
            apart = [b - a if b > a else inf for a, b in pairwise(self.marks)]
            spacing = self.inputs["mark.spacing"] * self.inputs["mark.every"] / self.f
            following = apart[0] if apart else (spacing or inf)
            return present, following, apart
        orders = list(self.orders)
        if self.piece and self.piece.kind == PRODUCT and self.piece.order in orders and self.piece.order.remaining == 1:
            orders = self._without(self.piece.order)
        following = self._pitch(self._requested(orders)[1])
        return present, following, [self._pitch(order.length) for order in self.orders]

    def _pitch(self, length: float) -> float:
        """The pitch for a length; infinite for none."""
        travel = length + self.correction + self.kerf
        return travel / self.f if min(length, travel) > LEAST_LENGTH else inf
