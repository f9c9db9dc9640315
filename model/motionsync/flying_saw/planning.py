"""From an order and the state of both axes to a profile that keeps what the order asks for, or to a fault.

Source: TS5055, sections 3 to 7 and 13.
"""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..laws import Quintic
from ..limits import SHORTEST, computable
from ..motion import Motion, acceleration_limit
from .checks import TOLERANCE, violated_dynamics, violated_position, violated_velocity
from .constant_velocity import ConstantVelocity
from .extremes import Extremes
from .faults import Fault
from .order import Order
from .profile import Profile, ProfileKind
from .segments import (
    add_ramp_from_acceleration,
    plan_one_ramp,
    plan_two_ramps,
    ramp_duration,
    same_peak_durations,
)

NO_ACCELERATION = 1e-9  # of the velocity: an acceleration that changes it by less until the end does not count
SAME_VELOCITY = 1e-12  # of the greater: velocities that differ by less are in sync at once
LARGEST = 1e100  # s, u/s2 and u/s3: beyond it a number comes from a distance or a velocity lost to rounding


@dataclass(slots=True)
class AxisState:
    """An axis at an instant: u, u/s, u/s2."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def put(self, position: float, velocity: float, acceleration: float) -> None:
        """Set the state, as far as it can be computed with: an axis of almost no velocity stands."""
        self.position = position
        self.velocity = computable(velocity)
        self.acceleration = computable(acceleration)

    def is_standing(self) -> bool:
        return self.velocity == 0.0 and self.acceleration == 0.0


@dataclass(slots=True)
class Plan:
    """A synchronisation from the states `master` and `slave`, which are set before.

    Attributes:
        profile: the one found.
        at_once: both are in sync already, and no profile is needed.
        judged: there is a profile, and the checks have looked at its extremes.
        extremes: of the profile, for the checks.
        master_end, end: where master and slave are at the profile's end, u.
        synchronous: the slave's velocity at its end, u/s.
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
    end: float = 0.0
    at_once: bool = False
    judged: bool = False
    synchronous: float = 0.0
    acceleration: float = 0.0

    def try_order(self, order: Order) -> Fault:
        """Plan what the order asks for; the fault if that is refused."""
        self.judged = False
        return self.try_to_position(order) if order.to_position else self.try_to_velocity(order)

    def try_measure_motion(self, motion: Motion) -> bool:
        """Measure a motion in time up to its last piece, in place of the last plan; whether there is anything to."""
        self.profile.begin(ProfileKind.JERK_LIMITED, motion.positions[0])
        self.profile.add_motion(motion)
        if self.profile.pieces == 0:
            return False
        self.extremes.measure(self.profile)
        return True

    # --- gear_in_velo ---

    def try_to_velocity(self, order: Order) -> Fault:
        """Plan a ramp to the synchronous velocity, wherever that is reached."""
        standing = self.slave.is_standing()
        self.prepare(order)
        if self.is_too_fast(order):
            return Fault.LIMIT
        if self.master.velocity == 0.0 and not standing:
            return Fault.SLAVE_MOVING
        self.profile.begin(ProfileKind.NONE, self.slave.position)
        self.master_end = self.master.position
        self.end = self.slave.position
        velocity = self.slave.velocity
        change = self.synchronous - velocity
        greater = max(abs(self.synchronous), abs(velocity))
        self.at_once = self.master.velocity == 0.0 or abs(change) <= SAME_VELOCITY * greater
        if order.mode.time_based and self.master.velocity != 0.0:
            return self.try_in_time(order)
        if self.at_once:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.synchronous, order.acceleration, order.deceleration)
        along = self.acceleration if change > 0.0 else -self.acceleration
        duration = ramp_duration(abs(change), along, limit, order.checked_jerk())
        if not self.is_computable(duration):
            return Fault.NOT_AHEAD
        self.profile.begin(ProfileKind.P5, self.slave.position)
        add_ramp_from_acceleration(self.profile, duration, velocity, self.acceleration, self.synchronous)
        return self.try_free_end(order)

    def try_in_time(self, order: Order) -> Fault:
        """Plan the time-optimal change of velocity; the checks see it as if the master had no acceleration."""
        self.acceleration = self.slave.acceleration
        velocity = self.slave.velocity
        lacking = abs(self.slave.acceleration - order.factor * self.master.acceleration)
        self.at_once = self.at_once and lacking <= SAME_VELOCITY * min(order.acceleration, order.deceleration)
        if self.at_once:
            return Fault.NONE
        self.profile.begin(ProfileKind.JERK_LIMITED, self.slave.position)
        if self.slave.acceleration == 0.0 and velocity == self.synchronous:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.synchronous, order.acceleration, order.deceleration)
        self.nominal.try_change(
            self.slave.position, velocity, self.slave.acceleration, self.synchronous, 0.0, -limit, limit, order.jerk
        )
        self.profile.add_motion(self.nominal)
        return self.try_free_end(order)

    def try_free_end(self, order: Order) -> Fault:
        """Check a profile whose end positions follow from it."""
        self.master_end = self.master.position + self.master.velocity * self.profile.duration()
        self.end = self.slave.position + self.profile.distance()
        self.extremes.measure(self.profile)
        return self.try_checks(order)

    # --- gear_in_pos ---

    def try_to_position(self, order: Order) -> Fault:
        """Plan a profile that takes the slave to its sync position just when the master is at its own."""
        fault = self.try_prepare_to_position(order)
        if fault != Fault.NONE:
            return fault
        toward = 1.0 if order.factor * self.master.velocity > 0.0 else -1.0
        distance = order.slave_sync - self.slave.position
        duration = (order.master_sync - self.master.position) / self.master.velocity
        if distance * toward <= 0.0 or not self.is_computable(duration):
            return Fault.NOT_AHEAD
        self.master_end = order.master_sync
        self.end = order.slave_sync
        return self.try_profiles(order, duration, distance)

    def try_prepare_to_position(self, order: Order) -> Fault:
        """Prepare a gear_in_pos; the fault that refuses it whatever the slave does, known at its edge already."""
        self.prepare(order)
        self.at_once = False
        if self.is_too_fast(order):
            return Fault.LIMIT
        if order.mode.time_based:
            return Fault.TIME_BASED
        if self.master.velocity == 0.0:
            return Fault.MASTER_STANDING
        ahead = (order.master_sync - self.master.position) * self.master.velocity
        return Fault.NONE if ahead > 0.0 and order.start_distance >= 0.0 else Fault.NOT_AHEAD

    def try_profiles(self, order: Order, duration: float, distance: float) -> Fault:
        """Try the profiles in the order of preference; the one that remains is judged by all checks."""
        velocity = self.slave.velocity
        end = self.synchronous
        if self.is_unaccelerated(duration):
            self.acceleration = 0.0
            if order.mode.prefer_constant_velocity and self.try_constant_velocity(order, duration, distance):
                self.extremes.measure(self.profile)
                if self.try_checks(order) == Fault.NONE:
                    return Fault.NONE
            mean = distance / duration
            between = min(velocity, end) < mean < max(velocity, end)
            if between and (order.mode.check_overshoot_velocity or order.mode.check_undershoot_velocity):
                plan_one_ramp(self.profile, self.slave.position, duration, distance, velocity, end)
                if self.try_dynamics(order):
                    return self.try_checks(order)
            self.plan_quintic(duration, distance)
            if order.mode.check_max_velocity and self.try_velocity_limit(order, duration, distance):
                if self.try_dynamics(order):
                    return self.try_checks(order)
                self.plan_quintic(duration, distance)
        else:
            self.plan_quintic(duration, distance)
        return self.try_checks(order)

    def is_unaccelerated(self, duration: float) -> bool:
        """Whether both axes count as free of acceleration; an acceleration that the order ignores is 0 already."""
        master = abs(self.master.acceleration) * duration <= NO_ACCELERATION * abs(self.master.velocity)
        speed = max(abs(self.slave.velocity), abs(self.synchronous))
        return master and abs(self.slave.acceleration) * duration <= NO_ACCELERATION * speed

    def plan_quintic(self, duration: float, distance: float) -> None:
        """P5: one polynomial of order 5, measured."""
        self.profile.begin(ProfileKind.P5, self.slave.position)
        self.quintic.fit(duration, 0.0, self.slave.velocity, self.acceleration, distance, self.synchronous, 0.0)
        self.profile.add_quintic(self.quintic)
        self.extremes.measure(self.profile)

    def try_constant_velocity(self, order: Order, duration: float, distance: float) -> bool:
        """Plan P5+P1+P5 with ramps as short as the limits allow; whether there is such a profile."""
        self.constant.duration = duration
        self.constant.distance = distance
        self.constant.velocity = self.slave.velocity
        self.constant.end = self.synchronous
        self.constant.acceleration = order.acceleration
        self.constant.deceleration = order.deceleration
        self.constant.jerk = order.checked_jerk()
        if not self.constant.try_solve():
            return False
        plan_two_ramps(
            self.profile,
            self.slave.position,
            duration,
            self.slave.velocity,
            self.constant.cruise,
            self.synchronous,
            self.constant.rise,
            self.constant.fall,
        )
        return True

    def try_velocity_limit(self, order: Order, duration: float, distance: float) -> bool:
        """Plan P5+P1+P5 at the velocity limit that P5, measured just before, exceeds; whether there is such a profile.

        False too if P5 keeps the limit."""
        limit = order.velocity + TOLERANCE * max(self.extremes.velocity_max, -self.extremes.velocity_min)
        if self.extremes.velocity_max > limit:
            cruise = order.velocity
        elif self.extremes.velocity_min < -limit:
            cruise = -order.velocity
        else:
            return False
        rise, fall = same_peak_durations(duration, distance, self.slave.velocity, cruise, self.synchronous)
        if rise + fall <= 0.0:
            return False
        plan_two_ramps(
            self.profile, self.slave.position, duration, self.slave.velocity, cruise, self.synchronous, rise, fall
        )
        return True

    # --- what both share ---

    def prepare(self, order: Order) -> None:
        """Make the accelerations 0 that the order ignores; then find the profile's own acceleration at its start."""
        if order.mode.ignore_master_acceleration and not order.mode.time_based:
            self.master.acceleration = 0.0
        if order.mode.ignore_slave_acceleration and not order.mode.time_based:
            self.slave.acceleration = 0.0
        self.synchronous = order.factor * self.master.velocity
        self.acceleration = self.slave.acceleration
        if self.master.velocity != 0.0:
            self.acceleration -= self.slave.velocity / self.master.velocity * self.master.acceleration

    def is_too_fast(self, order: Order) -> bool:
        """Whether the synchronous velocity is beyond its limit, where that is checked or needed."""
        limited = order.mode.check_max_velocity or (order.mode.time_based and not order.to_position)
        return limited and abs(self.synchronous) > order.velocity * (1.0 + TOLERANCE)

    def is_computable(self, duration: float) -> bool:
        """Whether the duration and the rates that it requires are well above rounding error."""
        if not SHORTEST <= duration < LARGEST:
            return False
        speed = abs(self.slave.velocity) + abs(self.synchronous)
        steepest = speed / duration + abs(self.acceleration)
        return isfinite(steepest) and steepest / duration < LARGEST

    def try_checks(self, order: Order) -> Fault:
        """Check the measured profile; the fault in the detail that the order asks for."""
        fault = self.violated(order)
        self.judged = True
        if fault == Fault.NONE or order.mode.detailed_error_codes:
            return fault
        return Fault.CHECK

    def violated(self, order: Order) -> Fault:
        """The first violated check of those that the order asks for."""
        fault = violated_position(self.extremes, order, self.slave.position, self.end)
        if fault == Fault.NONE:
            fault = violated_velocity(self.extremes, order, self.slave.velocity, self.synchronous, self.master.velocity)
        return fault if fault != Fault.NONE else violated_dynamics(self.extremes, order)

    def try_dynamics(self, order: Order) -> bool:
        """Measure the profile; whether acceleration, deceleration and jerk keep the limits that are checked."""
        self.extremes.measure(self.profile)
        return violated_dynamics(self.extremes, order) == Fault.NONE
