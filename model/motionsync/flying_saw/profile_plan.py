"""Plans a gear-in request from the states of both axes: a profile that keeps the limits, or a fault.

Source: TS5055, sections 3 to 7 and 13.
"""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..motion.jerk_limited import Motion, acceleration_limit
from ..motion.laws import Quintic
from ..numerics.computable_range import SHORTEST_TIME, to_computable_rate
from .checks import TOLERANCE, find_dynamics_fault, find_position_fault, find_velocity_fault
from .constant_velocity import ConstantVelocity
from .extremes import Extremes
from .faults import Fault
from .gear_in_request import GearInRequest
from .profile import Profile, ProfileKind
from .segments import (
    add_constant_velocity,
    add_ramp,
    add_ramp_from_acceleration,
    plan_one_ramp,
    ramp_duration,
    same_peak_durations,
)

NO_ACCELERATION = 1e-9  # of the velocity: an acceleration that changes it by less until the end does not count
SAME_VELOCITY = 1e-12  # of the greater: velocities that differ by less are the same one but for rounding
LARGEST_QUANTITY = 1e100  # s, u/s2 and u/s3: beyond it a number comes from a distance or a velocity lost to rounding


@dataclass(slots=True)
class AxisState:
    """An axis at an instant: u, u/s, u/s2."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def set(self, position: float, velocity: float, acceleration: float) -> None:
        """Set the state, as far as it can be computed with: a tiny velocity is taken as 0."""
        self.position = position
        self.velocity = to_computable_rate(velocity)
        self.acceleration = to_computable_rate(acceleration)

    def is_at_rest(self) -> bool:
        return self.velocity == 0.0 and self.acceleration == 0.0


@dataclass(slots=True)
class ProfilePlan:
    """A synchronisation from the states `master` and `slave`, which are set before.

    Attributes:
        profile: the result.
        in_sync: both are in sync already, and no profile is needed.
        checked: there is a profile, and the checks have been applied to its extremes.
        extremes: of the profile, for the checks.
        master_end, slave_end: where master and slave are at the profile's end, u.
        end_velocity: the slave's velocity at its end, u/s.
        acceleration: the slave's own at constant master velocity, a0 - v0 a_m / v_m, u/s2.
    """

    master: AxisState = var.part(AxisState)
    slave: AxisState = var.part(AxisState)
    profile: Profile = var.part(Profile)
    extremes: Extremes = var.part(Extremes)
    nominal: Motion = var.part(Motion)
    constant: ConstantVelocity = var.part(ConstantVelocity)
    quintic: Quintic = var.part(Quintic)
    master_end: float = 0.0
    slave_end: float = 0.0
    in_sync: bool = False
    checked: bool = False
    end_velocity: float = 0.0
    acceleration: float = 0.0

    def try_request(self, request: GearInRequest) -> Fault:
        """Plan the request; the fault if it is refused."""
        self.checked = False
        return self.try_to_position(request) if request.to_position else self.try_to_velocity(request)

    def try_measure_motion(self, motion: Motion) -> bool:
        """Measure a motion in time up to its last segment, in place of the last plan; False if it has no other."""
        self.profile.start(ProfileKind.JERK_LIMITED, motion.positions[0])
        self.profile.add_motion(motion)
        if self.profile.segments == 0:
            return False
        self.extremes.measure(self.profile)
        return True

    # --- gear_in_velo ---

    def try_to_velocity(self, request: GearInRequest) -> Fault:
        """Plan a ramp to the synchronous velocity, wherever that is reached."""
        at_rest = self.slave.is_at_rest()
        self.prepare(request)
        if self.is_too_fast(request):
            return Fault.LIMIT
        if self.master.velocity == 0.0 and not at_rest:
            return Fault.SLAVE_MOVING
        self.profile.start(ProfileKind.NONE, self.slave.position)
        self.master_end = self.master.position
        self.slave_end = self.slave.position
        velocity = self.slave.velocity
        change = self.end_velocity - velocity
        greater = max(abs(self.end_velocity), abs(velocity))
        self.in_sync = self.master.velocity == 0.0 or abs(change) <= SAME_VELOCITY * greater
        if request.mode.time_based and self.master.velocity != 0.0:
            return self.try_in_time(request)
        if self.in_sync:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.end_velocity, request.acceleration, request.deceleration)
        along = self.acceleration if change > 0.0 else -self.acceleration
        duration = ramp_duration(abs(change), along, limit, request.checked_jerk())
        if not self.is_computable(duration):
            return Fault.NOT_AHEAD
        self.profile.start(ProfileKind.P5, self.slave.position)
        add_ramp_from_acceleration(self.profile, duration, velocity, self.acceleration, self.end_velocity)
        return self.try_check_free_end(request)

    def try_in_time(self, request: GearInRequest) -> Fault:
        """Plan the time-optimal change of velocity; the checks see it as if the master had no acceleration."""
        self.acceleration = self.slave.acceleration
        velocity = self.slave.velocity
        lacking = abs(self.slave.acceleration - request.factor * self.master.acceleration)
        self.in_sync = self.in_sync and lacking <= SAME_VELOCITY * min(request.acceleration, request.deceleration)
        if self.in_sync:
            return Fault.NONE
        self.profile.start(ProfileKind.JERK_LIMITED, self.slave.position)
        if self.slave.acceleration == 0.0 and velocity == self.end_velocity:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.end_velocity, request.acceleration, request.deceleration)
        self.nominal.start(self.slave.position, velocity, self.slave.acceleration)
        self.nominal.try_change(self.end_velocity, 0.0, -limit, limit, request.jerk)
        self.profile.add_motion(self.nominal)
        return self.try_check_free_end(request)

    def try_check_free_end(self, request: GearInRequest) -> Fault:
        """Check a profile whose end positions follow from it."""
        self.master_end = self.master.position + self.master.velocity * self.profile.duration()
        self.slave_end = self.slave.position + self.profile.distance()
        self.extremes.measure(self.profile)
        return self.try_checks(request)

    # --- gear_in_pos ---

    def try_to_position(self, request: GearInRequest) -> Fault:
        """Plan a profile that takes the slave to its sync position just when the master is at its own."""
        fault = self.try_prepare_to_position(request)
        if fault != Fault.NONE:
            return fault
        toward = 1.0 if request.factor * self.master.velocity > 0.0 else -1.0
        distance = request.slave_sync - self.slave.position
        duration = (request.master_sync - self.master.position) / self.master.velocity
        if distance * toward <= 0.0 or not self.is_computable(duration):
            return Fault.NOT_AHEAD
        self.master_end = request.master_sync
        self.slave_end = request.slave_sync
        return self.try_profiles(request, duration, distance)

    def try_prepare_to_position(self, request: GearInRequest) -> Fault:
        """Prepare a gear_in_pos; the fault that it has whatever the slave does, and so already at its edge."""
        self.prepare(request)
        self.in_sync = False
        if self.is_too_fast(request):
            return Fault.LIMIT
        if request.mode.time_based:
            return Fault.TIME_BASED
        if self.master.velocity == 0.0:
            return Fault.MASTER_STANDING
        ahead = (request.master_sync - self.master.position) * self.master.velocity
        return Fault.NONE if ahead > 0.0 and request.start_distance >= 0.0 else Fault.NOT_AHEAD

    def try_profiles(self, request: GearInRequest, duration: float, distance: float) -> Fault:
        """Try the profiles in the sequence of preference; all checks are applied to the one that remains."""
        velocity = self.slave.velocity
        end = self.end_velocity
        if self.is_unaccelerated(duration):
            self.acceleration = 0.0
            if request.mode.prefer_constant_velocity and self.try_constant_velocity(request, duration, distance):
                self.extremes.measure(self.profile)
                if self.try_checks(request) == Fault.NONE:
                    return Fault.NONE
            mean = distance / duration
            same = SAME_VELOCITY * max(abs(velocity), abs(end))
            between = min(velocity, end) + same < mean < max(velocity, end) - same
            if between and (request.mode.check_overshoot_velocity or request.mode.check_undershoot_velocity):
                plan_one_ramp(self.profile, self.slave.position, duration, distance, velocity, end)
                if self.try_keep_dynamics(request):
                    return self.try_checks(request)
            self.plan_quintic(duration, distance)
            if request.mode.check_max_velocity and self.try_velocity_limit(request, duration, distance):
                if self.try_keep_dynamics(request):
                    return self.try_checks(request)
                self.plan_quintic(duration, distance)
        else:
            self.plan_quintic(duration, distance)
        return self.try_checks(request)

    def is_unaccelerated(self, duration: float) -> bool:
        """Whether both axes count as free of acceleration; an acceleration that the request ignores is 0 already."""
        master = abs(self.master.acceleration) * duration <= NO_ACCELERATION * abs(self.master.velocity)
        speed = max(abs(self.slave.velocity), abs(self.end_velocity))
        return master and abs(self.slave.acceleration) * duration <= NO_ACCELERATION * speed

    def plan_quintic(self, duration: float, distance: float) -> None:
        """P5: one polynomial of order 5, measured."""
        self.profile.start(ProfileKind.P5, self.slave.position)
        self.quintic.fit(duration, 0.0, self.slave.velocity, self.acceleration, distance, self.end_velocity, 0.0)
        self.profile.add_quintic(self.quintic)
        self.extremes.measure(self.profile)

    def try_constant_velocity(self, request: GearInRequest, duration: float, distance: float) -> bool:
        """Plan P5+P1+P5 with ramps as short as the limits allow; whether there is such a profile."""
        self.constant.duration = duration
        self.constant.distance = distance
        self.constant.velocity = self.slave.velocity
        self.constant.end = self.end_velocity
        self.constant.acceleration = request.acceleration
        self.constant.deceleration = request.deceleration
        self.constant.jerk = request.checked_jerk()
        if not self.constant.try_solve():
            return False
        self.plan_two_ramps(duration, self.constant.cruise, self.constant.rise, self.constant.fall)
        return True

    def try_velocity_limit(self, request: GearInRequest, duration: float, distance: float) -> bool:
        """Plan P5+P1+P5 at the velocity limit that P5, measured just before, exceeds; whether there is such a profile.

        False too if P5 keeps the limit."""
        limit = request.velocity + TOLERANCE * max(self.extremes.velocity_max, -self.extremes.velocity_min)
        if self.extremes.velocity_max > limit:
            cruise = request.velocity
        elif self.extremes.velocity_min < -limit:
            cruise = -request.velocity
        else:
            return False
        rise, fall = same_peak_durations(duration, distance, self.slave.velocity, cruise, self.end_velocity)
        if rise + fall <= 0.0:
            return False
        self.plan_two_ramps(duration, cruise, rise, fall)
        return True

    def plan_two_ramps(self, duration: float, cruise: float, rise: float, fall: float) -> None:
        """P5+P1+P5: a ramp to the velocity `cruise` in the time `rise`, that velocity, and a ramp to the end's."""
        self.profile.start(ProfileKind.P5_P1_P5, self.slave.position)
        add_ramp(self.profile, rise, self.slave.velocity, cruise)
        add_constant_velocity(self.profile, duration - rise - fall, cruise)
        add_ramp(self.profile, fall, cruise, self.end_velocity)

    # --- what both share ---

    def prepare(self, request: GearInRequest) -> None:
        """Set the accelerations that the request ignores to 0; then compute the profile's own acceleration at its
        start."""
        if request.mode.ignore_master_acceleration and not request.mode.time_based:
            self.master.acceleration = 0.0
        if request.mode.ignore_slave_acceleration and not request.mode.time_based:
            self.slave.acceleration = 0.0
        self.end_velocity = request.factor * self.master.velocity
        self.acceleration = self.slave.acceleration
        if self.master.velocity != 0.0:
            self.acceleration -= self.slave.velocity / self.master.velocity * self.master.acceleration

    def is_too_fast(self, request: GearInRequest) -> bool:
        """Whether the synchronous velocity is beyond its limit, where that is checked or needed."""
        limited = request.mode.check_max_velocity or (request.mode.time_based and not request.to_position)
        return limited and abs(self.end_velocity) > request.velocity * (1.0 + TOLERANCE)

    def is_computable(self, duration: float) -> bool:
        """Whether the duration and the rates that it requires are well above rounding error."""
        if not SHORTEST_TIME <= duration < LARGEST_QUANTITY:
            return False
        speed = abs(self.slave.velocity) + abs(self.end_velocity)
        steepest = speed / duration + abs(self.acceleration)
        return isfinite(steepest) and steepest / duration < LARGEST_QUANTITY

    def try_checks(self, request: GearInRequest) -> Fault:
        """Check the measured profile; the fault in the detail that sync_mode selects."""
        fault = self.find_fault(request)
        self.checked = True
        if fault == Fault.NONE or request.mode.detailed_error_codes:
            return fault
        return Fault.CHECK

    def find_fault(self, request: GearInRequest) -> Fault:
        """The fault of the first violated check."""
        fault = find_position_fault(self.extremes, request, self.slave.position, self.slave_end)
        if fault == Fault.NONE:
            fault = find_velocity_fault(
                self.extremes, request, self.slave.velocity, self.end_velocity, self.master.velocity
            )
        return fault if fault != Fault.NONE else find_dynamics_fault(self.extremes, request)

    def try_keep_dynamics(self, request: GearInRequest) -> bool:
        """Measure the profile; whether acceleration, deceleration and jerk keep the limits that are checked."""
        self.extremes.measure(self.profile)
        return find_dynamics_fault(self.extremes, request) == Fault.NONE
