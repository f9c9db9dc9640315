"""From one cycle to the next. Source: Robox mv_follow2. Positions and travels are the master's, in M."""

from dataclasses import dataclass

from .. import var
from ..motion.quintic_peaks import QuinticPeaks
from ..numerics.grid import floor
from .cam_section import FAR
from .cycle import CycleState
from .faults import DropReason, Fault
from .interface import FollowerInterface
from .meetings import Meetings, lead
from .monitoring import LIMIT_TOLERANCE, keeps_limits
from .parameters import POSITION_TOLERANCE, parameter_fault, ramp_travel, steady_approach_travel, wait_travel
from .stages import Stage


@dataclass(slots=True)
class CycleSequence:
    """The slave's cycle, and to which meeting it goes from its park, from its way home, and from sync_out.

    - current: the stage of the slave, and its cycle.
    - candidate: a cycle that the slave may join, or to which it is being positioned.
    - stays_at_park: skip_next_cycle or sync_assumed, as read at the commands of the last step.
    """

    current: CycleState = var.part(CycleState)
    candidate: CycleState = var.part(CycleState)
    meetings: Meetings = var.part(Meetings)
    peaks: QuinticPeaks = var.part(QuinticPeaks)
    stays_at_park: bool = False

    # --- the undisturbed cycle ---

    def plan_undisturbed_cycle(self, parameters: FollowerInterface, master: float) -> None:
        """`candidate` becomes the undisturbed cycle with the master at that position."""
        self.candidate.rest_at(parameters.park_slave)
        if parameters.variable_cycle:
            meeting = self.meetings.latest_position() - lead(parameters)
            self.candidate.set_meeting(parameters, meeting, ramp_travel(parameters, parameters.park_slave))
            self.candidate.start_approach()
        else:
            passes_park = parameters.slave_cycle > 0.0 and not parameters.stop_in_park
            approach = steady_approach_travel(parameters)
            self.candidate.is_approach_shortened = approach < ramp_travel(parameters, parameters.park_slave)
            origin = self.meetings.origin(parameters)
            ahead = 0.0 if passes_park else approach
            cycles = floor((master + ahead - origin) / parameters.master_cycle)
            self.candidate.set_meeting(parameters, origin + cycles * parameters.master_cycle, approach)
            if passes_park:
                self.candidate.enter_synchronized()
            else:
                self.candidate.start_approach()
        self.candidate.advance_to(parameters, master)

    def enter_undisturbed_cycle(self, is_variable: bool, master: float) -> None:
        """The slave is being positioned to `candidate`."""
        var.copy(self.current, self.candidate)
        self.current.enter_to_cycle()
        self.current.watch_from(master)
        if self.candidate.is_parked() and self.candidate.has_meeting:
            self.meetings.new_position = self.meetings.latest_position()
            self.meetings.has_new_value = is_variable
        else:
            self.meetings.use_new_value()

    # --- at the park ---

    def try_choose_meeting(self, parameters: FollowerInterface, master: float) -> bool:
        """Choose the meeting to wait for, with the master at that position. True: something else has happened, the
        slave has left the park to join a late meeting or has missed the start to one."""
        if parameters.variable_cycle:
            return self.try_choose_value(parameters, master)
        return self.try_choose_next_meeting(parameters, master)

    def approach_travel(self, parameters: FollowerInterface) -> float:
        """M_f from where the slave is parked."""
        if self.current.is_approach_shortened:
            return self.current.approach_travel
        return ramp_travel(parameters, self.current.park)

    def try_choose_next_meeting(self, parameters: FollowerInterface, master: float) -> bool:
        """Fixed cycle: choose the first meeting whose start is not behind the master. True: that of the present cycle
        is behind, which is missed. The present cycle's meeting is the next one ahead of the master or, if the slave
        expected one, the one nearest to that."""
        tolerance = POSITION_TOLERANCE * parameters.master_cycle
        approach = self.approach_travel(parameters)
        soonest = master - tolerance + approach
        present = self.meetings.first_from(parameters, master + tolerance)
        if self.current.has_meeting:
            lowest = self.current.meeting - 0.5 * parameters.master_cycle - tolerance
            present = self.meetings.first_from(parameters, lowest)
        earliest = max(soonest, self.current.earliest_next_meeting)
        self.current.set_meeting(parameters, self.meetings.first_from(parameters, earliest), approach)
        return present < soonest and self.try_miss_start(parameters, master, self.current.start())

    def try_choose_value(self, parameters: FollowerInterface, master: float) -> bool:
        """Variable cycle: choose the new value, unless its start is behind the master."""
        self.current.has_meeting = False
        if not self.meetings.has_new_value or self.try_drop_value(parameters):
            return False
        approach = self.approach_travel(parameters)
        meeting = self.meetings.new_meeting(parameters)
        if meeting - approach >= master - POSITION_TOLERANCE * parameters.master_cycle:
            self.current.set_meeting(parameters, meeting, approach)
            return False
        if not self.try_join(parameters, master, parameters.master.path.crossing_time(master)):
            if parameters.local.drop_reason == DropReason.NONE:
                parameters.local.drop_reason = DropReason.MISSED
            self.meetings.has_new_value = False
            self.try_miss_start(parameters, master, meeting + parameters.master_cycle - approach)
        return True

    def try_miss_start(self, parameters: FollowerInterface, master: float, next_start: float) -> bool:
        """Wait for the next cycle, up to its start, less the wait. False: it is behind, or is waited for already."""
        until = next_start - wait_travel(parameters)
        is_awaited = self.current.stage == Stage.WAITING_NEXT_CYCLE and self.current.next_cycle_from == until
        if until <= master or is_awaited:
            return False
        self.current.enter_waiting_next_cycle(until)
        return True

    def try_start_cycle(self, parameters: FollowerInterface, master: float) -> Fault:
        """The way to the meeting starts, or is not carried out; the master is there, or beyond."""
        meeting = self.current.meeting
        fault = parameter_fault(parameters, self.current.park)
        if self.stays_at_park:
            if not meeting + parameters.master_cycle > meeting:  # rounding would let the same start come for ever
                return Fault.CYCLE_TOO_SHORT
            self.try_miss_start(parameters, master, meeting + parameters.master_cycle - self.current.approach_travel)
            self.current.earliest_next_meeting = meeting + 0.5 * parameters.master_cycle
            self.meetings.has_new_value = False
            self.current.has_meeting = False
            return Fault.NONE
        if fault == Fault.NONE:
            self.meetings.use_new_value()
            self.current.start_approach()
        return fault

    # --- late values ---

    def try_drop_value(self, parameters: FollowerInterface) -> bool:
        """Drop the new value if its meeting is less than a cycle after the one before, as one that comes in time is: on
        the way there the slave would be faster than in a cycle of the least length."""
        earliest = self.current.last_meeting + (1.0 - POSITION_TOLERANCE) * parameters.master_cycle
        if self.meetings.new_meeting(parameters) >= earliest:
            return False
        self.meetings.has_new_value = False
        parameters.local.drop_reason = DropReason.TOO_SOON
        return True

    def try_join(self, parameters: FollowerInterface, master: float, time: float) -> bool:
        """Join a meeting whose value comes too late, if the way is no faster than that to the earliest meeting, a cycle
        after the one before, and if it keeps the limits at the master's velocity then."""
        if not self.may_join(parameters):
            return False
        is_parked = self.current.is_parked()
        goes_back = parameters.master.is_measured()  # and the slave with it
        begin = master if is_parked or goes_back else max(master, self.current.highest)
        meeting = self.meetings.new_meeting(parameters)
        tolerance = POSITION_TOLERANCE * parameters.master_cycle
        is_in_time = is_parked and meeting - self.approach_travel(parameters) >= begin - tolerance
        if meeting <= begin + tolerance or is_in_time or self.try_drop_value(parameters):
            return False
        fastest = FAR
        earliest = self.current.last_meeting + parameters.master_cycle
        if begin + tolerance < earliest < meeting - tolerance:
            self.plan_way(parameters, begin, earliest)
            fastest = self.peaks.d1
        self.plan_way(parameters, begin, meeting)
        if self.peaks.d1 > fastest * LIMIT_TOLERANCE:
            parameters.local.drop_reason = DropReason.TOO_FAST
            return False
        if not keeps_limits(parameters, self.peaks, abs(parameters.master.velocity_at(time))):
            parameters.local.drop_reason = DropReason.LIMITS
            return False
        var.copy(self.current, self.candidate)
        self.meetings.use_new_value()
        return True

    def plan_way(self, parameters: FollowerInterface, master: float, meeting: float) -> None:
        """`candidate` becomes the way to a meeting from where the slave is with the master at that position; `peaks`
        are those of the way."""
        var.copy(self.candidate, self.current)
        self.candidate.join(parameters, master, meeting)
        self.peaks.measure(self.candidate.cam_section.quintic)

    def may_join(self, parameters: FollowerInterface) -> bool:
        """Whether there is a new value, and a cyclic slave that does not park and may join its meeting late."""
        can_leave = self.current.is_parked() or self.current.stage == Stage.HOMING
        passes_park = parameters.slave_cycle > 0.0 and not parameters.stop_in_park
        is_allowed = parameters.variable_cycle and parameters.recover_late_sync and not self.stays_at_park
        if not (can_leave and self.meetings.has_new_value and passes_park and is_allowed):
            return False
        return parameter_fault(parameters, self.current.park) == Fault.NONE

    # --- the end of the synchronized phase ---

    def try_leave_synchronized(self, parameters: FollowerInterface) -> Fault:
        """The synchronized phase is over: choose the next meeting and the way there.

        Fixed cycle: to the first meeting that is half a cycle ahead, or more."""
        fault = parameter_fault(parameters, parameters.park_slave)
        if fault != Fault.NONE:
            return fault
        parks = parameters.stop_in_park or self.stays_at_park
        if parameters.variable_cycle:
            return self.try_leave_to_value(parameters, parks)
        earliest = self.current.meeting + (0.5 - POSITION_TOLERANCE) * parameters.master_cycle
        return self.current.try_leave(parameters, self.meetings.first_from(parameters, earliest), True, parks)

    def try_leave_to_value(self, parameters: FollowerInterface, parks: bool) -> Fault:
        """Variable cycle: to the new value if it is at least a cycle ahead and the master's travel suffices; else home,
        and the value is dropped."""
        assumed = self.current.meeting + parameters.master_cycle
        meeting = self.meetings.new_meeting(parameters)
        is_later = meeting >= assumed - POSITION_TOLERANCE * parameters.master_cycle
        may_go_on = self.meetings.has_new_value and is_later
        if may_go_on and self.current.try_leave(parameters, meeting, True, parks) == Fault.NONE:
            if self.current.stage in (Stage.FOLLOWING, Stage.SLOWING):
                self.meetings.use_new_value()
            return Fault.NONE
        if self.meetings.has_new_value:
            parameters.local.drop_reason = DropReason.TOO_SHORT if is_later else DropReason.TOO_SOON
        self.meetings.has_new_value = False
        return self.current.try_leave(parameters, assumed, False, True)
