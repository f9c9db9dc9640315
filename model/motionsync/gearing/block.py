"""The behaviour of a Gearing. Source: MOVIKIT gearing; README.md has the decisions where it is silent."""

from dataclasses import dataclass

from .. import var
from ..master_path import MOST_EVENTS, NEVER
from ..numerics.grid import wrap
from ..slave import Edge
from .faults import Fault, Refusal
from .interface import GearingInterface, State
from .line import direction_of
from .manoeuvre import Manoeuvre
from .master_motion import direction_in, is_motion, is_same_position
from .request import ManoeuvreRequest, ratio_fault, transition_fault
from .stage import Stage, state_of


@dataclass(slots=True)
class Gearing(GearingInterface):
    """Gears a slave to a master by a whole-number ratio, on a straight line through a point that can be chosen.

    A rising edge of start engages it, a falling edge disengages it: `start_mode` and `stop_mode` select where and in
    which direction of the master, `transition` how.
    """

    # What the inputs were when the commands were carried out last.
    active_before: bool = True
    start_before: bool = False
    reset_edge: Edge = var.part(Edge)
    set_master_edge: Edge = var.part(Edge)
    set_slave_edge: Edge = var.part(Edge)
    manoeuvre: Manoeuvre = var.part(Manoeuvre)

    def initialize(self) -> Refusal:
        """STOPPED at the initial position; may be called again while parameters and inputs still change."""
        refusal = self.start_refusal()
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.active_before = self.activate
        self.start_before = self.start
        self.reset_edge.take_level(self.reset)
        self.set_master_edge.take_level(self.set_master.execute)
        self.set_slave_edge.take_level(self.set_slave.execute)
        manoeuvre = self.manoeuvre
        manoeuvre.use_ratio(self.gearing)
        manoeuvre.rest_position = self.slave.initial_position
        manoeuvre.synchronous_slave = manoeuvre.rest_position
        manoeuvre.line.set_point(0.0, manoeuvre.rest_position)
        manoeuvre.show_line_offset(self)
        self.set_slave_at_end()
        self.show()
        return Refusal.NONE

    def start_refusal(self) -> Refusal:
        """Why the start values of the block's own parameters are refused; NONE: they are not."""
        match ratio_fault(self.gearing):
            case Fault.DENOMINATOR:
                return Refusal.DENOMINATOR
            case Fault.NUMERATOR:
                return Refusal.NUMERATOR
            case _:
                pass
        if transition_fault(self.gear_in.transition, 0.0, self.gear_in.time) != Fault.NONE:
            return Refusal.GEAR_IN_TIME
        if transition_fault(self.gear_out.transition, 0.0, self.gear_out.time) != Fault.NONE:
            return Refusal.GEAR_OUT_TIME
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the master's path in the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        if self.manoeuvre.stage in (Stage.STOPPED, Stage.ACTIVE, Stage.FROZEN):
            self.master.watch_travel()
        for section in range(self.master.path.sections):
            self.follow_section(section)
            if section == 0:
                self.obey()
        self.manoeuvre.time_curve.advance(h)
        self.rebase()  # before the setpoint is computed: from smaller positions it has more of its last bits
        self.set_slave_at_end()
        self.show()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands of the step, with the master at its present input."""
        self.master.path.leave()
        self.obey_ratio()
        self.obey_activate()
        self.obey_start()
        self.obey_reset()
        self.obey_synchronous_point()

    def obey_ratio(self) -> None:
        """A changed ratio acts at once on the line, on the way there, or while waiting; else at the next engagement."""
        before = self.manoeuvre.ratio_before
        if before.numerator == self.gearing.numerator and before.denominator == self.gearing.denominator:
            return
        var.copy(before, self.gearing)
        match self.manoeuvre.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                pass
            case _:
                fault = ratio_fault(self.gearing)
                if fault == Fault.NONE:
                    self.manoeuvre.change_ratio(self)
                else:
                    self.error_id = fault

    def obey_activate(self) -> None:
        """A falling edge of activate freezes the slave; a frozen block that is activated again is STOPPED."""
        if self.active_before and not self.activate:
            self.freeze()
        elif self.manoeuvre.stage == Stage.FROZEN and self.activate:
            self.manoeuvre.enter_stopped()
        self.active_before = self.activate

    def freeze(self) -> None:
        """The slave stops where it is."""
        manoeuvre = self.manoeuvre
        if manoeuvre.stage == Stage.ACTIVE:
            manoeuvre.save_synchronous_point(self.master.path.reached)
        manoeuvre.set_slave_now(self)
        manoeuvre.rest_position = manoeuvre.slave_position
        manoeuvre.has_queued_edge = False
        manoeuvre.enter_frozen()

    def obey_start(self) -> None:
        """The edges of start; while the block is not active they are lost."""
        if self.activate and self.start and not self.start_before:
            self.command_start()
        if self.activate and self.start_before and not self.start:
            self.command_stop()
        self.start_before = self.start

    def command_start(self) -> None:
        """The rising edge of start."""
        manoeuvre = self.manoeuvre
        match manoeuvre.stage:
            case Stage.STOPPED:
                if manoeuvre.try_request_gear_in(self):
                    manoeuvre.engage(self)
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_IN_TIME_BASED:
                manoeuvre.cancel_queued_edge(self)
            case Stage.WAITING_FOR_STOP:
                self.error_id = Fault.NONE
                manoeuvre.enter_active()
            case Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                if manoeuvre.try_request_gear_in(self):
                    manoeuvre.engage_from_transition(self)
            case _:
                pass

    def command_stop(self) -> None:
        """The falling edge of start."""
        manoeuvre = self.manoeuvre
        match manoeuvre.stage:
            case Stage.WAITING_FOR_START:
                self.error_id = Fault.NONE
                manoeuvre.enter_stopped()
            case Stage.ACTIVE:
                if manoeuvre.try_request_gear_out(self):
                    manoeuvre.disengage(self)
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_IN_TIME_BASED:
                if manoeuvre.try_request_gear_out(self):
                    manoeuvre.disengage_from_transition(self)
            case Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                manoeuvre.cancel_queued_edge(self)
            case _:
                pass

    def obey_reset(self) -> None:
        """A rising edge of reset clears the fault; a frozen block then shows STOPPED."""
        if self.reset_edge.try_rise(self.reset):
            self.error_id = Fault.NONE
            if self.manoeuvre.stage == Stage.FROZEN:
                self.manoeuvre.state_when_frozen = State.STOPPED
                self.local.progress = 0.0

    def obey_synchronous_point(self) -> None:
        """Rising edges set the halves of the synchronous point while the block is not active; the slave's half sets the
        slave's position, too."""
        if self.set_master_edge.try_rise(self.set_master.execute) and not self.activate:
            self.manoeuvre.synchronous_master = self.set_master.value
            self.error_id = Fault.NONE
        if self.set_slave_edge.try_rise(self.set_slave.execute) and not self.activate:
            self.manoeuvre.synchronous_slave = self.set_slave.value
            self.manoeuvre.rest_position = self.set_slave.value
            self.error_id = Fault.NONE

    # --- the master's path ---

    def follow_section(self, section: int) -> None:
        """Carry out the events on a section of the master's path one after the other."""
        self.master.path.enter(section)
        for _ in range(MOST_EVENTS):
            if not self.try_event():
                break
        self.manoeuvre.master_motion.record_section(self.master)

    def try_event(self) -> bool:
        """Carry out the next event of the stage on what is left of the section; False: there is none."""
        manoeuvre = self.manoeuvre
        match manoeuvre.stage:
            case Stage.STOPPED | Stage.ACTIVE:
                return self.try_event_queued_edge()
            case Stage.WAITING_FOR_START:
                return self.try_event_waiting(manoeuvre.gear_in_request)
            case Stage.WAITING_FOR_STOP:
                return self.try_event_waiting(manoeuvre.gear_out_request)
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_OUT_MASTER_BASED:
                return self.try_event_master_based()
            case Stage.GEAR_IN_TIME_BASED | Stage.GEAR_OUT_TIME_BASED:
                return self.try_event_time_based()
            case _:  # FROZEN ends by a command only
                return False

    def try_event_queued_edge(self) -> bool:
        """At rest or on the line: an edge that has waited for the end of a transition acts."""
        if not self.manoeuvre.has_queued_edge:
            return False
        self.manoeuvre.has_queued_edge = False
        if self.manoeuvre.stage == Stage.STOPPED:
            self.command_start()
        else:
            self.command_stop()
        return True

    def try_event_waiting(self, request: ManoeuvreRequest) -> bool:
        """At rest or on the line: the master moves as it has to, or crosses a trigger."""
        manoeuvre = self.manoeuvre
        direction = direction_in(self.master.path)
        is_engaging = manoeuvre.stage == Stage.WAITING_FOR_START
        if manoeuvre.starts_by_motion(request):
            if not (request.allows(direction) and is_motion(self.master)):
                return False
            manoeuvre.set_slave_now(self)
            if is_engaging:
                manoeuvre.start_gear_in_now(self, direction)
            else:
                manoeuvre.start_gear_out_now(self, direction)
            return True
        if not manoeuvre.crosses_trigger(self, request):
            return False
        if is_engaging:
            manoeuvre.start_gear_in_at_trigger(self)
        else:
            manoeuvre.start_gear_out_at_trigger(self)
        return True

    def try_event_master_based(self) -> bool:
        """On a curve over the master's position: its end is reached, or the master goes back before its beginning."""
        manoeuvre = self.manoeuvre
        path = self.master.path
        end = path.end
        curve = manoeuvre.master_curve
        is_engaging = manoeuvre.stage == Stage.GEAR_IN_MASTER_BASED
        if curve.direction == 0.0 and not is_same_position(self.master, end, curve.trigger):  # the first motion
            curve.direction = direction_of(end - curve.trigger, 0.0)
            if is_engaging:
                manoeuvre.line.master = curve.trigger + curve.half()
                manoeuvre.show_line_offset(self)
        is_reached = curve.is_reached_at(end)
        is_left = not is_reached and curve.is_left_at(end, self.master.uncertain_travel())
        if is_reached:
            path.go_to(curve.end())
            manoeuvre.end_transition(self)
        elif is_left:
            path.go_to(curve.trigger)
            if is_engaging:
                manoeuvre.fall_back_to_rest(self)
            else:
                manoeuvre.fall_back_to_line(self)
        return is_reached or is_left

    def try_event_time_based(self) -> bool:
        """On the way to the line or to rest: its time is over. The input correction takes no time."""
        path = self.master.path
        time_curve = self.manoeuvre.time_curve
        time = path.due(time_curve.clock, time_curve.curve.length)
        if path.is_correction() or time == NEVER:
            return False
        path.now = time
        path.reached = path.end if path.now >= path.until else path.position(path.now)
        self.manoeuvre.end_transition(self)
        return True

    def rebase(self) -> None:
        """Drop whole turns, so that positions keep their last bits; not while a transition is at a particular turn.

        On the line the slave travels on with each turn of the master: turns are dropped if the slave has turns too."""
        manoeuvre = self.manoeuvre
        is_geared = False
        match manoeuvre.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.WAITING_FOR_START:
                pass
            case Stage.ACTIVE | Stage.WAITING_FOR_STOP:
                is_geared = True
            case _:
                return
        period = self.slave.period
        if is_geared and period == 0.0:
            return
        before = self.master.end
        self.master.rebase()
        dropped = before - self.master.end
        manoeuvre.master_curve.trigger -= dropped
        if is_geared:
            manoeuvre.line.slave += manoeuvre.line.to_slave(dropped)
        if period > 0.0:
            position = manoeuvre.line.at(self.master.end) if is_geared else manoeuvre.rest_position
            dropped = position - wrap(position, period)
            manoeuvre.line.slave -= dropped
            manoeuvre.synchronous_slave -= dropped
            manoeuvre.rest_position = wrap(manoeuvre.rest_position, period)

    # --- the outputs ---

    def set_slave_at_end(self) -> None:
        """Set the slave's motion at the step's end."""
        master = self.master
        self.manoeuvre.set_slave_at(self, 0.0, master.end, master.end_velocity, master.end_acceleration)

    def show(self) -> None:
        """Derive the other outputs at the step's end; while FROZEN, progress and trigger stay as they were."""
        self.state = state_of(self.manoeuvre.stage, self.manoeuvre.state_when_frozen)
        self.state_code = self.state
        self.in_gear = self.state == State.ACTIVE
        self.error = self.error_id != Fault.NONE
        if self.manoeuvre.stage != Stage.FROZEN:
            self.local.progress = self.transition_progress()
            self.local.trigger_position = wrap(self.shown_trigger(), self.master.period)

    def transition_progress(self) -> float:
        """The share of the transition that is done at the step's end: 1 in gear, 0 at rest and while waiting."""
        match self.manoeuvre.stage:
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_OUT_MASTER_BASED:
                return self.manoeuvre.master_curve.progress(self.master.end)
            case Stage.GEAR_IN_TIME_BASED | Stage.GEAR_OUT_TIME_BASED:
                return self.manoeuvre.time_curve.progress()
            case Stage.ACTIVE:
                return 1.0
            case _:
                return 0.0

    def shown_trigger(self) -> float:
        """The trigger that the master crosses next while a request waits for one; else that of the last transition."""
        manoeuvre = self.manoeuvre
        match manoeuvre.stage:
            case Stage.WAITING_FOR_START:
                return manoeuvre.expected_trigger(self, manoeuvre.gear_in_request)
            case Stage.WAITING_FOR_STOP:
                return manoeuvre.expected_trigger(self, manoeuvre.gear_out_request)
            case _:
                return manoeuvre.master_curve.trigger
