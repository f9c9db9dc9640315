"""What all machines that cut to length show: enumerations, groups of variables, and the interface that theirs extend.

Lengths of material are in u of true material; positions of the master are as the master counts. A class that is named
...Parameters has nothing but parameters: the settings of a machine (`settings.py`) hold the last valid ones.
"""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..motion.exceeded_limit import Limit
from ..numerics.computable_range import LARGEST, SMALLEST_LIMIT
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import Contradiction, MarkRefusal, NoLength, PieceFault

# What the predictions depend on in all machines, after the initialization as ever after.
PITCH = ("length", "length_correction", "kerf", "source", "waste", "waste_length", "mark.spacing", "mark.every")
REQUEST = ("line.wanted_velocity", "line.margin")


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
class MarkParameters:
    """Where marks are expected, and what becomes of them."""

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
class Mark(MarkParameters):
    """Marks on the material, with the source MARK."""

    detected: bool = var.command(False, "rising edge: a mark was at the sensor ...")
    position: float = var.input(0.0, "... while the master was there, if mark.latched", Unit.POSITION, discrete=True)


@dataclass(slots=True)
class LineParameters:
    """How the line is asked to run."""

    margin: float = var.parameter(
        0.02, "how far below the highest admissible velocity the line is asked to be", tunable=True, min=0.0, below=1.0
    )


@dataclass(slots=True)
class LineRequest(LineParameters):
    """What the machine asks of the line."""

    wanted_velocity: float = var.input(1e9, "what the line would like to run", Unit.VELOCITY, discrete=True)
    velocity_request: float = var.output(
        0.0, "at which the line should run; 0 in FAULT", Unit.VELOCITY, discrete=True, role=Role.MASTER_REQUEST
    )
    stop_request: bool = var.output(False, "the line should stop: a fault is present")


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


@dataclass(slots=True)
class CuttingLimits:
    """What the machine can do."""

    max_line_velocity: float = var.output(
        0.0, "highest for this piece and the next one", Unit.VELOCITY, discrete=True, role=Role.MAX_MASTER_VELOCITY
    )
    min_length: float = var.output(0.0, "shortest piece at the present line velocity; 1e12: none", Unit.POSITION)
    reserve: float = var.output(1.0, "share of the cycle that is left at the present line velocity")
    max_line_velocity_orders: float = var.snapshot(0.0, "highest admissible for all orders or marks", Unit.VELOCITY)
    cycle_time: float = var.local(0.0, "shortest time from cut to cut at the present line velocity", Unit.TIME)
    min_sensor_distance: float = var.local(
        0.0, "MARK: least sum of sensor distance and cut offset at the present line velocity", Unit.POSITION
    )


@dataclass(slots=True)
class CuttingWarnings:
    """What the machine's operator should know."""

    any: bool = var.output(False, "one of the warnings is present", role=Role.WARNING)
    line_too_fast: bool = var.output(False, "the line is faster than limits.max_line_velocity")
    limit_exceeded: bool = var.output(
        False, "the setpoint exceeds a limit or an end position of the axis, or will", role=Role.LIMIT_EXCEEDED
    )
    orders_too_fast: bool = var.local(False, "the line is faster than limits.max_line_velocity_orders")
    velocity: bool = var.local(False, "in sync the slave cannot be as fast as the line")
    mark_missing: bool = var.local(False, "a mark did not come; until the next accepted one")
    mark_outside: bool = var.local(False, "an edge was no mark; until the next accepted one")
    mark_refused: bool = var.local(False, "at a mark no piece could end; until the next accepted one")
    no_length: bool = var.local(False, "no length is given for the next piece, or none that can be cut")
    change_pending: bool = var.local(False, "a new length waits until the piece in progress has ended")
    master_input: bool = var.local(False, "master.input_warning is above 1: the line's position or velocity is wrong")


@dataclass(slots=True)
class CuttingLocal:
    """What a commissioning engineer would watch."""

    marks_waiting: int = var.local(0, "marks in the queue")
    no_length: int = var.local(
        0, "why no length is known for the next piece", codes=var.selected(NoLength, "NOT_GIVEN", "TOO_SHORT")
    )
    mark_refusal: int = var.local(
        0, "why a mark was refused in the last step; 0: none was", codes=MarkRefusal, report=Report.STEPS
    )
    refused_mark: float = var.snapshot(0.0, "master position of the last refused mark", Unit.POSITION)
    refused_parameter: int = var.refused_parameter(0, "which tunable parameter is out of its range", Contradiction)
    skip_reason: int = var.local(0, "why a cut was skipped in the last step; 0: none was", report=Report.STEPS)
    skipped_cut: float = var.snapshot(
        0.0, "master position at which the last skipped cut passes slave position 0", Unit.POSITION
    )
    missing_distance: float = var.snapshot(0.0, "by how much the way to it was too short", Unit.POSITION)
    line_velocity: float = var.snapshot(0.0, "the line's velocity when it was skipped", Unit.VELOCITY)
    exceeded_limit: int = var.local(
        0, "which limit of the axis is exceeded", codes=Limit, report=Report.EPISODES, role=Role.EXCEEDED_LIMIT
    )
    exceeded_value: float = var.snapshot(0.0, "the value that exceeds it, in the limit's unit")


@dataclass(slots=True)
class CycleParameters:
    """What a machine's cycle reads."""

    material_factor: float = var.parameter(
        1.0,
        "true travel of the material per travel of the master",
        tunable=True,
        min=SMALLEST_LIMIT,
        max=LARGEST,
        role=Role.MATERIAL_FACTOR,
    )
    late_mode: LateMode = var.parameter(LateMode.SKIP, "what becomes of a cut that cannot be reached", tunable=True)


@dataclass(slots=True)
class PieceParameters(CycleParameters):
    """What a piece is fixed and recorded with."""

    kerf: float = var.length(0.0, "material that a cut removes, along the material", role=Role.KERF)
    length_tolerance: float = var.length(0.5, "greatest length error of a good piece", role=Role.LENGTH_TOLERANCE)
    change_mode: ChangeMode = var.parameter(ChangeMode.NEXT_PIECE, "to which piece a new length applies", tunable=True)
    sample_length: float = var.length(100.0, "length of a sample", min=SMALLEST_LIMIT)
    waste_length: float = var.length(100.0, "length of a piece of waste", min=SMALLEST_LIMIT)
    batch_size: int = var.parameter(0, "good pieces in a batch (stack); 0: no batches", tunable=True, min=0)


@dataclass(slots=True)
class StartParameters(PieceParameters):
    """What the command start reads."""

    start_mode: StartMode = var.parameter(StartMode.FRONT, "what the first piece is measured from", tunable=True)
    front_position: float = var.position(
        0.0, "how far the material's front end is beyond slave position 0 at the edge of start"
    )
    trim_length: float = var.length(0.0, "TRIM: at least so much is cropped")


@dataclass(slots=True)
class CuttingInterface(StartParameters):
    """The variables of all machines that cut to length; each machine declares some anew, to say more of them.

    What a machine has in addition to `limits`, `warning` and `local` is in groups of its own that extend those here."""

    master: Master = var.part(Master)
    start: bool = var.command(False, "rising edge: start to cut")
    stop: bool = var.command(False, "rising edge: finish the cut under way, then rest")
    abort: bool = var.command(False, "rising edge: leave the material at once, then rest")
    reset: bool = var.command(False, "rising edge: clear the fault, once the machine rests")
    hold: bool = var.input(False, "no way to a cut begins while it is true")
    length: float = var.input(1000.0, "length of a piece without an order; <= 0: none", Unit.POSITION, discrete=True)
    length_correction: float = var.input(
        0.0, "added to each measured length (tape error)", Unit.POSITION, discrete=True, role=Role.LENGTH_CORRECTION
    )
    cut_now: bool = var.command(False, "rising edge: cut as soon as possible")
    take_sample: bool = var.command(False, "rising edge: one sample after the next cut")
    waste: bool = var.input(False, "pieces that start while it is true are waste of waste_length")
    order: Order = var.part(Order)
    mark: Mark = var.part(Mark)
    line: LineRequest = var.part(LineRequest)
    slave: Slave = var.part(Slave)
    state_code: int = var.output(0, "the state as a plain integer")
    error: bool = var.output(False, "a command was refused, or the machine has stopped for a fault")
    error_id: int = var.output(0, "why: 1 to 6 for a command, from 16 on for a fault", codes=PieceFault)
    running: bool = var.output(False, "from start to the rest after stop or abort, or to a fault", role=Role.RUNNING)
    in_sync: bool = var.output(False, "the slave is in sync with the material")
    next_cut: NextCut = var.part(NextCut)
    piece: Piece = var.part(Piece)
    last: LastPiece = var.part(LastPiece)
    statistics: Statistics = var.part(Statistics)
    auto_start: bool = var.parameter(False, "the first step brings an edge of start")
    source: Source = var.parameter(Source.LENGTH, "what decides where the cuts are")
    calibration: Calibration = var.part(Calibration)
    clear_statistics: bool = var.switch(False, "rising edge: start the statistics anew")
    batch_count: int = var.local(0, "good pieces in the present batch")
    batches: int = var.local(0, "full batches")
    batch_done: bool = var.local(False, "a batch is full, until the next cut ends")
    clock: float = var.local(0.0, "the block's time: 0 at initialization", Unit.TIME)
