"""What a Gearing shows to the outside. Source: MOVIKIT gearing."""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..numerics.computable_range import LARGEST
from ..slave import Slave
from ..var import LARGEST_INPUT, Enumeration, Unit
from .faults import Fault

LEAST = 1e-9  # of a distance, in u, a time, in s, and a period, in u: the block does not compute with less


class State(Enumeration):
    """What the slave does (eGearingState)"""

    STOPPED = 0, "it rests"
    WAITING_FOR_STARTPOSITION = 1, "it rests until the condition of the engagement is met"
    GEAR_IN = 2, "it is on its way to the line"
    ACTIVE = 3, "it is on the line: in gear"
    WAITING_FOR_STOPPOSITION = 4, "it is on the line until the condition of the disengagement is met"
    GEAR_OUT = 5, "it is on its way to rest"


class StartMode(Enumeration):
    """Through which point the line runs, and in which direction the master has to travel; the numbers are our own"""

    CW_DIRECT = 1, "through both axes' positions as soon as the master travels clockwise (upwards)"
    CCW_DIRECT = 2, "through both axes' positions as soon as the master travels counter-clockwise (downwards)"
    CW_CCW_DIRECT = 3, "through both axes' positions at once"
    WITH_CW_REFERENCE_POSITION = 4, "through the reference position, passed clockwise"
    WITH_CCW_REFERENCE_POSITION = 5, "through the reference position, passed counter-clockwise"
    WITH_CW_CCW_REFERENCE_POSITION = 6, "through the reference position, passed either way"
    CONTINUE_SYNCHRONIZED = 7, "through the last synchronous point, either way"


class StopMode(Enumeration):
    """Where the slave rests, and in which direction the master has to travel; the numbers are our own"""

    CW_DIRECT = 1, "anywhere, as soon as the master travels clockwise (upwards)"
    CCW_DIRECT = 2, "anywhere, as soon as the master travels counter-clockwise (downwards)"
    CW_CCW_DIRECT = 3, "anywhere, at once"
    WITH_CW_STOP_POSITION = 4, "at the stop position, the master travelling clockwise"
    WITH_CCW_STOP_POSITION = 5, "at the stop position, the master travelling counter-clockwise"
    WITH_CW_CCW_STOP_POSITION = 6, "at the stop position, either way"


class Transition(Enumeration):
    """How the slave changes between rest and the line"""

    NONE = 1, "at once: its velocity jumps"
    MASTER_BASED = 2, "along a curve over the master's position"
    TIME_BASED = 3, "along a curve in time"


@dataclass(slots=True)
class Ratio:
    """Slave per master."""

    numerator: int = var.parameter(1, "slave per master: numerator, may be negative, not 0", tunable=True)
    denominator: int = var.parameter(1, "slave per master: denominator, may be negative, not 0", tunable=True)


@dataclass(slots=True)
class GearIn:
    """How to engage; read at the rising edge of start."""

    start_mode: StartMode = var.parameter(
        StartMode.WITH_CW_REFERENCE_POSITION, "through which point the line runs, and the direction", tunable=True
    )
    transition: Transition = var.parameter(Transition.MASTER_BASED, "how the slave gets onto the line", tunable=True)
    reference_position: float = var.input(
        0.0, "the line passes the slave's start position at reference_position + offset", Unit.POSITION, discrete=True
    )
    offset: float = var.input(0.0, "is added to reference_position", Unit.POSITION, discrete=True)
    distance: float = var.length(100.0, "master distance of a master-based transition; 0: none", smallest=LEAST)
    time: float = var.parameter(
        1.0, "duration of a time-based transition, which needs 1e-9 to 1e12", Unit.TIME, tunable=True, max=LARGEST
    )


@dataclass(slots=True)
class GearOut:
    """How to disengage; read at the falling edge of start."""

    stop_mode: StopMode = var.parameter(
        StopMode.CW_CCW_DIRECT, "where the slave rests, and the direction", tunable=True
    )
    transition: Transition = var.parameter(Transition.MASTER_BASED, "how the slave gets to rest", tunable=True)
    stop_position: float = var.input(
        0.0, "where the slave shall rest, in the modes with a stop position", Unit.POSITION, discrete=True
    )
    distance: float = var.length(100.0, "master distance of a master-based transition; 0: none", smallest=LEAST)
    time: float = var.parameter(
        1.0, "duration of a time-based transition, which needs 1e-9 to 1e12", Unit.TIME, tunable=True, max=LARGEST
    )


@dataclass(slots=True)
class SynchronousPointInput:
    """Sets half of the synchronous point, the master's or the slave's position, while the block is not active."""

    execute: bool = var.command(False, "rising edge, while activate is false: set this half of the synchronous point")
    value: float = var.input(0.0, "the position to which it is set", Unit.POSITION, discrete=True)


@dataclass(slots=True)
class GearedSlave(Slave):
    """The slave's setpoint at the end of the step, and its initial position."""

    initial_position: float = var.parameter(
        0.0, "where the slave is at first", Unit.POSITION, min=-LARGEST_INPUT, max=LARGEST_INPUT
    )
    period: float = var.parameter(
        0.0,
        "modulo period of the slave's position: 0, a linear axis, or at least 1e-9",
        Unit.POSITION,
        min=0.0,
        max=LARGEST_INPUT,
        smallest=LEAST,
    )


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    trigger_position: float = var.local(
        0.0, "master position at which the transition starts, or has started", Unit.POSITION
    )
    line_offset: float = var.snapshot(0.0, "slave position on the line with the master at 0", Unit.POSITION)
    progress: float = var.local(
        0.0, "share of the transition that is done, of its distance or its time", min=0.0, max=1.0
    )


@dataclass(slots=True)
class GearingInterface:
    """All variables of a Gearing."""

    master: Master = var.part(Master)
    activate: bool = var.input(True, "false: the slave stops at its last setpoint")
    start: bool = var.command(False, "rising edge: engage; falling edge: disengage (xStart)")
    reset: bool = var.command(False, "rising edge: clear the fault")
    set_master: SynchronousPointInput = var.part(SynchronousPointInput)
    set_slave: SynchronousPointInput = var.part(SynchronousPointInput)
    slave: GearedSlave = var.part(
        GearedSlave,
        depends={"position": ("slave.initial_position", "slave.period")},
        periods={"position": "slave.period"},
    )
    state: State = var.output(State.STOPPED, "what the slave does (eGearingState)")
    state_code: int = var.output(0, "the state as a plain integer")
    in_gear: bool = var.output(False, "the slave is on the line, and not waiting to leave it")
    error: bool = var.output(False, "a command or a ratio was refused, and no command accepted since")
    error_id: int = var.output(
        0, "why: 1 denominator 0, 2 numerator 0, 3 time, 4 distance, 5 unknown mode", codes=Fault
    )
    gearing: Ratio = var.part(Ratio)
    gear_in: GearIn = var.part(GearIn)
    gear_out: GearOut = var.part(GearOut)
    local: Local = var.part(Local, depends={"line_offset": ("slave.initial_position", "slave.period")})
