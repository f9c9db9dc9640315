"""All variables of the CutToLength, and the enumerations of its own.

Lengths of material are in u of true material; positions of the master are as the master counts. The README says why the
one signal is wired and the other is watched.
"""

from dataclasses import dataclass

from .. import var
from ..cutting.faults import Contradiction, PieceFault
from ..cutting.interface import (
    PITCH,
    REQUEST,
    CuttingInterface,
    CuttingLimits,
    CuttingLocal,
    CuttingWarnings,
    LineRequest,
)
from ..master import VELOCITY_SOURCES
from ..motion.axis_limits import AxisLimits
from ..numerics.computable_range import SMALLEST_LIMIT
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import Fault, SawContradiction, SkipReason

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
STROKE = ("axis.max_position", "home_position")


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
class ToolParameters:
    """What ends the blade's cut, and how long it needs."""

    mode: ToolMode = var.parameter(ToolMode.TIME, "what ends the cut")
    settle_time: float = var.duration(0.0, "in sync before the blade may touch (clamping)")
    on_delay: float = var.duration(0.0, "from tool.command until the blade touches: it is commanded so much earlier")
    cut_time: float = var.duration(0.25, "TIME: the cut; FEEDBACK: what is expected of it")
    cut_distance: float = var.length(100.0, "DISTANCE: the carriage's travel during the cut")
    retract_time: float = var.duration(0.0, "from the end of the cut until the blade is clear")
    timeout: float = var.duration(0.0, "FEEDBACK: the longest cut; 0: any")


@dataclass(slots=True)
class Tool(ToolParameters):
    """The blade."""

    done: bool = var.command(False, "FEEDBACK: rising edge, the cut is through")
    command: bool = var.output(False, "the valve: the blade shall be in the material")
    command_time: float = var.output(
        0.0, "the block's time at the last change of tool.command, which is inside the step", Unit.TIME, discrete=True
    )
    blade_down: bool = var.local(False, "the blade is in the material, as modelled: from command + delay until clear")
    cutting: bool = var.local(False, "the machine is cutting", role=Role.CUTTING)


@dataclass(slots=True)
class MachineLimits(CuttingLimits):
    """What the machine can do."""

    stroke: float = var.local(0.0, "way from home that a cycle takes at the present line velocity", Unit.POSITION)


@dataclass(slots=True)
class Warnings(CuttingWarnings):
    """What the machine's operator should know."""

    stroke: bool = var.local(False, "a cycle at the present line velocity would not fit into the stroke")
    blade_early: bool = var.local(False, "the blade touched before the carriage was in sync; until the next cut")
    gap_skipped: bool = var.local(False, "the gap was not opened, for the axis's limits; until the next cut")


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
class Local(CuttingLocal):
    """What a commissioning engineer would watch."""

    refused_parameter: int = var.refused_parameter(
        0, "which tunable parameter is out of its range", var.merged(SawContradiction, Contradiction)
    )
    skip_reason: int = var.local(
        0, "why a cut was skipped in the last step; 0: none was", codes=SkipReason, report=Report.STEPS
    )
    start_position: float = var.local(0.0, "master position of the next start, at the present velocity", Unit.POSITION)
    approach_distance: float = var.local(0.0, "way from home to sync, at the present line velocity", Unit.POSITION)
    coupling_factor: float = var.snapshot(1.0, "carriage velocity per line velocity in sync", role=Role.COUPLING_FACTOR)
    progress: float = var.local(0.0, "share of the approach that is done", min=0.0, max=1.0)
    ease: float = var.snapshot(1.0, "share of the limits that the way home uses")
    start_time: float = var.snapshot(0.0, "the block's time at the last start of an approach", Unit.TIME)
    home_time: float = var.snapshot(0.0, "the block's time at the last arrival at home", Unit.TIME)


@dataclass(slots=True)
class CutToLengthInterface(CuttingInterface):
    """All variables of the block."""

    tool: Tool = var.part(Tool)
    line: LineRequest = var.part(
        LineRequest, depends={"velocity_request": (*APPROACH, *CUT, *TURN, *WAY_HOME, *PITCH, *STROKE, *REQUEST)}
    )
    slave: Slave = var.part(Slave, depends={"position": ("axis.initial_position",)})
    state: State = var.output(State.OFF, "what the machine does")
    error_id: int = var.output(
        0, "why: 1 to 6 for a command, from 16 on for a fault", codes=var.merged(Fault, PieceFault)
    )
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
    warning: Warnings = var.part(Warnings)
    axis: AxisLimits = var.part(AxisLimits)
    home_position: float = var.position(0.0, "where the carriage waits")
    diagonal_angle: float = var.parameter(
        0.0, "angle between the carriage's and the material's travel", Unit.ANGLE, above=-90.0, below=90.0
    )
    front_position: float = var.position(
        0.0, "carriage position where the material's front end is at the edge of start"
    )
    approach: Approach = var.part(Approach)
    homing: Homing = var.part(Homing)
    gap: Gap = var.part(Gap)
    local: Local = var.part(
        Local, depends={"approach_distance": (*APPROACH, *VELOCITY_SOURCES), "coupling_factor": COUPLING}
    )
