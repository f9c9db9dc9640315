"""From an order and the state of both axes to a profile that keeps its conditions, or to the reason why there is none.

Source: TS5055, sections 3 to 7 and 13.
"""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..laws import Quintic
from ..motion import Motion, acceleration_limit
from .checks import TOLERANCE, broken_position, broken_steepness, broken_velocity
from .constant_velocity import ConstantVelocity
from .extremes import Extremes
from .faults import Fault
from .order import Order
from .profile import Profile, ProfileKind
from .shapes import at_velocity, begin_first, ramp_duration, ramp_from, same_peak

FREE = 1e-9  # a velocity's share: an acceleration that changes it by less until the end does not count
EQUAL = 1e-12  # of the greater: velocities that differ by less are in sync at once
MOST = 1e100  # u/s3 and less: what is beyond it comes from a way or time that is lost to rounding


@dataclass(slots=True)
class State:
    """An axis at an instant: u, u/s, u/s2."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def put(self, position: float, velocity: float, acceleration: float) -> None:
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration

    def stands(self) -> bool:
        return self.velocity == 0.0 and self.acceleration == 0.0


@dataclass(slots=True)
class Plan:
    """A synchronisation from the states `master` and `slave`, which are set before.

    Attributes:
        profile: the one found.
        at_once: there is nothing to do for being in sync.
        judged: there is a profile, and the checks have looked at its extremes.
        extremes: of the profile, for the checks.
        master_end, end: where master and slave are at the profile's end, u.
        synchronous: the slave's velocity at its end, u/s.
        acceleration: the slave's own at constant master velocity, a0 - v0 a_m / v_m, u/s2.
    """

    master: State = var.part(State)
    slave: State = var.part(State)
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

    def make(self, order: Order) -> Fault:
        self.judged = False
        return self.meet(order) if order.to_position else self.join(order)

    # --- gear_in_velo ---

    def join(self, order: Order) -> Fault:
        """To the synchronous velocity, wherever that is reached."""
        stands = self.slave.stands()
        self.prepare(order)
        if self.too_fast(order):
            return Fault.LIMIT
        if self.master.velocity == 0.0 and not stands:
            return Fault.SLAVE_MOVING
        self.profile.begin(ProfileKind.NONE, self.slave.position)
        self.master_end = self.master.position
        self.end = self.slave.position
        velocity = self.slave.velocity
        change = self.synchronous - velocity
        self.at_once = self.master.velocity == 0.0 or abs(change) <= EQUAL * max(abs(self.synchronous), abs(velocity))
        if order.mode.time_based and self.master.velocity != 0.0:
            return self.join_in_time(order)
        if self.at_once:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.synchronous, order.acceleration, order.deceleration)
        along = self.acceleration if change > 0.0 else -self.acceleration
        duration = ramp_duration(abs(change), along, limit, order.checked_jerk())
        if not self.sound(duration):
            return Fault.NOT_AHEAD
        self.profile.begin(ProfileKind.P5, self.slave.position)
        ramp_from(self.profile, duration, velocity, self.acceleration, self.synchronous)
        return self.measured(order)

    def join_in_time(self, order: Order) -> Fault:
        """The time-optimal ramp in the velocity that is lacking; the checks take the master as unaccelerated."""
        self.acceleration = self.slave.acceleration
        velocity = self.slave.velocity
        lacking = abs(self.slave.acceleration - order.factor * self.master.acceleration)
        self.at_once = self.at_once and lacking <= EQUAL * min(order.acceleration, order.deceleration)
        if self.at_once:
            return Fault.NONE
        self.profile.begin(ProfileKind.JERK_LIMITED, self.slave.position)
        if self.slave.acceleration == 0.0 and velocity == self.synchronous:
            return Fault.NONE
        limit = acceleration_limit(velocity, self.synchronous, order.acceleration, order.deceleration)
        self.nominal.change(
            self.slave.position, velocity, self.slave.acceleration, self.synchronous, 0.0, -limit, limit, order.jerk
        )
        for i in range(self.nominal.pieces - 1):
            t = self.nominal.begins[i + 1] - self.nominal.begins[i]
            self.profile.add(
                t,
                self.nominal.positions[i] - self.slave.position,
                self.nominal.velocities[i] * t,
                0.5 * self.nominal.accelerations[i] * t * t,
                self.nominal.jerks[i] * t * t * t / 6.0,
                0.0,
                0.0,
            )
        return self.measured(order)

    def measured(self, order: Order) -> Fault:
        """The checks of a profile that ends where it ends."""
        self.master_end = self.master.position + self.master.velocity * self.profile.duration()
        self.end = self.slave.position + self.profile.way()
        self.extremes.measure(self.profile)
        return self.verdict(order)

    # --- gear_in_pos ---

    def meet(self, order: Order) -> Fault:
        """To the slave's sync position just where the master is at its own."""
        fault = self.hindrance(order)
        if fault != Fault.NONE:
            return fault
        toward = 1.0 if order.factor * self.master.velocity > 0.0 else -1.0
        way = order.slave_sync - self.slave.position
        duration = (order.master_sync - self.master.position) / self.master.velocity
        if way * toward <= 0.0 or not self.sound(duration):
            return Fault.NOT_AHEAD
        self.master_end = order.master_sync
        self.end = order.slave_sync
        return self.choose(order, duration, way)

    def hindrance(self, order: Order) -> Fault:
        """What stands against a gear_in_pos whatever the slave does, known at its edge already."""
        self.prepare(order)
        self.at_once = False
        if self.too_fast(order):
            return Fault.LIMIT
        if order.mode.time_based:
            return Fault.TIME_BASED
        if self.master.velocity == 0.0:
            return Fault.MASTER_STANDING
        ahead = (order.master_sync - self.master.position) * self.master.velocity
        return Fault.NONE if ahead > 0.0 and order.start_distance >= 0.0 else Fault.NOT_AHEAD

    def choose(self, order: Order, duration: float, way: float) -> Fault:
        """The profiles in the order of preference; the last one is judged by all checks."""
        velocity = self.slave.velocity
        end = self.synchronous
        if self.free(duration):
            self.acceleration = 0.0
            if order.mode.prefer_constant_velocity and self.at_constant_velocity(order, duration, way):
                self.extremes.measure(self.profile)
                if self.verdict(order) == Fault.NONE:
                    return Fault.NONE
            mean = way / duration
            between = min(velocity, end) < mean < max(velocity, end)
            if between and (order.mode.check_overshoot_velocity or order.mode.check_undershoot_velocity):
                begin_first(self.profile, self.slave.position, duration, way, velocity, end)
                if self.driveable(order):
                    return self.verdict(order)
            self.single(duration, way)
            if order.mode.check_max_velocity and self.at_velocity_limit(order, duration, way):
                if self.driveable(order):
                    return self.verdict(order)
                self.single(duration, way)
        else:
            self.single(duration, way)
        return self.verdict(order)

    def free(self, duration: float) -> bool:
        """Whether both axes count as free of acceleration; what the order ignores is 0 here already."""
        master = abs(self.master.acceleration) * duration <= FREE * abs(self.master.velocity)
        speed = max(abs(self.slave.velocity), abs(self.synchronous))
        return master and abs(self.slave.acceleration) * duration <= FREE * speed

    def single(self, duration: float, way: float) -> None:
        """P5."""
        self.profile.begin(ProfileKind.P5, self.slave.position)
        self.quintic.fit(duration, 0.0, self.slave.velocity, self.acceleration, way, self.synchronous, 0.0)
        self.profile.whole(self.quintic)
        self.extremes.measure(self.profile)

    def at_constant_velocity(self, order: Order, duration: float, way: float) -> bool:
        """P5+P1+P5 with ramps as steep as allowed; whether there is one."""
        self.constant.duration = duration
        self.constant.way = way
        self.constant.velocity = self.slave.velocity
        self.constant.end = self.synchronous
        self.constant.acceleration = order.acceleration
        self.constant.deceleration = order.deceleration
        self.constant.jerk = order.checked_jerk()
        if not self.constant.solve():
            return False
        at_velocity(
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

    def at_velocity_limit(self, order: Order, duration: float, way: float) -> bool:
        """P5+P1+P5 at the velocity limit that P5, measured just now, breaks; whether there is one."""
        limit = order.velocity + TOLERANCE * max(self.extremes.velocity_max, -self.extremes.velocity_min)
        if self.extremes.velocity_max > limit:
            cruise = order.velocity
        elif self.extremes.velocity_min < -limit:
            cruise = -order.velocity
        else:
            return False
        rise, fall = same_peak(duration, way, self.slave.velocity, cruise, self.synchronous)
        if rise + fall <= 0.0:
            return False
        at_velocity(
            self.profile, self.slave.position, duration, self.slave.velocity, cruise, self.synchronous, rise, fall
        )
        return True

    # --- what both share ---

    def prepare(self, order: Order) -> None:
        """What the order ignores becomes 0; the profile's own start acceleration follows from the rest."""
        if order.mode.ignore_master_acceleration and not order.mode.time_based:
            self.master.acceleration = 0.0
        if order.mode.ignore_slave_acceleration and not order.mode.time_based:
            self.slave.acceleration = 0.0
        self.synchronous = order.factor * self.master.velocity
        self.acceleration = self.slave.acceleration
        if self.master.velocity != 0.0:
            self.acceleration -= self.slave.velocity / self.master.velocity * self.master.acceleration

    def too_fast(self, order: Order) -> bool:
        """The synchronous velocity is out of the question."""
        limited = order.mode.check_max_velocity or (order.mode.time_based and not order.to_position)
        return limited and abs(self.synchronous) > order.velocity * (1.0 + TOLERANCE)

    def sound(self, duration: float) -> bool:
        """Whether the time, and what has to happen in it, can be told from rounding."""
        if not 0.0 < duration < MOST:
            return False
        speed = abs(self.slave.velocity) + abs(self.synchronous)
        steep = speed / duration + abs(self.acceleration)
        return isfinite(steep) and steep / duration < MOST

    def verdict(self, order: Order) -> Fault:
        """The checks of the measured profile, and the order's kind of answer to a broken one."""
        fault = self.broken(order)
        self.judged = True
        if fault == Fault.NONE or order.mode.detailed_error_codes:
            return fault
        return Fault.CHECK

    def broken(self, order: Order) -> Fault:
        """The first broken check of those that the order asks for."""
        fault = broken_position(self.extremes, order, self.slave.position, self.end)
        if fault == Fault.NONE:
            fault = broken_velocity(self.extremes, order, self.slave.velocity, self.synchronous, self.master.velocity)
        return fault if fault != Fault.NONE else broken_steepness(self.extremes, order)

    def driveable(self, order: Order) -> bool:
        """Measure the profile; whether acceleration, deceleration and jerk keep the limits that are checked."""
        self.extremes.measure(self.profile)
        return broken_steepness(self.extremes, order) == Fault.NONE
