"""The variables of the Synchronizer, in the order in which its FMU lists them, and what their values mean."""

from dataclasses import dataclass

from .. import var
from ..master import ACCELERATION_SOURCES, POSITION_SOURCES, VELOCITY_SOURCES, Master
from ..slave import Slave
from ..var import Enumeration, Unit
from .faults import Fault

LEAST_PHASING = 1e-9
GREATEST_PHASING = 1e12


class Curve(Enumeration):
    """Law of the transition"""

    PARABOLA = 1, "two parabolas: least acceleration, the jerk is an impulse at both ends"
    POLYNOMIAL_3_4_5 = 2, "polynomial 3-4-5: continuous acceleration, bounded jerk"


class State(Enumeration):
    """What becomes of the last command"""

    READY = 0, "the last command has been completed, refused or ignored"
    EXECUTING = 1, "a command waits for its ramp or ramps the slave"
    STACKED = 2, "as EXECUTING, and the contrary command follows at the ramp's end"


@dataclass(slots=True)
class Local:
    """Variables for commissioning."""

    ramp_begin: float = var.snapshot(0.0, "master position at which the ramp starts", Unit.POSITION)
    ramp_end: float = var.snapshot(0.0, "master position at which the ramp ends", Unit.POSITION)
    progress: float = var.local(0.0, "share of the ramp's master travel that is done", min=0.0, max=1.0)
    distance_to_begin: float = var.local(0.0, "master travel missing to the ramp's beginning", Unit.POSITION)
    distance_to_end: float = var.local(0.0, "master travel missing to the ramp's end", Unit.POSITION)
    transition_distance: float = var.snapshot(0.0, "master travel of the whole ramp", Unit.POSITION)
    peak_acceleration_per_v2: float = var.snapshot(
        0.0, "peak slave acceleration over the square of a constant master velocity", Unit.PER_POSITION
    )
    peak_jerk_per_v3: float = var.snapshot(
        0.0, "peak slave jerk over the cube of a constant master velocity; 0: an impulse", Unit.PER_POSITION2
    )


@dataclass(slots=True)
class SynchronizerInterface:
    """The inputs, parameters, outputs and locals of the block."""

    master: Master = var.part(Master)
    active: bool = var.input(True, "the block is part of a running pipe; inactive, commands act at once")
    start: bool = var.command(False, "rising edge: synchronize")
    stop: bool = var.command(False, "rising edge: unsynchronize and come to rest at rest_value")
    rest_value: float = var.input(
        0.0, "where the slave comes to rest; read at the edge of stop", Unit.POSITION, discrete=True
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
    state: State = var.output(State.READY, "what becomes of the last command")
    state_code: int = var.output(0, "the state as a plain integer")
    ready: bool = var.output(True, "the last command has been completed, refused or ignored")
    synchronized: bool = var.output(True, "the last completed transition was a start")
    status: int = var.output(1, "status word: 1 syn_synchronized, 2 syn_ramp_on")
    syn_synchronized: bool = var.output(True, "the slave is the master")
    syn_ramp_on: bool = var.output(False, "the ramp generator drives the slave")
    error: bool = var.output(False, "the last command was refused")
    error_id: int = var.output(0, "why: 1, output_phasing out of its range", codes=Fault)
    curve: Curve = var.parameter(Curve.POLYNOMIAL_3_4_5, "law of the transition")
    output_phasing: float = var.parameter(
        90.0,
        "the slave's travel in a transition, not 0; its sign is the direction of travel in which commands are executed",
        Unit.POSITION,
        tunable=True,
        min=-GREATEST_PHASING,
        max=GREATEST_PHASING,
        smallest=LEAST_PHASING,
        zero=False,
    )
    local: Local = var.part(Local)
