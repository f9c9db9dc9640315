"""The material: where its cuts are. What is ordered and what the marks demand determine the piece in progress.

Positions are unwrapped positions of the master at which a cut passes slave position 0, u.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.grid import floor, nearest_on_grid, rounding_tolerance
from .faults import MarkRefusal, NoLength, PieceFault
from .interface import CuttingInterface, PieceKind, Source, StartMode, Statistics
from .marks import MarkQueue
from .orders import OrderQueue
from .piece import CAPACITY, LEAST_LENGTH, NO_ORDER, UNLIMITED, PieceInProgress
from .records import increased
from .settings import CuttingSettings

FARTHEST_MARK = 1e4  # of the spacing of marks: a cut further ahead is none


@dataclass(slots=True)
class Demand:
    """The values of the inputs and of two parameters in the present step.

    Attributes:
        source: what decides where the cuts are.
        length: of a piece while no order waits, u.
        length_correction: is added to every piece's measured length, u.
        waste: pieces that start now are waste.
        repeat: a completed order is appended anew.
    """

    source: Source = Source.LENGTH
    length: float = 0.0
    length_correction: float = 0.0
    waste: bool = False
    repeat: bool = False

    def read(self, block: CuttingInterface) -> None:
        self.source = block.source
        self.length = block.length
        self.length_correction = block.length_correction
        self.waste = block.waste
        self.repeat = block.order.repeat

    def correction(self) -> float:
        """The length correction, u; pieces between marks have none."""
        return self.length_correction if self.source == Source.LENGTH else 0.0


@dataclass(slots=True)
class Material:
    """The piece in progress and all that waits behind it.

    Attributes:
        is_sample_pending: a sample is to be cut after the next cut.
        has_cut: a cut has been made, at `last_cut`, with this kerf and length correction.
        mark_fault, mark_refusal: what is wrong with the marks that were watched last, and why one was refused, which is
            at `refused_mark`.
        is_mark_missing, is_mark_outside, is_mark_refused: since the last accepted mark one did not come, an edge was no
            mark, or one was refused.
        queue_pitch: the least pitch of all that waits, with this allowance of kerf and correction, u, and this factor.
    """

    settings: CuttingSettings = var.part(CuttingSettings, hidden=True)
    demand: Demand = var.part(Demand)
    piece: PieceInProgress = var.part(PieceInProgress)
    orders: OrderQueue = var.part(OrderQueue)
    marks: MarkQueue = var.part(MarkQueue)
    is_sample_pending: bool = False
    has_cut: bool = False
    last_cut: float = 0.0
    last_kerf: float = 0.0
    last_correction: float = 0.0
    mark_fault: PieceFault = PieceFault.NONE
    mark_refusal: MarkRefusal = MarkRefusal.NONE
    refused_mark: float = 0.0
    is_mark_missing: bool = False
    is_mark_outside: bool = False
    is_mark_refused: bool = False
    queue_allowance: float = 0.0
    queue_factor: float = 0.0
    queue_pitch: float = UNLIMITED

    # --- the piece ---

    def start(self, start_mode: StartMode, master: float, front: float) -> None:
        """Fix the first piece after a start, at which the master is at this position.

        `front`: the master's travel from the material's front end to slave position 0, u."""
        self.piece.begin = self.last_cut
        if start_mode != StartMode.CONTINUE:
            self.marks.clear()
            self.piece.begin = master - (front + 0.5 * self.settings.piece.kerf / self.settings.factor)
        if start_mode == StartMode.TRIM:
            self.fix_trim()
        else:
            self.fix_piece()

    def measure_piece(self) -> None:
        """The piece is measured with the present settings."""
        self.piece.factor = self.settings.factor
        self.piece.kerf = self.settings.piece.kerf
        self.piece.correction = self.demand.correction()

    def fix_trim(self) -> None:
        """The piece is what is cropped from the front end; its pitch is no limit for the line."""
        self.measure_piece()
        self.piece.fix(PieceKind.TRIM, self.settings.start.trim_length, NO_ORDER)
        self.piece.pitch = UNLIMITED

    def fix_piece(self) -> None:
        """Fix the piece that starts at the last cut, if its length is determined."""
        self.piece.reset()
        self.measure_piece()
        if self.demand.source == Source.MARK:
            self.fix_marked()
        elif self.demand.waste:
            self.fix_length(PieceKind.WASTE, self.settings.piece.waste_length, NO_ORDER)
        elif self.is_sample_pending:
            self.fix_length(PieceKind.SAMPLE, self.settings.piece.sample_length, NO_ORDER)
            self.is_sample_pending = not self.piece.is_fixed
        else:
            self.fix_product()

    def fix_open_piece(self) -> None:
        """Fix a piece that had no length, if there is one now. A mark fixes its piece when it comes."""
        if self.demand.source == Source.MARK:
            self.measure_piece()
        else:
            self.fix_piece()

    def fix_product(self) -> None:
        """The piece is of the active order, or of the input length."""
        length, order = self.next_product()
        self.fix_length(PieceKind.PRODUCT, length, order)

    def change_product(self) -> None:
        """Fix the product in progress anew."""
        self.piece.reset()
        self.measure_piece()
        self.fix_product()

    def fix_length(self, kind: PieceKind, length: float, order: int) -> None:
        """Give the piece this length, if a piece can have it."""
        if self.piece.can_have(length):
            self.piece.fix(kind, length, order)

    def missing_length(self) -> NoLength:
        """Why no length is known for the piece that starts at the last cut."""
        if self.piece.is_fixed or self.demand.source == Source.MARK:
            return NoLength.NONE
        length = self.expected_length(False)
        is_input = not self.demand.waste and not self.is_sample_pending and self.orders.waiting == 0
        if is_input and length <= LEAST_LENGTH:
            return NoLength.NOT_GIVEN
        return NoLength.NONE if self.piece.can_have(length) else NoLength.TOO_SHORT

    def fix_marked(self) -> None:
        """The piece ends at the next mark that is cut. Without their spacing marks do not determine its length."""
        piece = self.piece
        mark = self.settings.mark
        piece.has_ordered_length = mark.spacing > 0.0
        if self.marks.waiting > 0:
            piece.is_fixed = True
            piece.kind = PieceKind.PRODUCT
            if piece.has_ordered_length:
                piece.ordered = mark.spacing * float(mark.every) - piece.kerf
            piece.end = self.marks.position(0)
            piece.pitch = limiting_distance(piece.end - piece.begin)

    def try_fix_short(self, end: float) -> bool:
        """The piece ends with a cut out of turn, at this position; False: it would have no length."""
        if not self.piece.is_fixed:
            self.measure_piece()
        if not self.piece.leaves_length(end):
            return False
        self.piece.is_fixed = True
        self.piece.kind = PieceKind.SHORT
        self.piece.end = end
        return True

    def next_product(self) -> tuple[float, int]:
        """Length of the product that is due, and the number of its order."""
        if self.orders.waiting > 0:
            return self.orders.length(0), self.orders.first
        return self.demand.length, NO_ORDER

    def has_changed(self) -> bool:
        """Whether the product in progress would be another one if it were fixed now."""
        piece = self.piece
        length, order = self.next_product()
        return (
            length != piece.ordered
            or order != piece.order
            or self.demand.length_correction != piece.correction
            or self.settings.piece.kerf != piece.kerf
            or self.settings.factor != piece.factor
        )

    def skip_pitches(self, number: float, statistics: Statistics) -> None:
        """Leave out so many cuts: the piece ends with the one after them."""
        self.piece.kind = PieceKind.MERGED
        end = self.piece.end + number * self.piece.pitch
        self.piece.end = max(end, self.piece.end + rounding_tolerance(end, end))
        statistics.skipped = increased(statistics.skipped, number)

    def skip_mark(self, statistics: Statistics) -> None:
        """Leave out the cut at the next mark."""
        self.marks.drop()
        statistics.skipped = increased(statistics.skipped, 1.0)

    def end_piece(self, end: float) -> None:
        """The piece has been cut at this position; the next one starts, and is not fixed yet."""
        piece = self.piece
        self.has_cut = True
        self.last_cut = end
        self.last_kerf = piece.kerf
        self.last_correction = piece.correction
        if self.demand.source == Source.MARK and not piece.waits_for_line() and self.marks.waiting > 0:
            self.marks.drop()
        piece.reset()
        piece.begin = end

    # --- the marks ---

    def watch_marks(self, block: CuttingInterface, detected: bool) -> None:
        """Take a mark that the sensor has seen, and count those that should have come; `mark_fault` and `mark_refusal`
        are the result. The master is at the beginning of the step."""
        self.mark_fault = PieceFault.NONE
        self.mark_refusal = MarkRefusal.NONE
        if not (block.running and self.demand.source == Source.MARK):
            return
        statistics = block.statistics
        settings = self.settings.mark
        master = block.master.begin
        delayed = master - block.master.begin_velocity * settings.delay
        position = delayed
        if detected and settings.latched:
            position = nearest_on_grid(block.mark.position, block.master.period, master)
        is_far = detected and self.is_far_ahead(position, master)
        is_expected = settings.spacing > 0.0 and settings.window > 0.0
        if is_expected:
            self.count_missing_marks(position if detected and not is_far else delayed, settings.substitute, statistics)
        if detected and self.mark_fault == PieceFault.NONE:
            if is_far:
                self.refuse_mark(MarkRefusal.FAR, position, statistics)
            elif is_expected and self.is_before_window(position):
                statistics.marks_outside = increased(statistics.marks_outside, 1.0)
                self.is_mark_outside = True
            elif not self.leaves_length_before(position):
                self.refuse_mark(MarkRefusal.NO_LENGTH, position, statistics)
            else:
                statistics.marks = increased(statistics.marks, 1.0)
                self.is_mark_missing = False
                self.is_mark_outside = False
                self.is_mark_refused = False
                self.marks.missing = 0
                self.add_mark(position)

    def refuse_mark(self, reason: MarkRefusal, position: float, statistics: Statistics) -> None:
        """The edge at a position is no mark: nothing is cut there, and no other mark is expected from there."""
        self.mark_refusal = reason
        self.refused_mark = position
        statistics.marks_refused = increased(statistics.marks_refused, 1.0)
        self.is_mark_refused = True

    def is_far_ahead(self, position: float, master: float) -> bool:
        """Whether the cut of a mark at a position would be further ahead than any sensor is."""
        spacing = self.settings.mark.spacing / self.settings.factor
        return spacing > 0.0 and self.cut_of_mark(position) - master > FARTHEST_MARK * spacing

    def leaves_length_before(self, position: float) -> bool:
        """Whether between the cut of a mark at a position and the cut before it a piece of some length is left."""
        waiting = self.marks.waiting
        before = self.marks.position(waiting - 1) if waiting > 0 else self.piece.begin
        return self.settings.factor * (self.cut_of_mark(position) - before) - self.settings.piece.kerf > LEAST_LENGTH

    def cut_of_mark(self, position: float) -> float:
        """Where the cut of a mark at a position passes slave position 0."""
        mark = self.settings.mark
        return position + (mark.sensor_distance + mark.cut_offset) / self.settings.factor

    def is_before_window(self, position: float) -> bool:
        """Whether a position is before the window in which the next mark is expected."""
        window_start = (self.settings.mark.spacing - self.settings.mark.window) / self.settings.factor
        return self.marks.has_last and position < self.marks.last + window_start

    def count_missing_marks(self, position: float, substitute: bool, statistics: Statistics) -> None:
        """Count the marks that should have come before a position; `substitute`: add a mark for each of them.

        All that do not come between two substitutes that are cut, at most 64 of which wait, are counted at once."""
        spacing = self.settings.mark.spacing / self.settings.factor
        for _ in range(CAPACITY + 2):
            number = self.missing_marks(position)
            if number == 0.0 or self.mark_fault != PieceFault.NONE:
                break
            if substitute:
                number = min(number, float(self.marks.until_cut) + 1.0)
            allowed = min(number, max(float(self.settings.mark.max_missing - self.marks.missing), 0.0))
            counted = min(number, allowed + 1.0)
            self.marks.missing = increased(self.marks.missing, counted)
            statistics.marks_missing = increased(statistics.marks_missing, counted)
            self.is_mark_missing = True
            last = self.marks.last + allowed * spacing
            if counted == allowed and substitute:
                self.marks.until_cut -= int(allowed) - 1
                self.add_mark(last)
                continue
            self.marks.last = last
            if counted > allowed:
                self.mark_fault = PieceFault.MARKS_MISSING
                self.marks.until_cut -= int(allowed) if substitute else 0

    def missing_marks(self, position: float) -> float:
        """How many marks should have come before a position, and have not."""
        spacing = self.settings.mark.spacing / self.settings.factor
        window = self.settings.mark.window / self.settings.factor
        if not (self.marks.has_last and position > self.marks.last + spacing + window):
            return 0.0
        return max(-floor(-(position - self.marks.last - window) / spacing) - 1.0, 1.0)

    def add_mark(self, position: float) -> None:
        """Take a mark at this position of the master."""
        self.marks.has_last = True
        self.marks.last = position
        if not self.marks.try_select(self.settings.mark.every):
            return
        if self.marks.is_full():
            self.mark_fault = PieceFault.MARKS_FULL
            return
        self.marks.append(self.cut_of_mark(position))
        if not self.piece.is_fixed:
            is_merged = self.piece.kind == PieceKind.MERGED
            self.fix_piece()
            if is_merged:
                self.piece.kind = PieceKind.MERGED

    def merge_to_next_mark(self) -> None:
        """The piece, of which a cut was left out, ends at the next mark, if there is one."""
        piece = self.piece
        piece.kind = PieceKind.MERGED
        piece.is_fixed = self.marks.waiting > 0
        if piece.is_fixed:
            piece.end = self.marks.position(0)
        else:
            piece.pitch = UNLIMITED

    # --- pitches ---

    def limiting_pitch(self, running: bool) -> float:
        """The smaller of the pitch in progress, as it was fixed, and the one that is expected after it."""
        expected = self.expected_pitch(running)
        return min(self.piece.pitch, expected) if running else expected

    def expected_pitch(self, running: bool) -> float:
        """The pitch of the piece after the one in progress; UNLIMITED: it is not determined."""
        if self.demand.source == Source.MARK:
            if self.marks.waiting > 1:
                return limiting_distance(self.marks.position(1) - self.marks.position(0))
            return self.pitch_of_marks()
        return self.pitch_of(self.expected_length(running))

    def pitch_of_marks(self) -> float:
        """The pitch of cuts at marks in their spacing; UNLIMITED: it is not given."""
        spacing = self.settings.mark.spacing * float(self.settings.mark.every)
        return spacing / self.settings.factor if spacing > 0.0 else UNLIMITED

    def repeated_pitch(self, shortest: float, length: float) -> float:
        """The least pitch that may come again and again in a step: of `shortest`, the least one at its beginning, and
        of the input length as it is now. The marks that wait are few, and each is cut at most once."""
        if self.demand.source == Source.MARK:
            return self.pitch_of_marks()
        return min(shortest, self.pitch_of(length)) if self.orders.waiting == 0 else shortest

    def expected_length(self, running: bool) -> float:
        """The length of the piece after the one in progress."""
        if self.demand.waste:
            return self.settings.piece.waste_length
        if self.is_sample_pending:
            return self.settings.piece.sample_length
        counts = running and self.piece.kind == PieceKind.PRODUCT
        index = self.orders.next_index(self.piece.order if counts else NO_ORDER, self.demand.repeat)
        return self.demand.length if index < 0 else self.orders.length(index)

    def pitch_of(self, length: float) -> float:
        """The pitch of a piece of that length; UNLIMITED: a piece cannot have it."""
        material = length + self.demand.length_correction + self.settings.piece.kerf
        return material / self.settings.factor if min(length, material) > LEAST_LENGTH else UNLIMITED

    def shortest_pitch(self) -> float:
        """The least pitch of all orders that wait, or of all marks; UNLIMITED without any."""
        allowance = self.settings.piece.kerf + self.demand.length_correction
        if (
            self.orders.has_changed
            or self.marks.has_changed
            or self.queue_allowance != allowance
            or self.queue_factor != self.settings.factor
        ):
            self.orders.has_changed = False
            self.marks.has_changed = False
            self.queue_allowance = allowance
            self.queue_factor = self.settings.factor
            if self.demand.source == Source.MARK:
                self.queue_pitch = self.marks.shortest_pitch()
            else:
                shortest = self.orders.shortest_length()
                self.queue_pitch = self.pitch_of(shortest) if shortest < UNLIMITED else UNLIMITED
        return self.queue_pitch

    def rebase(self, distance: float) -> None:
        """Reduce all positions by a distance, u: whole turns are dropped."""
        self.piece.begin -= distance
        self.piece.end -= distance
        self.last_cut -= distance
        self.marks.rebase(distance)


def limiting_distance(distance: float) -> float:
    """The pitch of two cuts at marks, u; a cut that is not beyond the other one is no limit: it will be late."""
    return distance if distance > 0.0 else UNLIMITED
