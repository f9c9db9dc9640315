"""The scripted master of a rotary knife, with 50 digits at any time; its events are at times in floats."""

from dataclasses import dataclass, replace

from tests.oracle.master import Motion, Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


@dataclass(frozen=True)
class ExactSection:
    """A stretch of the master, its positions moved by `shift`."""

    stretch: Stretch
    shift: Number

    @property
    def begin(self) -> float:
        return float(self.stretch.begin)

    @property
    def end(self) -> float:
        return float(self.stretch.end)

    @property
    def direction(self) -> int:
        return self.stretch.direction

    def at(self, time: float) -> Motion:
        motion = self.stretch.at(mp.mpf(time))
        return replace(motion, position=motion.position + self.shift)

    def passes(self, place: Number, direction: int, low: float, high: float) -> float | None:
        """When the master that moves in that direction reaches a place in [low, high]; `low` if it is beyond."""
        if self.direction != direction or (self.at(high).position - place) * direction < 0:
            return None
        if (self.at(low).position - place) * direction >= 0:
            return low
        time = self.stretch.when(place - self.shift, mp.mpf(low), mp.mpf(high))
        return min(max(float(time), low), high)
