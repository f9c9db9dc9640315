"""FlyingSaw: a slave axis that can be coupled to a moving master from any state of motion.

Source: TwinCAT's universal flying saw (TS5055) and PLCopen's function blocks. See also README.md in this folder.
"""

from dataclasses import dataclass

from .. import var
from ..master_path import MOST_EVENTS
from ..motion.exceeded_limit import ExceededLimit, Limit
from ..motion.jerk_limited import Motion
from ..numerics.computable_range import clamp
from ..numerics.cosine import cosine
from ..numerics.grid import wrap
from .axis_outputs import show_limits, show_plcopen_state, show_state
from .commands import Command, GearInVelo, Halt, Phase
from .faults import Fault, Refusal
from .function_blocks import Owner, report_phase, show_function_blocks, take_execute_levels
from .gear_in_request import GearInRequest, unwrap_sync_position
from .interface import FlyingSawInterface
from .motion_request import MotionRequest
from .profile import Profile, ProfileKind
from .profile_plan import ProfilePlan
from .saw_master import coupling_acceleration
from .segments import add_ramp_from_acceleration, ramp_duration
from .stage import Stage
from .time_based_sync import TimeBasedSync

SAME_PLACE = 1e-15  # of the master's position: a smaller distance is rounding
PROFILE_END = 1e-9  # of a profile's master travel: closer to its end it is over
NO_HALT = 1e-12  # of the velocity limit: a slave that is slower than that rests at once
SMALLEST_DIVISOR = 1e-300  # u or u/s: the reciprocal of a divisor that is not smaller is finite


@dataclass(slots=True)
class FlyingSaw(FlyingSawInterface):
    """Couples a slave axis to a moving master, at its velocity or at given positions, from any state of motion.

    The block is the slave axis with its setpoint generator. Uncoupled it moves by itself: move_absolute, move_velocity,
    halt and stop are time-optimal with limited jerk. gear_in_velo takes it to the master's velocity times the coupling
    factor as fast as the limits allow; gear_in_pos takes it there so that the slave is at slave_sync_position just when
    the master is at master_sync_position. From then on it is in sync until gear_out or another motion command uncouples
    it: a tool on it works on moving material as if the material were at rest.

    The way into sync is a curve over the master's position, so it is exact whatever the master does meanwhile.
    sync_mode selects the limits that this curve has to keep, and what happens if the master reverses. A command that
    cannot keep them is refused, and the slave goes on as before.

    The outputs at the end of a step are those for the master at the end of the step. Commands act at the step's
    beginning.
    """

    # Not shown. Positions of the master are unwrapped, u; times are in s.
    cosine: float = 1.0  # of diagonal_angle
    stage: Stage = Stage.CONTINUOUS_MOTION
    owner: Owner = Owner.NOBODY
    locked: bool = False  # by stop
    waiting: bool = False  # gear_in_pos waits until the master passes start_position in start_direction
    start_position: float = 0.0
    start_direction: float = 1.0
    motion_request: MotionRequest = var.part(MotionRequest)  # of the newest edge
    new_request: GearInRequest = var.part(GearInRequest)  # of the newest edge
    pending_request: GearInRequest = var.part(GearInRequest)  # of the command that waits
    active_request: GearInRequest = var.part(GearInRequest)  # of the coupling
    coupling_position: float = 0.0  # where the synchronisation began
    direction: float = 1.0  # the coupling's direction of travel; 0: unknown, since the master was at rest
    master_sync: float = 0.0  # the synchronous line passes through this master position ...
    slave_sync: float = 0.0  # ... and this slave position
    motion: Motion = var.part(Motion)  # the slave's own, and the one of TIME_BASED
    time_based: TimeBasedSync = var.part(TimeBasedSync)
    candidate: TimeBasedSync = var.part(TimeBasedSync)  # the target as the master moves now
    compared_at: float = 0.0  # when candidate and time_based were compared last, since the step's beginning
    profile: Profile = var.part(Profile)  # of PROFILE; in PARKED and UNCOUPLED_HALT the halt, over time
    per_nominal_velocity: float = 1.0  # reciprocal of the profile's nominal master velocity
    per_travel: float = 0.0  # reciprocal of the profile's master travel
    halt_time: float = 0.0  # from the halt's beginning to the step's; a halt is too short for this sum to need a Clock
    plan: ProfilePlan = var.part(ProfilePlan)  # the last one made
    planned_exceeded: ExceededLimit = var.part(ExceededLimit)  # by the motion under way, as it was planned
    present_exceeded: ExceededLimit = var.part(ExceededLimit)  # by the setpoint

    def initialize(self) -> Refusal:
        """Set the axis to rest or to its initial velocity; may be called again while parameters still change."""
        if self.axis.min_position > self.axis.max_position:
            return Refusal.END_POSITIONS
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.motion.start(self.axis.initial_position, self.axis.initial_velocity, 0.0)
        take_execute_levels(self)
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.planned_exceeded.clear()
        self.present_exceeded.clear()
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the path of the step."""
        before = self.slave.position
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        for section in range(self.master.path.sections):
            self.follow_section(section)
            if section == 0:
                self.obey()
        self.motion.advance(h)
        self.halt_time += h
        self.set_slave_at(0.0, self.master.end, self.master.end_velocity, self.master.end_acceleration)
        self.check_limits(before, h)
        self.show()
        self.rebase()
        return Refusal.NONE

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands that have an edge in this step, the most urgent one first."""
        if self.locked and not self.stop.execute and not self.slave.is_moving():
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
            self.new_request.read(self.gear_in_velo, self.axis, self.sync_mode, self.cosine)
            self.command_gear_in(self.gear_in_velo, Owner.GEAR_IN_VELO)
        if self.gear_in_pos.edge.try_rise(self.gear_in_pos.execute):
            self.new_request.read(self.gear_in_pos, self.axis, self.sync_mode, self.cosine)
            self.new_request.set_sync_positions(
                unwrap_sync_position(self.master, self.gear_in_pos.master_sync_position),
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
        self.motion_request.read_halt(command, self.axis)
        fault = Fault.LOCKED if self.locked and owner != Owner.STOP else self.motion_request.find_halt_fault()
        if self.try_accept(command, owner, fault):
            self.motion_request.plan_halt(self.motion, self.slave, self.axis)
            self.enter_discrete_motion()
            self.locked = owner == Owner.STOP

    def command_move_velocity(self) -> None:
        self.motion_request.read_move_velocity(self.move_velocity, self.axis)
        fault = Fault.LOCKED if self.locked else self.motion_request.find_move_velocity_fault(self.axis)
        if self.try_accept(self.move_velocity, Owner.MOVE_VELOCITY, fault):
            self.motion_request.plan_move_velocity(self.motion, self.slave, self.axis)
            self.enter_continuous_motion()

    def command_move_absolute(self) -> None:
        self.motion_request.read_move_absolute(self.move_absolute, self.axis)
        fault = Fault.LOCKED if self.locked else self.motion_request.find_move_absolute_fault(self.axis)
        if self.try_accept(self.move_absolute, Owner.MOVE_ABSOLUTE, fault):
            self.motion_request.plan_move_absolute(self.motion, self.slave, self.axis)
            self.enter_discrete_motion()

    def command_gear_out(self) -> None:
        self.gear_out.conclude(Fault.LOCKED if self.locked else Fault.NONE)
        self.error_id = Fault.LOCKED if self.locked else Fault.NONE
        if not self.locked and self.is_coupled():
            report_phase(self, self.owner, Phase.ABORTED)
            self.owner = Owner.NOBODY
            self.set_slave_at_begin()
            self.run_on()

    def command_gear_in(self, command: GearInVelo, owner: Owner) -> None:
        """gear_in_velo or gear_in_pos, at once, or when the master passes the start ahead."""
        master_position = self.master.begin
        request = self.new_request
        self.set_plan_start(request, 0.0, master_position, self.master.begin_velocity, self.master.begin_acceleration)
        direction = 1.0 if self.master.begin_velocity > 0.0 else -1.0
        start = request.master_sync - direction * request.start_distance
        later = request.start_distance > 0.0 and (master_position - start) * direction < 0.0
        fault = Fault.LOCKED if self.locked else request.find_fault()
        if fault == Fault.NONE:
            fault = self.plan.try_prepare_to_position(request) if later else self.try_plan(request)
        if self.try_accept(command, owner, fault):
            self.waiting = later
            if later:
                var.copy(self.pending_request, request)
                self.start_position = start
                self.start_direction = direction
            else:
                var.copy(self.active_request, request)
                self.couple(0.0, master_position)

    def try_accept(self, command: Command, owner: Owner, fault: Fault) -> bool:
        """Refuse a command for a fault; without one it replaces the owner's, which is aborted.

        An accepted command finds in `slave` the slave's state at the step's beginning."""
        if fault != Fault.NONE:
            command.refuse(fault)
            self.error_id = fault
            return False
        self.set_slave_at_begin()
        report_phase(self, self.owner, Phase.ABORTED)
        command.accept()
        self.owner = owner
        self.error_id = Fault.NONE
        return True

    def fail_owner(self, fault: Fault) -> None:
        """A gear-in command that was accepted before cannot go on."""
        if self.owner == Owner.GEAR_IN_VELO:
            self.gear_in_velo.fail(fault)
        else:
            self.gear_in_pos.fail(fault)
        self.owner = Owner.NOBODY
        self.error_id = fault

    def report_sync(self, phase: Phase) -> None:
        """Report the phase of the owner's gear-in. While a command waits, the former coupling ends without a report."""
        if not self.waiting:
            report_phase(self, self.owner, phase)

    def is_coupled(self) -> bool:
        """Whether a gear-in command moves the slave or waits to do so."""
        return self.waiting or self.stage not in (Stage.CONTINUOUS_MOTION, Stage.DISCRETE_MOTION, Stage.UNCOUPLED_HALT)

    # --- coupling ---

    def set_plan_start(
        self, request: GearInRequest, time: float, master_position: float, velocity: float, acceleration: float
    ) -> None:
        """Set the states from which the request is planned: the master's as given, but for what an encoder makes of its
        acceleration; the slave's as it then is."""
        self.set_slave_at(time, master_position, velocity, acceleration)
        counted = acceleration if request.mode.time_based else coupling_acceleration(self.master, acceleration)
        self.plan.master.set(master_position, velocity, counted)
        self.plan.slave.set(self.slave.position, self.slave.velocity, self.slave.acceleration)

    def try_plan(self, request: GearInRequest) -> Fault:
        """Plan from the states set before, and show what the plan asks of the slave, refused or not."""
        fault = self.plan.try_request(request)
        if self.plan.checked:
            self.local.show_plan(self.plan.extremes)
        return fault

    def couple(self, time: float, master_position: float) -> None:
        """Start the plan made for this instant, s since the step's beginning."""
        self.characteristics.show(self.plan, self.master.period)
        self.coupling_position = master_position
        self.master.watch_travel()
        self.local.coupling_position = wrap(master_position, self.master.period)
        nominal = self.plan.master.velocity
        self.direction = 1.0 if nominal > 0.0 else -1.0 if nominal < 0.0 else 0.0
        self.master_sync = self.plan.master_end
        self.slave_sync = self.plan.slave_end
        if self.plan.in_sync:
            self.enter_in_sync()
        elif self.active_request.mode.time_based:
            self.enter_time_based(time)
        else:
            self.enter_profile()

    def try_start_pending(self) -> bool:
        """The master passes the start, if the section is divided there: plan the waiting command from the present
        state.

        If that is refused, a motion of the slave's own goes on, and a coupled slave runs on at its velocity."""
        path = self.master.path
        if not self.waiting or path.end == path.positions[path.section + 1]:
            return False
        time = path.until
        path.enter(path.section)
        path.reached = self.start_position
        request = self.pending_request
        velocity = self.master.velocity_at(time)
        self.set_plan_start(request, time, self.start_position, velocity, self.master.end_acceleration)
        self.waiting = False
        fault = self.try_plan(request)
        if fault == Fault.NONE:
            var.copy(self.active_request, request)
            self.couple(time, self.start_position)
        else:
            self.fail_owner(fault)
            if self.is_coupled():
                self.run_on()
                self.motion.clock.start(time)
        return True

    def couple_again(self, time: float) -> None:
        """The master passes the coupling position forwards again: plan anew from the present state."""
        request = self.active_request
        velocity = self.master.velocity_at(time)
        self.set_plan_start(request, time, self.coupling_position, velocity, self.master.end_acceleration)
        fault = self.try_plan(request)
        if fault == Fault.NONE:
            self.couple(time, self.coupling_position)
        else:
            self.fail_owner(fault)
            self.enter_uncoupled_halt()

    def run_on(self) -> None:
        """Uncouple: the slave runs on from the state in `slave`, without acceleration."""
        self.motion_request.start.set(self.slave.position, self.slave.velocity, 0.0)
        self.motion.start(self.slave.position, self.slave.velocity, 0.0)
        self.enter_continuous_motion()

    def update_time_based(self, time: float) -> None:
        """Plan the time-based motion anew at that time if the master does not do what was expected."""
        self.compared_at = time
        self.candidate.set_target(self.active_request, self.master.velocity_at(time), self.master.mean_acceleration())
        if not self.candidate.continues(self.active_request, self.time_based, self.motion.clock.time + time):
            self.set_slave_at(time, self.coupling_position, 0.0, 0.0)
            if self.motion.is_over(time):
                self.planned_exceeded.clear()
            var.copy(self.time_based, self.candidate)
            self.plan_time_based(time)

    def plan_time_based(self, time: float) -> None:
        """Plan the motion to the time-based target from the state in `slave`, which belongs to that time."""
        self.time_based.plan(self.active_request, self.motion, self.slave)
        self.motion.clock.start(time)

    # --- entering a stage ---

    def enter_continuous_motion(self) -> None:
        """The motion just planned drives the slave; it goes on for ever."""
        self.waiting = False
        self.check_motion()
        self.stage = Stage.CONTINUOUS_MOTION

    def enter_discrete_motion(self) -> None:
        """The motion just planned drives the slave; it ends at rest."""
        self.waiting = False
        self.check_motion()
        self.stage = Stage.DISCRETE_MOTION

    def enter_uncoupled_halt(self) -> None:
        """The halt of PARKED goes on, or the rest after it, but the axis is uncoupled."""
        self.stage = Stage.UNCOUPLED_HALT

    def check_motion(self) -> None:
        """Check the motion just planned, and what it starts from, until it is at its velocity or at rest."""
        if self.plan.try_measure_motion(self.motion):
            self.plan.extremes.check_limits(self.axis, self.planned_exceeded)
        else:
            self.planned_exceeded.clear()
        self.planned_exceeded.include(self.motion_request.start.exceeded)

    def enter_profile(self) -> None:
        """Start the planned profile at the coupling position."""
        self.plan.extremes.check_limits(self.axis, self.planned_exceeded)
        var.copy(self.profile, self.plan.profile)
        self.per_nominal_velocity = clamp(
            1.0 / self.plan.master.velocity, -1.0 / SMALLEST_DIVISOR, 1.0 / SMALLEST_DIVISOR
        )
        self.per_travel = 1.0 / max(abs(self.master_sync - self.coupling_position), SMALLEST_DIVISOR)
        self.stage = Stage.PROFILE

    def enter_time_based(self, time: float) -> None:
        """Start the motion in time from the state in `slave`, s since the step's beginning."""
        if self.plan.profile.segments > 0:
            self.plan.extremes.check_limits(self.axis, self.planned_exceeded)
        else:
            self.planned_exceeded.clear()
        self.compared_at = time
        self.time_based.set_target(self.active_request, self.master.velocity_at(time), self.master.mean_acceleration())
        self.plan_time_based(time)
        self.stage = Stage.TIME_BASED

    def enter_in_sync(self) -> None:
        """The slave is on the synchronous line through master_sync and slave_sync."""
        self.planned_exceeded.clear()
        self.stage = Stage.IN_SYNC
        self.report_sync(Phase.REACHED)

    def enter_parked(self) -> None:
        """The master passes the coupling position backwards: to rest at once, or along the ramp of gear_in_velo."""
        position = self.parking_position()
        time = self.master.path.crossing_time(position)
        self.set_slave_at(time, position, self.master.velocity_at(time), self.master.end_acceleration)
        self.profile.start(ProfileKind.NONE, self.slave.position)
        self.planned_exceeded.clear()
        request = self.active_request
        speed = abs(self.slave.velocity)
        if speed > NO_HALT * request.velocity:
            if request.mode.instant_stop_on_rollback:
                self.planned_exceeded.set(Limit.INSTANT_STOP, speed)
            else:
                along = -self.slave.acceleration if self.slave.velocity > 0.0 else self.slave.acceleration
                duration = ramp_duration(speed, along, request.deceleration, request.checked_jerk())
                add_ramp_from_acceleration(self.profile, duration, self.slave.velocity, self.slave.acceleration, 0.0)
                self.plan.extremes.measure(self.profile)
                self.plan.extremes.check_limits(self.axis, self.planned_exceeded)
        self.halt_time = -time
        self.master.path.reached = position
        self.stage = Stage.PARKED
        self.report_sync(Phase.BUSY)

    # --- the path of the step ---

    def follow_section(self, section: int) -> None:
        """Follow a section of the master's path, which is divided where a waiting command starts.

        Section 0, the input correction, takes no time, so no event that depends on time occurs there."""
        path = self.master.path
        path.enter(section)
        if self.waiting and (path.end - self.start_position) * self.start_direction > 0.0:
            path.end_at(self.start_position)
        for _ in range(MOST_EVENTS):
            if not (self.try_event() or self.try_start_pending()):
                break

    def try_event(self) -> bool:
        """Carry out the next event of the stage on what is left of the section; False: there is none."""
        match self.stage:
            case Stage.CONTINUOUS_MOTION | Stage.DISCRETE_MOTION:
                return self.try_event_own_motion()
            case Stage.PROFILE:
                return self.try_event_profile()
            case Stage.TIME_BASED:
                return self.try_event_time_based()
            case Stage.IN_SYNC:
                return self.try_event_in_sync()
            case Stage.PARKED:
                return self.try_event_parked()
            case _:  # UNCOUPLED_HALT ends by a command only
                return False

    def try_event_own_motion(self) -> bool:
        """The motion is at its velocity, or has ended, and the owner's command with it."""
        path = self.master.path
        if path.is_correction() or not self.motion.is_over(path.until):
            return False
        if self.stage == Stage.CONTINUOUS_MOTION:
            if self.owner != Owner.MOVE_VELOCITY or self.move_velocity.phase != Phase.BUSY:
                return False
            self.move_velocity.report(Phase.REACHED)
            return True
        if self.owner not in (Owner.HALT, Owner.STOP, Owner.MOVE_ABSOLUTE):
            return False
        report_phase(self, self.owner, Phase.REACHED)
        if self.owner == Owner.STOP:
            self.locked = self.stop.execute
        self.owner = Owner.NOBODY
        return True

    def try_event_profile(self) -> bool:
        """The profile ends at the sync position; a master that turns back may leave it at the coupling position."""
        path = self.master.path
        distance = abs(self.master_sync - self.coupling_position)
        if (path.end - self.master_sync) * self.direction >= -PROFILE_END * distance:
            path.reached = self.master_sync
            self.enter_in_sync()
            return True
        if self.is_behind_coupling(path.end):
            self.enter_parked()
            return True
        return False

    def try_event_time_based(self) -> bool:
        """The motion in time goes on up to the section's end, or until a master that turns back passes the coupling
        position, if sync_mode says that the slave rests then. Section 0 shows how the master moves now."""
        path = self.master.path
        mode = self.active_request.mode
        parks = (mode.rollback_lock or mode.instant_stop_on_rollback) and self.is_behind_coupling(path.end)
        if path.is_correction() and not parks:
            self.update_time_based(0.0)
        last = path.crossing_time(self.parking_position()) if parks else path.until
        if not path.is_correction() and self.try_meet_target(last):
            return True
        if parks:
            self.enter_parked()
        return parks

    def try_meet_target(self, last: float) -> bool:
        """Up to the time `last` the velocities meet, or the target reaches its limit or leaves it."""
        meeting = min(self.motion.time_left(), last)
        over = self.motion.is_over(last)
        meets = over and self.time_based.reachable and not self.time_based.at_limit
        limit = self.time_based.time_to_limit(
            self.active_request, self.master.velocity_at(self.compared_at), self.master.mean_acceleration()
        )
        if limit >= 0.0:
            limit += self.compared_at
        if meets and not 0.0 <= limit < meeting:
            self.set_slave_at(meeting, self.coupling_position, 0.0, 0.0)
            self.slave_sync = self.slave.position
            self.master_sync = self.master.path.position(meeting)
            self.master.path.reached = self.master_sync
            self.enter_in_sync()
            return True
        if 0.0 <= limit <= last:
            self.update_time_based(limit)
            return True
        return False

    def try_event_in_sync(self) -> bool:
        """The backstop parks the slave where the master passes the coupling position backwards.

        A coupling to a master at rest takes its direction from the master's first motion, which is no event."""
        end = self.master.path.end
        if self.direction == 0.0:
            if abs(end - self.coupling_position) > SAME_PLACE * (abs(end) + abs(self.coupling_position)):
                self.direction = 1.0 if end > self.coupling_position else -1.0
            return False
        passed = self.is_behind_coupling(end) and not self.is_behind_coupling(self.master.path.reached)
        if self.active_request.mode.rollback_lock and passed:
            self.enter_parked()
            return True
        return False

    def try_event_parked(self) -> bool:
        """The master passes the coupling position forwards; a waiting command keeps the slave parked."""
        path = self.master.path
        is_against = self.master.goes_against(self.direction)
        if self.waiting or is_against or self.distance_beyond_coupling(path.end) <= 0.0:
            return False
        path.reached = self.coupling_position
        self.couple_again(path.crossing_time(self.coupling_position))
        return True

    def parking_position(self) -> float:
        """The master's position behind which it has passed the coupling position backwards, u."""
        return self.coupling_position - self.direction * self.master.uncertain_travel()

    def is_behind_coupling(self, position: float) -> bool:
        """Whether a master at that position has passed the coupling position backwards."""
        return self.distance_beyond_coupling(position) < -self.master.uncertain_travel()

    def distance_beyond_coupling(self, position: float) -> float:
        """The distance of a position from the coupling position, in the coupling's direction, u; 0 within rounding."""
        distance = (position - self.coupling_position) * self.direction
        return distance if abs(distance) > SAME_PLACE * (abs(position) + abs(self.coupling_position)) else 0.0

    # --- the slave at an instant ---

    def set_slave_at(self, time: float, master_position: float, velocity: float, acceleration: float) -> None:
        """Set `slave` to its state at a time, s since the step's beginning, when the master moves as given.

        The last state set in a step is the output."""
        match self.stage:
            case Stage.IN_SYNC:
                k = self.active_request.factor
                position = self.slave_sync + k * (master_position - self.master_sync)
                self.slave.set(position, k * velocity, k * acceleration, 0.0)
            case Stage.PROFILE:
                distance = master_position - self.coupling_position
                per_velocity = self.per_nominal_velocity
                is_measured = self.master.is_measured()
                position, v, a, j = self.profile.follow(distance, velocity, acceleration, per_velocity, is_measured)
                self.slave.set(position, v, a, j)
            case Stage.PARKED | Stage.UNCOUPLED_HALT:
                position, v, a, j = self.profile.at_or_at_rest(self.halt_time + time)
                self.slave.set(position, v, a, j)
            case _:
                position, v, a, j = self.motion.at(time)
                self.slave.set(position, v, a, j)

    def set_slave_at_begin(self) -> None:
        """Set `slave` to its state at the step's beginning, where the commands act."""
        self.set_slave_at(0.0, self.master.begin, self.master.begin_velocity, self.master.begin_acceleration)

    # --- the limits of the axis ---

    def is_planned_motion_over(self) -> bool:
        """Whether the motion under way has reached the end of its plan, after the step's time."""
        match self.stage:
            case Stage.CONTINUOUS_MOTION | Stage.DISCRETE_MOTION | Stage.TIME_BASED:
                return self.motion.is_over(0.0)
            case Stage.PARKED | Stage.UNCOUPLED_HALT:
                return self.profile.segments > 0 and self.halt_time >= self.profile.duration()
            case _:
                return False

    def check_limits(self, before: float, h: float) -> None:
        """Find the limit of the axis that the setpoint exceeds, or the way to it from the one `before`, of h seconds;
        what the plan exceeds ends with the planned motion."""
        if self.planned_exceeded.limit != Limit.NONE and self.is_planned_motion_over():
            self.planned_exceeded.clear()
        self.present_exceeded.check_setpoint(self.axis, self.slave)
        self.present_exceeded.check_way(self.axis, self.slave, before, 0.0, h, self.master)

    # --- the outputs ---

    def show(self) -> None:
        """Derive the outputs at the end of a step."""
        self.coupled = self.is_coupled()
        self.in_sync = self.stage == Stage.IN_SYNC and not self.waiting
        factor = self.pending_request.factor if self.waiting else self.active_request.factor
        self.coupling_factor = factor if self.coupled else 0.0
        self.error = self.error_id != Fault.NONE
        show_state(self, self.stage, self.waiting)
        show_plcopen_state(self, self.stage, self.locked)
        show_function_blocks(self)
        self.show_progress()
        show_limits(self, self.planned_exceeded, self.present_exceeded)

    def show_progress(self) -> None:
        """Show the progress of the synchronisation at constant master velocity; it stays when uncoupled."""
        missing = 0.0
        if self.stage == Stage.PROFILE and not self.waiting:
            missing = max((self.master_sync - self.master.end) * self.direction, 0.0)
            self.local.progress = clamp(1.0 - missing * self.per_travel, 0.0, 1.0)
        elif self.in_sync:
            self.local.progress = 1.0
        elif self.coupled:
            self.local.progress = 0.0
        self.local.master_distance_to_sync = missing

    def rebase(self) -> None:
        """Drop the master's whole turns while no position belongs to a particular turn."""
        if not self.coupled:
            self.master.rebase()
