"""How a rotary knife parks in time: by a motion of its own, from wherever it is, with the axis's limits.

Readings of the specification that it leaves open:
- The motion begins with an acceleration that the axis could have. One that slows a knife down that turns forwards is
  no more than what a stop needs: sqrt(2·jerk·velocity).
- A stop that ends at a park place, to 1e-9 of a turn, ends there.
"""

from tests.oracle import mp
from tests.oracle.flying_saw_motion import run, stop
from tests.oracle.master import Motion
from tests.oracle.motion_start import attainable_acceleration
from tests.oracle.mp import Number
from tests.oracle.root_search import find_first_root
from tests.oracle.rotary_knife_limits import SPARE, Knife
from tests.oracle.timed_motion import TimedMotion, plan_move


def plan_parking(knife: Knife, time: float, position: Number, velocity: Number, acceleration: Number) -> TimedMotion:
    """From a state of the slave to the first park place at which it can come to rest."""
    limits = knife.velocity, knife.acceleration, knife.acceleration
    a = attainable_acceleration(velocity, acceleration, *limits)
    if velocity >= 0:
        a = max(a, -mp.sqrt(2 * knife.jerk * velocity))
    start = Motion(position, velocity, a)
    end = run(start, stop(start, knife.acceleration, knife.jerk)).position
    places = mp.ceil((end - SPARE * knife.turn - knife.park_angle) / knife.spacing)
    target = max(knife.park_angle + places * knife.spacing, end)
    return plan_move(time, (position, velocity, a, mp.mpf(0)), target, (*limits, knife.jerk))


def when_passed(motion: TimedMotion, position: Number, begin: float) -> float | None:
    """When the motion passes a position forwards."""
    if motion.target < position:
        return None
    return find_first_root(lambda time: motion.at(time)[0] - float(position), begin, motion.end)
