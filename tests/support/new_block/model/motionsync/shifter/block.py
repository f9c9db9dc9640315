"""Shifter: a slave that runs ahead of its master by an offset."""

from dataclasses import dataclass

from .. import var
from ..grid import wrap
from ..slave import Edge
from .faults import Fault, Refusal
from .interface import ShifterInterface, State


@dataclass(slots=True)
class Shifter(ShifterInterface):
    """Runs a slave ahead of its master by an offset that a command sets."""

    apply_edge: Edge = var.part(Edge)
    shift: float = 0.0

    def initialize(self) -> Refusal:
        """The slave is where its master is."""
        if self.least_offset > self.greatest_offset:
            return Refusal.RANGE
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.apply_edge.hold(self.apply)
        self.shift = 0.0
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t + h: the command, then the master's path."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.obey()
        self.show()
        self.master.rebase()
        return Refusal.NONE

    def obey(self) -> None:
        """Carry out the command: its edge sets the offset, or is refused."""
        if self.apply_edge.try_rise(self.apply):
            if self.least_offset <= self.offset <= self.greatest_offset:
                self.shift = self.offset
                self.error_id = Fault.NONE
            else:
                self.error_id = Fault.OFFSET

    def show(self) -> None:
        """Everything that is put out, at the step's end."""
        position = wrap(self.master.end + self.shift, self.master.period)
        self.slave.put(position, self.master.end_velocity, self.master.end_acceleration, 0.0)
        self.state = State.FOLLOWING if self.shift == 0.0 else State.SHIFTED
        self.state_code = self.state
        self.error = self.error_id != Fault.NONE
