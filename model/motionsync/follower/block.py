"""The behaviour of a Follower. Source: Robox mv_follow2; README.md has the decisions where it is silent."""

from dataclasses import dataclass

from .. import var
from ..master import MasterInput, PathRefusal
from ..master_path import MOST_EVENTS, NEVER
from ..motion.jerk_limited import Motion
from ..motion.laws import chain_rule
from ..numerics.computable_range import LARGEST, clamp, is_usable
from ..numerics.grid import nearest_on_grid, wrap
from ..slave import Edge
from .cycle_sequence import CycleSequence
from .faults import DropReason, Fault, Refusal
from .interface import FollowerInterface
from .monitoring import exceeded_limit_fault
from .parameters import is_start_computable, parameter_fault
from .stages import Stage, shown_state

MOST_CYCLES = 1e6  # of the master: a step over more of them is refused
SAME_POSITION = 1e-12  # u, and of the positions: a slave that is no further away is already there
REST_TOLERANCE = 1e-9  # u/s, u/s2: the slave of a master at rest has no more, by rounding


@dataclass(slots=True)
class Follower(FollowerInterface):
    """Meets the master at given positions cycle after cycle, runs with it, and comes back.

    The slave leaves its park so that it is at sync_slave where the master is at sync_master, runs with k_slave_master
    times the master's velocity up to sync_out, and comes back: backwards (a linear slave), or onwards by slave_cycle (a
    cyclic one). All these ways are curves over the master's position; the master may stop, but not turn back. Nothing
    moves before a positioning. What cannot go on leads to an alarm with a stop ramp.
    """

    park_edge: Edge = var.part(Edge)
    cycle_edge: Edge = var.part(Edge)
    end_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    stays_forward: bool = False  # stop_after_forward, as read at the commands of the last step
    sequence: CycleSequence = var.part(CycleSequence)
    motion: Motion = var.part(Motion)
    slave_position: float = 0.0  # the slave's before it is wrapped into slave_cycle

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
                return Refusal.CYCLE_TOO_SHORT_CYCLIC if self.slave_cycle > 0.0 else Refusal.CYCLE_TOO_SHORT_LINEAR
        self.sequence.current.enter_idle(wrap(self.slave.initial_position, self.slave_cycle))
        self.park_edge.take_level(self.position_to_park)
        self.cycle_edge.take_level(self.position_to_cycle)
        self.end_edge.take_level(self.end_synchronism)
        self.reset_edge.take_level(self.reset)
        self.sequence.meetings.turn_origin = 0.0
        self.read_levels()
        self.sequence.meetings.record_new_value(self, self.master.end)
        self.set_slave_at(0.0, self.master.end, 0.0, 0.0)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the master's path."""
        refusal = self.master.try_advance_within(h, MOST_CYCLES * self.master_cycle)
        if refusal != PathRefusal.NONE:
            return Refusal.CYCLES if refusal == PathRefusal.TRAVEL else Refusal.MASTER_TURNS
        if not self.is_on_cam() and self.sequence.current.stage != Stage.TO_CYCLE:
            self.master.watch_travel()
        self.local.drop_reason = DropReason.NONE
        for section in range(self.master.path.sections):
            self.follow_section(section)
            if section == 0:
                self.obey()
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
        current = self.sequence.current
        current.record_input(self.master.begin)
        if self.sync_master != self.sequence.meetings.last_value:
            self.sequence.meetings.record_new_value(self, self.master.begin)
            self.sequence.try_join(self, self.master.begin, 0.0)
        if current.stage == Stage.HOLDING and not self.stays_forward:
            current.release(max(self.master.begin, current.highest), self.variable_cycle)
        if self.park_edge.try_rise(self.position_to_park):
            self.command_to_park()
        if self.cycle_edge.try_rise(self.position_to_cycle):
            self.command_to_cycle()
        if self.end_edge.try_rise(self.end_synchronism) and current.stage == Stage.SYNCHRONIZED:
            self.error_id = Fault.NONE
            current.end_synchronized_at(max(self.master.begin, current.highest))
            self.leave_synchronized(0.0)
        if self.reset_edge.try_rise(self.reset):
            self.command_reset()

    def read_levels(self) -> None:
        """Read the levels; they act from now on, in the input correction of the next step, too."""
        self.sequence.stays_at_park = self.skip_next_cycle or self.sync_assumed
        self.stays_forward = self.stop_after_forward

    def command_to_park(self) -> None:
        """Move to park_slave, of a cyclic slave to its nearest turn."""
        self.set_slave_at_input()
        if not (self.can_be_positioned() and abs(self.park_slave) <= LARGEST):
            self.refuse_positioning()
        elif self.try_move_to(nearest_on_grid(self.park_slave, self.slave_cycle, self.slave_position)):
            self.sequence.current.enter_to_park(self.park_slave)

    def command_to_cycle(self) -> None:
        """Move to where the undisturbed cycle has the slave for the master's present position, to go on from there."""
        self.set_slave_at_input()
        meetings = self.sequence.meetings
        has_value = meetings.has_new_value or meetings.uses_value or not self.variable_cycle
        if not (self.can_be_positioned() and has_value and parameter_fault(self, self.park_slave) == Fault.NONE):
            self.refuse_positioning()
            return
        master = self.master.begin
        self.sequence.plan_undisturbed_cycle(self, master)
        candidate = self.sequence.candidate
        target = candidate.park
        if not candidate.is_parked():
            target, _, _, _ = candidate.cam_section.at(master)
        if self.try_move_to(nearest_on_grid(target, self.slave_cycle, self.slave_position)):
            self.sequence.enter_undisturbed_cycle(self.variable_cycle, master)

    def can_be_positioned(self) -> bool:
        """Whether a positioning may start: the slave is at rest, and there is no alarm.

        A slave that follows the noise of a measured line counts as at rest if the positioning can stop it within the
        line's reaction time."""
        is_at_rest = max(abs(self.slave.velocity), abs(self.slave.acceleration)) <= REST_TOLERANCE
        if self.master.is_measured() and is_usable(self.positioning.acceleration):
            fastest = self.positioning.acceleration * self.master.reaction_time()
            is_at_rest = is_at_rest or abs(self.slave.velocity) <= fastest
        return self.sequence.current.stage != Stage.BRAKING and is_at_rest

    def try_move_to(self, target: float) -> bool:
        """Start the move to a position, or refuse it. A slave that is already there needs no limits."""
        begin = self.slave_position
        if abs(target - begin) <= SAME_POSITION * (1.0 + abs(target) + abs(begin)):
            self.motion.start(target, 0.0, 0.0)
        elif self.positioning.limits_usable() and abs(target) <= 2.0 * LARGEST and abs(begin) <= 2.0 * LARGEST:
            limits = self.positioning
            limit = limits.acceleration
            is_measured = self.master.is_measured()
            velocity = self.slave.velocity if is_measured else 0.0
            acceleration = self.slave.acceleration if is_measured else 0.0
            self.motion.start(begin, velocity, acceleration)
            self.motion.move(target, limits.velocity, limit, limit, limits.jerk)
        else:
            self.refuse_positioning()
            return False
        self.error_id = Fault.NONE
        return True

    def refuse_positioning(self) -> None:
        """Set the fault; an alarm keeps its own number."""
        if self.sequence.current.stage != Stage.BRAKING:
            self.error_id = Fault.POSITIONING

    def command_reset(self) -> None:
        """Clear the error. An alarm ends where the slave is at rest; before, it is not cleared."""
        if self.sequence.current.stage == Stage.BRAKING:
            self.set_slave_at_input()
            if self.slave.velocity != 0.0:
                return
            self.sequence.current.enter_idle(wrap(self.slave_position, self.slave_cycle))
        self.error_id = Fault.NONE

    # --- the master's path ---

    def follow_section(self, section: int) -> None:
        """Carry out the events in a section of the master's path; section 0 is the input correction."""
        self.master.path.enter(section)
        for _ in range(MOST_EVENTS):
            if not self.try_event():
                break

    def try_event(self) -> bool:
        """Carry out the next event of the stage on what is left of the section; False: there is none."""
        match self.sequence.current.stage:
            case Stage.IDLE | Stage.BRAKING:  # commands alone end them
                return False
            case Stage.TO_PARK:
                return self.try_event_to_park()
            case Stage.TO_CYCLE:
                return self.try_event_to_cycle()
            case Stage.WAITING:
                return self.try_event_waiting()
            case Stage.WAITING_NEXT_CYCLE:
                return self.try_event_waiting_next_cycle()
            case _:
                return self.try_event_on_cam()

    def try_event_to_park(self) -> bool:
        """The slave arrives at the park, whatever the master does."""
        if not self.try_arrive():
            return False
        self.sequence.current.rest_at(self.sequence.current.park)
        self.sequence.meetings.uses_value = False
        return True

    def try_event_to_cycle(self) -> bool:
        """The slave arrives in the cycle. A master that has moved before is an alarm."""
        current = self.sequence.current
        end = self.master.path.end
        tolerance = current.backward_tolerance + self.master.uncertain_travel()
        if abs(end - current.highest) > tolerance:
            limit = current.highest + (tolerance if end > current.highest else -tolerance)
            time = self.master.path.crossing_time(limit)
            if self.arrival_time() > time:
                self.alarm(Fault.MASTER_MOVED, time, limit)
                return False
        if not self.try_arrive():
            return False
        current.enter_cycle(self.sequence.candidate.stage)
        self.sequence.meetings.uses_value = self.sequence.meetings.uses_value and not current.is_parked()
        return True

    def try_event_waiting(self) -> bool:
        """A cycle starts, or its start is missed; or no start can be computed, which is an alarm. Where the master goes
        back, the meeting is chosen again, and nothing starts."""
        current = self.sequence.current
        path = self.master.path
        is_falling = self.master.goes_against(1.0)
        position = path.end if is_falling else path.reached
        if not is_start_computable(self):
            self.alarm_at(parameter_fault(self, current.park), position)
            return True
        if self.sequence.try_choose_meeting(self, position):
            if not current.is_parked():
                path.reached = position
            return True
        if is_falling or not (current.has_meeting and path.end >= current.start()):
            return False
        start = current.start()
        path.reached = max(path.reached, start)
        fault = self.sequence.try_start_cycle(self, path.reached)
        if fault != Fault.NONE:
            self.alarm_at(fault, start)
        return True

    def try_event_waiting_next_cycle(self) -> bool:
        """As WAITING; and the cycle whose start was missed is over, which is the last event of the section."""
        if self.try_event_waiting():
            return True
        path = self.master.path
        if path.reached <= path.end and self.sequence.current.next_cycle_from <= path.end:
            self.sequence.current.enter_waiting()
        return False

    def try_event_on_cam(self) -> bool:
        """On the way: the end of the stage's cam section, or an alarm if the master goes back."""
        if not self.try_end_cam_section():
            return False
        current = self.sequence.current
        match current.stage:
            case Stage.FOLLOWING:
                current.enter_synchronized()
            case Stage.SLOWING:
                current.enter_pausing()
            case Stage.PAUSING:
                current.speed_up(self.slave_cycle)
            case Stage.SYNCHRONIZED:
                self.leave_synchronized(self.master.path.crossing_time(current.cam_section.end))
            case Stage.DECEL:
                if self.stays_forward:
                    current.enter_holding()
                else:
                    current.return_home(current.cam_section.end, current.return_travel)
            case Stage.HOMING:
                current.enter_waiting()
                self.sequence.meetings.uses_value = False
            case _:  # HOLDING, which has no end
                pass
        return True

    # --- what several stages have in common ---

    def arrival_time(self) -> float:
        """When a positioning ends, in s since the step's beginning; NEVER: not on what is left of the section."""
        return self.master.path.due(self.motion.clock, self.motion.end_time())

    def try_arrive(self) -> bool:
        """The master reaches the position where a positioning ends, if that is on what is left of the section."""
        path = self.master.path
        arrival = self.arrival_time()
        if arrival > path.now and arrival != NEVER:
            position = path.end if arrival >= path.until else path.position(arrival)
            path.reached = clamp(position, min(path.reached, path.end), max(path.reached, path.end))
        return arrival != NEVER

    def try_end_cam_section(self) -> bool:
        """Go to the end of the cam section; False: it is beyond the section. A master that goes back, not by noise, is
        an alarm; of mode POSITION_ONLY only the inputs are checked, since the path inside the step is a guess."""
        current = self.sequence.current
        end = self.master.path.end
        is_correction = self.master.path.is_correction()
        tolerance = current.backward_tolerance + self.master.uncertain_travel()
        lowest = (current.highest_input if is_correction else current.highest_in_step) - tolerance
        is_guessed = not is_correction and self.master.input_mode == MasterInput.POSITION_ONLY
        if end < lowest and not is_guessed:
            self.alarm_at(Fault.MASTER_BACKWARDS, lowest)
            return False
        if end < current.cam_section.end:
            current.highest = max(current.highest, end)
            current.highest_in_step = max(current.highest_in_step, end)
            return False
        self.master.path.reached = current.cam_section.end
        return True

    def leave_synchronized(self, time: float) -> None:
        """The synchronized phase is over at a time within the step: go on towards the next meeting."""
        self.cycle += 1
        position = self.sequence.current.cam_section.end
        fault = self.sequence.try_leave_synchronized(self)
        if fault != Fault.NONE:
            self.alarm(fault, time, position)

    # --- alarms ---

    def check_limits(self) -> None:
        """Brake if the setpoint exceeds a limit."""
        fault = exceeded_limit_fault(self, self.sequence.current.stage)
        if fault != Fault.NONE:
            self.brake(fault)

    def alarm_at(self, fault: Fault, master: float) -> None:
        """Brake where the master passes a position on the section of its path."""
        self.alarm(fault, self.master.path.crossing_time(master), master)

    def alarm(self, fault: Fault, time: float, master: float) -> None:
        """Brake at a time within the step, with the master at that position."""
        self.set_slave_at(time, master, self.master.velocity_at(time), 0.0)
        self.brake(fault)
        self.motion.clock.start(time)

    def brake(self, fault: Fault) -> None:
        """Start the linear stop ramp from the slave's state as it is set."""
        self.error_id = fault
        self.sequence.current.enter_braking()
        deceleration = self.max_acceleration if is_usable(self.max_acceleration) else self.positioning.acceleration
        if self.slave.velocity == 0.0 or not is_usable(deceleration):
            self.motion.start(self.slave_position, 0.0, 0.0)
        else:
            self.motion.brake(self.slave_position, self.slave.velocity, deceleration)

    # --- the slave ---

    def set_slave_at(self, time: float, master: float, velocity: float, acceleration: float) -> None:
        """Set the slave for a time since the step's beginning, with the master at that position and moving so."""
        current = self.sequence.current
        match current.stage:
            case Stage.IDLE | Stage.WAITING | Stage.WAITING_NEXT_CYCLE:
                self.set_slave(current.park, 0.0, 0.0, 0.0)
            case Stage.TO_PARK | Stage.TO_CYCLE | Stage.BRAKING:
                position, v, a, j = self.motion.at(time)
                self.set_slave(position, v, a, j)
            case _:
                self.set_slave_on_cam(master, velocity, acceleration)

    def set_slave_on_cam(self, master: float, velocity: float, acceleration: float) -> None:
        """Set the slave on its cam section. A master that has gone back takes the slave along if it is measured; else
        it counts as at rest at its highest position. Its jerk counts as 0."""
        section = self.sequence.current.cam_section
        if self.master.is_measured():
            position, d1, d2, d3 = section.at_or_before(master)
        else:
            position, d1, d2, d3 = section.at(max(master, self.sequence.current.highest))
            velocity = max(velocity, 0.0)
        v, a, j = chain_rule(d1, d2, d3, velocity, acceleration)
        self.set_slave(position, v, a, j)

    def set_slave_at_input(self) -> None:
        """Set the slave for the master's present input, where the commands act."""
        self.set_slave_at(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)

    def set_slave(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        """Set the slave's motion; its position is given unwrapped."""
        self.slave_position = position
        self.slave.set(wrap(position, self.slave_cycle), velocity, acceleration, jerk)

    # --- the other outputs ---

    def show(self) -> None:
        """Derive from the stage the outputs other than the setpoint."""
        current = self.sequence.current
        self.state = shown_state(current.stage)
        self.state_code = self.state
        self.error = self.error_id != Fault.NONE
        self.show_meeting()
        self.local.progress = current.cam_section.progress(self.master.end) if self.is_on_cam() else 0.0

    def is_in_cycle(self) -> bool:
        """Whether the slave waits for a meeting or is on its way."""
        return self.sequence.current.stage not in (Stage.IDLE, Stage.TO_PARK, Stage.TO_CYCLE, Stage.BRAKING)

    def is_on_cam(self) -> bool:
        """Whether the slave is on its way, on a cam section."""
        return self.is_in_cycle() and not self.sequence.current.is_parked()

    def show_meeting(self) -> None:
        """Show the meeting under way or, after it, the next one."""
        current = self.sequence.current
        has_meeting = self.is_in_cycle() and current.has_meeting
        meeting = current.meeting
        if self.variable_cycle and current.stage in (Stage.DECEL, Stage.HOLDING, Stage.HOMING):
            has_meeting = self.sequence.meetings.has_new_value  # whether it will be in time or not
            lead = 0.5 * current.synchronous_travel() if self.align_center else 0.0
            meeting = self.sequence.meetings.new_position - lead
        start = meeting - current.approach_travel
        end = meeting + current.synchronous_travel()
        self.master_to_start = max(start - self.master.end, 0.0) if has_meeting else 0.0
        self.master_to_sync = max(meeting - self.master.end, 0.0) if has_meeting else 0.0
        self.master_to_out = max(end - self.master.end, 0.0) if has_meeting else 0.0
        self.local.meeting_known = has_meeting
        self.local.meeting_position = wrap(meeting, self.master.period) if has_meeting else 0.0
        self.local.start_position = wrap(start, self.master.period) if has_meeting else 0.0
        self.local.following_travel = current.approach_travel if has_meeting else 0.0

    def rebase(self) -> None:
        """Drop whole turns of the master, from all its positions."""
        before = self.master.end
        self.master.rebase()
        dropped = before - self.master.end
        if dropped != 0.0:
            self.sequence.current.shift(dropped)
            self.sequence.meetings.shift(self.master_cycle, dropped)
