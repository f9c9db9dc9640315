"""The beats so far: how far apart they are, and whether that changes. Source: TwinCAT TS5066, mean drift."""

from dataclasses import dataclass

from .. import var
from .interface import MOST_PERIODS

SIGNIFICANT = 0.2  # of the last mean: a change of the drift that is worth a warning


@dataclass(slots=True)
class BeatHistory:
    """Beats one after the other, and the distances between those of one sign, in receiver cycles, the latest first.

    `sign` is the sign of the latest beat: 1 where the sender has gained a count; `time` is its cycle, which need not be
    a whole number. `count` distances are stored; `mean` is the mean of the last `periods` of them, 0 where there are
    fewer. `has_changed`: with the latest beat the mean, or the sign, has changed significantly.
    """

    beats: int = 0
    sign: int = 0
    time: float = 0.0
    count: int = 0
    mean: float = 0.0
    has_changed: bool = False
    distances: list[float] = var.array(MOST_PERIODS)

    def start(self) -> None:
        self.forget()
        self.has_changed = False

    def forget(self) -> None:
        """Drop all beats; if there was one, the drift has changed."""
        self.has_changed = self.has_changed or self.beats > 0
        self.beats = 0
        self.sign = 0
        self.count = 0
        self.mean = 0.0

    def is_reversed_by(self, sign: int) -> bool:
        """Whether a beat of that sign is opposite to the ones before."""
        return self.beats > 0 and sign != self.sign

    def add(self, time: float, sign: int, periods: int) -> None:
        """Add a beat at this cycle; the mean is taken over the last `periods` distances."""
        if self.beats > 0 and sign == self.sign:
            mean_before = self.mean
            self.add_distance(time - self.time, periods)
            self.has_changed = mean_before > 0.0 and abs(self.mean - mean_before) > SIGNIFICANT * mean_before
        else:
            self.has_changed = self.beats > 0
            self.count = 0
            self.mean = 0.0
        self.beats += 1
        self.sign = sign
        self.time = time

    def add_distance(self, distance: float, periods: int) -> None:
        """Add the latest distance; the mean is computed as soon as there are enough of them."""
        for i in range(periods - 1):
            later = periods - 1 - i
            self.distances[later] = self.distances[later - 1]
        self.distances[0] = distance
        self.count = min(self.count + 1, periods)
        if self.count == periods:
            total = 0.0
            for i in range(periods):
                total += self.distances[i]
            self.mean = total / periods
