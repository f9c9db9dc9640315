"""A clock that adds up the lengths of the steps, without an error that grows."""

from dataclasses import dataclass

SAME_TIME = 1.0 - 1e-13  # of a time: from this share on the time is reached, but for rounding


@dataclass(slots=True)
class Clock:
    """The time since some instant, s, at the start of the present step.

    `rounding_error` is what rounding has added to the sum; `advance` subtracts it from the next step (Kahan's
    summation).
    """

    time: float = 0.0
    rounding_error: float = 0.0

    def start(self, offset: float) -> None:
        """Set the clock so that time 0 is `offset` seconds after the start of the present step."""
        self.time = 0.0 - offset
        self.rounding_error = 0.0

    def has_reached(self, time: float, at: float) -> bool:
        """Whether the clock has reached a time, but for rounding, `at` seconds after the start of the present step."""
        return self.time + at >= time * SAME_TIME

    def advance(self, h: float) -> None:
        """Advance the clock to the end of a step of h seconds."""
        step = h - self.rounding_error
        time = self.time + step
        self.rounding_error = (time - self.time) - step
        self.time = time
