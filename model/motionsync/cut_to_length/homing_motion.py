"""The carriage's motion home: as fast as the limits allow, or eased, so that it arrives just in time."""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..motion.jerk_limited import Motion
from ..motion.start import MotionStart
from .machine_limits import Machine, change_time, return_time

FASTER = 1e-9  # of a velocity: by so much the line has become faster


@dataclass(slots=True)
class HomingMotion:
    """A motion that ends at rest at home.

    Attributes:
        end: where it ends, and where the carriage rests afterwards, u.
        is_eased: it uses a `share` of the limits.
        is_halting: its first part, in which the carriage halts, is under way.
        eased_velocity, eased_cut: the line's velocity, u/s, and the next cut's position, u, for which it was planned.
    """

    motion: Motion = var.part(Motion)
    end: float = 0.0
    is_eased: bool = False
    is_halting: bool = False
    share: float = 1.0
    eased_velocity: float = 0.0
    eased_cut: float = 0.0

    def rest_at(self, position: float) -> None:
        """The carriage rests."""
        self.end = position
        self.is_eased = False
        self.share = 1.0

    def plan(self, machine: Machine, now: float, start: MotionStart) -> None:
        """Plan it as fast as the limits of homing allow; it starts this time after the step's beginning, s."""
        self.rest_at(machine.home_position)
        self.is_halting = False
        self.motion.start(start.position, start.velocity, start.acceleration)
        self.move_home(machine, now)

    def plan_eased(self, machine: Machine, slowest: float, now: float, start: MotionStart, time: float) -> None:
        """If the motion may take this time, s, halt first; from there use the share of the limits that is needed."""
        down = machine.homing_deceleration
        jerk = machine.homing_jerk
        halt = change_time(start.velocity, down, jerk)
        distance = start.position - machine.home_position + 0.5 * start.velocity * halt
        if not (distance > 0.0 and start.velocity >= 0.0):
            return
        fast = return_time(machine, 0.0, distance, machine.homing_acceleration)
        if time - halt > fast:
            self.is_eased = True
            self.is_halting = True
            self.share = max(slowest, fast / (time - halt))
            self.motion.start(start.position, start.velocity, start.acceleration)
            self.motion.halt(down, jerk)
            self.motion.clock.start(now)

    def continue_home(self, machine: Machine, now: float) -> None:
        """Move home from where the carriage has halted."""
        self.is_halting = False
        self.motion.start(self.motion.positions[self.motion.segments - 1], 0.0, 0.0)
        self.move_home(machine, now)

    def move_home(self, machine: Machine, now: float) -> None:
        """Move from where the motion has been started, with the share of the limits."""
        share = self.share
        speed = share * machine.homing_velocity
        up = share * share * machine.homing_acceleration
        down = share * share * machine.homing_deceleration
        jerk = share * share * share * machine.homing_jerk
        self.motion.move(self.end, speed, up, down, jerk)
        self.motion.clock.start(now)

    def can_stay_eased(self, master: Master, cut: float) -> bool:
        """Whether the motion still is in time for the next cut: this has not changed, nor is the line faster."""
        is_faster = is_accelerating(master) or master.begin_velocity > self.eased_velocity * (1.0 + FASTER)
        return not is_faster and cut == self.eased_cut


def is_accelerating(master: Master) -> bool:
    """Whether the line gets faster in the present step; of a measured one nobody can say."""
    begin = master.begin_velocity
    return not master.is_measured() and master.end_velocity - begin > FASTER * abs(begin)
