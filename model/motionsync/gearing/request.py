"""The request for a manoeuvre: the settings that an edge of `start` has read, and whether they are accepted."""

from dataclasses import dataclass

from ..numerics.computable_range import LARGEST
from ..var import Enumeration
from .faults import Fault
from .interface import LEAST, GearIn, GearOut, Ratio, StartMode, StopMode, Transition


class PositionSource(Enumeration):
    """What determines where a manoeuvre takes place"""

    DIRECT = 1, "both axes' positions at the moment when the manoeuvre's condition is met"
    POSITION = 2, "a position that is set with the command"
    SYNCHRONOUS_POINT = 3, "the last synchronous point"


@dataclass(slots=True)
class ManoeuvreRequest:
    """An engagement or a disengagement with the settings that its edge has read; they hold to the manoeuvre's end.

    Its condition is either the master's motion alone, or that the master crosses a trigger while it travels in a
    direction that is allowed, clockwise (upwards) or counter-clockwise (downwards).

    - at_rest: a condition that is the master's motion alone is met by a master at rest, too.
    - transition: NONE means a master-based one of distance 0, too.
    - distance: the master's distance of a master-based transition, u; 0 for the other transitions.
    - time: the duration of a time-based transition, s.
    - position: of an engagement the master's reference position, of a disengagement the slave's stop position, u.
    """

    source: PositionSource = PositionSource.DIRECT
    clockwise: bool = True
    counter_clockwise: bool = True
    at_rest: bool = True
    transition: Transition = Transition.NONE
    distance: float = 0.0
    time: float = 1.0
    position: float = 0.0

    def read_gear_in(self, settings: GearIn) -> None:
        """Become the engagement of these settings."""
        mode = settings.start_mode
        self.source = PositionSource.POSITION
        if mode == StartMode.CONTINUE_SYNCHRONIZED:
            self.source = PositionSource.SYNCHRONOUS_POINT
        elif mode in (StartMode.CW_DIRECT, StartMode.CCW_DIRECT, StartMode.CW_CCW_DIRECT):
            self.source = PositionSource.DIRECT
        self.clockwise = mode not in (StartMode.CCW_DIRECT, StartMode.WITH_CCW_REFERENCE_POSITION)
        self.counter_clockwise = mode not in (StartMode.CW_DIRECT, StartMode.WITH_CW_REFERENCE_POSITION)
        self.at_rest = mode == StartMode.CW_CCW_DIRECT
        self.position = settings.reference_position + settings.offset
        self.set_transition(settings.transition, settings.distance, settings.time)

    def read_gear_out(self, settings: GearOut) -> None:
        """Become the disengagement of these settings."""
        mode = settings.stop_mode
        direct = mode in (StopMode.CW_DIRECT, StopMode.CCW_DIRECT, StopMode.CW_CCW_DIRECT)
        self.source = PositionSource.DIRECT if direct else PositionSource.POSITION
        self.clockwise = mode not in (StopMode.CCW_DIRECT, StopMode.WITH_CCW_STOP_POSITION)
        self.counter_clockwise = mode not in (StopMode.CW_DIRECT, StopMode.WITH_CW_STOP_POSITION)
        self.at_rest = self.clockwise and self.counter_clockwise
        self.position = settings.stop_position
        self.set_transition(settings.transition, settings.distance, settings.time)

    def set_transition(self, transition: Transition, distance: float, time: float) -> None:
        no_distance = transition == Transition.MASTER_BASED and distance == 0.0
        self.transition = Transition.NONE if no_distance else transition
        self.distance = distance if transition == Transition.MASTER_BASED else 0.0
        self.time = time

    def allows(self, direction: float) -> bool:
        """Whether the manoeuvre may start while the master moves in this direction; 0 is rest."""
        return (direction > 0.0 and self.clockwise) or (direction < 0.0 and self.counter_clockwise)

    def is_met_by(self, direction: float) -> bool:
        """Whether a condition that is the master's motion alone is met by a motion in this direction; 0 is rest."""
        return self.at_rest or self.allows(direction)


def ratio_fault(ratio: Ratio) -> Fault:
    """Why a ratio is refused: DENOMINATOR, NUMERATOR or NONE."""
    if ratio.denominator == 0:
        return Fault.DENOMINATOR
    return Fault.NUMERATOR if ratio.numerator == 0 else Fault.NONE


def transition_fault(transition: Transition, distance: float, time: float) -> Fault:
    """TIME, DISTANCE, CHOICE or NONE. A time that the transition does not use may have any value, a distance not."""
    if transition == Transition.TIME_BASED and not LEAST <= time <= LARGEST:
        return Fault.TIME
    if not (distance == 0.0 or LEAST <= distance <= LARGEST):
        return Fault.DISTANCE
    if transition not in (Transition.NONE, Transition.MASTER_BASED, Transition.TIME_BASED):
        return Fault.CHOICE
    return Fault.NONE


def gear_in_fault(settings: GearIn) -> Fault:
    """Why an engagement with these settings is refused; NONE: it is accepted."""
    fault = transition_fault(settings.transition, settings.distance, settings.time)
    if fault == Fault.NONE and not StartMode.CW_DIRECT <= settings.start_mode <= StartMode.CONTINUE_SYNCHRONIZED:
        return Fault.CHOICE
    return fault


def gear_out_fault(settings: GearOut) -> Fault:
    """Why a disengagement with these settings is refused; NONE: it is accepted."""
    fault = transition_fault(settings.transition, settings.distance, settings.time)
    if fault == Fault.NONE and not StopMode.CW_DIRECT <= settings.stop_mode <= StopMode.WITH_CW_CCW_STOP_POSITION:
        return Fault.CHOICE
    return fault
