"""All variables of the CutToLength in the order in which the FMU shows them, and the enumerations that it shows.

What is wired comes first: the master, the commands, the slave and the block's status. Then come what is set once for a
machine and what is watched. Lengths of material are in u of true material; positions of the master are as the master
counts. The README says why the one signal is wired and the other is watched.
"""

from dataclasses import dataclass

from .. import var
from ..axis_limits import AxisLimits
from ..exceeded import Limit
from ..limits import LEAST_LIMIT, MOST
from ..master import Master
from ..slave import Slave
from ..var import Enumeration, Role, Unit
from .faults import Fault
from .tunables import Tunable


class State(Enumeration):
    """What the machine does"""

    FAULT = -1, "a fault is present; the carriage comes home under it"
    OFF = 0, "at rest, not running"
    HOMING = 1, "to home after start"
    WAITING = 2, "at home, for the start point"
    APPROACHING = 3, "towards the synchronous motion"
    SYNCHRONOUS = 4, "in sync, settling"
    CUTTING = 5, "the cut"
    PULLING = 6, "opening the gap"
    CLEARING = 7, "the blade leaves the material"
    RETURNING = 8, "on the way home"


class Source(Enumeration):
    """What decides where the cuts lie"""

    LENGTH = 1, "lengths: of the orders, or the input length"
    MARK = 2, "marks on the material, which a sensor sees"


class StartMode(Enumeration):
    """What the first piece after start is measured from"""

    FRONT = 1, "the material's front end"
    TRIM = 2, "the front end; a piece of trim_length is cropped first"
    CONTINUE = 3, "the last cut"


class ChangeMode(Enumeration):
    """To which piece a new length applies"""

    NEXT_PIECE = 1, "the one that begins with the next cut"
    THIS_PIECE = 2, "the one in progress, if its cut can still be reached"


class LateMode(Enumeration):
    """What becomes of a cut that cannot be reached"""

    SKIP = 1, "it is left out: the piece ends with one of the next cuts"
    LATE = 2, "it is made as soon as possible: the piece is longer"
    STOP_LINE = 3, "a fault, which asks the line to stop"


class ToolMode(Enumeration):
    """What ends the cut"""

    TIME = 1, "the time tool.cut_time"
    DISTANCE = 2, "the carriage's travel tool.cut_distance"
    FEEDBACK = 3, "a rising edge of tool.done"


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
    waiting: int = var.output(0, "orders in the queue, the active one included")
    remaining: int = var.output(0, "good pieces that the active order still lacks")
    skip: bool = var.parameter(False, "rising edge: end the active order", tunable=True)
    clear: bool = var.parameter(False, "rising edge: forget all orders", tunable=True)
    repeat: bool = var.parameter(False, "a finished order is appended anew", tunable=True)
    length_active: float = var.local(
        0.0, "length of the active order's pieces; 0 without one", Unit.POSITION, discrete=True
    )
    completed: int = var.local(0, "orders that were fulfilled, not skipped")


@dataclass(slots=True)
class Mark:
    """Marks on the material, with the source MARK."""

    detected: bool = var.command(False, "rising edge: a mark was at the sensor ...")
    position: float = var.input(0.0, "... while the master was there, if mark.latched", Unit.POSITION, discrete=True)
    sensor_distance: float = var.parameter(
        1000.0,
        "from the sensor to carriage position 0, upstream positive",
        Unit.POSITION,
        tunable=True,
        min=-MOST,
        max=MOST,
    )
    cut_offset: float = var.parameter(
        0.0, "the cut lies so much behind the mark", Unit.POSITION, tunable=True, min=-MOST, max=MOST
    )
    spacing: float = var.parameter(
        0.0, "expected distance of the marks; 0: each edge is a mark", Unit.POSITION, tunable=True, min=0.0, max=MOST
    )
    window: float = var.parameter(
        0.0,
        "how far off a mark may be, less than half of the spacing; 0: each edge is a mark",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
    )
    every: int = var.parameter(1, "each n-th mark is cut", tunable=True, min=1)
    max_missing: int = var.parameter(3, "so many marks may be missing in a row", tunable=True, min=0)
    substitute: bool = var.parameter(
        True, "a missing mark is replaced by the place where it was expected", tunable=True
    )
    latched: bool = var.parameter(True, "mark.position is wired (touch probe)")
    delay: float = var.parameter(0.0, "how late the edge comes, at most", Unit.TIME, tunable=True, min=0.0, max=1e6)


@dataclass(slots=True)
class Tool:
    """The blade: what ends its cut, and how long it needs."""

    done: bool = var.command(False, "FEEDBACK: rising edge, the cut is through")
    command: bool = var.output(False, "the valve: the blade shall be in the material")
    command_time: float = var.output(
        0.0, "the block's time at the last change of tool.command, which lies inside the step", Unit.TIME, discrete=True
    )
    mode: ToolMode = var.parameter(ToolMode.TIME, "what ends the cut")
    settle_time: float = var.parameter(
        0.0, "in sync before the blade may touch (clamping)", Unit.TIME, tunable=True, min=0.0, max=1e6
    )
    on_delay: float = var.parameter(
        0.0,
        "from tool.command until the blade touches: it is commanded so much earlier",
        Unit.TIME,
        tunable=True,
        min=0.0,
        max=1e6,
    )
    cut_time: float = var.parameter(
        0.25, "TIME: the cut; FEEDBACK: what is expected of it", Unit.TIME, tunable=True, min=0.0, max=1e6
    )
    cut_distance: float = var.parameter(
        100.0, "DISTANCE: the carriage's travel during the cut", Unit.POSITION, tunable=True, min=0.0, max=MOST
    )
    retract_time: float = var.parameter(
        0.0, "from the end of the cut until the blade is clear", Unit.TIME, tunable=True, min=0.0, max=1e6
    )
    timeout: float = var.parameter(0.0, "FEEDBACK: the longest cut; 0: any", Unit.TIME, tunable=True, min=0.0, max=1e6)
    blade_down: bool = var.local(False, "the blade is in the material, as modelled: from command + delay until clear")
    cutting: bool = var.local(False, "the machine is cutting", role=Role.CUTTING)


@dataclass(slots=True)
class LineRequest:
    """What the machine asks of the line."""

    wanted_velocity: float = var.input(1e9, "what the line would like to run", Unit.VELOCITY, discrete=True)
    velocity_request: float = var.output(
        0.0,
        "the velocity at which the line should run; 0 in FAULT",
        Unit.VELOCITY,
        discrete=True,
        role=Role.MASTER_REQUEST,
    )
    stop_request: bool = var.output(False, "the line should stop: a fault is present")
    margin: float = var.parameter(
        0.02,
        "how far below the highest admissible velocity the line is asked to stay",
        tunable=True,
        min=0.0,
        below=1.0,
    )


@dataclass(slots=True)
class NextCut:
    """The cut that comes next."""

    distance: float = var.output(
        0.0,
        "master travel missing until sync, 0 from then until the cut ends; negative: too late",
        Unit.POSITION,
    )
    position: float = var.local(
        0.0, "master position at which the cut's line passes carriage position 0", Unit.POSITION, discrete=True
    )
    known: bool = var.local(False, "its place is known")


@dataclass(slots=True)
class Piece:
    """The piece in progress."""

    length: float = var.output(0.0, "what it would measure if it were cut where the blade is", Unit.POSITION)
    ordered: float = var.local(0.0, "what it is to become", Unit.POSITION, discrete=True)
    kind: PieceKind = var.local(PieceKind.NONE, "what it is")


@dataclass(slots=True)
class Last:
    """The piece that the last cut ended."""

    length: float = var.output(0.0, "its length", Unit.POSITION, discrete=True, role=Role.LAST_LENGTH)
    error: float = var.output(0.0, "its length less the ordered one", Unit.POSITION, discrete=True)
    good: bool = var.output(False, "it is a product within length_tolerance")
    kind: PieceKind = var.local(PieceKind.NONE, "what it was")
    time: float = var.local(0.0, "the block's time when its cut came in sync", Unit.TIME, discrete=True)
    reserve: float = var.local(0.0, "share of its cycle spent ready at home; late 0, after start 1", discrete=True)


@dataclass(slots=True)
class Limits:
    """What the machine can do."""

    max_line_velocity: float = var.output(
        0.0,
        "highest admissible for the piece in progress and the next one",
        Unit.VELOCITY,
        discrete=True,
        role=Role.MAX_MASTER_VELOCITY,
    )
    min_length: float = var.output(0.0, "shortest piece at the present line velocity", Unit.POSITION)
    reserve: float = var.output(1.0, "share of the cycle that is left at the present line velocity")
    max_line_velocity_orders: float = var.local(
        0.0, "highest admissible for all that waits: orders, marks", Unit.VELOCITY, discrete=True
    )
    cycle_time: float = var.local(0.0, "shortest time from cut to cut at the present line velocity", Unit.TIME)
    stroke: float = var.local(0.0, "way from home that a cycle takes at the present line velocity", Unit.POSITION)
    min_sensor_distance: float = var.local(
        0.0, "MARK: least sum of sensor distance and cut offset at the present line velocity", Unit.POSITION
    )


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
    unsynchronised: int = var.local(0, "times that the blade was in the material and the carriage not in sync")
    length_good: float = var.local(0.0, "length of the good pieces", Unit.POSITION, discrete=True)
    length_waste: float = var.local(0.0, "length of waste, bad pieces and samples apart", Unit.POSITION, discrete=True)
    error_worst: float = var.local(0.0, "greatest length error of a product", Unit.POSITION, discrete=True)
    error_mean: float = var.local(0.0, "mean length error of the products", Unit.POSITION, discrete=True)
    error_deviation: float = var.local(
        0.0, "standard deviation of the products' length errors", Unit.POSITION, discrete=True
    )
    reserve_worst: float = var.local(1.0, "least last.reserve", discrete=True)


@dataclass(slots=True)
class Warning:
    """What the machine's operator should know."""

    any: bool = var.output(False, "one of the warnings stands")
    line_too_fast: bool = var.output(False, "the line is faster than limits.max_line_velocity")
    limit_exceeded: bool = var.output(
        False, "the setpoint exceeds a limit of the axis or an end position, as on a line that accelerates"
    )
    orders_too_fast: bool = var.local(False, "the line is faster than limits.max_line_velocity_orders")
    stroke: bool = var.local(False, "a cycle at the present line velocity would not fit into the stroke")
    velocity: bool = var.local(False, "the carriage cannot be as fast as the line")
    blade_early: bool = var.local(False, "the blade touched before the carriage was in sync; until the next cut")
    gap_skipped: bool = var.local(False, "the gap was not opened, for the axis's limits; until the next cut")
    mark_missing: bool = var.local(False, "a mark did not come; until the next accepted one")
    mark_outside: bool = var.local(False, "an edge was no mark; until the next accepted one")
    no_length: bool = var.local(False, "no length is given for the next piece")
    change_pending: bool = var.local(False, "a new length waits until the piece in progress has ended")


@dataclass(slots=True)
class Calibration:
    """The material's travel is found from a piece that was measured."""

    execute: bool = var.parameter(False, "rising edge: the last piece measured so long", tunable=True)
    measured_length: float = var.parameter(
        0.0, "measured length of the last piece", Unit.POSITION, tunable=True, min=-MOST, max=MOST
    )
    reset: bool = var.parameter(False, "rising edge: forget the factor", tunable=True)
    factor: float = var.local(
        1.0, "further factor of the material's travel", discrete=True, role=Role.CALIBRATION_FACTOR
    )


@dataclass(slots=True)
class Approach:
    """The way from home to the synchronous motion."""

    distance: float = var.parameter(
        0.0,
        "least way from home to the sync position; 0: as short as the limits allow",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
    )
    reserve: float = var.parameter(
        0.02, "the approach is laid out for a line faster by this share", tunable=True, min=0.0, max=1e6
    )
    acceleration: float = var.limit(0.0, "acceleration limit; 0: the axis's", Unit.ACCELERATION)
    jerk: float = var.limit(0.0, "jerk limit; 0: the axis's", Unit.JERK)


@dataclass(slots=True)
class Homing:
    """The way home."""

    velocity: float = var.limit(0.0, "velocity limit; 0: the axis's", Unit.VELOCITY)
    acceleration: float = var.limit(0.0, "acceleration limit; 0: the axis's", Unit.ACCELERATION)
    deceleration: float = var.limit(0.0, "deceleration limit; 0: the axis's", Unit.ACCELERATION)
    jerk: float = var.limit(0.0, "jerk limit; 0: the axis's", Unit.JERK)
    settle_time: float = var.parameter(
        0.0, "rest at home before the next start", Unit.TIME, tunable=True, min=0.0, max=1e6
    )
    ease: bool = var.parameter(False, "come home just in time", tunable=True)
    spare_time: float = var.parameter(
        0.02, "come home so much before the next start", Unit.TIME, tunable=True, min=0.0, max=1e6
    )
    slowest: float = var.parameter(
        0.05, "the eased way home is no slower than this share", tunable=True, above=0.0, max=1.0
    )


@dataclass(slots=True)
class Gap:
    """After the cut the carriage pulls ahead of the material."""

    distance: float = var.parameter(0.0, "by so much; 0: not at all", Unit.POSITION, tunable=True, min=0.0, max=MOST)
    travel: float = var.parameter(
        100.0, "while it travels so far", Unit.POSITION, tunable=True, min=LEAST_LIMIT, max=MOST
    )


@dataclass(slots=True)
class SawAxis(AxisLimits):
    """The carriage's axis."""

    max_deceleration: float = var.limit(
        10000.0,
        "deceleration limit; 0: as the acceleration limit",
        Unit.ACCELERATION,
        role=Role.MAX_DECELERATION,
    )


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    start_position: float = var.local(
        0.0, "master position of the next start at the present line velocity", Unit.POSITION
    )
    approach_distance: float = var.local(
        0.0, "way from home to the sync position at the present line velocity", Unit.POSITION
    )
    coupling_factor: float = var.local(
        1.0, "carriage velocity per line velocity in sync", discrete=True, role=Role.COUPLING_FACTOR
    )
    progress: float = var.local(0.0, "share of the approach that is done", min=0.0, max=1.0)
    ease: float = var.local(1.0, "share of the limits that the way home uses", discrete=True)
    marks_waiting: int = var.local(0, "marks in the queue")
    start_time: float = var.local(0.0, "the block's time at the last start of an approach", Unit.TIME, discrete=True)
    home_time: float = var.local(0.0, "the block's time at the last arrival at home", Unit.TIME, discrete=True)
    refused_parameter: int = var.local(0, "which tunable parameter is out of its range", codes=Tunable)
    exceeded_limit: int = var.local(0, "which limit of the axis is exceeded", codes=Limit)
    exceeded_value: float = var.local(0.0, "the value that exceeds it, in the limit's unit", discrete=True)


@dataclass(slots=True)
class CutToLengthInterface:
    """All variables of the block, in the order in which the FMU lists them."""

    master: Master = var.part(Master)
    start: bool = var.command(False, "rising edge: begin to cut")
    stop: bool = var.command(False, "rising edge: finish the cut under way, then rest at home")
    abort: bool = var.command(False, "rising edge: leave the material at once, then rest at home")
    reset: bool = var.command(False, "rising edge: clear the fault, once the carriage rests at home")
    hold: bool = var.input(False, "no approach begins while it is true")
    length: float = var.input(
        1000.0, "length of a piece while no order waits; at most 0: none", Unit.POSITION, discrete=True
    )
    length_correction: float = var.input(
        0.0,
        "is added to every piece's measured length (stretch, tape error)",
        Unit.POSITION,
        discrete=True,
        role=Role.LENGTH_CORRECTION,
    )
    cut_now: bool = var.command(False, "rising edge: cut as soon as possible")
    take_sample: bool = var.command(False, "rising edge: one sample after the next cut")
    waste: bool = var.input(False, "pieces that begin while it is true are waste of waste_length")
    order: Order = var.part(Order)
    mark: Mark = var.part(Mark)
    tool: Tool = var.part(Tool)
    line: LineRequest = var.part(LineRequest)
    slave: Slave = var.part(Slave, depends={"position": ("axis.initial_position",)})
    state: State = var.output(State.OFF, "what the machine does")
    state_code: int = var.output(0, "the state as a plain integer")
    error: bool = var.output(False, "a command was refused, or the machine has stopped for a fault")
    error_id: int = var.output(
        0,
        "why: 1 start, 2 order, 3 orders full, 4 calibration, 5 tuned parameter, 6 cut_now; 16 cut missed, 17 stroke, "
        "18 marks missing, 19 tool timeout, 20 marks full",
        codes=Fault,
    )
    running: bool = var.output(False, "from start to the arrival after stop or abort, or to a fault", role=Role.RUNNING)
    in_sync: bool = var.output(False, "the carriage is on the line of its cut")
    next_cut: NextCut = var.part(NextCut)
    piece: Piece = var.part(Piece)
    last: Last = var.part(Last)
    limits: Limits = var.part(Limits)
    statistics: Statistics = var.part(Statistics)
    warning: Warning = var.part(Warning)
    axis: SawAxis = var.part(SawAxis)
    auto_start: bool = var.parameter(False, "the first step brings an edge of start")
    home_position: float = var.parameter(
        0.0, "where the carriage waits", Unit.POSITION, tunable=True, min=-MOST, max=MOST
    )
    diagonal_angle: float = var.parameter(
        0.0, "angle between the carriage's and the material's travel", Unit.ANGLE, above=-90.0, below=90.0
    )
    material_factor: float = var.parameter(
        1.0,
        "true travel of the material per travel of the master",
        tunable=True,
        min=LEAST_LIMIT,
        max=MOST,
        role=Role.MATERIAL_FACTOR,
    )
    kerf: float = var.parameter(
        0.0,
        "material that a cut removes, along the material",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        role=Role.KERF,
    )
    length_tolerance: float = var.parameter(
        0.5,
        "a piece is good if its length is off by no more",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        role=Role.LENGTH_TOLERANCE,
    )
    source: Source = var.parameter(Source.LENGTH, "what decides where the cuts lie")
    start_mode: StartMode = var.parameter(StartMode.FRONT, "what the first piece is measured from", tunable=True)
    front_position: float = var.parameter(
        0.0,
        "where the material's front end is at the edge of start, as a position of the carriage",
        Unit.POSITION,
        tunable=True,
        min=-MOST,
        max=MOST,
    )
    trim_length: float = var.parameter(
        0.0, "TRIM: at least so much is cropped", Unit.POSITION, tunable=True, min=0.0, max=MOST
    )
    change_mode: ChangeMode = var.parameter(ChangeMode.NEXT_PIECE, "to which piece a new length applies", tunable=True)
    late_mode: LateMode = var.parameter(LateMode.SKIP, "what becomes of a cut that cannot be reached", tunable=True)
    sample_length: float = var.parameter(
        100.0, "length of a sample", Unit.POSITION, tunable=True, min=LEAST_LIMIT, max=MOST
    )
    waste_length: float = var.parameter(
        100.0, "length of a piece of waste", Unit.POSITION, tunable=True, min=LEAST_LIMIT, max=MOST
    )
    batch_size: int = var.parameter(0, "good pieces in a batch (stack); 0: no batches", tunable=True, min=0)
    approach: Approach = var.part(Approach)
    homing: Homing = var.part(Homing)
    gap: Gap = var.part(Gap)
    calibration: Calibration = var.part(Calibration)
    clear_statistics: bool = var.parameter(False, "rising edge: begin the statistics anew", tunable=True)
    batch_count: int = var.local(0, "good pieces in the present batch")
    batches: int = var.local(0, "full batches")
    batch_done: bool = var.local(False, "a batch is full, until the next cut ends")
    clock: float = var.local(0.0, "the block's time: 0 at initialization", Unit.TIME)
    local: Local = var.part(Local)
