"""The material: where its cuts lie. What is ordered, what the marks say, and which piece comes of it.

Places are unwrapped positions of the master at which the line of a cut passes carriage position 0, u.
"""

from dataclasses import dataclass

from .. import var
from ..grid import nearest
from .faults import Fault
from .interface import CutToLengthInterface, PieceKind, Source
from .marks import Marks
from .orders import Orders
from .piece import LEAST_MATERIAL, NO_ORDER, UNLIMITED, PieceInProgress
from .settings import Settings


@dataclass(slots=True)
class Material:
    """The piece in progress and all that waits behind it.

    Attributes:
        sample_waits: a sample is to be cut after the next cut.
        has_cut: a cut has been made, at `last_place`, with this kerf and length correction.
        fault: what is wrong with the marks that were watched last.
        queue_pitch: the least pitch of all orders or marks that wait; `queue_known`: it has been found, for these.
    """

    piece: PieceInProgress = var.part(PieceInProgress)
    orders: Orders = var.part(Orders)
    marks: Marks = var.part(Marks)
    sample_waits: bool = False
    has_cut: bool = False
    last_place: float = 0.0
    last_kerf: float = 0.0
    last_correction: float = 0.0
    fault: Fault = Fault.NONE
    queue_known: bool = False
    queue_material: float = 0.0
    queue_factor: float = 0.0
    queue_pitch: float = UNLIMITED

    # --- the piece ---

    def measure(self, block: CutToLengthInterface, settings: Settings) -> None:
        """The piece is measured as the parameters say now."""
        self.piece.factor = settings.factor
        self.piece.kerf = settings.kerf
        self.piece.correction = correction_of(block)

    def crop(self, block: CutToLengthInterface, settings: Settings) -> None:
        """The piece is what is cropped from the front end; its pitch is no limit for the line."""
        self.measure(block, settings)
        self.piece.fix(PieceKind.TRIM, settings.trim_length, NO_ORDER)
        self.piece.pitch = UNLIMITED

    def fix(self, block: CutToLengthInterface, settings: Settings) -> None:
        """Fix the piece that begins at the last cut, if its length is known."""
        self.piece.forget()
        self.measure(block, settings)
        if block.source == Source.MARK:
            self.fix_marked(settings)
        elif block.waste:
            self.fix_length(PieceKind.WASTE, settings.waste_length, NO_ORDER)
        elif self.sample_waits:
            self.fix_length(PieceKind.SAMPLE, settings.sample_length, NO_ORDER)
            self.sample_waits = not self.piece.known
        else:
            self.fix_product(block)

    def look_for_length(self, block: CutToLengthInterface, settings: Settings) -> None:
        """The length of the piece was not known: fix it if it is now. A mark fixes its piece when it comes."""
        if block.source == Source.MARK:
            self.measure(block, settings)
        else:
            self.fix(block, settings)

    def fix_product(self, block: CutToLengthInterface) -> None:
        """The piece is of the active order, or of the input length."""
        length, order = self.product(block)
        self.fix_length(PieceKind.PRODUCT, length, order)

    def change_product(self, block: CutToLengthInterface, settings: Settings) -> None:
        """Fix the product in progress anew."""
        self.piece.forget()
        self.measure(block, settings)
        self.fix_product(block)

    def fix_length(self, kind: PieceKind, length: float, order: int) -> None:
        """The piece has this length, if that is one."""
        if self.piece.can_measure(length):
            self.piece.fix(kind, length, order)

    def fix_marked(self, settings: Settings) -> None:
        """The piece ends at the next mark that is cut. Marks without a known spacing say nothing of its length."""
        piece = self.piece
        piece.exact = settings.mark.spacing > 0.0
        if self.marks.waiting > 0:
            piece.known = True
            piece.kind = PieceKind.PRODUCT
            if piece.exact:
                piece.ordered = settings.mark.spacing * float(settings.mark.every) - piece.kerf
            piece.end = self.marks.place(0)
            piece.pitch = limiting(piece.end - piece.begin)

    def product(self, block: CutToLengthInterface) -> tuple[float, int]:
        """Length of the product that is due, and the number of its order."""
        if self.orders.waiting > 0:
            return self.orders.length(0), self.orders.first
        return block.length, NO_ORDER

    def has_changed(self, block: CutToLengthInterface, settings: Settings) -> bool:
        """Whether the product in progress would be another one if it were fixed now."""
        piece = self.piece
        length, order = self.product(block)
        return (
            length != piece.ordered
            or order != piece.order
            or block.length_correction != piece.correction
            or settings.kerf != piece.kerf
            or settings.factor != piece.factor
        )

    def changed_pitch(self, block: CutToLengthInterface, settings: Settings) -> float:
        """The pitch of the product in progress if it were fixed now; UNLIMITED: it would have no length."""
        length, _ = self.product(block)
        return self.pitch_of(length, block, settings)

    def end_piece(self, block: CutToLengthInterface, place: float) -> None:
        """The piece has been cut; the next one begins, of which nothing is known yet."""
        piece = self.piece
        self.has_cut = True
        self.last_place = place
        self.last_kerf = piece.kerf
        self.last_correction = piece.correction
        if block.source == Source.MARK and not piece.waits_for_line() and self.marks.waiting > 0:
            self.marks.drop()
            self.queue_known = False
        piece.forget()
        piece.begin = place

    def measured_material(self, length: float) -> float:
        """The material of the last piece, with its kerf, if the piece has this length, u."""
        return length + self.last_kerf + self.last_correction

    # --- the orders ---

    def add_order(self, length: float, quantity: float) -> None:
        """The queue is not full."""
        self.orders.append(length, quantity)
        self.queue_known = False

    def skip_order(self) -> None:
        """End the active order, if there is one."""
        if self.orders.waiting > 0:
            self.orders.drop()
            self.queue_known = False

    def clear_orders(self) -> None:
        self.orders.clear()
        self.queue_known = False

    def try_fulfil_order(self, repeat: bool) -> bool:
        """The piece in progress is good: count it for its order, if that still waits; whether it was its last one."""
        if not self.orders.has(self.piece.order):
            return False
        self.queue_known = False
        return self.orders.try_fulfil(self.piece.order, repeat)

    # --- the marks ---

    def forget_marks(self) -> None:
        self.marks.forget()
        self.queue_known = False

    def watch_marks(
        self, block: CutToLengthInterface, settings: Settings, detected: bool, master: float, velocity: float
    ) -> None:
        """Take a mark that the sensor has seen, and miss those that should have come. `fault` tells what is wrong."""
        self.fault = Fault.NONE
        here = master - velocity * settings.mark.delay
        place = here
        if detected and block.mark.latched:
            place = nearest(block.mark.position, block.master.period, master)
        expected = settings.mark.spacing > 0.0 and settings.mark.window > 0.0
        if expected:
            self.miss_marks(block, settings, place if detected else here)
        if detected and self.fault == Fault.NONE:
            if expected and self.is_outside(settings, place):
                block.statistics.marks_outside += 1
                block.warning.mark_outside = True
            else:
                block.statistics.marks += 1
                block.warning.mark_missing = False
                block.warning.mark_outside = False
                self.marks.missing = 0
                self.take_mark(block, settings, place)

    def is_outside(self, settings: Settings, place: float) -> bool:
        """Whether a place lies before the window in which the next mark is expected."""
        least = (settings.mark.spacing - settings.mark.window) / settings.factor
        return self.marks.known and place < self.marks.last + least

    def miss_marks(self, block: CutToLengthInterface, settings: Settings, place: float) -> None:
        """Count the marks that should have come before a place, and put others in their stead."""
        spacing = settings.mark.spacing / settings.factor
        window = settings.mark.window / settings.factor
        while self.fault == Fault.NONE and self.marks.known and place > self.marks.last + spacing + window:
            self.marks.missing += 1
            block.statistics.marks_missing += 1
            block.warning.mark_missing = True
            if self.marks.missing > settings.mark.max_missing:
                self.fault = Fault.MARKS_MISSING
            elif block.mark.substitute:
                self.take_mark(block, settings, self.marks.last + spacing)
            else:
                self.marks.last += spacing

    def take_mark(self, block: CutToLengthInterface, settings: Settings, place: float) -> None:
        """A mark lies at this place of the master."""
        self.marks.known = True
        self.marks.last = place
        if not self.marks.try_take(settings.mark.every):
            return
        if self.marks.is_full():
            self.fault = Fault.MARKS_FULL
            return
        self.marks.append(place + (settings.mark.sensor_distance + settings.mark.cut_offset) / settings.factor)
        self.queue_known = False
        if not self.piece.known:
            merged = self.piece.kind == PieceKind.MERGED
            self.fix(block, settings)
            if merged:
                self.piece.kind = PieceKind.MERGED

    def drop_mark(self) -> None:
        """Leave out the cut of the next mark."""
        self.marks.drop()
        self.queue_known = False

    # --- pitches ---

    def limiting_pitch(self, block: CutToLengthInterface, settings: Settings) -> float:
        """The smaller of the pitch in progress, as it was fixed, and the one that is expected after it."""
        expected = self.expected_pitch(block, settings)
        return min(self.piece.pitch, expected) if block.running else expected

    def expected_pitch(self, block: CutToLengthInterface, settings: Settings) -> float:
        """The pitch of the piece after the one in progress, as far as it is known; UNLIMITED: it is not."""
        if block.source == Source.MARK:
            if self.marks.waiting > 1:
                return limiting(self.marks.place(1) - self.marks.place(0))
            spacing = settings.mark.spacing * float(settings.mark.every)
            return spacing / settings.factor if spacing > 0.0 else UNLIMITED
        return self.pitch_of(self.expected_length(block, settings), block, settings)

    def expected_length(self, block: CutToLengthInterface, settings: Settings) -> float:
        """The length of the piece after the one in progress."""
        if block.waste:
            return settings.waste_length
        if self.sample_waits:
            return settings.sample_length
        counts = block.running and self.piece.kind == PieceKind.PRODUCT
        place = self.orders.place_after(self.piece.order if counts else NO_ORDER, block.order.repeat)
        return block.length if place < 0 else self.orders.length(place)

    def pitch_of(self, length: float, block: CutToLengthInterface, settings: Settings) -> float:
        """The pitch of a piece of that length; UNLIMITED: it is none."""
        material = length + block.length_correction + settings.kerf
        return material / settings.factor if length > 0.0 and material > LEAST_MATERIAL else UNLIMITED

    def shortest_pitch(self, block: CutToLengthInterface, settings: Settings) -> float:
        """The least pitch of all orders that wait, or of all marks; UNLIMITED without any."""
        material = settings.kerf + block.length_correction
        if not self.queue_known or self.queue_material != material or self.queue_factor != settings.factor:
            self.queue_known = True
            self.queue_material = material
            self.queue_factor = settings.factor
            if block.source == Source.MARK:
                self.queue_pitch = self.marks.shortest()
            else:
                shortest = self.orders.shortest()
                self.queue_pitch = self.pitch_of(shortest, block, settings) if shortest < UNLIMITED else UNLIMITED
        return self.queue_pitch

    def shift(self, distance: float) -> None:
        """All places get smaller by a distance, u: whole turns are dropped."""
        self.piece.begin -= distance
        self.piece.end -= distance
        self.last_place -= distance
        self.marks.shift(distance)


def limiting(distance: float) -> float:
    """The pitch of two cuts that marks ask for, u; a cut that lies before the other one is no limit: it is late."""
    return distance if distance > 0.0 else UNLIMITED


def correction_of(block: CutToLengthInterface) -> float:
    """The length correction, u; it does not belong to marks."""
    return block.length_correction if block.source == Source.LENGTH else 0.0
