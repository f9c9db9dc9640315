"""What machines can do, by hand: the block's predictions, its runs, the plan and the oracle are compared with it.

V2/a: the approach's distance is D = max(0.75 V²/a, sqrt(1.5 V³/j)); for the reference machine the jerk limits it. 2 D/V
is its time, S = D + 0.25 s · V the travel through the cut. All numbers are rounded to the last digit that is given.
"""

from math import sqrt
from typing import Any, NamedTuple

import pytest

# The reference machine, its approach planned for the present line; home 0, a cut of 0.25 s.
REFERENCE: dict[str, Any] = {
    "axis.max_velocity": 1500.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 10000.0,
    "axis.max_jerk": 200000.0,
    "axis.min_position": -250.0,
    "axis.max_position": 650.0,
    "approach.reserve": 0.0,
}
SLOWER: dict[str, Any] = {
    "tool.settle_time": 0.05,
    "tool.retract_time": 0.04,
    "homing.velocity": 1200.0,
    "homing.acceleration": 6000.0,
    "homing.deceleration": 8000.0,
    "homing.jerk": 100000.0,
    "homing.settle_time": 0.02,
}
MACHINES: dict[str, dict[str, Any]] = {  # what is different from the reference machine
    "reference": {},
    "reserve": {"approach.reserve": 0.02},
    "slower": SLOWER,
    "slower, reserve": SLOWER | {"approach.reserve": 0.1},
    "long approach": {"approach.distance": 150.0},
    "mitre": {  # k = 1.02/cos 30° = 1.177794549; pieces of 812 and a kerf of 4 have the pitch 816/1.02 = 800
        "material_factor": 1.02,
        "diagonal_angle": 30.0,
        "kerf": 4.0,
        "axis.max_position": 900.0,
        "gap.distance": 10.0,
        "gap.travel": 150.0,
    },
}


class Cycle(NamedTuple):
    """A cycle at one velocity of the line: distances in u, times in s."""

    approach_distance: float
    approach_time: float
    cut_travel: float
    return_time: float
    cycle_time: float
    shortest_pitch: float
    stroke: float


CYCLES = {  # of the reference machine, by the line's velocity, in u/s
    500.0: Cycle(30.618621785, 0.122474487, 155.618621785, 0.373399796, 0.745874284, 372.937142, 180.618622),
    1000.0: Cycle(86.602540378, 0.173205081, 336.602540378, 0.574401694, 0.997606774, 997.606774, 411.602540),
}

GREATEST_VELOCITIES = {  # of the reference machine, by the pitch, in u; from 2000 on the stroke of 650 is used up
    500.0: 619.645830,
    1000.0: 1001.572745,
    1500.0: 1297.293509,
    1504.0: 1299.439552,
    2000.0: 1431.797780,
    1e300: 1431.797780,
}


class Result(NamedTuple):
    """A quantity of a machine, at a velocity of the line or for a pitch, rounded to so many decimal places."""

    machine: str
    quantity: str
    at: float
    value: float
    digits: int


RESULTS = [
    *(
        Result("reference", name, velocity, x, 6 if name in ("shortest_pitch", "stroke") else 9)
        for velocity, cycle in CYCLES.items()
        for name, x in cycle._asdict().items()
    ),
    *(Result("reference", "max_line_velocity", pitch, x, 6) for pitch, x in GREATEST_VELOCITIES.items()),
    Result("reference", "shortest_pitch", 1310.0, 1523.763272, 6),
    Result("reserve", "approach_distance", 1000.0, 89.213563991, 9),
    Result("reserve", "max_line_velocity", 1504.0, 1293.533469, 6),
    Result("slower", "approach_distance", 800.0, 61.967733539, 9),
    Result("slower", "cut_travel", 800.0, 333.967733539, 9),  # 61.967733539 + 800 (0.05 + 0.25 + 0.04)
    Result("slower", "return_time", 800.0, 0.721084222, 9),
    Result("slower", "cycle_time", 800.0, 1.236003556, 9),
    Result("slower", "shortest_pitch", 800.0, 988.802845, 6),
    Result("slower", "max_line_velocity", 1504.0, 1048.596584, 6),
    Result("slower, reserve", "approach_distance", 800.0, 71.491538, 6),
    Result("slower, reserve", "cycle_time", 800.0, 1.267749571, 9),
    Result("slower, reserve", "shortest_pitch", 800.0, 1014.199657, 6),
    Result("slower, reserve", "max_line_velocity", 1504.0, 1031.077820, 6),
    Result("long approach", "max_line_velocity", 1000.0, 856.617072, 6),
    Result("mitre", "coupling", 0.0, 1.177794549, 9),
    Result("mitre", "max_line_velocity", 800.0, 674.114819, 6),
]
EACH_RESULT = pytest.mark.parametrize("result", RESULTS, ids=lambda r: f"{r.machine}: {r.quantity} at {r.at:g}")

# At 1000 u/s from 0 on, started at 0.2 s with pieces of 1500 and a kerf of 4: B = 200 - 2, C = 198 + 1504 = 1702, the
# start at 1702 - D. By instant, in s; the next pieces follow after 1.504 s each.
BASIC_CUT = {"start": 1.615397460, "sync": 1.788602540, "cut": 2.038602540, "home": 2.613004234}


def result_of(machine: str, quantity: str, at: float) -> float:
    """The number that is given."""
    (value,) = (r.value for r in RESULTS if (r.machine, r.quantity, r.at) == (machine, quantity, at))
    return value


def to(digits: int, value: float) -> Any:
    """Equal to a number that is rounded to so many decimal places."""
    return pytest.approx(value, rel=0.0, abs=0.5000001 * 10.0**-digits)


def pitch_without_jerk(v: float, a: float, t: float) -> float:
    """The shortest pitch where no jerk is limited, t the time of the cut. 2D/V = 1.5 v/a; S = 0.75 v2/a + v t; the way
    home: v/a, then from standstill 2 sqrt((S + 0.5 v2/a)/a). Without a cut (2.5 + 2 sqrt 1.25) v2/a = 4.73607 v2/a."""
    return v * (2.5 * v / a + t + 2.0 * sqrt((1.25 * v * v / a + v * t) / a))
