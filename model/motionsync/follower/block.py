"""Follower: a slave that meets the master at given positions cycle after cycle, runs with it, and comes back.

Source: Robox mv_follow2.

Decisions where the source is silent:
- A positioning is taken up wherever the slave stands, also in the middle of a cycle whose master stands, but not in
  M_IN_ALARM: there it is refused and `error_id` keeps the alarm's number. `reset` clears fault 1 in any other state.
- park_slave is read for the way home and by a positioning: the next cycle begins where the slave stands.
- 3, 4 and 5 are judged where a cycle's parameters are read: at its start, at the end of the synchronized phase for
  the way home, and at the park as soon as k, the cycle or a position is such that no start can be told. They are why a
  positioning to the cycle is refused, as fault 1. A meeting of a fixed cycle that leaves no travel for the way home of
  a linear slave is a lack of room, too; one of a variable cycle is dropped.
- R of a cyclic slave is the travel up to the next meeting in a fixed cycle too, so a sync_master that moves between two
  cycles is met. A tight M_f stays until the next way home.
- Standstill is a velocity and acceleration of at most 1e-9. A start is not missed, and a value of a variable cycle is
  not too early, by less than 1e-9 master_cycle, and a limit is exceeded by more than 1e-9 of it only: values that an
  importer computes have rounding errors.
- M_WAITING_NEXT_CYCLE lasts for the last start that was missed or skipped, also while a new meeting is known already.
- A value of a variable cycle that is less than master_cycle after the meeting under way is dropped at its end. Until
  the slave parks, the value of a cycle that was interrupted still counts for a positioning to the cycle. With
  master.period a value means the next occurrence after the instant at which it is set, in [0, period) or not. One that
  comes while skip_next_cycle or sync_assumed holds is not joined.
- Where the master has fallen, within what is allowed, the slave's velocity is 0.
- With neither max_acceleration nor positioning.acceleration an alarm stops the slave at once.
- Levels and sync_master act from the commands of a step on; tunable parameters already act on its seam.
- With master.period the grid of a fixed cycle counts from the turn of the initialization, less whole cycles: a new
  master_cycle counts from a later turn.
- `skip_next_cycle` and `sync_assumed` do not matter to a positioning to the cycle: it leads into the undisturbed one.
"""

from dataclasses import dataclass

from .. import var
from ..grid import floor, nearest, wrap
from ..laws import chain_rule
from ..limits import LEAST_LIMIT, MOST, clamp, usable
from ..master import Master, MasterInput
from ..motion import Motion
from ..slave import Edge, Slave
from ..var import Enumeration, Unit
from .course import LEAST_LENGTH, SAME_PLACE, Course, Settings, Stage
from .faults import Fault, Refusal
from .leg import FAR, Peaks

MOST_CYCLES = 1e6  # of the master in one step
MOST_EVENTS = 10000000  # in one piece of the master's path: no more than 8 a cycle
ARRIVED = 1e-12  # of a period: a value that is less ahead is the one just passed
SAME_POSITION = 1e-12  # u, and of the positions: the slave already stands there
STANDING = 1e-9  # u/s, u/s2: less is rounding of a master that stands
EXCEEDED = 1.0 + 1e-9  # of a limit


class State(Enumeration):
    """What the slave does (the source's phases; -1, 1, 9 and 10 are motionsync's own numbers)"""

    M_IN_ALARM = -1, "it stops or has stopped because of a fault"
    M_IDLE = 1, "it stands, and waits for a positioning"
    M_POSITIONING = 2, "it moves to the park or into the cycle"
    M_WAITING = 3, "at the park, until the way to the next meeting begins"
    M_WAITING_NEXT_CYCLE = 4, "at the park, after a start that was missed or not carried out"
    M_FOLLOWING = 5, "on the way to the meeting"
    M_SYNCHRONIZED = 8, "it runs with the master"
    M_DECEL = 9, "linear slave: it slows down after the synchronized phase, or is held there"
    M_HOMING = 10, "back to the park"


@dataclass(slots=True)
class FollowerSlave(Slave):
    """The slave's setpoint at the end of the step, in slave units."""

    initial_position: float = var.parameter(0.0, "where the slave stands at first", Unit.POSITION, min=-MOST, max=MOST)


@dataclass(slots=True)
class Positioning:
    """Limits of the time-optimal move to the park or into the cycle; read at its command."""

    velocity: float = var.parameter(
        500.0,
        "velocity limit; 0 only where the slave already stands right (velPositSlave)",
        Unit.VELOCITY,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
    )
    acceleration: float = var.parameter(
        5000.0,
        "acceleration limit, also of an alarm's stop without max_acceleration; 0 as for velocity (accPositSlave)",
        Unit.ACCELERATION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
    )
    jerk: float = var.parameter(
        50000.0,
        "jerk limit; 0 as for velocity (jerkPositSlave)",
        Unit.JERK,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
    )

    def allowed(self) -> bool:
        return usable(self.velocity) and usable(self.acceleration) and usable(self.jerk)


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    meeting_known: bool = var.local(False, "there is a meeting under way or ahead")
    meeting_position: float = var.local(0.0, "master position of that meeting; 0: none", Unit.POSITION, discrete=True)
    start_position: float = var.local(
        0.0, "master position where the way to that meeting begins; 0: none", Unit.POSITION, discrete=True
    )
    following_travel: float = var.local(
        0.0, "master travel of the way to that meeting; 0: none", Unit.POSITION, discrete=True
    )
    progress: float = var.local(0.0, "share of the present phase that is done", min=0.0, max=1.0)


@dataclass(slots=True)
class Follower:
    """Meets the master at given positions cycle after cycle, runs with it, and comes back.

    A saw, a welding jaw or a pusher leaves its parking position so that it meets the master at sync_master with the
    slave at sync_slave, runs with k_slave_master times the master's velocity up to sync_out, and comes back to the park
    for the next cycle: backwards (a linear slave), or onwards by slave_cycle (a cyclic one). All these ways are curves
    over the master's position, so the slave is exact whatever the master's speed does; it may stop, but not turn back.

    A cycle of the master has the fixed length master_cycle, or a variable one: then each new value of sync_master is
    the next meeting. Given too late, the slave parks and waits for another one; a cyclic slave may be allowed to
    join the running motion instead.

    Nothing moves before a positioning: position_to_park, or position_to_cycle where the master stands in the middle of
    a cycle. What cannot go on leads to an alarm with a stop ramp; reset and a new positioning go on from there.

    The master's positions and the slave's may be in different units; k_slave_master is in slave units per master unit.
    """

    master: Master = var.part(Master)
    master_cycle: float = var.parameter(
        1000.0,
        "length C of the master's cycle, not 0; of a variable one the least length (masterCycle)",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LENGTH,
        zero=False,
    )
    variable_cycle: bool = var.parameter(
        False, "each new value of sync_master is the next meeting (command bit 16); else one meeting a master_cycle"
    )
    sync_master: float = var.input(
        0.0,
        "where master and slave meet: within the cycle; with variable_cycle absolute (qSyncMaster)",
        Unit.POSITION,
        discrete=True,
    )
    slave_cycle: float = var.parameter(
        0.0,
        "0: a linear slave; else a cyclic one's advance in a cycle (slaveCycle)",
        Unit.SLAVE_POSITION,
        min=0.0,
        max=MOST,
        smallest=LEAST_LENGTH,
    )
    park_slave: float = var.parameter(
        0.0, "where the slave parks (qParkSlave)", Unit.SLAVE_POSITION, tunable=True, min=-MOST, max=MOST
    )
    sync_slave: float = var.parameter(
        100.0,
        "where the slave is at the meeting, beyond park_slave (qSyncSlave)",
        Unit.SLAVE_POSITION,
        tunable=True,
        min=-MOST,
        max=MOST,
    )
    sync_out: float = var.parameter(
        300.0,
        "where the synchronized phase ends, beyond sync_slave; cyclic: before park_slave + slave_cycle (qSyncOut)",
        Unit.SLAVE_POSITION,
        tunable=True,
        min=-MOST,
        max=MOST,
    )
    space_stop_slave: float = var.parameter(
        100.0,
        "braking space of a linear slave after sync_out, not 0 (spaceStopSlave)",
        Unit.SLAVE_POSITION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LENGTH,
        zero=False,
    )
    space_wait_in_park: float = var.parameter(
        0.0, "master travel spent at the park (spaceWaitInPark)", Unit.POSITION, tunable=True, min=0.0, max=MOST
    )
    k_slave_master: float = var.parameter(
        1.0,
        "slave velocity over master velocity while synchronized, not 0 (kSlaveMaster)",
        Unit.SLAVE_PER_MASTER,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
        zero=False,
    )
    align_center: bool = var.parameter(
        False, "sync_master belongs to the middle between sync_slave and sync_out (command bit 19)"
    )
    stop_in_park: bool = var.parameter(True, "a cyclic slave rests at the park in each cycle (command bit 20)")
    recover_late_sync: bool = var.parameter(
        False, "a sync_master set too late is met by joining the running motion, if limits allow it (command bit 21)"
    )
    max_speed: float = var.parameter(
        0.0, "speed limit; 0: none (maxSpe)", Unit.SLAVE_VELOCITY, tunable=True, min=0.0, max=MOST
    )
    max_acceleration: float = var.parameter(
        0.0,
        "acceleration limit, and the deceleration of an alarm's stop; 0: none, and positioning.acceleration (maxAcc)",
        Unit.SLAVE_ACCELERATION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
    )
    check_speed: bool = var.parameter(True, "max_speed is checked (not command bit 17)", tunable=True)
    check_acceleration: bool = var.parameter(True, "max_acceleration is checked (not command bit 18)", tunable=True)
    positioning: Positioning = var.part(Positioning, slave_unit=True)
    position_to_park: bool = var.input(False, "rising edge, at standstill: move to the park (command bit 1)")
    position_to_cycle: bool = var.input(
        False, "rising edge, at standstill: move to where the cycle has the slave, and go on (command bit 2)"
    )
    end_synchronism: bool = var.input(
        False, "rising edge in M_SYNCHRONIZED: the present position is this cycle's sync_out (command bit 3)"
    )
    skip_next_cycle: bool = var.input(False, "while set the slave stays at the park (command bit 0)")
    stop_after_forward: bool = var.input(
        False, "while set a linear slave stays at the end of its forward stroke (command bit 4)"
    )
    sync_assumed: bool = var.input(
        False, "while set sync_master is only assumed: the next meeting is not carried out (command bit 5)"
    )
    reset: bool = var.input(False, "rising edge, at standstill: leave M_IN_ALARM and clear the error")
    slave: FollowerSlave = var.part(
        FollowerSlave, depends={"position": ("slave.initial_position", "slave_cycle")}, slave_unit=True
    )
    state: State = var.output(State.M_IDLE, "what the slave does")
    state_code: int = var.output(1, "the state as a plain integer")
    master_to_start: float = var.output(
        0.0, "master travel missing to the start of the way to the meeting; 0: passed or none known", Unit.POSITION
    )
    master_to_sync: float = var.output(0.0, "master travel missing to the meeting; 0: as above", Unit.POSITION)
    master_to_out: float = var.output(
        0.0, "master travel missing to the end of the synchronized phase; 0: as above", Unit.POSITION
    )
    cycle: int = var.output(0, "cycles completed: counted at the end of the synchronized phase")
    error: bool = var.output(False, "a positioning was refused, or the slave is in M_IN_ALARM")
    error_id: int = var.output(0, "why: 1 positioning refused; 2 to 14 alarms", codes=Fault)
    local: Local = var.part(Local)

    park_edge: Edge = var.part(Edge)
    cycle_edge: Edge = var.part(Edge)
    end_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    skips: bool = False
    assumes: bool = False
    holds: bool = False
    value: float = 0.0
    wanted: bool = False
    wanted_place: float = 0.0
    used: bool = False
    used_place: float = 0.0
    origin: float = 0.0
    missed: bool = False
    barred: float = -FAR
    free: float = 0.0
    now: Settings = var.part(Settings)
    course: Course = var.part(Course)
    sought: Course = var.part(Course)
    peaks: Peaks = var.part(Peaks)
    motion: Motion = var.part(Motion)
    here: float = 0.0
    position: float = 0.0

    def initialize(self) -> Refusal:
        """M_IDLE at slave.initial_position; may be called again while parameters and inputs still change."""
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.read()
        match self.now.fault(self.park_slave):
            case Fault.NONE:
                pass
            case Fault.ORDER:
                return Refusal.ORDER
            case Fault.RATIO:
                return Refusal.RATIO
            case _:
                return Refusal.ROOM_CYCLIC if self.slave_cycle > 0.0 else Refusal.ROOM_LINEAR
        self.course.stage = Stage.IDLE
        self.course.park = wrap(self.slave.initial_position, self.slave_cycle)
        self.park_edge.before = self.position_to_park
        self.cycle_edge.before = self.position_to_cycle
        self.end_edge.before = self.end_synchronism
        self.reset_edge.before = self.reset
        self.origin = 0.0
        self.take_levels()
        self.take_value(self.master.end)
        self.look(0.0, self.master.end, 0.0, 0.0)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the seam to the present input, the commands, then the path of the step."""
        if 0.0 < MOST_CYCLES * self.master_cycle < self.master.longest_travel(h):
            return Refusal.CYCLES
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.read()
        self.travel(0, self.master.path.places[0], self.master.begin)
        self.course.see(self.master.begin)
        self.obey()
        for i in range(1, self.master.path.pieces):
            self.travel(i, self.master.path.places[i], self.master.path.places[i + 1])
        self.motion.advance(h)
        self.look(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.check_limits()
        self.show()
        self.rebase()
        return Refusal.NONE

    def read(self) -> None:
        """The parameters as they are in this step."""
        self.now.cycle = self.master_cycle
        self.now.turn = self.slave_cycle
        self.now.park = self.park_slave
        self.now.sync = self.sync_slave
        self.now.out = self.sync_out
        self.now.stop = self.space_stop_slave
        self.now.wait = self.space_wait_in_park
        self.now.ratio = self.k_slave_master

    # --- the commands ---

    def obey(self) -> None:
        """Levels and the value of sync_master, then the edges in the order of their declaration."""
        self.take_levels()
        if self.sync_master != self.value:
            self.take_value(self.master.begin)
            self.try_to_join(self.master.begin, 0.0)
        if self.course.stage == Stage.HOLDING and not self.holds:
            self.course.release(max(self.master.begin, self.course.largest), self.variable_cycle)
        if self.park_edge.rising(self.position_to_park):
            self.command_to_park()
        if self.cycle_edge.rising(self.position_to_cycle):
            self.command_to_cycle()
        if self.end_edge.rising(self.end_synchronism) and self.course.stage == Stage.SYNCHRONIZED:
            self.error_id = Fault.NONE
            self.course.shorten(max(self.master.begin, self.course.largest))
            self.leave(0.0)
        if self.reset_edge.rising(self.reset):
            self.command_reset()

    def take_levels(self) -> None:
        self.skips = self.skip_next_cycle
        self.assumes = self.sync_assumed
        self.holds = self.stop_after_forward

    def take_value(self, place: float) -> None:
        """A new value of sync_master; with a period its first occurrence ahead of the master's place."""
        self.value = self.sync_master
        self.wanted = True
        self.wanted_place = self.value
        period = self.master.period
        if period > 0.0:
            missing = wrap(self.value, period) - wrap(place, period)
            if missing <= ARRIVED * period:
                missing += period
            self.wanted_place = place + missing

    def command_to_park(self) -> None:
        """To park_slave, of a cyclic slave to its nearest turn."""
        if not (self.stands() and abs(self.park_slave) <= MOST):
            self.refuse()
            return
        if self.move_to(nearest(self.park_slave, self.slave_cycle, self.position)):
            self.course.stage = Stage.TO_PARK
            self.course.park = self.park_slave
            self.course.known = False

    def command_to_cycle(self) -> None:
        """To where the undisturbed cycle has the slave for the master's present position, to go on from there."""
        valued = self.wanted or self.used or not self.variable_cycle
        if not (self.stands() and valued and self.now.fault(self.park_slave) == Fault.NONE):
            self.refuse()
            return
        master = self.master.begin
        self.seek(master)
        target = self.sought.park
        if self.sought.stage != Stage.PARKED:
            target, _, _, _ = self.sought.leg.at(master)
        if self.move_to(nearest(target, self.slave_cycle, self.position)):
            self.course.take(self.sought)
            self.course.stage = Stage.TO_CYCLE
            self.course.watch(master)
            if self.sought.stage == Stage.PARKED and self.sought.known:
                self.wanted_place = self.chosen_place()
                self.wanted = self.variable_cycle
            else:
                self.use_up()

    def seek(self, master: float) -> None:
        """Lay `sought`, the undisturbed cycle at that place of the master."""
        self.sought.wait_at(self.park_slave)
        if self.variable_cycle:
            self.sought.aim(self.now, self.chosen_place() - self.center(), self.now.reach(self.park_slave))
            self.sought.follow()
        else:
            goes_on = self.slave_cycle > 0.0 and not self.stop_in_park
            reach = self.now.steady_reach()
            self.sought.tight = reach < self.now.reach(self.park_slave)
            base = self.base()
            lead = 0.0 if goes_on else reach
            place = base + floor((master + lead - base) / self.now.cycle) * self.now.cycle
            self.sought.aim(self.now, place, reach)
            if goes_on:
                self.sought.meet()
            else:
                self.sought.follow()
        self.sought.locate(self.now, master, self.stop_in_park, self.variable_cycle)

    def chosen_place(self) -> float:
        """Of a variable cycle's last value, be it still to be used or that of the cycle under way."""
        return self.wanted_place if self.wanted else self.used_place

    def move_to(self, target: float) -> bool:
        """Whether the move there can be made; it has no way, and so no limits, where the slave already stands."""
        same = SAME_POSITION * (1.0 + abs(target) + abs(self.position))
        if abs(target - self.position) <= same:
            self.motion.run(target, 0.0)
        elif self.positioning.allowed() and abs(target) <= 2.0 * MOST and abs(self.position) <= 2.0 * MOST:
            acceleration = self.positioning.acceleration
            self.motion.move(
                self.position,
                0.0,
                0.0,
                target,
                self.positioning.velocity,
                acceleration,
                acceleration,
                self.positioning.jerk,
            )
        else:
            self.refuse()
            return False
        self.error_id = Fault.NONE
        return True

    def stands(self) -> bool:
        """Whether a positioning may begin; the slave is looked at as it is at the commands."""
        self.look(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)
        return (
            self.course.stage != Stage.BRAKING
            and max(abs(self.slave.velocity), abs(self.slave.acceleration)) <= STANDING
        )

    def refuse(self) -> None:
        """A positioning; an alarm keeps its own number."""
        if self.course.stage != Stage.BRAKING:
            self.error_id = Fault.POSITIONING

    def command_reset(self) -> None:
        """Leave the alarm at standstill; before, it is ignored."""
        if self.course.stage == Stage.BRAKING:
            self.look(0.0, self.master.begin, 0.0, 0.0)
            if self.slave.velocity != 0.0:
                return
            self.course.stage = Stage.IDLE
            self.course.park = wrap(self.position, self.slave_cycle)
        self.error_id = Fault.NONE

    # --- the way of the step ---

    def travel(self, piece: int, begin: float, end: float) -> None:
        """A monotone piece of the master's path, 0 being the input correction: one event after the other."""
        self.here = begin
        for _ in range(MOST_EVENTS):
            more = False
            match self.course.stage:
                case Stage.IDLE | Stage.BRAKING:
                    pass
                case Stage.TO_PARK | Stage.TO_CYCLE:
                    more = self.move_on(piece, end)
                case Stage.PARKED:
                    more = self.wait(piece, end)
                case _:
                    more = self.go_along(piece, end)
            if not more:
                break

    def crossing(self, piece: int, place: float) -> float:
        """When the piece passes the place, s since the step's beginning; the seam takes no time."""
        return self.master.path.crossing(piece, place)

    def move_on(self, piece: int, end: float) -> bool:
        """A positioning: whether it ends in this piece. Into the cycle, the master has to stand meanwhile."""
        first = self.master.path.times[piece]
        last = self.master.path.times[piece + 1]
        ends = self.motion.over(self.motion.clock.time + last)
        arrival = clamp(self.motion.end() - self.motion.clock.time, first, last)
        slack = self.course.slack
        if self.course.stage == Stage.TO_CYCLE and abs(end - self.course.largest) > slack:
            limit = self.course.largest + (slack if end > self.course.largest else -slack)
            moved = self.crossing(piece, limit)
            if not (ends and arrival <= moved):
                self.alarm(Fault.MASTER_MOVED, moved, limit)
                return False
        if not ends:
            return False
        if piece > 0 and arrival > first:
            place = end if arrival >= last else self.master.path.position(arrival)
            self.here = clamp(place, min(self.here, end), max(self.here, end))
        self.missed = False
        self.barred = -FAR
        if self.course.stage == Stage.TO_PARK:
            self.course.wait_at(self.course.park)
            self.used = False
        else:
            self.course.stage = self.sought.stage
            self.used = self.used and self.course.stage != Stage.PARKED
        return True

    def wait(self, piece: int, end: float) -> bool:
        """At the park: whether a cycle starts in this piece, or is not carried out. A master that goes back is followed
        by the choice of the meeting only."""
        falling = end < self.here
        place = end if falling else self.here
        if not self.choose(piece, place):
            return self.course.stage != Stage.PARKED
        if falling:
            return False
        if self.course.known and end >= self.course.start():
            self.start(piece)
            return True
        if self.missed and end >= self.free:
            self.missed = False
            self.barred = -FAR
        return False

    def choose(self, piece: int, place: float) -> bool:
        """The meeting to wait for, with the parameters of this step; False if the slave has left the park instead: for
        an alarm, or to join a late meeting."""
        if not self.now.startable():
            self.alarm(self.now.fault(self.course.park), self.crossing(piece, place), place)
            return False
        if self.variable_cycle:
            return self.choose_wanted(piece, place)
        self.choose_next(place)
        return True

    def reach(self) -> float:
        """M_f from where the slave is parked."""
        return self.course.reach if self.course.tight else self.now.reach(self.course.park)

    def choose_next(self, place: float) -> None:
        """Fixed cycle: the first meeting whose start is not behind the master."""
        cycle = self.now.cycle
        reach = self.reach()
        base = self.base()
        least = max(place - SAME_PLACE * cycle + reach, self.barred)
        meeting = base - floor((base - least) / cycle) * cycle
        self.course.aim(self.now, meeting, reach)

    def choose_wanted(self, piece: int, place: float) -> bool:
        """Variable cycle: the value that was set, unless its start is behind the master."""
        self.course.known = False
        if not self.wanted:
            return True
        reach = self.reach()
        meeting = self.wanted_place - self.center()
        if meeting - reach >= place - SAME_PLACE * self.now.cycle:
            self.course.aim(self.now, meeting, reach)
            return True
        if self.try_to_join(place, self.crossing(piece, place)):
            self.here = place
            return False
        self.wanted = False
        self.miss(place, meeting, reach, -FAR)
        return True

    def miss(self, place: float, meeting: float, reach: float, barred: float) -> None:
        """The start to that meeting is missed or not carried out: M_WAITING_NEXT_CYCLE up to the next one less the
        wait, if that lies ahead; no meeting of a fixed cycle before `barred`."""
        free = meeting + self.now.cycle - reach - self.now.waiting()
        if free > place:
            self.missed = True
            self.free = free
        self.barred = barred

    def start(self, piece: int) -> None:
        """The master is where the way to the meeting begins."""
        place = self.course.start()
        meeting = self.course.place
        fault = self.now.fault(self.course.park)
        if self.skips or self.assumes:
            if not meeting + self.now.cycle > meeting:  # rounding would let the same start come for ever
                self.alarm(Fault.NO_ROOM, self.crossing(piece, place), place)
                return
            self.here = max(self.here, place)
            self.miss(self.here, meeting, self.course.reach, meeting + 0.5 * self.now.cycle)
            self.wanted = False
            self.course.known = False
        elif fault != Fault.NONE:
            self.alarm(fault, self.crossing(piece, place), place)
        else:
            self.use_up()
            self.course.follow()

    def use_up(self) -> None:
        """The value of a variable cycle is that of the cycle which now runs."""
        if self.wanted:
            self.used = True
            self.used_place = self.wanted_place
        self.wanted = False

    def try_to_join(self, place: float, time: float) -> bool:
        """A value of a variable cycle that comes too late for a cyclic slave which does not park: a quintic from the
        motion under way to the meeting, if it keeps the limits at the master's present velocity."""
        if not self.may_join():
            return False
        park = self.course.stage == Stage.PARKED
        begin = place if park else max(place, self.course.largest)
        meeting = self.wanted_place - self.center()
        slack = SAME_PLACE * self.now.cycle
        if meeting <= begin + slack or (park and meeting - self.reach() >= begin - slack):
            return False
        self.sought.take(self.course)
        self.sought.join(self.now, begin, meeting)
        if not self.keeps_limits(abs(self.master.velocity_at(time))):
            return False
        self.course.take(self.sought)
        self.use_up()
        return True

    def may_join(self) -> bool:
        """Whether there is a value, and a slave that may join at all."""
        late = self.course.stage in (Stage.HOMING, Stage.PARKED) and self.wanted
        cyclic = self.slave_cycle > 0.0 and not self.stop_in_park
        may = self.variable_cycle and self.recover_late_sync and not (self.skips or self.assumes)
        return late and cyclic and may and self.now.fault(self.course.park) == Fault.NONE

    def keeps_limits(self, speed: float) -> bool:
        """Whether the curve just sought keeps what is checked, at that velocity of the master."""
        self.peaks.measure(self.sought.leg.quintic)
        if self.exceeds(self.check_speed, self.peaks.slope * speed, self.max_speed):
            return False
        return not self.exceeds(self.check_acceleration, self.peaks.curvature * speed * speed, self.max_acceleration)

    def exceeds(self, checked: bool, size: float, limit: float) -> bool:
        return checked and limit > 0.0 and size > limit * EXCEEDED

    def go_along(self, piece: int, end: float) -> bool:
        """A phase of the cycle: whether it ends in this piece."""
        least = (self.course.peak if piece > 0 else self.course.given) - self.course.slack
        guessed = piece > 0 and self.master.input_mode == MasterInput.POSITION_ONLY
        if end < least and not guessed:
            self.alarm(Fault.MASTER_BACKWARDS, self.crossing(piece, least), least)
            return False
        if end < self.course.leg.end:
            self.course.largest = max(self.course.largest, end)
            if piece > 0:
                self.course.peak = max(self.course.peak, end)
            return False
        time = self.crossing(piece, self.course.leg.end)
        self.here = self.course.leg.end
        match self.course.stage:
            case Stage.FOLLOWING:
                self.course.meet()
            case Stage.SLOWING:
                self.course.pause()
            case Stage.PAUSING:
                self.course.speed_up(self.slave_cycle)
            case Stage.SYNCHRONIZED:
                self.leave(time)
            case Stage.DECEL:
                if self.holds:
                    self.course.hold()
                else:
                    self.course.return_home(self.course.leg.end, self.course.pace)
            case _:
                self.course.stage = Stage.PARKED
                self.missed = False
                self.barred = -FAR
                self.used = False
        return True

    def leave(self, time: float) -> None:
        """The synchronized phase is over: the next meeting is chosen, and the way there."""
        self.cycle += 1
        place = self.course.leg.end
        fault = self.now.fault(self.park_slave)
        if fault == Fault.NONE:
            fault = self.leave_variable() if self.variable_cycle else self.leave_fixed()
        if fault != Fault.NONE:
            self.alarm(fault, time, place)

    def leave_fixed(self) -> Fault:
        """To the first meeting that is half a cycle ahead, or more."""
        base = self.base()
        least = self.course.place + (0.5 - SAME_PLACE) * self.now.cycle
        meeting = base - floor((base - least) / self.now.cycle) * self.now.cycle
        return self.course.leave(self.now, meeting, True, self.stop_in_park or self.skips or self.assumes)

    def leave_variable(self) -> Fault:
        """To the value that was set if it is at least a cycle ahead and there is room; else home, and it is dropped."""
        assumed = self.course.place + self.now.cycle
        meeting = self.wanted_place - self.center()
        if self.wanted and meeting >= assumed - SAME_PLACE * self.now.cycle:
            home = self.stop_in_park or self.skips or self.assumes
            if self.course.leave(self.now, meeting, True, home) == Fault.NONE:
                if self.course.stage in (Stage.FOLLOWING, Stage.SLOWING):
                    self.use_up()
                return Fault.NONE
        self.wanted = False
        return self.course.leave(self.now, assumed, False, True)

    def base(self) -> float:
        """Where the meetings of a fixed cycle are, but for whole cycles."""
        return self.origin + self.sync_master - self.center()

    def center(self) -> float:
        """How much earlier than at sync_master the meeting is."""
        return self.now.half() if self.align_center else 0.0

    # --- alarms ---

    def check_limits(self) -> None:
        """At the end of the step, on what is about to be put out."""
        at = -1
        match self.course.stage:
            case Stage.FOLLOWING | Stage.SLOWING | Stage.PAUSING:
                at = 0
            case Stage.SYNCHRONIZED:
                at = 1
            case Stage.DECEL | Stage.HOLDING:
                at = 2
            case Stage.HOMING:
                at = 3
            case _:
                pass
        if at >= 0 and self.exceeds(self.check_speed, abs(self.slave.velocity), self.max_speed):
            self.brake(Fault.SPEED_FOLLOWING + at)
        elif at >= 0 and self.exceeds(self.check_acceleration, abs(self.slave.acceleration), self.max_acceleration):
            self.brake(Fault.ACCELERATION_FOLLOWING + at)

    def alarm(self, fault: Fault, time: float, place: float) -> None:
        """Within the step, with the master at that place."""
        velocity = self.master.velocity_at(time)
        self.look(time, place, velocity, 0.0)
        self.brake(fault)
        self.motion.clock.start(time)

    def brake(self, fault: int) -> None:
        """The linear stop ramp from the state just looked at."""
        self.error_id = fault
        self.course.stage = Stage.BRAKING
        self.course.known = False
        deceleration = self.max_acceleration if usable(self.max_acceleration) else self.positioning.acceleration
        velocity = self.slave.velocity
        if velocity == 0.0 or not usable(deceleration):
            self.motion.run(self.position, 0.0)
            return
        self.motion.begin(self.position, velocity, -deceleration if velocity > 0.0 else deceleration)
        self.motion.extend(abs(velocity) / deceleration, 0.0, 0.0)
        self.motion.velocities[self.motion.pieces - 1] = 0.0

    # --- the state at an instant ---

    def look(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """The slave's state at a time since the step's beginning, with the master there and moving so. The chain rule
        takes the master's jerk as 0; where the master has fallen it counts as standing at its greatest position."""
        match self.course.stage:
            case Stage.IDLE | Stage.PARKED:
                self.put(self.course.park, 0.0, 0.0, 0.0)
            case Stage.TO_PARK | Stage.TO_CYCLE | Stage.BRAKING:
                position, v, a, j = self.motion.at(self.motion.clock.time + time)
                self.put(position, v, a, j)
            case _:
                position, slope, curvature, twist = self.course.leg.at(max(place, self.course.largest))
                v, a, j = chain_rule(slope, curvature, twist, max(velocity, 0.0), acceleration)
                self.put(position, v, a, j)

    def put(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        self.position = position
        self.slave.put(wrap(position, self.slave_cycle), velocity, acceleration, jerk)

    # --- what is put out ---

    def show(self) -> None:
        self.tell_state()
        self.state_code = self.state
        self.error = self.error_id != Fault.NONE
        self.tell_meeting()

    def tell_state(self) -> None:
        match self.course.stage:
            case Stage.IDLE:
                self.state = State.M_IDLE
            case Stage.TO_PARK | Stage.TO_CYCLE:
                self.state = State.M_POSITIONING
            case Stage.PARKED:
                self.state = State.M_WAITING_NEXT_CYCLE if self.missed else State.M_WAITING
            case Stage.FOLLOWING | Stage.SLOWING | Stage.PAUSING:
                self.state = State.M_FOLLOWING
            case Stage.SYNCHRONIZED:
                self.state = State.M_SYNCHRONIZED
            case Stage.DECEL | Stage.HOLDING:
                self.state = State.M_DECEL
            case Stage.HOMING:
                self.state = State.M_HOMING
            case _:
                self.state = State.M_IN_ALARM

    def tell_meeting(self) -> None:
        """Distances to the meeting under way or, after it, to the next one."""
        stage = self.course.stage
        in_cycle = stage not in (Stage.IDLE, Stage.TO_PARK, Stage.TO_CYCLE, Stage.BRAKING)
        known = in_cycle and self.course.known
        place = self.course.place
        if self.variable_cycle and stage in (Stage.DECEL, Stage.HOLDING, Stage.HOMING):
            known = self.wanted  # whether it will be in time or not
            place = self.wanted_place - (0.5 * self.course.synchronous() if self.align_center else 0.0)
        self.local.meeting_known = known
        if known:
            start = place - self.course.reach
            self.master_to_start = max(start - self.master.end, 0.0)
            self.master_to_sync = max(place - self.master.end, 0.0)
            self.master_to_out = max(place + self.course.synchronous() - self.master.end, 0.0)
            self.local.meeting_position = wrap(place, self.master.period)
            self.local.start_position = wrap(start, self.master.period)
            self.local.following_travel = self.course.reach
        else:
            self.master_to_start = 0.0
            self.master_to_sync = 0.0
            self.master_to_out = 0.0
            self.local.meeting_position = 0.0
            self.local.start_position = 0.0
            self.local.following_travel = 0.0
        moves = in_cycle and stage != Stage.PARKED
        self.local.progress = self.course.leg.progress(self.master.end) if moves else 0.0

    def rebase(self) -> None:
        """Drop whole turns of the master, from all its positions."""
        before = self.master.end
        self.master.rebase()
        turned = before - self.master.end
        if turned != 0.0:
            self.course.shift(turned)
            self.wanted_place -= turned
            self.used_place -= turned
            self.barred -= turned
            self.free -= turned
            origin = self.origin - turned
            self.origin = wrap(origin, self.master_cycle) if usable(self.master_cycle) else origin
