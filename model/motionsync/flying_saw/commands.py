"""The function blocks: the inputs of each command, and the outputs that show its progress and its result.

PLCopen's rules for the outputs: a rising edge of `execute` gives the command. While `execute` stays true exactly one of
busy, the result, command_aborted and error is true. The falling edge resets the result; a result that arises after the
falling edge is shown for the one step in which it arises. The falling edge never ends a command. Source: PLCopen motion
control, TS5055, section 12.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import LARGEST, SMALLEST_LIMIT
from ..slave import Edge
from ..var import Enumeration, Unit
from .faults import Fault


class Phase(Enumeration):
    """What has become of a command, as its outputs show"""

    IDLE = 0, "nothing to show"
    BUSY = 1, "it is under way"
    REACHED = 2, "it has led to its result"
    ABORTED = 3, "another command has taken its place"


@dataclass(slots=True)
class Command:
    """What all commands share. A derived class adds the command's values and its result.

    A function block shows what becomes of its last edge. If that edge was refused, a command of an earlier edge goes on
    without being shown.

    Attributes:
        phase: what has become of the command of the last edge.
        is_accepted: the last edge was accepted, so the block shows what becomes of its command.
        has_news: the phase or the fault has arisen since the outputs were shown last.
        settled: the outputs stay as they are until something arises or `execute` changes.
        shown_execute: `execute` when the outputs were shown last.
    """

    execute: bool = var.command(False, "rising edge: give the command")
    busy: bool = var.output(False, "the command is under way")
    command_aborted: bool = var.output(False, "another command has taken its place")
    error: bool = var.output(False, "the command was refused")
    error_id: int = var.local(0, "why it was refused, TwinCAT's number", codes=Fault)
    active: bool = var.local(False, "the command controls the axis (as busy)")
    edge: Edge = var.part(Edge)
    phase: Phase = Phase.IDLE
    is_accepted: bool = True
    has_news: bool = False
    settled: bool = False
    shown_execute: bool = False

    def accept(self) -> None:
        """Take the command of the last edge as under way."""
        self.is_accepted = True
        self.error_id = Fault.NONE
        self.report(Phase.BUSY)

    def refuse(self, fault: Fault) -> None:
        """Refuse the command of this edge."""
        self.is_accepted = False
        self.phase = Phase.IDLE
        self.error_id = fault
        self.has_news = True

    def fail(self, fault: Fault) -> None:
        """Refuse the last accepted command, which cannot go on."""
        if self.is_accepted:
            self.refuse(fault)

    def report(self, phase: Phase) -> None:
        """Set the phase that the last accepted command has reached."""
        if self.is_accepted:
            self.phase = phase
            self.has_news = True

    def show(self) -> None:
        """Derive the outputs from the command's phase; the derived classes' results follow from `is_reached` after
        this."""
        if self.settled and not self.has_news and self.execute == self.shown_execute:
            return
        self.settled = not self.has_news
        self.shown_execute = self.execute
        if not (self.execute or self.has_news):
            if self.phase != Phase.BUSY:
                self.phase = Phase.IDLE
            self.error_id = Fault.NONE
        self.has_news = False
        self.error = self.error_id != Fault.NONE
        self.busy = self.phase == Phase.BUSY
        self.active = self.busy
        self.command_aborted = self.phase == Phase.ABORTED

    def is_reached(self) -> bool:
        """Whether the command has led to its result."""
        return self.phase == Phase.REACHED


@dataclass(slots=True)
class Limited(Command):
    """A command that may have limits of its own for speeding up and slowing down."""

    acceleration: float = var.limit(0.0, "acceleration limit; 0: the axis's", Unit.ACCELERATION)
    deceleration: float = var.limit(0.0, "deceleration limit; 0: the axis's", Unit.ACCELERATION)
    jerk: float = var.limit(0.0, "jerk limit; 0: the axis's", Unit.JERK)


@dataclass(slots=True)
class GearInVelo(Limited):
    """MC_GearInVelo: couple the slave to the master's velocity."""

    ratio_numerator: float = var.parameter(
        1.0,
        "slave per master: numerator, not 0, may be negative",
        tunable=True,
        min=-LARGEST,
        max=LARGEST,
        smallest=SMALLEST_LIMIT,
        zero=False,
    )
    ratio_denominator: int = var.parameter(1, "slave per master: denominator, at least 1", tunable=True, min=1)
    velocity: float = var.limit(0.0, "velocity limit; 0: the axis's", Unit.VELOCITY)
    start_sync: bool = var.output(False, "the synchronisation has begun")
    in_sync: bool = var.output(False, "the slave is in sync with the master")


@dataclass(slots=True)
class GearInPos(GearInVelo):
    """MC_GearInPos: couple the slave so that it meets the master at given positions."""

    master_sync_position: float = var.input(
        0.0, "where the master is when both are in sync", Unit.POSITION, discrete=True
    )
    slave_sync_position: float = var.input(
        0.0, "where the slave is when both are in sync", Unit.POSITION, discrete=True
    )
    master_start_distance: float = var.input(
        0.0, "the slave starts so much before the master's sync position; 0: at once", Unit.POSITION, discrete=True
    )


@dataclass(slots=True)
class Halt(Command):
    """MC_Halt, MC_Stop: come to rest; stop locks the axis meanwhile."""

    deceleration: float = var.limit(0.0, "deceleration limit; 0: the axis's", Unit.ACCELERATION)
    jerk: float = var.limit(0.0, "jerk limit; 0: the axis's", Unit.JERK)
    done: bool = var.output(False, "the axis is at rest")


@dataclass(slots=True)
class MoveVelocity(Limited):
    """MC_MoveVelocity: move at a velocity for ever."""

    velocity: float = var.input(0.0, "the velocity with its sign; 0: standstill", Unit.VELOCITY, discrete=True)
    in_velocity: bool = var.output(False, "the velocity is reached")


@dataclass(slots=True)
class MoveAbsolute(Limited):
    """MC_MoveAbsolute: move to a position and rest there."""

    position: float = var.input(0.0, "where to go", Unit.POSITION, discrete=True)
    velocity: float = var.limit(0.0, "velocity limit; 0: the axis's", Unit.VELOCITY)
    done: bool = var.output(False, "the axis is at rest at the position")


@dataclass(slots=True)
class GearOut:
    """MC_GearOut: uncouple; done at once."""

    execute: bool = var.command(False, "rising edge: give the command")
    done: bool = var.output(False, "the slave is uncoupled")
    error: bool = var.output(False, "the command was refused")
    error_id: int = var.local(0, "why it was refused, TwinCAT's number", codes=Fault)
    busy: bool = var.local(False, "always false: the command is done at once")
    edge: Edge = var.part(Edge)

    def conclude(self, fault: Fault) -> None:
        """Take the command as done, or as refused for that fault."""
        self.error_id = fault
        self.done = fault == Fault.NONE

    def show(self) -> None:
        """Derive the outputs from the command's result."""
        if not self.execute:
            self.done = False
            self.error_id = Fault.NONE
        self.error = self.error_id != Fault.NONE


@dataclass(slots=True)
class Reset:
    """MC_Reset: clear the axis's error; done at once."""

    execute: bool = var.command(False, "rising edge: give the command")
    done: bool = var.output(False, "the error is cleared")
    error: bool = var.local(False, "always false: the command is never refused")
    error_id: int = var.local(0, "always 0: the command is never refused")
    edge: Edge = var.part(Edge)

    def show(self) -> None:
        """Derive the outputs from the command's result."""
        self.done = self.done and self.execute
