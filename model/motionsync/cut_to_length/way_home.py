"""The carriage's way home: as fast as the limits allow, or with ease, so that it is there just in time."""

from dataclasses import dataclass

from .. import var
from ..motion import Motion
from .limits import Machine, change_time, return_time


@dataclass(slots=True)
class WayHome:
    """A motion that ends at rest at home.

    Attributes:
        home: where it ends, u.
        eased: it uses a `share` of the limits.
        halting: its first part, in which the carriage halts, is under way.
        eased_velocity, eased_place: the line's velocity, u/s, and the next cut's place, u, for which it was planned.
    """

    motion: Motion = var.part(Motion)
    home: float = 0.0
    eased: bool = False
    halting: bool = False
    share: float = 1.0
    eased_velocity: float = 0.0
    eased_place: float = 0.0

    def rest_at(self, position: float) -> None:
        """There is no way: the carriage rests."""
        self.home = position
        self.eased = False
        self.share = 1.0

    def plan(self, machine: Machine, begin: float, position: float, velocity: float, acceleration: float) -> None:
        """As fast as the limits of homing allow; it begins so long after the step's beginning, s."""
        self.rest_at(machine.home_position)
        self.halting = False
        self.motion.move(
            position,
            velocity,
            acceleration,
            self.home,
            machine.homing_velocity,
            machine.homing_acceleration,
            machine.homing_deceleration,
            machine.homing_jerk,
        )
        self.motion.clock.start(begin)

    def ease(
        self,
        machine: Machine,
        slowest: float,
        begin: float,
        position: float,
        velocity: float,
        acceleration: float,
        time: float,
    ) -> None:
        """If the way home may take so long, s, halt first; from there it uses only the share of the limits it needs."""
        down = machine.homing_deceleration
        jerk = machine.homing_jerk
        halt = change_time(velocity, down, jerk)
        distance = position - machine.home_position + 0.5 * velocity * halt
        if not (distance > 0.0 and velocity >= 0.0):
            return
        fast = return_time(0.0, distance, machine.homing_acceleration, down, jerk, machine.homing_velocity)
        if time - halt > fast:
            self.eased = True
            self.halting = True
            self.share = max(slowest, fast / (time - halt))
            self.motion.halt(position, velocity, acceleration, down, jerk)
            self.motion.clock.start(begin)

    def go_on(self, machine: Machine, begin: float) -> None:
        """The carriage has halted: from here home."""
        share = self.share
        position, _, _, _ = self.motion.at(self.motion.end())
        self.halting = False
        self.motion.move(
            position,
            0.0,
            0.0,
            self.home,
            share * machine.homing_velocity,
            share * share * machine.homing_acceleration,
            share * share * machine.homing_deceleration,
            share * share * share * machine.homing_jerk,
        )
        self.motion.clock.start(begin)

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk at a time since the step's beginning."""
        return self.motion.at(self.motion.clock.time + time)
