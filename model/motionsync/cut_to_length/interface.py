"""All variables of the CutToLength in the order in which the FMU shows them, and the enumerations of its own.

What is wired comes first: the master, the commands, the slave and the block's status. Then come what is set once for a
machine and what is watched. Lengths of material are in u of true material; positions of the master are as the master
counts. The README says why the one signal is wired and the other is watched.
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
from ..motion.axis_limits import AxisLimits
from ..motion.exceeded_limit import Limit
from ..numerics.computable_range import LARGEST, SMALLEST_LIMIT
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import Fault, SawParameter, SkipReason

# What the predictions depend on, after the initialization as ever after.
COUPLING = ("diagonal_angle", "material_factor")
APPROACH = (
    "diagonal_angle",
    "material_factor",
    "approach.distance",
    "approach.reserve",
    "approach.acceleration",
    "approach.jerk",
    "axis.max_acceleration",
    "axis.max_jerk",
)
CUT = (
    "tool.mode",
    "tool.settle_time",
    "tool.on_delay",
    "tool.cut_time",
    "tool.cut_distance",
    "tool.retract_time",
    "gap.distance",
    "gap.travel",
)
TURN = ("axis.max_deceleration", "homing.acceleration", "homing.deceleration", "homing.jerk")
WAY_HOME = ("axis.max_velocity", "homing.velocity", "homing.settle_time")
PITCH = ("length", "length_correction", "kerf", "source", "waste", "waste_length", "mark.spacing", "mark.every")
STROKE = ("axis.max_position", "home_position")
REQUEST = ("line.wanted_velocity", "line.margin")


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


class ToolMode(Enumeration):
    """What ends the cut"""

    TIME = 1, "the time tool.cut_time"
    DISTANCE = 2, "the carriage's travel tool.cut_distance"
    FEEDBACK = 3, "a rising edge of tool.done"


@dataclass(slots=True)
class Tool:
    """The blade: what ends its cut, and how long it needs."""

    done: bool = var.command(False, "FEEDBACK: rising edge, the cut is through")
    command: bool = var.output(False, "the valve: the blade shall be in the material")
    command_time: float = var.output(
        0.0, "the block's time at the last change of tool.command, which is inside the step", Unit.TIME, discrete=True
    )
    mode: ToolMode = var.parameter(ToolMode.TIME, "what ends the cut")
    settle_time: float = var.duration(0.0, "in sync before the blade may touch (clamping)")
    on_delay: float = var.duration(0.0, "from tool.command until the blade touches: it is commanded so much earlier")
    cut_time: float = var.duration(0.25, "TIME: the cut; FEEDBACK: what is expected of it")
    cut_distance: float = var.length(100.0, "DISTANCE: the carriage's travel during the cut")
    retract_time: float = var.duration(0.0, "from the end of the cut until the blade is clear")
    timeout: float = var.duration(0.0, "FEEDBACK: the longest cut; 0: any")
    blade_down: bool = var.local(False, "the blade is in the material, as modelled: from command + delay until clear")
    cutting: bool = var.local(False, "the machine is cutting", role=Role.CUTTING)


@dataclass(slots=True)
class MachineLimits:
    """What the machine can do."""

    max_line_velocity: float = var.output(
        0.0, "highest for this piece and the next one", Unit.VELOCITY, discrete=True, role=Role.MAX_MASTER_VELOCITY
    )
    min_length: float = var.output(0.0, "shortest piece at the present line velocity", Unit.POSITION)
    reserve: float = var.output(1.0, "share of the cycle that is left at the present line velocity")
    max_line_velocity_orders: float = var.snapshot(0.0, "highest admissible for all orders or marks", Unit.VELOCITY)
    cycle_time: float = var.local(0.0, "shortest time from cut to cut at the present line velocity", Unit.TIME)
    stroke: float = var.local(0.0, "way from home that a cycle takes at the present line velocity", Unit.POSITION)
    min_sensor_distance: float = var.local(
        0.0, "MARK: least sum of sensor distance and cut offset at the present line velocity", Unit.POSITION
    )


@dataclass(slots=True)
class Warnings:
    """What the machine's operator should know."""

    any: bool = var.output(False, "one of the warnings is present", role=Role.WARNING)
    line_too_fast: bool = var.output(False, "the line is faster than limits.max_line_velocity")
    limit_exceeded: bool = var.output(
        False, "the setpoint exceeds a limit or an end position of the axis", role=Role.LIMIT_EXCEEDED
    )
    orders_too_fast: bool = var.local(False, "the line is faster than limits.max_line_velocity_orders")
    stroke: bool = var.local(False, "a cycle at the present line velocity would not fit into the stroke")
    velocity: bool = var.local(False, "the carriage cannot be as fast as the line")
    blade_early: bool = var.local(False, "the blade touched before the carriage was in sync; until the next cut")
    gap_skipped: bool = var.local(False, "the gap was not opened, for the axis's limits; until the next cut")
    mark_missing: bool = var.local(False, "a mark did not come; until the next accepted one")
    mark_outside: bool = var.local(False, "an edge was no mark; until the next accepted one")
    mark_refused: bool = var.local(False, "at a mark no piece could end; until the next accepted one")
    no_length: bool = var.local(False, "no length is given for the next piece")
    change_pending: bool = var.local(False, "a new length waits until the piece in progress has ended")
    master_input: bool = var.local(False, "master.input_warning is above 1: the line's position or velocity is wrong")


@dataclass(slots=True)
class Approach:
    """The way from home to the synchronous motion."""

    distance: float = var.length(0.0, "least way from home to the sync position; 0: as short as the limits allow")
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
    settle_time: float = var.duration(0.0, "rest at home before the next start")
    ease: bool = var.switch(False, "come home just in time")
    spare_time: float = var.duration(0.02, "come home so much before the next start")
    slowest: float = var.parameter(
        0.05, "the eased way home is no slower than this share", tunable=True, above=0.0, max=1.0
    )


@dataclass(slots=True)
class Gap:
    """After the cut the carriage pulls ahead of the material."""

    distance: float = var.length(0.0, "by so much; 0: not at all")
    travel: float = var.length(100.0, "while it travels so far", min=SMALLEST_LIMIT)


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    start_position: float = var.local(0.0, "master position of the next start, at the present velocity", Unit.POSITION)
    approach_distance: float = var.local(0.0, "way from home to sync, at the present line velocity", Unit.POSITION)
    coupling_factor: float = var.snapshot(1.0, "carriage velocity per line velocity in sync", role=Role.COUPLING_FACTOR)
    progress: float = var.local(0.0, "share of the approach that is done", min=0.0, max=1.0)
    ease: float = var.snapshot(1.0, "share of the limits that the way home uses")
    marks_waiting: int = var.local(0, "marks in the queue")
    no_length: int = var.local(
        0, "why no length is known for the next piece", codes=var.selected(NoLength, "NOT_GIVEN", "TOO_SHORT")
    )
    mark_refusal: int = var.local(
        0, "why a mark was refused in the last step; 0: none was", codes=MarkRefusal, report=Report.STEPS
    )
    refused_mark: float = var.snapshot(0.0, "master position of the last refused mark", Unit.POSITION)
    start_time: float = var.snapshot(0.0, "the block's time at the last start of an approach", Unit.TIME)
    home_time: float = var.snapshot(0.0, "the block's time at the last arrival at home", Unit.TIME)
    refused_parameter: int = var.local(
        0, "which tunable parameter is out of its range", codes=var.merged(SawParameter, PieceParameter)
    )
    skip_reason: int = var.local(
        0, "why a cut was skipped in the last step; 0: none was", codes=SkipReason, report=Report.STEPS
    )
    skipped_cut: float = var.snapshot(
        0.0, "master position at which the last skipped cut passes slave position 0", Unit.POSITION
    )
    missing_distance: float = var.snapshot(0.0, "by how much the carriage's way to it was too short", Unit.POSITION)
    line_velocity: float = var.snapshot(0.0, "the line's velocity when it was skipped", Unit.VELOCITY)
    exceeded_limit: int = var.local(
        0, "which limit of the axis is exceeded", codes=Limit, report=Report.EPISODES, role=Role.EXCEEDED_LIMIT
    )
    exceeded_value: float = var.snapshot(0.0, "the value that exceeds it, in the limit's unit")


@dataclass(slots=True)
class CutToLengthInterface:
    """All variables of the block, in the order in which the FMU lists them."""

    master: Master = var.part(Master)
    start: bool = var.command(False, "rising edge: start to cut")
    stop: bool = var.command(False, "rising edge: finish the cut under way, then rest at home")
    abort: bool = var.command(False, "rising edge: leave the material at once, then rest at home")
    reset: bool = var.command(False, "rising edge: clear the fault, once the carriage rests at home")
    hold: bool = var.input(False, "no approach starts while it is true")
    length: float = var.input(1000.0, "length of a piece without an order; <= 0: none", Unit.POSITION, discrete=True)
    length_correction: float = var.input(
        0.0, "added to each measured length (tape error)", Unit.POSITION, discrete=True, role=Role.LENGTH_CORRECTION
    )
    cut_now: bool = var.command(False, "rising edge: cut as soon as possible")
    take_sample: bool = var.command(False, "rising edge: one sample after the next cut")
    waste: bool = var.input(False, "pieces that start while it is true are waste of waste_length")
    order: Order = var.part(Order)
    mark: Mark = var.part(Mark)
    tool: Tool = var.part(Tool)
    line: LineRequest = var.part(
        LineRequest, depends={"velocity_request": (*APPROACH, *CUT, *TURN, *WAY_HOME, *PITCH, *STROKE, *REQUEST)}
    )
    slave: Slave = var.part(Slave, depends={"position": ("axis.initial_position",)})
    state: State = var.output(State.OFF, "what the machine does")
    state_code: int = var.output(0, "the state as a plain integer")
    error: bool = var.output(False, "a command was refused, or the machine has stopped for a fault")
    error_id: int = var.output(
        0,
        "why: 1 start, 2 order, 3 orders full, 4 calibration, 5 tuned parameter, 6 cut_now; 16 cut missed, 17 stroke, "
        "18 marks missing, 19 tool timeout, 20 marks full",
        codes=var.merged(Fault, PieceFault),
    )
    running: bool = var.output(False, "from start to the arrival after stop or abort, or to a fault", role=Role.RUNNING)
    in_sync: bool = var.output(False, "the carriage is in sync with its cut")
    next_cut: NextCut = var.part(NextCut)
    piece: Piece = var.part(Piece)
    last: LastPiece = var.part(LastPiece)
    limits: MachineLimits = var.part(
        MachineLimits,
        depends={
            "max_line_velocity": (*APPROACH, *CUT, *TURN, *WAY_HOME, *PITCH, *STROKE),
            "max_line_velocity_orders": (*APPROACH, *CUT, *TURN, *WAY_HOME, *PITCH, *STROKE),
            "min_length": (*APPROACH, *CUT, *TURN, *WAY_HOME, *VELOCITY_SOURCES, "length_correction", "kerf", "source"),
            "cycle_time": (*APPROACH, *CUT, *TURN, *WAY_HOME, *VELOCITY_SOURCES),
            "stroke": (*APPROACH, *CUT, *TURN, *VELOCITY_SOURCES),
            "min_sensor_distance": (*APPROACH, *VELOCITY_SOURCES, "home_position", "mark.delay"),
        },
    )
    statistics: Statistics = var.part(Statistics)
    warning: Warnings = var.part(Warnings)
    axis: AxisLimits = var.part(AxisLimits)
    auto_start: bool = var.parameter(False, "the first step brings an edge of start")
    home_position: float = var.position(0.0, "where the carriage waits")
    diagonal_angle: float = var.parameter(
        0.0, "angle between the carriage's and the material's travel", Unit.ANGLE, above=-90.0, below=90.0
    )
    material_factor: float = var.parameter(
        1.0,
        "true travel of the material per travel of the master",
        tunable=True,
        min=SMALLEST_LIMIT,
        max=LARGEST,
        role=Role.MATERIAL_FACTOR,
    )
    kerf: float = var.length(0.0, "material that a cut removes, along the material", role=Role.KERF)
    length_tolerance: float = var.length(0.5, "greatest length error of a good piece", role=Role.LENGTH_TOLERANCE)
    source: Source = var.parameter(Source.LENGTH, "what decides where the cuts are")
    start_mode: StartMode = var.parameter(StartMode.FRONT, "what the first piece is measured from", tunable=True)
    front_position: float = var.position(
        0.0, "carriage position where the material's front end is at the edge of start"
    )
    trim_length: float = var.length(0.0, "TRIM: at least so much is cropped")
    change_mode: ChangeMode = var.parameter(ChangeMode.NEXT_PIECE, "to which piece a new length applies", tunable=True)
    late_mode: LateMode = var.parameter(LateMode.SKIP, "what becomes of a cut that cannot be reached", tunable=True)
    sample_length: float = var.length(100.0, "length of a sample", min=SMALLEST_LIMIT)
    waste_length: float = var.length(100.0, "length of a piece of waste", min=SMALLEST_LIMIT)
    batch_size: int = var.parameter(0, "good pieces in a batch (stack); 0: no batches", tunable=True, min=0)
    approach: Approach = var.part(Approach)
    homing: Homing = var.part(Homing)
    gap: Gap = var.part(Gap)
    calibration: Calibration = var.part(Calibration)
    clear_statistics: bool = var.switch(False, "rising edge: start the statistics anew")
    batch_count: int = var.local(0, "good pieces in the present batch")
    batches: int = var.local(0, "full batches")
    batch_done: bool = var.local(False, "a batch is full, until the next cut ends")
    clock: float = var.local(0.0, "the block's time: 0 at initialization", Unit.TIME)
    local: Local = var.part(
        Local, depends={"approach_distance": (*APPROACH, *VELOCITY_SOURCES), "coupling_factor": COUPLING}
    )
