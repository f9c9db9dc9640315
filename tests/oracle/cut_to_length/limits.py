"""What a cut-to-length machine can do: the closed forms of a cycle, and their inversion for the line's velocity.

A cycle at constant line velocity v leads from the start of an approach to the earliest start of the next. V = k·v is
the carriage's velocity in sync. Floats, with roots to the last bit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, inf, pi, sqrt
from typing import Any

from tests.oracle.numerics.root_search import find_root

TIME, DISTANCE, FEEDBACK = 1, 2, 3


def change_time(change: float, acceleration: float, jerk: float) -> float:
    """R: the time of a jerk-limited change of velocity between states without acceleration."""
    if change >= acceleration**2 / jerk:
        return change / acceleration + acceleration / jerk
    return 2 * sqrt(max(change, 0.0) / jerk)


@dataclass(frozen=True)
class Saw:
    """What the machine is set to at an instant. A limit that is set to 0 has the axis's value in it.

    `k`: carriage velocity per line velocity in sync; `f`: travel of the material per travel of the master; `home`: h.
    `axis`: velocity, acceleration, deceleration and jerk limits of the axis; `homing`: the same of the way home.
    """

    f: float
    k: float
    home: float
    low: float
    high: float
    axis: tuple[float, float, float, float]
    distance: float
    reserve: float
    approach_acceleration: float
    approach_jerk: float
    homing: tuple[float, float, float, float]
    settle_home: float
    mode: int
    settle: float
    on_delay: float
    cut_time: float
    cut_distance: float
    retract: float
    timeout: float
    gap: float
    gap_travel: float

    @staticmethod
    def of(inputs: Mapping[str, Any], calibration: float) -> "Saw":
        """The machine as its variables are set now, with the factor of the calibration."""
        f = float(inputs["material_factor"]) * calibration
        velocity, acceleration, deceleration, jerk = (
            float(inputs[f"axis.max_{name}"]) for name in ("velocity", "acceleration", "deceleration", "jerk")
        )
        axis = (velocity, acceleration, deceleration or acceleration, jerk)
        homing = (
            float(inputs["homing.velocity"]) or axis[0],
            float(inputs["homing.acceleration"]) or axis[1],
            float(inputs["homing.deceleration"]) or axis[2],
            float(inputs["homing.jerk"]) or axis[3],
        )
        return Saw(
            f=f,
            k=f / cos(inputs["diagonal_angle"] * pi / 180),
            home=float(inputs["home_position"]),
            low=float(inputs["axis.min_position"]),
            high=float(inputs["axis.max_position"]),
            axis=axis,
            distance=float(inputs["approach.distance"]),
            reserve=float(inputs["approach.reserve"]),
            approach_acceleration=float(inputs["approach.acceleration"]) or axis[1],
            approach_jerk=float(inputs["approach.jerk"]) or axis[3],
            homing=homing,
            settle_home=float(inputs["homing.settle_time"]),
            mode=int(inputs["tool.mode"]),
            settle=float(inputs["tool.settle_time"]),
            on_delay=float(inputs["tool.on_delay"]),
            cut_time=float(inputs["tool.cut_time"]),
            cut_distance=float(inputs["tool.cut_distance"]),
            retract=float(inputs["tool.retract_time"]),
            timeout=float(inputs["tool.timeout"]),
            gap=float(inputs["gap.distance"]),
            gap_travel=float(inputs["gap.travel"]),
        )

    @property
    def turning_acceleration(self) -> float:
        """The limit of acceleration where the carriage reverses."""
        return min(self.homing[1], self.homing[2])

    def lead(self, velocity: float) -> float:
        """The shortest distance from home to sync for a carriage that has V = `velocity` then."""
        v = max(velocity, 0.0)
        return max(0.75 * v**2 / self.approach_acceleration, sqrt(1.5 * v**3 / self.approach_jerk))

    def approach_distance(self, v: float) -> float:
        """D(v): the distance from home to sync that an approach is designed for, at the line velocity v."""
        return max(self.distance, self.lead(self.k * max(v, 0.0) * (1 + self.reserve)))

    def approach_time(self, v: float) -> float:
        return 2 * self.approach_distance(v) / (self.k * v)

    def tool_time(self, v: float) -> float:
        """t_s without the time of the gap."""
        cut = self.cut_distance / (self.k * v) if self.mode == DISTANCE else self.cut_time
        return max(self.settle, self.on_delay - self.approach_time(v), 0.0) + cut + self.retract

    def cut_travel(self, v: float) -> float:
        """S: from home to where the way home starts."""
        gap = self.gap_travel + self.gap if self.gap > 0 else 0.0
        return self.approach_distance(v) + self.k * v * self.tool_time(v) + gap

    def return_time(self, velocity: float, distance: float, turning_acceleration: float) -> float:
        """T_r: the way home over `distance` from the velocity V; `turning_acceleration`: its limit until the peak."""
        fastest, _, deceleration, jerk = self.homing

        def covered(w: float) -> float:
            up = (w - velocity) / 2 * change_time(velocity + w, turning_acceleration, jerk)
            return up + w / 2 * change_time(w, deceleration, jerk)

        peak, cruise = fastest, 0.0
        if covered(fastest) <= distance:
            cruise = (distance - covered(fastest)) / fastest
        else:
            peak = find_root(lambda w: covered(w) - distance, 0.0, fastest)
        return change_time(velocity + peak, turning_acceleration, jerk) + change_time(peak, deceleration, jerk) + cruise

    def cycle_time(self, v: float) -> float:
        """T_c; 0 for a line that does not move forwards."""
        if v <= 0:
            return 0.0
        gap = self.gap_travel / (self.k * v) if self.gap > 0 else 0.0
        home = self.return_time(self.k * v, self.cut_travel(v), self.turning_acceleration)
        return self.approach_time(v) + self.tool_time(v) + gap + home + self.settle_home

    def shortest_pitch(self, v: float) -> float:
        """p_min: travel of the master in the shortest cycle."""
        return v * self.cycle_time(v)

    def stroke(self, v: float) -> float:
        """How far from home a cycle leads."""
        if v <= 0:
            return self.distance
        speed = self.k * v
        return self.cut_travel(v) + speed / 2 * change_time(speed, self.turning_acceleration, self.homing[3])

    def stroke_margin(self, v: float) -> float:
        """How far the line velocity is from what velocity and stroke of the axis admit; not below 0: admissible."""
        return min(self.axis[0] - self.k * v, self.high - self.home - self.stroke(v))

    def max_line_velocity(self, pitch: float) -> float:
        """The greatest velocity for cuts that are `pitch` (of the master, or inf) apart; 0 if there is none."""
        fastest = self.axis[0] / self.k
        slowest = fastest * 1e-15

        def too_far(v: float) -> float:
            return self.home + self.stroke(v) - self.high

        def too_often(v: float) -> float:
            return self.shortest_pitch(v) - pitch

        greatest = fastest
        for excess in (too_far, too_often) if pitch < inf else (too_far,):
            if excess(fastest) > 0:
                greatest = min(greatest, find_root(excess, slowest, fastest) if excess(slowest) < 0 else 0.0)
        return greatest

    def can_open_gap(self, v: float) -> bool:
        """The curve that opens the gap keeps the axis's limits at the line velocity v."""
        speed, (fastest, acceleration, deceleration, jerk) = self.k * v, self.axis
        time = self.gap_travel / speed
        return (
            speed + 1.875 * self.gap / time <= fastest
            and 10 / sqrt(3) * self.gap / time**2 <= min(acceleration, deceleration)
            and 60 * self.gap / time**3 <= jerk
        )
