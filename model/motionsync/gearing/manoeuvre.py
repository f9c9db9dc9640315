"""Engaging and disengaging (MOVIKIT gearing). `block` is the Gearing whose settings, axes and outputs a method uses."""

from dataclasses import dataclass

from .. import var
from ..motion.laws import chain_rule
from ..numerics.grid import first_on_grid_ahead, nearest_on_grid, wrap
from .curves import MasterCurve, TimeCurve, gear_in_curve, gear_out_curve
from .faults import Fault
from .interface import GearingInterface, Ratio, State, Transition
from .line import SynchronousLine, direction_of
from .master_motion import MasterMotion, direction_in, occurrence_spacing, present_direction
from .request import ManoeuvreRequest, PositionSource, gear_in_fault, gear_out_fault, ratio_fault
from .stage import Stage, state_of
from .trigger import expected_direction, is_trigger_crossed, next_trigger

LINE_TOLERANCE = 1e-9  # of the master's position, at least of 1 u: a slave that is so near to the line is on it


@dataclass(slots=True)
class Manoeuvre:
    """The stage of the slave, the line, and the engagement or disengagement that waits or is under way.

    Positions of the slave are unwrapped.

    - state_when_frozen: the state that is shown while FROZEN.
    - gear_in_request, gear_out_request: what the last edges of start have read.
    - has_queued_edge: an edge of start that came during a transition acts at the transition's end.
    - master_motion: in which directions the master moved before.
    - ratio_before: gearing.numerator and gearing.denominator as they were read last.
    - synchronous_master, synchronous_slave: the synchronous point, where both axes were last in gear, u.
    - keeps_trigger: a direct transition that has fallen back waits for its own trigger.
    - begin_position: where the slave was at the beginning of the transition, u.
    - target_position: where the slave rests after the transition, u.
    - rest_position: where the slave is at rest, u.
    - slave_position: the slave's setpoint before it is wrapped, u.
    """

    stage: Stage = Stage.STOPPED
    state_when_frozen: State = State.STOPPED
    gear_in_request: ManoeuvreRequest = var.part(ManoeuvreRequest)
    gear_out_request: ManoeuvreRequest = var.part(ManoeuvreRequest)
    has_queued_edge: bool = False
    master_motion: MasterMotion = var.part(MasterMotion)
    ratio_before: Ratio = var.part(Ratio, hidden=True)
    line: SynchronousLine = var.part(SynchronousLine)
    synchronous_master: float = 0.0
    synchronous_slave: float = 0.0
    master_curve: MasterCurve = var.part(MasterCurve)
    time_curve: TimeCurve = var.part(TimeCurve)
    keeps_trigger: bool = False
    begin_position: float = 0.0
    target_position: float = 0.0
    rest_position: float = 0.0
    slave_position: float = 0.0

    # --- the stages are entered ---

    def enter_stopped(self) -> None:
        """The slave is at rest at `rest_position`."""
        self.stage = Stage.STOPPED

    def enter_frozen(self) -> None:
        """The slave is at rest at `rest_position`; the state that is shown stays."""
        self.state_when_frozen = state_of(self.stage, self.state_when_frozen)
        self.stage = Stage.FROZEN

    def enter_waiting_for_start(self, keeps_trigger: bool) -> None:
        """The slave is at rest at `rest_position` until the engagement can start, or start again at its own trigger."""
        self.stage = Stage.WAITING_FOR_START
        self.keeps_trigger = keeps_trigger

    def enter_gear_in_master_based(self) -> None:
        """The curve starts at `trigger`, `begin_position`."""
        self.stage = Stage.GEAR_IN_MASTER_BASED

    def enter_gear_in_time_based(self, block: GearingInterface) -> None:
        """What the slave, as it was set last, lacks to the line in position, velocity and acceleration goes to 0."""
        self.stage = Stage.GEAR_IN_TIME_BASED
        time = block.master.path.now
        e = self.slave_position - self.line.at(block.master.path.reached)
        e1 = block.slave.velocity - self.line.to_slave(block.master.velocity_at(time))
        e2 = block.slave.acceleration - self.line.to_slave(block.master.mean_acceleration())
        self.time_curve.start(time, self.gear_in_request.time, e, e1, e2, 0.0)

    def enter_active(self) -> None:
        """The slave is on the line."""
        self.stage = Stage.ACTIVE

    def enter_waiting_for_stop(self, keeps_trigger: bool) -> None:
        """The slave stays on the line until the disengagement can start, or start again at its own trigger."""
        self.stage = Stage.WAITING_FOR_STOP
        self.keeps_trigger = keeps_trigger

    def enter_gear_out_master_based(self) -> None:
        """The curve starts at `trigger`, `begin_position`."""
        self.stage = Stage.GEAR_OUT_MASTER_BASED

    def enter_gear_out_time_based(self, block: GearingInterface) -> None:
        """The slave goes from its motion, as it was set last, to rest at `target_position`."""
        self.stage = Stage.GEAR_OUT_TIME_BASED
        time = block.master.path.now
        slave = block.slave
        duration = self.gear_out_request.time
        end = self.target_position
        self.time_curve.start(time, duration, self.slave_position, slave.velocity, slave.acceleration, end)

    # --- the line ---

    def use_ratio(self, ratio: Ratio) -> None:
        """Make the ratio that is set the line's."""
        var.copy(self.ratio_before, ratio)
        self.line.numerator = ratio.numerator
        self.line.denominator = ratio.denominator

    def change_ratio(self, block: GearingInterface) -> None:
        """Use the new ratio: the line, or the curve, turns about the point where both axes are."""
        position = block.master.path.reached
        match self.stage:
            case Stage.WAITING_FOR_START:
                self.use_ratio(block.gearing)
                self.set_line_in_advance(block)
            case Stage.GEAR_IN_MASTER_BASED:
                curve = self.master_curve
                travel, _, _, _ = gear_in_curve(curve.travel(position), curve.distance)
                before = self.line.to_slave(curve.direction * travel)
                self.use_ratio(block.gearing)
                self.begin_position += before - self.line.to_slave(curve.direction * travel)
                self.line.slave = self.begin_position
                self.show_line_offset(block)
            case _:
                self.line.set_point(position, self.line.at(position))
                self.use_ratio(block.gearing)
                self.show_line_offset(block)

    def set_line_in_advance(self, block: GearingInterface) -> None:
        """At rest: set the line if the request determines it, by a position or by the synchronous point."""
        if self.gear_in_request.source != PositionSource.DIRECT:
            self.line.set_point(self.reference_position(self.rest_position), self.rest_position)
            self.show_line_offset(block)

    def reference_position(self, slave: float) -> float:
        """m_a, any occurrence of it, for a slave that is at s_a = `slave`, u; unless the engagement is direct."""
        if self.gear_in_request.source == PositionSource.SYNCHRONOUS_POINT:
            return self.synchronous_master + self.line.to_master(slave - self.synchronous_slave)
        return self.gear_in_request.position

    def save_synchronous_point(self, master: float) -> None:
        """Save both axes' positions at this instant, as ACTIVE is left; the master is there."""
        self.synchronous_master = master
        self.synchronous_slave = self.line.at(master)

    def show_line_offset(self, block: GearingInterface) -> None:
        """Set the output that shows where the line runs; it stays until the line changes."""
        master = wrap(self.line.master, block.master.period)
        block.local.line_offset = wrap(self.line.slave, block.slave.period) - self.line.to_slave(master)

    # --- engaging ---

    def try_request_gear_in(self, block: GearingInterface) -> bool:
        """Check and read the settings of an engagement; whether they are accepted. `error_id` is the fault, or NONE."""
        block.error_id = ratio_fault(block.gearing)
        if block.error_id == Fault.NONE:
            block.error_id = gear_in_fault(block.gear_in)
        if block.error_id != Fault.NONE:
            return False
        self.gear_in_request.read_gear_in(block.gear_in)
        return True

    def engage(self, block: GearingInterface) -> None:
        """From rest: the engagement starts now if its condition is met; else it waits."""
        self.master_motion.direction_since_request = 0.0
        self.enter_waiting_for_start(False)
        self.set_slave_now(block)
        self.use_ratio(block.gearing)
        self.set_line_in_advance(block)
        direction = present_direction(block.master)
        request = self.gear_in_request
        if self.is_on_synchronous_line(block):
            self.master_curve.trigger = self.nearest_reference(block)
            self.line.set_point(self.master_curve.trigger, self.rest_position)
            self.enter_active()
        elif self.starts_by_motion(request) and request.is_met_by(direction):
            self.start_gear_in_now(block, direction)

    def engage_from_transition(self, block: GearingInterface) -> None:
        """On the way to rest: a time-based engagement starts now if its condition is met; any other waits for rest."""
        direction = present_direction(block.master)
        request = self.gear_in_request
        if request.transition == Transition.TIME_BASED and request.is_met_by(direction):
            self.set_slave_now(block)
            self.has_queued_edge = False
            self.use_ratio(block.gearing)
            self.start_gear_in_now(block, direction)
        else:
            self.has_queued_edge = True

    def is_on_synchronous_line(self, block: GearingInterface) -> bool:
        """Whether the slave, at rest, is on the line of the synchronous point, and no transition is requested."""
        request = self.gear_in_request
        if request.source != PositionSource.SYNCHRONOUS_POINT or request.transition != Transition.NONE:
            return False
        distance = abs(block.master.path.reached - self.nearest_reference(block))
        return distance <= LINE_TOLERANCE * max(1.0, abs(block.master.path.reached))

    def nearest_reference(self, block: GearingInterface) -> float:
        """Of the occurrences of m_a for a slave at rest the one nearest to the master."""
        base = self.reference_position(self.rest_position)
        return nearest_on_grid(base, occurrence_spacing(block.master), block.master.path.reached)

    def start_gear_in_now(self, block: GearingInterface, direction: float) -> None:
        """Start a direct or time-based engagement, whose condition is met; the slave is as it was set last."""
        position = block.master.path.reached
        self.master_curve.start(position, direction, self.gear_in_request.distance)
        self.begin_position = self.slave_position
        reference = position + self.master_curve.half()
        if self.gear_in_request.source != PositionSource.DIRECT:
            base = self.reference_position(self.slave_position)
            reference = first_on_grid_ahead(base, occurrence_spacing(block.master), direction, position, True)
        self.line.set_point(reference, self.slave_position)
        self.start_gear_in(block)

    def start_gear_in_at_trigger(self, block: GearingInterface) -> None:
        """Start the engagement where the master crosses its trigger, in this section of its path."""
        self.go_to_trigger(block, self.gear_in_request)
        self.set_slave_now(block)
        self.begin_position = self.rest_position
        self.line.set_point(self.master_curve.trigger + self.master_curve.half(), self.rest_position)
        self.start_gear_in(block)

    def start_gear_in(self, block: GearingInterface) -> None:
        """Start the transition onto the line; `trigger`, `begin_position` and `line` are set."""
        self.show_line_offset(block)
        match self.gear_in_request.transition:
            case Transition.MASTER_BASED:
                self.enter_gear_in_master_based()
            case Transition.TIME_BASED:
                self.enter_gear_in_time_based(block)
            case _:
                self.enter_active()

    def fall_back_to_rest(self, block: GearingInterface) -> None:
        """The master has gone back before the trigger: the slave is at rest where the transition began."""
        self.rest_position = self.begin_position
        if self.has_queued_edge:
            self.enter_stopped()
        else:
            self.enter_waiting_for_start(self.waits_for_same_trigger(block, self.gear_in_request))
        self.has_queued_edge = False
        self.set_line_in_advance(block)

    # --- disengaging ---

    def try_request_gear_out(self, block: GearingInterface) -> bool:
        """Check and read the settings of a disengagement, as `try_request_gear_in` does."""
        block.error_id = gear_out_fault(block.gear_out)
        if block.error_id != Fault.NONE:
            return False
        self.gear_out_request.read_gear_out(block.gear_out)
        return True

    def disengage(self, block: GearingInterface) -> None:
        """From the line: the disengagement starts now if its condition is met; else it waits."""
        direction = present_direction(block.master)
        self.set_slave_now(block)
        self.save_synchronous_point(block.master.path.reached)
        self.master_motion.direction_since_request = 0.0
        self.enter_waiting_for_stop(False)
        request = self.gear_out_request
        if self.starts_by_motion(request) and request.is_met_by(direction):
            self.start_gear_out_now(block, direction)

    def disengage_from_transition(self, block: GearingInterface) -> None:
        """On the way to the line: one that is time-based, or direct without transition, starts now; others wait."""
        self.set_slave_now(block)
        request = self.gear_out_request
        at_once = request.transition == Transition.NONE and request.source == PositionSource.DIRECT
        if at_once or request.transition == Transition.TIME_BASED:
            self.has_queued_edge = False
            self.start_gear_out_now(block, present_direction(block.master))
        else:
            self.has_queued_edge = True

    def start_gear_out_now(self, block: GearingInterface, direction: float) -> None:
        """Start a direct or time-based disengagement, whose condition is met; the slave is as it was set last."""
        self.master_curve.start(block.master.path.reached, direction, self.gear_out_request.distance)
        self.begin_position = self.slave_position
        self.target_position = self.slave_position
        if self.gear_out_request.source == PositionSource.POSITION:
            self.target_position = self.stop_position_ahead(block, direction)
        self.start_gear_out(block)

    def stop_position_ahead(self, block: GearingInterface, direction: float) -> float:
        """The stop position for a time-based disengagement, in the turn in which the slave reaches it first while the
        master moves in this direction; with the master at rest in the nearest turn."""
        stop = self.gear_out_request.position
        slave_direction = direction_of(self.line.to_slave(direction), 0.0)
        if slave_direction == 0.0:
            return nearest_on_grid(stop, block.slave.period, self.slave_position)
        return first_on_grid_ahead(stop, block.slave.period, slave_direction, self.slave_position, True)

    def start_gear_out_at_trigger(self, block: GearingInterface) -> None:
        """Start the disengagement where the master crosses its trigger, in this section of its path."""
        request = self.gear_out_request
        self.go_to_trigger(block, request)
        half = self.line.to_slave(self.master_curve.half())
        self.begin_position = self.line.at(self.master_curve.trigger)
        self.target_position = self.begin_position + half
        if request.source == PositionSource.POSITION:
            self.target_position = nearest_on_grid(request.position, block.slave.period, self.target_position)
            self.begin_position = self.target_position - half
        self.start_gear_out(block)

    def start_gear_out(self, block: GearingInterface) -> None:
        """Start the transition to rest; `trigger`, `begin_position` and `target_position` are set."""
        match self.gear_out_request.transition:
            case Transition.MASTER_BASED:
                self.enter_gear_out_master_based()
            case Transition.TIME_BASED:
                self.enter_gear_out_time_based(block)
            case _:
                self.stop_at_target(block)

    def stop_at_target(self, block: GearingInterface) -> None:
        """Rest at the target. With a period that is the stop position itself, without whole turns."""
        self.rest_position = self.target_position
        if self.gear_out_request.source == PositionSource.POSITION and block.slave.period > 0.0:
            self.rest_position = wrap(self.gear_out_request.position, block.slave.period)
            self.synchronous_slave -= self.target_position - self.rest_position
        self.enter_stopped()

    def fall_back_to_line(self, block: GearingInterface) -> None:
        """The master has gone back before the trigger: the slave is on the line; a waiting edge engages it."""
        if self.has_queued_edge:
            self.cancel_queued_edge(block)
            self.enter_active()
        else:
            self.enter_waiting_for_stop(self.waits_for_same_trigger(block, self.gear_out_request))

    def cancel_queued_edge(self, block: GearingInterface) -> None:
        """If an edge waits for the end of the transition, the contrary edge cancels it: neither of them acts."""
        if self.has_queued_edge:
            self.has_queued_edge = False
            block.error_id = Fault.NONE

    # --- the transition's end ---

    def end_transition(self, block: GearingInterface) -> None:
        """The slave has reached the line, or its target, at which it rests."""
        if self.stage in (Stage.GEAR_IN_MASTER_BASED, Stage.GEAR_IN_TIME_BASED):
            self.enter_active()
            return
        if self.stage == Stage.GEAR_OUT_MASTER_BASED and self.gear_out_request.source == PositionSource.DIRECT:
            self.target_position = self.begin_position + self.line.to_slave(self.master_curve.half())
        self.stop_at_target(block)

    # --- the triggers ---

    def waits_for_same_trigger(self, block: GearingInterface, request: ManoeuvreRequest) -> bool:
        """Whether a request that has fallen back waits for its own trigger: a direct one, whose direction was that of
        the master. The direction of a measured one at rest was noise; the request waits for a motion again."""
        return request.source == PositionSource.DIRECT and not block.master.is_measured()

    def starts_by_motion(self, request: ManoeuvreRequest) -> bool:
        """Whether the condition is the master's motion alone, not a trigger that the master crosses."""
        is_direct = request.source == PositionSource.DIRECT and not self.keeps_trigger
        return request.transition == Transition.TIME_BASED or is_direct

    def triggers(self, block: GearingInterface, request: ManoeuvreRequest, direction: float) -> tuple[float, float]:
        """A trigger of a waiting request for this direction of the master, and the distance to the next; 0: none."""
        half = direction * (0.5 * request.distance)
        if self.keeps_trigger:
            return self.master_curve.trigger, occurrence_spacing(block.master)
        if self.stage == Stage.WAITING_FOR_START:
            return self.reference_position(self.rest_position) - half, occurrence_spacing(block.master)
        stop = self.line.master + self.line.to_master(request.position - self.line.slave)
        return stop - half, abs(self.line.to_master(block.slave.period))

    def crosses_trigger(self, block: GearingInterface, request: ManoeuvreRequest) -> bool:
        """Whether the manoeuvre starts at a trigger on the rest of the section."""
        direction = direction_in(block.master.path)
        if not request.allows(direction) or (self.keeps_trigger and direction != self.master_curve.direction):
            return False
        if block.master.goes_against(direction):
            return False
        base, spacing = self.triggers(block, request, direction)
        return is_trigger_crossed(self.master_motion, block.master, base, spacing, direction)

    def go_to_trigger(self, block: GearingInterface, request: ManoeuvreRequest) -> None:
        """Go to the next trigger, which is on the section: the transition starts there."""
        direction = direction_in(block.master.path)
        base, spacing = self.triggers(block, request, direction)
        trigger = next_trigger(self.master_motion, base, spacing, direction, block.master.path.reached)
        self.master_curve.start(trigger, direction, request.distance)
        block.master.path.go_to(self.master_curve.trigger)

    def expected_trigger(self, block: GearingInterface, request: ManoeuvreRequest) -> float:
        """The next trigger of a waiting request after the step's end; the last trigger if it waits for a motion."""
        if self.starts_by_motion(request):
            return self.master_curve.trigger
        direction = self.master_curve.direction
        if not self.keeps_trigger:
            direction = expected_direction(self.master_motion, block.master, request)
        base, spacing = self.triggers(block, request, direction)
        return next_trigger(self.master_motion, base, spacing, direction, block.master.end)

    # --- the setpoint at an instant ---

    def set_slave_now(self, block: GearingInterface) -> None:
        """Set the slave's motion at the instant up to which the step is carried out."""
        time = block.master.path.now
        master = block.master
        self.set_slave_at(block, time, block.master.path.reached, master.velocity_at(time), master.mean_acceleration())

    def set_slave_at(
        self, block: GearingInterface, time: float, master: float, velocity: float, acceleration: float
    ) -> None:
        """Set the slave's motion at a time since the step's beginning, with the master there and moving so."""
        line = self.line
        match self.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.WAITING_FOR_START:
                self.set_slave(block, self.rest_position, 0.0, 0.0, 0.0)
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_OUT_MASTER_BASED:
                self.set_slave_on_curve(block, master, velocity, acceleration)
            case Stage.GEAR_IN_TIME_BASED:
                e, e1, e2, e3 = self.time_curve.at(time)  # what the slave still lacks to the line
                v = line.to_slave(velocity) + e1
                self.set_slave(block, line.at(master) + e, v, line.to_slave(acceleration) + e2, e3)
            case Stage.ACTIVE | Stage.WAITING_FOR_STOP:
                self.set_slave(block, line.at(master), line.to_slave(velocity), line.to_slave(acceleration), 0.0)
            case Stage.GEAR_OUT_TIME_BASED:
                position, v, a, j = self.time_curve.at(time)
                self.set_slave(block, position, v, a, j)

    def set_slave_on_curve(self, block: GearingInterface, master: float, velocity: float, acceleration: float) -> None:
        """Set the slave on the curve, with the master there and moving so. Before its beginning the slave goes on as it
        began: a measured master may go back there by noise."""
        curve = self.master_curve
        is_before = curve.travel(master) < 0.0 and block.master.is_measured()
        if is_before and self.stage == Stage.GEAR_OUT_MASTER_BASED:
            line = self.line
            position = self.begin_position + line.to_slave(master - curve.trigger)
            self.set_slave(block, position, line.to_slave(velocity), line.to_slave(acceleration), 0.0)
            return
        if self.stage == Stage.GEAR_IN_MASTER_BASED:
            travel, d1, d2, d3 = gear_in_curve(curve.travel(master), curve.distance)
        else:
            travel, d1, d2, d3 = gear_out_curve(curve.travel(master), curve.distance)
        v, a, j = chain_rule(d1, curve.direction * d2, d3, velocity, acceleration)
        position = self.begin_position + self.line.to_slave(curve.direction * travel)
        self.set_slave(block, position, self.line.to_slave(v), self.line.to_slave(a), self.line.to_slave(j))

    def set_slave(
        self, block: GearingInterface, position: float, velocity: float, acceleration: float, jerk: float
    ) -> None:
        """Set the slave's motion; its position is given unwrapped."""
        self.slave_position = position
        block.slave.set(wrap(position, block.slave.period), velocity, acceleration, jerk)
