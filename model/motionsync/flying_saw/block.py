"""FlyingSaw: a slave axis that can be coupled to a moving master from any state of motion.

To the master's velocity, or so that both meet at given positions; uncoupled it moves by itself. Source: TwinCAT's
universal flying saw (TS5055) and PLCopen's function blocks.

Decisions where the source is silent:
- While gear_in_pos waits for its start the slave's motion goes on, that of a former coupling too, which parks at the
  backstop but is not planned anew. What can be told at the edge is refused there (limits, a standing master, a master's
  sync position not ahead, a negative distance), the rest when the master passes the start; then a motion of the slave's
  own goes on, and a coupled one runs on as after gear_out. gear_out while waiting ends the slave's own motion too.
- The time-based ramp starts from the true accelerations: the two bits that ignore them are for position-based profiles.
- Where a new plan is refused when the master comes back, the axis is uncoupled; a halt under way goes on to its end.
- `coupling_factor` is 0 while uncoupled. `start_sync` holds in SYNCHRONIZING and SYNCHRON as long as busy or in_sync.
  With master.period the characteristic master positions lie in [0, period).
- A function block speaks of its last edge: if that was refused, it does not show what becomes of the command of an
  earlier edge, which goes on.
- Velocities that differ by less than 1e-12 of the greater are in sync at once.
"""

from dataclasses import dataclass

from .. import var
from ..cosine import cosine
from ..grid import wrap
from ..laws import chain_rule
from ..limits import clamp, usable
from ..master import Master
from ..motion import Motion, acceleration_limit
from ..slave import Slave
from ..var import Enumeration, Unit
from .characteristics import Characteristics
from .chase import Chase
from .commands import Command, GearInPos, GearInVelo, GearOut, Halt, MoveAbsolute, MoveVelocity, Phase, Reset
from .extremes import Extremes
from .faults import Fault, Refusal
from .machine import Axis, chosen, ends_known
from .order import Order
from .planning import Plan
from .profile import Profile, ProfileKind
from .shapes import ramp_duration, ramp_from
from .sync_mode import SyncMode

SAME_PLACE = 1e-15  # of the master's position: rounding
ARRIVED = 1e-12  # of a period: a sync position that is less ahead is the one just passed
REACHED = 1e-9  # of a profile's master travel: closer to its end it is ended, which differs by rounding only
STANDING = 1e-12  # of the velocity limit: no ramp is needed for less
SHORTEST = 1e-300  # u: a reciprocal that stays finite
FASTEST = 1e60
EVENTS = 8  # in a monotone piece of the master's path there are three at most


class State(Enumeration):
    """What moves the axis (nAxisState)"""

    INACTIVE = 0, "it stands"
    CONSTANT_VELOCITY = 3, "uncoupled, at constant velocity"
    ACCELERATING = 4, "uncoupled, getting faster"
    DECELERATING = 5, "uncoupled, getting slower"
    PREPHASE = 11, "coupled, waiting: for the start distance, or parked by the backstop"
    SYNCHRONIZING = 12, "coupled, on the way to the synchronous motion"
    SYNCHRON = 13, "coupled, in sync"


class PlcopenState(Enumeration):
    """State of the axis in PLCopen's diagram"""

    STANDSTILL = 1, "it stands, and no command moves it"
    DISCRETE_MOTION = 2, "under way to rest: halt or move_absolute"
    CONTINUOUS_MOTION = 3, "under way for ever"
    SYNCHRONIZED_MOTION = 4, "coupled"
    STOPPING = 5, "locked by stop"


class Drive(Enumeration):
    """Whence the setpoint comes"""

    OWN = 0, "the axis's own motion"
    HALT = 1, "as PARKED, but uncoupled"
    PROFILE = 2, "a profile over the master's position"
    CHASE = 3, "a motion in time towards the master's velocity"
    LINE = 4, "in sync"
    PARKED = 5, "a halt in time, then rest, until the master passes the coupling position forwards"


class Owner(Enumeration):
    """Whose command moves the axis"""

    NOBODY = 0, "no command's, or a finished one's"
    GEAR_IN_VELO = 1, "gear_in_velo's"
    GEAR_IN_POS = 2, "gear_in_pos's"
    HALT = 3, "halt's"
    STOP = 4, "stop's"
    MOVE_VELOCITY = 5, "move_velocity's"
    MOVE_ABSOLUTE = 6, "move_absolute's"


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    coupling_position: float = var.local(
        0.0, "master position where the present synchronisation began", Unit.POSITION, discrete=True
    )
    progress: float = var.local(0.0, "share of the synchronisation that is done", min=0.0, max=1.0)
    master_distance_to_sync: float = var.local(
        0.0, "master travel missing to the synchronous phase, at constant master velocity", Unit.POSITION
    )
    plan_position_min: float = var.local(
        0.0, "least position of the last plan, refused or not", Unit.POSITION, discrete=True
    )
    plan_position_max: float = var.local(
        0.0, "greatest position of the last plan, refused or not", Unit.POSITION, discrete=True
    )
    plan_velocity_min: float = var.local(
        0.0, "least velocity of the last plan, refused or not", Unit.VELOCITY, discrete=True
    )
    plan_velocity_max: float = var.local(
        0.0, "greatest velocity of the last plan, refused or not", Unit.VELOCITY, discrete=True
    )
    plan_acceleration: float = var.local(
        0.0,
        "greatest acceleration (away from standstill) of the last plan, refused or not",
        Unit.ACCELERATION,
        discrete=True,
    )
    plan_deceleration: float = var.local(
        0.0,
        "greatest deceleration (towards standstill) of the last plan, refused or not",
        Unit.ACCELERATION,
        discrete=True,
    )
    plan_jerk_min: float = var.local(0.0, "least jerk of the last plan, refused or not", Unit.JERK, discrete=True)
    plan_jerk_max: float = var.local(0.0, "greatest jerk of the last plan, refused or not", Unit.JERK, discrete=True)

    def tell(self, extremes: Extremes) -> None:
        """What the last plan asks of the slave."""
        self.plan_position_min = extremes.position_min
        self.plan_position_max = extremes.position_max
        self.plan_velocity_min = extremes.velocity_min
        self.plan_velocity_max = extremes.velocity_max
        self.plan_acceleration = extremes.acceleration_peak
        self.plan_deceleration = extremes.deceleration_peak
        self.plan_jerk_min = extremes.jerk_min
        self.plan_jerk_max = extremes.jerk_max


@dataclass(slots=True)
class FlyingSaw:
    """Couples a slave axis to a moving master, at its velocity or at given positions, from any state of motion.

    The block is the slave axis with its setpoint generator. Uncoupled it moves by itself: move_absolute, move_velocity,
    halt and stop are time-optimal with limited jerk. gear_in_velo takes it to the master's velocity times the coupling
    factor as fast as the limits allow; gear_in_pos takes it there so that the slave is at slave_sync_position just when
    the master is at master_sync_position. From then on it is in sync until gear_out or another motion command uncouples
    it: a tool on it works on moving material as if it stood.

    The way into sync is a curve over the master's position, so it is exact whatever the master does meanwhile.
    sync_mode says which limits it has to keep, and what happens if the master turns round; a command that cannot keep
    them is refused, and the slave goes on as it did.

    The state at the end of a step is put out for the master at the end of the step. Commands act at the step's
    beginning.
    """

    master: Master = var.part(Master)
    axis: Axis = var.part(Axis)
    diagonal_angle: float = var.parameter(
        0.0, "angle between the saw's and the master's travel", Unit.ANGLE, above=-90.0, below=90.0
    )
    sync_mode: SyncMode = var.part(SyncMode)
    gear_in_velo: GearInVelo = var.part(GearInVelo)
    gear_in_pos: GearInPos = var.part(GearInPos)
    gear_out: GearOut = var.part(GearOut)
    halt: Halt = var.part(Halt)
    stop: Halt = var.part(Halt)
    move_velocity: MoveVelocity = var.part(MoveVelocity)
    move_absolute: MoveAbsolute = var.part(MoveAbsolute)
    reset: Reset = var.part(Reset)
    slave: Slave = var.part(
        Slave, depends={"position": ("axis.initial_position",), "velocity": ("axis.initial_velocity",)}
    )
    state: State = var.output(State.INACTIVE, "what moves the axis (nAxisState)", depends=("axis.initial_velocity",))
    state_code: int = var.output(0, "the state as a plain integer", depends=("axis.initial_velocity",))
    plcopen_state: PlcopenState = var.output(
        PlcopenState.STANDSTILL, "the axis in PLCopen's state diagram", depends=("axis.initial_velocity",)
    )
    in_sync: bool = var.output(False, "the slave is in sync with the master")
    coupled: bool = var.output(False, "the slave is coupled to the master: states 11 to 13")
    coupling_factor: float = var.output(0.0, "slave velocity per master velocity; 0 while uncoupled", discrete=True)
    error: bool = var.output(False, "a command was refused, and none accepted since")
    error_id: int = var.output(0, "why the last refused command was: TwinCAT's number")
    characteristics: Characteristics = var.part(Characteristics)
    local: Local = var.part(Local)

    cosine: float = 1.0
    drive: Drive = Drive.OWN
    owner: Owner = Owner.NOBODY
    locked: bool = False
    resting: bool = False
    motion: Motion = var.part(Motion)
    wanted: Order = var.part(Order)
    awaited: Order = var.part(Order)
    order: Order = var.part(Order)
    profile: Profile = var.part(Profile)
    chase: Chase = var.part(Chase)
    glance: Chase = var.part(Chase)
    direction: float = 1.0
    waits: bool = False
    start: float = 0.0
    toward: float = 1.0
    coupling: float = 0.0
    per_nominal: float = 1.0
    per_travel: float = 0.0
    master_sync: float = 0.0
    slave_sync: float = 0.0
    parked: float = 0.0
    checked: float = 0.0
    here: float = 0.0
    plan: Plan = var.part(Plan)

    def initialize(self) -> Refusal:
        """The axis stands, or moves at its initial velocity; may be called again while parameters still change."""
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.motion.run(self.axis.initial_position, self.axis.initial_velocity)
        self.reset.edge.before = self.reset.execute
        self.stop.edge.before = self.stop.execute
        self.halt.edge.before = self.halt.execute
        self.gear_out.edge.before = self.gear_out.execute
        self.gear_in_velo.edge.before = self.gear_in_velo.execute
        self.gear_in_pos.edge.before = self.gear_in_pos.execute
        self.move_velocity.edge.before = self.move_velocity.execute
        self.move_absolute.edge.before = self.move_absolute.execute
        self.look(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the seam to the present input, the commands, then the path of the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        if self.master.path.places[0] != self.master.begin and self.is_coupled():
            self.travel(0, self.master.path.places[0], self.master.begin)
        self.obey()
        if self.drive == Drive.CHASE:
            self.renew(0.0)
        for i in range(1, self.master.path.pieces):
            self.travel(i, self.master.path.places[i], self.master.path.places[i + 1])
        self.motion.advance(h)
        self.parked += h
        self.look(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.show()
        if not self.coupled:
            self.master.rebase()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """The edges, at the path's beginning, in the order of urgency."""
        if self.locked and not self.stop.execute and self.slave.velocity == 0.0 and self.slave.acceleration == 0.0:
            self.locked = False
        if self.reset.edge.rising(self.reset.execute):
            self.reset.done = True
            self.error_id = Fault.NONE
        if self.stop.edge.rising(self.stop.execute):
            self.command_halt(self.stop, Owner.STOP)
        if self.halt.edge.rising(self.halt.execute):
            self.command_halt(self.halt, Owner.HALT)
        if self.gear_out.edge.rising(self.gear_out.execute):
            self.command_gear_out()
        if self.gear_in_velo.edge.rising(self.gear_in_velo.execute):
            self.wanted.sample(self.gear_in_velo, self.axis, self.sync_mode, self.cosine)
            self.command_gear_in(self.gear_in_velo, Owner.GEAR_IN_VELO)
        if self.gear_in_pos.edge.rising(self.gear_in_pos.execute):
            self.wanted.sample(self.gear_in_pos, self.axis, self.sync_mode, self.cosine)
            self.wanted.aim(
                self.ahead(self.gear_in_pos.master_sync_position),
                self.gear_in_pos.slave_sync_position,
                self.gear_in_pos.master_start_distance,
            )
            self.command_gear_in(self.gear_in_pos, Owner.GEAR_IN_POS)
        if self.move_velocity.edge.rising(self.move_velocity.execute):
            self.command_move_velocity()
        if self.move_absolute.edge.rising(self.move_absolute.execute):
            self.command_move_absolute()

    def command_halt(self, command: Halt, owner: Owner) -> None:
        deceleration = chosen(command.deceleration, self.axis.max_deceleration)
        jerk = chosen(command.jerk, self.axis.max_jerk)
        fault = Fault.NONE
        if self.locked and owner != Owner.STOP:
            fault = Fault.LOCKED
        elif not (usable(deceleration) and usable(jerk)):
            fault = Fault.LIMIT
        if self.takes(command, owner, fault):
            self.motion.halt(self.slave.position, self.slave.velocity, self.slave.acceleration, deceleration, jerk)
            self.uncouple(True)
            self.locked = owner == Owner.STOP

    def command_move_velocity(self) -> None:
        acceleration = chosen(self.move_velocity.acceleration, self.axis.max_acceleration)
        deceleration = chosen(self.move_velocity.deceleration, self.axis.max_deceleration)
        jerk = chosen(self.move_velocity.jerk, self.axis.max_jerk)
        target = self.move_velocity.velocity
        fault = Fault.NONE
        if self.locked:
            fault = Fault.LOCKED
        elif not (
            usable(acceleration) and usable(deceleration) and usable(jerk) and abs(target) <= self.axis.max_velocity
        ):
            fault = Fault.LIMIT
        if self.takes(self.move_velocity, Owner.MOVE_VELOCITY, fault):
            limit = acceleration_limit(self.slave.velocity, target, acceleration, deceleration)
            self.motion.change(
                self.slave.position, self.slave.velocity, self.slave.acceleration, target, 0.0, -limit, limit, jerk
            )
            self.uncouple(False)

    def command_move_absolute(self) -> None:
        velocity = chosen(self.move_absolute.velocity, self.axis.max_velocity)
        acceleration = chosen(self.move_absolute.acceleration, self.axis.max_acceleration)
        deceleration = chosen(self.move_absolute.deceleration, self.axis.max_deceleration)
        jerk = chosen(self.move_absolute.jerk, self.axis.max_jerk)
        moves = usable(acceleration) and usable(deceleration) and usable(jerk)
        target = self.move_absolute.position
        fault = Fault.NONE
        if self.locked:
            fault = Fault.LOCKED
        elif not (ends_known(self.axis.min_position, self.axis.max_position) and usable(velocity) and moves):
            fault = Fault.LIMIT
        elif target < self.axis.min_position:
            fault = Fault.MIN_POSITION
        elif target > self.axis.max_position:
            fault = Fault.MAX_POSITION
        if self.takes(self.move_absolute, Owner.MOVE_ABSOLUTE, fault):
            self.motion.move(
                self.slave.position,
                self.slave.velocity,
                self.slave.acceleration,
                target,
                velocity,
                acceleration,
                deceleration,
                jerk,
            )
            self.uncouple(True)

    def command_gear_out(self) -> None:
        self.gear_out.answer(Fault.LOCKED if self.locked else Fault.NONE)
        if self.locked:
            self.error_id = Fault.LOCKED
            return
        self.error_id = Fault.NONE
        if self.is_coupled():
            self.abort()
            self.owner = Owner.NOBODY
            self.look(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)
            self.run_free()

    def command_gear_in(self, command: GearInVelo, owner: Owner) -> None:
        """At once, or when the master passes the start that lies ahead."""
        place = self.master.begin
        self.survey(0.0, place, self.master.begin_velocity, self.master.begin_acceleration)
        direction = 1.0 if self.master.begin_velocity > 0.0 else -1.0
        start = self.wanted.master_sync - direction * self.wanted.start_distance
        waits = self.wanted.start_distance > 0.0 and (place - start) * direction < 0.0
        fault = Fault.LOCKED if self.locked else self.wanted.fault()
        if fault == Fault.NONE:
            fault = self.plan.hindrance(self.wanted) if waits else self.planned(self.wanted)
        if self.takes(command, owner, fault):
            self.waits = waits
            if waits:
                self.awaited.take(self.wanted)
                self.start = start
                self.toward = direction
            else:
                self.order.take(self.wanted)
                self.couple(0.0, place)

    def takes(self, command: Command, owner: Owner, fault: Fault) -> bool:
        """Refuse a command, or let it take the place of the one before; the slave's present state is looked at then."""
        if fault != Fault.NONE:
            command.refuse(fault)
            self.error_id = fault
            return False
        self.look(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)
        self.abort()
        command.accept()
        self.owner = owner
        self.error_id = Fault.NONE
        return True

    def abort(self) -> None:
        """The command that has moved the axis up to now ends."""
        match self.owner:
            case Owner.GEAR_IN_VELO:
                self.gear_in_velo.come(Phase.ABORTED)
            case Owner.GEAR_IN_POS:
                self.gear_in_pos.come(Phase.ABORTED)
            case Owner.HALT:
                self.halt.come(Phase.ABORTED)
            case Owner.STOP:
                self.stop.come(Phase.ABORTED)
            case Owner.MOVE_VELOCITY:
                self.move_velocity.come(Phase.ABORTED)
            case Owner.MOVE_ABSOLUTE:
                self.move_absolute.come(Phase.ABORTED)
            case _:
                pass

    def uncouple(self, resting: bool) -> None:
        """The axis's own motion, just planned, drives it; `resting`: towards rest."""
        self.waits = False
        self.drive = Drive.OWN
        self.resting = resting

    def run_free(self) -> None:
        """From the state just looked at, without acceleration."""
        self.motion.run(self.slave.position, self.slave.velocity)
        self.uncouple(False)

    def is_coupled(self) -> bool:
        return self.waits or self.drive not in (Drive.OWN, Drive.HALT)

    def ahead(self, position: float) -> float:
        """The place that a master's sync position means: with a period, one in [0, period) its next occurrence.

        Another one lies in the turn of the master's input, be that wrapped or not."""
        period = self.master.period
        if period == 0.0:
            return position
        if not 0.0 <= position < period:
            return self.master.unwrap_in_current_turn(position)
        missing = position - wrap(self.master.begin, period)
        if self.master.begin_velocity >= 0.0 and missing <= ARRIVED * period:
            missing += period
        elif self.master.begin_velocity < 0.0 and missing >= -ARRIVED * period:
            missing -= period
        return self.master.begin + missing

    # --- coupling ---

    def survey(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """Lay before the plan where both axes are; the master's state is given."""
        self.look(time, place, velocity, acceleration)
        self.plan.master.put(place, velocity, acceleration)
        self.plan.slave.put(self.slave.position, self.slave.velocity, self.slave.acceleration)

    def planned(self, order: Order) -> Fault:
        """The plan for the states surveyed, and what it is like, refused or not."""
        fault = self.plan.make(order)
        if self.plan.judged:
            self.local.tell(self.plan.extremes)
        return fault

    def couple(self, time: float, place: float) -> None:
        """The plan made for this instant begins."""
        self.characteristics.tell(self.plan, self.master.period)
        self.coupling = place
        self.local.coupling_position = wrap(place, self.master.period)
        nominal = self.plan.master.velocity
        self.direction = 1.0 if nominal > 0.0 else -1.0 if nominal < 0.0 else 0.0
        self.master_sync = self.plan.master_end
        self.slave_sync = self.plan.end
        if self.plan.at_once:
            self.drive = Drive.LINE
            self.sync_comes(Phase.REACHED)
        elif self.order.mode.time_based:
            self.drive = Drive.CHASE
            self.chase.aim(self.order, self.master.velocity_at(time), self.master.mean_acceleration())
            self.chase.plan(self.order, self.motion, self.slave.position, self.slave.velocity, self.slave.acceleration)
            self.motion.clock.start(time)
            self.checked = time
        else:
            self.drive = Drive.PROFILE
            self.profile.take(self.plan.profile)
            self.per_nominal = clamp(1.0 / nominal, -1.0 / SHORTEST, 1.0 / SHORTEST)
            self.per_travel = 1.0 / max(abs(self.master_sync - place), SHORTEST)

    def begin_awaited(self, time: float) -> None:
        """The master passes the start: plan from the present state."""
        self.survey(time, self.start, self.master.velocity_at(time), self.master.end_acceleration)
        self.waits = False
        fault = self.planned(self.awaited)
        if fault == Fault.NONE:
            self.order.take(self.awaited)
            self.couple(time, self.start)
        else:
            self.give_up(fault)
            if self.is_coupled():
                self.run_free()
                self.motion.clock.start(time)

    def resume(self, time: float) -> None:
        """The master passes the coupling position forwards again: plan from the present state."""
        self.survey(time, self.coupling, self.master.velocity_at(time), self.master.end_acceleration)
        fault = self.planned(self.order)
        if fault == Fault.NONE:
            self.couple(time, self.coupling)
        else:
            self.give_up(fault)
            self.drive = Drive.HALT
            self.resting = True

    def give_up(self, fault: Fault) -> None:
        """A gear-in command accepted before cannot go on."""
        if self.owner == Owner.GEAR_IN_VELO:
            self.gear_in_velo.fail(fault)
        else:
            self.gear_in_pos.fail(fault)
        self.owner = Owner.NOBODY
        self.error_id = fault

    def sync_comes(self, phase: Phase) -> None:
        """The gear-in block shows it, unless it waits for the start of a new command: the former one ends unseen."""
        if self.waits:
            return
        if self.owner == Owner.GEAR_IN_VELO:
            self.gear_in_velo.come(phase)
        else:
            self.gear_in_pos.come(phase)

    # --- the way of the step ---

    def travel(self, piece: int, begin: float, end: float) -> None:
        """A monotone piece of the master's path, 0 being the input correction; cut where a waiting command starts."""
        last = self.master.path.times[piece + 1]
        if self.waits and (end - self.start) * self.toward > 0.0:
            time = self.crossing(piece, self.start)
            self.proceed(piece, begin, self.start, time)
            self.begin_awaited(time)
            self.proceed(piece, self.start, end, last)
        else:
            self.proceed(piece, begin, end, last)

    def proceed(self, piece: int, begin: float, end: float, last: float) -> None:
        """A part of a piece, up to the time `last` since the step's beginning: one event after the other."""
        self.here = begin
        for _ in range(EVENTS):
            more = False
            match self.drive:
                case Drive.OWN:
                    self.arrive(last)
                case Drive.PROFILE:
                    more = self.follow(piece, end)
                case Drive.CHASE:
                    more = self.run_after(piece, last)
                case Drive.LINE:
                    more = self.keep(piece, end)
                case Drive.PARKED:
                    more = self.stand(piece, end)
                case _:
                    pass
            if not more:
                break

    def crossing(self, piece: int, place: float) -> float:
        """When the piece passes the place, s since the step's beginning; the seam takes no time."""
        return self.master.path.crossing(piece, place)

    def beyond(self, place: float) -> float:
        """How far a place lies beyond the coupling position, in the direction of the coupling; 0 within rounding."""
        way = (place - self.coupling) * self.direction
        return way if abs(way) > SAME_PLACE * (abs(place) + abs(self.coupling)) else 0.0

    def arrive(self, last: float) -> None:
        """A motion of the axis that has ended by then has led to its result."""
        if self.owner == Owner.NOBODY or not self.motion.over(self.motion.clock.time + last):
            return
        match self.owner:
            case Owner.HALT:
                self.halt.come(Phase.REACHED)
                self.owner = Owner.NOBODY
            case Owner.STOP:
                self.stop.come(Phase.REACHED)
                self.owner = Owner.NOBODY
                self.locked = self.stop.execute
            case Owner.MOVE_ABSOLUTE:
                self.move_absolute.come(Phase.REACHED)
                self.owner = Owner.NOBODY
            case Owner.MOVE_VELOCITY:
                if self.move_velocity.phase == Phase.BUSY:
                    self.move_velocity.come(Phase.REACHED)
            case _:
                pass

    def follow(self, piece: int, end: float) -> bool:
        """The profile ends at the sync position; backwards it may lead behind the coupling position."""
        reach = abs(self.master_sync - self.coupling)
        if (end - self.master_sync) * self.direction >= -REACHED * reach:
            self.here = self.master_sync
            self.drive = Drive.LINE
            self.sync_comes(Phase.REACHED)
            return True
        if self.beyond(end) < 0.0:
            self.park(self.crossing(piece, self.coupling))
            return True
        return False

    def keep(self, piece: int, end: float) -> bool:
        """In sync, unless the backstop holds the slave where the master passes the coupling position backwards.

        At first a standing master has no direction."""
        if self.direction == 0.0:
            if abs(end - self.coupling) > SAME_PLACE * (abs(end) + abs(self.coupling)):
                self.direction = 1.0 if end > self.coupling else -1.0
            return False
        if self.order.mode.rollback_lock and self.beyond(end) < 0.0 <= self.beyond(self.here):
            self.park(self.crossing(piece, self.coupling))
            return True
        return False

    def stand(self, piece: int, end: float) -> bool:
        """Parked until the master passes the coupling position forwards."""
        if self.waits or self.beyond(end) <= 0.0:
            return False
        self.here = self.coupling
        self.resume(self.crossing(piece, self.coupling))
        return True

    def park(self, time: float) -> None:
        """The master passes the coupling position backwards: to rest at once, or along the ramp of gear_in_velo."""
        self.look(time, self.coupling, self.master.velocity_at(time), self.master.end_acceleration)
        self.profile.begin(ProfileKind.NONE, self.slave.position)
        speed = abs(self.slave.velocity)
        if speed > STANDING * self.order.velocity and not self.order.mode.instant_stop_on_rollback:
            along = -self.slave.acceleration if self.slave.velocity > 0.0 else self.slave.acceleration
            duration = ramp_duration(speed, along, self.order.deceleration, self.order.checked_jerk())
            ramp_from(self.profile, duration, self.slave.velocity, self.slave.acceleration, 0.0)
        self.parked = -time
        self.here = self.coupling
        self.drive = Drive.PARKED
        self.sync_comes(Phase.BUSY)

    def run_after(self, piece: int, last: float) -> bool:
        """In time: the velocities meet, or the target comes to its limit or back from it."""
        if piece == 0:
            return False
        meeting = min(self.motion.end() - self.motion.clock.time, last)
        meets = self.motion.over(self.motion.clock.time + last) and self.chase.reachable and not self.chase.held
        turning = self.chase.turn(self.order, self.master.velocity_at(self.checked), self.master.mean_acceleration())
        if turning >= 0.0:
            turning += self.checked
        if meets and not 0.0 <= turning < meeting:
            self.look(meeting, self.coupling, 0.0, 0.0)
            self.slave_sync = self.slave.position
            self.master_sync = self.master.path.position(meeting)
            self.here = self.master_sync
            self.drive = Drive.LINE
            self.sync_comes(Phase.REACHED)
            return True
        if 0.0 <= turning <= last:
            self.renew(turning)
            return True
        return False

    def renew(self, time: float) -> None:
        """Plan the time-based motion anew if the master does not do what was expected."""
        self.checked = time
        self.glance.aim(self.order, self.master.velocity_at(time), self.master.mean_acceleration())
        if not self.glance.continues(self.order, self.chase, self.motion.clock.time + time):
            self.look(time, self.coupling, 0.0, 0.0)
            self.chase.take(self.glance)
            self.chase.plan(self.order, self.motion, self.slave.position, self.slave.velocity, self.slave.acceleration)
            self.motion.clock.start(time)

    # --- the state at an instant ---

    def look(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """The slave's state at a time since the step's beginning, with the master there and moving so.

        It is laid down in `slave`, whose last look is the step's end."""
        match self.drive:
            case Drive.LINE:
                k = self.order.factor
                self.slave.put(self.slave_sync + k * (place - self.master_sync), k * velocity, k * acceleration, 0.0)
            case Drive.PROFILE:
                self.look_along(place, velocity, acceleration)
            case Drive.PARKED | Drive.HALT:
                self.look_halting(self.parked + time)
            case _:
                position, v, a, j = self.motion.at(self.motion.clock.time + time)
                self.slave.put(position, v, a, j)

    def look_along(self, place: float, velocity: float, acceleration: float) -> None:
        """On the profile, by the chain rule; the master's jerk is taken as 0.

        Ratios of velocities are held where products stay finite, for masters that all but stood at the start."""
        position, v, a, j = self.profile.at((place - self.coupling) * self.per_nominal)
        pace = clamp(velocity * self.per_nominal, -FASTEST, FASTEST)
        gain = clamp(acceleration * self.per_nominal, -FASTEST, FASTEST)
        velocity, acceleration, jerk = chain_rule(v, a, j, pace, gain)
        self.slave.put(position, velocity, acceleration, jerk)

    def look_halting(self, time: float) -> None:
        if time < self.profile.duration():
            position, v, a, j = self.profile.at(time)
            self.slave.put(position, v, a, j)
        else:
            self.slave.put(self.profile.origin + self.profile.way(), 0.0, 0.0, 0.0)

    # --- what is put out ---

    def show(self) -> None:
        self.coupled = self.is_coupled()
        self.in_sync = self.drive == Drive.LINE and not self.waits
        factor = self.awaited.factor if self.waits else self.order.factor
        self.coupling_factor = factor if self.coupled else 0.0
        self.error = self.error_id != Fault.NONE
        self.tell_state()
        self.tell_commands()
        self.tell_progress()

    def tell_state(self) -> None:
        moves = self.slave.velocity != 0.0 or self.slave.acceleration != 0.0
        if self.waits or self.drive == Drive.PARKED:
            self.state = State.PREPHASE
        elif self.drive == Drive.LINE:
            self.state = State.SYNCHRON
        elif self.coupled:
            self.state = State.SYNCHRONIZING
        elif not moves:
            self.state = State.INACTIVE
        elif self.slave.acceleration == 0.0:
            self.state = State.CONSTANT_VELOCITY
        else:
            self.state = (
                State.DECELERATING if self.slave.velocity * self.slave.acceleration < 0.0 else State.ACCELERATING
            )
        self.state_code = self.state
        if self.coupled:
            self.plcopen_state = PlcopenState.SYNCHRONIZED_MOTION
        elif self.locked:
            self.plcopen_state = PlcopenState.STOPPING
        elif not moves:
            self.plcopen_state = PlcopenState.STANDSTILL
        else:
            self.plcopen_state = PlcopenState.DISCRETE_MOTION if self.resting else PlcopenState.CONTINUOUS_MOTION

    def tell_commands(self) -> None:
        begun = self.state in (State.SYNCHRONIZING, State.SYNCHRON)
        self.gear_in_velo.in_sync = self.gear_in_velo.show()
        self.gear_in_velo.start_sync = begun and (self.gear_in_velo.busy or self.gear_in_velo.in_sync)
        self.gear_in_pos.in_sync = self.gear_in_pos.show()
        self.gear_in_pos.start_sync = begun and (self.gear_in_pos.busy or self.gear_in_pos.in_sync)
        self.gear_out.show()
        self.halt.done = self.halt.show()
        self.stop.done = self.stop.show()
        self.move_velocity.in_velocity = self.move_velocity.show()
        self.move_absolute.done = self.move_absolute.show()
        self.reset.show()

    def tell_progress(self) -> None:
        """Of the synchronisation, at constant master velocity."""
        if self.drive == Drive.PROFILE and not self.waits:
            missing = max((self.master_sync - self.master.end) * self.direction, 0.0)
            self.local.progress = clamp(1.0 - missing * self.per_travel, 0.0, 1.0)
            self.local.master_distance_to_sync = missing
        elif self.in_sync:
            self.local.progress = 1.0
            self.local.master_distance_to_sync = 0.0
        else:
            self.local.master_distance_to_sync = 0.0
            if self.coupled:
                self.local.progress = 0.0
