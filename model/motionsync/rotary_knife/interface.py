"""All variables of the RotaryKnife, and the enumerations of its own.

Lengths of material are in u of true material; positions of the master are as the master counts; the knife turns in the
slave's own unit.
"""

from dataclasses import dataclass

from .. import var
from ..cutting.faults import Contradiction, NoLength
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
from ..motion.exceeded_limit import Limit
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import KnifeContradiction, KnifeLimit, SkipReason

MOST_BLADES = 64

# What the predictions depend on, after the initialization as ever after.
COUPLING = ("material_factor", "knife.turn", "knife.circumference")
WINDOW = ("knife.blades", "sync.before", "sync.after", "sync.mode", "sync.overspeed")
RAMP_UP = ("knife.blades", "knife.park_angle", "sync.before", "sync.mode", "sync.overspeed")
AXIS = ("axis.max_velocity", "axis.max_acceleration", "axis.max_jerk")
ALLOWANCE = ("length_correction", "kerf", "source")


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
    turn: float = var.limit(
        360.0, "the slave's position per turn of the cylinder, not 0", Unit.SLAVE_POSITION, zero=False, tunable=False
    )
    circumference: float = var.limit(
        600.0, "of the circle on which the blades' edges run, not 0", Unit.POSITION, zero=False, tunable=False
    )
    blades: int = var.parameter(1, "evenly spaced; one cuts at 0", min=1, max=MOST_BLADES)
    park_angle: float = var.length(
        0.0,
        "where the blade that has cut last rests, between the windows of two blades; 0: half way between them",
        Unit.SLAVE_POSITION,
        tunable=False,
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
        min=-0.2,
        max=0.5,
    )


@dataclass(slots=True)
class KnifeAxis:
    """The limits of the axis that turns the cylinder."""

    max_velocity: float = var.limit(
        3600.0, "velocity limit, not 0", Unit.VELOCITY, zero=False, tunable=False, role=Role.MAX_VELOCITY
    )
    max_acceleration: float = var.limit(
        72000.0, "acceleration limit, not 0", Unit.ACCELERATION, zero=False, tunable=False, role=Role.MAX_ACCELERATION
    )
    max_jerk: float = var.limit(1e6, "jerk limit, not 0", Unit.JERK, zero=False, tunable=False, role=Role.MAX_JERK)


@dataclass(slots=True)
class MachineLimits(CuttingLimits):
    """What the machine can do."""

    max_length: float = var.snapshot(0.0, "longest piece on which the knife does not come to rest", Unit.POSITION)


@dataclass(slots=True)
class Peaks:
    """The greatest magnitudes of the present cycle at the present line velocity."""

    velocity: float = var.local(0.0, "greatest speed of the knife", Unit.VELOCITY, role=Role.PEAK_VELOCITY)
    acceleration: float = var.local(
        0.0, "greatest acceleration of the knife", Unit.ACCELERATION, role=Role.PEAK_ACCELERATION
    )
    jerk: float = var.local(0.0, "greatest jerk of the knife", Unit.JERK, role=Role.PEAK_JERK)


@dataclass(slots=True)
class Local(CuttingLocal):
    """What a commissioning engineer would watch."""

    no_length: int = var.local(0, "why no length is known for the next piece", codes=NoLength)
    refused_parameter: int = var.refused_parameter(
        0, "which tunable parameter is out of its range", var.merged(KnifeContradiction, Contradiction)
    )
    skip_reason: int = var.local(
        0, "why a cut was skipped in the last step; 0: none was", codes=SkipReason, report=Report.STEPS
    )
    exceeded_limit: int = var.local(
        0,
        "which limit of the axis is exceeded",
        codes=var.merged(var.selected(Limit, "MAX_VELOCITY", "MAX_ACCELERATION", "MAX_JERK"), KnifeLimit),
        report=Report.EPISODES,
        role=Role.EXCEEDED_LIMIT,
    )
    coupling_factor: float = var.snapshot(
        1.0, "the knife's travel per travel of the master in sync", Unit.SLAVE_PER_MASTER, role=Role.COUPLING_FACTOR
    )
    blade_spacing: float = var.snapshot(
        360.0, "the knife's travel from one blade to the next", Unit.SLAVE_POSITION, role=Role.CUT_SPACING
    )
    edge_radius: float = var.snapshot(
        0.0, "HORIZONTAL: the knife's travel per rad; else 0", Unit.SLAVE_POSITION, role=Role.EDGE_RADIUS
    )
    allowed_from: float = var.local(0.0, "the least value that a machine setting may have which is refused")
    allowed_to: float = var.local(0.0, "the greatest one; 0: none is refused")


@dataclass(slots=True)
class RotaryKnifeInterface(CuttingInterface):
    """All variables of the block."""

    line: LineRequest = var.part(
        LineRequest, depends={"velocity_request": (*COUPLING, *WINDOW, "knife.park_angle", *AXIS, *PITCH, *REQUEST)}
    )
    slave: Slave = var.part(
        Slave, depends={"position": ("knife.park_angle",)}, periods={"position": "knife.turn"}, slave_unit=True
    )
    state: State = var.output(State.OFF, "what the machine does")
    knife: Cylinder = var.part(Cylinder)
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
    warning: CuttingWarnings = var.part(CuttingWarnings)
    axis: KnifeAxis = var.part(KnifeAxis, slave_unit=True)
    sync: Sync = var.part(Sync)
    allow_parking: bool = var.parameter(
        True, "the knife rests on pieces longer than limits.max_length; false: such pieces are not cut"
    )
    peaks: Peaks = var.part(Peaks, slave_unit=True)
    local: Local = var.part(
        Local,
        depends={
            "coupling_factor": (*COUPLING, "sync.mode", "sync.overspeed"),
            "blade_spacing": ("knife.turn", "knife.blades"),
            "edge_radius": ("knife.turn", "sync.mode"),
        },
    )
