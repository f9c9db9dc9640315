"""Follower: a slave that meets the master at given positions cycle after cycle, runs with it, and comes back.

Source: Robox mv_follow2; what is decided where it is silent stands in README.md.
"""

from dataclasses import dataclass

from .. import var
from ..grid import first_at_or_after, floor, nearest, wrap
from ..laws import chain_rule
from ..limits import MOST, clamp, usable
from ..master import MasterInput
from ..motion import Motion
from ..slave import Edge
from .cam_section import FAR, Peaks
from .cycle import CycleState
from .faults import Fault, Refusal
from .interface import FollowerInterface
from .parameters import (
    SAME_PLACE,
    half_synchronous_travel,
    parameter_fault,
    ramp_travel,
    start_computable,
    steady_approach_travel,
    wait_travel,
)
from .stages import Stage, acceleration_fault, shown_state, speed_fault

MOST_CYCLES = 1e6  # of the master: a step over more of them is refused
MOST_EVENTS = 10000000  # in one piece of the master's path; a cycle has no more than 8
ARRIVED = 1e-12  # of a period: a value of sync_master that lies less ahead than this has just been passed
SAME_POSITION = 1e-12  # u, and of the positions: a slave that is no further away already stands there
STANDING = 1e-9  # u/s, u/s2: the slave of a master that stands has no more, by rounding
EXCEEDED = 1.0 + 1e-9  # of a limit: a value up to here keeps the limit, but for rounding


@dataclass(slots=True)
class Follower(FollowerInterface):
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

    park_edge: Edge = var.part(Edge)
    cycle_edge: Edge = var.part(Edge)
    end_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    stay_at_park: bool = False  # skip_next_cycle or sync_assumed, as read at the commands of the last step
    stay_forward: bool = False  # stop_after_forward, as read there
    last_value: float = 0.0  # sync_master, as read there
    new_value: bool = False  # sync_master has a value that no variable cycle has used yet
    new_value_at: float = 0.0  # the master position, unwrapped, that the new value means
    value_in_use: bool = False  # the variable cycle under way has its meeting from a value of sync_master
    value_in_use_at: float = 0.0  # the master position, unwrapped, that this value means
    turn_origin: float = 0.0  # the master position from which the meetings of a fixed cycle count
    current: CycleState = var.part(CycleState)  # the stage of the slave, and the cycle that it carries out
    candidate: CycleState = var.part(CycleState)  # a cycle that the slave may join, or is being positioned to
    peaks: Peaks = var.part(Peaks)
    motion: Motion = var.part(Motion)
    reached: float = 0.0  # how far the master has come in the piece whose events are being carried out
    unwrapped: float = 0.0  # the slave's position before it is wrapped into slave_cycle

    def initialize(self) -> Refusal:
        """M_IDLE at slave.initial_position; may be called again while parameters and inputs still change."""
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        match parameter_fault(self, self.park_slave):
            case Fault.NONE:
                pass
            case Fault.ORDER:
                return Refusal.ORDER
            case Fault.RATIO:
                return Refusal.RATIO
            case _:
                return Refusal.ROOM_CYCLIC if self.slave_cycle > 0.0 else Refusal.ROOM_LINEAR
        self.current.enter_idle(wrap(self.slave.initial_position, self.slave_cycle))
        self.park_edge.hold(self.position_to_park)
        self.cycle_edge.hold(self.position_to_cycle)
        self.end_edge.hold(self.end_synchronism)
        self.reset_edge.hold(self.reset)
        self.turn_origin = 0.0
        self.read_levels()
        self.note_new_value(self.master.end)
        self.set_slave_at(0.0, self.master.end, 0.0, 0.0)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the master's path."""
        if 0.0 < MOST_CYCLES * self.master_cycle < self.master.longest_travel(h):
            return Refusal.CYCLES
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(0)
        self.current.note_input(self.master.begin)
        self.obey()
        for piece in range(1, self.master.path.pieces):
            self.travel(piece)
        self.motion.advance(h)
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.check_limits()
        self.show()
        self.rebase()
        return Refusal.NONE

    # --- the commands, which act at the master's present input ---

    def obey(self) -> None:
        """Carry out the levels and the value of sync_master, then the edges in the order of their declaration."""
        self.read_levels()
        if self.sync_master != self.last_value:
            self.note_new_value(self.master.begin)
            self.try_join(self.master.begin, 0.0)
        if self.current.stage == Stage.HOLDING and not self.stay_forward:
            self.current.release(max(self.master.begin, self.current.highest), self.variable_cycle)
        if self.park_edge.try_rise(self.position_to_park):
            self.command_to_park()
        if self.cycle_edge.try_rise(self.position_to_cycle):
            self.command_to_cycle()
        if self.end_edge.try_rise(self.end_synchronism) and self.current.stage == Stage.SYNCHRONIZED:
            self.error_id = Fault.NONE
            self.current.end_synchronized_at(max(self.master.begin, self.current.highest))
            self.leave_synchronized(0.0)
        if self.reset_edge.try_rise(self.reset):
            self.command_reset()

    def read_levels(self) -> None:
        """The levels act from here on; the input correction of the next step still acts with these."""
        self.stay_at_park = self.skip_next_cycle or self.sync_assumed
        self.stay_forward = self.stop_after_forward

    def note_new_value(self, master: float) -> None:
        """sync_master has a new value; with a period it means the first occurrence ahead of the master's position."""
        self.last_value = self.sync_master
        self.new_value = True
        self.new_value_at = self.sync_master
        period = self.master.period
        if period > 0.0:
            travel = wrap(self.sync_master, period) - wrap(master, period)
            if travel <= ARRIVED * period:
                travel += period
            self.new_value_at = master + travel

    def use_new_value(self) -> None:
        """The new value of a variable cycle becomes that of the cycle which begins."""
        if self.new_value:
            self.value_in_use = True
            self.value_in_use_at = self.new_value_at
        self.new_value = False

    def command_to_park(self) -> None:
        """Move to park_slave, of a cyclic slave to its nearest turn."""
        self.set_slave_at_input()
        if not (self.positionable() and abs(self.park_slave) <= MOST):
            self.refuse()
        elif self.try_move_to(nearest(self.park_slave, self.slave_cycle, self.unwrapped)):
            self.current.enter_to_park(self.park_slave)

    def command_to_cycle(self) -> None:
        """Move to where the undisturbed cycle has the slave for the master's present position, to go on from there."""
        self.set_slave_at_input()
        valued = self.new_value or self.value_in_use or not self.variable_cycle
        if not (self.positionable() and valued and parameter_fault(self, self.park_slave) == Fault.NONE):
            self.refuse()
            return
        master = self.master.begin
        self.lay_undisturbed_cycle(master)
        parked = self.candidate.parked()
        target = self.candidate.park
        if not parked:
            target, _, _, _ = self.candidate.section.at(master)
        if self.try_move_to(nearest(target, self.slave_cycle, self.unwrapped)):
            var.copy(self.current, self.candidate)
            self.current.enter_to_cycle()
            self.current.watch_from(master)
            if parked and self.candidate.meeting_known:
                self.new_value_at = self.chosen_value()
                self.new_value = self.variable_cycle
            else:
                self.use_new_value()

    def lay_undisturbed_cycle(self, master: float) -> None:
        """`candidate` becomes the undisturbed cycle with the master at that position."""
        self.candidate.rest_at(self.park_slave)
        if self.variable_cycle:
            meeting = self.chosen_value() - self.lead()
            self.candidate.aim(self, meeting, ramp_travel(self, self.park_slave))
            self.candidate.follow()
        else:
            passes = self.slave_cycle > 0.0 and not self.stop_in_park
            approach = steady_approach_travel(self)
            self.candidate.tight = approach < ramp_travel(self, self.park_slave)
            origin = self.meeting_origin()
            ahead = 0.0 if passes else approach
            cycles = floor((master + ahead - origin) / self.master_cycle)
            self.candidate.aim(self, origin + cycles * self.master_cycle, approach)
            if passes:
                self.candidate.enter_synchronized()
            else:
                self.candidate.follow()
        self.candidate.go_to(self, master)

    def chosen_value(self) -> float:
        """Where the last value of a variable cycle lies, be it new or that of the cycle under way."""
        return self.new_value_at if self.new_value else self.value_in_use_at

    def positionable(self) -> bool:
        """Whether a positioning may begin: the slave stands, and there is no alarm."""
        moving = max(abs(self.slave.velocity), abs(self.slave.acceleration))
        return self.current.stage != Stage.BRAKING and moving <= STANDING

    def try_move_to(self, target: float) -> bool:
        """Begin the move to a position, or refuse it. A slave that already stands there needs no limits."""
        same = SAME_POSITION * (1.0 + abs(target) + abs(self.unwrapped))
        if abs(target - self.unwrapped) <= same:
            self.motion.run(target, 0.0)
        elif self.positioning.limits_usable() and abs(target) <= 2.0 * MOST and abs(self.unwrapped) <= 2.0 * MOST:
            speed = self.positioning.velocity
            acceleration = self.positioning.acceleration
            jerk = self.positioning.jerk
            self.motion.move(self.unwrapped, 0.0, 0.0, target, speed, acceleration, acceleration, jerk)
        else:
            self.refuse()
            return False
        self.error_id = Fault.NONE
        return True

    def refuse(self) -> None:
        """Refuse a positioning; an alarm keeps its own number."""
        if self.current.stage != Stage.BRAKING:
            self.error_id = Fault.POSITIONING

    def command_reset(self) -> None:
        """Clear the error. An alarm ends where the slave stands; before, it is not cleared."""
        if self.current.stage == Stage.BRAKING:
            self.set_slave_at_input()
            if self.slave.velocity != 0.0:
                return
            self.current.enter_idle(wrap(self.unwrapped, self.slave_cycle))
        self.error_id = Fault.NONE

    # --- the master's path: one method a stage ---

    def travel(self, piece: int) -> None:
        """Carry out the events in a monotone piece of the master's path; piece 0 is the input correction."""
        self.reached = self.master.path.places[piece]
        end = self.master.path.places[piece + 1]
        for _ in range(MOST_EVENTS):
            if not self.try_event(piece, end):
                break

    def try_event(self, piece: int, end: float) -> bool:
        """Carry out the stage's next event before the piece ends at `end`; False: nothing more happens in the piece."""
        happened = False
        match self.current.stage:
            case Stage.TO_PARK:
                happened = self.try_event_to_park(piece, end)
            case Stage.TO_CYCLE:
                happened = self.try_event_to_cycle(piece, end)
            case Stage.WAITING:
                happened = self.try_event_waiting(piece, end)
            case Stage.WAITING_NEXT_CYCLE:
                happened = self.try_event_waiting_next_cycle(piece, end)
            case Stage.FOLLOWING:
                happened = self.try_event_following(piece, end)
            case Stage.SLOWING:
                happened = self.try_event_slowing(piece, end)
            case Stage.PAUSING:
                happened = self.try_event_pausing(piece, end)
            case Stage.SYNCHRONIZED:
                happened = self.try_event_synchronized(piece, end)
            case Stage.DECEL:
                happened = self.try_event_decel(piece, end)
            case Stage.HOLDING:
                happened = self.try_event_holding(piece, end)
            case Stage.HOMING:
                happened = self.try_event_homing(piece, end)
            case _:  # IDLE and BRAKING, which commands alone end
                pass
        return happened

    def try_event_to_park(self, piece: int, end: float) -> bool:
        """The slave arrives at the park, whatever the master does."""
        if not self.arrives(piece):
            return False
        self.go_to_arrival(piece, end)
        self.current.rest_at(self.current.park)
        self.value_in_use = False
        return True

    def try_event_to_cycle(self, piece: int, end: float) -> bool:
        """The slave arrives in the cycle. A master that has moved before is an alarm."""
        moved = abs(end - self.current.highest)
        tolerance = self.current.backward_tolerance
        if moved > tolerance:
            limit = self.current.highest + (tolerance if end > self.current.highest else -tolerance)
            time = self.master.path.crossing(piece, limit)
            if not (self.arrives(piece) and self.arrival(piece) <= time):
                self.alarm(Fault.MASTER_MOVED, time, limit)
                return False
        if not self.arrives(piece):
            return False
        self.go_to_arrival(piece, end)
        self.current.enter_cycle(self.candidate.stage)
        self.value_in_use = self.value_in_use and not self.current.parked()
        return True

    def try_event_waiting(self, piece: int, end: float) -> bool:
        """A cycle starts, or its start is missed or not carried out.

        Where the master goes back, the meeting is chosen anew, and nothing starts."""
        falling = end < self.reached
        place = end if falling else self.reached
        if self.try_choose_meeting(piece, place):
            return True
        if falling or not (self.current.meeting_known and end >= self.current.start()):
            return False
        self.start_cycle(piece)
        return True

    def try_event_waiting_next_cycle(self, piece: int, end: float) -> bool:
        """As WAITING; and the cycle whose start was missed is over, which is the last event of the piece."""
        if self.try_event_waiting(piece, end):
            return True
        if self.reached <= end and self.current.next_cycle_from <= end:
            self.current.enter_waiting()
        return False

    def try_event_following(self, piece: int, end: float) -> bool:
        """The meeting."""
        if not self.try_end_section(piece, end):
            return False
        self.current.enter_synchronized()
        return True

    def try_event_slowing(self, piece: int, end: float) -> bool:
        """The intermediate stop."""
        if not self.try_end_section(piece, end):
            return False
        self.current.enter_pausing()
        return True

    def try_event_pausing(self, piece: int, end: float) -> bool:
        """The ramp up to the meeting begins."""
        if not self.try_end_section(piece, end):
            return False
        self.current.speed_up(self.slave_cycle)
        return True

    def try_event_synchronized(self, piece: int, end: float) -> bool:
        """The slave is at sync_out."""
        if not self.try_end_section(piece, end):
            return False
        self.leave_synchronized(self.master.path.crossing(piece, self.reached))
        return True

    def try_event_decel(self, piece: int, end: float) -> bool:
        """The end of the forward stroke: the slave is held there, or goes home."""
        if not self.try_end_section(piece, end):
            return False
        if self.stay_forward:
            self.current.enter_holding()
        else:
            self.current.return_home(self.reached, self.current.return_travel)
        return True

    def try_event_holding(self, piece: int, end: float) -> bool:
        """No event: a command ends the hold. A master that goes back is an alarm here too."""
        return self.try_end_section(piece, end)

    def try_event_homing(self, piece: int, end: float) -> bool:
        """The slave arrives at the park."""
        if not self.try_end_section(piece, end):
            return False
        self.current.enter_waiting()
        self.value_in_use = False
        return True

    # --- what several stages have in common ---

    def arrives(self, piece: int) -> bool:
        """Whether a positioning ends in the piece."""
        return self.motion.over(self.motion.clock.time + self.master.path.times[piece + 1])

    def arrival(self, piece: int) -> float:
        """The time since the step's beginning at which a positioning ends, within the piece."""
        times = self.master.path.times
        return clamp(self.motion.end() - self.motion.clock.time, times[piece], times[piece + 1])

    def go_to_arrival(self, piece: int, end: float) -> None:
        """The master has reached the place where a positioning ends."""
        arrival = self.arrival(piece)
        if arrival > self.master.path.times[piece]:
            place = end if arrival >= self.master.path.times[piece + 1] else self.master.path.position(arrival)
            self.reached = clamp(place, min(self.reached, end), max(self.reached, end))

    def try_end_section(self, piece: int, end: float) -> bool:
        """Go to the end of the cam section; False: it is beyond the piece. A master that goes back is an alarm.

        In mode POSITION_ONLY the path inside the step is a guess, so the inputs alone are judged."""
        highest = self.current.highest_in_step if piece > 0 else self.current.highest_input
        least = highest - self.current.backward_tolerance
        guessed = piece > 0 and self.master.input_mode == MasterInput.POSITION_ONLY
        if end < least and not guessed:
            self.alarm(Fault.MASTER_BACKWARDS, self.master.path.crossing(piece, least), least)
            return False
        if end < self.current.section.end:
            self.current.highest = max(self.current.highest, end)
            self.current.highest_in_step = max(self.current.highest_in_step, end)
            return False
        self.reached = self.current.section.end
        return True

    # --- at the park ---

    def try_choose_meeting(self, piece: int, place: float) -> bool:
        """Choose the meeting to wait for, with the parameters of this step.

        True: something else has happened. The slave has left the park, for an alarm or to join a late meeting; or the
        start of a meeting is missed."""
        if not start_computable(self):
            fault = parameter_fault(self, self.current.park)
            self.alarm(fault, self.master.path.crossing(piece, place), place)
            return True
        if self.variable_cycle:
            return self.try_choose_value(piece, place)
        self.choose_next(place)
        return False

    def approach_travel(self) -> float:
        """M_f from where the slave is parked."""
        return self.current.approach_travel if self.current.tight else ramp_travel(self, self.current.park)

    def choose_next(self, place: float) -> None:
        """Fixed cycle: choose the first meeting whose start is not behind the master."""
        cycle = self.master_cycle
        approach = self.approach_travel()
        origin = self.meeting_origin()
        least = max(place - SAME_PLACE * cycle + approach, self.current.no_meeting_before)
        meeting = first_at_or_after(origin, cycle, least)
        self.current.aim(self, meeting, approach)

    def try_choose_value(self, piece: int, place: float) -> bool:
        """Variable cycle: choose the new value, unless its start is behind the master."""
        self.current.meeting_known = False
        if not self.new_value:
            return False
        approach = self.approach_travel()
        meeting = self.new_value_at - self.lead()
        if meeting - approach >= place - SAME_PLACE * self.master_cycle:
            self.current.aim(self, meeting, approach)
            return False
        if self.try_join(place, self.master.path.crossing(piece, place)):
            self.reached = place
        else:
            self.new_value = False
            self.miss(place, meeting, approach, -FAR)
        return True

    def miss(self, place: float, meeting: float, approach: float, no_meeting_before: float) -> None:
        """The start to that meeting is missed or not carried out. M_WAITING_NEXT_CYCLE lasts up to the start one cycle
        later, less the wait, if that is still ahead."""
        until = meeting + self.master_cycle - approach - wait_travel(self)
        if until > place:
            self.current.enter_waiting_next_cycle(until)
        self.current.no_meeting_before = no_meeting_before

    def start_cycle(self, piece: int) -> None:
        """The master is where the way to the meeting begins."""
        place = self.current.start()
        meeting = self.current.meeting
        fault = parameter_fault(self, self.current.park)
        if self.stay_at_park:
            if not meeting + self.master_cycle > meeting:  # rounding would let the same start come for ever
                self.alarm(Fault.NO_ROOM, self.master.path.crossing(piece, place), place)
                return
            self.reached = max(self.reached, place)
            self.miss(self.reached, meeting, self.current.approach_travel, meeting + 0.5 * self.master_cycle)
            self.new_value = False
            self.current.meeting_known = False
        elif fault != Fault.NONE:
            self.alarm(fault, self.master.path.crossing(piece, place), place)
        else:
            self.use_new_value()
            self.current.follow()

    # --- late values ---

    def try_join(self, place: float, time: float) -> bool:
        """Join a meeting whose value comes too late: a quintic from the motion under way, if it keeps the limits at the
        master's present velocity. Only a cyclic slave that does not park may do so."""
        if not self.may_join():
            return False
        parked = self.current.parked()
        begin = place if parked else max(place, self.current.highest)
        meeting = self.new_value_at - self.lead()
        tolerance = SAME_PLACE * self.master_cycle
        in_time = parked and meeting - self.approach_travel() >= begin - tolerance
        if meeting <= begin + tolerance or in_time:
            return False
        var.copy(self.candidate, self.current)
        self.candidate.join(self, begin, meeting)
        self.peaks.measure(self.candidate.section.quintic)
        if not self.peaks_allowed(abs(self.master.velocity_at(time))):
            return False
        var.copy(self.current, self.candidate)
        self.use_new_value()
        return True

    def may_join(self) -> bool:
        """Whether there is a new value, and a slave that may join its meeting late."""
        late = (self.current.parked() or self.current.stage == Stage.HOMING) and self.new_value
        cyclic = self.slave_cycle > 0.0 and not self.stop_in_park
        may = self.variable_cycle and self.recover_late_sync and not self.stay_at_park
        return late and cyclic and may and parameter_fault(self, self.current.park) == Fault.NONE

    def peaks_allowed(self, speed: float) -> bool:
        """Whether a curve with these peaks keeps the limits that are checked, at that speed of the master."""
        if self.exceeds(self.check_speed, self.peaks.d1 * speed, self.max_speed):
            return False
        return not self.exceeds(self.check_acceleration, self.peaks.d2 * speed * speed, self.max_acceleration)

    def exceeds(self, checked: bool, size: float, limit: float) -> bool:
        """Whether a magnitude exceeds a limit that is checked."""
        return checked and limit > 0.0 and size > limit * EXCEEDED

    # --- the end of the synchronized phase ---

    def leave_synchronized(self, time: float) -> None:
        """The synchronized phase is over: choose the next meeting and the way there."""
        self.cycle += 1
        place = self.current.section.end
        fault = parameter_fault(self, self.park_slave)
        if fault == Fault.NONE:
            fault = self.try_leave_to_value() if self.variable_cycle else self.try_leave_to_next()
        if fault != Fault.NONE:
            self.alarm(fault, time, place)

    def try_leave_to_next(self) -> Fault:
        """Fixed cycle: to the first meeting that is half a cycle ahead, or more."""
        origin = self.meeting_origin()
        least = self.current.meeting + (0.5 - SAME_PLACE) * self.master_cycle
        meeting = first_at_or_after(origin, self.master_cycle, least)
        return self.current.try_leave(self, meeting, True, self.stop_in_park or self.stay_at_park)

    def try_leave_to_value(self) -> Fault:
        """Variable cycle: to the new value if it is at least a cycle ahead and there is room; else home, and the value
        is dropped."""
        assumed = self.current.meeting + self.master_cycle
        meeting = self.new_value_at - self.lead()
        if self.new_value and meeting >= assumed - SAME_PLACE * self.master_cycle:
            home = self.stop_in_park or self.stay_at_park
            if self.current.try_leave(self, meeting, True, home) == Fault.NONE:
                if self.current.stage in (Stage.FOLLOWING, Stage.SLOWING):
                    self.use_new_value()
                return Fault.NONE
        self.new_value = False
        return self.current.try_leave(self, assumed, False, True)

    def meeting_origin(self) -> float:
        """A place from which the meetings of a fixed cycle are whole cycles away."""
        return self.turn_origin + self.sync_master - self.lead()

    def lead(self) -> float:
        """How far the meeting lies before sync_master: half the synchronized phase, or 0."""
        return half_synchronous_travel(self) if self.align_center else 0.0

    # --- alarms ---

    def check_limits(self) -> None:
        """Brake if what is about to be put out exceeds a limit."""
        fault = speed_fault(self.current.stage)
        if fault == Fault.NONE:
            return
        if self.exceeds(self.check_speed, abs(self.slave.velocity), self.max_speed):
            self.brake(fault)
        elif self.exceeds(self.check_acceleration, abs(self.slave.acceleration), self.max_acceleration):
            self.brake(acceleration_fault(self.current.stage))

    def alarm(self, fault: Fault, time: float, place: float) -> None:
        """Brake at a time within the step, with the master at that place."""
        self.set_slave_at(time, place, self.master.velocity_at(time), 0.0)
        self.brake(fault)
        self.motion.clock.start(time)

    def brake(self, fault: Fault) -> None:
        """Begin the linear stop ramp from the slave's state as it is set."""
        self.error_id = fault
        self.current.enter_braking()
        deceleration = self.max_acceleration if usable(self.max_acceleration) else self.positioning.acceleration
        if self.slave.velocity == 0.0 or not usable(deceleration):
            self.motion.run(self.unwrapped, 0.0)
        else:
            self.motion.brake(self.unwrapped, self.slave.velocity, deceleration)

    # --- the slave ---

    def set_slave_at(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """Set the slave for a time since the step's beginning, with the master at `place` and moving so.

        A master that has fallen counts as standing at its highest position; its jerk counts as 0."""
        match self.current.stage:
            case Stage.IDLE | Stage.WAITING | Stage.WAITING_NEXT_CYCLE:
                self.put(self.current.park, 0.0, 0.0, 0.0)
            case Stage.TO_PARK | Stage.TO_CYCLE | Stage.BRAKING:
                position, v, a, j = self.motion.at(self.motion.clock.time + time)
                self.put(position, v, a, j)
            case _:
                position, d1, d2, d3 = self.current.section.at(max(place, self.current.highest))
                v, a, j = chain_rule(d1, d2, d3, max(velocity, 0.0), acceleration)
                self.put(position, v, a, j)

    def set_slave_at_input(self) -> None:
        """Set the slave for the master's present input, where the commands act."""
        self.set_slave_at(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)

    def put(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        """Put out the slave's motion, its position within slave_cycle."""
        self.unwrapped = position
        self.slave.put(wrap(position, self.slave_cycle), velocity, acceleration, jerk)

    # --- what is put out ---

    def show(self) -> None:
        """Derive from the stage what is put out beside the slave."""
        self.state = shown_state(self.current.stage)
        self.state_code = self.state
        self.error = self.error_id != Fault.NONE
        self.show_meeting()
        moving = self.in_cycle() and not self.current.parked()
        self.local.progress = self.current.section.progress(self.master.end) if moving else 0.0

    def in_cycle(self) -> bool:
        """Whether the slave waits for a meeting or is on its way."""
        return self.current.stage not in (Stage.IDLE, Stage.TO_PARK, Stage.TO_CYCLE, Stage.BRAKING)

    def show_meeting(self) -> None:
        """Show the meeting under way or, after it, the next one."""
        known = self.in_cycle() and self.current.meeting_known
        meeting = self.current.meeting
        if self.variable_cycle and self.current.stage in (Stage.DECEL, Stage.HOLDING, Stage.HOMING):
            known = self.new_value  # whether it will be in time or not
            meeting = self.new_value_at - (0.5 * self.current.synchronous_travel() if self.align_center else 0.0)
        start = meeting - self.current.approach_travel
        end = meeting + self.current.synchronous_travel()
        self.master_to_start = max(start - self.master.end, 0.0) if known else 0.0
        self.master_to_sync = max(meeting - self.master.end, 0.0) if known else 0.0
        self.master_to_out = max(end - self.master.end, 0.0) if known else 0.0
        self.local.meeting_known = known
        self.local.meeting_position = wrap(meeting, self.master.period) if known else 0.0
        self.local.start_position = wrap(start, self.master.period) if known else 0.0
        self.local.following_travel = self.current.approach_travel if known else 0.0

    def rebase(self) -> None:
        """Drop whole turns of the master, from all its positions."""
        before = self.master.end
        self.master.rebase()
        turned = before - self.master.end
        if turned != 0.0:
            self.current.shift(turned)
            self.new_value_at -= turned
            self.value_in_use_at -= turned
            origin = self.turn_origin - turned
            self.turn_origin = wrap(origin, self.master_cycle) if usable(self.master_cycle) else origin
