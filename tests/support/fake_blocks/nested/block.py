"""A block that follows its master up to a limit, on an inclined axis."""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..slave import Edge, Slave
from ..var import Enumeration, Unit
from .faults import Fault, Refusal
from .law import limited, slanted


class State(Enumeration):
    """What the small block does"""

    FREE = 0, "follows the master"
    LIMITED = 13, "follows it up to the limit"


@dataclass(slots=True)
class Limit:
    """The command that sets a limit."""

    execute: bool = var.command(False, "rising edge: take the limit")
    limit: float = var.input(1.0, "greatest position, > 0", Unit.POSITION, discrete=True)
    error: bool = var.output(False, "the limit was refused")
    error_id: int = var.output(0, "why", codes=Fault)
    edge: Edge = var.part(Edge)


@dataclass(slots=True)
class Nested:
    """Follows its master up to a limit, on an inclined axis."""

    master: Master = var.part(Master)
    angle: float = var.parameter(0.0, "between the two axes", Unit.ANGLE, above=-90.0, below=90.0)
    keep: Limit = var.part(Limit)
    slave: Slave = var.part(Slave, depends={"position": ("master.position", "master.period", "angle")})
    state: State = var.output(State.FREE, "what it does")
    state_code: int = var.output(0, "the state as a plain integer")
    power: float = var.output(0.0, "the slave's velocity times its acceleration", Unit.MOMENTUM)
    age: float = var.output(0.0, "time since the beginning", Unit.TIME)
    rotated: float = var.output(0.0, "the angle", Unit.ANGLE, discrete=True, depends=("angle",))
    factor: float = 1.0
    limit: float = 1e9

    def initialize(self) -> Refusal:
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.factor = slanted(self.angle)
        self.rotated = self.angle
        self.keep.edge.before = self.keep.execute
        self.slave.position = limited(self.factor * self.master.end, self.limit)
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        if self.keep.edge.try_rise(self.keep.execute):
            self.take()
        self.age += h
        velocity = self.factor * self.master.end_velocity
        acceleration = self.factor * self.master.end_acceleration
        self.slave.set(limited(self.factor * self.master.end, self.limit), velocity, acceleration, 0.0)
        self.power = velocity * acceleration
        self.state_code = self.state
        return Refusal.NONE

    def take(self) -> None:
        self.keep.error = not self.keep.limit > 0.0
        self.keep.error_id = Fault.LIMIT if self.keep.error else Fault.NONE
        if not self.keep.error:
            self.limit = self.keep.limit
            self.state = State.LIMITED
