"""All variables of the RotaryKnife in the order in which the FMU shows them, and the enumerations of its own.

What is wired comes first: the master, the commands, the slave and the block's status. Then come what is set once for a
machine and what is watched. Lengths of material are in u of true material; positions of the master are as the master
counts; the knife turns in the slave's own unit.
"""

from dataclasses import dataclass

from .. import var
from ..cutting.faults import MarkRefusal, NoLength, PieceFault
from ..cutting.interface import (
    Calibration,
    ChangeMode,
    LastPiece,
    LateMode,
    LineRequest,
    Mark,
    NextCut,
    Order,
    Piece,
    Source,
    StartMode,
    Statistics,
)
from ..cutting.settings import PieceParameter
from ..master import VELOCITY_SOURCES, Master
from ..motion.exceeded_limit import Limit
from ..numerics.computable_range import LARGEST, SMALLEST_LIMIT
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import KnifeLimit, KnifeParameter, SkipReason

MOST_BLADES = 64
LEAST_OVERSPEED = -0.2
GREATEST_OVERSPEED = 0.5

# What the predictions depend on, after the initialization as ever after.
COUPLING = ("material_factor", "knife.turn", "knife.circumference")
WINDOW = ("knife.blades", "sync.before", "sync.after", "sync.mode", "sync.overspeed")
RAMP_UP = ("knife.blades", "knife.park_angle", "sync.before", "sync.mode", "sync.overspeed")
AXIS = ("axis.max_velocity", "axis.max_acceleration", "axis.max_jerk")
PITCH = ("length", "length_correction", "kerf", "source", "waste", "waste_length", "mark.spacing", "mark.every")
ALLOWANCE = ("length_correction", "kerf", "source")
REQUEST = ("line.wanted_velocity", "line.margin")


class State(Enumeration):
    """What the machine does"""

    FAULT = -1, "a fault is present; the knife parks under it"
    OFF = 0, "at park, not running"
    PARKING = 1, "to park, by a motion of its own"
    WAITING = 2, "at park, for the ramp up to the next cut"
    ENGAGING = 3, "ramp up, into sync"
    SYNCHRONOUS = 4, "in sync, in the window of a cut"
    TURNING = 5, "between the windows of two cuts"
    DISENGAGING = 6, "ramp down, to park"


class SyncMode(Enumeration):
    """What is in sync with the material in the window of a cut"""

    TANGENTIAL = 1, "the edge's speed along its circle"
    HORIZONTAL = 2, "the edge's speed along the material"


@dataclass(slots=True)
class Cylinder:
    """The cylinder with its blades."""

    in_window: bool = var.output(False, "a blade is in the window of a cut", role=Role.CUTTING)
    turn: float = var.parameter(
        360.0,
        "the slave's position per turn of the cylinder, not 0",
        Unit.SLAVE_POSITION,
        min=0.0,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
    )
    circumference: float = var.parameter(
        600.0,
        "of the circle on which the blades' edges run, not 0",
        Unit.POSITION,
        min=0.0,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
    )
    blades: int = var.parameter(1, "evenly spaced; one cuts at 0", min=1, max=MOST_BLADES)
    park_angle: float = var.parameter(
        0.0,
        "where the blade that has cut last rests, between the windows of two blades; 0: half way between them",
        Unit.SLAVE_POSITION,
        min=0.0,
        max=LARGEST,
    )


@dataclass(slots=True)
class Sync:
    """The window around each cut, in which the edge is in sync with the material."""

    before: float = var.length(20.0, "material in the window before the cut")
    after: float = var.length(20.0, "material in the window after the cut")
    mode: SyncMode = var.parameter(SyncMode.TANGENTIAL, "what is in sync with the material")
    overspeed: float = var.parameter(
        0.0,
        "TANGENTIAL: the edge is faster than the material by this share",
        tunable=True,
        min=LEAST_OVERSPEED,
        max=GREATEST_OVERSPEED,
    )


@dataclass(slots=True)
class KnifeAxis:
    """The limits of the axis that turns the cylinder."""

    max_velocity: float = var.parameter(
        3600.0,
        "velocity limit, not 0",
        Unit.VELOCITY,
        min=0.0,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
        role=Role.MAX_VELOCITY,
    )
    max_acceleration: float = var.parameter(
        72000.0,
        "acceleration limit, not 0",
        Unit.ACCELERATION,
        min=0.0,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
        role=Role.MAX_ACCELERATION,
    )
    max_jerk: float = var.parameter(
        1e6,
        "jerk limit, not 0",
        Unit.JERK,
        min=0.0,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
        role=Role.MAX_JERK,
    )


@dataclass(slots=True)
class MachineLimits:
    """What the machine can do."""

    max_line_velocity: float = var.output(
        0.0, "highest for this piece and the next one", Unit.VELOCITY, discrete=True, role=Role.MAX_MASTER_VELOCITY
    )
    min_length: float = var.output(0.0, "shortest piece at the present line velocity; 1e12: none", Unit.POSITION)
    reserve: float = var.output(1.0, "share of the cycle that is left at the present line velocity")
    max_line_velocity_orders: float = var.snapshot(0.0, "highest admissible for all orders or marks", Unit.VELOCITY)
    max_length: float = var.snapshot(0.0, "longest piece on which the knife does not come to rest", Unit.POSITION)
    cycle_time: float = var.local(0.0, "shortest time from cut to cut at the present line velocity", Unit.TIME)
    min_sensor_distance: float = var.local(
        0.0, "MARK: least sum of sensor distance and cut offset at the present line velocity", Unit.POSITION
    )


@dataclass(slots=True)
class Peaks:
    """The greatest magnitudes of the present cycle at the present line velocity."""

    velocity: float = var.local(0.0, "greatest speed of the knife", Unit.VELOCITY, role=Role.PEAK_VELOCITY)
    acceleration: float = var.local(
        0.0, "greatest acceleration of the knife", Unit.ACCELERATION, role=Role.PEAK_ACCELERATION
    )
    jerk: float = var.local(0.0, "greatest jerk of the knife", Unit.JERK, role=Role.PEAK_JERK)


@dataclass(slots=True)
class Warnings:
    """What the machine's operator should know."""

    any: bool = var.output(False, "one of the warnings is present", role=Role.WARNING)
    line_too_fast: bool = var.output(False, "the line is faster than limits.max_line_velocity")
    limit_exceeded: bool = var.output(
        False, "the setpoint exceeds a limit of the axis, or the ramp down will", role=Role.LIMIT_EXCEEDED
    )
    orders_too_fast: bool = var.local(False, "the line is faster than limits.max_line_velocity_orders")
    velocity: bool = var.local(False, "in the window the knife cannot be as fast as the line")
    mark_missing: bool = var.local(False, "a mark did not come; until the next accepted one")
    mark_outside: bool = var.local(False, "an edge was no mark; until the next accepted one")
    mark_refused: bool = var.local(False, "at a mark no piece could end; until the next accepted one")
    no_length: bool = var.local(False, "no length is given for the next piece, or none that can be cut")
    change_pending: bool = var.local(False, "a new length, or a cut_now, waits until the piece in progress has ended")
    master_input: bool = var.local(False, "master.input_warning is above 1: the line's position or velocity is wrong")


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    coupling_factor: float = var.snapshot(
        1.0, "the knife's travel per travel of the master in sync", Unit.SLAVE_PER_MASTER, role=Role.COUPLING_FACTOR
    )
    blade_spacing: float = var.snapshot(
        360.0, "the knife's travel from one blade to the next", Unit.SLAVE_POSITION, role=Role.CUT_SPACING
    )
    edge_radius: float = var.snapshot(
        0.0, "HORIZONTAL: the knife's travel per rad; else 0", Unit.SLAVE_POSITION, role=Role.EDGE_RADIUS
    )
    marks_waiting: int = var.local(0, "marks in the queue")
    no_length: int = var.local(0, "why no length is known for the next piece", codes=NoLength)
    mark_refusal: int = var.local(
        0, "why a mark was refused in the last step; 0: none was", codes=MarkRefusal, report=Report.STEPS
    )
    refused_mark: float = var.snapshot(0.0, "master position of the last refused mark", Unit.POSITION)
    refused_parameter: int = var.local(
        0, "which tunable parameter is out of its range", codes=var.merged(KnifeParameter, PieceParameter)
    )
    allowed_from: float = var.local(0.0, "the least value that a machine setting may have which is refused")
    allowed_to: float = var.local(0.0, "the greatest one; 0: none is refused")
    skip_reason: int = var.local(
        0, "why a cut was skipped in the last step; 0: none was", codes=SkipReason, report=Report.STEPS
    )
    skipped_cut: float = var.snapshot(0.0, "master position of the last skipped cut", Unit.POSITION)
    missing_distance: float = var.snapshot(
        0.0, "by how much the line's travel to it was too short for the ramp from rest", Unit.POSITION
    )
    line_velocity: float = var.snapshot(0.0, "the line's velocity when it was skipped", Unit.VELOCITY)
    exceeded_limit: int = var.local(
        0,
        "which limit of the axis is exceeded",
        codes=var.merged(var.selected(Limit, "MAX_VELOCITY", "MAX_ACCELERATION", "MAX_JERK"), KnifeLimit),
        report=Report.EPISODES,
        role=Role.EXCEEDED_LIMIT,
    )
    exceeded_value: float = var.snapshot(0.0, "the value that exceeds it, in the limit's unit")


@dataclass(slots=True)
class RotaryKnifeInterface:
    """All variables of the block, in the order in which the FMU lists them."""

    master: Master = var.part(Master)
    start: bool = var.command(False, "rising edge: start to cut")
    stop: bool = var.command(False, "rising edge: finish the cut under way, then rest at park")
    abort: bool = var.command(False, "rising edge: park at once")
    reset: bool = var.command(False, "rising edge: clear the fault, once the knife rests at park")
    hold: bool = var.input(False, "no way to a cut begins while it is true: the knife parks")
    length: float = var.input(1000.0, "length of a piece without an order; <= 0: none", Unit.POSITION, discrete=True)
    length_correction: float = var.input(
        0.0, "added to each measured length (tape error)", Unit.POSITION, discrete=True, role=Role.LENGTH_CORRECTION
    )
    cut_now: bool = var.command(False, "rising edge: cut as soon as possible")
    take_sample: bool = var.command(False, "rising edge: one sample after the next cut")
    waste: bool = var.input(False, "pieces that start while it is true are waste of waste_length")
    order: Order = var.part(Order)
    mark: Mark = var.part(Mark)
    line: LineRequest = var.part(
        LineRequest, depends={"velocity_request": (*COUPLING, *WINDOW, "knife.park_angle", *AXIS, *PITCH, *REQUEST)}
    )
    slave: Slave = var.part(
        Slave, depends={"position": ("knife.park_angle",)}, periods={"position": "knife.turn"}, slave_unit=True
    )
    state: State = var.output(State.OFF, "what the machine does")
    state_code: int = var.output(0, "the state as a plain integer")
    error: bool = var.output(False, "a command was refused, or the machine has stopped for a fault")
    error_id: int = var.output(
        0,
        "why: 1 start, 2 order, 3 orders full, 4 calibration, 5 tuned parameter, 6 cut_now; 16 cut missed, "
        "18 marks missing, 20 marks full",
        codes=PieceFault,
    )
    running: bool = var.output(
        False, "from start to the rest at park after stop or abort, or to a fault", role=Role.RUNNING
    )
    in_sync: bool = var.output(False, "the knife is in sync with the material")
    knife: Cylinder = var.part(Cylinder)
    next_cut: NextCut = var.part(NextCut)
    piece: Piece = var.part(Piece)
    last: LastPiece = var.part(LastPiece)
    limits: MachineLimits = var.part(
        MachineLimits,
        depends={
            "max_line_velocity": (*COUPLING, *WINDOW, "knife.park_angle", *AXIS, *PITCH),
            "max_line_velocity_orders": (*COUPLING, *WINDOW, "knife.park_angle", *AXIS, *PITCH),
            "min_length": (*COUPLING, *WINDOW, *AXIS, *VELOCITY_SOURCES, *ALLOWANCE),
            "max_length": (*COUPLING, *WINDOW, *ALLOWANCE),
            "cycle_time": (*COUPLING, *WINDOW, *AXIS, *VELOCITY_SOURCES),
            "min_sensor_distance": (*COUPLING, *RAMP_UP, *VELOCITY_SOURCES, "mark.delay"),
        },
    )
    statistics: Statistics = var.part(Statistics)
    warning: Warnings = var.part(Warnings)
    axis: KnifeAxis = var.part(KnifeAxis, slave_unit=True)
    sync: Sync = var.part(Sync)
    auto_start: bool = var.parameter(False, "the first step brings an edge of start")
    allow_parking: bool = var.parameter(
        True, "the knife rests on pieces longer than limits.max_length; false: such pieces are not cut"
    )
    material_factor: float = var.parameter(
        1.0,
        "true travel of the material per travel of the master",
        tunable=True,
        min=SMALLEST_LIMIT,
        max=LARGEST,
        role=Role.MATERIAL_FACTOR,
    )
    kerf: float = var.length(0.0, "material that a cut removes", role=Role.KERF)
    length_tolerance: float = var.length(0.5, "greatest length error of a good piece", role=Role.LENGTH_TOLERANCE)
    source: Source = var.parameter(Source.LENGTH, "what decides where the cuts are")
    start_mode: StartMode = var.parameter(StartMode.FRONT, "what the first piece is measured from", tunable=True)
    front_position: float = var.position(
        0.0, "how far the material's front end is beyond the place of the cut at the edge of start"
    )
    trim_length: float = var.length(0.0, "TRIM: at least so much is cropped")
    change_mode: ChangeMode = var.parameter(ChangeMode.NEXT_PIECE, "to which piece a new length applies", tunable=True)
    late_mode: LateMode = var.parameter(LateMode.SKIP, "what becomes of a cut that cannot be reached", tunable=True)
    sample_length: float = var.length(100.0, "length of a sample", min=SMALLEST_LIMIT)
    waste_length: float = var.length(100.0, "length of a piece of waste", min=SMALLEST_LIMIT)
    batch_size: int = var.parameter(0, "good pieces in a batch (stack); 0: no batches", tunable=True, min=0)
    calibration: Calibration = var.part(Calibration)
    clear_statistics: bool = var.switch(False, "rising edge: start the statistics anew")
    batch_count: int = var.local(0, "good pieces in the present batch")
    batches: int = var.local(0, "full batches")
    batch_done: bool = var.local(False, "a batch is full, until the next cut")
    clock: float = var.local(0.0, "the block's time: 0 at initialization", Unit.TIME)
    peaks: Peaks = var.part(Peaks, slave_unit=True)
    local: Local = var.part(
        Local,
        depends={
            "coupling_factor": (*COUPLING, "sync.mode", "sync.overspeed"),
            "blade_spacing": ("knife.turn", "knife.blades"),
            "edge_radius": ("knife.turn", "sync.mode"),
        },
    )
