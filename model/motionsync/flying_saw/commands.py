"""The function blocks: how a command tells what becomes of it, by PLCopen's rules for its outputs.

A rising edge of `execute` gives the command. While `execute` stays true exactly one of busy, the result, aborted and
error is true. A result is reset by the falling edge; one that arises after it is shown for the step in which it arises.
The falling edge never ends a command. Source: PLCopen motion control, TS5055, section 12.
"""

from dataclasses import dataclass

from .. import var
from ..slave import Edge
from ..var import Enumeration, Unit
from .faults import Fault


class Phase(Enumeration):
    """What has become of a command, as its outputs show it"""

    IDLE = 0, "nothing to show"
    BUSY = 1, "it is under way"
    REACHED = 2, "it has led to its result"
    ABORTED = 3, "another command has taken its place"


@dataclass(slots=True)
class Command:
    """What all commands share. A derived one adds its values and the name of its result.

    A block speaks of its last edge. If that was refused, a command of an earlier edge goes on unseen: `answers` is
    false. `fresh`: what is shown has arisen in this step. `settled`: the outputs are what they are to stay, until
    something arises or `execute` is no longer as `shown`.
    """

    execute: bool = var.input(False, "rising edge: give the command")
    busy: bool = var.output(False, "the command is under way")
    active: bool = var.output(False, "the command controls the axis (as busy)")
    command_aborted: bool = var.output(False, "another command has taken its place")
    error: bool = var.output(False, "the command was refused")
    error_id: int = var.output(0, "why it was refused, TwinCAT's number", codes=Fault)
    edge: Edge = var.part(Edge)
    phase: Phase = Phase.IDLE
    answers: bool = True
    fresh: bool = False
    settled: bool = False
    shown: bool = False

    def accept(self) -> None:
        self.answers = True
        self.error_id = Fault.NONE
        self.come(Phase.BUSY)

    def refuse(self, fault: Fault) -> None:
        self.answers = False
        self.phase = Phase.IDLE
        self.error_id = fault
        self.fresh = True

    def fail(self, fault: Fault) -> None:
        """An accepted command that cannot go on."""
        if self.answers:
            self.refuse(fault)

    def come(self, phase: Phase) -> None:
        """To what the last accepted command has come."""
        if self.answers:
            self.phase = phase
            self.fresh = True

    def show(self) -> bool:
        """At the end of a step; whether the result is to be shown."""
        if self.settled and not self.fresh and self.execute == self.shown:
            return self.phase == Phase.REACHED
        self.settled = not self.fresh
        self.shown = self.execute
        if not (self.execute or self.fresh):
            if self.phase != Phase.BUSY:
                self.phase = Phase.IDLE
            self.error_id = Fault.NONE
        self.fresh = False
        self.error = self.error_id != Fault.NONE
        self.busy = self.phase == Phase.BUSY
        self.active = self.busy
        self.command_aborted = self.phase == Phase.ABORTED
        return self.phase == Phase.REACHED


@dataclass(slots=True)
class Limited(Command):
    """A command that may have limits of its own for speeding up and slowing down."""

    acceleration: float = var.input(0.0, "acceleration limit; 0: the axis's", Unit.ACCELERATION, discrete=True)
    deceleration: float = var.input(0.0, "deceleration limit; 0: the axis's", Unit.ACCELERATION, discrete=True)
    jerk: float = var.input(0.0, "jerk limit; 0: the axis's", Unit.JERK, discrete=True)


@dataclass(slots=True)
class GearInVelo(Limited):
    """MC_GearInVelo: couple the slave to the master's velocity."""

    ratio_numerator: float = var.input(1.0, "slave per master: numerator, may be negative", discrete=True)
    ratio_denominator: int = var.input(1, "slave per master: denominator, at least 1")
    velocity: float = var.input(0.0, "velocity limit; 0: the axis's", Unit.VELOCITY, discrete=True)
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

    deceleration: float = var.input(0.0, "deceleration limit; 0: the axis's", Unit.ACCELERATION, discrete=True)
    jerk: float = var.input(0.0, "jerk limit; 0: the axis's", Unit.JERK, discrete=True)
    done: bool = var.output(False, "the axis stands")


@dataclass(slots=True)
class MoveVelocity(Limited):
    """MC_MoveVelocity: go on at a velocity for ever."""

    velocity: float = var.input(0.0, "the velocity with its sign; 0: standstill", Unit.VELOCITY, discrete=True)
    in_velocity: bool = var.output(False, "the velocity is reached")


@dataclass(slots=True)
class MoveAbsolute(Limited):
    """MC_MoveAbsolute: go to a position and rest there."""

    position: float = var.input(0.0, "where to go", Unit.POSITION, discrete=True)
    velocity: float = var.input(0.0, "velocity limit; 0: the axis's", Unit.VELOCITY, discrete=True)
    done: bool = var.output(False, "the axis stands at the position")


@dataclass(slots=True)
class GearOut:
    """MC_GearOut: uncouple; done at once."""

    execute: bool = var.input(False, "rising edge: give the command")
    done: bool = var.output(False, "the slave is uncoupled")
    busy: bool = var.output(False, "always false: the command is done at once")
    error: bool = var.output(False, "the command was refused")
    error_id: int = var.output(0, "why it was refused, TwinCAT's number", codes=Fault)
    edge: Edge = var.part(Edge)

    def answer(self, fault: Fault) -> None:
        self.error_id = fault
        self.done = fault == Fault.NONE

    def show(self) -> None:
        if not self.execute:
            self.done = False
            self.error_id = Fault.NONE
        self.error = self.error_id != Fault.NONE


@dataclass(slots=True)
class Reset:
    """MC_Reset: clear the axis's error; done at once."""

    execute: bool = var.input(False, "rising edge: give the command")
    done: bool = var.output(False, "the error is cleared")
    error: bool = var.output(False, "always false: the command is never refused")
    error_id: int = var.output(0, "always 0: the command is never refused")
    edge: Edge = var.part(Edge)

    def show(self) -> None:
        self.done = self.done and self.execute
