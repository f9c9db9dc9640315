"""FlyingSaw: a slave axis that can be coupled to a moving master from any state of motion.

It is coupled to the master's velocity, or so that both axes meet at given positions; uncoupled it moves by itself.
Source: TwinCAT's universal flying saw (TS5055) and PLCopen's function blocks. The decisions where these are silent, and
the diagram of the states, stand in the README of this folder.
"""

from dataclasses import dataclass

from .. import var
from ..axis_limits import are_finite, limit_in_use
from ..cosine import cosine
from ..exceeded import Exceeded, Limit
from ..grid import wrap
from ..laws import chain_rule
from ..limits import clamp, usable
from ..motion import Motion, acceleration_limit
from ..var import Enumeration
from .commands import Command, GearInVelo, Halt, Phase
from .faults import Fault, Refusal
from .interface import FlyingSawInterface, PlcopenState, State
from .order import Order
from .planning import Plan
from .profile import Profile, ProfileKind
from .segments import add_ramp_from_acceleration, ramp_duration
from .time_based_sync import TimeBasedSync

SAME_PLACE = 1e-15  # of the master's position: a smaller distance is rounding
JUST_PASSED = 1e-12  # of a period: a sync position that is less ahead is the one just passed
PROFILE_END = 1e-9  # of a profile's master travel: closer to its end it is over, which differs by rounding only
NO_HALT = 1e-12  # of the velocity limit: a slave that is slower than that rests at once
SMALLEST_DIVISOR = 1e-300  # u or u/s: the reciprocal of a divisor that is not smaller is finite
LARGEST_RATIO = 1e60  # to the nominal master velocity: products of the profile's derivatives with its powers are finite
MOST_EVENTS = 8  # in a monotone piece of the master's path there are three at most


class Stage(Enumeration):
    """What drives the slave"""

    CONTINUOUS_MOTION = 0, "a motion of its own that goes on for ever"
    DISCRETE_MOTION = 1, "a motion of its own that ends at rest"
    UNCOUPLED_HALT = 2, "the halt of PARKED, which goes on although the coupling has ended"
    PROFILE = 3, "a profile over the master's position"
    TIME_BASED = 4, "a motion in time towards the master's velocity"
    IN_SYNC = 5, "the synchronous line over the master's position"
    PARKED = 6, "a halt in time, then rest, until the master passes the coupling position forwards"


class Owner(Enumeration):
    """Whose command moves the axis, or waits to do so"""

    NOBODY = 0, "no command's, or one that is done"
    GEAR_IN_VELO = 1, "gear_in_velo's"
    GEAR_IN_POS = 2, "gear_in_pos's"
    HALT = 3, "halt's"
    STOP = 4, "stop's"
    MOVE_VELOCITY = 5, "move_velocity's"
    MOVE_ABSOLUTE = 6, "move_absolute's"


@dataclass(slots=True)
class FlyingSaw(FlyingSawInterface):
    """Couples a slave axis to a moving master, at its velocity or at given positions, from any state of motion.

    The block is the slave axis with its setpoint generator. Uncoupled it moves by itself: move_absolute, move_velocity,
    halt and stop are time-optimal with limited jerk. gear_in_velo takes it to the master's velocity times the coupling
    factor as fast as the limits allow; gear_in_pos takes it there so that the slave is at slave_sync_position just when
    the master is at master_sync_position. From then on it is in sync until gear_out or another motion command uncouples
    it: a tool on it works on moving material as if the material stood still.

    The way into sync is a curve over the master's position, so it is exact whatever the master does meanwhile.
    sync_mode says which limits that curve has to keep, and what happens if the master turns round; a command that
    cannot keep them is refused, and the slave goes on as before.

    The outputs at the end of a step are those for the master at the end of the step. Commands act at the step's
    beginning.
    """

    # Not shown. Places are unwrapped positions of the master, u; times are in s.
    cosine: float = 1.0  # of diagonal_angle
    stage: Stage = Stage.CONTINUOUS_MOTION
    owner: Owner = Owner.NOBODY
    locked: bool = False  # by stop
    waiting: bool = False  # gear_in_pos waits until the master passes start_place in start_direction; the stage goes on
    start_place: float = 0.0
    start_direction: float = 1.0
    requested_order: Order = var.part(Order)  # of the present edge
    pending_order: Order = var.part(Order)  # of the command that waits
    active_order: Order = var.part(Order)  # of the coupling
    coupling_place: float = 0.0  # where the synchronisation began
    direction: float = 1.0  # the coupling's direction of travel; 0: unknown, since the master stood
    master_sync: float = 0.0  # the synchronous line passes through this place ...
    slave_sync: float = 0.0  # ... and this position of the slave
    motion: Motion = var.part(Motion)  # the slave's own, and the one of TIME_BASED
    time_based: TimeBasedSync = var.part(TimeBasedSync)
    candidate: TimeBasedSync = var.part(TimeBasedSync)  # the target as the master moves now
    compared_at: float = 0.0  # when candidate and time_based were compared last, since the step's beginning
    profile: Profile = var.part(Profile)  # of PROFILE; in PARKED and UNCOUPLED_HALT the halt, over time
    per_nominal_velocity: float = 1.0  # reciprocal of the profile's nominal master velocity
    per_travel: float = 0.0  # reciprocal of the profile's master travel
    halt_time: float = 0.0  # from the halt's beginning to the step's; a halt is too short for this sum to need a Clock
    here: float = 0.0  # the place up to which all events of this step are carried out
    until: float = 0.0  # when the present part of a piece ends, since the step's beginning
    plan: Plan = var.part(Plan)  # the last one made
    planned_exceeded: Exceeded = var.part(Exceeded)  # by the motion under way, as it was planned
    present_exceeded: Exceeded = var.part(Exceeded)  # by the setpoint

    def initialize(self) -> Refusal:
        """The axis stands, or moves at its initial velocity; may be called again while parameters still change."""
        if self.axis.min_position > self.axis.max_position:
            return Refusal.END_POSITIONS
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.motion.run(self.axis.initial_position, self.axis.initial_velocity)
        self.hold_edges()
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.planned_exceeded.clear()
        self.present_exceeded.clear()
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the path of the step."""
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(0)
        self.obey()
        for piece in range(1, self.master.path.pieces):
            self.travel(piece)
        self.motion.advance(h)
        self.halt_time += h
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.judge_limits()
        self.show()
        self.rebase()
        return Refusal.NONE

    # --- the commands ---

    def hold_edges(self) -> None:
        """Take the present levels of `execute` as they are: the first value seen is no edge."""
        self.reset.edge.hold(self.reset.execute)
        self.stop.edge.hold(self.stop.execute)
        self.halt.edge.hold(self.halt.execute)
        self.gear_out.edge.hold(self.gear_out.execute)
        self.gear_in_velo.edge.hold(self.gear_in_velo.execute)
        self.gear_in_pos.edge.hold(self.gear_in_pos.execute)
        self.move_velocity.edge.hold(self.move_velocity.execute)
        self.move_absolute.edge.hold(self.move_absolute.execute)

    def obey(self) -> None:
        """Carry out the commands that have an edge in this step, in the order of urgency."""
        if self.locked and not self.stop.execute and not self.is_moving():
            self.locked = False
        if self.reset.edge.try_rise(self.reset.execute):
            self.reset.done = True
            self.error_id = Fault.NONE
        if self.stop.edge.try_rise(self.stop.execute):
            self.command_halt(self.stop, Owner.STOP)
        if self.halt.edge.try_rise(self.halt.execute):
            self.command_halt(self.halt, Owner.HALT)
        if self.gear_out.edge.try_rise(self.gear_out.execute):
            self.command_gear_out()
        if self.gear_in_velo.edge.try_rise(self.gear_in_velo.execute):
            self.requested_order.sample(self.gear_in_velo, self.axis, self.sync_mode, self.cosine)
            self.command_gear_in(self.gear_in_velo, Owner.GEAR_IN_VELO)
        if self.gear_in_pos.edge.try_rise(self.gear_in_pos.execute):
            self.requested_order.sample(self.gear_in_pos, self.axis, self.sync_mode, self.cosine)
            self.requested_order.aim(
                self.sync_place(self.gear_in_pos.master_sync_position),
                self.gear_in_pos.slave_sync_position,
                self.gear_in_pos.master_start_distance,
            )
            self.command_gear_in(self.gear_in_pos, Owner.GEAR_IN_POS)
        if self.move_velocity.edge.try_rise(self.move_velocity.execute):
            self.command_move_velocity()
        if self.move_absolute.edge.try_rise(self.move_absolute.execute):
            self.command_move_absolute()

    def command_halt(self, command: Halt, owner: Owner) -> None:
        """halt or stop: to rest with the command's deceleration; stop locks the axis."""
        deceleration = limit_in_use(command.deceleration, self.axis.deceleration())
        jerk = limit_in_use(command.jerk, self.axis.max_jerk)
        fault = Fault.NONE
        if self.locked and owner != Owner.STOP:
            fault = Fault.LOCKED
        elif not (usable(deceleration) and usable(jerk)):
            fault = Fault.LIMIT
        if self.try_accept(command, owner, fault):
            self.motion.halt(self.slave.position, self.slave.velocity, self.slave.acceleration, deceleration, jerk)
            self.enter_discrete_motion()
            self.locked = owner == Owner.STOP

    def command_move_velocity(self) -> None:
        acceleration = limit_in_use(self.move_velocity.acceleration, self.axis.max_acceleration)
        deceleration = limit_in_use(self.move_velocity.deceleration, self.axis.deceleration())
        jerk = limit_in_use(self.move_velocity.jerk, self.axis.max_jerk)
        target = self.move_velocity.velocity
        fault = Fault.NONE
        if self.locked:
            fault = Fault.LOCKED
        elif not (
            usable(acceleration) and usable(deceleration) and usable(jerk) and abs(target) <= self.axis.max_velocity
        ):
            fault = Fault.LIMIT
        if self.try_accept(self.move_velocity, Owner.MOVE_VELOCITY, fault):
            limit = acceleration_limit(self.slave.velocity, target, acceleration, deceleration)
            self.motion.try_change(
                self.slave.position, self.slave.velocity, self.slave.acceleration, target, 0.0, -limit, limit, jerk
            )
            self.enter_continuous_motion()

    def command_move_absolute(self) -> None:
        velocity = limit_in_use(self.move_absolute.velocity, self.axis.max_velocity)
        acceleration = limit_in_use(self.move_absolute.acceleration, self.axis.max_acceleration)
        deceleration = limit_in_use(self.move_absolute.deceleration, self.axis.deceleration())
        jerk = limit_in_use(self.move_absolute.jerk, self.axis.max_jerk)
        limits_usable = usable(velocity) and usable(acceleration) and usable(deceleration) and usable(jerk)
        target = self.move_absolute.position
        fault = Fault.NONE
        if self.locked:
            fault = Fault.LOCKED
        elif not (are_finite(self.axis.min_position, self.axis.max_position) and limits_usable):
            fault = Fault.LIMIT
        elif target < self.axis.min_position:
            fault = Fault.MIN_POSITION
        elif target > self.axis.max_position:
            fault = Fault.MAX_POSITION
        if self.try_accept(self.move_absolute, Owner.MOVE_ABSOLUTE, fault):
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
            self.enter_discrete_motion()

    def command_gear_out(self) -> None:
        self.gear_out.conclude(Fault.LOCKED if self.locked else Fault.NONE)
        self.error_id = Fault.LOCKED if self.locked else Fault.NONE
        if not self.locked and self.is_coupled():
            self.abort_owner()
            self.owner = Owner.NOBODY
            self.set_slave_at_begin()
            self.run_on()

    def command_gear_in(self, command: GearInVelo, owner: Owner) -> None:
        """gear_in_velo or gear_in_pos, at once, or when the master passes the start that lies ahead."""
        place = self.master.begin
        order = self.requested_order
        self.set_plan_from(0.0, place, self.master.begin_velocity, self.master.begin_acceleration)
        direction = 1.0 if self.master.begin_velocity > 0.0 else -1.0
        start = order.master_sync - direction * order.start_distance
        later = order.start_distance > 0.0 and (place - start) * direction < 0.0
        fault = Fault.LOCKED if self.locked else order.fault()
        if fault == Fault.NONE:
            fault = self.plan.try_prepare_to_position(order) if later else self.try_plan(order)
        if self.try_accept(command, owner, fault):
            self.waiting = later
            if later:
                var.copy(self.pending_order, order)
                self.start_place = start
                self.start_direction = direction
            else:
                var.copy(self.active_order, order)
                self.couple(0.0, place)

    def try_accept(self, command: Command, owner: Owner, fault: Fault) -> bool:
        """Refuse a command for a fault; without one it takes the place of the owner's, which is aborted.

        An accepted command finds in `slave` the slave's state at the step's beginning."""
        if fault != Fault.NONE:
            command.refuse(fault)
            self.error_id = fault
            return False
        self.set_slave_at_begin()
        self.abort_owner()
        command.accept()
        self.owner = owner
        self.error_id = Fault.NONE
        return True

    def abort_owner(self) -> None:
        """Tell the command that has moved the axis up to now that another one has taken its place."""
        match self.owner:
            case Owner.GEAR_IN_VELO:
                self.gear_in_velo.report(Phase.ABORTED)
            case Owner.GEAR_IN_POS:
                self.gear_in_pos.report(Phase.ABORTED)
            case Owner.HALT:
                self.halt.report(Phase.ABORTED)
            case Owner.STOP:
                self.stop.report(Phase.ABORTED)
            case Owner.MOVE_VELOCITY:
                self.move_velocity.report(Phase.ABORTED)
            case Owner.MOVE_ABSOLUTE:
                self.move_absolute.report(Phase.ABORTED)
            case _:
                pass

    def fail_owner(self, fault: Fault) -> None:
        """A gear-in command that was accepted before cannot go on."""
        if self.owner == Owner.GEAR_IN_VELO:
            self.gear_in_velo.fail(fault)
        else:
            self.gear_in_pos.fail(fault)
        self.owner = Owner.NOBODY
        self.error_id = fault

    def report_sync(self, phase: Phase) -> None:
        """Tell the owner's gear-in block; the former coupling of a command that waits ends without being shown."""
        if self.waiting:
            return
        if self.owner == Owner.GEAR_IN_VELO:
            self.gear_in_velo.report(phase)
        else:
            self.gear_in_pos.report(phase)

    def is_coupled(self) -> bool:
        """Whether a gear-in command moves the slave or waits to do so."""
        return self.waiting or self.stage not in (
            Stage.CONTINUOUS_MOTION,
            Stage.DISCRETE_MOTION,
            Stage.UNCOUPLED_HALT,
        )

    def is_moving(self) -> bool:
        """Whether the slave's setpoint moves."""
        return self.slave.velocity != 0.0 or self.slave.acceleration != 0.0

    def sync_place(self, position: float) -> float:
        """The place that a master's sync position means.

        With a period a position in [0, period) means its next occurrence ahead of the master. Any other position lies
        in the same turn as the master's input, whether that is wrapped or not."""
        period = self.master.period
        if period == 0.0:
            return position
        if not 0.0 <= position < period:
            return self.master.unwrap_in_current_turn(position)
        missing = position - wrap(self.master.begin, period)
        if self.master.begin_velocity >= 0.0 and missing <= JUST_PASSED * period:
            missing += period
        elif self.master.begin_velocity < 0.0 and missing >= -JUST_PASSED * period:
            missing -= period
        return self.master.begin + missing

    # --- coupling ---

    def set_plan_from(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """Put the state of both axes into the plan; the master's is given, the slave's belongs to it."""
        self.set_slave_at(time, place, velocity, acceleration)
        self.plan.master.put(place, velocity, acceleration)
        self.plan.slave.put(self.slave.position, self.slave.velocity, self.slave.acceleration)

    def try_plan(self, order: Order) -> Fault:
        """Plan from the states put into the plan, and put out what the plan asks of the slave, refused or not."""
        fault = self.plan.try_order(order)
        if self.plan.judged:
            self.local.show_plan(self.plan.extremes)
        return fault

    def couple(self, time: float, place: float) -> None:
        """Begin the plan made for this instant, s since the step's beginning."""
        self.characteristics.show(self.plan, self.master.period)
        self.coupling_place = place
        self.local.coupling_position = wrap(place, self.master.period)
        nominal = self.plan.master.velocity
        self.direction = 1.0 if nominal > 0.0 else -1.0 if nominal < 0.0 else 0.0
        self.master_sync = self.plan.master_end
        self.slave_sync = self.plan.end
        if self.plan.at_once:
            self.enter_in_sync()
        elif self.active_order.mode.time_based:
            self.enter_time_based(time)
        else:
            self.enter_profile()

    def start_pending(self, time: float) -> None:
        """The master passes the start: plan the waiting command from the present state.

        If that is refused, a motion of the slave's own goes on, and a coupled slave runs on at its velocity."""
        self.set_plan_from(time, self.start_place, self.master.velocity_at(time), self.master.end_acceleration)
        self.waiting = False
        fault = self.try_plan(self.pending_order)
        if fault == Fault.NONE:
            var.copy(self.active_order, self.pending_order)
            self.couple(time, self.start_place)
        else:
            self.fail_owner(fault)
            if self.is_coupled():
                self.run_on()
                self.motion.clock.start(time)

    def couple_again(self, time: float) -> None:
        """The master passes the coupling position forwards again: plan anew from the present state."""
        self.set_plan_from(time, self.coupling_place, self.master.velocity_at(time), self.master.end_acceleration)
        fault = self.try_plan(self.active_order)
        if fault == Fault.NONE:
            self.couple(time, self.coupling_place)
        else:
            self.fail_owner(fault)
            self.enter_uncoupled_halt()

    def run_on(self) -> None:
        """Uncouple: the slave runs on from the state in `slave`, without acceleration."""
        self.motion.run(self.slave.position, self.slave.velocity)
        self.enter_continuous_motion()

    def update_time_based(self, time: float) -> None:
        """Plan the time-based motion anew at that time if the master does not do what was expected."""
        self.compared_at = time
        self.candidate.aim(self.active_order, self.master.velocity_at(time), self.master.mean_acceleration())
        if not self.candidate.continues(self.active_order, self.time_based, self.motion.clock.time + time):
            self.set_slave_at(time, self.coupling_place, 0.0, 0.0)
            if self.motion.over(self.motion.clock.time + time):
                self.planned_exceeded.clear()
            var.copy(self.time_based, self.candidate)
            self.plan_time_based(time)

    def plan_time_based(self, time: float) -> None:
        """Plan the motion to the time-based target from the state in `slave`, which belongs to that time."""
        self.time_based.plan(
            self.active_order, self.motion, self.slave.position, self.slave.velocity, self.slave.acceleration
        )
        self.motion.clock.start(time)

    # --- the stages' beginnings ---

    def enter_continuous_motion(self) -> None:
        """The motion just planned drives the slave; it goes on for ever."""
        self.waiting = False
        self.judge_motion()
        self.stage = Stage.CONTINUOUS_MOTION

    def enter_discrete_motion(self) -> None:
        """The motion just planned drives the slave; it ends at rest."""
        self.waiting = False
        self.judge_motion()
        self.stage = Stage.DISCRETE_MOTION

    def enter_uncoupled_halt(self) -> None:
        """The halt of PARKED goes on, or the rest after it, but the axis is uncoupled."""
        self.stage = Stage.UNCOUPLED_HALT

    def judge_motion(self) -> None:
        """Find what the motion just planned exceeds, until it is at its velocity or at rest."""
        if self.plan.try_measure_motion(self.motion):
            self.plan.extremes.judge_limits(self.axis, self.planned_exceeded)
        else:
            self.planned_exceeded.clear()

    def enter_profile(self) -> None:
        """The planned profile begins at the coupling place."""
        self.plan.extremes.judge_limits(self.axis, self.planned_exceeded)
        var.copy(self.profile, self.plan.profile)
        self.per_nominal_velocity = clamp(
            1.0 / self.plan.master.velocity, -1.0 / SMALLEST_DIVISOR, 1.0 / SMALLEST_DIVISOR
        )
        self.per_travel = 1.0 / max(abs(self.master_sync - self.coupling_place), SMALLEST_DIVISOR)
        self.stage = Stage.PROFILE

    def enter_time_based(self, time: float) -> None:
        """The motion in time begins from the state in `slave`, s since the step's beginning."""
        if self.plan.profile.pieces > 0:
            self.plan.extremes.judge_limits(self.axis, self.planned_exceeded)
        else:
            self.planned_exceeded.clear()
        self.compared_at = time
        self.time_based.aim(self.active_order, self.master.velocity_at(time), self.master.mean_acceleration())
        self.plan_time_based(time)
        self.stage = Stage.TIME_BASED

    def enter_in_sync(self) -> None:
        """The slave is on the synchronous line through master_sync and slave_sync."""
        self.planned_exceeded.clear()
        self.stage = Stage.IN_SYNC
        self.report_sync(Phase.REACHED)

    def enter_parked(self, time: float) -> None:
        """The master passes the coupling position backwards: to rest at once, or along the ramp of gear_in_velo."""
        self.set_slave_at(time, self.coupling_place, self.master.velocity_at(time), self.master.end_acceleration)
        self.profile.begin(ProfileKind.NONE, self.slave.position)
        self.planned_exceeded.clear()
        order = self.active_order
        speed = abs(self.slave.velocity)
        if speed > NO_HALT * order.velocity:
            if order.mode.instant_stop_on_rollback:
                self.planned_exceeded.put(Limit.INSTANT_STOP, speed)
            else:
                along = -self.slave.acceleration if self.slave.velocity > 0.0 else self.slave.acceleration
                duration = ramp_duration(speed, along, order.deceleration, order.checked_jerk())
                add_ramp_from_acceleration(self.profile, duration, self.slave.velocity, self.slave.acceleration, 0.0)
                self.plan.extremes.measure(self.profile)
                self.plan.extremes.judge_limits(self.axis, self.planned_exceeded)
        self.halt_time = -time
        self.here = self.coupling_place
        self.stage = Stage.PARKED
        self.report_sync(Phase.BUSY)

    # --- the path of the step ---

    def travel(self, piece: int) -> None:
        """Go along a monotone piece of the master's path, which is cut where a waiting command starts.

        Piece 0, the input correction, takes no time, so nothing that happens in time happens there."""
        begin = self.master.path.places[piece]
        end = self.master.path.places[piece + 1]
        end_time = self.master.path.times[piece + 1]
        if self.waiting and (end - self.start_place) * self.start_direction > 0.0:
            time = self.master.path.crossing(piece, self.start_place)
            self.travel_part(piece, begin, self.start_place, time)
            self.start_pending(time)
            self.travel_part(piece, self.start_place, end, end_time)
        else:
            self.travel_part(piece, begin, end, end_time)

    def travel_part(self, piece: int, begin: float, end: float, end_time: float) -> None:
        """Go along a part of a piece, which ends at `end_time`, s since the step's beginning: one event after the
        other."""
        self.here = begin
        self.until = end_time
        for _ in range(MOST_EVENTS):
            if not self.try_event(piece, end):
                break

    def try_event(self, piece: int, end: float) -> bool:
        """Carry out the next event of the stage up to the place `end`; whether there was one."""
        happened = False
        match self.stage:
            case Stage.CONTINUOUS_MOTION:
                happened = self.try_event_continuous_motion(piece)
            case Stage.DISCRETE_MOTION:
                happened = self.try_event_discrete_motion(piece)
            case Stage.PROFILE:
                happened = self.try_event_profile(piece, end)
            case Stage.TIME_BASED:
                happened = self.try_event_time_based(piece)
            case Stage.IN_SYNC:
                happened = self.try_event_in_sync(piece, end)
            case Stage.PARKED:
                happened = self.try_event_parked(piece, end)
            case _:  # UNCOUPLED_HALT ends by a command only
                pass
        return happened

    def try_event_continuous_motion(self, piece: int) -> bool:
        """The velocity of move_velocity is reached."""
        if piece == 0 or self.owner != Owner.MOVE_VELOCITY or self.move_velocity.phase != Phase.BUSY:
            return False
        if not self.motion.over(self.motion.clock.time + self.until):
            return False
        self.move_velocity.report(Phase.REACHED)
        return True

    def try_event_discrete_motion(self, piece: int) -> bool:
        """The motion has ended, and the owner's command with it."""
        if piece == 0 or not self.motion.over(self.motion.clock.time + self.until):
            return False
        match self.owner:
            case Owner.HALT:
                self.halt.report(Phase.REACHED)
            case Owner.STOP:
                self.stop.report(Phase.REACHED)
                self.locked = self.stop.execute
            case Owner.MOVE_ABSOLUTE:
                self.move_absolute.report(Phase.REACHED)
            case _:
                return False
        self.owner = Owner.NOBODY
        return True

    def try_event_profile(self, piece: int, end: float) -> bool:
        """The profile ends at the sync position; a master that turns back may leave it at the coupling position."""
        distance = abs(self.master_sync - self.coupling_place)
        if (end - self.master_sync) * self.direction >= -PROFILE_END * distance:
            self.here = self.master_sync
            self.enter_in_sync()
            return True
        if self.distance_beyond_coupling(end) < 0.0:
            self.enter_parked(self.master.path.crossing(piece, self.coupling_place))
            return True
        return False

    def try_event_time_based(self, piece: int) -> bool:
        """The velocities meet, or the target reaches its limit or comes back from it; piece 0 tells how the master
        moves now."""
        if piece == 0:
            self.update_time_based(0.0)
            return False
        meeting = min(self.motion.end() - self.motion.clock.time, self.until)
        over = self.motion.over(self.motion.clock.time + self.until)
        meets = over and self.time_based.reachable and not self.time_based.held
        limit = self.time_based.time_to_limit(
            self.active_order, self.master.velocity_at(self.compared_at), self.master.mean_acceleration()
        )
        if limit >= 0.0:
            limit += self.compared_at
        if meets and not 0.0 <= limit < meeting:
            self.set_slave_at(meeting, self.coupling_place, 0.0, 0.0)
            self.slave_sync = self.slave.position
            self.master_sync = self.master.path.position(meeting)
            self.here = self.master_sync
            self.enter_in_sync()
            return True
        if 0.0 <= limit <= self.until:
            self.update_time_based(limit)
            return True
        return False

    def try_event_in_sync(self, piece: int, end: float) -> bool:
        """The backstop parks the slave where the master passes the coupling position backwards.

        A coupling to a standing master takes its direction from the master's first motion, which is no event."""
        if self.direction == 0.0:
            if abs(end - self.coupling_place) > SAME_PLACE * (abs(end) + abs(self.coupling_place)):
                self.direction = 1.0 if end > self.coupling_place else -1.0
            return False
        passed = self.distance_beyond_coupling(end) < 0.0 <= self.distance_beyond_coupling(self.here)
        if self.active_order.mode.rollback_lock and passed:
            self.enter_parked(self.master.path.crossing(piece, self.coupling_place))
            return True
        return False

    def try_event_parked(self, piece: int, end: float) -> bool:
        """The master passes the coupling position forwards; a waiting command keeps the slave parked."""
        if self.waiting or self.distance_beyond_coupling(end) <= 0.0:
            return False
        self.here = self.coupling_place
        self.couple_again(self.master.path.crossing(piece, self.coupling_place))
        return True

    def distance_beyond_coupling(self, place: float) -> float:
        """How far a place lies beyond the coupling position, in the coupling's direction, u; 0 within rounding."""
        distance = (place - self.coupling_place) * self.direction
        return distance if abs(distance) > SAME_PLACE * (abs(place) + abs(self.coupling_place)) else 0.0

    # --- the slave at an instant ---

    def set_slave_at(self, time: float, place: float, velocity: float, acceleration: float) -> None:
        """Set `slave` to its state at a time, s since the step's beginning, with the master at `place`, moving so.

        The last state set in a step is the one put out."""
        match self.stage:
            case Stage.IN_SYNC:
                k = self.active_order.factor
                position = self.slave_sync + k * (place - self.master_sync)
                self.slave.put(position, k * velocity, k * acceleration, 0.0)
            case Stage.PROFILE:
                self.set_slave_on_profile(place, velocity, acceleration)
            case Stage.PARKED | Stage.UNCOUPLED_HALT:
                self.set_slave_in_halt(self.halt_time + time)
            case _:
                position, v, a, j = self.motion.at(self.motion.clock.time + time)
                self.slave.put(position, v, a, j)

    def set_slave_at_begin(self) -> None:
        """Set `slave` to its state at the step's beginning, where the commands act."""
        self.set_slave_at(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)

    def set_slave_on_profile(self, place: float, velocity: float, acceleration: float) -> None:
        """Set `slave` by the chain rule; the master's jerk is taken as 0.

        The master may all but have stood at the start, so its velocity and acceleration over the nominal velocity are
        kept where products stay finite."""
        position, v, a, j = self.profile.at((place - self.coupling_place) * self.per_nominal_velocity)
        relative_velocity = clamp(velocity * self.per_nominal_velocity, -LARGEST_RATIO, LARGEST_RATIO)
        relative_acceleration = clamp(acceleration * self.per_nominal_velocity, -LARGEST_RATIO, LARGEST_RATIO)
        velocity, acceleration, jerk = chain_rule(v, a, j, relative_velocity, relative_acceleration)
        self.slave.put(position, velocity, acceleration, jerk)

    def set_slave_in_halt(self, time: float) -> None:
        """Set `slave` to its state at a time since the halt began, s: on the ramp, or at rest after it."""
        if time < self.profile.duration():
            position, v, a, j = self.profile.at(time)
            self.slave.put(position, v, a, j)
        else:
            self.slave.put(self.profile.origin + self.profile.distance(), 0.0, 0.0, 0.0)

    # --- the limits of the axis ---

    def is_planned_motion_over(self) -> bool:
        """Whether the motion under way has come to the end of what was planned; the step's time has passed."""
        match self.stage:
            case Stage.CONTINUOUS_MOTION | Stage.DISCRETE_MOTION | Stage.TIME_BASED:
                return self.motion.over(self.motion.clock.time)
            case Stage.PARKED | Stage.UNCOUPLED_HALT:
                return self.profile.pieces > 0 and self.halt_time >= self.profile.duration()
            case _:
                return False

    def judge_limits(self) -> None:
        """Find which limit of the axis is exceeded at the end of a step, by the plan under way or by the setpoint."""
        if self.planned_exceeded.limit != Limit.NONE and self.is_planned_motion_over():
            self.planned_exceeded.clear()
        self.present_exceeded.judge_setpoint(self.axis, self.slave)

    # --- what is put out ---

    def show(self) -> None:
        """Derive the outputs at the end of a step."""
        self.coupled = self.is_coupled()
        self.in_sync = self.stage == Stage.IN_SYNC and not self.waiting
        factor = self.pending_order.factor if self.waiting else self.active_order.factor
        self.coupling_factor = factor if self.coupled else 0.0
        self.error = self.error_id != Fault.NONE
        self.show_state()
        self.show_plcopen_state()
        self.show_commands()
        self.show_progress()
        self.show_limits()

    def show_state(self) -> None:
        if self.waiting or self.stage == Stage.PARKED:
            self.state = State.PREPHASE
        elif self.stage == Stage.IN_SYNC:
            self.state = State.SYNCHRON
        elif self.coupled:
            self.state = State.SYNCHRONIZING
        elif not self.is_moving():
            self.state = State.INACTIVE
        elif self.slave.acceleration == 0.0:
            self.state = State.CONSTANT_VELOCITY
        elif self.slave.velocity * self.slave.acceleration < 0.0:
            self.state = State.DECELERATING
        else:
            self.state = State.ACCELERATING
        self.state_code = self.state

    def show_plcopen_state(self) -> None:
        if self.coupled:
            self.plcopen_state = PlcopenState.SYNCHRONIZED_MOTION
        elif self.locked:
            self.plcopen_state = PlcopenState.STOPPING
        elif not self.is_moving():
            self.plcopen_state = PlcopenState.STANDSTILL
        elif self.stage == Stage.CONTINUOUS_MOTION:
            self.plcopen_state = PlcopenState.CONTINUOUS_MOTION
        else:
            self.plcopen_state = PlcopenState.DISCRETE_MOTION

    def show_commands(self) -> None:
        self.show_gear_in(self.gear_in_velo)
        self.show_gear_in(self.gear_in_pos)
        self.gear_out.show()
        self.halt.show()
        self.halt.done = self.halt.is_reached()
        self.stop.show()
        self.stop.done = self.stop.is_reached()
        self.move_velocity.show()
        self.move_velocity.in_velocity = self.move_velocity.is_reached()
        self.move_absolute.show()
        self.move_absolute.done = self.move_absolute.is_reached()
        self.reset.show()

    def show_gear_in(self, command: GearInVelo) -> None:
        begun = self.state in (State.SYNCHRONIZING, State.SYNCHRON)
        command.show()
        command.in_sync = command.is_reached()
        command.start_sync = begun and (command.busy or command.in_sync)

    def show_progress(self) -> None:
        """Put out how far the synchronisation has come, at constant master velocity; it stays when uncoupled."""
        missing = 0.0
        if self.stage == Stage.PROFILE and not self.waiting:
            missing = max((self.master_sync - self.master.end) * self.direction, 0.0)
            self.local.progress = clamp(1.0 - missing * self.per_travel, 0.0, 1.0)
        elif self.in_sync:
            self.local.progress = 1.0
        elif self.coupled:
            self.local.progress = 0.0
        self.local.master_distance_to_sync = missing

    def show_limits(self) -> None:
        """Put out the first of both limits in the order of `Limit`; where they are the same, as it was planned."""
        planned = self.planned_exceeded.limit
        present = self.present_exceeded.limit
        if planned == Limit.NONE or (present != Limit.NONE and present < planned):
            self.local.show_exceeded(self.present_exceeded)
        else:
            self.local.show_exceeded(self.planned_exceeded)
        self.limit_exceeded = self.local.exceeded_limit != Limit.NONE

    def rebase(self) -> None:
        """Drop the master's whole turns while nothing lies at a particular turn."""
        if not self.coupled:
            self.master.rebase()
