"""Gearing: a slave geared to a master by a whole-number ratio, engaged and disengaged by one level signal.

Source: MOVIKIT gearing; its mechanism with a reference position. Decisions where the source is silent:

- A deactivated block shows the state, and in_gear, that it had, until a reset or until it is activated again. A reset
  while active clears the fault only. A command that sets the synchronous point is an accepted one, a ratio is none.
- A falling edge in GEAR_IN whose disengagement is direct without transition, or time-based, acts at once whichever way
  the master moves. An edge that waits for the end of a transition is taken back by the contrary one; its values are
  judged at the edge, and judged and read when it acts. If the master falls back before the trigger of GEAR_OUT, a
  rising edge that waits acts as in WAITING_FOR_STOPPOSITION.
- A ratio that is changed in GEAR_OUT, or while not active, is not looked at before the next engagement.
- A direct transition that has fallen back waits for its own trigger, with `master.period` for each occurrence of it.
- To come from beyond on to a position and turn there, with or without a rest, is no crossing; to set out from it is.
- A condition met by the master's motion is met where the motion that way begins. In time-based laws and while waiting
  the master's acceleration is the one that takes its velocity to the step's end.
- `local.progress` is 1 in ACTIVE and 0 at rest or waiting; `local.line_offset` counts from the occurrences of m_a and
  s_a in [0, period); while waiting for a motion `local.trigger_position` is that of the manoeuvre before.
- A distance or a time below 1e-9 is taken like a negative one; a mode that does not exist is fault 5.
"""

from dataclasses import dataclass

from .. import var
from ..grid import nearest, wrap
from ..laws import chain_rule
from ..limits import clamp
from ..master import Master
from ..slave import Edge
from ..var import LARGEST_INPUT, Unit
from .choices import Aim, State, Transition
from .curves import SAME_TIME, Blend, into, out
from .faults import Fault, Refusal
from .line import ROUNDING, SAME_TURN, Line, ahead, direction_of, rounding, tolerance
from .orders import GearedSlave, GearIn, GearOut, Order, Ratio, SetPoint, fault_of, gear_in_fault, gear_out_fault

STANDING = 1e-13  # of the speed in a step: what rounding leaves of a velocity that comes to 0
ON_LINE = 1e-9  # of the master's position, at least of 1 u: so near to the line the slave is on it
FARTHEST = 1e25  # u: the master never comes so far; a period beyond it is none
EVENTS = 16  # in a monotone piece of the master's path there are eight at most


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    trigger_position: float = var.local(
        0.0, "master position at which the transition begins, or has begun", Unit.POSITION
    )
    line_offset: float = var.local(
        0.0, "where the line has the slave with the master at 0", Unit.POSITION, discrete=True
    )
    progress: float = var.local(
        0.0, "share of the transition that is done, of its distance or its time", min=0.0, max=1.0
    )


@dataclass(slots=True)
class Gearing:
    """Gears a slave to a master by a whole-number ratio, on a straight line through a point that can be chosen.

    In gear the slave is at s_a + numerator (m - m_a) / denominator. A rising edge of start engages it, a falling edge
    disengages it; `gear_in.start_mode` and `gear_out.stop_mode` say where and in which direction of the master,
    `transition` how: without any, the velocity jumps; master-based, the slave follows a curve over the master's
    position, and back along it should the master turn round; time-based, it is on the line, or at rest, after a time,
    whatever the master does meanwhile.
    """

    master: Master = var.part(Master)
    activate: bool = var.input(True, "false: the slave stops at its last setpoint")
    start: bool = var.input(False, "rising edge: engage; falling edge: disengage (xStart)")
    reset: bool = var.input(False, "rising edge: clear the fault")
    gearing: Ratio = var.part(Ratio)
    gear_in: GearIn = var.part(GearIn)
    gear_out: GearOut = var.part(GearOut)
    set_master: SetPoint = var.part(SetPoint)
    set_slave: SetPoint = var.part(SetPoint)
    slave: GearedSlave = var.part(GearedSlave, depends={"position": ("slave.initial_position", "slave.period")})
    state: State = var.output(State.STOPPED, "what the slave does (eGearingState)")
    state_code: int = var.output(0, "the state as a plain integer")
    in_gear: bool = var.output(False, "the slave is on the line, and not waiting to leave it")
    error: bool = var.output(False, "a command or a ratio was refused, and no command accepted since")
    error_id: int = var.output(
        0, "why: 1 denominator 0, 2 numerator 0, 3 time, 4 distance, 5 unknown mode", codes=Fault
    )
    local: Local = var.part(Local)

    was_active: bool = True
    frozen: bool = False
    started: bool = False
    reset_edge: Edge = var.part(Edge)
    seen: Ratio = var.part(Ratio, hidden=True)
    order_in: Order = var.part(Order)
    order_out: Order = var.part(Order)
    pending: bool = False
    line: Line = var.part(Line)
    sync_master: float = 0.0
    sync_slave: float = 0.0
    timed: bool = False
    blend: Blend = var.part(Blend)
    direction: float = 0.0
    trigger: float = 0.0
    kept: bool = False
    base: float = 0.0
    target: float = 0.0
    rest: float = 0.0
    here: float = 0.0
    now: float = 0.0
    last_way: float = 0.0
    heading: float = 0.0
    position: float = 0.0

    def initialize(self) -> Refusal:
        """STOPPED at the initial position; may be called again while parameters and inputs still change."""
        if self.gearing.denominator == 0:
            return Refusal.DENOMINATOR
        if self.gearing.numerator == 0:
            return Refusal.NUMERATOR
        if fault_of(self.gear_in.transition, 0.0, self.gear_in.time) != Fault.NONE:
            return Refusal.GEAR_IN_TIME
        if fault_of(self.gear_out.transition, 0.0, self.gear_out.time) != Fault.NONE:
            return Refusal.GEAR_OUT_TIME
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.was_active = self.activate
        self.started = self.start
        self.reset_edge.before = self.reset
        self.set_master.edge.before = self.set_master.execute
        self.set_slave.edge.before = self.set_slave.execute
        self.notice_ratio()
        self.rest = self.slave.initial_position
        self.sync_slave = self.rest
        self.line.take(0.0, self.rest)
        self.mark_line()
        self.look(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the seam to the present input, the commands, then the path of the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(0, self.master.path.places[0], self.master.begin)
        self.here = self.master.begin
        self.now = 0.0
        self.obey()
        for i in range(1, self.master.path.pieces):
            self.travel(i, self.master.path.places[i], self.master.path.places[i + 1])
        self.blend.advance(h)
        self.rebase()
        self.look(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """A change of the ratio, then the edges, with the master at the path's beginning."""
        if self.seen.numerator != self.gearing.numerator or self.seen.denominator != self.gearing.denominator:
            self.seen.numerator = self.gearing.numerator
            self.seen.denominator = self.gearing.denominator
            if not self.frozen and self.state not in (State.STOPPED, State.GEAR_OUT):
                self.take_ratio()
        if self.was_active and not self.activate:
            self.deactivate()
        if self.frozen and self.activate:
            self.thaw()
        self.was_active = self.activate
        if self.activate and self.start and not self.started:
            self.command_start()
        if self.activate and self.started and not self.start:
            self.command_stop()
        self.started = self.start
        if self.reset_edge.rising(self.reset):
            self.error_id = Fault.NONE
            if self.frozen:
                self.state = State.STOPPED
                self.local.progress = 0.0
        if self.set_master.edge.rising(self.set_master.execute) and not self.activate:
            self.sync_master = self.set_master.value
            self.error_id = Fault.NONE
        if self.set_slave.edge.rising(self.set_slave.execute) and not self.activate:
            self.sync_slave = self.set_slave.value
            self.rest = self.set_slave.value
            self.error_id = Fault.NONE

    def deactivate(self) -> None:
        """The slave stops where it is; the state is shown as it was."""
        if self.state == State.ACTIVE:
            self.save_point()
        self.look_here()
        self.rest = self.position
        self.pending = False
        self.frozen = True

    def thaw(self) -> None:
        self.frozen = False
        self.state = State.STOPPED

    def command_start(self) -> None:
        """The rising edge of start."""
        match self.state:
            case State.STOPPED:
                self.act_start()
            case State.GEAR_IN:
                self.take_back()
            case State.WAITING_FOR_STOPPOSITION:
                if self.takes(Fault.NONE):
                    self.state = State.ACTIVE
            case State.GEAR_OUT:
                if self.takes(self.start_fault()):
                    self.order_in.engage(self.gear_in)
                    self.engage_again()
            case _:
                pass

    def command_stop(self) -> None:
        """The falling edge of start."""
        match self.state:
            case State.WAITING_FOR_STARTPOSITION:
                if self.takes(Fault.NONE):
                    self.state = State.STOPPED
            case State.GEAR_IN | State.ACTIVE:
                self.act_stop()
            case State.GEAR_OUT:
                self.take_back()
            case _:
                pass

    def act_start(self) -> None:
        """The rising edge acts at rest."""
        if self.takes(self.start_fault()):
            self.order_in.engage(self.gear_in)
            self.engage()

    def act_stop(self) -> None:
        """The falling edge acts on the line, or on the way to it."""
        if self.takes(gear_out_fault(self.gear_out)):
            self.order_out.disengage(self.gear_out)
            self.leave()

    def take_back(self) -> None:
        """The contrary edge waits for the end of a transition: it does not act."""
        if self.pending:
            self.pending = not self.takes(Fault.NONE)

    def start_fault(self) -> Fault:
        fault = self.gearing.fault()
        return gear_in_fault(self.gear_in) if fault == Fault.NONE else fault

    def takes(self, fault: Fault) -> bool:
        """Whether a command is accepted; it then clears what was refused before."""
        self.error_id = fault
        return fault == Fault.NONE

    def notice_ratio(self) -> None:
        """The ratio that is set becomes the line's."""
        self.seen.numerator = self.gearing.numerator
        self.seen.denominator = self.gearing.denominator
        self.line.numerator = self.gearing.numerator
        self.line.denominator = self.gearing.denominator

    def take_ratio(self) -> None:
        """A ratio of 0 is refused; another one takes effect here: the line, or the curve, turns about this point."""
        fault = self.gearing.fault()
        if fault != Fault.NONE:
            self.error_id = fault
            return
        if self.state == State.WAITING_FOR_STARTPOSITION:
            self.notice_ratio()
            self.await_line()
        elif self.state == State.GEAR_IN and not self.timed:
            travel, _, _, _ = into(self.direction * (self.here - self.trigger), self.order_in.distance)
            before = self.line.scaled(self.direction * travel)
            self.notice_ratio()
            self.base += before - self.line.scaled(self.direction * travel)
            self.line.slave = self.base
            self.mark_line()
        else:
            self.line.take(self.here, self.line.at(self.here))
            self.notice_ratio()
            self.mark_line()

    # --- engaging ---

    def engage(self) -> None:
        """At rest: the order's condition may be met here, or has to be waited for."""
        self.await_order(State.WAITING_FOR_STARTPOSITION)
        self.look_here()
        self.take_ratio()
        way = self.master_way()
        if self.continues():
            self.engaged()
        elif self.by_motion(self.order_in) and self.order_in.begins(way):
            self.begin_in(way)

    def engage_again(self) -> None:
        """On the way to rest: from there at once in time, if the condition is met; else from the rest."""
        way = self.master_way()
        if self.order_in.transition == Transition.TIME_BASED and self.order_in.begins(way):
            self.look_here()
            self.pending = False
            self.take_ratio()
            self.begin_in(way)
        else:
            self.pending = True

    def by_motion(self, order: Order) -> bool:
        """Whether the order's condition is the master's motion alone, not a position that it passes."""
        return order.transition == Transition.TIME_BASED or (order.aim == Aim.DIRECT and not self.kept)

    def reference(self, position: float) -> float:
        """m_a, any occurrence, for a slave at s_a."""
        if self.order_in.aim == Aim.SYNCHRONOUS_POINT:
            return self.sync_master + self.line.unscaled(position - self.sync_slave)
        return self.order_in.position

    def await_line(self) -> None:
        """At rest: the line that a position makes known beforehand."""
        if self.order_in.aim != Aim.DIRECT:
            self.line.take(self.reference(self.rest), self.rest)
            self.mark_line()

    def continues(self) -> bool:
        """Without transition a slave that is on the line of the synchronous point already is in gear at once."""
        if self.order_in.aim != Aim.SYNCHRONOUS_POINT or self.order_in.transition != Transition.NONE:
            return False
        reference = nearest(self.reference(self.rest), self.turn(), self.here)
        if abs(self.here - reference) > ON_LINE * max(1.0, abs(self.here)):
            return False
        self.line.take(reference, self.rest)
        self.trigger = reference
        return True

    def begin_in(self, way: float) -> None:
        """The condition of a direct or time-based engagement is met here, the slave being as just looked at."""
        self.direction = way
        self.trigger = self.here
        self.base = self.position
        reference = self.here + way * (0.5 * self.order_in.distance)
        if self.order_in.aim != Aim.DIRECT:
            reference = ahead(self.reference(self.position), self.turn(), way, self.here, True)
        self.line.take(reference, self.position)
        self.enter_in()

    def enter_in(self) -> None:
        """The transition on to the line begins here; trigger, base and line are known."""
        self.mark_line()
        self.kept = False
        self.state = State.GEAR_IN
        self.timed = self.order_in.transition == Transition.TIME_BASED
        if self.timed:
            self.blend.begin(
                self.now,
                self.order_in.time,
                self.position - self.line.at(self.here),
                self.slave.velocity - self.line.scaled(self.master.velocity_at(self.now)),
                self.slave.acceleration - self.line.scaled(self.master.mean_acceleration()),
                0.0,
            )
        elif self.order_in.transition == Transition.NONE:
            self.engaged()

    def engaged(self) -> None:
        """The slave is on the line."""
        self.state = State.ACTIVE

    def save_point(self) -> None:
        """The synchronous point, as ACTIVE is left."""
        self.sync_master = self.here
        self.sync_slave = self.line.at(self.here)

    # --- disengaging ---

    def leave(self) -> None:
        """The falling edge, from the line or from the way on to it."""
        way = self.master_way()
        self.look_here()
        if self.state == State.ACTIVE:
            self.save_point()
            self.await_order(State.WAITING_FOR_STOPPOSITION)
            if self.by_motion(self.order_out) and self.order_out.begins(way):
                self.begin_out(way)
        elif self.order_out.transition == Transition.TIME_BASED or (
            self.order_out.transition == Transition.NONE and self.order_out.aim == Aim.DIRECT
        ):
            self.pending = False
            self.begin_out(way)
        else:
            self.pending = True

    def begin_out(self, way: float) -> None:
        """The condition of a direct or time-based disengagement is met here, the slave being as just looked at."""
        self.direction = way
        self.trigger = self.here
        self.base = self.position
        self.target = self.position
        if self.order_out.aim == Aim.POSITION:
            self.target = self.rest_ahead(way)
        self.enter_out()

    def rest_ahead(self, way: float) -> float:
        """The stop position's occurrence for a time-based disengagement."""
        toward = direction_of(self.line.scaled(way), 0.0)
        if toward == 0.0:
            return nearest(self.order_out.position, self.slave.period, self.position)
        return ahead(self.order_out.position, self.slave.period, toward, self.position, True)

    def enter_out(self) -> None:
        """The transition to rest begins here; trigger, base and target are known."""
        self.kept = False
        self.state = State.GEAR_OUT
        self.timed = self.order_out.transition == Transition.TIME_BASED
        if self.timed:
            self.blend.begin(
                self.now, self.order_out.time, self.position, self.slave.velocity, self.slave.acceleration, self.target
            )
        elif self.order_out.transition == Transition.NONE:
            self.come_to_rest()

    def come_to_rest(self) -> None:
        """At the target."""
        self.state = State.STOPPED
        self.rest = self.target
        if self.order_out.aim == Aim.POSITION and self.slave.period > 0.0:  # exactly, in whatever turn
            self.rest = wrap(self.order_out.position, self.slave.period)
            self.sync_slave -= self.target - self.rest

    # --- the way of the step ---

    def travel(self, piece: int, begin: float, end: float) -> None:
        """A monotone piece of the master's path, 0 being the input correction: one event after the other."""
        self.here = begin
        self.now = self.master.path.times[piece]
        way = direction_of(end - begin, 0.0)
        for _ in range(EVENTS):
            if self.frozen or not self.meets(piece, way, end):
                break
        if not self.same(begin, end):
            self.last_way = way
            self.heading = way

    def meets(self, piece: int, way: float, end: float) -> bool:
        """The next event on the rest of the piece, if there is one."""
        match self.state:
            case State.STOPPED | State.ACTIVE:
                return self.catch_up()
            case State.WAITING_FOR_STARTPOSITION:
                return self.await_start(piece, way, end)
            case State.GEAR_IN:
                return self.go_in(piece, end)
            case State.WAITING_FOR_STOPPOSITION:
                return self.await_stop(piece, way, end)
            case State.GEAR_OUT:
                return self.go_out(piece, end)
            case _:
                return False

    def catch_up(self) -> bool:
        """An edge that has waited for the end of a transition acts here."""
        if not self.pending:
            return False
        self.pending = False
        if self.state == State.ACTIVE:
            self.act_stop()
        else:
            self.act_start()
        return True

    def await_order(self, state: State) -> None:
        """A new order waits here; what the master did before does not count."""
        self.state = state
        self.last_way = 0.0
        self.kept = False

    def await_start(self, piece: int, way: float, end: float) -> bool:
        """At rest: until the master moves as it has to, or crosses the trigger."""
        if self.by_motion(self.order_in):
            if not (self.order_in.allows(way) and self.moves(piece)):
                return False
            self.look_here()
            self.begin_in(way)
            return True
        if not self.crosses(self.order_in, piece, way, end):
            return False
        self.look_here()
        self.base = self.rest
        self.line.take(self.trigger + way * (0.5 * self.order_in.distance), self.rest)
        self.enter_in()
        return True

    def await_stop(self, piece: int, way: float, end: float) -> bool:
        """On the line: until the master moves as it has to, or crosses the trigger."""
        if self.by_motion(self.order_out):
            if not (self.order_out.allows(way) and self.moves(piece)):
                return False
            self.look_here()
            self.begin_out(way)
            return True
        if not self.crosses(self.order_out, piece, way, end):
            return False
        half = self.line.scaled(way * (0.5 * self.order_out.distance))
        self.base = self.line.at(self.trigger)
        self.target = self.base + half
        if self.order_out.aim == Aim.POSITION:
            self.target = nearest(self.order_out.position, self.slave.period, self.target)
            self.base = self.target - half
        self.enter_out()
        return True

    def crosses(self, order: Order, piece: int, way: float, end: float) -> bool:
        """Go to the first trigger on the rest of the piece, if there is one.

        Being on it counts if the master goes on that way, and has not come there from beyond."""
        if not order.allows(way) or (self.kept and way != self.direction):
            return False
        base, spacing = self.triggers(order, way)
        margin = tolerance(base, spacing, self.here)
        turned = self.last_way == -way
        trigger = ahead(base, spacing, way, self.here, not turned)
        missing = way * (trigger - self.here)
        if missing < -margin or (turned and missing <= margin):
            return False
        missing = way * (trigger - end)
        margin = tolerance(base, spacing, end)
        if missing > margin or (missing >= -margin and not self.goes_on(piece, way)):
            return False
        self.go_to(piece, trigger)
        self.trigger = trigger
        self.direction = way
        return True

    def triggers(self, order: Order, way: float) -> tuple[float, float]:
        """One trigger for that direction of the master, and the distance between all; 0: there is but one."""
        half = way * (0.5 * order.distance)
        if self.kept:
            return self.trigger, self.turn()
        if self.state == State.WAITING_FOR_STARTPOSITION:
            return self.reference(self.rest) - half, self.turn()
        stop = self.line.master + self.line.unscaled(order.position - self.line.slave)
        return stop - half, abs(self.line.unscaled(self.slave.period))

    def moves(self, piece: int) -> bool:
        """Whether the master's way in a piece is a motion: not the seam, nor what rounding leaves of a stop."""
        if piece == 0 or self.master.path.times[piece + 1] - self.now <= SAME_TIME * self.master.step:
            return False
        if self.master.begin_velocity != 0.0 or self.master.end_velocity != 0.0:
            return True
        return not self.same(self.master.path.places[piece], self.master.path.places[piece + 1])

    def same(self, a: float, b: float) -> bool:
        """Whether two positions of the master differ by rounding only, that of the input in its turn included."""
        return abs(a - b) <= rounding(a, b) + ROUNDING * min(self.master.period, LARGEST_INPUT)

    def goes_on(self, piece: int, way: float) -> bool:
        """Whether the master passes the end of a piece that leads that way, rather than turn or rest there."""
        velocity = 0.0
        if piece == 0:
            velocity = self.master.begin_velocity
        elif piece == self.master.path.pieces - 1:
            velocity = self.master.end_velocity
        faster = max(abs(self.master.begin_velocity), abs(self.master.end_velocity))
        return way * velocity > STANDING * faster

    def go_to(self, piece: int, place: float) -> None:
        """Further along the piece, to a place on it; the seam takes no time."""
        if piece > 0:
            self.now = max(self.now, self.master.path.crossing(piece, place))
        self.here = place

    def go_in(self, piece: int, end: float) -> bool:
        """On the way to the line."""
        if self.timed:
            if self.blend_ends(piece, end):
                self.engaged()
                return True
            return False
        distance = self.order_in.distance
        if self.sets_out(end):
            self.line.master = self.trigger + self.direction * (0.5 * distance)
            self.mark_line()
        match self.leaves_curve(piece, end, distance):
            case 1:
                self.engaged()
                return True
            case -1:
                self.rest = self.base
                self.state = State.STOPPED if self.pending else State.WAITING_FOR_STARTPOSITION
                self.kept = self.order_in.aim == Aim.DIRECT
                self.pending = False
                self.await_line()
                return True
            case _:
                return False

    def go_out(self, piece: int, end: float) -> bool:
        """On the way to rest."""
        if self.timed:
            if self.blend_ends(piece, end):
                self.come_to_rest()
                return True
            return False
        distance = self.order_out.distance
        self.sets_out(end)
        match self.leaves_curve(piece, end, distance):
            case 1:
                if self.order_out.aim == Aim.DIRECT:
                    self.target = self.base + self.line.scaled(self.direction * (0.5 * distance))
                self.come_to_rest()
                return True
            case -1:
                self.state = State.WAITING_FOR_STOPPOSITION
                self.kept = self.order_out.aim == Aim.DIRECT
                if self.pending:
                    self.pending = not self.takes(Fault.NONE)
                    self.state = State.ACTIVE
                return True
            case _:
                return False

    def sets_out(self, end: float) -> bool:
        """A curve that began at rest gets its direction from the first motion; whether that is now."""
        if self.direction != 0.0 or self.same(end, self.trigger):
            return False
        self.direction = direction_of(end - self.trigger, 0.0)
        return True

    def leaves_curve(self, piece: int, end: float, distance: float) -> int:
        """Whether the piece leads beyond a master-based curve: 1 its end, -1 its beginning, 0 neither."""
        finish = self.trigger + self.direction * distance
        margin = rounding(end, finish) + SAME_TURN * distance
        if self.direction * (end - finish) >= -margin and self.direction != 0.0:
            self.go_to(piece, finish)
            return 1
        if self.direction * (end - self.trigger) < -margin:
            self.go_to(piece, self.trigger)
            return -1
        return 0

    def blend_ends(self, piece: int, end: float) -> bool:
        """Go to where the master is when the transition's time is over, if that is in this piece."""
        if piece == 0 or not self.blend.over(self.master.path.times[piece + 1]):
            return False
        last = self.master.path.times[piece + 1]
        time = clamp(self.blend.left(), self.now, last)
        self.here = end if time >= last else self.master.path.position(time)
        self.now = time
        return True

    def turn(self) -> float:
        """The distance between the occurrences of a master's position."""
        return self.master.period if self.master.period <= FARTHEST else 0.0

    def master_way(self) -> float:
        """Which way the master moves at this instant."""
        return direction_of(self.master.velocity_at(self.now), self.master.mean_acceleration())

    def rebase(self) -> None:
        """Drop whole turns, so that positions keep their last bits; not while a transition lies at a particular turn.

        On the line the slave travels on with each turn of the master: that is of use where it has turns too."""
        geared = self.state in (State.ACTIVE, State.WAITING_FOR_STOPPOSITION) and not self.frozen
        under_way = self.state in (State.GEAR_IN, State.GEAR_OUT) and not self.frozen
        period = self.slave.period
        if under_way or (geared and period == 0.0):
            return
        before = self.master.end
        self.master.rebase()
        turned = before - self.master.end
        self.trigger -= turned
        if geared:
            self.line.slave += self.line.scaled(turned)
        if period > 0.0:
            place = self.line.at(self.master.end) if geared else self.rest
            turned = place - wrap(place, period)
            self.line.slave -= turned
            self.sync_slave -= turned
            self.rest = wrap(self.rest, period)

    # --- the state at an instant ---

    def look_here(self) -> None:
        self.look(self.now, self.here, self.master.velocity_at(self.now), self.master.mean_acceleration())

    def look(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """The slave's state at a time since the step's beginning, with the master there and moving so."""
        if self.frozen:
            self.look_resting()
            return
        match self.state:
            case State.GEAR_IN:
                if self.timed:
                    self.look_blending(time, place, velocity, acceleration)
                else:
                    way = self.direction * (place - self.trigger)
                    travel, slope, curvature, twist = into(way, self.order_in.distance)
                    self.follow(travel, slope, curvature, twist, velocity, acceleration)
            case State.ACTIVE | State.WAITING_FOR_STOPPOSITION:
                self.put(self.line.at(place), self.line.scaled(velocity), self.line.scaled(acceleration), 0.0)
            case State.GEAR_OUT:
                if self.timed:
                    position, v, a, j = self.blend.at(time)
                    self.put(position, v, a, j)
                else:
                    way = self.direction * (place - self.trigger)
                    travel, slope, curvature, twist = out(way, self.order_out.distance)
                    self.follow(travel, slope, curvature, twist, velocity, acceleration)
            case _:
                self.look_resting()

    def look_resting(self) -> None:
        self.put(self.rest, 0.0, 0.0, 0.0)

    def follow(
        self, travel: float, slope: float, curvature: float, twist: float, velocity: float, acceleration: float
    ) -> None:
        """On a curve over the master's position, by the chain rule; the master's jerk is taken as 0."""
        v, a, j = chain_rule(slope, self.direction * curvature, twist, velocity, acceleration)
        position = self.base + self.line.scaled(self.direction * travel)
        self.put(position, self.line.scaled(v), self.line.scaled(a), self.line.scaled(j))

    def look_blending(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """The line and what still lacks to it."""
        e, e1, e2, e3 = self.blend.at(time)
        self.put(self.line.at(place) + e, self.line.scaled(velocity) + e1, self.line.scaled(acceleration) + e2, e3)

    def put(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        self.position = position
        self.slave.put(wrap(position, self.slave.period), velocity, acceleration, jerk)

    # --- what is put out ---

    def mark_line(self) -> None:
        """Where the line lies."""
        master = wrap(self.line.master, self.master.period)
        self.local.line_offset = wrap(self.line.slave, self.slave.period) - self.line.scaled(master)

    def mark_trigger(self, place: float) -> None:
        self.local.trigger_position = wrap(place, self.master.period)

    def show(self) -> None:
        """What else is put out, at the step's end."""
        self.state_code = self.state
        self.in_gear = self.state == State.ACTIVE
        self.error = self.error_id != Fault.NONE
        if not self.frozen:
            self.tell_progress()

    def tell_progress(self) -> None:
        """Of the transition, or where it would begin."""
        self.local.progress = 1.0 if self.state == State.ACTIVE else 0.0
        self.mark_trigger(self.trigger)
        match self.state:
            case State.WAITING_FOR_STARTPOSITION:
                self.tell_waiting(self.order_in)
            case State.WAITING_FOR_STOPPOSITION:
                self.tell_waiting(self.order_out)
            case State.GEAR_IN:
                self.local.progress = self.share(self.order_in)
            case State.GEAR_OUT:
                self.local.progress = self.share(self.order_out)
            case _:
                pass

    def tell_waiting(self, order: Order) -> None:
        """Which trigger would be crossed next, going on, or the way that is allowed."""
        if self.by_motion(order):
            return
        way = direction_of(self.master.end_velocity, self.master.end_acceleration)
        if way == 0.0:
            way = self.heading
        if self.kept:
            way = self.direction
        elif not order.allows(way):
            way = 1.0 if order.clockwise else -1.0
        base, spacing = self.triggers(order, way)
        self.mark_trigger(ahead(base, spacing, way, self.master.end, self.last_way != -way))

    def share(self, order: Order) -> float:
        """Of the transition, what is done."""
        if self.timed:
            return self.blend.progress()
        return clamp(self.direction * (self.master.end - self.trigger) / order.distance, 0.0, 1.0)
