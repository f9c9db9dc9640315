"""What the reference machine can do, by hand: the block's predictions, the plan and the oracle are compared with it.

V2/a: the approach's distance is D = max(0.75 V²/a, sqrt(1.5 V³/j)); here the jerk limits it. 2 D/V is its time,
S = D + 0.25 s · V the travel through the cut. All numbers are rounded to the last digit that is given.
"""

from typing import Any, NamedTuple

import pytest


class Cycle(NamedTuple):
    """A cycle at one velocity of the line: distances in u, times in s."""

    approach_distance: float
    approach_time: float
    cut_travel: float
    return_time: float
    cycle_time: float
    shortest_pitch: float
    stroke: float


CYCLES = {  # by the line's velocity, in u/s
    500.0: Cycle(30.618621785, 0.122474487, 155.618621785, 0.373399796, 0.745874284, 372.937142, 180.618622),
    1000.0: Cycle(86.602540378, 0.173205081, 336.602540378, 0.574401694, 0.997606774, 997.606774, 411.602540),
}

GREATEST_VELOCITIES = {  # by the pitch, in u; from 2000 on the stroke of 650 is used up
    500.0: 619.645830,
    1000.0: 1001.572745,
    1500.0: 1297.293509,
    1504.0: 1299.439552,
    2000.0: 1431.797780,
}


def to(digits: int, value: float) -> Any:
    """Equal to a number that is rounded to so many decimal places."""
    return pytest.approx(value, rel=0.0, abs=0.5000001 * 10.0**-digits)


def rounded(cycle: Cycle) -> tuple[Any, ...]:
    """Equal to these numbers; pitch and stroke have six decimal places, all else has nine."""
    return tuple(to(6 if name in ("shortest_pitch", "stroke") else 9, x) for name, x in cycle._asdict().items())
