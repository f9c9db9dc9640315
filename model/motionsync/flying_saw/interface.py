"""All variables of the FlyingSaw, and the enumerations that it shows.

The parts with variables of their own are in `saw_master`, `slave`, `axis_limits`, `sync_mode`, `commands` and
`characteristics`.
"""

from dataclasses import dataclass

from .. import var
from ..motion.axis_limits import AxisLimits
from ..motion.exceeded_limit import ExceededLimit, Limit
from ..numerics.computable_range import LARGEST
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .characteristics import Characteristics
from .commands import GearInPos, GearInVelo, GearOut, Halt, MoveAbsolute, MoveVelocity, Reset
from .extremes import Extremes
from .saw_master import SawMaster
from .sync_mode import SyncMode


class State(Enumeration):
    """What moves the axis (nAxisState)"""

    INACTIVE = 0, "it is at rest"
    CONSTANT_VELOCITY = 3, "uncoupled, at constant velocity"
    ACCELERATING = 4, "uncoupled, getting faster"
    DECELERATING = 5, "uncoupled, getting slower"
    PREPHASE = 11, "coupled, waiting: for the start distance, or parked by the backstop"
    SYNCHRONIZING = 12, "coupled, on the way to the synchronous motion"
    SYNCHRON = 13, "coupled, in sync"


class PlcopenState(Enumeration):
    """State of the axis in PLCopen's diagram"""

    STANDSTILL = 1, "it is at rest, and no command moves it"
    DISCRETE_MOTION = 2, "under way to rest: halt or move_absolute"
    CONTINUOUS_MOTION = 3, "under way for ever"
    SYNCHRONIZED_MOTION = 4, "coupled"
    STOPPING = 5, "locked by stop"


@dataclass(slots=True)
class SawAxis(AxisLimits):
    """The slave axis, which may move at first."""

    initial_velocity: float = var.parameter(
        0.0, "its velocity at first, with which it goes on for ever", Unit.VELOCITY, min=-LARGEST, max=LARGEST
    )


@dataclass(slots=True)
class Local:
    """Variables for commissioning."""

    coupling_position: float = var.snapshot(
        0.0, "master position where the present synchronisation began", Unit.POSITION
    )
    progress: float = var.local(0.0, "share of the synchronisation that is done", min=0.0, max=1.0)
    master_distance_to_sync: float = var.local(
        0.0, "master travel missing to the synchronous phase, at constant master velocity", Unit.POSITION
    )
    plan_position_min: float = var.snapshot(0.0, "least position of the last plan, refused or not", Unit.POSITION)
    plan_position_max: float = var.snapshot(0.0, "greatest position of the last plan, refused or not", Unit.POSITION)
    plan_velocity_min: float = var.snapshot(0.0, "least velocity of the last plan, refused or not", Unit.VELOCITY)
    plan_velocity_max: float = var.snapshot(0.0, "greatest velocity of the last plan, refused or not", Unit.VELOCITY)
    plan_acceleration: float = var.snapshot(
        0.0, "greatest acceleration (away from standstill) of the last plan, refused or not", Unit.ACCELERATION
    )
    plan_deceleration: float = var.snapshot(
        0.0, "greatest deceleration (towards standstill) of the last plan, refused or not", Unit.ACCELERATION
    )
    plan_jerk_min: float = var.snapshot(0.0, "least jerk of the last plan, refused or not", Unit.JERK)
    plan_jerk_max: float = var.snapshot(0.0, "greatest jerk of the last plan, refused or not", Unit.JERK)

    exceeded_limit: int = var.local(
        0, "which limit of the axis is exceeded", codes=Limit, report=Report.EPISODES, role=Role.EXCEEDED_LIMIT
    )
    exceeded_value: float = var.snapshot(0.0, "the value that exceeds it, in the limit's unit")

    def show_exceeded(self, exceeded: ExceededLimit) -> None:
        """Show the limit of the axis that is exceeded, and the value."""
        self.exceeded_limit = exceeded.limit
        self.exceeded_value = exceeded.value

    def show_plan(self, extremes: Extremes) -> None:
        """Show what the last plan asks of the slave."""
        self.plan_position_min = extremes.position_min
        self.plan_position_max = extremes.position_max
        self.plan_velocity_min = extremes.velocity_min
        self.plan_velocity_max = extremes.velocity_max
        self.plan_acceleration = extremes.acceleration_peak
        self.plan_deceleration = extremes.deceleration_peak
        self.plan_jerk_min = extremes.jerk_min
        self.plan_jerk_max = extremes.jerk_max


@dataclass(slots=True)
class FlyingSawInterface:
    """The inputs, parameters, outputs and locals of the block."""

    master: SawMaster = var.part(SawMaster)
    gear_in_pos: GearInPos = var.part(GearInPos)
    gear_in_velo: GearInVelo = var.part(GearInVelo)
    gear_out: GearOut = var.part(GearOut)
    move_absolute: MoveAbsolute = var.part(MoveAbsolute)
    move_velocity: MoveVelocity = var.part(MoveVelocity)
    halt: Halt = var.part(Halt)
    stop: Halt = var.part(Halt)
    reset: Reset = var.part(Reset)
    slave: Slave = var.part(
        Slave, depends={"position": ("axis.initial_position",), "velocity": ("axis.initial_velocity",)}
    )
    in_sync: bool = var.output(False, "the slave is in sync with the master")
    coupled: bool = var.output(False, "the slave is coupled to the master: states 11 to 13")
    coupling_factor: float = var.output(0.0, "slave velocity per master velocity; 0 while uncoupled", discrete=True)
    state: State = var.output(State.INACTIVE, "what moves the axis (nAxisState)", depends=("axis.initial_velocity",))
    state_code: int = var.output(0, "the state as a plain integer", depends=("axis.initial_velocity",))
    plcopen_state: PlcopenState = var.output(
        PlcopenState.STANDSTILL, "the axis in PLCopen's state diagram", depends=("axis.initial_velocity",)
    )
    error: bool = var.output(False, "a command was refused, and none accepted since")
    error_id: int = var.output(0, "why the last refused command was: TwinCAT's number")
    limit_exceeded: bool = var.output(
        False, "the motion under way exceeds a limit of the axis or an end position", role=Role.LIMIT_EXCEEDED
    )
    axis: SawAxis = var.part(SawAxis)
    diagonal_angle: float = var.parameter(
        0.0, "angle between the saw's and the master's travel", Unit.ANGLE, above=-90.0, below=90.0
    )
    sync_mode: SyncMode = var.part(SyncMode)
    local: Local = var.part(Local)
    characteristics: Characteristics = var.part(Characteristics)
