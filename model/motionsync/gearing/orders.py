"""What the gearing is told: the settings of engagement and disengagement, and what an edge takes from them."""

from dataclasses import dataclass

from .. import var
from ..slave import Edge, Slave
from ..var import LARGEST_INPUT, Unit
from .choices import Aim, StartMode, StopMode, Transition
from .faults import Fault

LEAST = 1e-9
MOST = 1e12


@dataclass(slots=True)
class Ratio:
    """Slave per master."""

    numerator: int = var.parameter(1, "slave per master: numerator, may be negative, not 0", tunable=True)
    denominator: int = var.parameter(1, "slave per master: denominator, may be negative, not 0", tunable=True)

    def fault(self) -> Fault:
        if self.denominator == 0:
            return Fault.DENOMINATOR
        return Fault.NUMERATOR if self.numerator == 0 else Fault.NONE


@dataclass(slots=True)
class GearIn:
    """How to engage; read at the rising edge of start."""

    start_mode: StartMode = var.parameter(
        StartMode.WITH_CW_REFERENCE_POSITION, "through which point the line runs, and the direction", tunable=True
    )
    transition: Transition = var.parameter(Transition.MASTER_BASED, "how the slave comes on to the line", tunable=True)
    reference_position: float = var.input(
        0.0, "the line passes the slave's start position at reference_position + offset", Unit.POSITION, discrete=True
    )
    offset: float = var.input(0.0, "is added to reference_position", Unit.POSITION, discrete=True)
    distance: float = var.parameter(
        100.0,
        "master distance of a master-based transition; 0: no transition",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST,
    )
    time: float = var.parameter(
        1.0, "duration of a time-based transition, 1e-9 to 1e12 where that is chosen", Unit.TIME, tunable=True, max=MOST
    )


@dataclass(slots=True)
class GearOut:
    """How to disengage; read at the falling edge of start."""

    stop_mode: StopMode = var.parameter(
        StopMode.CW_CCW_DIRECT, "where the slave comes to rest, and the direction", tunable=True
    )
    transition: Transition = var.parameter(Transition.MASTER_BASED, "how the slave comes to rest", tunable=True)
    stop_position: float = var.input(
        0.0, "where the slave shall rest, in the modes with a stop position", Unit.POSITION, discrete=True
    )
    distance: float = var.parameter(
        100.0,
        "master distance of a master-based transition; 0: no transition",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST,
    )
    time: float = var.parameter(
        1.0, "duration of a time-based transition, 1e-9 to 1e12 where that is chosen", Unit.TIME, tunable=True, max=MOST
    )


@dataclass(slots=True)
class SetPoint:
    """Sets half of the synchronous point while the block is not active."""

    execute: bool = var.input(False, "rising edge, while activate is false: set this half of the synchronous point")
    value: float = var.input(0.0, "the position to which it is set", Unit.POSITION, discrete=True)
    edge: Edge = var.part(Edge)


@dataclass(slots=True)
class GearedSlave(Slave):
    """The slave's setpoint at the end of the step, and where it begins."""

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
class Order:
    """A manoeuvre as its edge has ordered it; a master-based transition of distance 0 is none.

    `at_rest`: where its condition is the master's motion alone, it is met by a master at rest, too. `position`: the
    master's reference position, u, or where the slave shall rest."""

    aim: Aim = Aim.DIRECT
    clockwise: bool = True
    counter_clockwise: bool = True
    at_rest: bool = True
    transition: Transition = Transition.NONE
    distance: float = 0.0
    time: float = 1.0
    position: float = 0.0

    def engage(self, settings: GearIn) -> None:
        mode = settings.start_mode
        self.aim = Aim.POSITION
        if mode == StartMode.CONTINUE_SYNCHRONIZED:
            self.aim = Aim.SYNCHRONOUS_POINT
        elif mode in (StartMode.CW_DIRECT, StartMode.CCW_DIRECT, StartMode.CW_CCW_DIRECT):
            self.aim = Aim.DIRECT
        self.clockwise = mode not in (StartMode.CCW_DIRECT, StartMode.WITH_CCW_REFERENCE_POSITION)
        self.counter_clockwise = mode not in (StartMode.CW_DIRECT, StartMode.WITH_CW_REFERENCE_POSITION)
        self.at_rest = mode == StartMode.CW_CCW_DIRECT
        self.position = settings.reference_position + settings.offset
        self.follow(settings.transition, settings.distance, settings.time)

    def disengage(self, settings: GearOut) -> None:
        mode = settings.stop_mode
        direct = mode in (StopMode.CW_DIRECT, StopMode.CCW_DIRECT, StopMode.CW_CCW_DIRECT)
        self.aim = Aim.DIRECT if direct else Aim.POSITION
        self.clockwise = mode not in (StopMode.CCW_DIRECT, StopMode.WITH_CCW_STOP_POSITION)
        self.counter_clockwise = mode not in (StopMode.CW_DIRECT, StopMode.WITH_CW_STOP_POSITION)
        self.at_rest = self.clockwise and self.counter_clockwise
        self.position = settings.stop_position
        self.follow(settings.transition, settings.distance, settings.time)

    def follow(self, transition: Transition, distance: float, time: float) -> None:
        master_based = transition == Transition.MASTER_BASED and distance > 0.0
        self.transition = Transition.NONE if transition == Transition.MASTER_BASED else transition
        if master_based:
            self.transition = Transition.MASTER_BASED
        self.distance = distance if master_based else 0.0
        self.time = time

    def allows(self, way: float) -> bool:
        """Whether the manoeuvre may begin while the master moves that way; 0 is rest."""
        return (way > 0.0 and self.clockwise) or (way < 0.0 and self.counter_clockwise)

    def begins(self, way: float) -> bool:
        """Whether its condition, if that is the master's motion alone, is met while the master moves that way."""
        return self.at_rest or self.allows(way)


def fault_of(transition: Transition, distance: float, time: float) -> Fault:
    """What is wrong with a transition's settings; an unused time may be anything, an unused distance may not."""
    if transition == Transition.TIME_BASED and not LEAST <= time <= MOST:
        return Fault.TIME
    if not (distance == 0.0 or LEAST <= distance <= MOST):
        return Fault.DISTANCE
    if transition not in (Transition.NONE, Transition.MASTER_BASED, Transition.TIME_BASED):
        return Fault.CHOICE
    return Fault.NONE


def gear_in_fault(settings: GearIn) -> Fault:
    fault = fault_of(settings.transition, settings.distance, settings.time)
    if fault == Fault.NONE and not StartMode.CW_DIRECT <= settings.start_mode <= StartMode.CONTINUE_SYNCHRONIZED:
        return Fault.CHOICE
    return fault


def gear_out_fault(settings: GearOut) -> Fault:
    fault = fault_of(settings.transition, settings.distance, settings.time)
    known = StopMode.CW_DIRECT <= settings.stop_mode <= StopMode.WITH_CW_CCW_STOP_POSITION
    return fault if fault != Fault.NONE or known else Fault.CHOICE
