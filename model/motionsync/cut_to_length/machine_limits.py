"""What a machine can do, at a line velocity and for a pitch of the cuts, computed before any cut.

A cycle leads from the start of one approach to the earliest start of the next: approach, cut, way home, rest at home.
Below, v is the line's velocity, k the coupling, V = k v the carriage's velocity in sync, D the way of the approach.
All functions are finite for limits and inputs from 1e-12 to 1e12.
"""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..numerics.bracket import ITERATIONS, Bracket

LEAST = 1e-100  # a line velocity below it counts as this one, a pitch below it as none: no quotient overflows
CONVERGED = 1e-8  # of the peak of a return: after a step of Newton's method up to here, rounding is all that is left


@dataclass(slots=True)
class Machine:
    """What a cycle is computed from: the block's parameters, with the limits that are in use: none is 0.

    The parameters of axis, approach, homing, tool and gap are described where they are declared (`interface.py`).

    Attributes:
        coupling: k, carriage velocity per line velocity in sync.
        home_position: h, where the carriage waits, u.
        by_distance: the cut lasts for the carriage's travel cut_distance, u; else for the time cut_time, s.
    """

    coupling: float = 1.0
    home_position: float = 0.0
    min_position: float = -1e9
    max_position: float = 1e9
    max_velocity: float = 2000.0
    max_acceleration: float = 10000.0
    max_deceleration: float = 10000.0
    approach_distance: float = 0.0
    approach_reserve: float = 0.02
    approach_acceleration: float = 10000.0
    approach_jerk: float = 100000.0
    homing_velocity: float = 2000.0
    homing_acceleration: float = 10000.0
    homing_deceleration: float = 10000.0
    homing_jerk: float = 100000.0
    homing_settle_time: float = 0.0
    by_distance: bool = False
    cut_time: float = 0.25
    cut_distance: float = 100.0
    settle_time: float = 0.0
    on_delay: float = 0.0
    retract_time: float = 0.0
    gap_distance: float = 0.0
    gap_travel: float = 100.0


def change_time(speed: float, acceleration: float, jerk: float) -> float:
    """R: least time, in s, in which a velocity changes by `speed`, from and to states without acceleration.

    The acceleration is a trapezium of height a: x/a + a/j; where x < a2/j it is a triangle of height sqrt(x j)."""
    if speed >= acceleration * acceleration / jerk:
        return speed / acceleration + acceleration / jerk
    return 2.0 * sqrt(max(speed, 0.0) / jerk)


def lead(machine: Machine, velocity: float) -> float:
    """The shortest way of an approach, in u, that keeps its limits at the line velocity v, in u/s.

    The ramp over the master has the peak acceleration 0.75 V2/D and the peak jerk 1.5 V3/D2; each gives a least D."""
    v = machine.coupling * max(velocity, 0.0)
    by_acceleration = 0.75 * v * v / machine.approach_acceleration
    by_jerk = v * sqrt(1.5 * v / machine.approach_jerk)
    return max(by_acceleration, by_jerk)


def approach_distance(machine: Machine, velocity: float) -> float:
    """D: the way of the approach, in u: that of a line which is faster by the reserve, or the least one that is set."""
    return max(machine.approach_distance, lead(machine, velocity * (1.0 + machine.approach_reserve)))


def tool_time(machine: Machine, carriage: float, approach: float) -> float:
    """t_s: the time in sync, in s, without that of the gap: settling, cut, retracting. The carriage has the velocity
    V > 0 in sync, and its approach takes so long, in s.

    A delay of the tool that is longer than the approach keeps the carriage waiting in sync."""
    cut = machine.cut_distance / carriage if machine.by_distance else machine.cut_time
    return max(machine.settle_time, machine.on_delay - approach, 0.0) + cut + machine.retract_time


def gap_time(machine: Machine, carriage: float) -> float:
    """The time in which the gap is opened at the carriage's velocity V > 0, in s: gap_travel/V, or 0 without a gap."""
    return machine.gap_travel / carriage if machine.gap_distance > 0.0 else 0.0


def way_out(machine: Machine, velocity: float) -> tuple[float, float, float]:
    """S, D and t_s: the way from home, in u, at which the carriage starts to return, which is made of approach, time in
    sync and gap; the way of the approach, in u; the time in sync without that of the gap, in s. For v <= 0 the carriage
    returns from the end of the approach."""
    distance = approach_distance(machine, velocity)
    if velocity <= 0.0:
        return distance, distance, 0.0
    carriage = machine.coupling * max(velocity, LEAST)
    time = tool_time(machine, carriage, 2.0 * distance / carriage)
    gap_way = machine.gap_travel + machine.gap_distance if machine.gap_distance > 0.0 else 0.0
    return distance + gap_way + machine.coupling * velocity * time, distance, time


def change(speed: float, acceleration: float, jerk: float, ramp: float) -> tuple[float, float]:
    """R and dR/dx, in s and s2/u: `change_time`, and how it rises with the speed > 0; `ramp` is a/j, in s."""
    if speed >= acceleration * ramp:
        return speed / acceleration + ramp, 1.0 / acceleration
    root = sqrt(speed / jerk)
    return 2.0 * root, root / speed


def return_way(velocity: float, peak: float, turn: float, stop: float) -> float:
    """G(w): the way back, in u, of a return from the velocity V to -w, the peak, and to rest, which take these times.

    Each change of velocity is symmetric in time: it covers its mean velocity times its time. G rises and is convex."""
    return 0.5 * (peak - velocity) * turn + 0.5 * peak * stop


def return_time(machine: Machine, velocity: float, distance: float, up: float) -> float:
    """T_r: time-optimal way home, in s, over `distance` >= 0, from the velocity V >= 0 that leads away from home.

    `up` limits the acceleration while the carriage reverses and speeds up. Where the peak G(speed) leaves a rest of the
    way, it is covered at the speed of homing."""
    speed = machine.homing_velocity
    turn = change_time(velocity + speed, up, machine.homing_jerk)
    stop = change_time(speed, machine.homing_deceleration, machine.homing_jerk)
    cruise = distance - return_way(velocity, speed, turn, stop)
    if cruise < 0.0:
        return short_return_time(machine, velocity, distance, up)
    return turn + stop + cruise / speed


def short_return_time(machine: Machine, velocity: float, distance: float, up: float) -> float:
    """T_r where the way is too short for the speed of homing. Its peak is the w with G(w) = distance.

    Newton's method: G is convex and rises, so the first step leads beyond the solution, if not to it, and no later one
    passes it. It starts at the solution for changes of velocity that reach their acceleration, R(x) = x/a + a/j: there
    G(w) - distance = (A w2 + B w - C)/2. Each step doubles the digits. After a small one the times are those at its
    begin, changed by their rates."""
    down = machine.homing_deceleration
    jerk = machine.homing_jerk
    turn_ramp = up / jerk
    stop_ramp = down / jerk
    ramps = turn_ramp + stop_ramp  # B
    rest = 2.0 * distance + velocity * (velocity / up + turn_ramp)  # C
    peak = 2.0 * rest / (ramps + sqrt(ramps * ramps + 4.0 * (1.0 / up + 1.0 / down) * rest))
    turn = 0.0
    stop = 0.0
    for _ in range(ITERATIONS):
        if peak <= 0.0:
            break
        turn, turn_rate = change(velocity + peak, up, jerk, turn_ramp)
        stop, stop_rate = change(peak, down, jerk, stop_ramp)
        beyond = return_way(velocity, peak, turn, stop) - distance
        step = 2.0 * beyond / (turn + (peak - velocity) * turn_rate + stop + peak * stop_rate)
        if abs(step) <= CONVERGED * peak:
            return turn + stop - (turn_rate + stop_rate) * step
        peak = min(peak - step, machine.homing_velocity)
    return turn + stop


def turning_acceleration(machine: Machine) -> float:
    """The limit while the carriage reverses: it brakes and accelerates in one, with the smaller of both limits."""
    return min(machine.homing_acceleration, machine.homing_deceleration)


def overshoot(machine: Machine, carriage: float) -> float:
    """The way in which the carriage stops, in u, from its velocity V >= 0 in sync."""
    return 0.5 * carriage * change_time(carriage, turning_acceleration(machine), machine.homing_jerk)


def cycle(machine: Machine, velocity: float) -> tuple[float, float, float]:
    """T_c, D and the stroke: `cycle_time`, `approach_distance` and `stroke` at a line velocity v > 0."""
    carriage = machine.coupling * velocity
    travel, distance, tool = way_out(machine, velocity)
    home = return_time(machine, carriage, travel, turning_acceleration(machine))
    sync = tool + gap_time(machine, carriage)
    time = 2.0 * distance / carriage + sync + home + machine.homing_settle_time
    return time, distance, travel + overshoot(machine, carriage)


def cycle_time(machine: Machine, velocity: float) -> float:
    """T_c: the shortest time from start to start, in s, at the line velocity v; 0 for v <= 0."""
    if velocity <= 0.0:
        return 0.0
    time, _, _ = cycle(machine, max(velocity, LEAST))
    return time


def shortest_pitch(machine: Machine, velocity: float) -> float:
    """p_min: the shortest distance of two cuts, in u of the master, at the line velocity v; 0 for v <= 0."""
    return max(velocity, 0.0) * cycle_time(machine, velocity)


def stroke(machine: Machine, velocity: float) -> float:
    """The farthest that a cycle takes the carriage from home, in u: S, and the way in which it stops."""
    travel, _, _ = way_out(machine, velocity)
    return travel + overshoot(machine, machine.coupling * max(velocity, 0.0))


def is_admissible(machine: Machine, velocity: float) -> bool:
    """Whether the carriage is fast enough for the line velocity v, and its way from home long enough."""
    if machine.coupling * velocity > machine.max_velocity:
        return False
    return machine.home_position + stroke(machine, velocity) <= machine.max_position


def excess(machine: Machine, velocity: float, pitch: float) -> float:
    """By what share the line velocity v asks too much of stroke or pitch; at most 0 where neither. Rises with v."""
    time, _, way = cycle(machine, velocity)
    end = machine.home_position + way - machine.max_position
    of_stroke = end / max(machine.max_position - machine.home_position, LEAST)
    return max(of_stroke, (velocity * time - pitch) / pitch)


@dataclass(slots=True)
class CycleLimit:
    """The greatest admissible line velocity at which cuts of a pitch are reached.

    Attributes:
        max_line_velocity: u/s of the master; 0: there is none.
    """

    max_line_velocity: float = 0.0
    bracket: Bracket = var.part(Bracket)

    def solve(self, machine: Machine, pitch: float) -> None:
        """Find it for that pitch, in u.

        Stroke and shortest pitch rise with v, so what is admissible is one interval. It is searched from the velocity
        of the carriage's limit downwards."""
        self.max_line_velocity = 0.0
        if pitch < LEAST:
            return
        high = machine.max_velocity / machine.coupling
        if machine.coupling * high > machine.max_velocity:
            high *= 1.0 - 2.3e-16
        above = excess(machine, high, pitch)
        if above <= 0.0:
            self.max_line_velocity = high
            return
        low = 0.25 * high
        below = excess(machine, low, pitch)
        if below > 0.0:
            high = low
            above = below
            low = LEAST
            below = excess(machine, low, pitch)
        if below <= 0.0:
            self.bracket.set(low, below, high, above)
            while self.bracket.try_narrow():
                value = excess(machine, self.bracket.place, pitch)
                self.bracket.replace(value, value > 0.0)
            self.max_line_velocity = self.bracket.low
