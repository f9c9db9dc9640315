"""The beats that are known: how far apart they are, and whether that changes.

Source: TwinCAT TS5066, mean drift.
"""

from dataclasses import dataclass

from .. import var
from .interface import MOST_PERIODS

SIGNIFICANT = 0.2  # of the last mean: a change of the drift that is worth a warning


@dataclass(slots=True)
class History:
    """Beats one after the other, and the distances between those of one sign, in receiver cycles, the latest first.

    `sign` is the sign of the latest beat: 1 where the sender has gained a count; `time` is its cycle, which need not be
    a whole number. `known` distances are kept; `mean` is the mean of the last `periods` of them, 0 where fewer are
    known. `changed`: with the latest beat the mean, or the sign, has changed significantly.
    """

    beats: int = 0
    sign: int = 0
    time: float = 0.0
    known: int = 0
    mean: float = 0.0
    changed: bool = False
    distances: list[float] = var.ring(MOST_PERIODS)

    def begin(self) -> None:
        self.forget()
        self.changed = False

    def forget(self) -> None:
        """No beat is known any more; if there was one, the drift has changed."""
        self.changed = self.changed or self.beats > 0
        self.beats = 0
        self.sign = 0
        self.known = 0
        self.mean = 0.0

    def reverses(self, sign: int) -> bool:
        """Whether a beat of that sign is opposite to the ones before."""
        return self.beats > 0 and sign != self.sign

    def add(self, time: float, sign: int, periods: int) -> None:
        """A beat at this cycle; the mean is taken over the last `periods` distances."""
        if self.beats > 0 and sign == self.sign:
            last = self.mean
            self.remember(time - self.time, periods)
            self.changed = last > 0.0 and abs(self.mean - last) > SIGNIFICANT * last
        else:
            self.changed = self.beats > 0
            self.known = 0
            self.mean = 0.0
        self.beats += 1
        self.sign = sign
        self.time = time

    def remember(self, distance: float, periods: int) -> None:
        """The latest distance, and the mean as soon as enough of them are known."""
        for i in range(periods - 1):
            at = periods - 1 - i
            self.distances[at] = self.distances[at - 1]
        self.distances[0] = distance
        self.known = min(self.known + 1, periods)
        if self.known == periods:
            total = 0.0
            for i in range(periods):
                total += self.distances[i]
            self.mean = total / periods
