"""The scripted axis of a scenario: its motion is given segment by segment, and is exact at every time."""

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runner.axis import Axis, position_after, velocity_after


@dataclass(frozen=True)
class Segment:
    """A span of time with at most one of: a velocity to jump to, a constant acceleration, a constant jerk.

    Without any of them the velocity stays as it is. A jerk starts from the acceleration at the end of the segment
    before.
    """

    duration: float
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None


class AxisMotion(NamedTuple):
    """Position (u, unwrapped), velocity, acceleration and jerk at an instant."""

    position: float
    velocity: float
    acceleration: float
    jerk: float

    def after(self, t: float) -> "AxisMotion":
        """The motion a time t later, with constant jerk; of many motions at once, too."""
        position, velocity, a, j = self
        return AxisMotion(position_after(t, position, velocity, a, j), velocity_after(t, velocity, a, j), a + t * j, j)


class Script:
    """Segments, one after the other, from time 0 on. After the last one the velocity stays as it is.

    Attributes:
        initial: the motion before time 0, as it is at 0.
        breaks: the times at which the segments begin, the first one 0, in s.
        motions: the motions at these times.
        points: the breaks at which a run has a communication point.
        is_recorded: whether the line was recorded by an encoder, so that its true motion is not known.
    """

    is_recorded = False

    def __init__(self, position: float, velocity: float, acceleration: float, segments: Iterable[Segment]) -> None:
        self.initial = AxisMotion(position, velocity, acceleration, 0.0)
        self.breaks: list[float] = [0.0]
        self.motions: list[AxisMotion] = []
        ending = self.initial
        for segment in segments:
            begin = AxisMotion(
                ending.position,
                ending.velocity if segment.velocity is None else segment.velocity,
                ending.acceleration if segment.jerk is not None else segment.acceleration or 0.0,
                segment.jerk or 0.0,
            )
            self.motions.append(begin)
            self.breaks.append(self.breaks[-1] + segment.duration)
            ending = begin.after(segment.duration)
        self.motions.append(AxisMotion(ending.position, ending.velocity, 0.0, 0.0))
        self.points = self.breaks

    @cached_property
    def series(self) -> "tuple[array[float], array[float]]":
        """The breaks, and the motions at them, four numbers each, as the package `runner` reads them."""
        return array("d", self.breaks), array("d", chain.from_iterable(self.motions))

    def axis(self) -> Axis:
        """The axis of a run that has this script."""
        axis = Axis(*self.series, len(self.breaks), self.is_recorded)
        axis.start_position, axis.start_velocity, axis.start_acceleration, _ = self.initial
        return axis

    def at(self, t: float) -> AxisMotion:
        """The motion at t; where it jumps at t, the motion after the jump."""
        return self._after(max(bisect_right(self.breaks, t) - 1, 0), t)

    def table(self) -> NDArray[np.float64]:
        """The motions at the breaks, shape (breaks, 4): u, u/s, u/s2, u/s3."""
        return np.array(self.motions)

    def motions_at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The motions at these times, as `at` gives them, shape (times, 4): u, u/s, u/s2, u/s3."""
        breaks = np.array(self.breaks)
        i = np.maximum(np.searchsorted(breaks, times, "right") - 1, 0)
        segment_starts: Any = self.table()[i].T
        later = AxisMotion(*segment_starts).after(times - breaks[i])
        return np.column_stack([later.position, later.velocity, later.acceleration, later.jerk])

    def until(self, t: float) -> AxisMotion:
        """The motion at t; where it jumps at t, the motion before the jump."""
        return self._after(max(bisect_left(self.breaks, t) - 1, 0), t)

    def _after(self, i: int, t: float) -> AxisMotion:
        """The motion at t, by the segment i."""
        return self.motions[i].after(t - self.breaks[i])
