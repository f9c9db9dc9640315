"""Synchronizer: switches a slave on to and off from its master without a step in position or velocity.

Source: PAM synchronizer pipe block (1998). README.md in this folder gives the decisions where it is silent.
"""

from dataclasses import dataclass

from .. import var
from ..master_path import MOST_EVENTS
from ..motion.laws import chain_rule
from ..numerics.grid import wrap
from ..slave import Edge
from ..var import Enumeration
from .faults import Fault, Refusal
from .interface import GREATEST_PHASING, LEAST_PHASING, State, SynchronizerInterface
from .transition import PhasingTransition


class Stage(Enumeration):
    """What drives the slave"""

    SYNCHRONIZED = 1, "the slave is the master; no command is under way"
    RESTING = 2, "the slave rests; no command is under way"
    WAITING = 3, "a command waits for its ramp; until then a slave that shall start rests, one that shall stop goes on"
    RAMPING = 4, "the slave follows the ramp of a command"


@dataclass(slots=True)
class Synchronizer(SynchronizerInterface):
    """Switches a slave on to and off from its master without a step in position or velocity.

    The software form of a clutch. Synchronized, the slave is the master; unsynchronized, it rests. A rising edge of
    stop lets the slave run out of the master's motion and come to rest at exactly rest_value; a rising edge of start
    takes it from there back on to the master. In between the slave follows a curve over the master position, while it
    travels |output_phasing|; the master may change its speed, stop, or reverse in the meantime.

    The position of the ramp follows from the rest position, not from when the command is given: with the parabola from
    rest_value - phasing to rest_value + phasing of the master. Give the command before the master is there. Given too
    late it waits: with master.period for the next turn, without one until the master has come back.

    The sign of output_phasing gives the direction in which the master travels when commands shall be executed: positive
    for a rising master, negative for a falling one.

    A second command against the one under way is stacked and starts where the first one ends; further ones are ignored
    until the first is completed. While active is false commands act at once, and the slave jumps.
    """

    stage: Stage = Stage.SYNCHRONIZED
    stacked: bool = False
    was_active: bool = True
    start_edge: Edge = var.part(Edge)
    stop_edge: Edge = var.part(Edge)
    transition: PhasingTransition = var.part(PhasingTransition)
    stacked_phasing: float = 0.0
    stacked_rest: float = 0.0
    rest: float = 0.0

    def initialize(self) -> Refusal:
        """Synchronized at the master; may be called again while parameters and inputs still change."""
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.was_active = self.active
        self.start_edge.take_level(self.start)
        self.stop_edge.take_level(self.stop)
        self.set_slave()
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the correction to the present input, the commands, then the path of the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        for section in range(self.master.path.sections):
            self.follow_section(section)
            if section == 0:
                self.obey()
        self.set_slave()
        self.show()
        self.rebase()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """A change of `active`, then start, then stop; each with the master at the path's beginning."""
        if self.was_active and not self.active:
            self.deactivate()
        self.was_active = self.active
        if self.start_edge.try_rise(self.start):
            self.command(True)
        if self.stop_edge.try_rise(self.stop):
            self.command(False)

    def deactivate(self) -> None:
        """All pending commands are completed at once; the slave may jump."""
        if self.has_command():
            starting = self.transition.starting
            self.complete_at(starting, self.transition.commanded_rest())
            if self.stacked:
                self.complete_at(not starting, self.stacked_rest)
        self.stacked = False

    def command(self, starting: bool) -> None:
        """The edge of start or stop. A command that is neither ignored nor refused is taken up or stacked."""
        rest = self.rest if starting else wrap(self.rest_value, self.master.period)
        self.error_id = Fault.NONE
        if not self.active:
            self.complete_at(starting, rest)
        elif self.ignores(starting):
            return
        elif not LEAST_PHASING <= abs(self.output_phasing) <= GREATEST_PHASING:
            self.error_id = Fault.PHASING
        elif not self.has_command():
            self.start_command(starting, self.output_phasing, rest)
        else:
            self.stacked = True
            self.stacked_phasing = self.output_phasing
            self.stacked_rest = rest

    def ignores(self, starting: bool) -> bool:
        """Whether the slave is there already or on its way there, or a command is stacked already."""
        if self.has_command():
            return self.stacked or self.transition.starting == starting
        return self.is_synchronized() == starting

    def has_command(self) -> bool:
        """Whether a command is under way."""
        return self.stage in (Stage.WAITING, Stage.RAMPING)

    def is_synchronized(self) -> bool:
        """Whether the last completed transition was a start; the command under way is always the contrary one."""
        match self.stage:
            case Stage.SYNCHRONIZED:
                return True
            case Stage.RESTING:
                return False
            case _:
                return not self.transition.starting

    def start_command(self, starting: bool, phasing: float, rest: float) -> None:
        """Start a command: it waits for its ramp, if only until the next section of the path."""
        self.transition.command(starting, self.curve, phasing, rest)
        self.local.transition_distance = self.transition.distance
        self.local.peak_acceleration_per_v2 = self.transition.peak_acceleration()
        self.local.peak_jerk_per_v3 = self.transition.peak_jerk()
        self.master.watch_travel()
        self.enter_waiting()

    # --- the path ---

    def follow_section(self, section: int) -> None:
        """Follow a section of the master's path; where a command ends, the stacked one starts."""
        self.master.path.enter(section)
        for _ in range(MOST_EVENTS):
            if not self.try_event():
                break

    def try_event(self) -> bool:
        """Carry out the next event of the stage on what is left of the section; False: there is none."""
        match self.stage:
            case Stage.WAITING:
                return self.try_event_waiting()
            case Stage.RAMPING:
                return self.try_event_ramping()
            case _:
                return False

    def try_event_waiting(self) -> bool:
        """The master comes onto the ramp. A waiting command aims anew wherever the master goes; while it goes against
        the sign of the phasing, it passes the ramp's beginning and nothing starts."""
        path = self.master.path
        is_against = self.master.goes_against(self.transition.direction)
        self.transition.aim(path.end if is_against else path.reached, self.master.period)
        if is_against or not self.transition.is_on_ramp_at(path.end, 0.0):
            return False
        self.enter_ramping()
        return True

    def try_event_ramping(self) -> bool:
        """The end of the ramp; or the master is back before its beginning at the end of the section."""
        end = self.master.path.end
        if self.transition.is_complete_at(end):
            self.complete()
            return True
        if not self.transition.is_on_ramp_at(end, self.master.uncertain_travel()):
            self.transition.aim(end, self.master.period)
            self.enter_waiting()
        return False

    def complete(self) -> None:
        """The command's transition has ended."""
        starting = self.transition.starting
        self.show_ramp()
        self.local.progress = 1.0
        self.master.path.reached = self.transition.direction * self.transition.end
        self.complete_at(starting, self.transition.commanded_rest())
        if self.stacked:
            self.stacked = False
            self.start_command(not starting, self.stacked_phasing, self.stacked_rest if starting else self.rest)

    def complete_at(self, starting: bool, rest: float) -> None:
        """After a start the slave is the master; after a stop it is at rest at `rest`."""
        if starting:
            self.enter_synchronized()
        else:
            self.enter_resting(rest)

    def enter_synchronized(self) -> None:
        self.stage = Stage.SYNCHRONIZED

    def enter_resting(self, rest: float) -> None:
        self.stage = Stage.RESTING
        self.rest = rest

    def enter_waiting(self) -> None:
        self.stage = Stage.WAITING

    def enter_ramping(self) -> None:
        self.stage = Stage.RAMPING

    # --- the outputs ---

    def set_slave(self) -> None:
        """The setpoint that belongs to the master at the end of the step, whose jerk is taken as 0 on the ramp."""
        master = self.master
        if self.stage == Stage.RAMPING and self.transition.is_on_ramp_at(master.end, 0.0):
            position, d1, d2, d3 = self.transition.follow(master.end)
            v, a, j = chain_rule(d1, d2, d3, master.end_velocity, master.end_acceleration)
            self.slave.set(wrap(position, master.period), v, a, j)
        elif self.is_synchronized():
            self.slave.set(master.smoothed_position, master.end_velocity, master.end_acceleration, 0.0)
        else:
            self.slave.set(self.rest, 0.0, 0.0, 0.0)

    def show(self) -> None:
        """Derive all outputs but the slave's setpoint; periods are applied last."""
        ramping = self.stage == Stage.RAMPING
        self.state = self.shown_state()
        self.state_code = self.state
        self.ready = not self.has_command()
        self.synchronized = self.is_synchronized()
        self.syn_synchronized = self.synchronized and not ramping
        self.syn_ramp_on = ramping
        self.status = (1 if self.syn_synchronized else 0) + (2 if ramping else 0)
        self.error = self.error_id != Fault.NONE
        if self.has_command():
            self.show_ramp()
            self.local.progress = self.transition.progress(self.master.end)
            self.local.distance_to_begin = self.transition.distance_to_begin(self.master.end)
            self.local.distance_to_end = self.transition.distance_to_end(self.master.end)
        else:
            self.local.distance_to_begin = 0.0
            self.local.distance_to_end = 0.0

    def shown_state(self) -> State:
        """What becomes of the last command: whether one is under way, and whether another one follows it."""
        if not self.has_command():
            return State.READY
        return State.STACKED if self.stacked else State.EXECUTING

    def show_ramp(self) -> None:
        """Show the position of the command's ramp."""
        self.local.ramp_begin = wrap(self.transition.direction * self.transition.begin, self.master.period)
        self.local.ramp_end = wrap(self.transition.direction * self.transition.end, self.master.period)

    def rebase(self) -> None:
        """Drop whole turns unless the slave is on a ramp, which belongs to a particular turn."""
        if self.stage != Stage.RAMPING:
            self.master.rebase()
