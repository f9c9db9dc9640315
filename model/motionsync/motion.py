"""The slave's own motion: jerk-limited changes of velocity and moves to a position, planned from any state of motion.

A motion is a chain of pieces of constant jerk. What is planned at once may last for hours: the state at any time comes
from the piece it lies in, so it does not depend on the step size.

Source: universal flying saw (TS5055), whose axis moves with limits of velocity, acceleration, deceleration and jerk;
PLCopen's move_velocity, move_absolute and halt.
"""

from dataclasses import dataclass
from math import sqrt

from . import var
from .clock import Clock
from .limits import clamp

SAME_TIME = 1.0 - 1e-13  # of a time: it is reached, but for rounding
BISECTIONS = 200  # enough to halve any piece down to neighbouring numbers but for roots below 1e-40 of it


@dataclass(slots=True)
class Motion:
    """A motion in time of piecewise constant jerk; its last piece goes on for ever.

    Piece i, 0 <= i < pieces, begins at the time begins[i] (s, since the motion began) in the state positions[i],
    velocities[i], accelerations[i] (u, u/s, u/s2) and has the jerk jerks[i] (u/s3). `clock` tells the time since
    the motion began.

    All limits are greater than 0. Nothing overflows for numbers within 1e12 and limits from 1e-12 on.
    """

    pieces: int = 1
    begins: list[float] = var.ring(9)
    positions: list[float] = var.ring(9)
    velocities: list[float] = var.ring(9)
    accelerations: list[float] = var.ring(9)
    jerks: list[float] = var.ring(9)
    clock: Clock = var.part(Clock)

    def run(self, position: float, velocity: float) -> None:
        """Constant velocity (u/s) for ever; 0 is standstill."""
        self.begin(position, velocity, 0.0)

    def change(
        self,
        position: float,
        velocity: float,
        acceleration: float,
        target: float,
        slope: float,
        low: float,
        high: float,
        jerk: float,
    ) -> bool:
        """The time-optimal change of velocity to target + slope t (u/s, u/s2), where it stays, with low <= a <= high.

        An acceleration outside the limits is first brought to the nearer one. False: the target runs away, since its
        slope lies outside the limits, or on the one that is needed to catch up; then the acceleration goes to that
        limit and stays there for ever.
        """
        self.begin(position, velocity, acceleration)
        return self.approach(target, slope, low, high, jerk)

    def halt(self, position: float, velocity: float, acceleration: float, down: float, jerk: float) -> None:
        """The time-optimal stop with the deceleration `down`."""
        self.change(position, velocity, acceleration, 0.0, 0.0, -down, down, jerk)

    def move(
        self,
        position: float,
        velocity: float,
        acceleration: float,
        target: float,
        speed: float,
        up: float,
        down: float,
        jerk: float,
    ) -> None:
        """From any state to rest at `target`, u; |v| <= speed, |a| <= `up` away from standstill and `down` towards it.

        The ramp to the cruise velocity on that side of the stop where the target lies, then the cruise, both ended by
        the stop that leads to the target. The end position rises with the time tau at which the stop begins (where the
        ramp turns round more gently than the stop would, it falls first and then rises): tau is closed form in the
        cruise and bisected to rounding on the ramp. With equal limits this is time-optimal.

        Positions count from the start until all is planned, so that a short way far out loses nothing.
        """
        way = target - position
        self.begin(0.0, velocity, acceleration)
        side = 1.0 if way >= stopping_distance(velocity, acceleration, down, jerk) else -1.0
        limit = acceleration_limit(velocity, side * speed, up, down)
        self.approach(side * speed, 0.0, -limit, limit, jerk)
        passed = 1
        while passed < self.pieces and side * (self.stop_at(passed, 0.0, down, jerk) - way) <= 0.0:
            passed += 1
        last = passed - 1
        if passed < self.pieces:
            self.cut(last, self.stop_begin(last, side, way, down, jerk))
        else:
            self.cut(last, max(side * (way - self.stop_at(last, 0.0, down, jerk)), 0.0) / speed)
        self.approach(0.0, 0.0, -down, down, jerk)
        for i in range(self.pieces):
            self.positions[i] += position
        self.positions[self.pieces - 1] = target

    def brake(self, position: float, velocity: float, deceleration: float) -> None:
        """The stop with constant deceleration, without a limit of jerk; the velocity is not 0."""
        self.begin(position, velocity, -deceleration if velocity > 0.0 else deceleration)
        self.extend(abs(velocity) / deceleration, 0.0, 0.0)
        self.velocities[self.pieces - 1] = 0.0

    def end(self) -> float:
        """The time at which the last piece begins."""
        return self.begins[self.pieces - 1]

    def over(self, time: float) -> bool:
        """Whether the last piece has begun, but for rounding of the time."""
        return time >= self.end() * SAME_TIME

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk at a time >= 0; where two pieces meet, those of the later one."""
        i = 0
        while i + 1 < self.pieces and self.begins[i + 1] * SAME_TIME <= time:
            i += 1
        return self.state(i, time - self.begins[i])

    def advance(self, h: float) -> None:
        """The clock goes on by h."""
        self.clock.advance(h)

    def state(self, piece: int, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk at a time since the beginning of that piece."""
        acceleration = self.accelerations[piece]
        jerk = self.jerks[piece]
        position, velocity = moved(self.positions[piece], self.velocities[piece], acceleration, jerk, time)
        return position, velocity, acceleration + time * jerk, jerk

    def begin(self, position: float, velocity: float, acceleration: float) -> None:
        """A motion of one piece, which has no jerk."""
        self.pieces = 1
        self.begins[0] = 0.0
        self.positions[0] = position
        self.velocities[0] = velocity
        self.accelerations[0] = acceleration
        self.jerks[0] = 0.0
        self.clock.start(0.0)

    def extend(self, time: float, jerk: float, acceleration: float) -> None:
        """The last piece gets this jerk for that time and ends with `acceleration`; there a new one begins.

        A piece too short to be told from its own beginning is passed over, but for what it does to the state."""
        if time <= 0.0:
            return
        last = self.pieces - 1
        self.jerks[last] = jerk
        position, velocity, _, _ = self.state(last, time)
        begin = self.begins[last] + time
        if begin > self.begins[last]:
            last = self.pieces
            self.pieces += 1
        self.begins[last] = begin
        self.positions[last] = position
        self.velocities[last] = velocity
        self.accelerations[last] = acceleration
        self.jerks[last] = 0.0

    def cut(self, piece: int, time: float) -> None:
        """That piece ends at a time since its beginning; there a new last one begins."""
        self.pieces = piece + 1
        _, _, acceleration, jerk = self.state(piece, time)
        self.jerks[piece] = 0.0  # should the time be 0
        self.extend(time, jerk, acceleration)

    def approach(self, target: float, slope: float, low: float, high: float, jerk: float) -> bool:
        """`change` from the state in which the last piece begins; the target is reckoned from the motion's beginning.

        What has to vanish is w = v - c(t) and its derivative b = a - slope, with the limits shifted by the slope."""
        if not low <= slope <= high:
            self.hold(low if slope < low else high, jerk)
            return False
        self.hold(clamp(self.accelerations[self.pieces - 1], low, high), jerk)
        last = self.pieces - 1
        b = self.accelerations[last] - slope
        side, way = turn(self.velocities[last] - (target + slope * self.begins[last]), b, jerk)
        limit = high - slope if side > 0.0 else slope - low
        if limit == 0.0 and way > 0.0:
            self.hold(high if side > 0.0 else low, jerk)
            return False
        rise, steady, fall, peak = ramp(way, side * b, limit, jerk)
        top = clamp(slope + side * peak, low, high)
        self.extend(rise, side * jerk, top)
        self.extend(steady, 0.0, top)
        self.extend(fall, -side * jerk, slope)
        last = self.pieces - 1
        self.velocities[last] = target + slope * self.begins[last]
        self.accelerations[last] = slope
        return True

    def hold(self, acceleration: float, jerk: float) -> None:
        """The acceleration goes to a value and stays there."""
        missing = acceleration - self.accelerations[self.pieces - 1]
        self.extend(abs(missing) / jerk, jerk if missing > 0.0 else -jerk, acceleration)

    def stop_begin(self, piece: int, side: float, way: float, down: float, jerk: float) -> float:
        """The time since that piece's beginning at which the stop must begin to end at `way`, bisected to rounding."""
        first = 0.0
        last = self.begins[piece + 1] - self.begins[piece]
        for _ in range(BISECTIONS):
            middle = 0.5 * (first + last)
            if middle <= first or middle >= last:
                break
            if side * (self.stop_at(piece, middle, down, jerk) - way) <= 0.0:
                first = middle
            else:
                last = middle
        return first

    def stop_at(self, piece: int, time: float, down: float, jerk: float) -> float:
        """Where the stop ends that begins at a time since that piece's beginning."""
        position, velocity, acceleration, _ = self.state(piece, time)
        return position + stopping_distance(velocity, acceleration, down, jerk)


def acceleration_limit(velocity: float, target: float, acceleration: float, deceleration: float) -> float:
    """The limit of |a| in a change of velocity: of the acceleration away from 0, of the deceleration towards it, the
    lower one through it; u/s2."""
    if velocity < 0.0 < target or target < 0.0 < velocity:
        return min(acceleration, deceleration)
    return acceleration if abs(target) > abs(velocity) else deceleration


def stopping_distance(velocity: float, acceleration: float, down: float, jerk: float) -> float:
    """The way of the time-optimal stop, `Motion.halt`, u; its sign tells the direction."""
    bounded = clamp(acceleration, -down, down)
    back = jerk if bounded > acceleration else -jerk
    x, v = moved(0.0, velocity, acceleration, back, abs(bounded - acceleration) / jerk)
    side, way = turn(v, bounded, jerk)
    rise, steady, fall, peak = ramp(way, side * bounded, down, jerk)
    x, v = moved(x, v, bounded, side * jerk, rise)
    x, v = moved(x, v, side * peak, 0.0, steady)
    x, v = moved(x, v, side * peak, -side * jerk, fall)
    return x


def turn(velocity: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """To which side the acceleration has to be turned so that velocity and acceleration vanish together, 1 or -1, and
    how much velocity (>= 0, u/s) is lacking there once the acceleration is brought to 0 directly: v + a |a| / (2 j).

    Where nothing is lacking, the way to 0."""
    rest = velocity + 0.5 * acceleration * abs(acceleration) / jerk
    towards = rest if rest != 0.0 else acceleration
    return (-1.0 if towards > 0.0 else 1.0), abs(rest)


def ramp(way: float, acceleration: float, limit: float, jerk: float) -> tuple[float, float, float, float]:
    """How long, s, the acceleration rises with the jerk, stays, and falls to 0, and its peak, u/s2.

    In mirrored coordinates: `way` >= 0 is the velocity lacking after `turn`, and acceleration <= limit. With
    a+ = max(a, 0) the two triangles give peak^2 = a+^2 + j way, cut off at the limit."""
    ahead = max(acceleration, 0.0)
    peak = sqrt(ahead * ahead + jerk * way)
    if peak > limit:
        steady = (way - (limit - ahead) * (limit + ahead) / jerk) / limit
        return (limit - acceleration) / jerk, max(steady, 0.0), limit / jerk, limit
    rise = way / (peak + ahead) if ahead > 0.0 else (peak - acceleration) / jerk
    return rise, 0.0, peak / jerk, peak


def moved(position: float, velocity: float, acceleration: float, jerk: float, time: float) -> tuple[float, float]:
    """Position and velocity after a time of constant jerk."""
    return (
        position + time * (velocity + time * (0.5 * acceleration + time * (jerk / 6.0))),
        velocity + time * (acceleration + time * (0.5 * jerk)),
    )
