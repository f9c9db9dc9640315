"""What all machines that cut to length show: enumerations, and groups of variables.

Lengths of material are in u of true material; positions of the master are as the master counts.
"""

from dataclasses import dataclass

from .. import var
from ..var import Enumeration, Role, Unit


class Source(Enumeration):
    """What decides where the cuts are"""

    LENGTH = 1, "lengths: of the orders, or the input length"
    MARK = 2, "marks on the material, which a sensor sees"


class StartMode(Enumeration):
    """What the first piece after start is measured from"""

    FRONT = 1, "the material's front end"
    TRIM = 2, "the front end; a piece of trim_length is cropped first"
    CONTINUE = 3, "the last cut"


class ChangeMode(Enumeration):
    """To which piece a new length applies"""

    NEXT_PIECE = 1, "the one that starts with the next cut"
    THIS_PIECE = 2, "the one in progress, if its cut can still be reached"


class LateMode(Enumeration):
    """What becomes of a cut that cannot be reached"""

    SKIP = 1, "it is left out: the piece ends with one of the next cuts"
    LATE = 2, "it is made as soon as possible: the piece is longer"
    STOP_LINE = 3, "a fault, which asks the line to stop"


class PieceKind(Enumeration):
    """What a piece of material is"""

    NONE = 0, "there is none"
    PRODUCT = 1, "a piece that was ordered"
    SAMPLE = 2, "a sample"
    WASTE = 3, "waste"
    TRIM = 4, "what is cropped from the front end"
    SHORT = 5, "a piece that cut_now ended"
    MERGED = 6, "a piece in which a cut was left out"


@dataclass(slots=True)
class Order:
    """The queue of orders; without one, the input length counts."""

    add: bool = var.command(False, "rising edge: append an order")
    length: float = var.input(0.0, "length of the order's pieces, above 0", Unit.POSITION, discrete=True)
    quantity: int = var.input(1, "how many good pieces are ordered, at least 1")
    waiting: int = var.output(0, "orders in the queue, the active one included", role=Role.ORDERS)
    remaining: int = var.output(0, "good pieces that the active order still lacks")
    skip: bool = var.switch(False, "rising edge: end the active order")
    clear: bool = var.switch(False, "rising edge: forget all orders")
    repeat: bool = var.switch(False, "a finished order is appended anew")
    length_active: float = var.snapshot(0.0, "length of the active order's pieces; 0 without one", Unit.POSITION)
    completed: int = var.local(0, "orders that were fulfilled, not skipped")


@dataclass(slots=True)
class Mark:
    """Marks on the material, with the source MARK."""

    detected: bool = var.command(False, "rising edge: a mark was at the sensor ...")
    position: float = var.input(0.0, "... while the master was there, if mark.latched", Unit.POSITION, discrete=True)
    sensor_distance: float = var.position(1000.0, "from the sensor to slave position 0, upstream positive")
    cut_offset: float = var.position(0.0, "the cut is so much behind the mark")
    spacing: float = var.length(0.0, "expected distance of the marks; 0: each edge is a mark")
    window: float = var.length(0.0, "how far off a mark may be, less than half of the spacing; 0: each edge is a mark")
    every: int = var.parameter(1, "each n-th mark is cut", tunable=True, min=1)
    max_missing: int = var.parameter(3, "so many marks may be missing in a row", tunable=True, min=0)
    substitute: bool = var.switch(True, "a missing mark is replaced by its expected position")
    latched: bool = var.parameter(True, "mark.position is wired (touch probe)")
    delay: float = var.duration(0.0, "how late the edge comes, at most")


@dataclass(slots=True)
class LineRequest:
    """What the machine asks of the line."""

    wanted_velocity: float = var.input(1e9, "what the line would like to run", Unit.VELOCITY, discrete=True)
    velocity_request: float = var.output(
        0.0, "at which the line should run; 0 in FAULT", Unit.VELOCITY, discrete=True, role=Role.MASTER_REQUEST
    )
    stop_request: bool = var.output(False, "the line should stop: a fault is present")
    margin: float = var.parameter(
        0.02, "how far below the highest admissible velocity the line is asked to be", tunable=True, min=0.0, below=1.0
    )


@dataclass(slots=True)
class NextCut:
    """The cut that comes next."""

    distance: float = var.output(
        0.0, "master travel missing until sync, 0 from then until the cut ends; negative: too late", Unit.POSITION
    )
    position: float = var.snapshot(0.0, "master position at which the cut passes slave position 0", Unit.POSITION)
    known: bool = var.local(False, "its position is known")


@dataclass(slots=True)
class Piece:
    """The piece in progress."""

    length: float = var.output(0.0, "what it would measure if it were cut where the tool is", Unit.POSITION)
    ordered: float = var.snapshot(0.0, "what it is to become", Unit.POSITION)
    kind: PieceKind = var.local(PieceKind.NONE, "what it is")


@dataclass(slots=True)
class LastPiece:
    """The piece that the last cut ended."""

    length: float = var.output(0.0, "its length", Unit.POSITION, discrete=True, role=Role.LAST_LENGTH)
    error: float = var.output(0.0, "its length less the ordered one", Unit.POSITION, discrete=True)
    good: bool = var.output(False, "it is a product within length_tolerance")
    kind: PieceKind = var.local(PieceKind.NONE, "what it was")
    time: float = var.snapshot(0.0, "the block's time when its cut came in sync", Unit.TIME)
    reserve: float = var.snapshot(0.0, "share of its cycle that was left; late 0, after start 1")


@dataclass(slots=True)
class Statistics:
    """What the machine has made."""

    cuts: int = var.output(0, "cuts", role=Role.PIECES)
    pieces_good: int = var.output(0, "good products")
    skipped: int = var.output(0, "cuts left out because they could not be reached")
    pieces_bad: int = var.local(0, "products out of tolerance, short and merged pieces")
    pieces_sample: int = var.local(0, "samples")
    pieces_waste: int = var.local(0, "pieces of waste, trimmed ones included")
    late: int = var.local(0, "cuts made later than where they were due")
    marks: int = var.local(0, "marks seen and accepted")
    marks_missing: int = var.local(0, "marks that did not come")
    marks_outside: int = var.local(0, "edges that were no marks")
    marks_refused: int = var.local(0, "marks at which no piece could end")
    unsynchronised: int = var.local(0, "times that the tool was in the material and not in sync with it")
    length_good: float = var.snapshot(0.0, "length of the good pieces", Unit.POSITION)
    length_waste: float = var.snapshot(0.0, "length of waste, bad pieces and samples apart", Unit.POSITION)
    error_worst: float = var.snapshot(0.0, "greatest length error of a product", Unit.POSITION)
    error_mean: float = var.snapshot(0.0, "mean length error of the products", Unit.POSITION)
    error_deviation: float = var.snapshot(0.0, "standard deviation of the products' length errors", Unit.POSITION)
    reserve_worst: float = var.snapshot(1.0, "least last.reserve")


@dataclass(slots=True)
class Calibration:
    """The material's travel is determined from a piece that was measured."""

    execute: bool = var.switch(False, "rising edge: the last piece measured so long")
    measured_length: float = var.position(0.0, "measured length of the last piece")
    reset: bool = var.switch(False, "rising edge: forget the factor")
    factor: float = var.snapshot(1.0, "further factor of the material's travel", role=Role.CALIBRATION_FACTOR)
