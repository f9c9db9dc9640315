"""The variables of the Shifter, and the states that it shows."""

from dataclasses import dataclass

from .. import var
from ..master import ACCELERATION_SOURCES, POSITION_SOURCES, VELOCITY_SOURCES, Master
from ..slave import Slave
from ..var import Enumeration, Unit
from .faults import Fault


class State(Enumeration):
    """Where the slave runs"""

    FOLLOWING = 0, "the slave is where its master is"
    SHIFTED = 1, "the slave is ahead of its master by the offset"


@dataclass(slots=True)
class ShifterInterface:
    """All variables."""

    master: Master = var.part(Master)
    apply: bool = var.command(False, "rising edge: take the offset")
    offset: float = var.input(
        0.0, "how far the slave is ahead of its master; read at the edge of apply", Unit.POSITION, discrete=True
    )
    slave: Slave = var.part(
        Slave,
        depends={
            "position": POSITION_SOURCES,
            "velocity": VELOCITY_SOURCES,
            "acceleration": ACCELERATION_SOURCES,
        },
        periods={"position": "master.period"},
    )
    state: State = var.output(State.FOLLOWING, "where the slave runs")
    state_code: int = var.output(0, "the state as a plain integer")
    error: bool = var.output(False, "the last command was refused")
    error_id: int = var.output(0, "why: 1, the offset is out of its range", codes=Fault)
    least_offset: float = var.parameter(-100.0, "least offset that is taken", Unit.POSITION, min=-1e12, max=1e12)
    greatest_offset: float = var.parameter(100.0, "greatest offset that is taken", Unit.POSITION, min=-1e12, max=1e12)
