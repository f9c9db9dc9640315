"""The instants of events inside a step: when a clock has reached a time."""

from ..clock import Clock
from ..motion.jerk_limited import SAME_TIME

NEVER = 1e300  # s since the step's beginning


def due_instant(clock: Clock, time: float, now: float, until: float) -> float:
    """When a clock reaches a time, in s since the step's beginning, not before `now`; NEVER: not up to `until`."""
    if clock.time + until < time * SAME_TIME:
        return NEVER
    return max(now, min(time - clock.time, until))
