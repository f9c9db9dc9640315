"""The carriage: its curve over the master in the cycle under way, and its motion home."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..master import Master
from ..motion.exceeded_limit import end_tolerance
from ..motion.jerk_limited import stopping_distance
from ..motion.laws import chain_rule
from ..motion.start import MotionStart, attainable_acceleration
from ..numerics.grid import rounding_tolerance
from ..var import Enumeration
from .carriage_curve import CarriageCurve, gap_extremes
from .homing_motion import HomingMotion
from .machine_limits import Machine, approach_distance, turning_acceleration

NEARLY = 1e-9  # of an approach: what is missing to sync is rounding
PUNCTUAL = 1.0 - 1e-12  # of the time that is left: rounding must not make an eased motion home too slow


class Stage(Enumeration):
    """What drives the carriage"""

    RESTING = 0, "nothing: it rests, and the machine does not run"
    HOMING = 1, "its motion home after start"
    WAITING = 2, "nothing: it rests at home until the start point"
    APPROACHING = 3, "the curve into sync"
    SYNCHRONOUS = 4, "the motion in sync with the cut, before the blade cuts"
    CUTTING = 5, "the motion in sync with the cut"
    PULLING = 6, "the curve that gets ahead of the material"
    CLEARING = 7, "what drove it before, until the blade is clear"
    RETURNING = 8, "its motion home"


@dataclass(slots=True)
class Carriage:
    """The carriage with its machine.

    Attributes:
        machine: what it can do with the present settings.
        cycle_machine: the same as it was when this cycle's approach started.
        homing_start: where the motion home started.
        cut: the cut passes carriage position 0 at this position of the master, u.
        cut_begin: how far the master was beyond `cut` when the blade began to cut, u.
        stage_clock: the time since the stage began; at rest, since the arrival.
        is_ready: it has settled at home.
        cut_timeout: the longest cut of the cycle, s; 0: any.
        clearing_time: how long the stage CLEARING lasts, s.
    """

    stage: Stage = Stage.RESTING
    machine: Machine = var.part(Machine)
    cycle_machine: Machine = var.part(Machine)
    curve: CarriageCurve = var.part(CarriageCurve)
    homing: HomingMotion = var.part(HomingMotion)
    homing_start: MotionStart = var.part(MotionStart)
    cut: float = 0.0
    cut_begin: float = 0.0
    stage_clock: Clock = var.part(Clock)
    is_ready: bool = False
    cut_timeout: float = 0.0
    clearing_time: float = 0.0

    def enter_waiting(self) -> None:
        """At home until the start point."""
        self.stage = Stage.WAITING
        self.is_ready = False

    def enter_homing(self, now: float) -> None:
        """From rest to home."""
        self.stage = Stage.HOMING
        self.homing_start.set(self.homing.end, 0.0, 0.0)
        self.homing.plan(self.machine, now, self.homing_start)

    def enter_pulling(self, master: Master) -> None:
        """Ahead of the material, to open the gap."""
        self.stage = Stage.PULLING
        self.curve.plan_gap(
            master.distance_beyond(self.cut, master.path.now),
            self.cycle_machine.gap_distance,
            self.cycle_machine.gap_travel,
        )

    def enter_clearing(self, now: float) -> None:
        """On its curve, until the blade is clear."""
        self.stage = Stage.CLEARING
        self.stage_clock.start(now)
        self.clearing_time = self.cycle_machine.retract_time

    def setpoint_at(self, master: Master, time: float) -> tuple[float, float, float, float]:
        """The setpoint on the curve over the master, at a time since the step's beginning."""
        position, d1, d2, d3 = self.curve.at(master.distance_beyond(self.cut, time))
        velocity, acceleration, jerk = chain_rule(d1, d2, d3, master.velocity_at(time), master.mean_acceleration())
        return position, velocity, acceleration, jerk

    def setpoint_at_end(self, master: Master) -> tuple[float, float, float, float]:
        """The setpoint on the curve over the master, at the end of the step."""
        position, d1, d2, d3 = self.curve.at(master.end - self.cut)
        velocity, acceleration, jerk = chain_rule(d1, d2, d3, master.end_velocity, master.end_acceleration)
        return position, velocity, acceleration, jerk

    def plan_homing(self, master: Master, is_homing: bool) -> None:
        """Plan the motion home, as fast as the limits allow, from a motion home or from the curve over the master.

        Where the line has jumped, in no time, the carriage does not follow it beyond an end of its stroke."""
        machine = self.machine
        now = master.path.now
        if is_homing:
            position, velocity, acceleration, _ = self.homing.motion.at(now)
        else:
            position, velocity, acceleration, _ = self.setpoint_at(master, now)
        self.homing_start.set(position, velocity, acceleration)
        if not is_homing:
            former, _, _, _ = self.curve.at(master.path.positions[0] - self.cut)
            self.homing_start.limit_position(min(machine.min_position, former), max(machine.max_position, former))
        self.homing_start.limit_acceleration(machine.max_velocity, machine.max_acceleration, machine.max_deceleration)
        self.homing_start.limit_way(
            machine.min_position,
            machine.max_position,
            machine.max_velocity,
            turning_acceleration(machine),
            machine.homing_jerk,
        )
        self.homing.plan(machine, now, self.homing_start)

    def ease_homing(self, master: Master, slowest: float, spare_time: float, cut: float) -> None:
        """Ease the motion home that has just been planned, if there is time for it before the next cut.

        On a measured line, whose velocity is noisy, it stays eased up to the velocity that costs half the spare time.
        """
        machine = self.machine
        line_velocity = master.present_velocity()
        start = (machine.home_position - approach_distance(machine, line_velocity)) / machine.coupling
        until_start = (start - master.distance_beyond(cut, master.path.now)) / line_velocity
        time = until_start * PUNCTUAL - machine.homing_settle_time - spare_time
        self.homing.plan_eased(machine, slowest, master.path.now, self.homing_start, time)
        self.homing.eased_velocity = line_velocity
        if self.homing.is_eased and master.is_measured():
            self.homing.eased_velocity += 0.5 * spare_time / until_start * line_velocity
        self.homing.eased_cut = cut

    def is_nearly_in_sync(self, master: Master, time: float) -> bool:
        """Whether sync is ahead by rounding only, at a time since the step's beginning."""
        missing = self.curve.sync - master.distance_beyond(self.cut, time)
        travel = self.curve.sync - self.curve.start
        return missing <= NEARLY * travel + rounding_tolerance(self.cut, master.end)

    def has_to_stop(self, master: Master, time: float) -> bool:
        """Whether the time-optimal stop from the setpoint at a time ends at an end of the stroke, or beyond it."""
        position, velocity, acceleration, _ = self.setpoint_at(master, time)
        machine = self.machine
        if self.is_beyond_ends(position):
            return True  # whatever its direction: the line has jumped there
        acceleration = attainable_acceleration(
            velocity, acceleration, machine.max_velocity, machine.max_acceleration, machine.max_deceleration
        )
        end = position + stopping_distance(velocity, acceleration, turning_acceleration(machine), machine.homing_jerk)
        if velocity > 0.0 or (velocity == 0.0 and acceleration > 0.0):
            return end >= machine.max_position
        return (velocity < 0.0 or acceleration < 0.0) and end <= machine.min_position

    def is_beyond_ends(self, position: float) -> bool:
        """Whether a position is beyond the stroke."""
        machine = self.machine
        low = machine.min_position - end_tolerance(machine.min_position, machine.max_velocity)
        high = machine.max_position + end_tolerance(machine.max_position, machine.max_velocity)
        return not low <= position <= high

    def is_far_from_ends(self, master: Master, until: float) -> bool:
        """Whether the carriage, in sync, need not stop for an end of its stroke from now until a time since the step's
        beginning. Then no search for the instant is needed. The bound of the stopping distance is a rough one."""
        if not self.curve.has_joined:
            return False
        k = self.curve.coupling
        down = turning_acceleration(self.machine)
        jerk = self.machine.homing_jerk
        speed = k * max(abs(master.begin_velocity), abs(master.end_velocity))
        change = k * abs(master.end_velocity - master.begin_velocity)
        ahead = 0.0
        if self.curve.has_gap:
            ahead = self.curve.gap_distance
            step = master.step
            speed, acceleration = gap_extremes(speed, change / step, ahead, self.cycle_machine.gap_travel)
            change = acceleration * step
        if change > down * master.step:
            return False
        first = k * master.distance_beyond(self.cut, master.path.now)
        last = k * master.distance_beyond(self.cut, until)
        below = min(first, last) - self.machine.min_position
        stroke_left = min(below, self.machine.max_position - ahead - max(first, last))
        # With F = jerk speed + down^2 / 2 the stopping distance is below F (F / 2 + 3 down^2) / (down jerk^2).
        fast = jerk * speed + 0.5 * down * down
        return stroke_left * down * jerk * jerk > fast * (0.5 * fast + 3.0 * down * down)
