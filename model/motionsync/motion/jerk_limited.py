"""The slave's own motion in time: jerk-limited changes of velocity and moves to a position, from any state of motion.

A motion is a chain of segments of constant jerk. It is planned once and may then last for hours: the state at any
time is computed from the segment of that time, so it does not depend on the step size.

Source: universal flying saw (TS5055), whose axis moves with limits of velocity, acceleration, deceleration and jerk;
PLCopen's move_velocity, move_absolute and halt.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..clock import SAME_TIME, Clock
from ..numerics.bracket import can_halve, halve, middle
from ..numerics.computable_range import SHORTEST_TIME, clamp, to_computable_rate


@dataclass(slots=True)
class Motion:
    """A motion in time of piecewise constant jerk; its last segment goes on for ever.

    Segment i, 0 <= i < segments, starts at start_times[i] (s, since the motion started) in the state positions[i],
    velocities[i], accelerations[i] (u, u/s, u/s2) and has the jerk jerks[i] (u/s3). `clock.time` is the time since the
    motion began; the times that `at` and `is_over` take count from the beginning of the present step.

    All limits are greater than 0. Nothing overflows for numbers within 1e12 and limits from 1e-12 on.
    """

    segments: int = 1
    start_times: list[float] = var.array(9)
    positions: list[float] = var.array(9)
    velocities: list[float] = var.array(9)
    accelerations: list[float] = var.array(9)
    jerks: list[float] = var.array(9)
    clock: Clock = var.part(Clock)

    def start(self, position: float, velocity: float, acceleration: float) -> None:
        """From this state on (u, u/s, u/s2) without jerk, for ever; velocity and acceleration as far as they can be
        computed with. What follows is planned from here."""
        self.segments = 1
        self.start_times[0] = 0.0
        self.positions[0] = position
        self.velocities[0] = to_computable_rate(velocity)
        self.accelerations[0] = to_computable_rate(acceleration)
        self.jerks[0] = 0.0
        self.clock.start(0.0)

    def halt(self, down: float, jerk: float) -> None:
        """The time-optimal stop; `down` is the limit of |a|."""
        self.try_change(0.0, 0.0, -down, down, jerk)

    def move(self, target: float, speed: float, up: float, down: float, jerk: float) -> None:
        """From any start to rest at `target`, u; |v| <= speed, |a| <= `up` away from standstill and `down` towards it.

        If the motion stopped at once it would end somewhere: the target is on one side of that position. The motion
        ramps to the cruise velocity towards that side, cruises, and then stops, from a time tau on. The later
        the stop starts, the further away it ends. (Where the ramp reverses more gently than the stop would, the end
        first comes nearer.) So tau is closed form in the cruise, and bisected to rounding on the ramp. With equal
        limits the move is time-optimal.

        Positions count from the start of the motion until all is planned, so that a short distance far from 0 loses no
        digits.
        """
        position = self.positions[0]
        distance = target - position
        self.positions[0] = 0.0
        direction = 1.0 if distance >= self.stop_position(0, 0.0, down, jerk) else -1.0
        limit = acceleration_limit(self.velocities[0], direction * speed, up, down)
        self.try_change(direction * speed, 0.0, -limit, limit, jerk)
        passed = 1
        while passed < self.segments and direction * (self.stop_position(passed, 0.0, down, jerk) - distance) <= 0.0:
            passed += 1
        last = passed - 1
        if passed < self.segments:
            self.split_at(last, self.stop_start_time(last, direction, distance, down, jerk))
        else:
            self.split_at(last, max(direction * (distance - self.stop_position(last, 0.0, down, jerk)), 0.0) / speed)
        self.halt(down, jerk)
        for i in range(self.segments):
            self.positions[i] += position
        self.positions[self.segments - 1] = target

    def brake(self, position: float, velocity: float, deceleration: float) -> None:
        """The stop with constant deceleration, without a limit of jerk; the velocity is not 0."""
        self.start(position, velocity, -deceleration if velocity > 0.0 else deceleration)
        self.extend(abs(velocity) / deceleration, 0.0, 0.0)
        self.velocities[self.segments - 1] = 0.0

    def end_time(self) -> float:
        """The time at which the last segment starts."""
        return self.start_times[self.segments - 1]

    def time_left(self) -> float:
        """The time from the beginning of the present step to the start of the last segment; negative: it is past."""
        return self.end_time() - self.clock.time

    def is_over(self, time: float) -> bool:
        """Whether the last segment has started by then, but for rounding of the time."""
        return self.clock.has_reached(self.end_time(), time)

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk; where two segments meet, those of the later one."""
        since_start = self.clock.time + time
        i = 0
        while i + 1 < self.segments and self.start_times[i + 1] * SAME_TIME <= since_start:
            i += 1
        return self.state(i, since_start - self.start_times[i])

    def advance(self, h: float) -> None:
        """Advance the clock by h, s."""
        self.clock.advance(h)

    def state(self, segment: int, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk at a time since the start of that segment."""
        acceleration = self.accelerations[segment]
        jerk = self.jerks[segment]
        position, velocity = advance_state(self.positions[segment], self.velocities[segment], acceleration, jerk, time)
        return position, velocity, acceleration + time * jerk, jerk

    def extend(self, time: float, jerk: float, acceleration: float) -> None:
        """Give the last segment this jerk for that time, at the end of which it has `acceleration`; there a new one
        starts.

        A time that is too short to be computed with, or is lost in rounding beside the piece's beginning, makes no new
        segment, but it changes the state."""
        if time <= 0.0:
            return
        last = self.segments - 1
        self.jerks[last] = jerk
        position, velocity, _, _ = self.state(last, time)
        begin = self.start_times[last] + time
        if begin > self.start_times[last] and time >= SHORTEST_TIME:
            last = self.segments
            self.segments += 1
        self.start_times[last] = begin
        self.positions[last] = position
        self.velocities[last] = velocity
        self.accelerations[last] = acceleration
        self.jerks[last] = 0.0

    def split_at(self, segment: int, time: float) -> None:
        """End that segment at a time since its start; there a new last segment starts."""
        self.segments = segment + 1
        _, _, acceleration, jerk = self.state(segment, time)
        self.jerks[segment] = 0.0  # should the time be 0
        self.extend(time, jerk, acceleration)

    def try_change(self, target: float, drift: float, low: float, high: float, jerk: float) -> bool:
        """From the last segment's start the time-optimal change to the velocity target + drift t (u/s, u/s2), which
        then stays; low <= a <= high, and t counts from the start of the motion.

        An acceleration outside the limits is first brought to the nearer limit. False: the target runs away, because
        its drift is outside the limits, or at the limit that would be needed to catch up. Then the acceleration goes
        to that limit and stays there for ever.

        The velocity relative to the target, w = v - target - drift t, and its derivative, b = a - drift, are brought
        to 0, with the limits shifted by the drift."""
        if not low <= drift <= high:
            self.hold(low if drift < low else high, jerk)
            return False
        self.hold(clamp(self.accelerations[self.segments - 1], low, high), jerk)
        last = self.segments - 1
        b = self.accelerations[last] - drift
        direction, missing = pulse(self.velocities[last] - (target + drift * self.start_times[last]), b, jerk)
        limit = high - drift if direction > 0.0 else drift - low
        if limit == 0.0 and missing > 0.0:
            self.hold(high if direction > 0.0 else low, jerk)
            return False
        rise, steady, fall, peak = ramp(missing, direction * b, limit, jerk)
        top = clamp(drift + direction * peak, low, high)
        self.extend(rise, direction * jerk, top)
        self.extend(steady, 0.0, top)
        self.extend(fall, -direction * jerk, drift)
        last = self.segments - 1
        self.velocities[last] = target + drift * self.start_times[last]
        self.accelerations[last] = drift
        return True

    def hold(self, acceleration: float, jerk: float) -> None:
        """Append segments in which the acceleration goes to a value and stays there."""
        missing = acceleration - self.accelerations[self.segments - 1]
        self.extend(abs(missing) / jerk, jerk if missing > 0.0 else -jerk, acceleration)

    def stop_start_time(self, segment: int, direction: float, distance: float, down: float, jerk: float) -> float:
        """The time since that segment's start at which a stop must start that ends at `distance`; by bisection."""
        first = 0.0
        last = self.start_times[segment + 1] - self.start_times[segment]
        while can_halve(first, last):
            stop = self.stop_position(segment, middle(first, last), down, jerk)
            first, last = halve(first, last, direction * (stop - distance) > 0.0)
        return first

    def stop_position(self, segment: int, time: float, down: float, jerk: float) -> float:
        """Where the stop ends that starts at a time since that segment's start."""
        position, velocity, acceleration, _ = self.state(segment, time)
        return position + stopping_distance(velocity, acceleration, down, jerk)


def acceleration_limit(velocity: float, target: float, acceleration: float, deceleration: float) -> float:
    """The limit of |a| in a change of velocity: of the acceleration away from 0, of the deceleration towards it, the
    lower one through it; u/s2."""
    if velocity < 0.0 < target or target < 0.0 < velocity:
        return min(acceleration, deceleration)
    return acceleration if abs(target) > abs(velocity) else deceleration


def stopping_distance(velocity: float, acceleration: float, down: float, jerk: float) -> float:
    """The distance that the time-optimal stop (`Motion.halt`) takes, u; negative where it goes downwards."""
    bounded = clamp(acceleration, -down, down)
    back = jerk if bounded > acceleration else -jerk
    x, v = advance_state(0.0, velocity, acceleration, back, abs(bounded - acceleration) / jerk)
    direction, missing = pulse(v, bounded, jerk)
    rise, steady, fall, peak = ramp(missing, direction * bounded, down, jerk)
    x, v = advance_state(x, v, bounded, direction * jerk, rise)
    x, v = advance_state(x, v, direction * peak, 0.0, steady)
    x, v = advance_state(x, v, direction * peak, -direction * jerk, fall)
    return x


def pulse(velocity: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """Sign of the jerk pulse that brings velocity and acceleration to 0 at the same instant, and the speed (>= 0, u/s)
    that would be left to remove if the acceleration alone were ramped to 0: |v + a |a| / (2 j)|.

    Where that speed is 0, the sign is the one that ramps the acceleration to 0."""
    rest = velocity + 0.5 * acceleration * abs(acceleration) / jerk
    towards = rest if rest != 0.0 else acceleration
    return (-1.0 if towards > 0.0 else 1.0), abs(rest)


def ramp(missing: float, acceleration: float, limit: float, jerk: float) -> tuple[float, float, float, float]:
    """How long, s, the acceleration rises with the jerk, stays, and falls to 0, and its peak, u/s2.

    All is mirrored so that the pulse is positive: `missing` >= 0 is the speed from `pulse`, and acceleration <= limit.
    With a+ = max(a, 0), the triangles of the rise and the fall give peak^2 = a+^2 + j missing. A higher peak than the
    limit is cut off there."""
    ahead = max(acceleration, 0.0)
    peak = sqrt(ahead * ahead + jerk * missing)
    if peak > limit:
        steady = (missing - (limit - ahead) * (limit + ahead) / jerk) / limit
        return (limit - acceleration) / jerk, max(steady, 0.0), limit / jerk, limit
    rise = missing / (peak + ahead) if ahead > 0.0 else (peak - acceleration) / jerk
    return rise, 0.0, peak / jerk, peak


def advance_state(
    position: float, velocity: float, acceleration: float, jerk: float, time: float
) -> tuple[float, float]:
    """Position and velocity after a time of constant jerk."""
    return (
        position + time * (velocity + time * (0.5 * acceleration + time * (jerk / 6.0))),
        velocity + time * (acceleration + time * (0.5 * jerk)),
    )
