"""Gearing: a slave geared to a master by a whole-number ratio, engaged and disengaged by one level signal.

Source: MOVIKIT gearing; its mechanism with a reference position. README.md says what is decided where it is silent.
"""

from dataclasses import dataclass

from .. import var
from ..grid import ROUNDING, first_ahead, grid_tolerance, nearest, rounding, wrap
from ..laws import chain_rule
from ..limits import clamp
from ..slave import Edge
from ..var import LARGEST_INPUT
from .curves import SAME_TIME, MasterCurve, TimeCurve, gear_in_curve, gear_out_curve
from .faults import Fault, Refusal
from .interface import GearingInterface, Ratio, State, Transition
from .line import Line, direction_of
from .order import Aim, Order, gear_in_fault, gear_out_fault, ratio_fault, transition_fault
from .stage import Stage, state_of

STANDING = 1e-13  # of the speed in a step: what rounding leaves of a velocity that comes to 0
ON_LINE = 1e-9  # of the master's position, at least of 1 u: so near to the line the slave is on it
FARTHEST = 1e25  # u: the master never comes so far; a period beyond it is none
EVENTS = 16  # in a monotone piece of the master's path there are eight at most


@dataclass(slots=True)
class Gearing(GearingInterface):
    """Gears a slave to a master by a whole-number ratio, on a straight line through a point that can be chosen.

    In gear the slave is at s_a + numerator (m - m_a) / denominator. A rising edge of start engages it, a falling edge
    disengages it; `gear_in.start_mode` and `gear_out.stop_mode` say where and in which direction of the master,
    `transition` how: without any, the velocity jumps; master-based, the slave follows a curve over the master's
    position, and back along it should the master turn round; time-based, it is on the line, or at rest, after a time,
    whatever the master does meanwhile.
    """

    # What the inputs were when the commands were carried out last.
    active_before: bool = True
    start_before: bool = False
    ratio_before: Ratio = var.part(Ratio, hidden=True)
    reset_edge: Edge = var.part(Edge)
    set_master_edge: Edge = var.part(Edge)
    set_slave_edge: Edge = var.part(Edge)

    # What drives the slave, and what it has been told to do.
    stage: Stage = Stage.STOPPED
    state_when_frozen: State = State.STOPPED  # what is shown while FROZEN
    order_in: Order = var.part(Order)
    order_out: Order = var.part(Order)
    edge_queued: bool = False  # an edge of start that came during a transition acts at the transition's end

    # Where the line lies, and the synchronous point, both axes' positions when the slave was last in gear, u.
    line: Line = var.part(Line)
    synchronous_master: float = 0.0
    synchronous_slave: float = 0.0

    # The transition under way. Positions of the slave are unwrapped.
    master_curve: MasterCurve = var.part(MasterCurve)
    time_curve: TimeCurve = var.part(TimeCurve)
    trigger_kept: bool = False  # a direct transition that has fallen back waits for its own trigger
    begin_position: float = 0.0  # the slave's at the transition's beginning, u
    target_position: float = 0.0  # where the slave comes to rest after the transition, u
    rest_position: float = 0.0  # where the slave rests, u
    unwrapped_position: float = 0.0  # the slave's setpoint before it is wrapped, u

    # How far along the master's path the step is carried out: the master's place there, u, and the time since the
    # step's beginning, s.
    place_now: float = 0.0
    time_now: float = 0.0
    direction_since_order: float = 0.0  # of the master's last motion since the order began to wait; 0: none yet
    last_direction: float = 0.0  # of the master's last motion; 0: none yet

    def initialize(self) -> Refusal:
        """STOPPED at the initial position; may be called again while parameters and inputs still change."""
        refusal = self.start_refusal()
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.active_before = self.activate
        self.start_before = self.start
        self.reset_edge.hold(self.reset)
        self.set_master_edge.hold(self.set_master.execute)
        self.set_slave_edge.hold(self.set_slave.execute)
        self.use_ratio()
        self.rest_position = self.slave.initial_position
        self.synchronous_slave = self.rest_position
        self.line.lay_through(0.0, self.rest_position)
        self.set_line_offset()
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    def start_refusal(self) -> Refusal:
        """Why the start values of the block's own parameters are refused; NONE: they are not."""
        if self.gearing.denominator == 0:
            return Refusal.DENOMINATOR
        if self.gearing.numerator == 0:
            return Refusal.NUMERATOR
        if transition_fault(self.gear_in.transition, 0.0, self.gear_in.time) != Fault.NONE:
            return Refusal.GEAR_IN_TIME
        if transition_fault(self.gear_out.transition, 0.0, self.gear_out.time) != Fault.NONE:
            return Refusal.GEAR_OUT_TIME
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the master's path in the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(0)
        self.obey()
        for piece in range(1, self.master.path.pieces):
            self.travel(piece)
        self.time_curve.advance(h)
        self.rebase()  # before the setpoint is computed: from smaller positions it has more of its last bits
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands of the step, with the master where the present input says."""
        self.obey_ratio()
        self.obey_activate()
        self.obey_start()
        self.obey_reset()
        self.obey_synchronous_point()

    def obey_ratio(self) -> None:
        """A changed ratio acts at once while the slave is on the line, is on its way there, or waits. Else it acts at
        the next engagement."""
        before = self.ratio_before
        if before.numerator == self.gearing.numerator and before.denominator == self.gearing.denominator:
            return
        var.copy(self.ratio_before, self.gearing)
        match self.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                pass
            case _:
                fault = ratio_fault(self.gearing)
                if fault == Fault.NONE:
                    self.change_ratio()
                else:
                    self.error_id = fault

    def change_ratio(self) -> None:
        """Use the new ratio: the line, or the curve, turns about the point where both axes are."""
        match self.stage:
            case Stage.WAITING_FOR_START:
                self.use_ratio()
                self.lay_known_line()
            case Stage.GEAR_IN_MASTER_BASED:
                travel, _, _, _ = gear_in_curve(self.master_curve.travel(self.place_now), self.master_curve.distance)
                before = self.line.scaled(self.master_curve.direction * travel)
                self.use_ratio()
                self.begin_position += before - self.line.scaled(self.master_curve.direction * travel)
                self.line.slave = self.begin_position
                self.set_line_offset()
            case _:
                self.line.lay_through(self.place_now, self.line.at(self.place_now))
                self.use_ratio()
                self.set_line_offset()

    def use_ratio(self) -> None:
        """The ratio that is set becomes the line's."""
        var.copy(self.ratio_before, self.gearing)
        self.line.numerator = self.gearing.numerator
        self.line.denominator = self.gearing.denominator

    def obey_activate(self) -> None:
        """A falling edge of activate freezes the slave; a frozen block that is activated again is STOPPED."""
        if self.active_before and not self.activate:
            self.freeze()
        elif self.stage == Stage.FROZEN and self.activate:
            self.enter_stopped()
        self.active_before = self.activate

    def freeze(self) -> None:
        """The slave stops where it is."""
        if self.stage == Stage.ACTIVE:
            self.save_synchronous_point()
        self.set_slave_here()
        self.rest_position = self.unwrapped_position
        self.edge_queued = False
        self.enter_frozen()

    def obey_start(self) -> None:
        """The edges of start; while the block is not active they are lost."""
        if self.activate and self.start and not self.start_before:
            self.command_start()
        if self.activate and self.start_before and not self.start:
            self.command_stop()
        self.start_before = self.start

    def command_start(self) -> None:
        """The rising edge of start."""
        match self.stage:
            case Stage.STOPPED:
                if self.try_order_gear_in():
                    self.engage()
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_IN_TIME_BASED:
                self.take_back_queued_edge()
            case Stage.WAITING_FOR_STOP:
                self.error_id = Fault.NONE
                self.enter_active()
            case Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                if self.try_order_gear_in():
                    self.engage_from_transition()
            case _:
                pass

    def command_stop(self) -> None:
        """The falling edge of start."""
        match self.stage:
            case Stage.WAITING_FOR_START:
                self.error_id = Fault.NONE
                self.enter_stopped()
            case Stage.ACTIVE:
                if self.try_order_gear_out():
                    self.disengage()
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_IN_TIME_BASED:
                if self.try_order_gear_out():
                    self.disengage_from_transition()
            case Stage.GEAR_OUT_MASTER_BASED | Stage.GEAR_OUT_TIME_BASED:
                self.take_back_queued_edge()
            case _:
                pass

    def take_back_queued_edge(self) -> None:
        """If an edge waits for the end of the transition, the contrary edge takes it back: neither of them acts."""
        if self.edge_queued:
            self.edge_queued = False
            self.error_id = Fault.NONE

    def try_order_gear_in(self) -> bool:
        """Judge and read what an engagement needs; whether it is accepted. `error_id` tells the fault, or none."""
        self.error_id = ratio_fault(self.gearing)
        if self.error_id == Fault.NONE:
            self.error_id = gear_in_fault(self.gear_in)
        if self.error_id != Fault.NONE:
            return False
        self.order_in.read_gear_in(self.gear_in)
        return True

    def try_order_gear_out(self) -> bool:
        """Judge and read what a disengagement needs; whether it is accepted. `error_id` tells the fault, or none."""
        self.error_id = gear_out_fault(self.gear_out)
        if self.error_id != Fault.NONE:
            return False
        self.order_out.read_gear_out(self.gear_out)
        return True

    def obey_reset(self) -> None:
        """A rising edge of reset clears the fault; a frozen block then shows STOPPED."""
        if self.reset_edge.rising(self.reset):
            self.error_id = Fault.NONE
            if self.stage == Stage.FROZEN:
                self.state_when_frozen = State.STOPPED
                self.local.progress = 0.0

    def obey_synchronous_point(self) -> None:
        """Rising edges set the halves of the synchronous point while the block is not active; the slave's half sets the
        slave's position, too."""
        if self.set_master_edge.rising(self.set_master.execute) and not self.activate:
            self.synchronous_master = self.set_master.value
            self.error_id = Fault.NONE
        if self.set_slave_edge.rising(self.set_slave.execute) and not self.activate:
            self.synchronous_slave = self.set_slave.value
            self.rest_position = self.set_slave.value
            self.error_id = Fault.NONE

    # --- the stages are entered ---

    def enter_stopped(self) -> None:
        """The slave rests at `rest_position`."""
        self.stage = Stage.STOPPED

    def enter_frozen(self) -> None:
        """The slave rests at `rest_position`; the state that is shown stays."""
        self.state_when_frozen = state_of(self.stage, self.state_when_frozen)
        self.stage = Stage.FROZEN

    def enter_waiting_for_start(self, trigger_kept: bool) -> None:
        """The slave rests at `rest_position` until `order_in` can begin, or begin again at its own trigger."""
        self.stage = Stage.WAITING_FOR_START
        self.trigger_kept = trigger_kept

    def enter_gear_in_master_based(self) -> None:
        """The curve begins at `trigger`, `begin_position`."""
        self.stage = Stage.GEAR_IN_MASTER_BASED

    def enter_gear_in_time_based(self) -> None:
        """What the slave, as it was set last, lacks to the line in position, velocity and acceleration comes to 0."""
        self.stage = Stage.GEAR_IN_TIME_BASED
        self.time_curve.begin(
            self.time_now,
            self.order_in.time,
            self.unwrapped_position - self.line.at(self.place_now),
            self.slave.velocity - self.line.scaled(self.master.velocity_at(self.time_now)),
            self.slave.acceleration - self.line.scaled(self.master.mean_acceleration()),
            0.0,
        )

    def enter_active(self) -> None:
        """The slave is on the line."""
        self.stage = Stage.ACTIVE

    def enter_waiting_for_stop(self, trigger_kept: bool) -> None:
        """The slave stays on the line until `order_out` can begin, or begin again at its own trigger."""
        self.stage = Stage.WAITING_FOR_STOP
        self.trigger_kept = trigger_kept

    def enter_gear_out_master_based(self) -> None:
        """The curve begins at `trigger`, `begin_position`."""
        self.stage = Stage.GEAR_OUT_MASTER_BASED

    def enter_gear_out_time_based(self) -> None:
        """The slave comes from its motion, as it was set last, to rest at `target_position`."""
        self.stage = Stage.GEAR_OUT_TIME_BASED
        self.time_curve.begin(
            self.time_now,
            self.order_out.time,
            self.unwrapped_position,
            self.slave.velocity,
            self.slave.acceleration,
            self.target_position,
        )

    # --- engaging ---

    def engage(self) -> None:
        """From rest: `order_in` begins here if its condition is met; else it waits."""
        self.direction_since_order = 0.0
        self.enter_waiting_for_start(False)
        self.set_slave_here()
        self.use_ratio()
        self.lay_known_line()
        direction = self.master_direction()
        if self.is_on_synchronous_line():
            self.continue_synchronized()
        elif self.begins_by_motion(self.order_in) and self.order_in.is_met_by(direction):
            self.begin_gear_in_here(direction)

    def engage_from_transition(self) -> None:
        """On the way to rest: a time-based engagement begins here if its condition is met; any other waits for rest."""
        direction = self.master_direction()
        if self.order_in.transition == Transition.TIME_BASED and self.order_in.is_met_by(direction):
            self.set_slave_here()
            self.edge_queued = False
            self.use_ratio()
            self.begin_gear_in_here(direction)
        else:
            self.edge_queued = True

    def begins_by_motion(self, order: Order) -> bool:
        """Whether the order's condition is the master's motion alone, not a trigger that the master crosses."""
        return order.transition == Transition.TIME_BASED or (order.aim == Aim.DIRECT and not self.trigger_kept)

    def reference_position(self, slave: float) -> float:
        """m_a, any occurrence of it, for a slave that is at s_a = `slave`, u; unless the engagement is direct."""
        if self.order_in.aim == Aim.SYNCHRONOUS_POINT:
            return self.synchronous_master + self.line.unscaled(slave - self.synchronous_slave)
        return self.order_in.position

    def lay_known_line(self) -> None:
        """At rest: lay the line if the order tells it beforehand, by a position or by the synchronous point."""
        if self.order_in.aim != Aim.DIRECT:
            self.line.lay_through(self.reference_position(self.rest_position), self.rest_position)
            self.set_line_offset()

    def is_on_synchronous_line(self) -> bool:
        """Whether the slave, at rest, is on the line of the synchronous point already, and no transition is ordered:
        then it is in gear at once."""
        if self.order_in.aim != Aim.SYNCHRONOUS_POINT or self.order_in.transition != Transition.NONE:
            return False
        return abs(self.place_now - self.nearest_reference()) <= ON_LINE * max(1.0, abs(self.place_now))

    def nearest_reference(self) -> float:
        """Of the occurrences of m_a for a slave at rest the one nearest to the master."""
        return nearest(self.reference_position(self.rest_position), self.occurrence_spacing(), self.place_now)

    def continue_synchronized(self) -> None:
        """The slave, at rest, is in gear on the line of the synchronous point."""
        self.master_curve.trigger = self.nearest_reference()
        self.line.lay_through(self.master_curve.trigger, self.rest_position)
        self.enter_active()

    def begin_gear_in_here(self, direction: float) -> None:
        """The condition of a direct or time-based engagement is met here; the slave is as it was set last."""
        self.master_curve.begin(self.place_now, direction, self.order_in.distance)
        self.begin_position = self.unwrapped_position
        reference = self.place_now + self.master_curve.half()
        if self.order_in.aim != Aim.DIRECT:
            reference = first_ahead(
                self.reference_position(self.unwrapped_position),
                self.occurrence_spacing(),
                direction,
                self.place_now,
                True,
            )
        self.line.lay_through(reference, self.unwrapped_position)
        self.begin_gear_in()

    def begin_gear_in(self) -> None:
        """The transition on to the line begins here; `trigger`, `begin_position` and `line` are known."""
        self.set_line_offset()
        match self.order_in.transition:
            case Transition.MASTER_BASED:
                self.enter_gear_in_master_based()
            case Transition.TIME_BASED:
                self.enter_gear_in_time_based()
            case _:
                self.enter_active()

    def fall_back_to_rest(self) -> None:
        """The master has gone back before the trigger: the slave rests where the transition began. A falling edge that
        waits has nothing left to do."""
        self.rest_position = self.begin_position
        if self.edge_queued:
            self.enter_stopped()
        else:
            self.enter_waiting_for_start(self.order_in.aim == Aim.DIRECT)
        self.edge_queued = False
        self.lay_known_line()

    def save_synchronous_point(self) -> None:
        """Both axes' positions here, as ACTIVE is left."""
        self.synchronous_master = self.place_now
        self.synchronous_slave = self.line.at(self.place_now)

    # --- disengaging ---

    def disengage(self) -> None:
        """From the line: `order_out` begins here if its condition is met; else it waits."""
        direction = self.master_direction()
        self.set_slave_here()
        self.save_synchronous_point()
        self.direction_since_order = 0.0
        self.enter_waiting_for_stop(False)
        if self.begins_by_motion(self.order_out) and self.order_out.is_met_by(direction):
            self.begin_gear_out_here(direction)

    def disengage_from_transition(self) -> None:
        """On the way to the line: a time-based disengagement, or a direct one without transition, begins here; any
        other waits for the line."""
        self.set_slave_here()
        at_once = self.order_out.transition == Transition.NONE and self.order_out.aim == Aim.DIRECT
        if at_once or self.order_out.transition == Transition.TIME_BASED:
            self.edge_queued = False
            self.begin_gear_out_here(self.master_direction())
        else:
            self.edge_queued = True

    def begin_gear_out_here(self, direction: float) -> None:
        """The condition of a direct or time-based disengagement is met here; the slave is as it was set last."""
        self.master_curve.begin(self.place_now, direction, self.order_out.distance)
        self.begin_position = self.unwrapped_position
        self.target_position = self.unwrapped_position
        if self.order_out.aim == Aim.POSITION:
            self.target_position = self.stop_position_ahead(direction)
        self.begin_gear_out()

    def stop_position_ahead(self, direction: float) -> float:
        """The stop position for a time-based disengagement, in the turn in which the slave comes to it first while the
        master moves in this direction; with the master at rest in the nearest turn."""
        slave_direction = direction_of(self.line.scaled(direction), 0.0)
        if slave_direction == 0.0:
            return nearest(self.order_out.position, self.slave.period, self.unwrapped_position)
        return first_ahead(self.order_out.position, self.slave.period, slave_direction, self.unwrapped_position, True)

    def begin_gear_out(self) -> None:
        """The transition to rest begins here; `trigger`, `begin_position` and `target_position` are known."""
        match self.order_out.transition:
            case Transition.MASTER_BASED:
                self.enter_gear_out_master_based()
            case Transition.TIME_BASED:
                self.enter_gear_out_time_based()
            case _:
                self.come_to_rest()

    def come_to_rest(self) -> None:
        """The slave rests at the target. With a period that is the stop position itself, without whole turns."""
        self.rest_position = self.target_position
        if self.order_out.aim == Aim.POSITION and self.slave.period > 0.0:
            self.rest_position = wrap(self.order_out.position, self.slave.period)
            self.synchronous_slave -= self.target_position - self.rest_position
        self.enter_stopped()

    def fall_back_to_line(self) -> None:
        """The master has gone back before the trigger: the slave is on the line. A rising edge that waits puts it in
        gear."""
        if self.edge_queued:
            self.take_back_queued_edge()
            self.enter_active()
        else:
            self.enter_waiting_for_stop(self.order_out.aim == Aim.DIRECT)

    # --- the master's path ---

    def travel(self, piece: int) -> None:
        """Carry out the events on a monotone piece of the master's path one after the other."""
        begin = self.master.path.places[piece]
        end = self.master.path.places[piece + 1]
        self.place_now = begin
        self.time_now = self.master.path.times[piece]
        for _ in range(EVENTS):
            if not self.try_event(piece, end):
                break
        self.place_now = end
        self.time_now = self.master.path.times[piece + 1]
        if not self.is_same_place(begin, end):
            self.direction_since_order = self.direction_in(piece)
            self.last_direction = self.direction_in(piece)

    def try_event(self, piece: int, end: float) -> bool:
        """Carry out the next event on the rest of the piece, which leads to `end`, u; whether there was one."""
        happened = False
        match self.stage:
            case Stage.STOPPED:
                happened = self.try_event_stopped()
            case Stage.FROZEN:
                pass
            case Stage.WAITING_FOR_START:
                happened = self.try_event_waiting_for_start(piece, end)
            case Stage.GEAR_IN_MASTER_BASED:
                happened = self.try_event_gear_in_master_based(piece, end)
            case Stage.GEAR_IN_TIME_BASED:
                happened = self.try_event_gear_in_time_based(piece, end)
            case Stage.ACTIVE:
                happened = self.try_event_active()
            case Stage.WAITING_FOR_STOP:
                happened = self.try_event_waiting_for_stop(piece, end)
            case Stage.GEAR_OUT_MASTER_BASED:
                happened = self.try_event_gear_out_master_based(piece, end)
            case Stage.GEAR_OUT_TIME_BASED:
                happened = self.try_event_gear_out_time_based(piece, end)
        return happened

    def try_event_stopped(self) -> bool:
        """At rest: a rising edge that has waited for the end of a disengagement acts."""
        if not self.edge_queued:
            return False
        self.edge_queued = False
        if self.try_order_gear_in():
            self.engage()
        return True

    def try_event_waiting_for_start(self, piece: int, end: float) -> bool:
        """At rest: the master moves as it has to, or crosses a trigger."""
        direction = self.direction_in(piece)
        if self.begins_by_motion(self.order_in):
            if not (self.order_in.allows(direction) and self.is_motion(piece)):
                return False
            self.set_slave_here()
            self.begin_gear_in_here(direction)
            return True
        if not self.crosses_trigger(self.order_in, piece, end):
            return False
        self.go_to_trigger(self.order_in, piece)
        self.set_slave_here()
        self.begin_position = self.rest_position
        self.line.lay_through(self.master_curve.trigger + self.master_curve.half(), self.rest_position)
        self.begin_gear_in()
        return True

    def try_event_gear_in_master_based(self, piece: int, end: float) -> bool:
        """On the curve to the line: its end is reached, or the master goes back before its beginning."""
        curve = self.master_curve
        if self.is_first_motion(end):
            curve.direction = direction_of(end - curve.trigger, 0.0)
            self.line.master = curve.trigger + curve.half()
            self.set_line_offset()
        if curve.is_reached_at(end):
            self.go_to(piece, curve.end())
            self.enter_active()
            return True
        if curve.is_left_at(end):
            self.go_to(piece, curve.trigger)
            self.fall_back_to_rest()
            return True
        return False

    def try_event_gear_in_time_based(self, piece: int, end: float) -> bool:
        """On the way to the line: its time is over."""
        if not self.is_time_over_in(piece):
            return False
        self.go_to_end_of_time(piece, end)
        self.enter_active()
        return True

    def try_event_active(self) -> bool:
        """On the line: a falling edge that has waited for the end of an engagement acts."""
        if not self.edge_queued:
            return False
        self.edge_queued = False
        if self.try_order_gear_out():
            self.disengage()
        return True

    def try_event_waiting_for_stop(self, piece: int, end: float) -> bool:
        """On the line: the master moves as it has to, or crosses a trigger."""
        direction = self.direction_in(piece)
        if self.begins_by_motion(self.order_out):
            if not (self.order_out.allows(direction) and self.is_motion(piece)):
                return False
            self.set_slave_here()
            self.begin_gear_out_here(direction)
            return True
        if not self.crosses_trigger(self.order_out, piece, end):
            return False
        self.go_to_trigger(self.order_out, piece)
        half = self.line.scaled(self.master_curve.half())
        self.begin_position = self.line.at(self.master_curve.trigger)
        self.target_position = self.begin_position + half
        if self.order_out.aim == Aim.POSITION:
            self.target_position = nearest(self.order_out.position, self.slave.period, self.target_position)
            self.begin_position = self.target_position - half
        self.begin_gear_out()
        return True

    def try_event_gear_out_master_based(self, piece: int, end: float) -> bool:
        """On the curve to rest: its end is reached, or the master goes back before its beginning."""
        curve = self.master_curve
        if self.is_first_motion(end):
            curve.direction = direction_of(end - curve.trigger, 0.0)
        if curve.is_reached_at(end):
            self.go_to(piece, curve.end())
            if self.order_out.aim == Aim.DIRECT:
                self.target_position = self.begin_position + self.line.scaled(curve.half())
            self.come_to_rest()
            return True
        if curve.is_left_at(end):
            self.go_to(piece, curve.trigger)
            self.fall_back_to_line()
            return True
        return False

    def try_event_gear_out_time_based(self, piece: int, end: float) -> bool:
        """On the way to rest: its time is over."""
        if not self.is_time_over_in(piece):
            return False
        self.go_to_end_of_time(piece, end)
        self.come_to_rest()
        return True

    # --- where the master is, and where it goes ---

    def direction_in(self, piece: int) -> float:
        """In which direction a piece of the path leads: 1, -1, or 0 if it leads nowhere."""
        return direction_of(self.master.path.places[piece + 1] - self.master.path.places[piece], 0.0)

    def master_direction(self) -> float:
        """In which direction the master moves at this instant: 1, -1, or 0 at rest."""
        return direction_of(self.master.velocity_at(self.time_now), self.master.mean_acceleration())

    def go_to(self, piece: int, place: float) -> None:
        """Further along the piece, to a place on it; the input correction takes no time."""
        if piece > 0:
            self.time_now = max(self.time_now, self.master.path.crossing(piece, place))
        self.place_now = place

    def is_same_place(self, a: float, b: float) -> bool:
        """Whether two positions of the master differ by rounding only, that of the input in its turn included."""
        return abs(a - b) <= rounding(a, b) + ROUNDING * min(self.master.period, LARGEST_INPUT)

    def is_motion(self, piece: int) -> bool:
        """Whether the master moves in the rest of a piece. The input correction is no motion, nor is what rounding
        leaves of a standstill."""
        if piece == 0 or self.master.path.times[piece + 1] - self.time_now <= SAME_TIME * self.master.step:
            return False
        if self.master.begin_velocity != 0.0 or self.master.end_velocity != 0.0:
            return True
        return not self.is_same_place(self.master.path.places[piece], self.master.path.places[piece + 1])

    def passes_end(self, piece: int, direction: float) -> bool:
        """Whether the master, at the end of a piece that leads in this direction, goes on; else it turns or rests."""
        velocity = 0.0
        if piece == 0:
            velocity = self.master.begin_velocity
        elif piece == self.master.path.pieces - 1:
            velocity = self.master.end_velocity
        highest = max(abs(self.master.begin_velocity), abs(self.master.end_velocity))
        return direction * velocity > STANDING * highest

    def occurrence_spacing(self) -> float:
        """The distance between the occurrences of a position of the master; 0: there is but one."""
        return self.master.period if self.master.period <= FARTHEST else 0.0

    # --- the triggers ---

    def triggers(self, order: Order, direction: float) -> tuple[float, float]:
        """One of the triggers of a waiting order for this direction of the master, and the distance between them; 0:
        there is but one."""
        half = direction * (0.5 * order.distance)
        if self.trigger_kept:
            return self.master_curve.trigger, self.occurrence_spacing()
        if self.stage == Stage.WAITING_FOR_START:
            return self.reference_position(self.rest_position) - half, self.occurrence_spacing()
        stop = self.line.master + self.line.unscaled(order.position - self.line.slave)
        return stop - half, abs(self.line.unscaled(self.slave.period))

    def next_trigger(self, order: Order, direction: float, place: float) -> float:
        """The first trigger ahead of a place of the master. One at that place counts unless the master has come from
        beyond it since the order waits."""
        base, spacing = self.triggers(order, direction)
        return first_ahead(base, spacing, direction, place, not self.has_turned(direction))

    def has_turned(self, direction: float) -> bool:
        """Whether the master moved the other way before, since the order waits."""
        return self.direction_since_order == -direction

    def crosses_trigger(self, order: Order, piece: int, end: float) -> bool:
        """Whether there is a trigger on the rest of the piece at which the order begins.

        The master may begin on the trigger, unless it has come there from beyond, and may end on it, if it goes on."""
        direction = self.direction_in(piece)
        if not order.allows(direction) or (self.trigger_kept and direction != self.master_curve.direction):
            return False
        base, spacing = self.triggers(order, direction)
        trigger = self.next_trigger(order, direction, self.place_now)
        margin = grid_tolerance(base, spacing, self.place_now)
        missing = direction * (trigger - self.place_now)
        if missing < -margin or (self.has_turned(direction) and missing <= margin):
            return False
        margin = grid_tolerance(base, spacing, end)
        missing = direction * (trigger - end)
        return missing < -margin or (missing <= margin and self.passes_end(piece, direction))

    def go_to_trigger(self, order: Order, piece: int) -> None:
        """To the next trigger, which lies on the piece: the transition begins there."""
        direction = self.direction_in(piece)
        self.master_curve.begin(self.next_trigger(order, direction, self.place_now), direction, order.distance)
        self.go_to(piece, self.master_curve.trigger)

    # --- a transition under way ---

    def is_first_motion(self, end: float) -> bool:
        """Whether a master-based transition that began at rest gets its direction now, from the master's first motion,
        which leads to `end`."""
        return self.master_curve.direction == 0.0 and not self.is_same_place(end, self.master_curve.trigger)

    def is_time_over_in(self, piece: int) -> bool:
        """Whether the time of a time-based transition is over at the end of the piece; the input correction takes no
        time."""
        return piece > 0 and self.time_curve.is_over(self.master.path.times[piece + 1])

    def go_to_end_of_time(self, piece: int, end: float) -> None:
        """To where the master is when the time of a time-based transition is over; that is in this piece."""
        last = self.master.path.times[piece + 1]
        time = clamp(self.time_curve.time_left(), self.time_now, last)
        self.place_now = end if time >= last else self.master.path.position(time)
        self.time_now = time

    def rebase(self) -> None:
        """Drop whole turns, so that positions keep their last bits; not while a transition lies at a particular turn.

        On the line the slave travels on with each turn of the master: turns are dropped if the slave has turns too."""
        geared = False
        match self.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.WAITING_FOR_START:
                pass
            case Stage.ACTIVE | Stage.WAITING_FOR_STOP:
                geared = True
            case _:
                return
        period = self.slave.period
        if geared and period == 0.0:
            return
        before = self.master.end
        self.master.rebase()
        turned = before - self.master.end
        self.master_curve.trigger -= turned
        if geared:
            self.line.slave += self.line.scaled(turned)
        if period > 0.0:
            place = self.line.at(self.master.end) if geared else self.rest_position
            turned = place - wrap(place, period)
            self.line.slave -= turned
            self.synchronous_slave -= turned
            self.rest_position = wrap(self.rest_position, period)

    # --- the setpoint at an instant ---

    def set_slave_here(self) -> None:
        """Set the slave's motion at the instant up to which the step is carried out."""
        self.set_slave_at(
            self.time_now, self.place_now, self.master.velocity_at(self.time_now), self.master.mean_acceleration()
        )

    def set_slave_at(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """Set the slave's motion at a time since the step's beginning, with the master there and moving so."""
        match self.stage:
            case Stage.STOPPED | Stage.FROZEN | Stage.WAITING_FOR_START:
                self.put_slave(self.rest_position, 0.0, 0.0, 0.0)
            case Stage.GEAR_IN_MASTER_BASED:
                travel, d1, d2, d3 = gear_in_curve(self.master_curve.travel(place), self.master_curve.distance)
                self.put_slave_on_curve(travel, d1, d2, d3, velocity, acceleration)
            case Stage.GEAR_IN_TIME_BASED:
                self.put_slave_joining_line(time, place, velocity, acceleration)
            case Stage.ACTIVE | Stage.WAITING_FOR_STOP:
                line = self.line
                self.put_slave(line.at(place), line.scaled(velocity), line.scaled(acceleration), 0.0)
            case Stage.GEAR_OUT_MASTER_BASED:
                travel, d1, d2, d3 = gear_out_curve(self.master_curve.travel(place), self.master_curve.distance)
                self.put_slave_on_curve(travel, d1, d2, d3, velocity, acceleration)
            case Stage.GEAR_OUT_TIME_BASED:
                position, v, a, j = self.time_curve.at(time)
                self.put_slave(position, v, a, j)

    def put_slave_on_curve(
        self, travel: float, d1: float, d2: float, d3: float, velocity: float, acceleration: float
    ) -> None:
        """On a curve over the master's travel since the trigger, with the master moving so.

        travel, d1, d2, d3: what the curve makes of the master's travel, u, and its derivatives by it."""
        v, a, j = chain_rule(d1, self.master_curve.direction * d2, d3, velocity, acceleration)
        position = self.begin_position + self.line.scaled(self.master_curve.direction * travel)
        self.put_slave(position, self.line.scaled(v), self.line.scaled(a), self.line.scaled(j))

    def put_slave_joining_line(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """On the way to the line in time: the line's motion, and what the slave still lacks to it."""
        e, e1, e2, e3 = self.time_curve.at(time)
        line = self.line
        self.put_slave(line.at(place) + e, line.scaled(velocity) + e1, line.scaled(acceleration) + e2, e3)

    def put_slave(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        """Set the slave's motion; its position is given unwrapped."""
        self.unwrapped_position = position
        self.slave.put(wrap(position, self.slave.period), velocity, acceleration, jerk)

    # --- what is put out ---

    def set_line_offset(self) -> None:
        """Put out where the line lies; the output stays until the line is laid anew."""
        master = wrap(self.line.master, self.master.period)
        self.local.line_offset = wrap(self.line.slave, self.slave.period) - self.line.scaled(master)

    def show(self) -> None:
        """Derive what else is put out at the step's end; while FROZEN, progress and trigger stay as they were."""
        self.state = state_of(self.stage, self.state_when_frozen)
        self.state_code = self.state
        self.in_gear = self.state == State.ACTIVE
        self.error = self.error_id != Fault.NONE
        if self.stage != Stage.FROZEN:
            self.local.progress = self.transition_progress()
            self.local.trigger_position = wrap(self.shown_trigger(), self.master.period)

    def transition_progress(self) -> float:
        """The share of the transition that is done at the step's end: 1 in gear, 0 at rest and while waiting."""
        match self.stage:
            case Stage.GEAR_IN_MASTER_BASED | Stage.GEAR_OUT_MASTER_BASED:
                return self.master_curve.progress(self.master.end)
            case Stage.GEAR_IN_TIME_BASED | Stage.GEAR_OUT_TIME_BASED:
                return self.time_curve.progress()
            case Stage.ACTIVE:
                return 1.0
            case _:
                return 0.0

    def shown_trigger(self) -> float:
        """The trigger that the master crosses next while an order waits for one; else that of the last transition."""
        match self.stage:
            case Stage.WAITING_FOR_START:
                return self.awaited_trigger(self.order_in)
            case Stage.WAITING_FOR_STOP:
                return self.awaited_trigger(self.order_out)
            case _:
                return self.master_curve.trigger

    def awaited_trigger(self, order: Order) -> float:
        """The next trigger of a waiting order, seen from the step's end; the last trigger if it waits for a motion."""
        if self.begins_by_motion(order):
            return self.master_curve.trigger
        return self.next_trigger(order, self.expected_direction(order), self.master.end)

    def expected_direction(self, order: Order) -> float:
        """In which direction, 1 or -1, the master is expected to cross a waiting order's trigger: in that of
        its motion, if the order allows it."""
        if self.trigger_kept:
            return self.master_curve.direction
        direction = direction_of(self.master.end_velocity, self.master.end_acceleration)
        if direction == 0.0:
            direction = self.last_direction
        if order.allows(direction):
            return direction
        return 1.0 if order.clockwise else -1.0
