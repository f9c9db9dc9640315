"""Synchronizer: switches a slave on to and off from its master without a step in position or velocity.

Synchronized, the slave is the master; unsynchronized, it rests. A start or stop ramps it from one to the other along a
curve over the master while the slave travels the phasing. Source: PAM synchronizer pipe block (1998).

Decisions where the source is silent: `local.progress` keeps its value in READY (1 after a completed transition) and is
0 while a command that was given too late, without a period, is not armed; the distances then count the way back to the
ramp's beginning, and are 0 in READY. The characteristic values are those of the last command, 0 before the first.
"""

from dataclasses import dataclass

from .. import var
from ..grid import wrap
from ..laws import chain_rule
from ..master import Master
from ..slave import Edge, Slave
from ..var import Enumeration, Unit
from .faults import Fault, Refusal
from .transition import Curve, Transition

LEAST_PHASING = 1e-9
GREATEST_PHASING = 1e12


class State(Enumeration):
    """What becomes of the last command"""

    READY = 0, "the last command has been completed, refused or ignored"
    EXECUTING = 1, "a command waits for its ramp or ramps the slave"
    STACKED = 2, "as EXECUTING, and the contrary command follows at the ramp's end"


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    ramp_begin: float = var.local(0.0, "master position at which the ramp begins", Unit.POSITION, discrete=True)
    ramp_end: float = var.local(0.0, "master position at which the ramp ends", Unit.POSITION, discrete=True)
    progress: float = var.local(0.0, "share of the ramp's master travel that is done", min=0.0, max=1.0)
    distance_to_begin: float = var.local(0.0, "master travel missing to the ramp's beginning", Unit.POSITION)
    distance_to_end: float = var.local(0.0, "master travel missing to the ramp's end", Unit.POSITION)
    transition_distance: float = var.local(0.0, "master travel of the whole ramp", Unit.POSITION, discrete=True)
    peak_acceleration_per_v2: float = var.local(
        0.0,
        "peak slave acceleration over the square of a constant master velocity",
        Unit.PER_POSITION,
        discrete=True,
    )
    peak_jerk_per_v3: float = var.local(
        0.0,
        "peak slave jerk over the cube of a constant master velocity; 0: an impulse",
        Unit.PER_POSITION2,
        discrete=True,
    )


@dataclass(slots=True)
class Synchronizer:
    """Switches a slave on to and off from its master without a step in position or velocity.

    The software form of a clutch. Synchronized, the slave is the master; unsynchronized, it rests. A rising edge of
    stop lets the slave run out of the master's motion and come to rest at exactly rest_value; a rising edge of start
    takes it from there back on to the master. In between the slave follows a curve over the master position, while it
    travels |output_phasing|; the master may change its speed, stand, or turn round in the meantime.

    Where the ramp lies follows from the rest position, not from when the command is given: with the parabola from
    rest_value - phasing to rest_value + phasing of the master. Give the command before the master is there. Given too
    late it waits: with master.period for the next turn, without one until the master has come back.

    The sign of output_phasing tells the direction in which the master travels when commands shall be executed: positive
    for a rising master, negative for a falling one.

    A second command against the one under way is stacked and begins where the first one ends; further ones are ignored
    until the first is completed. While active is false commands act at once, and the slave jumps.
    """

    master: Master = var.part(Master)
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
    active: bool = var.input(True, "the block is part of a running pipe; inactive, commands act at once")
    start: bool = var.input(False, "rising edge: synchronize")
    stop: bool = var.input(False, "rising edge: unsynchronize and come to rest at rest_value")
    rest_value: float = var.input(
        0.0, "where the slave comes to rest; read at the edge of stop", Unit.POSITION, discrete=True
    )
    slave: Slave = var.part(
        Slave,
        depends={
            "position": ("master.position", "master.period"),
            "velocity": ("master.velocity", "master.input_mode"),
            "acceleration": ("master.acceleration", "master.input_mode"),
        },
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
    local: Local = var.part(Local)

    was_active: bool = True
    start_edge: Edge = var.part(Edge)
    stop_edge: Edge = var.part(Edge)
    running: Transition = var.part(Transition)
    stacked_phasing: float = 0.0
    stacked_rest: float = 0.0
    rest: float = 0.0

    def initialize(self) -> Refusal:
        """READY and synchronized at the master; may be called again while parameters and inputs still change."""
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.was_active = self.active
        self.start_edge.hold(self.start)
        self.stop_edge.hold(self.stop)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the seam to the present input, the commands, then the path of the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(self.master.path.places[0], self.master.begin)
        self.obey()
        for i in range(1, self.master.path.pieces):
            self.travel(self.master.path.places[i], self.master.path.places[i + 1])
        self.show()
        if self.state == State.READY or not self.running.ramping:
            self.master.rebase()
        return Refusal.NONE

    def obey(self) -> None:
        """A change of `active`, then start, then stop; each with the master at the path's beginning."""
        if self.was_active and not self.active:
            self.deactivate()
        self.was_active = self.active
        if self.start_edge.rising(self.start):
            self.command(True)
        if self.stop_edge.rising(self.stop):
            self.command(False)

    def deactivate(self) -> None:
        """At once what all pending commands would have led to."""
        if self.state == State.STACKED:
            self.settle(self.running.starting, self.running.direction * self.running.origin)
            self.settle(not self.running.starting, self.stacked_rest)
        elif self.state == State.EXECUTING:
            self.settle(self.running.starting, self.running.direction * self.running.origin)
        self.state = State.READY

    def settle(self, synchronized: bool, rest: float) -> None:
        """A transition is over: the slave is the master, or rests."""
        self.synchronized = synchronized
        if not synchronized:
            self.rest = rest

    def command(self, starting: bool) -> None:
        """The edge of start or stop; what is neither ignored nor refused is taken up or stacked."""
        rest = self.rest if starting else wrap(self.rest_value, self.master.period)
        self.error_id = Fault.NONE
        if not self.active:
            self.settle(starting, rest)
        elif self.ignores(starting):
            return
        elif not LEAST_PHASING <= abs(self.output_phasing) <= GREATEST_PHASING:
            self.error_id = Fault.PHASING
        elif self.state == State.READY:
            self.take_up(starting, self.output_phasing, rest)
        else:
            self.state = State.STACKED
            self.stacked_phasing = self.output_phasing
            self.stacked_rest = rest

    def ignores(self, starting: bool) -> bool:
        match self.state:
            case State.READY:
                return self.synchronized == starting
            case State.EXECUTING:
                return self.running.starting == starting
            case _:
                return True

    def take_up(self, starting: bool, phasing: float, rest: float) -> None:
        self.state = State.EXECUTING
        self.running.command(starting, self.curve, phasing, rest)
        self.local.transition_distance = self.running.distance
        self.local.peak_acceleration_per_v2 = self.running.peak_acceleration()
        self.local.peak_jerk_per_v3 = self.running.peak_jerk()

    def travel(self, begin: float, end: float) -> None:
        """A monotone piece of the master's path; where a transition ends, the stacked command goes on from there."""
        while self.state != State.READY and self.running.travel(begin, end, self.master.period):
            begin = self.running.direction * self.running.end
            self.complete()

    def complete(self) -> None:
        """The running command's transition has ended."""
        self.mark()
        self.local.progress = 1.0
        self.settle(self.running.starting, self.running.direction * self.running.origin)
        if self.state == State.STACKED:
            starting = not self.running.starting
            self.take_up(starting, self.stacked_phasing, self.rest if starting else self.stacked_rest)
        else:
            self.state = State.READY

    def mark(self) -> None:
        """Where the ramp lies that is aimed at."""
        self.local.ramp_begin = wrap(self.running.direction * self.running.begin, self.master.period)
        self.local.ramp_end = wrap(self.running.direction * self.running.end, self.master.period)

    def show(self) -> None:
        """Everything that is put out, at the step's end; periods are applied last."""
        executing = self.state != State.READY
        ramping = executing and self.running.ramping
        self.drive(ramping)
        self.state_code = self.state
        self.ready = not executing
        self.syn_synchronized = self.synchronized and not ramping
        self.syn_ramp_on = ramping
        self.status = (1 if self.syn_synchronized else 0) + (2 if ramping else 0)
        self.error = self.error_id != Fault.NONE
        if executing:
            self.mark()
            self.local.progress = self.running.progress(self.master.end)
            self.local.distance_to_begin = self.running.distance_to_begin(self.master.end)
            self.local.distance_to_end = self.running.distance_to_end(self.master.end)
        else:
            self.local.distance_to_begin = 0.0
            self.local.distance_to_end = 0.0

    def drive(self, ramping: bool) -> None:
        """The slave's setpoint: on the ramp by the chain rule, the master's jerk taken as 0; else master or rest."""
        position = self.master.end
        v = self.master.end_velocity
        a = self.master.end_acceleration
        if ramping:
            position, slope, curvature, twist = self.running.follow(position)
            velocity, acceleration, jerk = chain_rule(slope, curvature, twist, v, a)
            self.slave.put(wrap(position, self.master.period), velocity, acceleration, jerk)
        elif self.synchronized:
            self.slave.put(wrap(position, self.master.period), v, a, 0.0)
        else:
            self.slave.put(self.rest, 0.0, 0.0, 0.0)
