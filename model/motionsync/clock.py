"""A clock that sums up the lengths of the steps without an error that grows."""

from dataclasses import dataclass


@dataclass(slots=True)
class Clock:
    """The time since some instant, s, at the beginning of the present step.

    `lost` is what rounding has added to the sum; `advance` takes it off the next step (Kahan's summation).
    """

    time: float = 0.0
    lost: float = 0.0

    def start(self, offset: float) -> None:
        """Set the clock so that time 0 lies `offset` seconds after the beginning of the present step."""
        self.time = 0.0 - offset
        self.lost = 0.0

    def advance(self, h: float) -> None:
        """Let the clock go on to the end of a step of h seconds."""
        step = h - self.lost
        time = self.time + step
        self.lost = (time - self.time) - step
        self.time = time
