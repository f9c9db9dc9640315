"""The knife's motion to park: in time, with the limits of its axis, from wherever it is and without turning back."""

from dataclasses import dataclass
from math import sqrt

from .. import var
from ..master import Master
from ..motion.jerk_limited import Motion, stopping_distance
from ..motion.laws import chain_rule
from ..motion.start import attainable_acceleration
from ..numerics.grid import floor
from .cycle import Cycle
from .knife import Knife
from .window import PARK_MARGIN


@dataclass(slots=True)
class Parking:
    """The motion to the first park place at which the knife can come to rest.

    Positions of the knife count from where the blade `blade` cuts.

    Attributes:
        end: where the motion ends.
        passed: the number of the last place of a cut that was passed: 0 is that of `blade`.
    """

    motion: Motion = var.part(Motion)
    blade: float = 0.0
    end: float = 0.0
    passed: float = 0.0

    def plan(self, knife: Knife, cycle: Cycle, master: Master) -> None:
        """Plan it from where the knife is on its cycle now.

        What slows a knife down that turns forwards is no more than what a stop needs, sqrt(2 jerk velocity)."""
        position, d1, d2, d3 = cycle.at(master.path.reached)
        velocity, acceleration, _ = chain_rule(d1, d2, d3, master.present_velocity(), master.mean_acceleration())
        up = knife.max_acceleration
        jerk = knife.max_jerk
        start = attainable_acceleration(velocity, acceleration, knife.max_velocity, up, up)
        if velocity >= 0.0:
            start = max(start, -sqrt(2.0 * jerk * velocity))
        stop = position + stopping_distance(velocity, start, up, jerk)
        margin = PARK_MARGIN * knife.turn
        places = -floor(-(stop - margin - knife.park_angle) / knife.spacing)
        self.blade = cycle.blade
        self.end = max(knife.park_angle + places * knife.spacing, stop)
        self.passed = floor((position + margin) / knife.spacing)
        self.motion.start(position, velocity, start)
        self.motion.move(self.end, knife.max_velocity, up, up, jerk)
        self.motion.clock.start(master.path.now)

    def places_passed(self, knife: Knife, position: float) -> float:
        """How many places of cuts are passed at a position that were not passed before."""
        return max(floor(position / knife.spacing) - self.passed, 0.0)

    def turns_at_end(self, knife: Knife) -> float:
        """How many blades have passed where they cut, beyond `blade`, when the motion is over."""
        return floor(self.end / knife.spacing) + 1.0
