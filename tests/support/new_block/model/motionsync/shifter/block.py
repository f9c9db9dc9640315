"""Shifter: a slave that runs ahead of its master by an offset."""

from dataclasses import dataclass

from .. import var
from ..numerics.grid import wrap
from ..slave import Edge
from ..var import Enumeration
from .faults import Fault, Refusal
from .interface import ShifterInterface, State


class Stage(Enumeration):
    """What drives the slave"""

    FOLLOWING = 0, "the master"
    SHIFTED = 1, "the master and the offset"


@dataclass(slots=True)
class Shifter(ShifterInterface):
    """Runs a slave ahead of its master by an offset that a command sets."""

    stage: Stage = Stage.FOLLOWING
    apply_edge: Edge = var.part(Edge)
    shift: float = 0.0

    def initialize(self) -> Refusal:
        """The slave is where its master is."""
        if self.least_offset > self.greatest_offset:
            return Refusal.RANGE
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.apply_edge.take_level(self.apply)
        self.enter_following()
        self.set_slave_at(self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t + h: the command, then the master's path."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.obey()
        self.set_slave_at(self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        self.master.rebase()
        return Refusal.NONE

    def obey(self) -> None:
        """Carry out the command: its edge sets the offset, or is refused."""
        if self.apply_edge.try_rise(self.apply):
            if self.least_offset <= self.offset <= self.greatest_offset:
                self.error_id = Fault.NONE
                if self.offset == 0.0:
                    self.enter_following()
                else:
                    self.enter_shifted()
            else:
                self.error_id = Fault.OFFSET

    def enter_following(self) -> None:
        """The slave is where its master is."""
        self.stage = Stage.FOLLOWING
        self.shift = 0.0

    def enter_shifted(self) -> None:
        """The slave is ahead of its master by the present offset."""
        self.stage = Stage.SHIFTED
        self.shift = self.offset

    def set_slave_at(self, position: float, velocity: float, acceleration: float) -> None:
        """The setpoint that belongs to this motion of the master, whose jerk is taken as 0."""
        self.slave.set(wrap(position + self.shift, self.master.period), velocity, acceleration, 0.0)

    def show(self) -> None:
        """Everything that is put out but the slave's setpoint, at the step's end."""
        self.state = State.FOLLOWING if self.stage == Stage.FOLLOWING else State.SHIFTED
        self.state_code = self.state
        self.error = self.error_id != Fault.NONE
